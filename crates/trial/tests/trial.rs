//! A boat in a trial behaves like a boat in a game: same model, same sea.

use messages::Order;
use primitives::{Ned, Pose, SimTime};
use scenario::Scenario;
use sim::World;
use std::path::Path;
use trial::{Command, Start, TrialBoat};

fn scenarios() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

/// A game whose first boat is this one, at the datum pointing north, on this sea.
fn game_of(boat: &scenario::Boat, sea: &scenario::sea::Sea, tick: SimTime) -> Scenario {
    let mut game = scenario::load(&scenarios().join("games/attack_1v1.toml"))
        .unwrap_or_else(|e| panic!("{e}"));
    (game.tick, game.sea) = (tick, sea.clone());
    game.boats.push(boat.clone());
    game.vehicles[0].boat = game.boats.len() - 1;
    game.vehicles[0].start_position = scenario::StartPosition::At(Pose {
        at: Ned::from_xy(10.0, 40.0),
        psi_rad: 0.0,
    });
    game
}

#[test]
fn a_trial_sails_as_a_game_does() {
    let mut sea = trial::still_sea();
    trial::set_mean_current(&mut sea, 0.3, 120.0);
    for (name, tick_s) in [
        ("surveyor_m1_8", 0.05),
        ("surveyor_kinematic", 0.1),
        ("heron_kinematic", 0.1),
    ] {
        let boat =
            scenario::load_file::<scenario::Boat>(&scenarios().join(format!("boats/{name}.toml")))
                .unwrap_or_else(|e| panic!("{e}"));
        let tick = SimTime::from_s(tick_s);
        let mut world = World::of_game(&game_of(&boat, &sea, tick), 1).expect("there is room");
        let mut trial_boat = TrialBoat::new(&boat, &sea, tick, 1, &Start::default());
        let start = world.state().boats[0].pose.at;
        for second in 0..20 {
            let heading_rad = 0.1 * f64::from(second);
            let speed_m_s = 1.5;
            for _ in 0..(1.0 / tick_s).round() as u32 {
                world.step(&[
                    Order::Steer {
                        heading_rad,
                        speed_m_s,
                    },
                    Order::Hold,
                ]);
                trial_boat.step(Command::Steer {
                    heading_rad,
                    speed_m_s,
                });
            }
            let game = world.state().boats[0];
            let trial = trial_boat.sample(0.0, Command::Hold);
            let apart_m = (game.pose.at - start).distance(trial.at);
            assert!(apart_m < 1e-9, "{name} after {second} s: {apart_m} m apart");
            assert!(
                (game.pose.psi_rad - trial.psi_rad).abs() < 1e-9,
                "{name} after {second} s"
            );
            let a = game.nu;
            let b = trial.nu;
            let off = (a.surge - b.surge).abs() + (a.sway - b.sway).abs() + (a.yaw - b.yaw).abs();
            assert!(off < 1e-9, "{name} after {second} s: {a:?} and {b:?}");
        }
    }
}

#[test]
fn a_trial_does_not_end_at_the_edge_of_the_field() {
    let boat = scenario::load_file::<scenario::Boat>(&scenarios().join("boats/surveyor_m1_8.toml"))
        .unwrap_or_else(|e| panic!("{e}"));
    let mut trial_boat = TrialBoat::new(
        &boat,
        &trial::still_sea(),
        SimTime::from_s(0.05),
        1,
        &Start::default(),
    );
    for _ in 0..20_000 {
        trial_boat.step(Command::Steer {
            heading_rad: 0.0,
            speed_m_s: 2.0,
        });
    }
    let end = trial_boat.sample(1000.0, Command::Hold);
    assert!(
        end.at.north > 1980.0 && (end.nu.surge - 2.0).abs() < 0.01,
        "{end:?}"
    );
}
