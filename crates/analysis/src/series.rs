//! A recorded game as time series for plots and comparisons; long games are reduced to every nth
//! decision.

use crate::step::{Sample, Step, for_each_step};
use primitives::Ned;
use recording::{Damaged, Recording};
use rules::event::Logged;
use scenario::Source;

/// Maximum number of samples of all boats together, about 160 bytes each. Longer games are
/// downsampled.
const SAMPLES_MAX: usize = 1_000_000;

/// A game as time series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GameSeries {
    /// The downsampling factor: every nth decision is included, and so is the last.
    pub every: usize,
    /// Times of the samples, s.
    pub times_s: Vec<f64>,
    /// Boats, by vehicle index.
    pub boats: Vec<BoatSeries>,
    /// The names of the teams.
    pub teams: Vec<String>,
    /// Points, by sample and team.
    pub score: Vec<Vec<u32>>,
    /// All events in the frames.
    pub events: Vec<Logged>,
    /// Damaged messages.
    pub damaged: Damaged,
}

/// A boat as time series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoatSeries {
    /// Its name.
    pub name: String,
    /// Its team's index.
    pub team: usize,
    /// Whether it is a real boat, whose true state is its gateway's report.
    pub is_real: bool,
    /// Samples, in time order.
    pub samples: Vec<Sample>,
}

impl BoatSeries {
    /// Its true positions, sample by sample.
    pub fn track(&self) -> impl ExactSizeIterator<Item = Ned> + '_ {
        self.samples.iter().map(|sample| sample.truth.at())
    }
}

impl GameSeries {
    /// Reads a recording in one pass. Damaged messages are skipped and counted.
    pub fn of(recording: &Recording) -> GameSeries {
        GameSeries::of_at_most(recording, SAMPLES_MAX)
    }

    /// Like [`GameSeries::of`], downsampled to at most this many samples of all boats together,
    /// plus the last decision.
    pub fn of_at_most(recording: &Recording, samples_max: usize) -> GameSeries {
        let scenario = recording.scenario();
        let all = recording
            .frame_count()
            .saturating_mul(scenario.vehicles.len());
        let every = all.div_ceil(samples_max).max(1);
        let boat = |vehicle: &scenario::Vehicle| BoatSeries {
            name: vehicle.name.clone(),
            team: vehicle.team.index(),
            is_real: vehicle.source == Source::External,
            samples: Vec::with_capacity(recording.frame_count() / every + 2),
        };
        let mut series = GameSeries {
            every,
            boats: scenario.vehicles.iter().map(boat).collect(),
            teams: scenario
                .teams
                .iter()
                .map(|team| team.name.clone())
                .collect(),
            ..GameSeries::default()
        };
        let mut count = 0;
        let mut left_out = None;
        series.damaged = for_each_step(recording, |mut step| {
            series.events.append(&mut step.events);
            if usize::is_multiple_of(count, every) {
                series.add(step);
                left_out = None;
            } else {
                left_out = Some(step);
            }
            count += 1;
        });
        left_out.into_iter().for_each(|last| series.add(last));
        series
    }

    fn add(&mut self, step: Step) {
        self.times_s.push(step.time_s);
        self.score.push(step.score);
        for (boat, sample) in self.boats.iter_mut().zip(step.samples) {
            boat.samples.push(sample);
        }
    }

    /// A note for the user if decisions were omitted.
    pub fn remark(&self) -> Option<String> {
        (self.every > 1).then(|| {
            format!(
                "the game is long; only one decision in {} is analysed",
                self.every
            )
        })
    }

    /// The time between the first sample and the last, s.
    pub fn span_s(&self) -> f64 {
        self.times_s
            .last()
            .zip(self.times_s.first())
            .map_or(0.0, |(last, first)| last - first)
    }

    /// The boat with this name.
    pub fn boat(&self, name: &str) -> Option<&BoatSeries> {
        self.boats.iter().find(|boat| boat.name == name)
    }
}
