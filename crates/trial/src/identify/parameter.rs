//! Fittable parameters: numbers of a boat or of the water, their keys in a boat file, and how the
//! search varies them.

use primitives::{Ned, math};
use scenario::boat::{Boat, Drive, Thruster};

/// A boat and the water around it.
#[derive(Clone, Debug)]
pub(super) struct Model {
    pub(super) boat: Boat,
    /// Mean current, m/s.
    pub(super) current: Ned,
    /// Mean wind 10 m above the water, as a velocity, m/s; `None` if it is not fitted.
    pub(super) wind: Option<Ned>,
}

/// A fittable number of a boat, or of the water.
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
    place: fn(&mut Model) -> Option<&mut f64>,
}

/// The parameters of the mean current, m/s.
pub const CURRENT: [&str; 2] = ["current_east", "current_north"];
/// The parameters of the mean wind, m/s.
pub const WIND: [&str; 2] = ["wind_east", "wind_north"];

/// All parameters, in the order of reports.
pub const PARAMETERS: [Parameter; 20] = [
    hull("surge_linear", "surge_linear_kg_s", true, |model| {
        Some(&mut model.boat.hull.surge_linear_kg_s)
    }),
    hull("surge_quadratic", "surge_quadratic_kg_m", true, |model| {
        Some(&mut model.boat.hull.surge_quadratic_kg_m)
    }),
    hull("sway_linear", "sway_linear_kg_s", true, |model| {
        Some(&mut model.boat.hull.sway_linear_kg_s)
    }),
    hull("sway_lift", "sway_lift_kg_m", false, |model| {
        Some(&mut model.boat.hull.sway_lift_kg_m)
    }),
    hull("yaw_linear", "yaw_linear_kg_m2_s", true, |model| {
        Some(&mut model.boat.hull.yaw_linear_kg_m2_s)
    }),
    hull("yaw_quadratic", "yaw_quadratic_kg_m2", true, |model| {
        Some(&mut model.boat.hull.yaw_quadratic_kg_m2)
    }),
    hull("yaw_lift", "yaw_lift_kg_m", true, |model| {
        Some(&mut model.boat.hull.yaw_lift_kg_m)
    }),
    hull("munk_factor", "munk_factor", false, |model| {
        Some(&mut model.boat.hull.munk_factor)
    }),
    hull("crossflow", "crossflow_coefficient", false, |model| {
        Some(&mut model.boat.hull.crossflow_coefficient)
    }),
    hull("added_surge", "added_surge_kg", false, |model| {
        Some(&mut model.boat.hull.added_surge_kg)
    }),
    hull("added_sway", "added_sway_kg", false, |model| {
        Some(&mut model.boat.hull.added_sway_kg)
    }),
    hull("added_yaw", "added_yaw_kg_m2", false, |model| {
        Some(&mut model.boat.hull.added_yaw_kg_m2)
    }),
    hull("yaw_inertia", "yaw_inertia_kg_m2", false, |model| {
        Some(&mut model.boat.hull.yaw_inertia_kg_m2)
    }),
    thrusters("port_gain", "port_gain", |model| {
        thruster(&mut model.boat).map(|thruster| &mut thruster.flaws.gain.0)
    }),
    thrusters("starboard_gain", "starboard_gain", |model| {
        thruster(&mut model.boat).map(|thruster| &mut thruster.flaws.gain.1)
    }),
    thrusters("lag", "lag_s", |model| {
        thruster(&mut model.boat).map(|thruster| &mut thruster.lag_s)
    }),
    water(CURRENT[0], "current", |model| Some(&mut model.current.east)),
    water(CURRENT[1], "current", |model| {
        Some(&mut model.current.north)
    }),
    water(WIND[0], "wind", |model| {
        model.wind.as_mut().map(|wind| &mut wind.east)
    }),
    water(WIND[1], "wind", |model| {
        model.wind.as_mut().map(|wind| &mut wind.north)
    }),
];

const fn hull(
    name: &'static str,
    key: &'static str,
    by_default: bool,
    place: fn(&mut Model) -> Option<&mut f64>,
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
    place: fn(&mut Model) -> Option<&mut f64>,
) -> Parameter {
    Parameter {
        table: "thruster",
        ..hull(name, key, true, place)
    }
}

const fn water(
    name: &'static str,
    table: &'static str,
    place: fn(&mut Model) -> Option<&mut f64>,
) -> Parameter {
    Parameter {
        table,
        ..hull(name, "mean", false, place)
    }
}

fn thruster(boat: &mut Boat) -> Option<&mut Thruster> {
    match &mut boat.drive {
        Drive::Thrusters { thruster, .. } => Some(thruster),
        Drive::Kinematic(_) => None,
    }
}

impl Parameter {
    /// Its value in `boat`, if present; 0 for a parameter of the water.
    pub fn value(&self, boat: &Boat) -> Option<f64> {
        self.value_in(&Model {
            boat: boat.clone(),
            current: Ned::default(),
            wind: Some(Ned::default()),
        })
    }

    fn value_in(&self, model: &Model) -> Option<f64> {
        (self.place)(&mut model.clone()).copied()
    }

    /// Whether it belongs to the water rather than the boat.
    pub fn is_of_water(&self) -> bool {
        CURRENT.contains(&self.name) || WIND.contains(&self.name)
    }
}

/// A parameter as varied by the search. Those of the boat are multiplied by a factor, so that they
/// stay positive and steps are comparable; those of the water are shifted by a difference.
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
    pub(super) fn new(parameter: Parameter, model: &Model) -> Option<Knob> {
        let before = parameter.value_in(model)?;
        let scale = if before > 0.0 {
            before
        } else {
            FROM_ZERO * model.boat.hull.mass_kg
        };
        Some(Knob {
            parameter,
            before,
            scale,
        })
    }

    /// The value at a search coordinate, where 0 is the start.
    pub(super) fn value(&self, at: f64) -> f64 {
        if self.parameter.is_of_water() {
            return self.before + at;
        }
        // A factor of e^20 either way exceeds any real boat but does not overflow.
        self.scale * math::exp(at.clamp(-20.0, 20.0))
    }

    /// The change of the value per change of the search coordinate.
    pub(super) fn slope(&self, at: f64) -> f64 {
        if self.parameter.is_of_water() {
            1.0
        } else {
            self.value(at)
        }
    }

    /// Sets the value at a search coordinate.
    pub(super) fn turn(&self, model: &mut Model, at: f64) {
        if let Some(place) = (self.parameter.place)(model) {
            *place = self.value(at);
        }
    }
}
