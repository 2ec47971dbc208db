//! Radio links and contact reports, checked.

use crate::field::Field;
use crate::frame::Ned;
use crate::id::TeamId;
use crate::link::{Link, Sharing};
use crate::scenario::raw;

/// The link of a game on this field.
pub(super) fn link(raw: &raw::Link, field: &Field) -> Link {
    let middle = || field.seen_from(TeamId(0), 0.5 * field.plan.width_m, 0.5 * field.plan.depth_m);
    Link {
        delay_s: raw.delay_s,
        jitter_s: raw.jitter_s,
        loss: raw.loss.unwrap_or_default(),
        range_m: raw.range_m,
        station: raw.station.map_or_else(middle, |[x, y]| Ned::from_xy(x, y)),
    }
}

/// What is shown of other boats.
pub(super) fn sharing(raw: &raw::Sharing) -> Sharing {
    Sharing {
        range_m: raw.range_m,
        view_rad: (raw.view_deg < 360.0).then(|| raw.view_deg.to_radians()),
        delay_s: raw.delay_s,
        noise_m: raw.noise_m,
        velocity_noise_m_s: raw.velocity_noise_m_s,
        loss: raw.loss,
        memory_s: raw.memory_s,
    }
}
