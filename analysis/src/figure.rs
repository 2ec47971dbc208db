//! What a boat did in a game, in figures.

use super::book::{Boat, Book, Moment};
use game::angle::wrap_pi;
use game::count::{Counts, Tally};
use serde::{Deserialize, Serialize};

/// A boat's game in figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
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

/// How far a boat's own navigation, as its mind was shown it, was from the truth of that moment.
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

/// The figures of all boats.
#[must_use]
pub(super) fn figures(book: &Book) -> Vec<Figures> {
    let mut tally = Tally::new(book.boats.len());
    book.events.iter().for_each(|logged| tally.add(logged.event));
    let steps_s: Vec<f64> = book.steps_s().collect();
    book.boats.iter().zip(tally.vehicles).map(|(boat, counts)| of(boat, counts, &steps_s, &book.teams)).collect()
}

fn of(boat: &Boat, counts: Counts, steps_s: &[f64], teams: &[String]) -> Figures {
    let lasted = |is: fn(&Moment) -> bool| {
        let steps = boat.moments.iter().zip(steps_s).filter(|(moment, _)| is(moment));
        total(steps.map(|(_, step_s)| *step_s))
    };
    let span_s = total(steps_s.iter().copied());
    let travelled_m = boat.moments.iter().zip(steps_s).map(|(moment, step_s)| moment.speed_m_s() * step_s);
    Figures {
        boat: boat.name.clone(),
        team: teams.get(boat.team).cloned().unwrap_or_default(),
        is_real: boat.is_real,
        distance_m: length_m(boat),
        speed_mean_m_s: if span_s > 0.0 { total(travelled_m) / span_s } else { 0.0 },
        speed_max_m_s: boat.moments.iter().map(Moment::speed_m_s).fold(0.0, f64::max),
        tagged_s: lasted(|moment| moment.tagged),
        outside_s: lasted(|moment| moment.outside),
        carrying_s: lasted(|moment| moment.carrying),
        agent_lost_s: lasted(|moment| moment.agent_lost),
        nav_lost_s: lasted(|moment| moment.nav_lost),
        counts,
        navigation: navigation(boat),
        steering: steering(boat, steps_s),
    }
}

fn length_m(boat: &Boat) -> f64 {
    total(boat.moments.windows(2).map(|two| two[0].truth.at().distance(two[1].truth.at())))
}

fn navigation(boat: &Boat) -> Option<NavigationError> {
    let mut errors_m: Vec<f64> = boat.moments.iter().filter_map(Moment::nav_error_m).collect();
    errors_m.sort_by(f64::total_cmp);
    // The nearest rank: the smallest error that nineteen of twenty do not exceed.
    let rank = (0.95 * errors_m.len() as f64).ceil() as usize;
    let p95_m = *errors_m.get(rank.saturating_sub(1))?;
    Some(NavigationError { rms_m: rms(errors_m.iter().copied())?, p95_m })
}

fn steering(boat: &Boat, steps_s: &[f64]) -> Option<SteeringError> {
    let steered = || boat.moments.iter().filter_map(|moment| Some((moment.truth, moment.steered()?)));
    let heading_rad = rms(steered().map(|(truth, (heading_rad, _))| wrap_pi(truth.psi_rad - heading_rad)))?;
    let speed_rms_m_s = rms(steered().map(|(truth, (_, speed_m_s))| truth.surge_m_s - speed_m_s))?;
    let steps = boat.moments.iter().zip(steps_s).filter(|(moment, _)| moment.steered().is_some());
    let steered_s = total(steps.map(|(_, step_s)| *step_s));
    Some(SteeringError { heading_rms_deg: heading_rad.to_degrees(), speed_rms_m_s, steered_s })
}

/// The sum, which of nothing is 0: that of the library is then -0.
fn total(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |sum, number| sum + number)
}

