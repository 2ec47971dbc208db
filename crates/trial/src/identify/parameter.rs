//! Fittable parameters: numbers of a boat, their keys in a boat file, and how the search varies
//! them.

use primitives::math;
use scenario::boat::{Boat, Drive, Thruster};

/// A fittable number of a boat.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its table in a boat file.
    pub table: &'static str,
    /// Its key in that table.
    pub key: &'static str,
    /// Whether it is fitted by default.
    pub by_default: bool,
    place: fn(&mut Boat) -> Option<&mut f64>,
}

/// All parameters, in the order of reports.
pub const PARAMETERS: [Parameter; 16] = [
    hull("surge_linear", "surge_linear_kg_s", true, |boat| {
        Some(&mut boat.hull.surge_linear_kg_s)
    }),
    hull("surge_quadratic", "surge_quadratic_kg_m", true, |boat| {
        Some(&mut boat.hull.surge_quadratic_kg_m)
    }),
    hull("sway_linear", "sway_linear_kg_s", true, |boat| {
        Some(&mut boat.hull.sway_linear_kg_s)
    }),
    hull("sway_lift", "sway_lift_kg_m", false, |boat| {
        Some(&mut boat.hull.sway_lift_kg_m)
    }),
    hull("yaw_linear", "yaw_linear_kg_m2_s", true, |boat| {
        Some(&mut boat.hull.yaw_linear_kg_m2_s)
    }),
    hull("yaw_quadratic", "yaw_quadratic_kg_m2", true, |boat| {
        Some(&mut boat.hull.yaw_quadratic_kg_m2)
    }),
    hull("yaw_lift", "yaw_lift_kg_m", true, |boat| {
        Some(&mut boat.hull.yaw_lift_kg_m)
    }),
    hull("munk_factor", "munk_factor", false, |boat| {
        Some(&mut boat.hull.munk_factor)
    }),
    hull("crossflow", "crossflow_coefficient", false, |boat| {
        Some(&mut boat.hull.crossflow_coefficient)
    }),
    hull("added_surge", "added_surge_kg", false, |boat| {
        Some(&mut boat.hull.added_surge_kg)
    }),
    hull("added_sway", "added_sway_kg", false, |boat| {
        Some(&mut boat.hull.added_sway_kg)
    }),
    hull("added_yaw", "added_yaw_kg_m2", false, |boat| {
        Some(&mut boat.hull.added_yaw_kg_m2)
    }),
    hull("yaw_inertia", "yaw_inertia_kg_m2", false, |boat| {
        Some(&mut boat.hull.yaw_inertia_kg_m2)
    }),
    thrusters("port_gain", "port_gain", |boat| {
        thruster(boat).map(|thruster| &mut thruster.flaws.gain.0)
    }),
    thrusters("starboard_gain", "starboard_gain", |boat| {
        thruster(boat).map(|thruster| &mut thruster.flaws.gain.1)
    }),
    thrusters("lag", "lag_s", |boat| {
        thruster(boat).map(|thruster| &mut thruster.lag_s)
    }),
];

const fn hull(
    name: &'static str,
    key: &'static str,
    by_default: bool,
    place: fn(&mut Boat) -> Option<&mut f64>,
) -> Parameter {
    Parameter {
        name,
        table: "hull",
        key,
        by_default,
        place,
    }
}

const fn thrusters(
    name: &'static str,
    key: &'static str,
    place: fn(&mut Boat) -> Option<&mut f64>,
) -> Parameter {
    Parameter {
        name,
        table: "thruster",
        key,
        by_default: true,
        place,
    }
}

fn thruster(boat: &mut Boat) -> Option<&mut Thruster> {
    match &mut boat.drive {
        Drive::Thrusters { thruster, .. } => Some(thruster),
        Drive::Kinematic(_) => None,
    }
}

impl Parameter {
    /// Its value in `boat`, if present.
    pub fn value(&self, boat: &Boat) -> Option<f64> {
        (self.place)(&mut boat.clone()).copied()
    }

    fn set(&self, boat: &mut Boat, value: f64) {
        if let Some(place) = (self.place)(boat) {
            *place = value;
        }
    }
}

/// A parameter as varied by the search: by a factor, so that it stays positive and steps are
/// comparable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knob {
    pub(super) parameter: Parameter,
    /// The value in the initial boat.
    pub(super) before: f64,
    /// The factor's base value.
    scale: f64,
}

/// Initial value of a parameter that is zero in the boat at the start of the search.
const FROM_ZERO: f64 = 0.01;

impl Knob {
    pub(super) fn new(parameter: Parameter, boat: &Boat) -> Option<Knob> {
        let before = parameter.value(boat)?;
        let scale = if before > 0.0 {
            before
        } else {
            FROM_ZERO * boat.hull.mass_kg
        };
        Some(Knob {
            parameter,
            before,
            scale,
        })
    }

    /// The value at a search coordinate, where 0 is the start.
    pub(super) fn value(&self, at: f64) -> f64 {
        // A factor of e^20 either way exceeds any real boat but does not overflow.
        self.scale * math::exp(at.clamp(-20.0, 20.0))
    }

    /// Sets the value at a search coordinate in a boat.
    pub(super) fn turn(&self, boat: &mut Boat, at: f64) {
        self.parameter.set(boat, self.value(at));
    }
}
