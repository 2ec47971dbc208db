//! A sea file, checked.

mod current;
mod waves;
mod wind;

use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw;
use crate::scenario::read::Document;
use crate::sea::Sea;

/// Checks a sea.
pub(in crate::scenario) fn sea(diagnostics: &mut Diagnostics, document: &Document<raw::Sea>) -> Option<Sea> {
    let raw = &document.raw;
    let sea = Sea {
        name: document.name.clone(),
        water_density_kg_m3: raw.water_density_kg_m3,
        depth_m: raw.depth_m,
        waves: raw.waves.as_ref().and_then(|waves| waves::waves(diagnostics, document, waves)),
        wind: raw.wind.as_ref().map(wind::wind),
        current: current::current(diagnostics, document, &raw.current),
    };
    document.is_faultless(diagnostics).then_some(sea)
}
