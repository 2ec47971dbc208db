//! A stranger who reaches the hub and knows no token: he answers operators in the gateway's place, keeps their proofs and
//! sends them again later, forges reports, and floods.

use crate::play::net;
use bus::{Bus, Net, Query, Watched, clock};
use messages::external::{GatewayStatus, OperatorReply, Reported};
use messages::topic::{self, GameName};
use parking_lot::Mutex;
use primitives::stream::Stream;
use std::sync::Arc;
use std::time::Duration;

/// The state that he invents.
pub(crate) const FORGED: &str = "forged";
/// When he comes.
pub(crate) const BEGINS: Duration = Duration::from_millis(500);
/// How often he does something.
const ACTS: Duration = Duration::from_millis(50);
/// Messages of a flood, each time.
const FLOOD: usize = 40;
/// How late he sends a proof again: longer than it counts, and than any of our networks takes.
const LATE: Duration = Duration::from_secs(3);
/// Proofs and questions that he keeps.
const KEPT_MAX: usize = 16;

/// Proofs that he has heard, and when.
type Proofs = Mutex<Vec<(std::time::Instant, Vec<u8>)>>;

/// Does harm, as far as the hub lets him, until the game is over.
pub(crate) fn intrude(seed: u64, game: &GameName, vehicle: &str, over: &Watched<bool>) {
    let stream = &mut Stream::new(seed, "stranger");
    let is_silent = stream.below(2) == 0;
    while !over.wait(ACTS, |over| *over) {
        // His link may be cut like any other's, and a sim may come later.
        if let Ok(bus) = Bus::leaf(&Net { token: None, ..net(false) }) {
            stay(&bus, (game, vehicle), is_silent, stream, over);
            bus.close();
        }
    }
}

fn stay(bus: &Bus, (game, vehicle): (&GameName, &str), is_silent: bool, stream: &mut Stream, over: &Watched<bool>) {
    let (operate, proofs) = (topic::operate(game, vehicle), Arc::new(Proofs::default()));
    let (kept, forged) = (Arc::clone(&proofs), forged_reply(vehicle));
    // Whoever keeps a question open is waited for.
    let open = Mutex::new(Vec::new());
    let take = move |query: Query| {
        if query.payload().windows(7).any(|word| word == b"\"proof\"") && kept.lock().len() < KEPT_MAX {
            kept.lock().push((clock::now(), query.payload().to_vec()));
        }
        let mut open = open.lock();
        if is_silent && open.len() < KEPT_MAX {
            open.push(query);
        } else {
            query.answer(forged.clone());
        }
    };
    let Ok(_answers) = bus.answer(operate.clone(), take) else { return };
    let keys = Reported::ALL.map(|what| topic::report(game, what, vehicle)).into_iter().chain([topic::control(game)]);
    let publishers: Vec<_> = keys.filter_map(|key| bus.publisher(key, bus::Priority::Urgent).ok()).collect();
    let status = serde_json::to_vec(&forged_status(vehicle)).expect("JSON");
    while !over.wait(ACTS, |over| *over) {
        for publisher in &publishers {
            for _ in 0..1 + stream.below(FLOOD as u64) {
                if publisher.send_raw(Reported::with_ticket(stream.below(1 << 20), &status)).is_err() {
                    return;
                }
            }
        }
        let late = proofs.lock().pop_if(|(heard, _)| clock::since(*heard) >= LATE);
        if let Some((_, proof)) = late {
            drop(bus.ask(&operate, proof, ACTS));
        }
    }
}

fn forged_status(vehicle: &str) -> GatewayStatus {
    GatewayStatus { vehicle: vehicle.to_owned(), state: FORGED.to_owned(), ..GatewayStatus::default() }
}

fn forged_reply(vehicle: &str) -> Vec<u8> {
    bus::token::answer(&OperatorReply { refused: None, status: forged_status(vehicle) })
}
