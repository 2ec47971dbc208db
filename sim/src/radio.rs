//! The radio link between minds on shore and their boats: delays and losses of reports and orders.
//!
//! All random values derive from the seed, by vehicle, direction and decision. Losses are therefore
//! the same in one process and over a network, whatever else is sent. Delays and losses of the real
//! network are added to these.

use crate::two_state::TwoStateChain;
use messages::Order;
use messages::picture::OwnBoat;
use primitives::reseed::TimedNoise;
use primitives::{Ned, SimTime};
use scenario::Scenario;
use scenario::link::Link;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Upper bound of [`primitives::stream::Noise::exponential`]: 53 ln 2, rounded up.
const MOST_JITTERS: f64 = 37.0;
/// Uniform numbers per decision: the link's change of state, and loss and jitter in both
/// directions.
const DRAWS: u64 = 5;

#[derive(Clone)]
pub(crate) struct Radio {
    model: RadioModel,
    pub(crate) state: RadioState,
}

#[derive(Clone)]
struct RadioModel {
    link: Link,
    /// Changes between a link's good and bad state.
    bursts: TwoStateChain,
    /// Noises, by vehicle index.
    noises: Vec<TimedNoise>,
    /// The time between two decisions.
    decision: SimTime,
    /// Maximum number of messages in transit per direction: one per decision within the longest
    /// transit time.
    most: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RadioState {
    /// The number of the open decision.
    decision: u64,
    /// Links of the boats, by vehicle index.
    lines: Vec<Line>,
}

/// One boat's link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Line {
    is_bad: bool,
    /// Messages in transit in each direction, by ascending arrival time. Overtaken messages are
    /// dropped.
    orders: VecDeque<Sent<Order>>,
    reports: VecDeque<Sent<OwnBoat>>,
}

/// A message in transit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Sent<T> {
    /// The decision at which the message was sent.
    decision: u64,
    arrival: SimTime,
    message: T,
}

/// A message's direction; its value is the index of its first draw in a decision.
#[derive(Clone, Copy)]
enum Direction {
    Out = 1,
    In = 3,
}

fn send<T>(under_way: &mut VecDeque<Sent<T>>, sent: Sent<T>, most: usize) {
    // This message overtakes messages that would arrive later, as with a sender that keeps only its
    // newest message: an older message that arrives later is worthless.
    while under_way
        .pop_back_if(|earlier| earlier.arrival >= sent.arrival)
        .is_some()
    {}
    assert!(
        under_way.len() < most,
        "one message per decision, within the longest transit time"
    );
    under_way.push_back(sent);
}

/// The newest message that has arrived by `now`, if any. Calls `each` with the decision of every
/// arrived message.
fn receive<T>(
    under_way: &mut VecDeque<Sent<T>>,
    now: SimTime,
    mut each: impl FnMut(u64),
) -> Option<T> {
    let mut newest = None;
    while let Some(sent) = under_way.pop_front_if(|sent| sent.arrival <= now) {
        each(sent.decision);
        newest = Some(sent.message);
    }
    newest
}

impl Radio {
    /// The radio links of this scenario with its seed, if any.
    pub(crate) fn new(scenario: &Scenario) -> Option<Radio> {
        let link = scenario.link.clone()?;
        let seeds = scenario.seeds();
        let noise = |name: &str| seeds.noise(&format!("link/{name}"));
        Some(Radio::over(
            link,
            scenario.decision(),
            scenario.vehicles.iter().map(|vehicle| noise(&vehicle.name)),
        ))
    }

    fn over(link: Link, decision: SimTime, noises: impl Iterator<Item = TimedNoise>) -> Radio {
        let decisions = |span_s: f64| (span_s / decision.as_s()).ceil() as usize + 2;
        // Reserve space for messages without jitter: long jitter is rare, and late messages are
        // overtaken anyway.
        let usual = decisions(link.delay_s);
        let line = |_: &TimedNoise| Line {
            is_bad: false,
            orders: VecDeque::with_capacity(usual),
            reports: VecDeque::with_capacity(usual),
        };
        let noises: Vec<TimedNoise> = noises.collect();
        let state = RadioState {
            decision: 0,
            lines: noises.iter().map(line).collect(),
        };
        let most = decisions(link.delay_s + MOST_JITTERS * link.jitter_s);
        Radio {
            model: RadioModel {
                bursts: bursts(&link, decision),
                noises,
                decision,
                most,
                link,
            },
            state,
        }
    }

