//! The plan of one game: scenario, network conditions and faults, all drawn from one seed.

use primitives::stream::Stream;
use sim::node::Pace;
use simulated_network::{Conditions, Damage, Fault};
use std::time::Duration;

/// The games, from the folder `games`.
pub(crate) const GAMES: [&str; 5] = ["point_boats", "surveyors", "duel", "talking", "real_boat"];

/// Numbers of the first nodes. Agents follow, then, for a real boat, its gateway, an operator and
/// the boat itself.
pub(crate) const SIM: usize = 0;
pub(crate) const OBSERVER: usize = 1;
pub(crate) const FIRST_AGENT: usize = 2;

/// Time without a sign of life from the other side after which zenoh closes a link.
const LEASE: Duration = Duration::from_secs(10);

/// The plan of one game.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) seed: u64,
    /// Index into [`GAMES`].
    pub(crate) game: usize,
    /// The seed of the game.
    pub(crate) game_seed: u64,
    pub(crate) duration_s: u32,
    pub(crate) pace: Pace,
    /// Maximum speed in lockstep.
    pub(crate) speed: Option<f64>,
    pub(crate) patience_s: f64,
    /// Time to live of an order, if it differs from the game file: longer than patience, so that a
    /// boat holds because its agent is lost and not because its order has expired.
    pub(crate) order_ttl_s: Option<f64>,
    /// Vehicle indices of each agent process.
    pub(crate) agents: Vec<Vec<usize>>,
    pub(crate) conditions: Conditions,
    /// Start and end of each cut of the wire to the real boat.
    pub(crate) wire_cuts: Vec<(Duration, Duration)>,
    /// Each fault with its start.
    pub(crate) faults: Vec<(Duration, Fault)>,
}

fn ms(stream: &mut Stream, from: u64, to: u64) -> Duration {
    Duration::from_millis(from + stream.below(to - from + 1))
}

fn one<T: Copy>(stream: &mut Stream, of: &[T]) -> T {
    of[stream.below(of.len() as u64) as usize]
}

impl Plan {
    /// The plan for a seed.
    pub(crate) fn drawn(seed: u64) -> Plan {
        let stream = &mut Stream::new(seed, "plan");
        let game = stream.below(GAMES.len() as u64) as usize;
        let boats = if matches!(GAMES[game], "duel" | "real_boat") {
            2
        } else {
            4
        };
        let agents = drawn_agents(stream, boats);
        let pace = match stream.below(5) {
            // A real boat runs in real time.
            _ if GAMES[game] == "real_boat" => Pace::Realtime { factor: 1.0 },
            0..3 => Pace::Lockstep,
            _ => Pace::Realtime {
                factor: one(stream, &[1.0, 2.0, 4.0]),
            },
        };
        let mut plan = Plan {
            seed,
            game,
            game_seed: 1 + stream.below(4),
            duration_s: one(
                stream,
                if GAMES[game] == "real_boat" {
                    &[6, 20, 40]
                } else {
                    &[3, 6, 20]
                },
            ),
            pace,
            speed: one(stream, &[None, None, Some(4.0), Some(1.0)]),
            patience_s: one(stream, &[2.0, 3.0, 5.0]),
            order_ttl_s: one(stream, &[None, None, Some(30.0)]),
            conditions: drawn_conditions(stream),
            faults: vec![],
            wire_cuts: vec![],
            agents,
        };
        if plan.has_real_boat() && stream.below(3) == 0 {
            let at = ms(stream, 0, 20_000);
            plan.wire_cuts.push((at, at + ms(stream, 20, 6000)));
        }
        let faults = stream.below(6);
        plan.faults = (0..faults).map(|_| plan.drawn_fault(stream)).collect();
        plan
    }

    /// A random fault, at a time when the game is probably running.
    fn drawn_fault(&self, stream: &mut Stream) -> (Duration, Fault) {
        let expected_s = match (self.pace, self.speed) {
            (Pace::Realtime { factor }, _) => f64::from(self.duration_s) / factor,
            (Pace::Lockstep, Some(speed)) => f64::from(self.duration_s) / speed,
            (Pace::Lockstep, None) => 1.0,
        };
        let at = Duration::from_secs_f64(stream.between(0.0, 1.0 + expected_s));
        let node = match stream.below(10) {
            0 => SIM,
            1 => OBSERVER,
            2..4 if self.has_real_boat() => self.gateway(),
            4 if self.has_real_boat() => self.operator() + stream.below(2) as usize,
            _ => FIRST_AGENT + stream.below(self.agents.len() as u64) as usize,
        };
        let time = match stream.below(10) {
            0..7 => ms(stream, 20, 1200),
            7..9 => ms(stream, 1200, 4000),
            _ => ms(stream, 4000, 14_000),
        };
        let restart = Some(ms(stream, 0, 3000)).filter(|_| stream.below(4) > 0);
        let fault = match stream.below(10) {
            0..5 => Fault::Cut { node, time },
            5..8 => Fault::Suspend { node, time },
            // The operator ends the gateway and the boat, so it must survive.
            _ if node == self.operator() => Fault::Suspend { node, time },
            _ if node == self.page() => Fault::Kill {
                node,
                restart: None,
            },
            // The death of the sim ends the game, so it should be rare.
            _ if node == SIM && stream.below(4) > 0 => Fault::Suspend { node, time },
            _ if node == SIM => Fault::Kill {
                node,
                restart: None,
            },
            _ => Fault::Kill { node, restart },
        };
        (at, fault)
    }

