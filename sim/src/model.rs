//! The constants of a world: the boats, the sea, and the solid shapes.

use crate::autopilot::AutopilotModel;
use crate::contact::{ContactModel, ContactRole};
use crate::flaw::FlawState;
use crate::hull::{HullModel, Planar};
use crate::kinematic::{KinematicModel, KinematicState};
use crate::motion::{Fleet, Forcing, Motion};
use crate::sea::{Attitude, SeaModel, SeaNow};
use crate::sensor::{Reading, SensorModel, SensorState, Truth};
use crate::state::BoatState;
use crate::thruster::ThrusterModel;
use crate::world::WorldPlan;
use messages::Order;
use primitives::angle::wrap_pi;
use primitives::frame::{self, Ned, Rotation};
use primitives::{Pose, SimTime};
use scenario::boat;
use scenario::fault::{FaultKind, FaultSpan};
use scenario::sensor::Sensors;

/// A world's constants.
#[derive(Clone)]
pub(crate) struct Model {
    pub(crate) tick: SimTime,
    pub(crate) dt_s: f64,
    /// Hull models, by kind of boat.
    pub(crate) hulls: Vec<HullModel>,
    drives: Vec<Drive>,
    /// Kind of each vehicle, by vehicle index.
    pub(crate) kinds: Vec<usize>,
    /// Whether each vehicle is a real boat, by vehicle index.
    external: Vec<bool>,
    /// By vehicle index: the index of a point boat among the point boats.
    points: Vec<Option<usize>>,
    /// The sensors of each vehicle, if any, with its index among the vehicles with sensors.
    pub(crate) sensed: Vec<Option<(usize, SensorModel)>>,
    /// The hulls, by vehicle index.
    pub(crate) fleet: Fleet,
    pub(crate) sea: SeaModel,
    pub(crate) contact: ContactModel,
    /// Distance within which to search for pairs of boats, m.
    pub(crate) pairs_within_m: f64,
    /// Fault spans of the thrusters, by vehicle index.
    thruster_faults: Vec<Vec<FaultSpan>>,
}

/// A thruster failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Failing {
    /// The thruster stops.
    Lost,
    /// The thruster keeps its last setting.
    Stuck,
}

/// The propulsion of a kind of boat.
#[derive(Clone)]
enum Drive {
    /// Thrusters controlled by a front seat.
    Thrusters(ThrusterModel, AutopilotModel),
    Point(KinematicModel),
}

impl Drive {
    fn new(boat: &scenario::Boat, hull: &HullModel, dt_s: f64) -> Drive {
        match &boat.drive {
            boat::Drive::Thrusters {
                thruster,
                autopilot,
            } => Drive::Thrusters(
                ThrusterModel::new(thruster, dt_s),
                AutopilotModel::new(autopilot, hull, dt_s),
            ),
            boat::Drive::Kinematic(kinematic) => Drive::Point(KinematicModel::new(kinematic)),
        }
    }
}

impl Model {
    pub(crate) fn new(plan: &WorldPlan<'_>) -> Model {
        let dt_s = plan.tick.as_s();
        let density = plan.sea.water_density_kg_m3;
        let hulls: Vec<HullModel> = plan
            .kinds
            .iter()
            .map(|boat| HullModel::new(&boat.hull, density))
            .collect();
        let shapes = plan.kinds.iter().map(|boat| (boat.length_m, boat.beam_m));
        let drives: Vec<Drive> = plan
            .kinds
            .iter()
            .zip(&hulls)
            .map(|(boat, hull)| Drive::new(boat, hull, dt_s))
            .collect();
        // A real boat has no point-boat state, whatever its file says: its gateway reports its
        // position.
        let points = plan
            .vehicles
            .iter()
            .map(|v| !v.is_external && matches!(drives[v.kind], Drive::Point(_)));
        let sensors = |kind: usize| &plan.kinds[kind].sensors;
        // No readings are kept for boats without sensors: they would waste memory in large fleets
        // of such boats.
        let is_sensed = plan
            .vehicles
            .iter()
            .map(|v| !v.is_external && *sensors(v.kind) != Sensors::default());
        let sensed = numbered(is_sensed)
            .into_iter()
            .zip(&plan.vehicles)
            .map(|(place, vehicle)| {
                let sensors = sensors(vehicle.kind);
                let faults = &vehicle.faults;
                let model = || {
                    SensorModel::new(
                        sensors,
                        plan.sensor_period,
                        &plan.seeds,
                        vehicle.name,
                        faults,
                    )
                };
                place.map(|place| (place, model()))
            });
        Model {
            tick: plan.tick,
            dt_s,
            points: numbered(points),
            external: plan
                .vehicles
                .iter()
                .map(|vehicle| vehicle.is_external)
                .collect(),
            sensed: sensed.collect(),
            thruster_faults: plan
                .vehicles
                .iter()
                .map(|vehicle| thruster_faults(&vehicle.faults))
                .collect(),
            fleet: Fleet::new(plan.vehicles.iter().map(|vehicle| &hulls[vehicle.kind])),
            sea: SeaModel::new(plan.sea, plan.kinds, plan.field, plan.tick, &plan.seeds),
            contact: ContactModel::new(shapes, plan.field, plan.boats_are_solid, dt_s),
            pairs_within_m: plan.pairs_within_m,
            kinds: plan.vehicles.iter().map(|vehicle| vehicle.kind).collect(),
            hulls,
            drives,
        }
    }

