//! What a boat did in a game, in statistics.

use crate::series::{BoatSeries, GameSeries, Sample};
use game::angle::wrap_pi;
use game::count::{Counts, Tally};
use serde::{Deserialize, Serialize};

/// A boat's game in statistics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoatStatistics {
    /// The boat.
    pub boat: String,
    /// Its team.
    pub team: String,
    /// Whether it is a real one. Its truth is then what its gateway reported.
    pub is_real: bool,
    /// The length of its track, m: straight from decision to decision.
    pub distance_m: f64,
    /// Mean speed over the ground, m/s.
    pub speed_mean_m_s: f64,
    /// Highest speed over the ground, m/s.
    pub speed_max_m_s: f64,
    /// How long it was tagged, s.
    pub tagged_s: f64,
    /// How long it was outside of the field, s.
    pub outside_s: f64,
    /// How long it carried a flag, s.
    pub carrying_s: f64,
    /// How long it had no mind, s.
    pub agent_lost_s: f64,
    /// How long nobody knew where it was, s.
    pub nav_lost_s: f64,
    /// What it did, how often.
    pub counts: Counts,
    /// How far its own navigation was from the truth.
    pub navigation: Option<NavigationError>,
    /// How well it kept to what it was ordered.
    pub steering: Option<SteeringError>,
}

/// How far a boat's own navigation, as its mind was shown it, was from the truth of that sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavigationError {
    /// Root mean square, m.
    pub rms_m: f64,
    /// Nineteen of twenty were not more, m.
    pub p95_m: f64,
}

/// How far a boat was from the heading and the speed it was ordered, while it was free to follow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteeringError {
    /// Of the heading, root mean square, degrees.
    pub heading_rms_deg: f64,
    /// Of the speed ahead, root mean square, m/s.
    pub speed_rms_m_s: f64,
    /// For how much of the game this could be told, s.
    pub steered_s: f64,
}

/// The statistics of all boats.
#[must_use]
pub(crate) fn statistics(series: &GameSeries) -> Vec<BoatStatistics> {
    let mut tally = Tally::new(series.boats.len());
    series.events.iter().for_each(|logged| tally.add(logged.event));
    let steps_s: Vec<f64> = series.steps_s().collect();
    series.boats.iter().zip(tally.vehicles).map(|(boat, counts)| of(boat, counts, &steps_s, &series.teams)).collect()
}

fn of(boat: &BoatSeries, counts: Counts, steps_s: &[f64], teams: &[String]) -> BoatStatistics {
    let lasted = |is: fn(&Sample) -> bool| {
        let steps = boat.samples.iter().zip(steps_s).filter(|(sample, _)| is(sample));
        total(steps.map(|(_, step_s)| *step_s))
    };
    let span_s = total(steps_s.iter().copied());
    let travelled_m = boat.samples.iter().zip(steps_s).map(|(sample, step_s)| sample.truth.speed_m_s() * step_s);
    BoatStatistics {
        boat: boat.name.clone(),
        team: teams.get(boat.team).cloned().unwrap_or_default(),
        is_real: boat.is_real,
        distance_m: length_m(boat),
        speed_mean_m_s: if span_s > 0.0 { total(travelled_m) / span_s } else { 0.0 },
        speed_max_m_s: boat.samples.iter().map(|sample| sample.truth.speed_m_s()).fold(0.0, f64::max),
        tagged_s: lasted(|sample| sample.tagged),
        outside_s: lasted(|sample| sample.outside),
        carrying_s: lasted(|sample| sample.carrying),
        agent_lost_s: lasted(|sample| sample.agent_lost),
        nav_lost_s: lasted(|sample| sample.nav_lost),
        counts,
        navigation: navigation(boat),
        steering: steering(boat, steps_s),
    }
}

fn length_m(boat: &BoatSeries) -> f64 {
    total(boat.samples.windows(2).map(|two| two[0].truth.at().distance(two[1].truth.at())))
}

fn navigation(boat: &BoatSeries) -> Option<NavigationError> {
    let mut errors_m: Vec<f64> = boat.samples.iter().filter_map(Sample::nav_error_m).collect();
    errors_m.sort_by(f64::total_cmp);
    // The nearest rank: the smallest error that nineteen of twenty do not exceed.
    let rank = (0.95 * errors_m.len() as f64).ceil() as usize;
    let p95_m = *errors_m.get(rank.saturating_sub(1))?;
    Some(NavigationError { rms_m: rms(errors_m.iter().copied())?, p95_m })
}

fn steering(boat: &BoatSeries, steps_s: &[f64]) -> Option<SteeringError> {
    let steered = || boat.samples.iter().filter_map(|sample| Some((sample.truth, sample.steered()?)));
    let heading_rad = rms(steered().map(|(truth, (heading_rad, _))| wrap_pi(truth.psi_rad - heading_rad)))?;
    let speed_rms_m_s = rms(steered().map(|(truth, (_, speed_m_s))| truth.surge_m_s - speed_m_s))?;
    let steps = boat.samples.iter().zip(steps_s).filter(|(sample, _)| sample.steered().is_some());
    let steered_s = total(steps.map(|(_, step_s)| *step_s));
    Some(SteeringError { heading_rms_deg: heading_rad.to_degrees(), speed_rms_m_s, steered_s })
}

