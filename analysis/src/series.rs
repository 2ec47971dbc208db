//! A recorded game as time series: at every decision each boat's true and estimated position, and its order.

use crate::damaged::Damaged;
use game::event::Logged;
use game::input::{Input, Inputs};
use game::message::{Frame, VehicleTruth};
use game::outcome::EventOutcome;
use game::picture::{Nav, Picture};
use game::scenario::Source;
use game::{Ned, Order, Scenario, SimTime};
use recording::{FRAME, INPUTS, RecordedMessage, Recording, RecordingError, picture};

/// A game as time series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GameSeries {
    /// When the samples were, s.
    pub times_s: Vec<f64>,
    /// By vehicle.
    pub boats: Vec<BoatSeries>,
    /// The names of the teams.
    pub teams: Vec<String>,
    /// Points, by sample and team.
    pub score: Vec<Vec<u32>>,
    /// The events in the frames.
    pub events: Vec<Logged>,
    /// What could not be read of it.
    pub damaged: Damaged,
}

/// A boat as time series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoatSeries {
    /// Its name.
    pub name: String,
    /// Its team's place among the teams.
    pub team: usize,
    /// Whether it is a real one, whose truth is what its gateway reported.
    pub is_real: bool,
    /// By time.
    pub samples: Vec<Sample>,
}

/// A boat at one decision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Where it was.
    pub truth: Nav,
    /// Where it estimated to be, in the picture of that decision.
    pub estimated: Option<Nav>,
    /// The order that led here: the last that it had been sent before.
    pub order: Order,
    /// Whether it was free to follow its order: neither stopped nor tagged, off the field, out of action or lost.
    pub is_free: bool,
    /// Whether it was tagged.
    pub tagged: bool,
    /// Whether it carried a flag.
    pub carrying: bool,
    /// Whether it was outside of the field.
    pub outside: bool,
    /// Whether its agent was lost.
    pub agent_lost: bool,
    /// Whether its navigation was lost.
    pub nav_lost: bool,
}

impl Sample {
    /// The heading, rad, and the speed, m/s, that it steered by order.
    #[must_use]
    pub fn steered(&self) -> Option<(f64, f64)> {
        match self.order {
            Order::Steer { heading_rad, speed_m_s } if self.is_free => Some((heading_rad, speed_m_s)),
            _ => None,
        }
    }

    /// How far its estimated position was from the true one, m.
    #[must_use]
    pub fn nav_error_m(&self) -> Option<f64> {
        self.estimated.map(|nav| nav.at().distance(self.truth.at()))
    }
}

impl BoatSeries {
    /// Where it was, sample by sample.
    pub fn track(&self) -> impl ExactSizeIterator<Item = Ned> + '_ {
        self.samples.iter().map(|sample| sample.truth.at())
    }
}

impl GameSeries {
    /// The series of a recording, in one pass. Messages that are not what they should be are left out, and counted.
    #[must_use]
    pub fn of(recording: &Recording) -> GameSeries {
        let scenario = recording.scenario();
        let pictures: Vec<String> = scenario.teams.iter().map(|team| picture(&team.name)).collect();
        let mut builder = Builder::new(scenario, recording.frame_count());
        for message in recording.bag().messages() {
            let taken = match message.topic {
                FRAME => builder.frame(&message),
                INPUTS => builder.inputs(&message),
                topic if pictures.iter().any(|picture| picture == topic) => builder.picture(&message),
                _ => Ok(()),
            };
            builder.series.damaged.sound(taken);
        }
        builder.series
    }

