//! Saves and restores the state of a contest.

use super::Contest;
use super::state::ContestState;
use crate::radio::RadioState;
use crate::sighting::SightingState;
use crate::spawn::NoStart;
use crate::state::State;
use primitives::reseed::Reseed;
use scenario::Scenario;
use scenario::sea::Sea;
use thiserror::Error;
use xxhash_rust::xxh3;

/// Start of a snapshot: name and layout version.
const MAGIC: [u8; 5] = *b"SQLC\x01";

/// All changing state: boats and sea, game, messages in transit, sightings.
type Parts = (
    State,
    ContestState,
    Option<RadioState>,
    Option<SightingState>,
);

/// A reason why a snapshot cannot be restored.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RestoreError {
    /// Not a snapshot, or one with a different layout.
    #[error("not a snapshot made by this version of Squall")]
    NotASnapshot,
    /// A snapshot of a different scenario or seed.
    #[error(
        "the snapshot is of a different scenario or seed, or the scenario's files have changed since"
    )]
    OtherScenario,
    /// A truncated or modified snapshot.
    #[error("the snapshot is damaged")]
    Damaged,
}

impl Contest {
    /// The changing state as bytes, tagged with the game. A contest of the same game that is
    /// restored from them continues identically, bit for bit. Inputs kept for
    /// [`Contest::take_inputs`] are not included.
    pub fn snapshot(&self) -> Vec<u8> {
        // Sea and faults are omitted because they are functions of scenario, seed and time. The
        // contact engine has no state.
        let (radio, sightings) = self.messages();
        let body = bytes(&(self.world.state(), &self.state, radio, sightings));
        let mut snapshot = MAGIC.to_vec();
        snapshot.extend(self.scenario_mark.to_le_bytes());
        snapshot.extend(xxh3::xxh3_64(&body).to_le_bytes());
        snapshot.extend(body);
        snapshot
    }

    /// The messages in transit, and the sightings.
    fn messages(&self) -> (Option<&RadioState>, Option<&SightingState>) {
        (
            self.radio.as_ref().map(|radio| &radio.state),
            self.sightings.as_ref().map(|sightings| &sightings.state),
        )
    }

    /// Restores the state from a snapshot of the same game, taken earlier or later.
    ///
    /// # Errors
    /// [`RestoreError`]; the contest then remains unchanged.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), RestoreError> {
        let rest = snapshot
            .strip_prefix(&MAGIC)
            .ok_or(RestoreError::NotASnapshot)?;
        let (mark, rest) = rest.split_at_checked(8).ok_or(RestoreError::Damaged)?;
        let (check, body) = rest.split_at_checked(8).ok_or(RestoreError::Damaged)?;
        // The state of a different scenario could have the right length and be meaningless.
        if mark != self.scenario_mark.to_le_bytes() {
            return Err(RestoreError::OtherScenario);
        }
        if check != xxh3::xxh3_64(body).to_le_bytes() {
            return Err(RestoreError::Damaged);
        }
        self.put(postcard::from_bytes(body).map_err(|_| RestoreError::Damaged)?);
        Ok(())
    }

    fn put(&mut self, (world, state, radio, sightings): Parts) {
        self.world.set_state(world);
        self.state = state;
        self.radio
            .iter_mut()
            .zip(radio)
            .for_each(|(radio, state)| radio.state = state);
        self.sightings
            .iter_mut()
            .zip(sightings)
            .for_each(|(sightings, state)| sightings.state = state);
    }

    /// A contest in the same state whose later random values come from `seed`.
    ///
    /// # Errors
    /// [`NoStart`] if the game could not have started with its original seed either.
    pub fn reseeded(&self, seed: u64) -> Result<Contest, NoStart> {
        let after_s = self.now().as_s();
        self.continued(|scenario| scenario.reseed.push(Reseed { after_s, seed }))
    }

    /// A contest in the same state that continues in a different sea.
    ///
    /// # Errors
    /// [`NoStart`] if the values drawn for the seed are inconsistent with this sea.
    pub fn in_sea(&self, sea: &Sea) -> Result<Contest, NoStart> {
        self.continued(|scenario| scenario.sea = sea.clone())
    }

    fn continued(&self, change: impl FnOnce(&mut Scenario)) -> Result<Contest, NoStart> {
        let mut scenario = (*self.scenario).clone();
        change(&mut scenario);
        let (radio, sightings) = self.messages();
        let mut contest = Contest::new(&scenario, scenario.seed)?;
        contest.put((
            self.world.state().clone(),
            self.state.clone(),
            radio.cloned(),
            sightings.cloned(),
        ));
        Ok(contest)
    }

    /// A 128-bit hash of world, standing and all events. In games with radio links, limits on
    /// sharing or command watchdogs, it also covers the orders in force, the messages in transit,
    /// and what teams know of their own boats and of contacts. In games with real boats, it also
    /// covers their fixes.
    pub fn digest(&self) -> u128 {
        let ContestState {
            standing,
            orders,
            tracks,
            events,
            known,
            ..
        } = &self.state;
        let mut hash = xxh3::Xxh3::new();
        hash.update(&xxh3::xxh3_128(&bytes(&(self.world.state(), standing))).to_le_bytes());
        for logged in events {
            // Hash events in recorded form, field by field: changing only the Rust types must not
            // change a digest.
            let record = messages::EventRecord::from(*logged);
            hash.update(&record.tick.to_le_bytes());
            hash.update(&[record.kind]);
            hash.update(&record.subject.to_le_bytes());
            hash.update(&record.object.to_le_bytes());
        }
        // Hash these only if present, so that adding radios did not change the digests of games
        // without them.
        if self.radio.is_some()
            || self.sightings.is_some()
            || self.watchdogs.iter().any(Option::is_some)
        {
            let in_force: Vec<_> = orders.iter().map(|held| held.order).collect();
            let arrived_at: Vec<_> = orders.iter().map(|held| held.arrived_at).collect();
            hash.update(&bytes(&(in_force, arrived_at, known, self.messages())));
        }
        let tracks: Vec<_> = tracks.iter().flatten().collect();
        if !tracks.is_empty() {
            hash.update(&bytes(&tracks));
        }
        hash.digest128()
    }
}

/// A hash that identifies the game.
pub(super) fn mark(scenario: &Scenario) -> u64 {
    xxh3::xxh3_64(&bytes(scenario))
}

fn bytes(state: &impl serde::Serialize) -> Vec<u8> {
    postcard::to_stdvec(state).expect("plain numbers can be encoded")
}
