//! What a replay needs of a recording.

use crate::page::rose::HelmAnswer;
use game::external::GatewayStatus;
use game::message::GameInfo;
use game::outcome::EventOutcome;
use game::picture::OwnBoat;
use game::water::Water;
use game::{SimTime, VehicleId};

/// A recorded game.
pub trait ReplaySource: Send + Sync {
    /// What the game was.
    fn info(&self) -> &GameInfo;
    /// Its name on the network.
    fn game(&self) -> &str;
    /// The file's name.
    fn file(&self) -> &str;
    /// Whether the file ends abruptly.
    fn is_cut(&self) -> bool;
    /// The waves.
    fn water(&self) -> &Water;
    /// When the frames are, in order.
    fn frame_times(&self) -> &[SimTime];
    /// A frame, as CDR.
    fn frame_bytes(&self, frame: usize) -> &[u8];
    /// All that happened, gateways' failsafes included.
    fn events(&self) -> &[EventOutcome];
    /// Where a boat's own sensors put it at a frame.
    fn estimate(&self, vehicle: VehicleId, frame: usize) -> Option<OwnBoat>;
    /// What a boat's gateway had sent last.
    fn status(&self, vehicle: VehicleId, at: SimTime) -> Option<GatewayStatus>;
}

/// Recomputes helm reports of a recorded game. That may take a while.
pub trait Helms: Send {
    /// What a boat's helm thought at a decision, with utilities or without.
    fn report(&mut self, vehicle: VehicleId, decision: u64, functions: bool) -> HelmAnswer;
}
