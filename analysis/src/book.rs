//! A recorded game as series: where each boat was at every decision, where it believed to be, what it was ordered.

use game::event::Logged;
use game::input::{Input, Inputs};
use game::message::{Frame, VehicleTruth};
use game::outcome::EventOutcome;
use game::picture::{Nav, Picture};
use game::scenario::Source;
use game::{Ned, Order, Scenario, SimTime};
use recording::{FRAME, INPUTS, Recording, RecordingError, Said};

/// A game as series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Book {
    /// When the moments were, s.
    pub times_s: Vec<f64>,
    /// By vehicle.
    pub boats: Vec<Boat>,
    /// The names of the teams.
    pub teams: Vec<String>,
    /// Points, by moment and team.
    pub score: Vec<Vec<u32>>,
    /// What happened, as the frames tell it.
    pub events: Vec<Logged>,
}

/// A boat in a book.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Boat {
    /// Its name.
    pub name: String,
    /// Its team's place among the teams.
    pub team: usize,
    /// Whether it is a real one, whose truth is what its gateway reported.
    pub is_real: bool,
    /// By moment.
    pub moments: Vec<Moment>,
}

/// A boat at one decision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Where it was.
    pub truth: Nav,
    /// Where its own navigation told it was, in the picture of that decision.
    pub believed: Option<Nav>,
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
    /// Whether it had no mind.
    pub agent_lost: bool,
    /// Whether nobody knew where it was.
    pub nav_lost: bool,
}

impl Moment {
    /// How fast it went over the ground, m/s.
    #[must_use]
    pub fn speed_m_s(&self) -> f64 {
        game::math::length(self.truth.surge_m_s, self.truth.sway_m_s)
    }

    /// The heading, rad, and the speed, m/s, that it steered by order.
    #[must_use]
    pub fn steered(&self) -> Option<(f64, f64)> {
        match self.order {
            Order::Steer { heading_rad, speed_m_s } if self.is_free => Some((heading_rad, speed_m_s)),
            _ => None,
        }
    }

    /// How far its own navigation was from the truth, m.
    #[must_use]
    pub fn nav_error_m(&self) -> Option<f64> {
        self.believed.map(|nav| nav.at().distance(self.truth.at()))
    }
}

impl Boat {
    /// Where it was, moment by moment.
    pub fn track(&self) -> impl ExactSizeIterator<Item = Ned> + '_ {
        self.moments.iter().map(|moment| moment.truth.at())
    }
}

impl Book {
    /// The book of a recording, in one pass.
    ///
    /// # Errors
    /// [`RecordingError::Damaged`] names the first message that is not what it should be.
    pub fn of(recording: &Recording) -> Result<Book, RecordingError> {
        let scenario = &recording.header().notice.scenario;
        let pictures: Vec<String> = scenario.teams.iter().map(|team| recording::picture(&team.name)).collect();
        let mut scribe = Scribe::new(scenario, recording.frame_count());
        for said in recording.messages() {
            match said.topic {
                FRAME => scribe.frame(&said)?,
                INPUTS => scribe.inputs(&said)?,
                topic if pictures.iter().any(|picture| picture == topic) => scribe.picture(&said)?,
                _ => {}
            }
        }
        Ok(scribe.book)
    }

    /// The time between the first moment and the last, s.
    #[must_use]
    pub fn span_s(&self) -> f64 {
        self.times_s.last().zip(self.times_s.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// For each moment how long it stands for, s: since the moment before, and nothing for the first.
    pub fn steps_s(&self) -> impl Iterator<Item = f64> + '_ {
        let first = self.times_s.first().copied().unwrap_or(0.0);
        let before = std::iter::once(first).chain(self.times_s.iter().copied());
        self.times_s.iter().zip(before).map(|(now, before)| now - before)
    }

    /// The moment at this time: the last that was not later.
    #[must_use]
    pub fn moment_at(&self, at_s: f64) -> usize {
        self.times_s.partition_point(|time_s| *time_s <= at_s + 1e-6).saturating_sub(1)
    }

    /// The boat of this name.
    #[must_use]
    pub fn boat(&self, name: &str) -> Option<&Boat> {
        self.boats.iter().find(|boat| boat.name == name)
    }

    /// What happened, with names.
    #[must_use]
    pub fn named_events(&self, scenario: &Scenario) -> Vec<EventOutcome> {
        self.events.iter().map(|logged| EventOutcome::new(scenario, logged)).collect()
    }
}

/// Writes a book as messages come.
struct Scribe<'a> {
    scenario: &'a Scenario,
    book: Book,
    /// The numbers of the frames so far.
    seqs: Vec<u64>,
    /// In force, by vehicle, with the time of the picture that each answers.
    orders: Vec<(Order, SimTime)>,
}

