//! What every Squall process agrees on: time, frames, messages, the field, the rules, scenario files.
//!
//! Read [`scenario::Scenario`] first (what makes a game), then [`rules`] (the referee), then
//! [`message`] and [`topic`] (what goes over the wire).

pub mod action;
pub mod angle;
pub mod boat;
pub mod codec;
pub mod count;
pub mod event;
pub mod external;
pub mod fault;
pub mod field;
pub mod frame;
pub mod gateway;
pub mod helm;
pub mod id;
pub mod input;
pub mod input_file;
pub mod instructions;
pub mod link;
pub mod math;
pub mod message;
pub mod near;
mod normal;
pub mod observation;
pub mod order;
pub mod outcome;
pub mod payload;
pub mod picture;
pub mod policy;
pub mod printable;
pub mod refusal;
pub mod reseed;
pub mod rewards;
pub mod ros;
pub mod rules;
pub mod run_state;
pub mod scenario;
pub mod sea;
pub mod sensor;
pub mod stamp;
pub mod strategy;
pub mod stream;
pub mod time;
pub mod topic;
pub mod training;
pub mod water;

pub use boat::Boat;
pub use event::Event;
pub use field::Field;
pub use frame::{Body, LatLon, Leg, Ned, Pose, Rotation};
pub use id::{FlagId, TeamId, VehicleId};
pub use order::Order;
pub use outcome::Outcome;
pub use picture::Picture;
pub use rules::Rules;
pub use scenario::Scenario;
pub use time::SimTime;

/// The version of Squall, as every node states it when it joins a game.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