    /// Initial flaw state of each vehicle's thrusters.
    pub(crate) fn flaws_at_start(&self) -> Vec<FlawState> {
        let start = |kind: &usize| match &self.drives[*kind] {
            Drive::Thrusters(thruster, ..) => thruster.start(),
            Drive::Point(_) => FlawState::default(),
        };
        self.kinds.iter().map(start).collect()
    }

    pub(crate) fn points_at_start(&self, boats: &[BoatState]) -> Vec<KinematicState> {
        let is_point = |(i, _): &(usize, &BoatState)| self.points[*i].is_some();
        let points = boats.iter().enumerate().filter(is_point);
        points
            .map(|(_, boat)| KinematicState::at_rest(boat.pose.psi_rad))
            .collect()
    }

    /// Initial state and reading of the sensors, before the first measurement.
    pub(crate) fn senses_at_start(&self) -> Vec<(SensorState, Reading)> {
        self.sensed
            .iter()
            .flatten()
            .map(|_| (SensorState::default(), Reading::default()))
            .collect()
    }

    /// Compass error of a vehicle, rad.
    #[inline]
    pub(crate) fn heading_error_rad(
        &self,
        vehicle: usize,
        senses: &[(SensorState, Reading)],
    ) -> f64 {
        self.sensed[vehicle]
            .as_ref()
            .map_or(0.0, |(place, _)| senses[*place].0.heading_error_rad())
    }

    /// Whether a vehicle is a real boat, which the simulation never moves.
    #[inline]
    pub(crate) fn is_external(&self, vehicle: usize) -> bool {
        self.external[vehicle]
    }

    /// The model of a point boat, and its index among the point boats.
    #[inline]
    pub(crate) fn point(&self, vehicle: usize) -> Option<(usize, &KinematicModel)> {
        match (self.points[vehicle], &self.drives[self.kinds[vehicle]]) {
            (Some(place), Drive::Point(point)) => Some((place, point)),
            _ => None,
        }
    }

    /// Current failures of a vehicle's port and starboard thrusters.
    #[inline]
    pub(crate) fn failing(&self, vehicle: usize, now: SimTime) -> [Option<Failing>; 2] {
        let mut failing = [None; 2];
        for span in self.thruster_faults[vehicle]
            .iter()
            .filter(|span| span.is_on(now))
        {
            match span.kind {
                FaultKind::PortLost => failing[0] = Some(Failing::Lost),
                FaultKind::StarboardLost => failing[1] = Some(Failing::Lost),
                FaultKind::PortStuck => failing[0] = Some(Failing::Stuck),
                FaultKind::StarboardStuck => failing[1] = Some(Failing::Stuck),
                // Faults of sensors, radio and agents are handled elsewhere.
                _ => {}
            }
        }
        failing
    }