/// The root of the mean square; none of nothing.
pub(super) fn rms(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = numbers.fold((0.0, 0_u32), |(sum, count), number| (sum + number * number, count + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use game::Order;
    use game::event::{Event, Logged, TagCause};
    use game::picture::Nav;
    use game::{FlagId, SimTime, VehicleId};

    #[test]
    fn a_boat_on_a_circle_sails_its_circumference_at_its_speed() {
        // Once round in 100 s: chords of a tenth of a second are a millionth short.
        let figures = &figures(&sample::circle(20.0, 100.0))[0];
        let round_m = std::f64::consts::TAU * 20.0;
        assert!((figures.distance_m / round_m - 1.0).abs() < 1e-5, "{} m", figures.distance_m);
        for speed_m_s in [figures.speed_mean_m_s, figures.speed_max_m_s] {
            assert!((speed_m_s - round_m / 100.0).abs() < 1e-9, "{speed_m_s} m/s");
        }
        assert_eq!((figures.navigation, figures.steering), (None, None));
    }

    #[test]
    fn an_estimate_off_by_3_and_4_is_off_by_5() {
        let mut book = sample::circle(20.0, 10.0);
        for moment in &mut book.boats[0].moments {
            let Nav { north_m, east_m, .. } = moment.truth;
            moment.believed = Some(Nav { north_m: north_m + 3.0, east_m: east_m - 4.0, ..moment.truth });
        }
        let error = figures(&book)[0].navigation.expect("it was shown");
        assert!((error.rms_m - 5.0).abs() < 1e-9 && (error.p95_m - 5.0).abs() < 1e-9, "{error:?}");
    }

    #[test]
    fn the_worst_of_twenty_is_beyond_the_percentile() {
        let mut book = sample::circle(20.0, 1.9);
        assert_eq!(book.times_s.len(), 20);
        for (i, moment) in book.boats[0].moments.iter_mut().enumerate() {
            let off_m = if i == 7 { 100.0 } else { 1.0 };
            moment.believed = Some(Nav { north_m: moment.truth.north_m + off_m, ..moment.truth });
        }
        let error = figures(&book)[0].navigation.expect("it was shown");
        assert!((error.p95_m - 1.0).abs() < 1e-9, "{error:?}");
        assert!((error.rms_m - (10_019.0_f64 / 20.0).sqrt()).abs() < 1e-9, "{error:?}");
    }

    #[test]
    fn steering_counts_only_while_a_boat_is_free_to() {
        let mut book = sample::circle(20.0, 10.0);
        for (i, moment) in book.boats[0].moments.iter_mut().enumerate() {
            let heading_rad = moment.truth.psi_rad + 0.1 + std::f64::consts::TAU;
            moment.order = Order::Steer { heading_rad, speed_m_s: moment.truth.surge_m_s + 0.5 };
            moment.is_free = i > 50;
            moment.tagged = i <= 50;
            moment.carrying = i > 90;
        }
        let figures = &figures(&book)[0];
        let error = figures.steering.expect("it was ordered");
        assert!((error.heading_rms_deg - 0.1_f64.to_degrees()).abs() < 1e-9, "{error:?}");
        assert!((error.speed_rms_m_s - 0.5).abs() < 1e-9 && (error.steered_s - 5.0).abs() < 1e-9, "{error:?}");
        assert!((figures.tagged_s - 5.0).abs() < 1e-9 && (figures.carrying_s - 1.0).abs() < 1e-9);
        for none_s in [figures.outside_s, figures.agent_lost_s, figures.nav_lost_s] {
            assert_eq!(format!("{none_s:.1}"), "0.0");
        }
    }

    #[test]
    fn what_happened_is_counted() {
        let mut book = sample::circle(20.0, 1.0);
        let vehicle = VehicleId(0);
        let flag = FlagId(1);
        let tagged = Event::Tagged { vehicle, cause: TagCause::Boundary };
        for event in [Event::Grabbed { vehicle, flag }, tagged, Event::Grabbed { vehicle, flag }] {
            book.events.push(Logged { tick: 1, at: SimTime::ZERO, event });
        }
        let counts = figures(&book)[0].counts;
        assert_eq!((counts.grabs, counts.tagged, counts.tags), (2, 1, 0));
    }

    #[test]
    fn an_empty_book_has_no_bad_numbers() {
        let mut book = sample::circle(20.0, 0.0);
        for boat in &mut book.boats {
            boat.moments.clear();
        }
        book.times_s.clear();
        let figures = &figures(&book)[0];
        assert_eq!((figures.distance_m, figures.speed_mean_m_s, figures.speed_max_m_s), (0.0, 0.0, 0.0));
    }
}
