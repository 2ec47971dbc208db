//! Open water: a sea, and a field without obstacles.

use primitives::Ned;
use primitives::frame::LatLon;
use rules::Field;
use rules::field::{Plan, Walls};
use scenario::sea::{Current, Sea};

/// Extent of the field in each direction, m. It limits only the positions of random eddies; boats
/// and the sea continue beyond it.
const FIELD_M: f64 = 1000.0;
/// Density of sea water, kg/m³.
const SEA_WATER_KG_M3: f64 = 1025.0;

/// The default sea of a trial: salt water at rest, no wind.
pub fn still_sea() -> Sea {
    Sea {
        name: "still".into(),
        water_density_kg_m3: SEA_WATER_KG_M3,
        ..Sea::at_rest()
    }
}

/// Replaces the mean current of `sea`. Its other currents (tide, shear, eddies) remain.
pub fn set_mean_current(sea: &mut Sea, speed_m_s: f64, toward_deg: f64) {
    let toward = Ned::toward_deg(toward_deg);
    let wander = sea
        .current
        .wander
        .map(|wander| scenario::sea::Wander { toward, ..wander });
    sea.current = Current {
        mean_m_s: toward.scaled(speed_m_s),
        wander,
        ..sea.current.clone()
    };
}

/// A field without walls or obstacles around the datum.
pub fn open_field() -> Field {
    Field::new(Plan {
        name: "open_water".into(),
        datum: LatLon::default(),
        corner: Ned::from_xy(-0.5 * FIELD_M, -0.5 * FIELD_M),
        along_deg: 90.0,
        width_m: FIELD_M,
        depth_m: FIELD_M,
        flag_inset_m: 0.125 * FIELD_M,
        extra_flags: vec![],
        default_flags: Default::default(),
        obstacles: vec![],
        walls: Walls::None,
    })
}