    /// The forces on a boat in this tick, and the current around it. The thrusters follow the
    /// command, using the compass heading.
    #[inline]
    pub(crate) fn forcing(
        &self,
        (vehicle, failing): (usize, [Option<Failing>; 2]),
        boat: &mut BoatState,
        flaws: &mut FlawState,
        (rotation, heading_error_rad): (Rotation, f64),
        command: Order,
        sea: &SeaNow<'_>,
    ) -> (Forcing, Ned) {
        let kind = self.kinds[vehicle];
        let Drive::Thrusters(thruster, autopilot) = &self.drives[kind] else {
            return (Forcing::default(), Ned::default());
        };
        // A quarantined boat stays in place, so that one bug does not end the game for all others.
        if boat.quarantined || self.external[vehicle] {
            return (Forcing::default(), Ned::default());
        }
        let hull = &self.hulls[kind];
        let mut settings = settings(
            boat,
            heading_error_rad,
            (hull, thruster, autopilot),
            command,
        );
        for (side, shaft) in [&boat.port, &boat.starboard].into_iter().enumerate() {
            // The front seat does not know of the fault and steers as if both thrusters worked:
            // that is the purpose of the fault.
            let Some(failing) = failing[side] else {
                continue;
            };
            settings[side] = if failing == Failing::Lost {
                0.0
            } else {
                shaft.command
            };
            // Also replace settings in transit.
            flaws.replace_under_way(side, settings[side]);
        }
        let from_sea = sea.forcing(kind, hull, boat.pose, rotation, boat.nu);
        let still_m = thruster
            .ventilation()
            .map_or(0.0, |ventilation| ventilation.depth_m);
        let water_above_m = from_sea
            .submergence_change_m
            .map(|change_m| still_m + change_m);
        let thrust = thruster.drive(
            [&mut boat.port, &mut boat.starboard],
            flaws,
            settings,
            water_above_m,
        );
        let forcing = Forcing {
            nu_r: through_water(boat.nu, rotation, from_sea.current_m_s, -1.0),
            tau: thrust.map(|thrust| thrust.plus(1.0, from_sea.force)),
            water: from_sea.water,
            water_rate: from_sea.water_rate,
        };
        (forcing, from_sea.current_m_s)
    }

    /// A hull's pose after a tick without contact, with the rotation of its heading, and its
    /// velocity over the ground.
    #[inline]
    pub(crate) fn hull_moved(
        &self,
        from: Pose,
        rotation: Rotation,
        forcing: &Forcing,
        motion: &Motion,
        current_m_s: Ned,
    ) -> (Pose, Rotation, Planar) {
        // Wrap every tick: an angle that accumulated turns would lose digits in a long game.
        let psi_rad = wrap_pi(from.psi_rad + motion.turn_rad);
        let rotation_half = rotation.turned(small_rotation(motion.turn_half_rad));
        let rotation_to = Rotation::from_heading(psi_rad);
        // Simpson's rule for the distance over the ground: velocities in body axes are known at the
        // start, middle and end of the tick, while the axes turn.
        let start = forcing.nu_r.in_ned(rotation);
        let middle = motion.nu_r_half.in_ned(rotation_half);
        let end = motion.nu_r.in_ned(rotation_to);
        let mean_m_s = (start + middle.scaled(4.0) + end).scaled(1.0 / 6.0) + current_m_s;
        let to = Pose {
            at: from.at + mean_m_s.scaled(self.dt_s),
            psi_rad,
        };
        (
            to,
            rotation_to,
            through_water(motion.nu_r, rotation_to, current_m_s, 1.0),
        )
    }

    /// Like [`Model::hull_moved`], for a point boat.
    pub(crate) fn point_moved(
        &self,
        from: Pose,
        (point, state): (&KinematicModel, &mut KinematicState),
        command: Order,
        drift_m_s: Ned,
    ) -> (Pose, Rotation, Planar) {
        let motion = point.step(state, command, drift_m_s, self.dt_s);
        let to = Pose {
            at: from.at + motion.travel_m,
            psi_rad: state.psi_rad(),
        };
        let rotation_to = to.rotation();
        let nu = Planar {
            surge: state.speed_m_s,
            sway: 0.0,
            yaw: motion.turn_rad / self.dt_s,
        };
        (
            to,
            rotation_to,
            through_water(nu, rotation_to, drift_m_s, 1.0),
        )
    }

    /// A boat's role in contact.
    #[inline]
    pub(crate) fn role(&self, vehicle: usize, boat: &BoatState) -> ContactRole {
        match (self.external[vehicle], boat.quarantined) {
            (true, _) => ContactRole::Kinematic,
            (false, true) => ContactRole::Fixed,
            (false, false) => ContactRole::Dynamic,
        }
    }

