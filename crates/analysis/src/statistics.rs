//! Statistics of each boat in a game.

use crate::quantile::Quantile;
use crate::step::{Sample, Step};
use primitives::Ned;
use primitives::angle::wrap_pi;
use rules::count::{Counts, Tally};
use scenario::{Scenario, Source};
use serde::{Deserialize, Serialize};

/// Statistics of one boat in a game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoatStatistics {
    /// The boat.
    pub boat: String,
    /// Its team.
    pub team: String,
    /// Whether it is a real boat. Its true state is then its gateway's report.
    pub is_real: bool,
    /// Length of its track (m), with straight segments between decisions.
    pub distance_m: f64,
    /// Mean speed over the ground, m/s.
    pub speed_mean_m_s: f64,
    /// Highest speed over the ground, m/s.
    pub speed_max_m_s: f64,
    /// Time tagged, s.
    pub tagged_s: f64,
    /// Time outside the field, s.
    pub outside_s: f64,
    /// Time carrying a flag, s.
    pub carrying_s: f64,
    /// Time without an agent, s.
    pub agent_lost_s: f64,
    /// Time with unknown position, s.
    pub nav_lost_s: f64,
    /// Counts of its events.
    pub counts: Counts,
    /// Error of its own navigation.
    pub navigation: Option<NavigationError>,
    /// Error of its heading and speed relative to its orders.
    pub steering: Option<SteeringError>,
}

/// Error of a boat's own navigation, as in its mind's picture, against the true state of the same
/// sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavigationError {
    /// Root mean square, m.
    pub rms_m: f64,
    /// 95th percentile, m; up to one part in 128 too large.
    pub p95_m: f64,
}

/// Deviation of a boat from its ordered heading and speed while it was free to follow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SteeringError {
    /// Heading error, root mean square, degrees.
    pub heading_rms_deg: f64,
    /// Error of the speed ahead, root mean square, m/s.
    pub speed_rms_m_s: f64,
    /// Duration of this measurement, s.
    pub steered_s: f64,
}

/// Builds the statistics of all boats decision by decision. Only sums are kept.
pub struct StatisticsBuilder {
    /// Time of the previous decision, s.
    before_s: Option<f64>,
    span_s: f64,
    tally: Tally,
    boats: Vec<BoatSums>,
}

#[derive(Default)]
struct BoatSums {
    /// The statistics. Means, counts and errors are valid after the last decision.
    sums: BoatStatistics,
    before: Option<Ned>,
    travelled_m: f64,
    nav_error: MeanSquare,
    nav_errors_m: Quantile,
    heading_error: MeanSquare,
    speed_error: MeanSquare,
    steered_s: f64,
}

impl StatisticsBuilder {
    /// Starts before the first decision of a game.
    pub fn new(scenario: &Scenario) -> StatisticsBuilder {
        let boat = |vehicle: &scenario::Vehicle| BoatSums {
            sums: BoatStatistics {
                boat: vehicle.name.clone(),
                team: scenario
                    .teams
                    .get(vehicle.team.index())
                    .map(|team| team.name.clone())
                    .unwrap_or_default(),
                is_real: vehicle.source == Source::External,
                ..BoatStatistics::default()
            },
            ..BoatSums::default()
        };
        let boats: Vec<BoatSums> = scenario.vehicles.iter().map(boat).collect();
        StatisticsBuilder {
            before_s: None,
            span_s: 0.0,
            tally: Tally::new(boats.len()),
            boats,
        }
    }

    /// Adds a decision.
    pub fn add(&mut self, step: &Step) {
        step.events
            .iter()
            .for_each(|logged| self.tally.add(logged.event));
        // A decision covers the time since the previous one, and the first covers none.
        let step_s = step.time_s - self.before_s.replace(step.time_s).unwrap_or(step.time_s);
        self.span_s += step_s;
        self.boats
            .iter_mut()
            .zip(&step.samples)
            .for_each(|(boat, sample)| boat.add(sample, step_s));
    }

    /// The statistics, by vehicle index.
    pub fn end(self) -> Vec<BoatStatistics> {
        self.boats
            .into_iter()
            .zip(self.tally.vehicles)
            .map(|(boat, counts)| boat.end(counts, self.span_s))
            .collect()
    }
}

impl BoatSums {
    fn add(&mut self, sample: &Sample, step_s: f64) {
        let at = sample.truth.at();
        let sums = &mut self.sums;
        sums.distance_m += self
            .before
            .replace(at)
            .map_or(0.0, |before| before.distance(at));
        sums.speed_max_m_s = sums.speed_max_m_s.max(sample.truth.speed_m_s());
        self.travelled_m += sample.truth.speed_m_s() * step_s;
        for (is, lasted_s) in [
            (sample.tagged, &mut sums.tagged_s),
            (sample.outside, &mut sums.outside_s),
            (sample.carrying, &mut sums.carrying_s),
            (sample.agent_lost, &mut sums.agent_lost_s),
            (sample.nav_lost, &mut sums.nav_lost_s),
        ] {
            *lasted_s += if is { step_s } else { 0.0 };
        }
        if let Some(error_m) = sample.nav_error_m() {
            self.nav_error.add(error_m);
            self.nav_errors_m.add(error_m);
        }
        if let Some((heading_rad, speed_m_s)) = sample.steered() {
            self.heading_error
                .add(wrap_pi(sample.truth.psi_rad - heading_rad));
            self.speed_error.add(sample.truth.surge_m_s - speed_m_s);
            self.steered_s += step_s;
        }
    }