impl<'a> Scribe<'a> {
    fn new(scenario: &'a Scenario, frames: usize) -> Scribe<'a> {
        let boat = |vehicle: &game::scenario::Vehicle| Boat {
            name: vehicle.name.clone(),
            team: vehicle.team.index(),
            is_real: vehicle.source == Source::External,
            moments: Vec::with_capacity(frames),
        };
        let book = Book {
            boats: scenario.vehicles.iter().map(boat).collect(),
            teams: scenario.teams.iter().map(|team| team.name.clone()).collect(),
            ..Book::default()
        };
        Scribe { scenario, book, seqs: vec![], orders: vec![(Order::Hold, SimTime::ZERO); scenario.vehicles.len()] }
    }

    fn frame(&mut self, said: &Said<'_>) -> Result<(), RecordingError> {
        let frame: Frame = said.read()?;
        self.seqs.push(frame.stamp.seq);
        self.book.times_s.push(frame.stamp.valid_ns.as_s());
        for (i, (boat, (order, _))) in self.book.boats.iter_mut().zip(&self.orders).enumerate() {
            let truth = frame.vehicles.get(i).copied().unwrap_or_default();
            boat.moments.push(moment(&truth, *order, frame.stopped));
        }
        self.book.events.extend(frame.logged(self.scenario));
        self.book.score.push(frame.score);
        Ok(())
    }

    fn picture(&mut self, said: &Said<'_>) -> Result<(), RecordingError> {
        let picture: Picture = said.read()?;
        // A picture is recorded after the frame of its decision, and before the next.
        let Ok(place) = self.seqs.binary_search(&picture.stamp.seq) else { return Ok(()) };
        for own in &picture.own {
            let boat = self.book.boats.get_mut(own.vehicle.index());
            if let Some(moment) = boat.and_then(|boat| boat.moments.get_mut(place)) {
                moment.believed = Some(own.nav);
            }
        }
        Ok(())
    }

    fn inputs(&mut self, said: &Said<'_>) -> Result<(), RecordingError> {
        let inputs: Inputs = said.read()?;
        for input in inputs.of(self.scenario).flatten() {
            match input {
                Input::Ordered { vehicle, order, given_at } => self.orders[vehicle.index()] = (order, given_at),
                Input::Held { vehicle } | Input::AgentLost { vehicle } => self.orders[vehicle.index()].0 = Order::Hold,
                Input::Played => self.expire_orders(),
                _ => {}
            }
        }
        Ok(())
    }

    /// Orders expire by the age of the picture that they answer, when a decision is played.
    fn expire_orders(&mut self) {
        let Some(now_s) = self.book.times_s.last() else { return };
        for (order, given_at) in &mut self.orders {
            if now_s - given_at.as_s() > self.scenario.order_ttl_s {
                *order = Order::Hold;
            }
        }
    }
}

fn moment(truth: &VehicleTruth, order: Order, stopped: bool) -> Moment {
    let VehicleTruth { tagged, disabled, outside, agent_lost, quarantined, nav_lost, .. } = *truth;
    Moment {
        truth: truth.nav,
        believed: None,
        order,
        is_free: !(stopped || tagged || disabled || outside || agent_lost || quarantined || nav_lost),
        tagged,
        carrying: truth.carrying >= 0,
        outside,
        agent_lost,
        nav_lost,
    }
}
