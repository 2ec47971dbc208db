//! Checks a rules file.

use crate::kind::ScenarioFile;
use crate::read::Document;
use rules::{CaptureAt, Radii, Rules, UntagAt};

impl ScenarioFile for Rules {
    type Keys = Rules;
    const NAME: &'static str = "rules";
    const FOLDER: &'static str = "rules";

    fn check(document: &Document<Rules>) -> Option<Rules> {
        let mut rules = document.raw.clone();
        rules.win_score = rules.win_score.filter(|win_score| *win_score > 0);
        let sharing = &mut rules.sharing;
        sharing.view_rad = sharing.view_rad.filter(|rad| *rad < f64::to_radians(360.0));
        for message in keepout_faults(&rules, rules.radii()) {
            if document.is_sound("") {
                document.note("flag_keepout_m", message);
            }
        }
        document.is_faultless().then_some(rules)
    }
}

/// Faults in the radii of a flag: outside its keep-out circle, its boats must still be able to
/// capture and untag there.
pub(super) fn keepout_faults(rules: &Rules, radii: Radii) -> impl Iterator<Item = String> {
    let found_m = radii.keepout_m;
    let needed = [
        (
            rules.untag_at == UntagAt::OwnFlag,
            "untag_radius_m",
            radii.untag_m,
        ),
        (
            rules.capture_at == CaptureAt::OwnFlag,
            "capture_radius_m",
            radii.capture_m,
        ),
    ];
    let is_broken = move |(applies, _, radius_m): &(bool, _, f64)| *applies && found_m >= *radius_m;
    needed
        .into_iter()
        .filter(is_broken)
        .map(move |(_, key, radius_m)| {
            format!("flag_keepout_m is {found_m}, expected less than {key}, which is {radius_m}")
        })
}
