//! A sea file, checked.

mod current;
mod waves;
mod wind;

use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::RawSea;
use crate::scenario::read::Document;
use crate::sea::{Current, Sea};

/// Checks a sea.
pub(in crate::scenario) fn sea(diagnostics: &mut Diagnostics, document: &Document<RawSea>) -> Option<Sea> {
    let faults = diagnostics.faults();
    let raw = &document.raw;
    let density = diagnostics.number("water_density_kg_m3", raw.water_density_kg_m3.as_ref(), 900.0..=1300.0);
    let depth_m = diagnostics.number("depth_m", raw.depth_m.as_ref(), 0.5..=12_000.0);
    let wind = raw.wind.as_ref().and_then(|given| wind::wind(diagnostics, given));
    let waves = raw.waves.as_ref().and_then(|given| waves::waves(diagnostics, given, raw.wind.as_ref(), depth_m));
    let current = raw.current.as_ref().map_or_else(Current::default, |given| current::current(diagnostics, given));
    let sea = Sea {
        name: document.name.clone(),
        water_density_kg_m3: density.unwrap_or(1000.0),
        depth_m,
        waves,
        wind,
        current,
    };
    (diagnostics.faults() == faults).then_some(sea)
}
