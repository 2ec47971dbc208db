//! The curves of a recorded game over time, for the plots below the timeline.

use crate::page::message::{BoatCurves, Curves, PageMessage};
use analysis::{GameSeries, Sample};
use messages::Order;
use primitives::angle::compass_deg_from_rad;
use primitives::{Ned, SimTime, VehicleId, math};
use recording::Recording;
use rules::Field;
use std::sync::Arc;

/// Maximum number of samples per boat sent to a page; a screen has fewer pixels.
const SAMPLES: usize = 1500;
/// Maximum number of samples kept for all boats together, about 160 bytes each.
const SAMPLES_MAX: usize = 400_000;

/// Reads the curves from a recording on first use.
#[derive(Default)]
pub(super) struct Plotter {
    recording: Option<Arc<Recording>>,
    series: Option<GameSeries>,
}

impl Plotter {
    /// A plotter for this recording, which has not yet been read.
    pub(super) fn new(recording: Arc<Recording>) -> Plotter {
        Plotter {
            recording: Some(recording),
            series: None,
        }
    }

    /// The score and a boat's curves, as a message to the page.
    pub(super) fn curves(&mut self, vehicle: Option<VehicleId>) -> String {
        let Some(recording) = &self.recording else {
            return PageMessage::Curves(&Curves::default()).json();
        };
        let series = self.series.get_or_insert_with(|| {
            let boats = recording.scenario().vehicles.len();
            GameSeries::of_at_most(recording, SAMPLES.saturating_mul(boats).min(SAMPLES_MAX))
        });
        let boat = vehicle.and_then(|vehicle| series.boats.get(vehicle.index()));
        let curves = Curves {
            vehicle: boat.map(|boat| boat.name.as_str()),
            t_s: series.times_s.iter().copied().map(rounded).collect(),
            score: (0..series.teams.len())
                .map(|team| {
                    series
                        .score
                        .iter()
                        .map(|score| score.get(team).copied().unwrap_or(0))
                        .collect()
                })
                .collect(),
            boat: vehicle
                .filter(|_| boat.is_some())
                .map(|vehicle| boat_curves(series, &recording.scenario().field, vehicle)),
        };
        PageMessage::Curves(&curves).json()
    }
}

fn boat_curves(series: &GameSeries, field: &Field, vehicle: VehicleId) -> BoatCurves {
    let boat = &series.boats[vehicle.index()];
    let each = |of: &dyn Fn(&Sample) -> Option<f64>| -> Vec<f64> {
        boat.samples
            .iter()
            .map(|sample| rounded(of(sample).unwrap_or(f64::NAN)))
            .collect()
    };
    let ordered_speed = |sample: &Sample| match sample.order {
        Order::Steer { speed_m_s, .. } | Order::Turn { speed_m_s, .. } => Some(speed_m_s),
        Order::Hold => Some(0.0),
        Order::Thrust { .. } => None,
    };
    let ordered_heading = |sample: &Sample| match sample.order {
        Order::Steer { heading_rad, .. } => Some(compass_deg_from_rad(heading_rad)),
        Order::Hold | Order::Turn { .. } | Order::Thrust { .. } => None,
    };
    let course = |sample: &Sample| {
        let velocity = sample.truth.velocity_m_s();
        Some(compass_deg_from_rad(math::atan2(
            velocity.east,
            velocity.north,
        )))
    };
    BoatCurves {
        x_m: each(&|sample| Some(sample.truth.east_m)),
        y_m: each(&|sample| Some(sample.truth.north_m)),
        speed_m_s: each(&|sample| Some(sample.truth.speed_m_s())),
        ordered_speed_m_s: each(&ordered_speed),
        heading_deg: each(&|sample| Some(compass_deg_from_rad(sample.truth.psi_rad))),
        ordered_heading_deg: each(&ordered_heading),
        course_deg: each(&course),
        sway_m_s: each(&|sample| Some(sample.truth.sway_m_s)),
        yaw_rate_deg_s: each(&|sample| Some(sample.truth.yaw_rate_rad_s.to_degrees())),
        port_newton: each(&|sample| Some(sample.thrusts_newton[0])),
        starboard_newton: each(&|sample| Some(sample.thrusts_newton[1])),
        flag_m: flag_distances(series, field, vehicle),
        error_m: each(&Sample::nav_error_m),
    }
}

/// A boat's distance to the nearest flag of the other team, which may be moving.
fn flag_distances(series: &GameSeries, field: &Field, vehicle: VehicleId) -> Vec<f64> {
    let boat = &series.boats[vehicle.index()];
    let mut carriers: Vec<Option<VehicleId>> = vec![None; field.flags.len()];
    let mut events = series.events.iter().peekable();
    let mut distances = Vec::with_capacity(boat.samples.len());
    for (sample, time_s) in series.times_s.iter().enumerate() {
        while let Some(logged) = events.next_if(|logged| logged.at.as_s() <= time_s + 1e-6) {
            let Some(flag) = logged.event.flag() else {
                continue;
            };
            if let Some(carrier) = carriers.get_mut(usize::from(flag.0)) {
                *carrier = logged
                    .event
                    .vehicle()
                    .filter(|_| matches!(logged.event, rules::event::Event::Grabbed { .. }));
            }
        }
        let at = boat.samples[sample].truth.at();
        let now = SimTime::from_s(*time_s);
        let place = |flag: usize| -> Ned {
            let carrier = carriers[flag].and_then(|carrier| series.boats.get(carrier.index()));
            carrier.map_or_else(
                || field.flags[flag].home(now),
                |carrier| carrier.samples[sample].truth.at(),
            )
        };
        let others =
            (0..field.flags.len()).filter(|flag| field.flags[*flag].team.index() != boat.team);
        distances.push(rounded(
            others
                .map(|flag| at.distance(place(flag)))
                .fold(f64::INFINITY, f64::min),
        ));
    }
    distances
}

/// Rounds to millimetres: precise enough for a plot, and short in a message.
fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
