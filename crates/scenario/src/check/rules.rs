//! Checks a rules file.

use crate::kind::ScenarioFile;
use crate::read::Document;
use rules::{CaptureAt, Rules, UntagAt};

impl ScenarioFile for Rules {
    type Keys = Rules;
    const NAME: &'static str = "rules";
    const FOLDER: &'static str = "rules";

    fn check(document: &Document<Rules>) -> Option<Rules> {
        let mut rules = document.raw.clone();
        rules.win_score = rules.win_score.filter(|win_score| *win_score > 0);
        let sharing = &mut rules.sharing;
        sharing.view_rad = sharing.view_rad.filter(|rad| *rad < f64::to_radians(360.0));
        // Outside a keep-out circle, boats must still be able to grab, capture and untag at their
        // own flag.
        let needed = [
            (
                rules.untag_at == UntagAt::OwnFlag,
                "untag_radius_m",
                rules.untag_radius_m,
            ),
            (
                rules.capture_at == CaptureAt::OwnFlag,
                "capture_radius_m",
                rules.capture_radius_m,
            ),
        ];
        for (applies, key, radius_m) in needed {
            let found_m = rules.flag_keepout_m;
            if applies && found_m >= radius_m && document.is_sound("") {
                let message = format!(
                    "flag_keepout_m is {found_m}, expected less than {key}, which is {radius_m}"
                );
                document.note("flag_keepout_m", message);
            }
        }
        document.is_faultless().then_some(rules)
    }
}
