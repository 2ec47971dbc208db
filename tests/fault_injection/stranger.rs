//! A stranger who reaches the hub without a token. It answers operators in place of the gateway,
//! replays their proofs, forges reports, and floods.

use crate::play::net;
use bus::{Bus, Net, Query, Watched, clock};
use messages::external::{GatewayStatus, OperatorReply, Reported};
use messages::topic::{self, GameName};
use parking_lot::Mutex;
use primitives::stream::Stream;
use std::sync::Arc;
use std::time::Duration;

/// The state invented by the stranger.
pub(crate) const FORGED: &str = "forged";
/// When the stranger appears.
pub(crate) const BEGINS: Duration = Duration::from_millis(500);
/// Interval between its actions.
const ACTS: Duration = Duration::from_millis(50);
/// Messages per flood.
const FLOOD: usize = 40;
/// Delay of a replayed proof: longer than its validity and than any delay in these networks.
const LATE: Duration = Duration::from_secs(3);
/// Maximum number of proofs and queries kept.
const KEPT_MAX: usize = 16;

/// Overheard proofs, with their times.
type Proofs = Mutex<Vec<(std::time::Instant, Vec<u8>)>>;

/// Attacks the game, as far as the hub allows, until it is over.
pub(crate) fn intrude(seed: u64, game: &GameName, vehicle: &str, over: &Watched<bool>) {
    let stream = &mut Stream::new(seed, "stranger");
    let is_silent = stream.below(2) == 0;
    while !over.wait(ACTS, |over| *over) {
        // The stranger's link may be cut too, and the sim may start later.
        if let Ok(bus) = Bus::leaf(&Net {
            token: None,
            ..net(false)
        }) {
            stay(&bus, (game, vehicle), is_silent, stream, over);
            bus.close();
        }
    }
}

fn stay(
    bus: &Bus,
    (game, vehicle): (&GameName, &str),
    is_silent: bool,
    stream: &mut Stream,
    over: &Watched<bool>,
) {
    let operate = topic::operate(game, vehicle);
    let proofs = Arc::new(Proofs::default());
    let kept = Arc::clone(&proofs);
    let forged = forged_reply(vehicle);
    // An unanswered query keeps its sender waiting.
    let open = Mutex::new(Vec::new());
    let take = move |query: Query| {
        if query.payload().windows(7).any(|word| word == b"\"proof\"")
            && kept.lock().len() < KEPT_MAX
        {
            kept.lock().push((clock::now(), query.payload().to_vec()));
        }
        let mut open = open.lock();
        if is_silent && open.len() < KEPT_MAX {
            open.push(query);
        } else {
            query.answer(forged.clone());
        }
    };
    let Ok(_answers) = bus.answer(operate.clone(), take) else {
        return;
    };
    let keys = Reported::ALL
        .map(|what| topic::report(game, what, vehicle))
        .into_iter()
        .chain([topic::control(game)]);
    let publishers: Vec<_> = keys
        .filter_map(|key| bus.publisher(key, bus::Priority::Urgent).ok())
        .collect();
    let status = serde_json::to_vec(&forged_status(vehicle)).expect("JSON");
    while !over.wait(ACTS, |over| *over) {
        for publisher in &publishers {
            for _ in 0..1 + stream.below(FLOOD as u64) {
                if publisher
                    .send_raw(Reported::with_ticket(stream.below(1 << 20), &status))
                    .is_err()
                {
                    return;
                }
            }
        }
        let late = proofs
            .lock()
            .pop_if(|(heard, _)| clock::since(*heard) >= LATE);
        if let Some((_, proof)) = late {
            drop(bus.ask(&operate, proof, ACTS));
        }
    }
}

fn forged_status(vehicle: &str) -> GatewayStatus {
    GatewayStatus {
        vehicle: vehicle.to_owned(),
        state: FORGED.to_owned(),
        ..GatewayStatus::default()
    }
}

fn forged_reply(vehicle: &str) -> Vec<u8> {
    bus::token::answer(&OperatorReply {
        refused: None,
        status: forged_status(vehicle),
    })
}