    /// Opens the next decision: each link may change between good and bad.
    pub(crate) fn open_next(&mut self) {
        let Radio { model, state } = self;
        state.decision += 1;
        let now = model.decision * state.decision as i64;
        for (line, noise) in state.lines.iter_mut().zip(&model.noises) {
            // The Gilbert-Elliott model: radio losses come in bursts, for which agents tested with
            // independent losses are unprepared.
            line.is_bad = model
                .bursts
                .next(line.is_bad, noise.at(now).unit(DRAWS * state.decision));
        }
    }

    /// Sends an order to a boat at `at`. Only the last of several orders in one decision counts.
    pub(crate) fn send_order(&mut self, vehicle: usize, order: Order, at: Ned, now: SimTime) {
        if let Some(sent) = self.sent(vehicle, Direction::Out, order, at, now) {
            send(&mut self.state.lines[vehicle].orders, sent, self.model.most);
        }
    }

    /// The order that arrives at a boat by `now`, if a new one has arrived.
    pub(crate) fn order(&mut self, vehicle: usize, now: SimTime) -> Option<Order> {
        receive(&mut self.state.lines[vehicle].orders, now, |_| {})
    }

    /// Cancels orders in transit to a boat.
    pub(crate) fn recall_orders(&mut self, vehicle: usize) {
        self.state.lines[vehicle].orders.clear();
    }

    /// Sends a boat's report from `at`, once per decision.
    pub(crate) fn send_report(&mut self, vehicle: usize, report: OwnBoat, at: Ned, now: SimTime) {
        if let Some(sent) = self.sent(vehicle, Direction::In, report, at, now) {
            send(
                &mut self.state.lines[vehicle].reports,
                sent,
                self.model.most,
            );
        }
    }

    /// A boat's newest report that has arrived by `now`, if any. Calls `each` with the decision of
    /// every arrived report.
    pub(crate) fn report(
        &mut self,
        vehicle: usize,
        now: SimTime,
        each: impl FnMut(u64),
    ) -> Option<OwnBoat> {
        receive(&mut self.state.lines[vehicle].reports, now, each)
    }

    /// The decision of the oldest report in transit, or the open decision.
    pub(crate) fn oldest_report(&self) -> u64 {
        let oldest = |line: &Line| line.reports.front().map(|sent| sent.decision);
        self.state
            .lines
            .iter()
            .filter_map(oldest)
            .min()
            .unwrap_or(self.state.decision)
    }

    /// Sends a message of the open decision unless it is lost.
    fn sent<T>(
        &self,
        vehicle: usize,
        way: Direction,
        message: T,
        at: Ned,
        now: SimTime,
    ) -> Option<Sent<T>> {
        let decision = self.state.decision;
        let link = &self.model.link;
        let noise = self.model.noises[vehicle].at(now);
        let draw = DRAWS * decision + way as u64;
        let share = if self.state.lines[vehicle].is_bad {
            link.loss.bad
        } else {
            link.loss.good
        };
        let is_out_of_range = link
            .range_m
            .is_some_and(|range_m| at.distance(link.station) > range_m);
        // Look up the random number by vehicle and decision instead of drawing in sequence: other
        // boats' messages must not shift it.
        if is_out_of_range || noise.unit(draw) < share {
            return None;
        }
        let arrival =
            now + SimTime::from_s(link.delay_s + link.jitter_s * noise.exponential(draw + 1));
        Some(Sent {
            decision,
            arrival,
            message,
        })
    }
}

