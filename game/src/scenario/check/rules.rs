//! A rules file, checked.

use super::link::sharing;
use crate::link::Sharing;
use crate::rules::{CaptureAt, Rules, UntagAt};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw;
use crate::scenario::read::Document;
use crate::time::SimTime;

/// Checks rules.
pub(in crate::scenario) fn rules(diagnostics: &mut Diagnostics, document: &Document<raw::Rules>) -> Option<Rules> {
    let raw = &document.raw;
    let rules = Rules {
        name: document.name.clone(),
        points: raw.points,
        grab_radius_m: raw.grab_radius_m,
        tag_radius_m: raw.tag_radius_m,
        untag_radius_m: raw.untag_radius_m,
        capture_radius_m: raw.capture_radius_m,
        collision_distance_m: raw.collision_distance_m,
        capture_at: raw.capture_at,
        capture_needs_own_flag: raw.capture_needs_own_flag,
        untag_at: raw.untag_at,
        untag_on: raw.untag_on,
        tag_cooldown: SimTime::from_s(raw.tag_cooldown_s),
        tag_choice: raw.tag_choice,
        boundary_tags: raw.boundary_tags,
        tagged_boat: raw.tagged_boat,
        tagged_speed_factor: raw.tagged_speed_factor,
        outside_speed_factor: raw.outside_speed_factor,
        sharing: raw.sharing.as_ref().map_or_else(Sharing::default, sharing),
        flag_keepout_m: raw.flag_keepout_m,
        win_score: (raw.win_score > 0).then_some(raw.win_score),
        time_limit: SimTime::from_s(raw.time_limit_s),
        power_play: SimTime::from_s(raw.power_play_s),
    };
    // A keep-out circle must leave room at the own flag for what boats have to do there.
    let needed = [
        (rules.untag_at == UntagAt::OwnFlag, "untag_radius_m", rules.untag_radius_m),
        (rules.capture_at == CaptureAt::OwnFlag, "capture_radius_m", rules.capture_radius_m),
    ];
    for (applies, key, radius_m) in needed {
        let found_m = rules.flag_keepout_m;
        if applies && found_m >= radius_m && document.is_sound("") {
            let message = format!("flag_keepout_m is {found_m}, expected less than {key}, which is {radius_m}");
            diagnostics.note(document.at("flag_keepout_m"), message);
        }
    }
    document.is_faultless(diagnostics).then_some(rules)
}
