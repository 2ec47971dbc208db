//! What can be fitted: numbers of a boat, their keys in a boat file, and how the search moves them.

use primitives::math;
use scenario::boat::{Boat, Drive, Thruster};

/// A number of a boat that can be fitted.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// What it is called on the command line.
    pub name: &'static str,
    /// Its table in a boat file.
    pub table: &'static str,
    /// Its key there.
    pub key: &'static str,
    /// Whether it is fitted if nobody says what to fit.
    pub by_default: bool,
    place: fn(&mut Boat) -> Option<&mut f64>,
}

/// All that can be fitted, in the order in which it is reported.
pub const PARAMETERS: [Parameter; 16] = [
    hull("surge_linear", "surge_linear_kg_s", true, |boat| Some(&mut boat.hull.surge_linear_kg_s)),
    hull("surge_quadratic", "surge_quadratic_kg_m", true, |boat| Some(&mut boat.hull.surge_quadratic_kg_m)),
    hull("sway_linear", "sway_linear_kg_s", true, |boat| Some(&mut boat.hull.sway_linear_kg_s)),
    hull("sway_lift", "sway_lift_kg_m", false, |boat| Some(&mut boat.hull.sway_lift_kg_m)),
    hull("yaw_linear", "yaw_linear_kg_m2_s", true, |boat| Some(&mut boat.hull.yaw_linear_kg_m2_s)),
    hull("yaw_quadratic", "yaw_quadratic_kg_m2", true, |boat| Some(&mut boat.hull.yaw_quadratic_kg_m2)),
    hull("yaw_lift", "yaw_lift_kg_m", true, |boat| Some(&mut boat.hull.yaw_lift_kg_m)),
    hull("munk_factor", "munk_factor", false, |boat| Some(&mut boat.hull.munk_factor)),
    hull("crossflow", "crossflow_coefficient", false, |boat| Some(&mut boat.hull.crossflow_coefficient)),
    hull("added_surge", "added_surge_kg", false, |boat| Some(&mut boat.hull.added_surge_kg)),
    hull("added_sway", "added_sway_kg", false, |boat| Some(&mut boat.hull.added_sway_kg)),
    hull("added_yaw", "added_yaw_kg_m2", false, |boat| Some(&mut boat.hull.added_yaw_kg_m2)),
    hull("yaw_inertia", "yaw_inertia_kg_m2", false, |boat| Some(&mut boat.hull.yaw_inertia_kg_m2)),
    thrusters("port_gain", "port_gain", |boat| thruster(boat).map(|thruster| &mut thruster.flaws.gain.0)),
    thrusters("starboard_gain", "starboard_gain", |boat| thruster(boat).map(|thruster| &mut thruster.flaws.gain.1)),
    thrusters("lag", "lag_s", |boat| thruster(boat).map(|thruster| &mut thruster.lag_s)),
];

const fn hull(
    name: &'static str,
    key: &'static str,
    by_default: bool,
    place: fn(&mut Boat) -> Option<&mut f64>,
) -> Parameter {
    Parameter { name, table: "hull", key, by_default, place }
}

const fn thrusters(name: &'static str, key: &'static str, place: fn(&mut Boat) -> Option<&mut f64>) -> Parameter {
    Parameter { name, table: "thruster", key, by_default: true, place }
}

fn thruster(boat: &mut Boat) -> Option<&mut Thruster> {
    match &mut boat.drive {
        Drive::Thrusters { thruster, .. } => Some(thruster),
        Drive::Kinematic(_) => None,
    }
}

impl Parameter {
    /// Its value in `boat`, if that has it.
    #[must_use]
    pub fn value(&self, boat: &Boat) -> Option<f64> {
        (self.place)(&mut boat.clone()).copied()
    }

    fn set(&self, boat: &mut Boat, value: f64) {
        if let Some(place) = (self.place)(boat) {
            *place = value;
        }
    }
}

/// A parameter as the search moves it: by a factor, so that it stays positive and one step means the same to all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knob {
    pub(super) parameter: Parameter,
    /// The value in the boat that was given.
    pub(super) before: f64,
    /// What the factor multiplies.
    scale: f64,
}

/// How small a number stands for one that the boat has as zero when the search begins.
const FROM_ZERO: f64 = 0.01;

impl Knob {
    pub(super) fn new(parameter: Parameter, boat: &Boat) -> Option<Knob> {
        let before = parameter.value(boat)?;
        let scale = if before > 0.0 { before } else { FROM_ZERO * boat.hull.mass_kg };
        Some(Knob { parameter, before, scale })
    }

    /// The value at a place of the search, where 0 is the beginning.
    pub(super) fn value(&self, at: f64) -> f64 {
        // A factor of e^20 either way is beyond any boat, and short of any overflow.
        self.scale * math::exp(at.clamp(-20.0, 20.0))
    }

    /// Puts the value at a place of the search into a boat.
    pub(super) fn turn(&self, boat: &mut Boat, at: f64) {
        self.parameter.set(boat, self.value(at));
    }
}
