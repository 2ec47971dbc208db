//! What a boat does by its own means: settings, station keeping, missions.

use game::Order;
use game::angle::wrap_pi;
use game::frame::Ned;
use std::collections::BTreeMap;

/// A place is reached, or kept, within this distance, m.
const NEAR_M: f64 = 3.0;
/// How fast a boat goes back to its station, m/s at most and per m of distance.
const KEEP_M_S: f64 = 1.0;
const KEEP_PER_S: f64 = 0.2;
/// Throttle of a mission that names none, per cent.
const THROTTLE_PCT: f64 = 40.0;
/// Thrust in per cent and speed in m/s: the thrust map of the West Point missions of 2024.
const THRUST_MAP: [(f64, f64); 6] = [(0.0, 0.0), (20.0, 1.0), (40.0, 1.5), (60.0, 2.0), (70.0, 2.25), (100.0, 3.0)];

/// Where it is going by itself.
#[derive(Clone, Debug, Default)]
pub(super) struct Helm {
    /// By index; 0 is the emergency recovery point.
    places: BTreeMap<u16, Ned>,
    throttle_pct: Option<f64>,
    /// What is being taken up, while it is.
    coming: Option<BTreeMap<u16, Ned>>,
    station: Option<Ned>,
    /// The waypoint that is next.
    next: u16,
    /// Where the boat was when it first did anything: its recovery point until it has another.
    home: Option<Ned>,
}

/// The order for thrust and difference in per cent.
pub(super) fn thrust(thrust_pct: f64, difference_pct: f64) -> Order {
    let share = |pct: f64| (0.01 * pct).clamp(-1.0, 1.0);
    Order::Thrust { port: share(thrust_pct + difference_pct), starboard: share(thrust_pct - difference_pct) }
}

/// The order for a heading and a speed; none of them may be missing.
pub(super) fn steer(heading_rad: Option<f64>, speed_m_s: Option<f64>) -> Order {
    match (heading_rad, speed_m_s) {
        (Some(heading_rad), Some(speed_m_s)) => {
            Order::Steer { heading_rad: wrap_pi(heading_rad), speed_m_s: speed_m_s.clamp(0.0, 100.0) }
        }
        _ => Order::Hold,
    }
}

pub(super) fn m_s_from_kn(speed_kn: f64) -> f64 {
    speed_kn * 1852.0 / 3600.0
}

/// The speed that a thrust gives, m/s.
pub(super) fn speed_of_thrust(thrust_pct: Option<f64>) -> Option<f64> {
    let thrust_pct = thrust_pct?.clamp(0.0, 100.0);
    let pairs = THRUST_MAP.windows(2).map(|pair| (pair[0], pair[1]));
    let (low, high) = pairs.into_iter().find(|(_, high)| thrust_pct <= high.0)?;
    Some(low.1 + (high.1 - low.1) * (thrust_pct - low.0) / (high.0 - low.0))
}

impl Helm {
    /// Something new begins here.
    pub(super) fn begin(&mut self, at: Ned) {
        self.station = Some(at);
        self.next = 1;
        self.home.get_or_insert(at);
    }

    pub(super) fn begin_download(&mut self) {
        self.coming = Some(BTreeMap::new());
    }

    pub(super) fn end_download(&mut self) {
        if let Some(places) = self.coming.take() {
            self.places = places;
        }
    }

    pub(super) fn take_throttle(&mut self, throttle_pct: f64) {
        if self.coming.is_some() {
            self.throttle_pct = Some(throttle_pct);
        }
    }

    /// A place that comes outside of a download is none of the mission's.
    pub(super) fn take_waypoint(&mut self, index: u16, at: Ned) {
        if let Some(coming) = &mut self.coming {
            coming.insert(index, at);
        }
    }

    /// Stays where it began.
    pub(super) fn keep(&mut self, at: Ned) -> Order {
        let station = *self.station.get_or_insert(at);
        let distance_m = at.distance(station);
        if distance_m <= NEAR_M {
            return Order::Hold;
        }
        let speed_m_s = (KEEP_PER_S * distance_m).min(KEEP_M_S);
        Order::Steer { heading_rad: at.bearing_rad(station), speed_m_s }
    }

    /// Goes to the recovery point, and stays there.
    pub(super) fn go_to_erp(&mut self, at: Ned) -> Order {
        let Some(erp) = self.places.get(&0).copied().or(self.home) else { return Order::Hold };
        self.go(at, erp).unwrap_or(Order::Hold)
    }

    /// Sails the mission, and stays at its end.
    pub(super) fn sail(&mut self, at: Ned) -> Order {
        while let Some(place) = self.places.get(&self.next.max(1)).copied() {
            if let Some(order) = self.go(at, place) {
                return order;
            }
            self.next = self.next.max(1) + 1;
            self.station = Some(place);
        }
        self.keep(at)
    }

    /// The way to a place, unless it is reached.
    fn go(&self, at: Ned, place: Ned) -> Option<Order> {
        let speed_m_s = speed_of_thrust(Some(self.throttle_pct.unwrap_or(THROTTLE_PCT)))?;
        (at.distance(place) > NEAR_M).then(|| Order::Steer { heading_rad: at.bearing_rad(place), speed_m_s })
    }
}
