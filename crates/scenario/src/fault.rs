//! Faults of boats during a game, at a fixed time or repeatedly.
//!
//! Like everything in a game, they depend on its seed. Spontaneous failures, such as a receiver
//! that freezes or a link that loses messages in bursts, are defined with the sensor or the link.

use primitives::id::VehicleId;
use primitives::reseed::Seeds;
use primitives::stream::Stream;
use primitives::time::SimTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// The agent is lost: the boat holds, reports nothing and accepts no orders. Afterwards the
    /// agent restarts without its memory.
    AgentLost,
    /// Orders do not reach the boat, nor do its reports reach the team. Its orders expire.
    LinkLost,
    /// The receiver repeats the last fix with new times.
    GpsFrozen,
    /// The receiver outputs no fix.
    GpsLost,
    /// Fixes are off by `offset_m` in a random direction.
    GpsOffset,
    /// The compass is off by `offset_deg`.
    CompassOffset,
    /// The port thruster stops.
    PortLost,
    /// The starboard thruster stops.
    StarboardLost,
    /// The port thruster keeps its thrust.
    PortStuck,
    /// The starboard thruster keeps its thrust.
    StarboardStuck,
}

/// A fault during the game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fault {
    /// The kind of fault.
    pub kind: FaultKind,
    /// Names of the affected boats; random times are drawn separately for each. Default: all.
    #[schemars(length(max = 10000))]
    pub boats: Vec<String>,
    /// Start, s.
    #[schemars(range(min = 0, max = 86400))]
    pub at_s: Option<f64>,
    /// Instead of `at_s`: mean of the exponentially distributed time to the next fault, s.
    #[schemars(range(min = 0.1, max = 1000000))]
    pub every_s: Option<f64>,
    /// Duration, s. Default: to the end of the game.
    #[schemars(range(min = 0, max = 86400))]
    pub for_s: Option<f64>,
    /// Position error, m, for "gps_offset".
    #[schemars(range(min = 0, max = 10000))]
    pub offset_m: Option<f64>,
    /// Compass error clockwise, degrees, for "compass_offset".
    #[schemars(range(min = -180, max = 180))]
    pub offset_deg: Option<f64>,
    /// The fault's name in the file.
    #[serde(default)]
    #[schemars(skip)]
    pub name: String,
    /// The affected boats.
    #[serde(default)]
    #[schemars(skip)]
    pub vehicles: Vec<VehicleId>,
}

/// A fault of one boat during one period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultSpan {
    /// The kind of fault.
    pub kind: FaultKind,
    /// Start.
    pub from: SimTime,
    /// End.
    pub to: SimTime,
    /// The offset of fixes, m.
    pub offset_m: f64,
    /// The direction of the offset, rad.
    pub direction_rad: f64,
    /// The compass error, rad.
    pub offset_rad: f64,
}

impl FaultSpan {
    /// Whether the fault is active at `now`.
    #[inline]
    pub fn is_on(&self, now: SimTime) -> bool {
        self.from <= now && now < self.to
    }
}