    pub(crate) fn truth(
        &self,
        vehicle: usize,
        boat: &BoatState,
        rotation: Rotation,
        sea: &SeaNow<'_>,
    ) -> Truth {
        let kind = self.kinds[vehicle];
        let thrust_share = match &self.drives[kind] {
            Drive::Thrusters(thruster, ..) => {
                0.5 * (boat.port.newton.abs() + boat.starboard.newton.abs()) / thruster.newton_max
            }
            Drive::Point(_) => 0.0,
        };
        // A real boat's attitude is unknown, and a point boat has none.
        let attitude = match self.drives[kind] {
            Drive::Thrusters(..) if !self.external[vehicle] => {
                sea.attitude(kind, boat.pose, rotation, boat.nu)
            }
            _ => Attitude::default(),
        };
        Truth {
            pose: boat.pose,
            nu: boat.nu,
            nu_dot: Planar::default().plus(1.0 / self.dt_s, boat.nu_change),
            attitude,
            thrust_share,
        }
    }
}

/// Numbers the selected items.
fn numbered(counts: impl Iterator<Item = bool>) -> Vec<Option<usize>> {
    let mut before = 0;
    let place = |counts: bool| {
        let place = before;
        before += usize::from(counts);
        counts.then_some(place)
    };
    counts.map(place).collect()
}

#[inline]
fn thruster_faults(faults: &[FaultSpan]) -> Vec<FaultSpan> {
    let is_of_thrusters = |kind: FaultKind| {
        use FaultKind::{PortLost, PortStuck, StarboardLost, StarboardStuck};
        matches!(kind, PortLost | PortStuck | StarboardLost | StarboardStuck)
    };
    faults
        .iter()
        .filter(|span| is_of_thrusters(span.kind))
        .copied()
        .collect()
}

/// The settings of the port and starboard thrusters for a command.
fn settings(
    boat: &mut BoatState,
    heading_error_rad: f64,
    (hull, thruster, autopilot): (&HullModel, &ThrusterModel, &AutopilotModel),
    command: Order,
) -> [f64; 2] {
    match command {
        Order::Steer {
            heading_rad,
            speed_m_s,
        } => {
            let turn_rad = wrap_pi(heading_rad - (boat.pose.psi_rad + heading_error_rad));
            autopilot.steer(
                (hull, thruster),
                boat.nu,
                (turn_rad, speed_m_s),
                &mut boat.speed_integral_newton,
            )
        }
        Order::Turn { by_rad, speed_m_s } => autopilot.steer(
            (hull, thruster),
            boat.nu,
            (by_rad, speed_m_s),
            &mut boat.speed_integral_newton,
        ),
        Order::Thrust { port, starboard } => [
            thruster.setting_of_share(port),
            thruster.setting_of_share(starboard),
        ],
        Order::Hold => [0.0, 0.0],
    }
}

/// The rotation by the small angle turned in half a tick. The series is accurate to the last digit
/// and much faster than sine and cosine.
#[inline]
fn small_rotation(by_rad: f64) -> Rotation {
    let square = by_rad * by_rad;
    if square >= 0.01 {
        return Rotation::from_heading(by_rad);
    }
    Rotation {
        sin: by_rad
            * (1.0
                - square / 6.0
                    * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)))),
        cos: 1.0
            - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0))),
    }
}

/// `nu` plus `sign` times the current in body axes: −1 converts velocity over the ground to
/// velocity through the water, 1 converts it back.
#[inline]
fn through_water(nu: Planar, rotation: Rotation, current_m_s: Ned, sign: f64) -> Planar {
    let current = frame::body_from_ned(rotation, current_m_s);
    nu.plus(
        sign,
        Planar {
            surge: current.ahead,
            sway: current.starboard,
            yaw: 0.0,
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_turned_by_the_series_is_the_heading_turned() {
        for i in -400..=400 {
            let psi_rad = f64::from(i) * 0.0231;
            let by_rad = f64::from(i) * 0.0007;
            let want = Rotation::from_heading(psi_rad + by_rad);
            let got = Rotation::from_heading(psi_rad).turned(small_rotation(by_rad));
            assert!(
                (want.sin - got.sin).abs() < 2e-15 && (want.cos - got.cos).abs() < 2e-15,
                "{i}: {want:?} {got:?}"
            );
        }
    }
}
