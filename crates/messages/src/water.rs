//! The waves of a game, for observers to draw.

use serde::{Deserialize, Serialize};

/// The waves of a game. The elevation of the water is their sum.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Water {
    /// The waves; empty in calm water.
    pub waves: Vec<PlaneWave>,
}

/// One plane wave. Its elevation at a place x north and y east of the datum at time t is
/// a cos(k (x cos χ + y sin χ) − ω t + φ).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlaneWave {
    /// a, m.
    pub amplitude_m: f64,
    /// k.
    pub wavenumber_rad_m: f64,
    /// χ, the compass bearing it travels towards.
    pub toward_rad: f64,
    /// ω.
    pub omega_rad_s: f64,
    /// φ.
    pub phase_rad: f64,
}
