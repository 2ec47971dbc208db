//! Turns the recent requests of a boat's MOOS applications into its order.

use crate::wire::Msg;
use messages::Order;
use messages::refusal::{Refusal, Refusals};
use primitives::SimTime;
use primitives::angle::rad_from_compass_deg;

/// The variables with which MOOS applications control their boat.
pub(crate) const READS: [&str; 10] = [
    "DESIRED_HEADING",
    "DESIRED_SPEED",
    "DESIRED_THRUST",
    "DESIRED_RUDDER",
    "DESIRED_THRUST_L",
    "DESIRED_THRUST_R",
    "DEPLOY",
    "MOOS_MANUAL_OVERRIDE",
    // The spelling of older applications.
    "MOOS_MANUAL_OVERIDE",
    "IVPHELM_ALLSTOP",
];

/// Variables whose presence shows that a boat has a helm or a controller.
pub(crate) const HELM: [&str; 7] = [
    "IVPHELM_STATE",
    READS[0],
    READS[1],
    READS[2],
    READS[3],
    READS[4],
    READS[5],
];

/// A number and the time of its arrival.
#[derive(Clone, Copy, Debug)]
struct Desired {
    value: f64,
    at: SimTime,
}

/// The newest requests of the applications of one boat.
#[derive(Clone, Debug, Default)]
pub(crate) struct BackSeat {
    /// The newest requests in the first six variables of [`READS`], in that order.
    desired: [Option<Desired>; 6],
    /// `DEPLOY` is false: the boat must not move.
    is_undeployed: bool,
    /// A person has overridden the helm.
    is_overridden: bool,
    /// Why the helm has stopped the boat, if it has.
    all_stop: Option<String>,
    /// Counts of unusable requests.
    pub(crate) refusals: Refusals,
}

impl BackSeat {
    /// Receives a value. Returns whether its variable is one of [`READS`].
    pub(crate) fn receive(&mut self, msg: &Msg, now: SimTime) -> bool {
        let Some(place) = READS.iter().position(|name| *name == msg.key) else {
            return false;
        };
        match READS[place] {
            "DEPLOY" => self.switch(msg.as_bool(), |seat, is_on| seat.is_undeployed = !is_on),
            "MOOS_MANUAL_OVERRIDE" | "MOOS_MANUAL_OVERIDE" => {
                self.switch(msg.as_bool(), |seat, is_on| seat.is_overridden = is_on);
            }
            "IVPHELM_ALLSTOP" => {
                let reason = msg.as_text().unwrap_or("unreadable").trim();
                self.all_stop = (!reason.eq_ignore_ascii_case("clear")).then(|| reason.to_owned());
            }
            _ => {
                let value = msg.as_number().filter(|value| value.is_finite());
                self.refusals
                    .add(Refusal::BadNumber, u64::from(value.is_none()));
                // An unreadable request ends the previous one: the boat holds.
                self.desired[place] = value.map(|value| Desired { value, at: now });
            }
        }
        true
    }

    fn switch(&mut self, is_on: Option<bool>, set: impl FnOnce(&mut BackSeat, bool)) {
        match is_on {
            Some(is_on) => set(self, is_on),
            None => self.refusals.count(Refusal::Garbage),
        }
    }

    /// The current order: thrust and rudder take precedence over heading and speed, because they
    /// are the output of a controller that follows the helm's heading and speed. Without a complete
    /// pair of requests younger than `ttl_s`, the boat holds.
    pub(crate) fn order(&mut self, now: SimTime, ttl_s: f64) -> Order {
        if self.is_undeployed || self.is_overridden || self.all_stop.is_some() {
            return Order::Hold;
        }
        let recent = |place: usize| {
            self.desired[place]
                .filter(|desired| (now - desired.at).as_s() <= ttl_s)
                .map(|desired| desired.value)
        };
        let share = |percent: f64| (percent / 100.0).clamp(-1.0, 1.0);
        let order = match [0, 1, 2, 3, 4, 5].map(recent) {
            [.., Some(left), Some(right)] => Order::Thrust {
                port: share(left),
                starboard: share(right),
            },
            [_, _, Some(thrust), Some(rudder), ..] => Order::Thrust {
                port: share(thrust + rudder),
                starboard: share(thrust - rudder),
            },
            [Some(heading_deg), Some(speed_m_s), ..] => Order::Steer {
                heading_rad: rad_from_compass_deg(heading_deg),
                speed_m_s,
            },
            _ => Order::Hold,
        };
        order.check().unwrap_or_else(|_| {
            self.refusals.count(Refusal::BadNumber);
            Order::Hold
        })
    }

