//! Identities: small indices into the scenario's lists.

use serde::{Deserialize, Serialize};

/// A vehicle: its index in `scenario::Scenario::vehicles`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct VehicleId(pub u16);

/// A team: its index in `scenario::Scenario::teams`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct TeamId(pub u8);

/// A flag: its index in `rules::Field::flags`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FlagId(pub u8);

impl VehicleId {
    /// The index as a `usize`, for list access.
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The vehicle at `index`. The scenario has already checked the list's length.
    #[inline]
    pub fn at(index: usize) -> VehicleId {
        debug_assert!(index < usize::from(u16::MAX));
        VehicleId(index as u16)
    }
}

impl TeamId {
    /// The index as a `usize`, for list access.
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

impl FlagId {
    /// The index as a `usize`, for list access.
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}
