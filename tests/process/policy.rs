//! Policies outside the helm: a separate program proposes actions, and the helm weighs them against
//! staying inside the field.

use crate::support::{Sim, own};
use bus::{Bus, Declaration, Priority};
use messages::topic::{self, GameName};
use messages::{Frame, GameInfo, Message, Picture, PolicyProposal, Stamp};
use primitives::{TeamId, VehicleId, codec};
use std::sync::{Arc, Mutex};
use std::time::Duration;

const ME: VehicleId = VehicleId(0);

/// A policy in a separate program: it receives the picture and always wants to drive north in a
/// zigzag. Occasionally it is slow.
fn drive_north(bus: &Bus, name: &GameName, info: &GameInfo) -> Declaration {
    let publisher = bus
        .publisher(topic::policy(name, &info.scenario, ME), Priority::Normal)
        .expect("the hub is up");
    let answer = move |bytes: &[u8]| {
        let picture: Picture = codec::decode(bytes).expect("a picture");
        let stamp = Stamp {
            version: PolicyProposal::VERSION,
            ..picture.stamp
        };
        let course_rad = if stamp.seq % 10 < 5 { 0.4 } else { -0.4 };
        let proposal = PolicyProposal {
            stamp,
            vehicle: ME,
            course_rad,
            speed_m_s: 2.0,
        };
        if stamp.seq.is_multiple_of(7) {
            std::thread::sleep(Duration::from_millis(3));
        }
        // Invalid messages in between have no effect.
        publisher
            .send(&PolicyProposal {
                course_rad: f64::NAN,
                ..proposal
            })
            .unwrap_or_default();
        publisher
            .send(&PolicyProposal {
                vehicle: VehicleId(1),
                course_rad: 3.0,
                ..proposal
            })
            .unwrap_or_default();
        publisher.send(&proposal).unwrap_or_default();
    };
    bus.subscribe(topic::picture(name, &info.scenario, TeamId(0)), answer)
        .expect("the hub is up")
}

/// Plays a game with or without the policy; returns the result and the frames.
fn play(is_safe: bool, has_policy: bool) -> (serde_json::Value, Vec<Frame>) {
    let sim = Sim::start("still_1v1", &[]);
    let bus = sim.bus();
    let name = sim.name();
    let info = sim.info(&bus);
    let frames = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&frames);
    let see = move |bytes: &[u8]| {
        seen.lock()
            .expect("whole")
            .push(codec::decode(bytes).expect("a frame"))
    };
    let _seen = bus
        .subscribe(topic::frame(&name), see)
        .expect("the hub is up");
    let _policy = has_policy.then(|| drive_north(&bus, &name, &info));
    // A strategy with a policy, with or without the behaviour that keeps the boat inside.
    let strategy = own(if is_safe { "told" } else { "told_unsafe" });
    let wait: &[&str] = if has_policy {
        &["--policy-wait-s", "2"]
    } else {
        &[]
    };
    let args = ["agent", "--vehicle", "blue_1", "--strategy", &strategy];
    let _told = sim.quiet(&[&args[..], wait].concat());
    let _still = sim.agent(&["red_1"]);
    let done = sim.wait_for_kind("done");
    let frames = frames.lock().expect("whole").clone();
    (done["outcome"].clone(), frames)
}

#[test]
fn a_boat_follows_a_policy_but_not_out_of_the_field_and_the_game_is_the_same_again() {
    let (outcome, frames) = play(true, true);
    let (again, _) = play(true, true);
    assert_eq!(
        outcome["digest"], again["digest"],
        "waiting for a policy makes no difference"
    );
    assert!(frames.len() > 500, "{} frames", frames.len());
    let navs: Vec<_> = frames
        .iter()
        .map(|frame| &frame.vehicles[ME.index()].nav)
        .collect();
    let north_m = navs
        .iter()
        .map(|nav| nav.north_m)
        .fold(f64::NEG_INFINITY, f64::max)
        - navs[0].north_m;
    assert!(north_m > 20.0, "it moved {north_m} m north");
    assert!(
        frames
            .iter()
            .all(|frame| !frame.vehicles[ME.index()].outside),
        "it stayed inside"
    );
    assert_eq!(outcome["counts"]["boats"]["blue_1"]["agents_lost"], 0);
    // Without a behaviour that keeps the boat inside, the same policy drives it out.
    let (_, frames) = play(false, true);
    assert!(
        frames
            .iter()
            .any(|frame| frame.vehicles[ME.index()].outside),
        "it went out"
    );
}

#[test]
fn without_a_policy_the_boat_lies_still() {
    let (_, frames) = play(true, false);
    let at = |frame: &Frame| frame.vehicles[ME.index()].nav.at();
    let first = frames.first().expect("frames");
    let last = frames.last().expect("frames");
    assert!(at(first).distance(at(last)) < 1.0);
}
