//! The sea has the same bits with every instruction set of this machine.

mod common;

use common::{boat, digest, on_sea, waves};
use messages::Order;
use primitives::frame::{Body, Ned, Pose};
use primitives::instructions::Instructions;
use primitives::stream::Stream;
use scenario::Scenario;
use scenario::sea::{Spreading, Waves};
use sim::World;
use sim::sea::{Attitude, HullWaves, Submergence, Surface, WaveField, WaveResponse, WaveSample};

/// Effects of waves with this many components on a boat, at many places and on all headings, as
/// bits.
fn bits_of_waves(components: u32, instructions: Instructions) -> Vec<u64> {
    let boat = boat("surveyor_m1_8");
    let sea = Waves {
        spreading: Spreading::CosineSquared,
        components,
        ..waves(0.7, 2.5, 0.4)
    };
    let field = WaveField::new(&sea, None, 3).with_instructions(instructions);
    let places = [-0.33, 0.33].map(|starboard| Body {
        ahead: -0.7,
        starboard,
    });
    let submergence = Submergence::new(&field, &boat, places);
    let hull = HullWaves::new(&field, &boat, 1000.0);
    let response = WaveResponse::new(&field, &boat);
    let mut stream = Stream::new(1, "test");
    let mut bits = Vec::new();
    for _ in 0..500 {
        let at = Ned {
            north: stream.between(-500.0, 500.0),
            east: stream.between(-500.0, 500.0),
        };
        let pose = Pose {
            at,
            psi_rad: stream.between(-7.0, 7.0),
        };
        let time_s = stream.between(0.0, 90_000.0);
        let turn_rad_s = stream.between(-1.0, 1.0);
        let velocity_m_s = Ned {
            north: stream.between(-3.0, 3.0),
            east: stream.between(-3.0, 3.0),
        };
        let (sample, depths_m) = hull.at_with(&submergence, pose, time_s);
        assert_eq!(
            sample,
            hull.at(pose, time_s),
            "{components}: with and without propellers"
        );
        let WaveSample {
            velocity,
            acceleration,
            drift_newton,
        } = sample;
        let Attitude {
            heave_up_m,
            roll_rad,
            pitch_rad,
            heave_up_m_s,
            roll_rad_s,
            pitch_rad_s,
            heave_up_m_s2,
        } = response.at(pose, velocity_m_s, turn_rad_s, time_s);
        let Surface { elevation_m, slope } = field.surface(at, time_s);
        let planar = [velocity, acceleration, drift_newton]
            .map(|planar| [planar.surge, planar.sway, planar.yaw]);
        let numbers = [
            heave_up_m,
            roll_rad,
            pitch_rad,
            heave_up_m_s,
            roll_rad_s,
            pitch_rad_s,
            heave_up_m_s2,
        ];
        let all = planar
            .as_flattened()
            .iter()
            .chain(&depths_m)
            .chain(&numbers);
        bits.extend(
            all.chain(&[elevation_m, slope.north, slope.east])
                .map(|number| number.to_bits()),
        );
    }
    bits
}

#[test]
fn waves_of_any_number_of_components_have_the_same_bits_with_all_instructions() {
    let sets = Instructions::of_this_machine();
    for components in [1, 3, 4, 5, 15, 16, 17, 32, 33, 64, 100] {
        let want = bits_of_waves(components, sets[0]);
        assert!(
            want.iter().any(|bits| f64::from_bits(*bits) > 0.01),
            "{components}: the sea has no effect"
        );
        for set in &sets[1..] {
            assert!(
                bits_of_waves(components, *set) == want,
                "{components} components, {set:?}"
            );
        }
    }
}

/// The digest of a world after a minute of driving, with these instructions.
fn voyage(scenario: &Scenario, instructions: Instructions) -> u128 {
    let mut world = World::of_game(scenario, 1).unwrap_or_else(|e| panic!("{e}"));
    world.set_instructions(instructions);
    let mut orders = Vec::new();
    for tick in 0..1_200 {
        if tick % 20 == 0 {
            let heading_rad = |i: usize| (f64::from(tick) * 0.02 + i as f64) % 6.0 - 3.0;
            let steer = |i: usize| Order::Steer {
                heading_rad: heading_rad(i),
                speed_m_s: 2.0,
            };
            orders = (0..world.state().boats.len()).map(steer).collect();
        }
        if tick % 2 == 0 {
            world.read_sensors();
        }
        world.step(&orders);
    }
    digest(&world)
}

#[test]
fn a_voyage_has_the_same_bits_with_all_instructions_and_on_every_machine() {
    for (game, sea, pinned) in PINNED {
        let scenario = on_sea(game, sea.as_ref());
        for set in Instructions::of_this_machine() {
            let got = voyage(&scenario, set);
            assert!(got == pinned, "{game} on {sea} with {set:?}: {got:#034x}");
        }
    }
}

/// Recorded once; a different value on any machine is a bug.
const PINNED: [(&str, &str, u128); 3] = [
    (
        "pav01_afloat.toml",
        "fresh_breeze.toml",
        0x8021_ad52_3d8c_3295_63e2_539a_18e8_d69b,
    ),
    (
        "pav01_afloat.toml",
        "bay_gale.toml",
        0x18a1_b4fa_6cc6_b6c3_d6c9_3236_171d_cc1b,
    ),
    (
        "swarm_20v20.toml",
        "fresh_breeze.toml",
        0x292b_2306_3a42_06d4_2dfd_874c_3efa_e6a5,
    ),
];
