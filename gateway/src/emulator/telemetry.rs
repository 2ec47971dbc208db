//! A Surveyor's telemetry, in one burst: fix, course, attitude, battery, control state, error code.

use super::Emulator;
use crate::nmea::{
    Attitude, Battery, BoatError, ControlState, Date, Gga, Hdg, Hdt, M_S_PER_KN, Mode, Rmc,
    Sentence, Talker, TimeOfDay, Vtg, Zda,
};
use messages::picture::{Imu, Nav};
use primitives::angle::compass_deg_from_rad;
use primitives::{LatLon, SimTime};

/// Minimum speed at which a receiver reports a course, m/s.
const COURSE_FROM_M_S: f64 = 0.1;
const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

/// Sentences that a Surveyor does not send, for readers that need them: gpsd gets time and speed
/// only from RMC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    /// Fix with date, course and speed.
    Rmc,
    /// True heading.
    Hdt,
    /// Magnetic heading and variation.
    Hdg,
    /// Time and date.
    Zda,
}

/// Writes a complete burst.
pub(super) fn burst(boat: &Emulator, now: SimTime, out: &mut Vec<u8>) {
    if let (Some(own), Some(seen)) = (&boat.sensed.own, boat.sensed.fix_seen) {
        let report = FixReport::new(boat, now, seen, &own.nav);
        Sentence::Gga(report.gga()).write(out);
        Sentence::Vtg(report.vtg(boat)).write(out);
        for extra in &boat.plan.extra {
            report.extra(boat, *extra).write(out);
        }
        Sentence::Attitude(attitude(boat, &own.nav, &own.imu)).write(out);
    }
    Sentence::Battery(battery(&boat.battery, now)).write(out);
    Sentence::ControlState(control_state(boat)).write(out);
    // The only known code, from West Point's driver, which treats any other as a warning.
    Sentence::BoatError(BoatError {
        code: "N".to_owned(),
    })
    .write(out);
}

/// A fix as reported.
struct FixReport {
    date: Date,
    now: TimeOfDay,
    time: TimeOfDay,
    /// `None` if the receiver has lost its fix.
    at: Option<LatLon>,
    psi_rad: f64,
    /// Course, rad, if any, and speed, m/s.
    course_rad: Option<f64>,
    speed_m_s: f64,
}

impl FixReport {
    fn new(boat: &Emulator, now: SimTime, seen: SimTime, nav: &Nav) -> FixReport {
        let (date, began) = boat.plan.began;
        let velocity = nav.velocity_m_s();
        let speed_m_s = velocity.length();
        FixReport {
            date,
            now: began.later(now),
            time: began.later(seen),
            at: boat
                .sensed
                .has_fix(now)
                .then(|| boat.frame.lat_lon(nav.at())),
            psi_rad: nav.psi_rad,
            // Blank, not zero: a reader that treated a missing course as north would compute a
            // wrong velocity for a boat at rest.
            course_rad: (speed_m_s >= COURSE_FROM_M_S).then(|| velocity.direction_rad()),
            speed_m_s,
        }
    }

    fn gga(&self) -> Gga {
        Gga {
            talker: Talker::GP,
            time: Some(self.time),
            at: self.at,
            // In the public samples, Surveyors report DGPS (2) with about eleven satellites.
            quality: if self.at.is_some() { 2 } else { 0 },
            satellites: Some(if self.at.is_some() { 11 } else { 0 }),
            hdop: self.at.map(|_| 0.98),
            altitude_m: Some(5.5),
            geoid_m: Some(-33.2),
        }
    }

    fn vtg(&self, boat: &Emulator) -> Vtg {
        let degrees = |rad: f64| compass_deg_from_rad(rad);
        Vtg {
            talker: Talker::GP,
            course_true_deg: self.course_rad.map(degrees),
            course_magnetic_deg: self
                .course_rad
                .map(|rad| degrees(rad - boat.plan.declination_rad)),
            speed_kn: Some(self.speed_m_s / M_S_PER_KN),
            speed_km_h: Some(3.6 * self.speed_m_s),
            // Newer boats omit the mode.
            with_mode: false,
        }
    }

