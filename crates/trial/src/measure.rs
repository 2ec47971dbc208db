//! The results of a manoeuvre as numbers.

use super::drift::Drift;
use super::manoeuvre::{DEAD, Manoeuvre, Plan, Sailed, turned_rad};
use super::sample::Sample;
use primitives::angle::compass_deg_from_rad;
use primitives::{Ned, math};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A number with its name and unit; NaN if the boat did not get that far.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
}

fn measure(name: &'static str, value: f64, unit: &'static str) -> Measure {
    Measure { name, value, unit }
}

/// The results of a manoeuvre.
pub fn measures(plan: &Plan, sailed: &Sailed) -> Vec<Measure> {
    let mut list = match plan.manoeuvre {
        Manoeuvre::TurningCircle => turning_circle(plan, sailed),
        Manoeuvre::Zigzag => zigzag(plan, sailed),
        Manoeuvre::CrashStop => crash_stop(plan, sailed),
        Manoeuvre::Acceleration => acceleration(sailed),
        Manoeuvre::Drift => drift(sailed),
        Manoeuvre::Spin => spin(sailed),
    };
    list.push(measure(
        "duration",
        sailed.samples.last().map_or(f64::NAN, |sample| sample.t_s),
        "s",
    ));
    list
}

/// Positions from the start, along the course and to its right, m.
fn along_and_across(plan: &Plan, at: Ned) -> (f64, f64) {
    let (sin, cos) = math::sin_cos(plan.course_rad);
    (
        at.dot(Ned {
            north: cos,
            east: sin,
        }),
        at.dot(Ned {
            north: -sin,
            east: cos,
        }),
    )
}

/// The mean of `of` over samples; NaN without samples.
fn mean(samples: &[Sample], of: impl Fn(&Sample) -> f64) -> f64 {
    samples.iter().map(of).sum::<f64>() / samples.len() as f64
}

/// Advance, transfer and tactical diameter as in MSC.137(76): positions of the midship point at
/// heading changes of 90° and 180°, relative to the position at which the thrusters were set.
/// Steady values are means over the last whole turn.
fn turning_circle(plan: &Plan, sailed: &Sailed) -> Vec<Measure> {
    let turned = turned_rad(&sailed.samples);
    let first = |angle_rad: f64| {
        turned
            .iter()
            .position(|turned| plan.side * turned >= angle_rad)
    };
    let place = |angle_rad: f64| {
        first(angle_rad).map_or((f64::NAN, f64::NAN), |i| {
            along_and_across(plan, sailed.samples[i].at)
        })
    };
    let time = |angle_rad: f64| first(angle_rad).map_or(f64::NAN, |i| sailed.samples[i].t_s);
    let (advance_m, transfer_m) = place(FRAC_PI_2);
    let (_, tactical_m) = place(PI);
    let end = turned.last().copied().unwrap_or(0.0);
    let last_turn = turned
        .iter()
        .position(|turned| (end - turned).abs() <= TAU)
        .unwrap_or(0);
    let steady = if end.abs() >= TAU {
        &sailed.samples[last_turn..]
    } else {
        &[]
    };
    let speed_m_s = mean(steady, Sample::speed_m_s);
    let rate_rad_s = mean(steady, |sample| sample.nu.yaw);
    vec![
        measure("approach speed", sailed.approach_m_s, "m/s"),
        measure("advance at 90°", advance_m, "m"),
        measure("transfer at 90°", plan.side * transfer_m, "m"),
        measure("tactical diameter at 180°", plan.side * tactical_m, "m"),
        measure("time to 90°", time(FRAC_PI_2), "s"),
        measure("time to 180°", time(PI), "s"),
        measure("time to 360°", time(TAU), "s"),
        measure(
            "steady turning diameter",
            2.0 * speed_m_s / rate_rad_s.abs(),
            "m",
        ),
        measure("steady speed", speed_m_s, "m/s"),
        measure("steady yaw rate", rate_rad_s.to_degrees(), "°/s"),
        measure(
            "speed loss",
            100.0 * (1.0 - speed_m_s / sailed.approach_m_s),
            "%",
        ),
    ]
}

/// The overshoot between two switches is how far the heading exceeds the switching angle. The
/// period is the mean over whole swings after the first switch.
fn zigzag(plan: &Plan, sailed: &Sailed) -> Vec<Measure> {
    let turned = turned_rad(&sailed.samples);
    let switches = &sailed.switches;
    let overshoot_deg = |which: usize| {
        let (Some(from), Some(to)) = (switches.get(which), switches.get(which + 1)) else {
            return f64::NAN;
        };
        let side = if which.is_multiple_of(2) {
            plan.side
        } else {
            -plan.side
        };
        let swing = sailed
            .samples
            .iter()
            .zip(&turned)
            .filter(|(sample, _)| (*from..=*to).contains(&sample.t_s));
        let furthest = swing
            .map(|(_, turned)| side * turned)
            .fold(f64::NEG_INFINITY, f64::max);
        (furthest - plan.switch_rad).to_degrees()
    };
    // An even number of half swings, excluding the first.
    let halves = switches.len().saturating_sub(2) / 2 * 2;
    let period_s = match switches.get(1 + halves) {
        Some(last) if halves > 0 => (last - switches[1]) / (halves as f64 / 2.0),
        _ => f64::NAN,
    };
    vec![
        measure("approach speed", sailed.approach_m_s, "m/s"),
        measure(
            "time to first switch",
            switches.first().copied().unwrap_or(f64::NAN),
            "s",
        ),
        measure("first overshoot", overshoot_deg(0), "°"),
        measure("second overshoot", overshoot_deg(1), "°"),
        measure("third overshoot", overshoot_deg(2), "°"),
        measure("period", period_s, "s"),
        measure("switches", switches.len() as f64, ""),
    ]
}

