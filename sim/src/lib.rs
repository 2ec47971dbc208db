//! The Squall simulation: boats in water, and the game that they play.
//!
//! Start with [`World::step`], the physics. [`Contest`] plays a whole game with it, and `node`
//! serves the game on the network.

pub mod afloat;
pub mod autopilot;
pub mod battery;
pub mod contact;
pub mod contest;
pub mod external;
pub mod flaw;
pub mod hull;
pub mod kinematic;
mod lanes;
mod model;
pub mod motion;
#[cfg(feature = "net")]
pub mod node;
mod piecewise_linear;
#[cfg(feature = "record")]
mod progress;
mod radio;
#[cfg(feature = "record")]
mod recorder;
pub mod sea;
pub mod sensor;
mod sighting;
pub mod spawn;
pub mod state;
pub mod thruster;
mod two_state;
mod view;
pub mod world;

pub use afloat::{NotAfloat, afloat};
pub use contest::{Contest, RestoreError};
pub use external::BadReport;
#[cfg(feature = "record")]
pub use progress::{EntryFaults, Progress, ProgressMessage, Report, Reporter, Run};
#[cfg(feature = "record")]
pub use recorder::GameRecorder;
pub use spawn::NoStart;
pub use state::{BoatState, State};
pub use world::{VehiclePlan, World, WorldPlan};