/// The sum, which of nothing is 0: that of the library is then -0.
fn total(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |sum, number| sum + number)
}

/// The root of the mean square; none of nothing.
pub(crate) fn rms(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = numbers.fold((0.0, 0_u32), |(sum, count), number| (sum + number * number, count + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up;
    use game::Order;
    use game::event::{Event, Logged, TagCause};
    use game::picture::Nav;
    use game::{FlagId, SimTime, VehicleId};

    #[test]
    fn a_boat_on_a_circle_sails_its_circumference_at_its_speed() {
        // Once round in 100 s: chords of a tenth of a second are a millionth short.
        let statistics = &statistics(&made_up::circle(20.0, 100.0))[0];
        let round_m = std::f64::consts::TAU * 20.0;
        assert!((statistics.distance_m / round_m - 1.0).abs() < 1e-5, "{} m", statistics.distance_m);
        for speed_m_s in [statistics.speed_mean_m_s, statistics.speed_max_m_s] {
            assert!((speed_m_s - round_m / 100.0).abs() < 1e-9, "{speed_m_s} m/s");
        }
        assert_eq!((statistics.navigation, statistics.steering), (None, None));
    }

    #[test]
    fn an_estimate_off_by_3_and_4_is_off_by_5() {
        let mut series = made_up::circle(20.0, 10.0);
        for sample in &mut series.boats[0].samples {
            let Nav { north_m, east_m, .. } = sample.truth;
            sample.estimated = Some(Nav { north_m: north_m + 3.0, east_m: east_m - 4.0, ..sample.truth });
        }
        let error = statistics(&series)[0].navigation.expect("it was shown");
        assert!((error.rms_m - 5.0).abs() < 1e-9 && (error.p95_m - 5.0).abs() < 1e-9, "{error:?}");
    }

    #[test]
    fn the_worst_of_twenty_is_beyond_the_percentile() {
        let mut series = made_up::circle(20.0, 1.9);
        assert_eq!(series.times_s.len(), 20);
        for (i, sample) in series.boats[0].samples.iter_mut().enumerate() {
            let off_m = if i == 7 { 100.0 } else { 1.0 };
            sample.estimated = Some(Nav { north_m: sample.truth.north_m + off_m, ..sample.truth });
        }
        let error = statistics(&series)[0].navigation.expect("it was shown");
        assert!((error.p95_m - 1.0).abs() < 1e-9, "{error:?}");
        assert!((error.rms_m - (10_019.0_f64 / 20.0).sqrt()).abs() < 1e-9, "{error:?}");
    }

    #[test]
    fn steering_counts_only_while_a_boat_is_free_to() {
        let mut series = made_up::circle(20.0, 10.0);
        for (i, sample) in series.boats[0].samples.iter_mut().enumerate() {
            let heading_rad = sample.truth.psi_rad + 0.1 + std::f64::consts::TAU;
            sample.order = Order::Steer { heading_rad, speed_m_s: sample.truth.surge_m_s + 0.5 };
            sample.is_free = i > 50;
            sample.tagged = i <= 50;
            sample.carrying = i > 90;
        }
        let statistics = &statistics(&series)[0];
        let error = statistics.steering.expect("it was ordered");
        assert!((error.heading_rms_deg - 0.1_f64.to_degrees()).abs() < 1e-9, "{error:?}");
        assert!((error.speed_rms_m_s - 0.5).abs() < 1e-9 && (error.steered_s - 5.0).abs() < 1e-9, "{error:?}");
        assert!((statistics.tagged_s - 5.0).abs() < 1e-9 && (statistics.carrying_s - 1.0).abs() < 1e-9);
        for none_s in [statistics.outside_s, statistics.agent_lost_s, statistics.nav_lost_s] {
            assert_eq!(format!("{none_s:.1}"), "0.0");
        }
    }

    #[test]
    fn what_happened_is_counted() {
        let mut series = made_up::circle(20.0, 1.0);
        let vehicle = VehicleId(0);
        let flag = FlagId(1);
        let tagged = Event::Tagged { vehicle, cause: TagCause::Boundary };
        for event in [Event::Grabbed { vehicle, flag }, tagged, Event::Grabbed { vehicle, flag }] {
            series.events.push(Logged { tick: 1, at: SimTime::ZERO, event });
        }
        let counts = statistics(&series)[0].counts;
        assert_eq!((counts.grabs, counts.tagged, counts.tags), (2, 1, 0));
    }

    #[test]
    fn an_empty_book_has_no_bad_numbers() {
        let mut series = made_up::circle(20.0, 0.0);
        for boat in &mut series.boats {
            boat.samples.clear();
        }
        series.times_s.clear();
        let statistics = &statistics(&series)[0];
        assert_eq!((statistics.distance_m, statistics.speed_mean_m_s, statistics.speed_max_m_s), (0.0, 0.0, 0.0));
    }
}
