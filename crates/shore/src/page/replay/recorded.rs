//! A recording, indexed for replay.

use messages::external::GatewayStatus;
use messages::picture::{OwnBoat, Picture};
use primitives::{SimTime, VehicleId};
use recording::{Damaged, Recording, picture};
use scenario::outcome::EventOutcome;
use serde_json::Value;
use std::sync::Arc;

/// A recording ready for replay.
pub struct Recorded {
    pub(super) recording: Arc<Recording>,
    /// The file's name.
    pub(super) file: String,
    /// Indices of valid frames in the recording.
    frames: Vec<usize>,
    /// The times of the frames, in order.
    pub frame_times: Vec<SimTime>,
    /// The number of skipped frames.
    pub damaged: Damaged,
    /// By team: time and location of each picture.
    pictures: Vec<Vec<(SimTime, usize)>>,
    /// By vehicle: time and location of each status from its gateway.
    statuses: Vec<Vec<(SimTime, usize)>>,
    /// The chance of winning over time, if known: times, chances, bounds and turning points.
    pub chances: Option<Value>,
    /// All events, including gateways' failsafes.
    pub(super) events: Vec<EventOutcome>,
}

impl Recorded {
    /// Reads the whole recording once and skips damaged frames.
    pub fn new(recording: Arc<Recording>, file: String) -> Recorded {
        let scenario = recording.scenario();
        let sent = |topic: String| {
            let bag = recording.bag();
            bag.places(&topic)
                .map(|place| (bag.message(place).at, place))
                .collect::<Vec<_>>()
        };
        let pictures = scenario
            .teams
            .iter()
            .map(|team| sent(picture(&team.name)))
            .collect();
        let statuses = scenario
            .vehicles
            .iter()
            .map(|vehicle| sent(format!("status/{}", vehicle.name)))
            .collect();
        let mut recorded = Recorded {
            recording: Arc::clone(&recording),
            file,
            frames: Vec::new(),
            frame_times: Vec::new(),
            damaged: Damaged::default(),
            pictures,
            statuses,
            chances: None,
            events: Vec::new(),
        };
        for (number, frame) in recording.frames().enumerate() {
            let Some(frame) = recorded.damaged.sound(frame) else {
                continue;
            };
            recorded.frames.push(number);
            recorded.frame_times.push(frame.stamp.valid_ns);
            recorded.events.extend(
                frame
                    .logged(scenario)
                    .map(|logged| EventOutcome::new(scenario, &logged)),
            );
        }
        recorded.add_failsafes();
        recorded
    }

    /// Adds gateways' failsafes to the events, at the time of their first report.
    fn add_failsafes(&mut self) {
        let scenario = self.recording.scenario();
        for (vehicle, sent) in scenario.vehicles.iter().zip(&self.statuses) {
            let mut known = 0;
            for (at, place) in sent {
                let Some(status) = self.status_at(*place) else {
                    continue;
                };
                // A restarted gateway counts from zero.
                known = known.min(status.failsafes.len());
                for failsafe in &status.failsafes[known..] {
                    self.events.push(EventOutcome {
                        tick: u64::try_from(at.0 / scenario.tick.0.max(1)).unwrap_or(0),
                        at_s: at.as_s(),
                        event: "failsafe".to_owned(),
                        vehicle: Some(vehicle.name.clone()),
                        other: Some(failsafe.cause.clone()),
                        team: None,
                    });
                }
                known = status.failsafes.len();
            }
        }
        self.events.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    }

    fn status_at(&self, place: usize) -> Option<GatewayStatus> {
        serde_json::from_slice(&self.recording.bag().message(place).bytes).ok()
    }

    pub(super) fn frame_bytes(&self, frame: usize) -> Vec<u8> {
        self.recording.frame(self.frames[frame]).bytes
    }

    /// A boat's own position estimate at a frame.
    pub fn estimate(&self, vehicle: VehicleId, frame: usize) -> Option<OwnBoat> {
        let team = self
            .recording
            .scenario()
            .vehicles
            .get(vehicle.index())?
            .team;
        let place = last_until(&self.pictures[team.index()], *self.frame_times.get(frame)?)?;
        let picture: Picture = self.recording.bag().message(place).read().ok()?;
        picture.own(vehicle).copied()
    }

    /// The last status from a boat's gateway up to a time.
    pub fn status(&self, vehicle: VehicleId, at: SimTime) -> Option<GatewayStatus> {
        self.status_at(last_until(self.statuses.get(vehicle.index())?, at)?)
    }
}

/// The location of the last item at or before `at`.
fn last_until(sent: &[(SimTime, usize)], at: SimTime) -> Option<usize> {
    let after = sent.partition_point(|(when, _)| *when <= at);
    sent[..after].last().map(|(_, place)| *place)
}
