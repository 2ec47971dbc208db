//! The state of a contest as bytes, and back.

use super::Contest;
use super::state::ContestState;
use crate::radio::{Radio, RadioState};
use crate::sighting::{SightingState, Sightings};
use crate::state::State;
use scenario::Scenario;
use thiserror::Error;
use xxhash_rust::xxh3;

/// What a snapshot begins with: name, layout version.
const MAGIC: [u8; 5] = *b"SQLC\x01";

/// Everything that changes: boats and sea, the game, messages under way, sightings.
type Parts = (State, ContestState, Option<RadioState>, Option<SightingState>);

/// Why bytes are not a snapshot of this contest.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RestoreError {
    /// Not a snapshot, or of another layout.
    #[error("not a snapshot of this version of Squall")]
    NotASnapshot,
    /// A snapshot of another scenario or seed: the sea would be another.
    #[error("a snapshot of another scenario, of another seed, or of other versions of its files")]
    OtherScenario,
    /// A snapshot that was cut or changed.
    #[error("the snapshot is damaged")]
    Damaged,
}

impl Contest {
    /// Everything that changes, as bytes, marked with the scenario it belongs to: a contest of the same game that is
    /// restored from them goes on as this one does, to the last bit. What [`Contest::take_inputs`] would give is not in it.
    #[must_use]
    pub fn snapshot(&self) -> Vec<u8> {
        let (radio, sightings) = (self.radio.as_ref().map(Radio::state), self.sightings.as_ref().map(Sightings::state));
        // The sea, the faults and the contact engine are missing on purpose: they are functions
        // of scenario, seed and time.
        let body = bytes(&(self.world.state(), &self.state, radio, sightings));
        let mut snapshot = MAGIC.to_vec();
        snapshot.extend(self.scenario_mark.to_le_bytes());
        snapshot.extend(xxh3::xxh3_64(&body).to_le_bytes());
        snapshot.extend(body);
        snapshot
    }

    /// Goes back (or on) to the state in a snapshot of the same game.
    ///
    /// # Errors
    /// [`RestoreError`] says what is wrong with the bytes; the contest stays as it was.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), RestoreError> {
        let rest = snapshot.strip_prefix(&MAGIC).ok_or(RestoreError::NotASnapshot)?;
        let (mark, rest) = rest.split_at_checked(8).ok_or(RestoreError::Damaged)?;
        let (check, body) = rest.split_at_checked(8).ok_or(RestoreError::Damaged)?;
        // A state of another scenario would fit by length and be nonsense.
        if mark != self.scenario_mark.to_le_bytes() {
            return Err(RestoreError::OtherScenario);
        }
        if check != xxh3::xxh3_64(body).to_le_bytes() {
            return Err(RestoreError::Damaged);
        }
        let (world, state, radio, sightings): Parts = postcard::from_bytes(body).map_err(|_| RestoreError::Damaged)?;
        self.world.set_state(world);
        self.state = state;
        self.radio.iter_mut().zip(radio).for_each(|(radio, state)| radio.set_state(state));
        self.sightings.iter_mut().zip(sightings).for_each(|(sightings, state)| sightings.set_state(state));
        Ok(())
    }

    /// 128 bits over world, standing and all events. Where a game has radio links, limits of sharing or command watchdogs,
    /// also over what is in force, under way and known, and where it has real boats, over their fixes.
    #[must_use]
    pub fn digest(&self) -> u128 {
        let ContestState { standing, orders, tracks, events, known, .. } = &self.state;
        let mut hash = xxh3::Xxh3::new();
        hash.update(&xxh3::xxh3_128(&bytes(&(self.world.state(), standing))).to_le_bytes());
        for logged in events {
            // As it is recorded, field by field: a change of the Rust types alone must not
            // change a digest.
            let record = messages::EventRecord::from(*logged);
            hash.update(&record.tick.to_le_bytes());
            hash.update(&[record.kind]);
            hash.update(&record.subject.to_le_bytes());
            hash.update(&record.object.to_le_bytes());
        }
        // Only where they exist: digests of games without them stay what they were before
        // radios were added.
        if self.radio.is_some() || self.sightings.is_some() || self.watchdogs.iter().any(Option::is_some) {
            let in_force: Vec<_> = orders.iter().map(|held| held.order).collect();
            let arrived_at: Vec<_> = orders.iter().map(|held| held.arrived_at).collect();
            let messages = (self.radio.as_ref().map(Radio::state), self.sightings.as_ref().map(Sightings::state));
            hash.update(&bytes(&(in_force, arrived_at, known, messages)));
        }
        let tracks: Vec<_> = tracks.iter().flatten().collect();
        if !tracks.is_empty() {
            hash.update(&bytes(&tracks));
        }
        hash.digest128()
    }
}

/// What tells a game from all others.
pub(super) fn mark(scenario: &Scenario) -> u64 {
    xxh3::xxh3_64(&bytes(scenario))
}

fn bytes(state: &impl serde::Serialize) -> Vec<u8> {
    postcard::to_stdvec(state).expect("plain numbers always encode")
}