/// Head reach is measured along the course, track reach along the track, until the boat is dead in
/// the water.
fn crash_stop(plan: &Plan, sailed: &Sailed) -> Vec<Measure> {
    let dead = |sample: &Sample| sample.surge_through_water_m_s <= DEAD * sailed.approach_m_s;
    let end = sailed.samples.iter().position(dead);
    let track = &sailed.samples[..end.map_or(0, |end| end + 1)];
    let way_m: f64 = track
        .windows(2)
        .map(|two| two[0].at.distance(two[1].at))
        .sum();
    let last = track.last();
    let (head_m, aside_m) = last.map_or((f64::NAN, f64::NAN), |sample| {
        along_and_across(plan, sample.at)
    });
    vec![
        measure("approach speed", sailed.approach_m_s, "m/s"),
        measure(
            "time to stop",
            last.map_or(f64::NAN, |sample| sample.t_s),
            "s",
        ),
        measure("head reach", head_m, "m"),
        measure(
            "track reach",
            if track.is_empty() { f64::NAN } else { way_m },
            "m",
        ),
        measure("lateral deviation to starboard", aside_m, "m"),
    ]
}

fn acceleration(sailed: &Sailed) -> Vec<Measure> {
    let tenth = sailed.samples.len().div_ceil(10);
    let end = &sailed.samples[sailed.samples.len() - tenth..];
    let steady_m_s = mean(end, |sample| sample.nu.surge);
    let time = |share: f64| {
        let reached = sailed
            .samples
            .iter()
            .find(|sample| sample.nu.surge >= share * steady_m_s);
        reached.map_or(f64::NAN, |sample| sample.t_s)
    };
    vec![
        measure("steady speed", steady_m_s, "m/s"),
        measure("time to 63.2 %", time(0.632), "s"),
        measure("time to 90 %", time(0.9), "s"),
        measure("time to 99 %", time(0.99), "s"),
        measure(
            "distance",
            sailed
                .samples
                .last()
                .map_or(f64::NAN, |sample| sample.at.length()),
            "m",
        ),
    ]
}

fn drift(sailed: &Sailed) -> Vec<Measure> {
    let Some(drift) = Drift::of(&sailed.samples) else {
        return vec![];
    };
    vec![
        measure("drift speed", drift.speed_m_s(), "m/s"),
        measure(
            "drift direction",
            drift.toward_rad().map_or(f64::NAN, compass_deg_from_rad),
            "°",
        ),
        measure("mean heading", compass_deg_from_rad(drift.heading_rad), "°"),
    ]
}

/// Rates over the second half, and the drift of the mean position from one whole turn to the next.
fn spin(sailed: &Sailed) -> Vec<Measure> {
    let turned = turned_rad(&sailed.samples);
    let middle = sailed.samples.len() / 2;
    let half = &sailed.samples[middle..];
    let rate_rad_s = mean(half, |sample| sample.nu.yaw);
    let reached = sailed
        .samples
        .iter()
        .find(|sample| sample.nu.yaw.abs() >= 0.632 * rate_rad_s.abs());
    let sense = turned.last().map_or(1.0, |end| end.signum());
    let end = turned.last().map_or(0.0, |end| end.abs());
    // The mean position and time of the whole turn that began this long before the end.
    let turn = |before_end: f64| {
        let range = end - before_end..=end - before_end + TAU;
        let inside = turned
            .iter()
            .zip(&sailed.samples)
            .filter(|(turned, _)| range.contains(&(sense * **turned)));
        let inside: Vec<Sample> = inside.map(|(_, sample)| *sample).collect();
        let at = Ned {
            north: mean(&inside, |sample| sample.at.north),
            east: mean(&inside, |sample| sample.at.east),
        };
        (at, mean(&inside, |sample| sample.t_s))
    };
    let (last, last_s) = turn(TAU);
    let (before, before_s) = turn(2.0 * TAU);
    let drifts = end >= 2.0 * TAU;
    let drift_m_s = if drifts {
        last.distance(before) / (last_s - before_s)
    } else {
        f64::NAN
    };
    vec![
        measure("steady yaw rate", rate_rad_s.to_degrees(), "°/s"),
        measure(
            "time to 63.2 % of yaw rate",
            reached.map_or(f64::NAN, |sample| sample.t_s),
            "s",
        ),
        measure(
            "turning diameter",
            2.0 * mean(half, Sample::speed_m_s) / rate_rad_s.abs(),
            "m",
        ),
        measure("drift speed", drift_m_s, "m/s"),
        measure(
            "furthest from the start",
            sailed
                .samples
                .iter()
                .map(|sample| sample.at.length())
                .fold(0.0, f64::max),
            "m",
        ),
    ]
}
