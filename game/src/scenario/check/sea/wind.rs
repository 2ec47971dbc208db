//! Wind.

use crate::scenario::raw;
use crate::sea::{Gusts, Wind};

/// The wind of a sea.
pub(super) fn wind(raw: &raw::Wind) -> Wind {
    let raw::Wind { intensity, across_ratio, length_m, .. } = *raw;
    let gusts = match raw.gusts {
        raw::Gusts::None => Gusts::None,
        raw::Gusts::OrnsteinUhlenbeck => Gusts::OrnsteinUhlenbeck { intensity, across_ratio, length_m },
    };
    Wind {
        speed_10m_m_s: raw.speed_m_s,
        from_rad: raw.from_deg.to_radians(),
        profile_exponent: raw.profile_exponent,
        gusts,
    }
}
