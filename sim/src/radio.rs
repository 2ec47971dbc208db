//! The radio link between the minds ashore and their boats: reports come in late or never, and orders go out so.
//!
//! All of it is drawn from the game's seed, by the number of the message: the same losses in one process and over a
//! network. What the real network does comes on top.

use game::link::Link;
use game::picture::OwnBoat;
use game::stream::Noise;
use game::{Ned, Order, Scenario, SimTime, math};
use std::collections::VecDeque;

/// The most messages of a kind that are under way to one boat or from it.
const MOST_UNDER_WAY: usize = 256;

/// The links of a game.
pub(crate) struct Radio {
    link: Link,
    lines: Vec<Line>,
}

/// The link of one boat.
struct Line {
    noise: Noise,
    /// Messages sent so far, both ways.
    sent: u64,
    is_bad: bool,
    /// When it was last asked whether it is.
    asked: SimTime,
    orders: Way<Order>,
    reports: Way<OwnBoat>,
}

/// Messages in one direction. One that is overtaken by a later one is not taken any more.
struct Way<T> {
    under_way: VecDeque<(SimTime, T)>,
    latest: Option<T>,
}

impl<T: Copy> Way<T> {
    fn new(latest: Option<T>) -> Way<T> {
        Way { under_way: VecDeque::with_capacity(MOST_UNDER_WAY), latest }
    }

    fn send(&mut self, arrival: SimTime, message: T) {
        // What would arrive after this one is overtaken by it.
        while self.under_way.back().is_some_and(|(later, _)| *later >= arrival) {
            self.under_way.pop_back();
        }
        if self.under_way.len() < MOST_UNDER_WAY {
            self.under_way.push_back((arrival, message));
        }
    }

    /// Whether something new has arrived by `now`.
    fn receive(&mut self, now: SimTime) -> bool {
        let mut is_new = false;
        while self.under_way.front().is_some_and(|(arrival, _)| *arrival <= now) {
            self.latest = self.under_way.pop_front().map(|(_, message)| message);
            is_new = true;
        }
        is_new
    }
}

impl Radio {
    /// The links of this scenario in the game that its seed chooses, if it states any. `reports` are what is known ashore
    /// before the game: every boat in its berth.
    pub(crate) fn new(scenario: &Scenario, reports: impl Iterator<Item = OwnBoat>) -> Option<Radio> {
        let link = scenario.link.clone()?;
        let lines = scenario.vehicles.iter().zip(reports).map(|(vehicle, report)| Line {
            noise: Noise::new(scenario.seed, &format!("link/{}", vehicle.name)),
            sent: 0,
            is_bad: false,
            asked: SimTime::ZERO,
            orders: Way::new(None),
            reports: Way::new(Some(report)),
        });
        Some(Radio { lines: lines.collect(), link })
    }

    /// An order goes out to a boat, which is at `at`.
    pub(crate) fn send_order(&mut self, vehicle: usize, order: Order, at: Ned, now: SimTime) {
        let line = &mut self.lines[vehicle];
        if let Some(arrival) = line.arrival(&self.link, at, now) {
            line.orders.send(arrival, order);
        }
    }

    /// The order that arrives at a boat by `now`, if a new one does.
    pub(crate) fn order(&mut self, vehicle: usize, now: SimTime) -> Option<Order> {
        let orders = &mut self.lines[vehicle].orders;
        orders.receive(now).then_some(orders.latest).flatten()
    }

    /// A boat reports from `at`; what is known of it ashore comes back.
    pub(crate) fn report(&mut self, vehicle: usize, report: OwnBoat, at: Ned, now: SimTime) -> OwnBoat {
        let line = &mut self.lines[vehicle];
        if let Some(arrival) = line.arrival(&self.link, at, now) {
            line.reports.send(arrival, report);
        }
        line.reports.receive(now);
        line.reports.latest.unwrap_or(report)
    }
}

impl Line {
    /// When a message sent now arrives, if it does.
    fn arrival(&mut self, link: &Link, at: Ned, now: SimTime) -> Option<SimTime> {
        let draw = 3 * self.sent;
        self.sent += 1;
        self.turn(link, now, self.noise.unit(draw));
        let share = if self.is_bad { link.loss.bad } else { link.loss.good };
        let is_out_of_range = link.range_m.is_some_and(|range_m| at.distance(link.station) > range_m);
        if is_out_of_range || self.noise.unit(draw + 1) < share {
            return None;
        }
        Some(now + SimTime::from_s(link.delay_s + link.jitter_s * self.noise.exponential(draw + 2)))
    }

