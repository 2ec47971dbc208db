//! Radio links and contact reports, checked.

use crate::field::Field;
use crate::frame::Ned;
use crate::id::TeamId;
use crate::link::{Link, Loss, Sharing};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawLink, RawLoss, RawSharing};

/// Checks the link of a game on this field.
pub(super) fn link(diagnostics: &mut Diagnostics, raw: &RawLink, field: &Field) -> Link {
    let station = diagnostics.pair("station", raw.station.as_ref(), -1e6..=1e6);
    Link {
        delay_s: diagnostics.number("delay_s", raw.delay_s.as_ref(), 0.0..=10.0).unwrap_or(0.02),
        jitter_s: diagnostics.number("jitter_s", raw.jitter_s.as_ref(), 0.0..=10.0).unwrap_or(0.0),
        loss: raw.loss.as_ref().map_or_else(Loss::default, |given| loss(diagnostics, &given.value)),
        range_m: diagnostics.number("range_m", raw.range_m.as_ref(), 1.0..=1e6),
        station: station.map_or_else(
            || field.seen_from(TeamId(0), 0.5 * field.plan.width_m, 0.5 * field.plan.depth_m),
            |(x, y)| Ned::from_xy(x, y),
        ),
    }
}

fn loss(diagnostics: &mut Diagnostics, raw: &RawLoss) -> Loss {
    let mut number = |key: &str, given: &Option<At<f64>>, low: f64, high: f64, default: f64| {
        diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(default)
    };
    Loss {
        good: number("good", &raw.good, 0.0, 1.0, 0.0),
        bad: number("bad", &raw.bad, 0.0, 1.0, 0.5),
        good_time_s: number("good_time_s", &raw.good_time_s, 0.0, 86_400.0, 0.0),
        bad_time_s: number("bad_time_s", &raw.bad_time_s, 0.01, 86_400.0, 2.0),
    }
}

/// Checks what is shown of other boats.
pub(super) fn sharing(diagnostics: &mut Diagnostics, raw: &RawSharing) -> Sharing {
    let range_m = diagnostics.number("range_m", raw.range_m.as_ref(), 1.0..=1e6);
    let view_deg = diagnostics.number("view_deg", raw.view_deg.as_ref(), 1.0..=360.0);
    let mut number = |key: &str, given: &Option<At<f64>>, high: f64, default: f64| {
        diagnostics.number(key, given.as_ref(), 0.0..=high).unwrap_or(default)
    };
    Sharing {
        range_m,
        view_rad: view_deg.filter(|view_deg| *view_deg < 360.0).map(f64::to_radians),
        delay_s: number("delay_s", &raw.delay_s, 10.0, 0.0),
        noise_m: number("noise_m", &raw.noise_m, 100.0, 0.0),
        velocity_noise_m_s: number("velocity_noise_m_s", &raw.velocity_noise_m_s, 10.0, 0.0),
        loss: number("loss", &raw.loss, 1.0, 0.0),
        memory_s: number("memory_s", &raw.memory_s, 86_400.0, 10.0),
    }
}