    fn end(self, counts: Counts, span_s: f64) -> BoatStatistics {
        let navigation = self.nav_error.root().zip(self.nav_errors_m.at(0.95));
        let steering = self.heading_error.root().zip(self.speed_error.root());
        let steered_s = self.steered_s;
        BoatStatistics {
            speed_mean_m_s: if span_s > 0.0 {
                self.travelled_m / span_s
            } else {
                0.0
            },
            counts,
            navigation: navigation.map(|(rms_m, p95_m)| NavigationError { rms_m, p95_m }),
            steering: steering.map(|(heading_rad, speed_rms_m_s)| SteeringError {
                heading_rms_deg: heading_rad.to_degrees(),
                speed_rms_m_s,
                steered_s,
            }),
            ..self.sums
        }
    }
}

/// A mean of squares, accumulated value by value.
#[derive(Clone, Copy, Debug, Default)]
struct MeanSquare {
    sum: f64,
    count: u64,
}

impl MeanSquare {
    fn add(&mut self, number: f64) {
        (self.sum, self.count) = (self.sum + number * number, self.count + 1);
    }

    /// The square root of the mean; `None` without values.
    fn root(self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum / self.count as f64).sqrt())
    }
}

/// The root mean square; `None` without values.
pub(crate) fn rms(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let mut mean = MeanSquare::default();
    numbers.for_each(|number| mean.add(number));
    mean.root()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up;
    use crate::series::GameSeries;
    use messages::Order;
    use messages::picture::Nav;
    use std::path::Path;

    /// The statistics of a synthetic game.
    fn statistics(series: &GameSeries) -> Vec<BoatStatistics> {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
        let scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let mut builder = StatisticsBuilder::new(&scenario);
        for (i, time_s) in series.times_s.iter().copied().enumerate() {
            let samples = series.boats.iter().map(|boat| boat.samples[i]).collect();
            builder.add(&Step {
                time_s,
                samples,
                ..Step::default()
            });
        }
        builder.end()
    }

    #[test]
    fn a_boat_on_a_circle_sails_its_circumference_at_its_speed() {
        // One turn in 100 s: chords of a tenth of a second are too short by a millionth.
        let statistics = &statistics(&made_up::circle(20.0, 100.0))[0];
        let round_m = std::f64::consts::TAU * 20.0;
        assert!(
            (statistics.distance_m / round_m - 1.0).abs() < 1e-5,
            "{} m",
            statistics.distance_m
        );
        for speed_m_s in [statistics.speed_mean_m_s, statistics.speed_max_m_s] {
            assert!(
                (speed_m_s - round_m / 100.0).abs() < 1e-9,
                "{speed_m_s} m/s"
            );
        }
        assert_eq!((statistics.navigation, statistics.steering), (None, None));
    }

    #[test]
    fn the_worst_of_twenty_is_beyond_the_percentile() {
        let mut series = made_up::circle(20.0, 1.9);
        assert_eq!(series.times_s.len(), 20);
        for (i, sample) in series.boats[0].samples.iter_mut().enumerate() {
            let off_m = if i == 7 { 100.0 } else { 1.0 };
            sample.estimated = Some(Nav {
                north_m: sample.truth.north_m + off_m,
                ..sample.truth
            });
        }
        let error = statistics(&series)[0].navigation.expect("it was shown");
        assert!((error.p95_m - 1.0).abs() < 1e-9, "{error:?}");
        assert!(
            (error.rms_m - (10_019.0_f64 / 20.0).sqrt()).abs() < 1e-9,
            "{error:?}"
        );
    }

    #[test]
    fn steering_counts_only_while_a_boat_is_free_to() {
        let mut series = made_up::circle(20.0, 10.0);
        for (i, sample) in series.boats[0].samples.iter_mut().enumerate() {
            let heading_rad = sample.truth.psi_rad + 0.1 + std::f64::consts::TAU;
            sample.order = Order::Steer {
                heading_rad,
                speed_m_s: sample.truth.surge_m_s + 0.5,
            };
            sample.is_free = i > 50;
            sample.tagged = i <= 50;
            sample.carrying = i > 90;
        }
        let statistics = &statistics(&series)[0];
        let error = statistics.steering.expect("it was ordered");
        assert!(
            (error.heading_rms_deg - 0.1_f64.to_degrees()).abs() < 1e-9,
            "{error:?}"
        );
        assert!(
            (error.speed_rms_m_s - 0.5).abs() < 1e-9 && (error.steered_s - 5.0).abs() < 1e-9,
            "{error:?}"
        );
        assert!(
            (statistics.tagged_s - 5.0).abs() < 1e-9 && (statistics.carrying_s - 1.0).abs() < 1e-9
        );
        for none_s in [
            statistics.outside_s,
            statistics.agent_lost_s,
            statistics.nav_lost_s,
        ] {
            assert_eq!(format!("{none_s:.1}"), "0.0");
        }
    }

    #[test]
    fn an_empty_game_has_no_bad_numbers() {
        let mut series = made_up::circle(20.0, 0.0);
        for boat in &mut series.boats {
            boat.samples.clear();
        }
        series.times_s.clear();
        let statistics = &statistics(&series)[0];
        assert_eq!(
            (
                statistics.distance_m,
                statistics.speed_mean_m_s,
                statistics.speed_max_m_s
            ),
            (0.0, 0.0, 0.0)
        );
    }
}
