//! A gateway file, checked.

use super::boat::thrust_map;
use crate::gateway::{Gateway, Loops};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw;
use crate::scenario::read::Document;

/// Checks a gateway.
pub(in crate::scenario) fn gateway(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Gateway>,
) -> Option<Gateway> {
    let raw = &document.raw;
    let gateway = Gateway {
        name: document.name.clone(),
        drive: raw.drive,
        declination_rad: raw.declination_deg.map(f64::to_radians),
        compass: raw.compass,
        rate_hz: raw.rate_hz,
        order_ttl_s: raw.order_ttl_s,
        upload_gap_s: raw.upload_gap_s,
        limits: raw.limits,
        nav: raw.nav,
        geofence: raw.geofence,
        halt: raw.halt,
        battery: raw.battery,
        control: raw.control,
        loops: Loops {
            thrust_map: thrust_map(diagnostics, document, "loops.thrust_map", &raw.loops.thrust_map),
            speed_pct_per_m_s: raw.loops.speed_pct_per_m_s,
            speed_integral_s: raw.loops.speed_integral_s,
            heading_pct_per_rad: raw.loops.heading_pct_per_deg.to_degrees(),
            turn_pct_per_rad_s: raw.loops.turn_pct_per_deg_s.to_degrees(),
        },
    };
    document.is_faultless(diagnostics).then_some(gateway)
}