    fn extra(&self, boat: &Emulator, extra: Extra) -> Sentence {
        let east_deg = boat.plan.declination_rad.to_degrees();
        match extra {
            Extra::Rmc => Sentence::Rmc(Rmc {
                talker: Talker::GP,
                time: Some(self.time),
                valid: self.at.is_some(),
                at: self.at,
                speed_kn: Some(self.speed_m_s / M_S_PER_KN),
                course_deg: self.course_rad.map(compass_deg_from_rad),
                date: Some(self.date),
            }),
            Extra::Hdt => Sentence::Hdt(Hdt {
                talker: Talker::GP,
                heading_deg: Some(compass_deg_from_rad(self.psi_rad)),
            }),
            Extra::Hdg => Sentence::Hdg(Hdg {
                talker: Talker::HC,
                heading_deg: Some(compass_deg_from_rad(
                    self.psi_rad - boat.plan.declination_rad,
                )),
                deviation_deg: None,
                variation_deg: Some(east_deg),
            }),
            Extra::Zda => Sentence::Zda(Zda {
                talker: Talker::GP,
                time: Some(self.now),
                date: Some(self.date),
            }),
        }
    }
}

fn attitude(boat: &Emulator, nav: &Nav, imu: &Imu) -> Attitude {
    let g = |acceleration_m_s2: f64| Some(acceleration_m_s2 / STANDARD_GRAVITY_M_S2);
    Attitude {
        pitch_deg: Some(0.0),
        roll_deg: Some(0.0),
        heading_deg: Some(compass_deg_from_rad(
            nav.psi_rad - boat.plan.declination_rad,
        )),
        box_c: Some(31.0),
        accel_ahead_g: g(imu.ahead_m_s2),
        accel_starboard_g: g(imu.starboard_m_s2),
        accel_down_g: g(imu.down_m_s2),
        yaw_rate_deg_s: Some(nav.yaw_rate_rad_s.to_degrees()),
        ..Attitude::default()
    }
}

fn battery(battery: &super::battery::Battery, now: SimTime) -> Battery {
    let [port_a, starboard_a] = battery.thruster_a;
    Battery {
        volts: Some(battery.volts()),
        charge: Some(battery.left_mah()),
        amps: Some(battery.amps()),
        celsius: Some(22.3),
        charge_used: Some(battery.used_mah()),
        port_volts: Some(battery.volts()),
        system_amps: Some(battery.pack.system_a),
        port_amps: Some(port_a),
        starboard_amps: Some(starboard_a),
        hours: Some((now.as_s() / 3600.0).floor()),
        ..Battery::default()
    }
}

fn control_state(boat: &Emulator) -> ControlState {
    // Without a commanded heading, the boat reports its own: in public samples, PSEAD in mode T
    // contains the boat's heading.
    let steers = matches!(boat.command.mode, Mode::Heading | Mode::Speed);
    let has = || {
        boat.sensed
            .own
            .as_ref()
            .map(|own| compass_deg_from_rad(own.nav.psi_rad - boat.plan.declination_rad))
    };
    // Report the command as executed: limited to full thrust, except for a speed.
    let is_speed = boat.command.mode == Mode::Speed;
    let clamped = |number: Option<f64>| {
        number.map(|number| {
            if is_speed {
                number
            } else {
                number.clamp(-100.0, 100.0)
            }
        })
    };
    ControlState {
        mode: boat.command.mode,
        heading_deg: if steers {
            boat.command.heading_deg
        } else {
            has()
        },
        thrust: clamped(boat.command.thrust),
        difference: clamped(boat.command.difference),
        words: boat.command.words.clone(),
        transmission: Some('T'),
        sent_to: Some(boat.operator.number()),
        operator: Some(boat.operator),
    }
}