    /// The mode in the boat's node report: why the boat must hold whatever is requested, or
    /// `DRIVE`.
    pub(crate) fn mode(&self) -> &str {
        match self {
            BackSeat {
                is_overridden: true,
                ..
            } => "MANUAL",
            BackSeat {
                is_undeployed: true,
                ..
            } => "PARK",
            BackSeat {
                all_stop: Some(_), ..
            } => "ALLSTOP",
            _ => "DRIVE",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Kind;
    use std::f64::consts::FRAC_PI_2;

    fn seat(values: &[(&str, f64)]) -> BackSeat {
        let mut seat = BackSeat::default();
        for (key, value) in values {
            assert!(
                seat.receive(&Msg::number(Kind::NOTIFY, key, *value, 0.0), SimTime::ZERO),
                "{key}"
            );
        }
        seat
    }

    fn order(values: &[(&str, f64)]) -> Order {
        seat(values).order(SimTime::ZERO, 1.0)
    }

    const EAST: Order = Order::Steer {
        heading_rad: FRAC_PI_2,
        speed_m_s: 1.5,
    };
    const COURSE: [(&str, f64); 2] = [("DESIRED_HEADING", 90.0), ("DESIRED_SPEED", 1.5)];

    #[test]
    fn requests_become_orders_and_a_controllers_output_comes_before_its_input() {
        let thrust = |port, starboard| Order::Thrust { port, starboard };
        let pid = |thrust, rudder| {
            [
                COURSE.to_vec(),
                vec![("DESIRED_THRUST", thrust), ("DESIRED_RUDDER", rudder)],
            ]
            .concat()
        };
        for (values, want) in [
            (COURSE.to_vec(), EAST),
            (COURSE[..1].to_vec(), Order::Hold),
            (pid(50.0, 25.0), thrust(0.75, 0.25)),
            (pid(100.0, -40.0), thrust(0.6, 1.0)),
            (pid(0.0, 0.0)[..3].to_vec(), EAST),
            (
                vec![("DESIRED_THRUST_L", -30.0), ("DESIRED_THRUST_R", 200.0)],
                thrust(-0.3, 1.0),
            ),
            (
                vec![("DESIRED_HEADING", 90.0), ("DESIRED_SPEED", -1.0)],
                Order::Hold,
            ),
            (
                vec![("DESIRED_HEADING", f64::NAN), ("DESIRED_SPEED", 1.0)],
                Order::Hold,
            ),
            (
                vec![("DESIRED_HEADING", 1e9), ("DESIRED_SPEED", f64::INFINITY)],
                Order::Hold,
            ),
        ] {
            assert_eq!(order(&values), want, "{values:?}");
        }
        let refused = |values: &[(&str, f64)]| {
            let mut seat = seat(values);
            seat.order(SimTime::ZERO, 1.0);
            seat.refusals.of(Refusal::BadNumber)
        };
        assert_eq!(refused(&COURSE), 0);
        assert_eq!(
            refused(&[("DESIRED_HEADING", 0.0), ("DESIRED_SPEED", -1.0)]),
            1
        );
        assert_eq!(refused(&[("DESIRED_HEADING", f64::NAN)]), 1);
    }

    #[test]
    fn a_silent_helm_a_person_and_an_all_stop_stop_the_boat() {
        let mut seat = seat(&COURSE);
        let at = |s: f64| SimTime((s * 1e9) as i64);
        assert_eq!(
            [seat.order(at(1.0), 1.0), seat.order(at(1.1), 1.0)],
            [EAST, Order::Hold]
        );
        for (key, stops, goes) in [
            ("DEPLOY", "false", "true"),
            ("MOOS_MANUAL_OVERRIDE", "true", "false"),
            ("MOOS_MANUAL_OVERIDE", "true", "false"),
            ("IVPHELM_ALLSTOP", "ManualOverride", "clear"),
        ] {
            for (value, want) in [
                (stops, Order::Hold),
                ("nonsense", Order::Hold),
                (goes, EAST),
            ] {
                seat.receive(&Msg::text(Kind::NOTIFY, key, value, 0.0), SimTime::ZERO);
                assert_eq!(
                    (seat.order(SimTime::ZERO, 1.0), seat.mode() == "DRIVE"),
                    (want, want == EAST),
                    "{key} {value}"
                );
            }
        }
        assert_eq!(
            seat.refusals.of(Refusal::Garbage),
            3,
            "nonsense changes nothing"
        );
        assert!(!seat.receive(&Msg::number(Kind::NOTIFY, "NAV_X", 1.0, 0.0), SimTime::ZERO));
    }
}
