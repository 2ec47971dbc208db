//! Scenes: a program, a boat's picture, and the decision.

use agent::{HelmMind, Mind};
use messages::Order;
use messages::helm::HelmReport;
use messages::picture::{Contact, FlagView, Nav, OwnBoat, Picture};
use primitives::{Ned, SimTime, TeamId, VehicleId};
use scenario::Scenario;
use std::path::Path;

/// The scenario in which all boats follow the program `strategy`: two against two on the test
/// field.
pub(crate) fn scenario(strategy: &str) -> Scenario {
    let game = include_str!("game.toml");
    let field = include_str!("field.toml");
    loaded(&[
        ("game.toml", game),
        ("field.toml", field),
        ("strategy.toml", strategy),
    ])
}

/// The scenario of `game.toml` among these files, in which `SCENARIOS` is replaced with the folder
/// of the shipped files.
pub(crate) fn loaded(files: &[(&str, &str)]) -> Scenario {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenarios")
        .display()
        .to_string();
    for (name, text) in files {
        let text = text.replace("SCENARIOS", &scenarios);
        std::fs::write(folder.path().join(name), text).expect("the file can be written");
    }
    scenario::load(&folder.path().join("game.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// `program` without the mandatory safety behaviours.
pub(crate) fn unsafely(program: &str) -> String {
    format!("unsafe_i_know = true\nunsafe_because = \"tests a behaviour alone\"\n{program}")
}

/// The scenario in which all boats follow a program without the mandatory safety behaviours.
pub(crate) fn without_safety(program: &str) -> Scenario {
    scenario(&unsafely(program))
}

/// A program with one behaviour and negligible other preferences.
pub(crate) fn only(behaviour: &str) -> Scenario {
    without_safety(&format!(
        "[behaviour.it]\n{behaviour}\n\
         [behaviour.head]\nkind = \"constant_heading\"\nheading_deg = 0\nweight = 0.01\n\
         [behaviour.speed]\nkind = \"constant_speed\"\nspeed_m_s = 2\nweight = 0.01\n"
    ))
}

/// Positions and motion in the units of files: x east, y north, compass degrees, m/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Boat {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) heading_deg: f64,
    pub(crate) speed_m_s: f64,
}

impl Boat {
    pub(crate) fn at(x: f64, y: f64) -> Boat {
        Boat {
            x,
            y,
            heading_deg: 0.0,
            speed_m_s: 0.0,
        }
    }

    pub(crate) fn going(self, heading_deg: f64, speed_m_s: f64) -> Boat {
        Boat {
            heading_deg,
            speed_m_s,
            ..self
        }
    }

    fn nav(self) -> Nav {
        Nav {
            north_m: self.y,
            east_m: self.x,
            psi_rad: primitives::angle::rad_from_compass_deg(self.heading_deg),
            surge_m_s: self.speed_m_s,
            ..Nav::default()
        }
    }

    pub(crate) fn own(self, vehicle: u16) -> OwnBoat {
        OwnBoat::new(VehicleId(vehicle), self.nav())
    }

    pub(crate) fn contact(self, vehicle: u16, seen: SimTime) -> Contact {
        let towards = Ned::toward_deg(self.heading_deg).scaled(self.speed_m_s);
        Contact {
            vehicle: VehicleId(vehicle),
            team: TeamId(1),
            seen_ns: seen,
            north_m: self.y,
            east_m: self.x,
            psi_rad: primitives::angle::rad_from_compass_deg(self.heading_deg),
            velocity_north_m_s: towards.north,
            velocity_east_m_s: towards.east,
            tagged: false,
            carrying: -1,
        }
    }
}

/// Blue's picture at a time: its boats 0 and 1, and red's 2 and 3.
pub(crate) fn picture(at_s: f64, [one, two]: [Boat; 2], [three, four]: [Boat; 2]) -> Picture {
    let now = SimTime::from_s(at_s);
    let mut picture = Picture {
        own: vec![one.own(0), two.own(1)],
        contacts: vec![three.contact(2, now), four.contact(3, now)],
        flags: vec![FlagView { carrier: -1 }; 2],
        score: vec![0, 0],
        ..Picture::default()
    };
    set_time(&mut picture, at_s);
    picture
}

/// Moves a picture and its fixes to a time.
pub(crate) fn set_time(picture: &mut Picture, at_s: f64) {
    let now = SimTime::from_s(at_s);
    picture.stamp.valid_ns = now;
    picture.own.iter_mut().for_each(|boat| boat.fix_ns = now);
}

/// A picture of a boat far from all other boats.
pub(crate) fn alone(at_s: f64, own: Boat) -> Picture {
    picture(
        at_s,
        [own, Boat::at(-75.0, -35.0)],
        [Boat::at(75.0, 35.0), Boat::at(75.0, -35.0)],
    )
}

/// The helm of boat 0.
pub(crate) fn helm(scenario: &Scenario) -> HelmMind {
    HelmMind::new(
        scenario,
        VehicleId(0),
        agent::roles::role_of(scenario, VehicleId(0)),
    )
}

/// The helm's report after this picture.
pub(crate) fn decided(helm: &mut HelmMind, picture: &Picture) -> HelmReport {
    let order = helm.decide(picture);
    let report = helm.report().expect("a helm has a report");
    match (order, report.course_deg.zip(report.speed_m_s)) {
        (
            Order::Steer {
                heading_rad,
                speed_m_s,
            },
            Some((course_deg, reported_m_s)),
        ) => {
            let off_deg =
                wrap_180(heading_rad.to_degrees() + report.heading_offset_deg - course_deg);
            // For nearly half a turn an intermediate heading is ordered.
            let psi_deg = picture.own[0].nav.psi_rad.to_degrees();
            let is_large = wrap_180(course_deg - psi_deg).abs() > 120.0;
            assert!(
                is_large || off_deg.abs() < 1e-6 && speed_m_s == reported_m_s,
                "{order:?}, {report:?}"
            );
        }
        (Order::Hold, None) => assert!(report.hold.is_some(), "{report:?}"),
        _ => panic!("{order:?}, but the report says {report:?}"),
    }
    report
}

/// The course (degrees) and speed (m/s) on which the helm decides.
pub(crate) fn steered(helm: &mut HelmMind, picture: &Picture) -> (f64, f64) {
    let report = decided(helm, picture);
    report
        .course_deg
        .zip(report.speed_m_s)
        .expect("the helm steers")
}

fn wrap_180(angle_deg: f64) -> f64 {
    primitives::angle::wrap_pi(angle_deg.to_radians()).to_degrees()
}
