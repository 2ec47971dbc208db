//! Monitors the wire of a game and checks it at every frame.

use crate::plan::Plan;
use messages::external::ExternalOrder;
use messages::{Frame, Order, Orders};
use primitives::{SimTime, codec};
use scenario::Scenario;
use sim::node::Pace;
use simulated_network::Published;
use std::time::Duration;

/// Simulated time within which a boat that must hold has stopped its thrusters: they change by a
/// fifth of their range per second, with a lag of 0.25 s.
const SETTLES_S: f64 = 6.5;
/// Maximum time between reports of a real boat that has joined, whatever the pauses.
const UNREPORTED: Duration = Duration::from_secs(2);
/// Maximum thrust of a boat that holds, N.
const RESTS_NEWTON: f64 = 1.0;
/// Time after a tag for which the rules may drive a boat.
const DRIVEN_S: f64 = 5.0;

/// One boat as observed on the wire.
#[derive(Clone, Debug)]
struct Boat {
    /// The time of the picture that its newest order answers.
    ordered: SimTime,
    /// When its agent was lost, in simulated time.
    lost_since: Option<SimTime>,
    /// When the rules were last seen to drive it.
    driven: SimTime,
}

/// The state of the checks.
#[derive(Clone, Debug)]
pub(crate) struct WireMonitor {
    boats: Vec<Boat>,
    order_ttl_s: f64,
    expires: bool,
    /// When each boat was first and last seen without an agent.
    pub(crate) lost: Vec<Option<(Duration, Duration)>>,
    /// When the first and the last frame of the game arrived.
    pub(crate) frames: Option<(Duration, Duration)>,
    /// When the real boat must be back; `None` if there is none or it is lost for good.
    is_back: Option<Duration>,
    /// When the real boat was last reported.
    reported: Duration,
    /// The errors found.
    pub(crate) wrong: Vec<String>,
}

impl WireMonitor {
    pub(crate) fn new(scenario: &Scenario, plan: &Plan) -> WireMonitor {
        let boat = Boat {
            ordered: SimTime::ZERO,
            lost_since: None,
            driven: SimTime::LONG_AGO,
        };
        WireMonitor {
            boats: vec![boat; scenario.vehicles.len()],
            order_ttl_s: scenario.order_ttl_s,
            expires: plan.pace != Pace::Lockstep && !plan.forges(),
            lost: vec![None; scenario.vehicles.len()],
            frames: None,
            is_back: plan.real_boat_is_back(),
            reported: Duration::ZERO,
            wrong: vec![],
        }
    }

    pub(crate) fn see(&mut self, published: Published<'_>) {
        if published.key.contains("/order/") {
            let Ok(orders) = codec::decode::<Orders>(published.bytes) else {
                return;
            };
            for order in &orders.orders {
                if let Some(boat) = self.boats.get_mut(order.vehicle.index()) {
                    boat.ordered = boat.ordered.max(orders.stamp.valid_ns);
                }
            }
        } else if published.key.contains("/nav/") {
            self.reported = published.at;
        } else if published.key.contains("/external/") {
            let order: ExternalOrder =
                codec::decode(published.bytes).expect("the sim publishes orders");
            self.check_external_order(&order);
        } else if published.key.ends_with("/frame") {
            let frame: Frame = codec::decode(published.bytes).expect("the sim publishes frames");
            self.check_frame(published.at, &frame);
        }
    }

    /// A real boat never receives an expired order.
    fn check_external_order(&mut self, external: &ExternalOrder) {
        let ExternalOrder {
            stamp,
            given_ns,
            order,
            ..
        } = external;
        let age_s = (stamp.valid_ns - *given_ns).as_s();
        // The rules drive a boat home by themselves while its agent is connected; even then, the
        // order must be fresh.
        if age_s > self.order_ttl_s && order.order() != Some(Order::Hold) {
            self.wrong.push(format!(
                "at {} an order {age_s:.2} s old is sent to a real boat",
                stamp.valid_ns
            ));
        }
    }

    fn check_frame(&mut self, at: Duration, frame: &Frame) {
        let now = frame.stamp.valid_ns;
        self.frames = Some((self.frames.map_or(at, |(first, _)| first), at));
        if self
            .is_back
            .is_some_and(|back| at > back + UNREPORTED && at > self.reported + UNREPORTED)
        {
            self.wrong.push(format!(
                "at {at:?} the real boat has not been reported since {:?}",
                self.reported
            ));
            self.is_back = None;
        }
        for i in 0..self.boats.len() {
            let truth = &frame.vehicles[i];
            if truth.agent_lost {
                self.lost[i] = Some((self.lost[i].map_or(at, |(first, _)| first), at));
            }
            let boat = &mut self.boats[i];
            boat.lost_since = boat
                .lost_since
                .filter(|_| truth.agent_lost)
                .or(truth.agent_lost.then_some(now));
            if truth.tagged || truth.disabled || truth.outside {
                boat.driven = now;
            }
            let thrust = truth.port_newton.abs() + truth.starboard_newton.abs();
            let rests = thrust <= RESTS_NEWTON;
            if let Some(reason) = self.boats[i].must_rest(now, self.order_ttl_s, self.expires)
                && !rests
            {
                self.wrong.push(format!(
                    "at {now} boat {i} has {thrust:.1} N although {reason}"
                ));
            }
        }
    }
}

impl Boat {
    /// Why this boat must rest now, if it must.
    fn must_rest(&self, now: SimTime, order_ttl_s: f64, expires: bool) -> Option<String> {
        if (now - self.driven).as_s() < DRIVEN_S {
            return None;
        }
        let lost_s = self.lost_since.map_or(0.0, |since| (now - since).as_s());
        if lost_s > SETTLES_S {
            return Some(format!("its agent has been lost for {lost_s:.1} s"));
        }
        let age_s = (now - self.ordered).as_s();
        (expires && age_s > order_ttl_s + SETTLES_S)
            .then(|| format!("its newest order is {age_s:.1} s old"))
    }
}
