//! The point boats of Pyquaticus (main, 2025-11): Heron, Surveyor and LargeUSV.

use game::boat::{Kinematic, Pid};

const fn pid(p: f64, i: f64, d: f64, i_limit: f64) -> Pid {
    Pid { p, i, d, i_limit }
}

/// What they inherit unless they say otherwise.
fn base() -> Kinematic {
    Kinematic {
        speed_max_m_s: 5.0,
        thrust_map: vec![(0.0, 0.0), (100.0, 5.0)],
        thrust_max: 100.0,
        rudder_max: 100.0,
        turn_rate: 70.0,
        turn_loss: 0.85,
        rotate_rad_s: 0.0,
        acceleration_max_m_s2: 0.0,
        deceleration_max_m_s2: 0.5,
        speed_factor: 0.0,
        speed_pid: pid(0.8, 0.11, 0.1, 0.07),
        heading_pid: pid(0.5, 0.012, 0.1, 0.2),
    }
}

pub(crate) fn heron_kinematic() -> Kinematic {
    Kinematic {
        speed_max_m_s: 2.0,
        thrust_map: vec![(0.0, 0.0), (40.0, 1.0), (100.0, 2.0)],
        turn_rate: 60.0,
        speed_pid: pid(1.0, 0.0, 0.0, 0.07),
        heading_pid: pid(0.9, 0.0, 0.6, 0.3),
        ..base()
    }
}

pub(crate) fn surveyor_kinematic() -> Kinematic {
    Kinematic {
        speed_max_m_s: 3.0,
        thrust_map: vec![(-100.0, -2.0), (0.0, 0.0), (20.0, 1.0), (40.0, 1.5), (60.0, 2.0), (70.0, 2.25), (100.0, 3.0)],
        turn_rate: 10.0,
        acceleration_max_m_s2: 0.15,
        deceleration_max_m_s2: 0.25,
        speed_pid: pid(0.5, 0.0, 0.0, 0.0),
        heading_pid: pid(1.2, 0.0, 3.0, 0.0),
        ..base()
    }
}

/// It sets thrust from the speed directly, and with 70 % at most: 10.5 m/s, although it accepts 12.
pub(crate) fn large_usv_kinematic() -> Kinematic {
    Kinematic {
        speed_max_m_s: 12.0,
        thrust_map: vec![
            (-100.0, -3.0),
            (0.0, 0.0),
            (20.0, 3.0),
            (40.0, 6.0),
            (60.0, 9.0),
            (80.0, 12.0),
            (100.0, 12.0),
        ],
        thrust_max: 70.0,
        turn_rate: 50.0,
        acceleration_max_m_s2: 0.5,
        speed_factor: 20.0 / 3.0,
        heading_pid: pid(0.35, 0.0, 0.07, 0.07),
        ..base()
    }
}