    /// The time between the first sample and the last, s.
    #[must_use]
    pub fn span_s(&self) -> f64 {
        self.times_s.last().zip(self.times_s.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// For each sample how long it stands for, s: since the one before, and nothing for the first.
    pub fn steps_s(&self) -> impl Iterator<Item = f64> + '_ {
        let first = self.times_s.first().copied().unwrap_or(0.0);
        let before = std::iter::once(first).chain(self.times_s.iter().copied());
        self.times_s.iter().zip(before).map(|(now, before)| now - before)
    }

    /// The sample at this time: the last that was not later.
    #[must_use]
    pub fn sample_at(&self, at_s: f64) -> usize {
        self.times_s.partition_point(|time_s| *time_s <= at_s + 1e-6).saturating_sub(1)
    }

    /// The boat of this name.
    #[must_use]
    pub fn boat(&self, name: &str) -> Option<&BoatSeries> {
        self.boats.iter().find(|boat| boat.name == name)
    }

    /// What happened, with names.
    #[must_use]
    pub fn named_events(&self, scenario: &Scenario) -> Vec<EventOutcome> {
        self.events.iter().map(|logged| EventOutcome::new(scenario, logged)).collect()
    }
}

/// Builds the series as messages come.
struct Builder<'a> {
    scenario: &'a Scenario,
    series: GameSeries,
    /// The numbers of the frames so far.
    seqs: Vec<u64>,
    /// In force, by vehicle, with the time of the picture that each answers.
    orders: Vec<(Order, SimTime)>,
}

impl<'a> Builder<'a> {
    fn new(scenario: &'a Scenario, frames: usize) -> Builder<'a> {
        let boat = |vehicle: &game::scenario::Vehicle| BoatSeries {
            name: vehicle.name.clone(),
            team: vehicle.team.index(),
            is_real: vehicle.source == Source::External,
            samples: Vec::with_capacity(frames),
        };
        let series = GameSeries {
            boats: scenario.vehicles.iter().map(boat).collect(),
            teams: scenario.teams.iter().map(|team| team.name.clone()).collect(),
            ..GameSeries::default()
        };
        Builder { scenario, series, seqs: vec![], orders: vec![(Order::Hold, SimTime::ZERO); scenario.vehicles.len()] }
    }

    fn frame(&mut self, message: &RecordedMessage<'_>) -> Result<(), RecordingError> {
        let frame: Frame = message.read()?;
        self.seqs.push(frame.stamp.seq);
        self.series.times_s.push(frame.stamp.valid_ns.as_s());
        for (i, (boat, (order, _))) in self.series.boats.iter_mut().zip(&self.orders).enumerate() {
            let truth = frame.vehicles.get(i).copied().unwrap_or_default();
            boat.samples.push(sample(&truth, *order, frame.stopped));
        }
        self.series.events.extend(frame.logged(self.scenario));
        self.series.score.push(frame.score);
        Ok(())
    }

    fn picture(&mut self, message: &RecordedMessage<'_>) -> Result<(), RecordingError> {
        let picture: Picture = message.read()?;
        // A picture is recorded after the frame of its decision, and before the next.
        let Ok(place) = self.seqs.binary_search(&picture.stamp.seq) else { return Ok(()) };
        for own in &picture.own {
            let boat = self.series.boats.get_mut(own.vehicle.index());
            if let Some(sample) = boat.and_then(|boat| boat.samples.get_mut(place)) {
                sample.estimated = Some(own.nav);
            }
        }
        Ok(())
    }

    fn inputs(&mut self, message: &RecordedMessage<'_>) -> Result<(), RecordingError> {
        let inputs: Inputs = message.read()?;
        for input in inputs.of(self.scenario).flatten() {
            match input {
                Input::Ordered { vehicle, order, given_at } => self.orders[vehicle.index()] = (order, given_at),
                Input::Held(vehicle) | Input::AgentLost(vehicle) => self.orders[vehicle.index()].0 = Order::Hold,
                Input::Played => self.expire_orders(),
                _ => {}
            }
        }
        Ok(())
    }

    /// Orders expire by the age of the picture that they answer, when a decision is played.
    fn expire_orders(&mut self) {
        let Some(now_s) = self.series.times_s.last() else { return };
        for (order, given_at) in &mut self.orders {
            if now_s - given_at.as_s() > self.scenario.order_ttl_s {
                *order = Order::Hold;
            }
        }
    }
}

fn sample(truth: &VehicleTruth, order: Order, stopped: bool) -> Sample {
    let VehicleTruth { tagged, disabled, outside, agent_lost, quarantined, nav_lost, .. } = *truth;
    Sample {
        truth: truth.nav,
        estimated: None,
        order,
        is_free: !(stopped || tagged || disabled || outside || agent_lost || quarantined || nav_lost),
        tagged,
        carrying: truth.carrying >= 0,
        outside,
        agent_lost,
        nav_lost,
    }
}
