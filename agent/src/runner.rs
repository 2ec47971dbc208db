//! Runs minds, decision by decision: delivers teammates' messages, then policy proposals; lets
//! every mind decide; then collects the minds' messages to their teams.
//!
//! Uses neither network nor clock. The arena, agent processes, replays and emulated boats all use
//! this loop, so a game has the same bytes in each of them.

use crate::mind::{Mind, Proposal};
use crate::situation::TeamView;
use messages::{Message, Order, Orders, Picture, PolicyProposal, Stamp, VehicleOrder, Word};
use primitives::VehicleId;
use std::sync::{Arc, Mutex, PoisonError};

/// A boat, its mind, and its last order.
struct Boat<M: ?Sized> {
    vehicle: VehicleId,
    order: Order,
    mind: Box<M>,
}

impl<M: Mind + ?Sized> Boat<M> {
    fn decide(&mut self, picture: Option<&Picture>, teams: &[Team]) {
        let order = picture.map(|picture| {
            let team = teams.iter().find(|team| team.has(picture));
            self.mind
                .decide_in_team(picture, team.map(|team| &team.view))
        });
        self.order = order.unwrap_or_default();
    }
}

/// A team with several boats in this process.
#[derive(Clone)]
struct Team {
    view: Arc<TeamView>,
    /// The previous view, whose memory is reused for the next.
    before: Arc<TeamView>,
    /// The picture behind the view at the current decision, identified by its address in memory.
    picture: Option<usize>,
}

impl Team {
    fn new(view: TeamView) -> Team {
        let view = Arc::new(view.shared());
        Team {
            before: Arc::clone(&view),
            view,
            picture: None,
        }
    }

    /// Processes the team's picture; if there are several in one decision, only the first.
    fn take_in(&mut self, picture: &Picture) {
        if self.picture.is_some() || self.view.team().index() != usize::from(picture.team) {
            return;
        }
        self.picture = Some(std::ptr::from_ref(picture).addr());
        std::mem::swap(&mut self.view, &mut self.before);
        // A mind that has received no picture since the old view was computed may still hold it.
        if Arc::get_mut(&mut self.view).is_none() {
            self.view = Arc::new(TeamView::clone(&self.before));
        }
        if let Some(view) = Arc::get_mut(&mut self.view) {
            view.remember(&self.before);
            view.take_in(picture);
        }
    }

    fn has(&self, picture: &Picture) -> bool {
        self.picture == Some(std::ptr::from_ref(picture).addr())
    }
}

/// The minds of one process.
pub struct MindRunner<M: Mind + ?Sized = dyn Mind> {
    boats: Vec<Boat<M>>,
    teams: Vec<Team>,
    /// The picture of the last decision.
    decided: Option<Stamp>,
    /// The minds' messages to their teams after the last decision.
    sent: Vec<Word>,
    threads: usize,
}

/// Number of minds above which threads save more time than starting them takes.
const MINDS_MIN: usize = 16;

impl<M: Mind + ?Sized> MindRunner<M> {
    /// A runner of these minds before their first decision.
    pub fn new(minds: impl IntoIterator<Item = (VehicleId, Box<M>)>) -> MindRunner<M> {
        let boat = |(vehicle, mind)| Boat {
            vehicle,
            order: Order::Hold,
            mind,
        };
        let boats: Vec<Boat<M>> = minds.into_iter().map(boat).collect();
        let views = boats.iter().filter_map(|boat| boat.mind.team_view());
        let mut teams: Vec<Team> = Vec::new();
        for view in views {
            if teams.iter().all(|team| team.view.team() != view.team()) {
                teams.push(Team::new(view));
            }
        }
        MindRunner {
            boats,
            teams,
            decided: None,
            sent: Vec::new(),
            threads: 1,
        }
    }

    /// The same runner, whose minds decide on this many threads if there are many minds. The orders
    /// are the same.
    pub fn on_threads(mut self, threads: usize) -> MindRunner<M> {
        self.threads = threads.max(1);
        self
    }

    /// The minds and their boats, in the order in which they decide.
    pub fn minds(&self) -> impl Iterator<Item = (VehicleId, &M)> {
        self.boats.iter().map(|boat| (boat.vehicle, &*boat.mind))
    }

    /// The minds and their boats, in the order in which they decide.
    pub fn minds_mut(&mut self) -> impl Iterator<Item = (VehicleId, &mut M)> {
        self.boats
            .iter_mut()
            .map(|boat| (boat.vehicle, &mut *boat.mind))
    }