/// The changes between good and bad state from one decision to the next.
fn bursts(link: &Link, decision: SimTime) -> TwoStateChain {
    let loss = &link.loss;
    if loss.good_time_s <= 0.0 {
        return TwoStateChain::OFF;
    }
    TwoStateChain::new(1.0 / loss.good_time_s, 1.0 / loss.bad_time_s, decision)
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::math;
    use primitives::reseed::Seeds;
    use scenario::link::Loss;

    const TENTH: SimTime = SimTime(100_000_000);

    fn radio(link: Link) -> Radio {
        Radio::over(
            link,
            TENTH,
            std::iter::once(Seeds::from(3).noise("link/test")),
        )
    }

    fn link() -> Link {
        Link {
            delay_s: 0.0,
            jitter_s: 0.0,
            loss: Loss::default(),
            range_m: None,
            station: Ned::default(),
        }
    }

    fn course(speed_m_s: f64) -> Order {
        Order::Steer {
            heading_rad: 0.0,
            speed_m_s,
        }
    }

    #[test]
    fn losses_come_in_bursts_of_the_stated_share_and_length() {
        let loss = Loss {
            good: 0.01,
            bad: 0.6,
            good_time_s: 8.0,
            bad_time_s: 2.0,
        };
        let mut radio = radio(Link { loss, ..link() });
        let n = 400_000_i64;
        let mut lost = [0.0; 2];
        let mut bad = 0.0;
        let mut turns = 0.0;
        let mut was_bad = false;
        for k in 0..n {
            for (lost, way) in lost.iter_mut().zip([Direction::Out, Direction::In]) {
                *lost += f64::from(u8::from(
                    radio.sent(0, way, (), Ned::default(), TENTH * k).is_none(),
                ));
            }
            let is_bad = radio.state.lines[0].is_bad;
            bad += f64::from(u8::from(is_bad));
            turns += f64::from(u8::from(is_bad && !was_bad));
            was_bad = is_bad;
            radio.open_next();
        }
        let n = n as f64;
        // Closed forms: bad for 2 of 10 s; sampled every tenth of a second, a stay in one state
        // lasts `tenth / (1 - stay)` on average.
        assert!((bad / n - 0.2).abs() < 0.01, "{}", bad / n);
        for lost in lost {
            assert!(
                (lost / n - (0.8 * 0.01 + 0.2 * 0.6)).abs() < 0.005,
                "{}",
                lost / n
            );
        }
        let leave = (1.0 - math::exp(-0.1 * (0.125 + 0.5))) * 0.8;
        assert!(
            (bad / turns / (1.0 / leave) - 1.0).abs() < 0.05,
            "{} {}",
            bad / turns,
            1.0 / leave
        );
    }

    #[test]
    fn an_order_that_is_overtaken_never_arrives() {
        let mut radio = radio(Link {
            jitter_s: 0.5,
            ..link()
        });
        let mut last = -1.0;
        let mut overtaken = 0;
        for k in 0..2_000_i64 {
            let now = TENTH * k;
            radio.send_order(0, course(k as f64), Ned::default(), now);
            if let Some(Order::Steer { speed_m_s, .. }) = radio.order(0, now) {
                assert!(speed_m_s > last, "{speed_m_s} after {last}");
                overtaken += (speed_m_s - last) as i64 - 1;
                last = speed_m_s;
            }
            radio.open_next();
        }
        assert!(last > 1_900.0 && overtaken > 200, "{last} {overtaken}");
    }

    #[test]
    fn orders_of_one_decision_share_their_fate_and_the_last_one_counts() {
        let loss = Loss {
            good: 0.5,
            ..Loss::default()
        };
        let mut radio = radio(Link { loss, ..link() });
        let mut lost = 0;
        for k in 0..1_000_i64 {
            (0..3)
                .for_each(|n| radio.send_order(0, course(f64::from(n)), Ned::default(), TENTH * k));
            let arrived = radio.order(0, TENTH * k);
            assert!(
                arrived.is_none() || arrived == Some(course(2.0)),
                "{arrived:?}"
            );
            lost += u32::from(arrived.is_none());
            radio.open_next();
        }
        assert!((420..580).contains(&lost), "{lost}");
    }

    #[test]
    fn the_longest_jitter_that_can_be_drawn_is_within_what_queues_are_made_for() {
        let longest = -libm::log(f64::EPSILON * 0.5);
        assert!(
            longest < MOST_JITTERS && longest > MOST_JITTERS - 1.0,
            "{longest}"
        );
    }
}
