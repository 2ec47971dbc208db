//! A recorded game decision by decision: each boat's true and estimated position, and its order.

use messages::input::{Input, Inputs};
use messages::picture::{Nav, Picture};
use messages::{Frame, Order, VehicleTruth};
use primitives::SimTime;
use recording::{Damaged, FRAME, INPUTS, RecordedMessage, Recording, RecordingError, picture};
use rules::event::Logged;
use scenario::Scenario;

/// A decision of a game.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// Its number, from the frame.
    pub decision: u64,
    /// Time, s.
    pub time_s: f64,
    /// Boats, by vehicle index.
    pub samples: Vec<Sample>,
    /// Points, by team index.
    pub score: Vec<u32>,
    /// Events since the previous decision.
    pub events: Vec<Logged>,
}

/// A boat at one decision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Its true navigation.
    pub truth: Nav,
    /// Its estimated navigation, from the picture of that decision.
    pub estimated: Option<Nav>,
    /// The order in force during this step: the last one sent before it.
    pub order: Order,
    /// Thrust of the port and starboard thrusters, N.
    pub thrusts_newton: [f64; 2],
    /// Whether it was free to follow its order: not stopped, tagged, off the field, out of action
    /// or lost.
    pub is_free: bool,
    /// Whether it was tagged.
    pub tagged: bool,
    /// Whether it carried a flag.
    pub carrying: bool,
    /// Whether it was outside the field.
    pub outside: bool,
    /// Whether its agent was lost.
    pub agent_lost: bool,
    /// Whether its navigation was lost.
    pub nav_lost: bool,
}

impl Step {
    /// The decision in a frame, with the orders that preceded it, by vehicle. Estimated navigation
    /// is not included.
    pub fn of_frame(
        scenario: &Scenario,
        frame: &Frame,
        orders: impl Iterator<Item = Order>,
    ) -> Step {
        let truth = |i: usize| frame.vehicles.get(i).copied().unwrap_or_default();
        Step {
            decision: frame.stamp.seq,
            time_s: frame.stamp.valid_ns.as_s(),
            samples: orders
                .enumerate()
                .map(|(i, order)| sample(&truth(i), order, frame.stopped))
                .collect(),
            events: frame.logged(scenario).collect(),
            score: frame.score.clone(),
        }
    }
}

/// Passes every decision of a recording to `take`, with only one in memory at a time. Damaged
/// messages are skipped and counted.
pub fn for_each_step(recording: &Recording, take: impl FnMut(Step)) -> Damaged {
    let scenario = recording.scenario();
    let pictures: Vec<String> = scenario
        .teams
        .iter()
        .map(|team| picture(&team.name))
        .collect();
    let mut reader = Reader {
        scenario,
        take,
        open: None,
        now_s: None,
        orders: vec![(Order::Hold, SimTime::ZERO); scenario.vehicles.len()],
    };
    let mut damaged = Damaged::default();
    for message in recording.bag().messages() {
        let taken = match message.topic {
            FRAME => reader.frame(&message),
            INPUTS => reader.inputs(&message),
            topic if pictures.iter().any(|picture| picture == topic) => reader.picture(&message),
            _ => Ok(()),
        };
        damaged.sound(taken);
    }
    reader.close();
    damaged
}

impl Sample {
    /// The ordered heading (rad) and speed (m/s), if the boat was steered.
    pub fn steered(&self) -> Option<(f64, f64)> {
        match self.order {
            Order::Steer {
                heading_rad,
                speed_m_s,
            } if self.is_free => Some((heading_rad, speed_m_s)),
            _ => None,
        }
    }

    /// Distance between estimated and true position, m.
    pub fn nav_error_m(&self) -> Option<f64> {
        self.estimated.map(|nav| nav.at().distance(self.truth.at()))
    }
}

/// The ordered speed, m/s; unknown for thrust orders.
pub fn ordered_m_s(order: Order) -> Option<f64> {
    match order {
        Order::Hold => Some(0.0),
        Order::Steer { speed_m_s, .. } | Order::Turn { speed_m_s, .. } => Some(speed_m_s),
        Order::Thrust { .. } => None,
    }
}

/// Assembles decisions from messages.
struct Reader<'a, T> {
    scenario: &'a Scenario,
    take: T,
    /// The decision whose pictures may still follow: pictures are recorded between its frame and
    /// the next.
    open: Option<Step>,
    /// Time of the last frame, s.
    now_s: Option<f64>,
    /// Orders in force, each with the time of the picture that it answers, by vehicle index.
    orders: Vec<(Order, SimTime)>,
}

impl<T: FnMut(Step)> Reader<'_, T> {
    fn frame(&mut self, message: &RecordedMessage<'_>) -> Result<(), RecordingError> {
        let frame: Frame = message.read()?;
        self.close();
        let step = Step::of_frame(
            self.scenario,
            &frame,
            self.orders.iter().map(|(order, _)| *order),
        );
        (self.now_s, self.open) = (Some(step.time_s), Some(step));
        Ok(())
    }

    /// Passes on the open decision.
    fn close(&mut self) {
        if let Some(step) = self.open.take() {
            (self.take)(step);
        }
    }

    fn picture(&mut self, message: &RecordedMessage<'_>) -> Result<(), RecordingError> {
        let picture: Picture = message.read()?;
        let Some(step) = self
            .open
            .as_mut()
            .filter(|step| step.decision == picture.stamp.seq)
        else {
            return Ok(());
        };
        for own in &picture.own {
            if let Some(sample) = step.samples.get_mut(own.vehicle.index()) {
                sample.estimated = Some(own.nav);
            }
        }
        Ok(())
    }

    fn inputs(&mut self, message: &RecordedMessage<'_>) -> Result<(), RecordingError> {
        let inputs: Inputs = message.read()?;
        for input in inputs.of(self.scenario).flatten() {
            match input {
                Input::Ordered {
                    vehicle,
                    order,
                    given_at,
                } => self.orders[vehicle.index()] = (order, given_at),
                Input::Held(vehicle) | Input::AgentLost(vehicle) => {
                    self.orders[vehicle.index()].0 = Order::Hold
                }
                Input::Played => self.expire_orders(),
                _ => {}
            }
        }
        Ok(())
    }

    /// Drops orders whose picture is too old at the time of the decision.
    fn expire_orders(&mut self) {
        let Some(now_s) = self.now_s else { return };
        for (order, given_at) in &mut self.orders {
            if now_s - given_at.as_s() > self.scenario.order_ttl_s {
                *order = Order::Hold;
            }
        }
    }
}

fn sample(truth: &VehicleTruth, order: Order, stopped: bool) -> Sample {
    let VehicleTruth {
        tagged,
        disabled,
        outside,
        agent_lost,
        quarantined,
        nav_lost,
        ..
    } = *truth;
    Sample {
        truth: truth.nav,
        estimated: None,
        order,
        thrusts_newton: [truth.port_newton, truth.starboard_newton],
        is_free: !(stopped
            || tagged
            || disabled
            || outside
            || agent_lost
            || quarantined
            || nav_lost),
        tagged,
        carrying: truth.carrying >= 0,
        outside,
        agent_lost,
        nav_lost,
    }
}
