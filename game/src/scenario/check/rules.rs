//! A rules file, checked.

use super::link::sharing;
use crate::link::Sharing;
use crate::rules::{CaptureAt, Points, Rules, TagChoice, TaggedBoat, UntagAt, UntagOn};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawRules};
use crate::scenario::read::Document;
use crate::time::SimTime;

/// Distances at which something happens, m.
const REACH_M: std::ops::RangeInclusive<f64> = 0.1..=1000.0;

/// Checks rules.
pub(in crate::scenario) fn rules(diagnostics: &mut Diagnostics, document: &Document<RawRules>) -> Option<Rules> {
    let faults = diagnostics.faults();
    let raw = &document.raw;
    let points = raw.points.clone().unwrap_or_default();
    let is_set = |given: &Option<At<bool>>, default: bool| given.as_ref().map_or(default, |given| given.value);
    let mut number = |key: &str, given: &Option<At<f64>>, allowed, default: f64| {
        diagnostics.number(key, given.as_ref(), allowed).unwrap_or(default)
    };
    let mut rules = Rules {
        name: document.name.clone(),
        points: Points { grab: 0, capture: 0, tag: 0 },
        grab_radius_m: number("grab_radius_m", &raw.grab_radius_m, REACH_M, 10.0),
        tag_radius_m: number("tag_radius_m", &raw.tag_radius_m, REACH_M, 10.0),
        untag_radius_m: number("untag_radius_m", &raw.untag_radius_m, REACH_M, 10.0),
        capture_radius_m: number("capture_radius_m", &raw.capture_radius_m, REACH_M, 10.0),
        collision_distance_m: number("collision_distance_m", &raw.collision_distance_m, 0.0..=100.0, 3.0),
        capture_at: raw.capture_at.map_or(CaptureAt::OwnFlag, CaptureAt::from),
        capture_needs_own_flag: is_set(&raw.capture_needs_own_flag, false),
        untag_at: raw.untag_at.map_or(UntagAt::OwnFlag, UntagAt::from),
        untag_on: raw.untag_on.map_or(UntagOn::Entering, UntagOn::from),
        tag_cooldown: SimTime::from_s(number("tag_cooldown_s", &raw.tag_cooldown_s, 0.0..=86400.0, 10.0)),
        tag_choice: raw.tag_choice.map_or(TagChoice::Nearest, TagChoice::from),
        boundary_tags: is_set(&raw.boundary_tags, true),
        tagged_boat: raw.tagged_boat.map_or(TaggedBoat::DrivesItself, TaggedBoat::from),
        tagged_speed_factor: number("tagged_speed_factor", &raw.tagged_speed_factor, 0.05..=1.0, 1.0),
        outside_speed_factor: number("outside_speed_factor", &raw.outside_speed_factor, 0.05..=1.0, 1.0),
        flag_keepout_m: number("flag_keepout_m", &raw.flag_keepout_m, 0.0..=1000.0, 0.0),
        sharing: Sharing::default(),
        win_score: None,
        time_limit: SimTime::from_s(number("time_limit_s", &raw.time_limit_s, 1.0..=86400.0, 600.0)),
        power_play: SimTime::from_s(number("power_play_s", &raw.power_play_s, 0.0..=86400.0, 0.0)),
    };
    let win_score = diagnostics.whole("win_score", raw.win_score.as_ref(), 0..=1_000_000, 0);
    rules.win_score = (win_score > 0).then_some(win_score as u32);
    rules.points = Points {
        grab: diagnostics.whole("grab", points.grab.as_ref(), 0..=1000, 1) as u32,
        capture: diagnostics.whole("capture", points.capture.as_ref(), 0..=1000, 2) as u32,
        tag: diagnostics.whole("tag", points.tag.as_ref(), 0..=1000, 0) as u32,
    };
    rules.sharing = raw.sharing.as_ref().map_or_else(Sharing::default, |given| sharing(diagnostics, &given.value));
    if diagnostics.faults() == faults {
        homes_can_be_reached(diagnostics, raw, &rules);
    }
    (diagnostics.faults() == faults).then_some(rules)
}

/// A keep-out circle must leave room at the own flag for what boats have to do there.
fn homes_can_be_reached(diagnostics: &mut Diagnostics, raw: &RawRules, rules: &Rules) {
    let Some(given) = &raw.flag_keepout_m else { return };
    let needed = [
        (rules.untag_at == UntagAt::OwnFlag, "untag_radius_m", rules.untag_radius_m),
        (rules.capture_at == CaptureAt::OwnFlag, "capture_radius_m", rules.capture_radius_m),
    ];
    for (key, radius_m) in needed.into_iter().filter(|(applies, ..)| *applies).map(|(_, key, radius_m)| (key, radius_m))
    {
        if rules.flag_keepout_m >= radius_m {
            let found = rules.flag_keepout_m;
            diagnostics
                .note(given.at, format!("flag_keepout_m is {found}, expected less than {key}, which is {radius_m}"));
        }
    }
}