    /// The mind of a boat, if this process runs it.
    pub fn mind(&self, vehicle: VehicleId) -> Option<&M> {
        self.boats
            .iter()
            .find(|boat| boat.vehicle == vehicle)
            .map(|boat| &*boat.mind)
    }

    /// The mind of a boat, if this process runs it.
    pub fn mind_mut(&mut self, vehicle: VehicleId) -> Option<&mut M> {
        self.boats
            .iter_mut()
            .find(|boat| boat.vehicle == vehicle)
            .map(|boat| &mut *boat.mind)
    }

    /// Gives a boat a different mind from the next decision on.
    pub fn replace(&mut self, vehicle: VehicleId, mind: Box<M>) {
        if let Some(boat) = self.boats.iter_mut().find(|boat| boat.vehicle == vehicle) {
            boat.mind = mind;
        }
    }

    /// Delivers messages that teammates in other processes sent after the previous decision. Minds
    /// ignore messages from the other team.
    pub fn receive(&mut self, messages: &[Word]) {
        if !messages.is_empty() {
            self.boats
                .iter_mut()
                .for_each(|boat| boat.mind.receive(messages));
        }
    }

    /// Delivers a policy's proposal before the decision on the picture with this stamp.
    pub fn propose(&mut self, proposal: &PolicyProposal, stamp: Stamp) {
        let PolicyProposal {
            vehicle,
            course_rad,
            speed_m_s,
            ..
        } = *proposal;
        if let Some(mind) = self.mind_mut(vehicle) {
            // A proposal cannot know more than the newest picture.
            mind.propose(Proposal {
                at: proposal.stamp.valid_ns.min(stamp.valid_ns),
                course_rad,
                speed_m_s,
            });
        }
    }

    /// Lets every mind decide on its boat's picture, which has this stamp; a boat without a picture
    /// holds. Teammates in this process receive the resulting messages at the next decision.
    pub fn decide<'p>(
        &mut self,
        stamp: Stamp,
        picture_of: impl Fn(VehicleId) -> Option<&'p Picture>,
    ) {
        let MindRunner { boats, teams, .. } = self;
        teams.iter_mut().for_each(|team| team.picture = None);
        for picture in boats.iter().filter_map(|boat| picture_of(boat.vehicle)) {
            teams.iter_mut().for_each(|team| team.take_in(picture));
        }
        let teams: &[Team] = teams;
        if self.threads == 1 || boats.len() < MINDS_MIN {
            for boat in boats {
                boat.decide(picture_of(boat.vehicle), teams);
            }
        } else {
            let mut all: Vec<_> = boats
                .iter_mut()
                .map(|boat| (picture_of(boat.vehicle), boat))
                .collect();
            // Hand out the boats in small parts, as threads become free: some boats take several
            // times as long as others.
            let parts = Mutex::new(all.chunks_mut(MINDS_MIN / 2));
            let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
            let work = || {
                while let Some(part) = next() {
                    part.iter_mut()
                        .for_each(|(picture, boat)| boat.decide(*picture, teams));
                }
            };
            std::thread::scope(|scope| {
                for _ in 1..self.threads {
                    scope.spawn(work);
                }
                work();
            });
        }
        self.decided = Some(stamp);
        let mut sent = std::mem::take(&mut self.sent);
        sent.clear();
        // Send after all have decided: teammates receive a boat's messages at the next decision,
        // whether in one process or several, for any order of the minds.
        self.boats.iter().for_each(|boat| boat.mind.send(&mut sent));
        self.receive(&sent);
        self.sent = sent;
    }

    /// The boats whose programs had faults, each with the first fault and the number of faults.
    pub fn faults(&self) -> impl Iterator<Item = (VehicleId, String, u64)> {
        self.minds().filter_map(|(vehicle, mind)| {
            let (first, count) = mind.faults()?;
            Some((vehicle, first, count))
        })
    }

    /// The number of the last decision.
    pub fn decided(&self) -> Option<u64> {
        self.decided.map(|stamp| stamp.seq)
    }

    /// The orders of the last decision.
    pub fn orders(&self) -> impl Iterator<Item = (VehicleId, Order)> {
        self.boats.iter().map(|boat| (boat.vehicle, boat.order))
    }

    /// The minds' messages to their teams after the last decision.
    pub fn sent(&self) -> &[Word] {
        &self.sent
    }

    /// The orders of the last decision as a message to the sim that issued this ticket, identical
    /// on every call. `None` before the first decision.
    pub fn answer(&self, ticket: u64) -> Option<Orders> {
        // Use the picture's own time and number, by which the sim identifies the answered tick.
        let stamp = Stamp {
            version: Orders::VERSION,
            ..self.decided?
        };
        Some(Orders {
            stamp,
            ticket,
            orders: self
                .orders()
                .map(|(v, order)| VehicleOrder::new(v, order))
                .collect(),
        })
    }
}

