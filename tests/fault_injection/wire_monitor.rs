//! What the wire showed of a game, and what must hold of it at every frame.

use crate::plan::Plan;
use messages::external::ExternalOrder;
use messages::{Frame, Order, Orders, VehicleTruth};
use primitives::{SimTime, codec};
use scenario::Scenario;
use sim::node::Pace;
use simulated_network::Published;
use std::time::Duration;

/// A boat that is to hold has stopped its thrusters after this much of the game: they take a fifth of their range a second,
/// with a lag of 0.25 s.
const SETTLES_S: f64 = 6.5;
/// A real boat that has joined is reported at least this often, whatever the pauses.
const UNREPORTED: Duration = Duration::from_secs(2);
/// Thrust of a boat that holds, N.
const RESTS_NEWTON: f64 = 1.0;
/// After a tag the rules may drive a boat for this long.
const DRIVEN_S: f64 = 5.0;

/// One boat, as the wire shows it.
#[derive(Clone, Debug)]
struct Boat {
    /// The time of the picture that its newest order answers.
    ordered: SimTime,
    /// Since when its agent has been lost, in the time of the game.
    lost_since: Option<SimTime>,
    /// When the rules were last seen to drive it.
    driven: SimTime,
}

/// Everything that the checks need to know.
#[derive(Clone, Debug)]
pub(crate) struct WireMonitor {
    boats: Vec<Boat>,
    order_ttl_s: f64,
    expires: bool,
    /// When each boat was seen without an agent, first and last.
    pub(crate) lost: Vec<Option<(Duration, Duration)>>,
    /// When the first frame of the game came, and the last.
    pub(crate) frames: Option<(Duration, Duration)>,
    /// From when on the real boat must be there, if there is one that is not lost for good.
    is_back: Option<Duration>,
    /// When it was reported last.
    reported: Duration,
    /// What must not be.
    pub(crate) wrong: Vec<String>,
}

impl WireMonitor {
    pub(crate) fn new(scenario: &Scenario, plan: &Plan) -> WireMonitor {
        let boat = Boat { ordered: SimTime::ZERO, lost_since: None, driven: SimTime::LONG_AGO };
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
            let Ok(orders) = codec::decode::<Orders>(published.bytes) else { return };
            for order in &orders.orders {
                if let Some(boat) = self.boats.get_mut(order.vehicle.index()) {
                    boat.ordered = boat.ordered.max(orders.stamp.valid_ns);
                }
            }
        } else if published.key.contains("/nav/") {
            self.reported = published.at;
        } else if published.key.contains("/external/") {
            let order: ExternalOrder = codec::decode(published.bytes).expect("the sim publishes orders");
            self.check_external_order(&order);
        } else if published.key.ends_with("/frame") {
            let frame: Frame = codec::decode(published.bytes).expect("the sim publishes frames");
            self.check_frame(published.at, &frame);
        }
    }

    /// A real boat never gets an order that has expired.
    fn check_external_order(&mut self, external: &ExternalOrder) {
        let ExternalOrder { stamp, given_ns, order } = external;
        let age_s = (stamp.valid_ns - *given_ns).as_s();
        // The rules drive a boat home by themselves, as long as somebody looks: then too the order must be young.
        if age_s > self.order_ttl_s && order.order() != Some(Order::Hold) {
            self.wrong.push(format!("at {} an order {age_s:.2} s old goes to a real boat", stamp.valid_ns));
        }
    }

    fn check_frame(&mut self, at: Duration, frame: &Frame) {
        let now = frame.stamp.valid_ns;
        self.frames = Some((self.frames.map_or(at, |(first, _)| first), at));
        if self.is_back.is_some_and(|back| at > back + UNREPORTED && at > self.reported + UNREPORTED) {
            self.wrong.push(format!("at {at:?} the real boat is not reported since {:?}", self.reported));
            self.is_back = None;
        }
        for i in 0..self.boats.len() {
            let truth = &frame.vehicles[i];
            if truth.agent_lost {
                self.lost[i] = Some((self.lost[i].map_or(at, |(first, _)| first), at));
            }
            let boat = &mut self.boats[i];
            boat.lost_since = boat.lost_since.filter(|_| truth.agent_lost).or(truth.agent_lost.then_some(now));
            if truth.tagged || truth.disabled || truth.outside {
                boat.driven = now;
            }
            if let Some(reason) = self.boats[i].must_rest(now, self.order_ttl_s, self.expires)
                && !rests(truth)
            {
                let thrust = truth.port_newton.abs() + truth.starboard_newton.abs();
                self.wrong.push(format!("at {now} boat {i} has {thrust:.1} N although {reason}"));
            }
        }
    }
}

fn rests(truth: &VehicleTruth) -> bool {
    truth.port_newton.abs() + truth.starboard_newton.abs() <= RESTS_NEWTON
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
        (expires && age_s > order_ttl_s + SETTLES_S).then(|| format!("its newest order is {age_s:.1} s old"))
    }
}