    pub(crate) fn has_real_boat(&self) -> bool {
        GAMES[self.game] == "real_boat"
    }

    /// Whether a stranger without the token attacks the real boat.
    pub(crate) fn has_stranger(&self) -> bool {
        self.has_real_boat() && self.seed.is_multiple_of(2)
    }

    /// Node number of the gateway.
    pub(crate) fn gateway(&self) -> usize {
        FIRST_AGENT + self.agents.len()
    }

    /// Node number of the operator.
    pub(crate) fn operator(&self) -> usize {
        self.gateway() + 1
    }

    /// Node number of the page server.
    pub(crate) fn page(&self) -> usize {
        self.gateway() + 2
    }

    /// Whether no message is lost or corrupted as long as no link is cut.
    pub(crate) fn is_calm(&self) -> bool {
        self.conditions.loss == 0.0 && self.conditions.damaged.0 == 0.0
    }

    /// Maximum time without faults for a message to cross two links, be processed, and cross one
    /// more link.
    pub(crate) fn on_its_way(&self) -> Duration {
        3 * (self.conditions.delay + self.conditions.jitter + self.conditions.pause)
    }

    /// Whether any of these nodes is cut off, suspended or dead at some time from `from` to `to`.
    pub(crate) fn is_disturbed(&self, nodes: &[usize], from: Duration, to: Duration) -> bool {
        self.faults.iter().any(|(at, fault)| {
            let (node, end) = match fault {
                Fault::Cut { node, time } | Fault::Suspend { node, time } => (node, *at + *time),
                Fault::Kill { node, restart } => {
                    (node, restart.map_or(Duration::MAX, |restart| *at + restart))
                }
            };
            nodes.contains(node) && *at <= to && end >= from
        })
    }

    /// Whether minds communicate: a mind that misses a teammate's message may decide differently.
    pub(crate) fn talks(&self) -> bool {
        GAMES[self.game] == "talking"
    }

    /// Whether corruption may turn a message into a different valid one.
    pub(crate) fn forges(&self) -> bool {
        self.conditions.damaged.0 > 0.0 && self.conditions.damaged.1 != Damage::Truncated
    }

    pub(crate) fn patience(&self) -> Duration {
        Duration::from_secs_f64(self.patience_s)
    }

    /// When the last fault is over and killed nodes have restarted.
    pub(crate) fn faults_end(&self) -> Duration {
        let ends = self.faults.iter().map(|(at, fault)| match fault {
            Fault::Cut { time, .. } | Fault::Suspend { time, .. } => *at + *time,
            Fault::Kill { restart, .. } => *at + restart.unwrap_or_default(),
        });
        ends.chain(self.wire_cuts.iter().map(|(_, end)| *end))
            .max()
            .unwrap_or_default()
    }

    /// The longest continuous period in which `node` was cut off or, unless only cuts count,
    /// suspended; unlimited if it was killed.
    pub(crate) fn longest_absence(&self, node: usize, only_cuts: bool) -> Duration {
        let mut spans: Vec<(Duration, Duration)> = Vec::new();
        for (at, fault) in &self.faults {
            match fault {
                Fault::Kill { node: who, .. } if *who == node => return Duration::MAX,
                Fault::Suspend { .. } if only_cuts => {}
                Fault::Cut { node: who, time } | Fault::Suspend { node: who, time }
                    if *who == node =>
                {
                    spans.push((*at, *at + *time));
                }
                _ => {}
            }
        }
        spans.sort();
        let mut longest = Duration::ZERO;
        let mut open = (Duration::ZERO, Duration::ZERO);
        for (from, to) in spans {
            // Faults in quick succession add up: the answer may not have got through in between.
            open = if from <= open.1 + GAP {
                (open.0, open.1.max(to))
            } else {
                (from, to)
            };
            longest = longest.max(open.1 - open.0);
        }
        longest
    }
}

/// Two absences separated by no more than this count as one.
const GAP: Duration = Duration::from_millis(1500);

/// Random assignment of boats to agent processes.
fn drawn_agents(stream: &mut Stream, boats: usize) -> Vec<Vec<usize>> {
    let mut agents: Vec<Vec<usize>> = Vec::new();
    let mut order: Vec<usize> = (0..boats).collect();
    stream.shuffle(&mut order);
    for boat in order {
        if !agents.is_empty() && stream.below(3) == 0 {
            let agent = stream.below(agents.len() as u64) as usize;
            agents[agent].push(boat);
        } else {
            agents.push(vec![boat]);
        }
    }
    agents
}

fn drawn_conditions(stream: &mut Stream) -> Conditions {
    let damage = one(
        stream,
        &[
            Damage::Truncated,
            Damage::Truncated,
            Damage::BitFlip,
            Damage::Noise,
        ],
    );
    Conditions {
        delay: Duration::from_micros(50 + stream.below(5000)),
        jitter: Duration::from_micros(one(stream, &[100, 2000, 60_000])),
        loss: one(stream, &[0.0, 0.0, 0.01, 0.03]),
        damaged: (one(stream, &[0.0, 0.0, 0.0, 0.02]), damage),
        lease: LEASE,
        retry: ms(stream, 200, 2000),
        queue: one(stream, &[4, 64, 1024]),
        pause: one(
            stream,
            &[
                Duration::ZERO,
                Duration::from_millis(2),
                Duration::from_millis(20),
            ],
        ),
    }
}
