//! A sea file, checked.

use crate::frame::Ned;
use crate::scenario::ledger::Ledger;
use crate::scenario::raw::RawSea;
use crate::scenario::read::Document;
use crate::sea::{Current, Sea};

/// Checks a sea.
pub(in crate::scenario) fn sea(ledger: &mut Ledger, document: &Document<RawSea>) -> Option<Sea> {
    let faults = ledger.faults();
    let raw = &document.raw;
    let current = raw.current.clone().unwrap_or_default();
    let density = ledger.number("water_density_kg_m3", raw.water_density_kg_m3.as_ref(), 900.0..=1300.0);
    let speed = ledger.number("current.speed_m_s", current.speed_m_s.as_ref(), 0.0..=10.0);
    let toward = ledger.number("current.toward_deg", current.toward_deg.as_ref(), -360.0..=360.0);
    let sea = Sea {
        name: document.name.clone(),
        water_density_kg_m3: density.unwrap_or(1000.0),
        depth_m: None,
        waves: None,
        wind: None,
        current: Current {
            mean_m_s: Ned::toward_deg(toward.unwrap_or(0.0)).scaled(speed.unwrap_or(0.0)),
            ..Current::default()
        },
    };
    (ledger.faults() == faults).then_some(sea)
}
