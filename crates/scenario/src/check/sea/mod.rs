//! Checks a sea file.

mod current;
mod waves;

use crate::kind::ScenarioFile;
use crate::raw;
use crate::read::Document;
use crate::sea::{Gusts, Sea, Wind};
use current::current;
use waves::waves;

impl ScenarioFile for Sea {
    type Keys = raw::Sea;
    const NAME: &'static str = "sea";
    const FOLDER: &'static str = "seas";

    fn check(document: &Document<raw::Sea>) -> Option<Sea> {
        let raw = &document.raw;
        let sea = Sea {
            name: document.name.clone(),
            water_density_kg_m3: raw.water_density_kg_m3,
            depth_m: raw.depth_m,
            waves: raw.waves.as_ref().and_then(|raw| waves(document, raw)),
            wind: raw.wind.as_ref().map(wind),
            current: current(document, &raw.current),
        };
        document.is_faultless().then_some(sea)
    }
}

fn wind(raw: &raw::Wind) -> Wind {
    let gusts = match raw.gusts {
        raw::Gusts::None => Gusts::None,
        raw::Gusts::OrnsteinUhlenbeck => Gusts::OrnsteinUhlenbeck {
            intensity: raw.intensity,
            across_ratio: raw.across_ratio,
            length_m: raw.length_m,
        },
    };
    Wind {
        speed_10m_m_s: raw.speed_m_s,
        from_rad: raw.from_deg.to_radians(),
        profile_exponent: raw.profile_exponent,
        gusts,
    }
}