    /// Lets the link turn good or bad since it was last asked: the two-state Markov chain in continuous time.
    fn turn(&mut self, link: &Link, now: SimTime, draw: f64) {
        if link.loss.good_time_s <= 0.0 {
            return;
        }
        let (to_bad, to_good) = (1.0 / link.loss.good_time_s, 1.0 / link.loss.bad_time_s);
        let settled = to_bad / (to_bad + to_good);
        let left = math::exp(-(to_bad + to_good) * (now.as_s() - self.asked.as_s()));
        let bad_chance = settled + (f64::from(u8::from(self.is_bad)) - settled) * left;
        self.is_bad = draw < bad_chance;
        self.asked = now;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::VehicleId;
    use game::link::Loss;
    use game::picture::{Imu, Nav};

    const TENTH: SimTime = SimTime(100_000_000);

    fn boat(north_m: f64) -> OwnBoat {
        OwnBoat {
            vehicle: VehicleId(0),
            nav: Nav { north_m, ..Nav::default() },
            fix_ns: SimTime::ZERO,
            imu: Imu::default(),
            tagged: false,
            carrying: -1,
            disabled: false,
            outside: false,
            tag_ready_ns: SimTime::ZERO,
        }
    }

    fn radio(link: Link) -> Radio {
        let line = Line {
            noise: Noise::new(3, "link/test"),
            sent: 0,
            is_bad: false,
            asked: SimTime::ZERO,
            orders: Way::new(None),
            reports: Way::new(Some(boat(-1.0))),
        };
        Radio { link, lines: vec![line] }
    }

    fn link() -> Link {
        Link { delay_s: 0.25, jitter_s: 0.0, loss: Loss::default(), range_m: None, station: Ned::default() }
    }

    #[test]
    fn what_is_sent_arrives_after_the_delay_and_not_before() {
        let mut radio = radio(link());
        for k in 0..50_i64 {
            let now = TENTH * k;
            let known = radio.report(0, boat(k as f64), Ned::default(), now).nav.north_m;
            // Sent at (k - 3) tenths, arrived 0.05 s ago; the berth before that.
            assert_eq!(known, if k < 3 { -1.0 } else { (k - 3) as f64 }, "at {k}");
            radio.send_order(0, Order::Steer { heading_rad: 0.0, speed_m_s: k as f64 }, Ned::default(), now);
            let arrived = radio.order(0, now);
            let want = (k >= 3).then_some(Order::Steer { heading_rad: 0.0, speed_m_s: (k - 3) as f64 });
            assert_eq!(arrived, want, "at {k}");
        }
    }

    #[test]
    fn nothing_passes_out_of_range() {
        let mut radio = radio(Link { range_m: Some(100.0), delay_s: 0.0, ..link() });
        for k in 1..200_i64 {
            let at = Ned { north: k as f64, east: 0.0 };
            let known = radio.report(0, boat(k as f64), at, TENTH * k).nav.north_m;
            assert_eq!(known, k.min(100) as f64);
        }
    }

    #[test]
    fn losses_come_in_bursts_of_the_stated_share_and_length() {
        let loss = Loss { good: 0.01, bad: 0.6, good_time_s: 8.0, bad_time_s: 2.0 };
        let mut radio = radio(Link { delay_s: 0.0, loss, ..link() });
        let n = 400_000_i64;
        let (mut lost, mut bad, mut turns) = (0.0, 0.0, 0.0);
        let mut was_bad = false;
        for k in 0..n {
            let line = &mut radio.lines[0];
            let arrived = line.arrival(&radio.link, Ned::default(), TENTH * k).is_some();
            lost += f64::from(u8::from(!arrived));
            bad += f64::from(u8::from(line.is_bad));
            turns += f64::from(u8::from(line.is_bad && !was_bad));
            was_bad = line.is_bad;
        }
        let n = n as f64;
        // Closed forms: bad for 2 of 10 s; a stay seen at every tenth of a second lasts tenth / (1 - stay).
        assert!((bad / n - 0.2).abs() < 0.01, "{}", bad / n);
        assert!((lost / n - (0.8 * 0.01 + 0.2 * 0.6)).abs() < 0.005, "{}", lost / n);
        let leave = (1.0 - math::exp(-0.1 * (0.125 + 0.5))) * 0.8;
        assert!((bad / turns / (1.0 / leave) - 1.0).abs() < 0.05, "{} {}", bad / turns, 1.0 / leave);
    }

    #[test]
    fn an_order_that_is_overtaken_is_not_obeyed() {
        let mut radio = radio(Link { delay_s: 0.0, jitter_s: 0.5, ..link() });
        let mut last = -1.0;
        for k in 0..2_000_i64 {
            let now = TENTH * k;
            radio.send_order(0, Order::Steer { heading_rad: 0.0, speed_m_s: k as f64 }, Ned::default(), now);
            if let Some(Order::Steer { speed_m_s, .. }) = radio.order(0, now) {
                assert!(speed_m_s > last, "{speed_m_s} after {last}");
                last = speed_m_s;
            }
        }
        assert!(last > 1_900.0);
    }
}