impl MindRunner {
    /// A runner in the same state that continues independently; `None` if a mind cannot be copied.
    pub fn fork(&self) -> Option<MindRunner> {
        let boats = self.boats.iter().map(|boat| {
            Some(Boat {
                vehicle: boat.vehicle,
                order: boat.order,
                mind: boat.mind.fork()?,
            })
        });
        Some(MindRunner {
            boats: boats.collect::<Option<_>>()?,
            teams: self.teams.clone(),
            decided: self.decided,
            sent: self.sent.clone(),
            threads: self.threads,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::SimTime;

    /// A mind that orders the proposed speed plus the values received, and sends its number of
    /// decisions.
    struct Adder {
        me: VehicleId,
        decisions: f64,
        received: f64,
        proposed: Option<Proposal>,
    }

    impl Mind for Adder {
        fn decide(&mut self, _picture: &Picture) -> Order {
            self.decisions += 1.0;
            let speed_m_s =
                self.received + self.proposed.map_or(0.0, |proposal| proposal.speed_m_s);
            Order::Steer {
                heading_rad: 0.0,
                speed_m_s,
            }
        }
        fn send(&self, messages: &mut Vec<Word>) {
            messages.push(Word {
                vehicle: self.me,
                key: 1,
                value: self.decisions,
            });
        }
        fn receive(&mut self, messages: &[Word]) {
            self.received += messages
                .iter()
                .filter(|word| word.vehicle != self.me)
                .map(|word| word.value)
                .sum::<f64>();
        }
        fn propose(&mut self, proposal: Proposal) {
            self.proposed = Some(proposal);
        }
    }

    fn speeds(runner: &MindRunner<Adder>) -> Vec<f64> {
        let speed = |(_, order)| {
            if let Order::Steer { speed_m_s, .. } = order {
                speed_m_s
            } else {
                -1.0
            }
        };
        runner.orders().map(speed).collect()
    }

    #[test]
    fn what_is_sent_after_a_decision_is_known_at_the_next_one() {
        let adder = |i| {
            let me = VehicleId(i);
            (
                me,
                Box::new(Adder {
                    me,
                    decisions: 0.0,
                    received: 0.0,
                    proposed: None,
                }),
            )
        };
        let mut runner = MindRunner::new([adder(0), adder(4)]);
        assert!(runner.answer(7).is_none() && runner.decided().is_none());
        let picture = Picture::default();
        let stamp = |seq| Stamp {
            seq,
            valid_ns: SimTime(10 * seq as i64),
            ..Stamp::default()
        };
        for (seq, want) in [(0, [0.0, 0.0]), (1, [1.0, 1.0]), (2, [3.0, 3.0])] {
            runner.decide(stamp(seq), |_| Some(&picture));
            assert_eq!(
                (speeds(&runner), runner.decided()),
                (want.to_vec(), Some(seq))
            );
        }
        runner.receive(&[Word {
            vehicle: VehicleId(9),
            key: 1,
            value: 100.0,
        }]);
        let proposal = PolicyProposal {
            stamp: stamp(99),
            vehicle: VehicleId(4),
            course_rad: 0.0,
            speed_m_s: 0.5,
        };
        runner.propose(&proposal, stamp(3));
        runner.propose(
            &PolicyProposal {
                vehicle: VehicleId(5),
                ..proposal
            },
            stamp(3),
        );
        runner.decide(stamp(3), |vehicle| {
            (vehicle == VehicleId(4)).then_some(&picture)
        });
        assert_eq!(
            speeds(&runner),
            [-1.0, 106.5],
            "without a picture the boat holds"
        );
        let known_at = runner
            .mind(VehicleId(4))
            .and_then(|mind| mind.proposed)
            .map(|proposal| proposal.at);
        assert_eq!(
            known_at,
            Some(SimTime(30)),
            "no proposal is newer than the picture"
        );
        assert_eq!(
            runner
                .sent()
                .iter()
                .map(|word| word.value)
                .collect::<Vec<_>>(),
            [3.0, 4.0]
        );
        let answer = runner.answer(7).expect("the minds have decided");
        assert_eq!(
            (answer.ticket, answer.stamp.seq, answer.orders.len()),
            (7, 3, 2)
        );
        assert_eq!(
            runner.answer(7),
            Some(answer),
            "a second call returns the same"
        );
    }
}
