//! Games as learning environments: the referee, sea, boats and minds of any game, with external
//! actions for some boats.

mod game;
mod games;
mod raw;
#[cfg(feature = "record")]
mod recorder;
mod setup;
mod stage;
mod starts;
mod truth;
mod vector;
mod watch;

pub use crate::training::CriticInput;
pub use agent::{Action, ActionSpace, ObservationSpace, Spaces};

pub use game::Side;
pub use games::{Finished, Games, Rows, Standing};
pub use raw::{RawObservation, RawSetup};
#[cfg(feature = "record")]
pub use recorder::{
    RecordingLog, RecordingNames, Recordings, check_recording_folder, recording_name,
};
pub use rules::event::{Event, Logged};
pub(crate) use setup::wrong;
pub use setup::{Control, Player, Setup, SetupError, Teacher};
pub use vector::VectorEnvironment;
pub use watch::{Moment, Watch, Watches};