/// The faults of one vehicle in the game with `seeds` that begin before `end`, sorted by start.
pub fn fault_spans(
    faults: &[Fault],
    (vehicle, name): (VehicleId, &str),
    seeds: &Seeds,
    end: SimTime,
) -> Vec<FaultSpan> {
    let mut spans = vec![];
    for fault in faults
        .iter()
        .filter(|fault| fault.vehicles.contains(&vehicle))
    {
        let stream = |seed: u64| Stream::new(seed, &format!("fault/{}/{name}", fault.name));
        let mut later = seeds.later().iter().peekable();
        let mut drawn = stream(seeds.first());
        let lasts = fault.for_s.map_or(end, SimTime::from_s);
        let wait = |stream: &mut Stream| {
            let mean_s = fault.every_s?;
            // Not `log(unit)`: a unit of 0 would give an infinite wait.
            Some(SimTime::from_s(
                (-mean_s * libm::log1p(-stream.unit())).min(1e7),
            ))
        };
        let mut next = fault.at_s.map(SimTime::from_s).or_else(|| wait(&mut drawn));
        let mut over = SimTime::ZERO;
        while let Some(mut from) = next.filter(|from| *from < end) {
            while let Some((after, seed)) = later.next_if(|(after, _)| *after < from) {
                drawn = stream(*seed);
                // Exponential waits have no memory: the rest of a wait has the same distribution as
                // a new wait.
                from = wait(&mut drawn).map_or(from, |wait| over.max(*after) + wait);
            }
            if from >= end {
                break;
            }
            over = from + lasts;
            spans.push(FaultSpan {
                kind: fault.kind,
                from,
                to: over,
                offset_m: fault.offset_m.unwrap_or(0.0),
                direction_rad: std::f64::consts::TAU * drawn.unit(),
                offset_rad: fault.offset_deg.unwrap_or(0.0).to_radians(),
            });
            // Wait at least 1 ms, so that the loop ends even with faults of zero duration.
            next = wait(&mut drawn).map(|wait| over + wait.max(SimTime(1_000_000)));
        }
    }
    spans.sort_by_key(|span| span.from);
    spans
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::reseed::Reseed;

    fn fault() -> Fault {
        Fault {
            kind: FaultKind::LinkLost,
            boats: vec![],
            at_s: None,
            every_s: None,
            for_s: None,
            offset_m: None,
            offset_deg: None,
            name: "one".to_owned(),
            vehicles: vec![VehicleId(0), VehicleId(1)],
        }
    }

    const HOUR: SimTime = SimTime(3_600_000_000_000);

    #[test]
    fn a_fault_with_a_time_happens_then_and_one_without_end_lasts() {
        let at = Fault {
            at_s: Some(30.0),
            ..fault()
        };
        let of = |fault: &Fault, vehicle, name| {
            fault_spans(
                std::slice::from_ref(fault),
                (VehicleId(vehicle), name),
                &1.into(),
                HOUR,
            )
        };
        let spans = of(&at, 0, "a");
        assert_eq!(spans.len(), 1);
        let on = |s: f64| spans[0].is_on(SimTime::from_s(s));
        assert_eq!([29.9, 30.0, 3599.9].map(on), [false, true, true]);
        let short = Fault {
            for_s: Some(5.0),
            ..at.clone()
        };
        let short = &of(&short, 1, "b")[0];
        let ends = [30.0, 35.0].map(SimTime::from_s);
        assert_eq!([short.from, short.to], ends);
        assert_eq!(of(&at, 2, "c"), []);
    }

    #[test]
    fn drawn_faults_come_as_often_as_stated_and_at_other_times_for_every_boat_and_seed() {
        let drawn = Fault {
            every_s: Some(50.0),
            for_s: Some(10.0),
            ..fault()
        };
        let of = |vehicle: u16, name, seed: u64| {
            fault_spans(
                std::slice::from_ref(&drawn),
                (VehicleId(vehicle), name),
                &seed.into(),
                HOUR,
            )
        };
        let count: usize = (0..100).map(|seed| of(0, "a", seed).len()).sum();
        // Expected: 6000 faults in 100 games of 3600 s with one every 60 s, with a standard
        // deviation of about 65.
        assert!((5700..6300).contains(&count), "{count}");
        assert_ne!(of(0, "a", 1)[0].from, of(1, "b", 1)[0].from);
        assert_ne!(of(0, "a", 1)[0].from, of(0, "a", 2)[0].from);
        let spans = of(0, "a", 1);
        assert!(spans.windows(2).all(|pair| pair[0].to < pair[1].from));
    }

    #[test]
    fn another_seed_changes_what_begins_after_its_time_and_neither_what_was_before_nor_how_often() {
        let drawn = Fault {
            every_s: Some(50.0),
            for_s: Some(10.0),
            ..fault()
        };
        let of = |seeds: &Seeds| {
            fault_spans(
                std::slice::from_ref(&drawn),
                (VehicleId(0), "a"),
                seeds,
                HOUR,
            )
        };
        let half = SimTime::from_s(1800.0);
        let first = of(&1.into());
        let mut counts = [0, 0];
        for seed in 2..202 {
            let after_s = 1800.0;
            let again = of(&Seeds::new(1, &[Reseed { after_s, seed }]));
            let until =
                |spans: &[FaultSpan]| spans.iter().take_while(|span| span.from <= half).count();
            assert_eq!(first[..until(&first)], again[..until(&again)]);
            assert_ne!(first[until(&first)..], again[until(&again)..]);
            let within = |from_s: f64, to_s: f64| {
                let is_within = |span: &&FaultSpan| (from_s..to_s).contains(&span.from.as_s());
                again.iter().filter(is_within).count()
            };
            counts[0] += within(1800.0, 1860.0);
            counts[1] += within(2800.0, 2860.0);
        }
        // Expected: 200 faults in 200 windows of 60 s with one every 60 s, with a standard
        // deviation of about 8 if the games are independent.
        assert!((160..240).contains(&counts[1]), "{counts:?}");
        // All games have the same faults as `first` until the reseed, and its last one ends before
        // that.
        let last = first.iter().rfind(|span| span.from <= half);
        let last = last.expect("there is one");
        assert!(last.to < half, "the seed of this test leaves no span open");
        // A minute that starts without a fault has 60/50 waits minus the duration of the spans:
        // 1.03 faults on average.
        assert!((165..245).contains(&counts[0]), "{counts:?}");
    }
}
