//! Flags with their own radii and paths, in whole games.

use crate::files::{loaded, watch};
use primitives::{Ned, SimTime, VehicleId};
use rules::Event;
use sim::Contest;

/// Red's flag circles between (140, 40) and (140, 70) at 0.5 m/s, and blue's between (20, 40) and
/// (20, 10). Boats request grabs.
const FILES: [(&str, &str); 3] = [
    (
        "game.toml",
        "base = \"SCENARIOS/games/attack_1v1.toml\"\nfield = \"field.toml\"\nrules = \"rules.toml\"\n",
    ),
    (
        "rules.toml",
        "base = \"SCENARIOS/rules/aquaticus_2023.toml\"\ntags_and_grabs = \"on_request\"\n",
    ),
    (
        "field.toml",
        "base = \"SCENARIOS/fields/aquaticus_160x80.toml\"\n\
         [[flag]]\nteam = \"second\"\ngrab_radius_m = 18\nroute = { points = [[140, 70]], speed_m_s = 0.5 }\n\
         [[flag]]\nteam = \"first\"\ncapture_radius_m = 4\nroute = { points = [[20, 10]], speed_m_s = 0.5 }\n",
    ),
];

/// The first event that `is_it` accepts, and the attacker's position at the decision after it.
fn first(contest: &Contest, is_it: impl Fn(Event) -> bool) -> Option<(SimTime, Ned)> {
    let logged = contest.events().iter().find(|logged| is_it(logged.event))?;
    let at = contest.world().state().boats[0].pose.at;
    (contest.now() - logged.at < contest.scenario().decision()).then_some((logged.at, at))
}

#[test]
fn an_attacker_follows_moving_flags_and_acts_within_their_own_radii() {
    let scenario = loaded(&FILES);
    let attacker = VehicleId(0);
    let (mut grabbed, mut captured) = (None, None);
    watch(&scenario, |contest, _| {
        let is_grab = |e| matches!(e, Event::Grabbed { vehicle, .. } if vehicle == attacker);
        let is_capture = |e| matches!(e, Event::Captured { vehicle, .. } if vehicle == attacker);
        grabbed = grabbed.or_else(|| first(contest, is_grab));
        captured = captured.or_else(|| first(contest, is_capture));
        captured.is_none()
    });
    let flags = &scenario.field.flags;
    let (now, at) = grabbed.expect("a grab");
    let off_m = at.distance(flags[1].home(now));
    assert!((17.0..18.5).contains(&off_m), "grabbed from {off_m} m");
    let moved_m = flags[1].home(now).distance(flags[1].start);
    assert!(moved_m > 10.0, "the flag has moved {moved_m} m");
    let (now, at) = captured.expect("a capture");
    let off_m = at.distance(flags[0].home(now));
    assert!((3.0..4.5).contains(&off_m), "captured from {off_m} m");
}
