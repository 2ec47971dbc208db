//! The Surveyor's protocol: reports from its sentences, sentences from commands.

use super::codec::{Codec, Command, UploadStep, named};
use super::mission_check;
use super::report::{ControlReport, Fix, Heading, North, Power, Report, Shown};
use crate::nmea::{
    self, ControlState, FixQuality, Framer, Gga, M_S_PER_KN, MissionSettings, Mode, ParseError,
    Sentence, Waypoint,
};
use crate::set_point::SetPoint;
use crate::supervisor::Task;
use messages::external::{BoatMode, Mission};
use primitives::SimTime;
use primitives::frame::{LatLon, Ned};
use std::collections::{BTreeMap, VecDeque};

/// Maximum number of unknown sentence names stored.
const UNKNOWN_MAX: usize = 64;

/// A mission being uploaded, line by line with pauses.
#[derive(Clone, Debug)]
struct Upload {
    /// The lines still to be sent.
    lines: VecDeque<Sentence>,
    due: SimTime,
}

/// The state of a link.
#[derive(Clone, Debug)]
pub struct Surveyor {
    framer: Framer,
    upload: Option<Upload>,
    upload_gap_s: f64,
    unreadable: u64,
    unknown: BTreeMap<String, u64>,
}

impl Surveyor {
    pub(super) fn new(upload_gap_s: f64) -> Surveyor {
        Surveyor {
            framer: Framer::new(),
            upload: None,
            upload_gap_s,
            unreadable: 0,
            unknown: BTreeMap::new(),
        }
    }
}

impl Codec for Surveyor {
    fn begin_link(&mut self) {
        // Bytes from the new link must not complete a truncated sentence.
        self.framer.push(b"\r\n", &mut |_| {});
        self.upload = None;
    }

    fn read(&mut self, _: SimTime, bytes: &[u8], take: &mut dyn FnMut(Report)) {
        let Surveyor {
            framer,
            unreadable,
            unknown,
            ..
        } = self;
        framer.push(bytes, &mut |body| match Sentence::parse(body) {
            Ok(sentence) => report(&sentence, take),
            Err(ParseError::Unknown { address }) => {
                // Names arrive over a link that may carry noise: without a limit they would exhaust
                // memory.
                let room = unknown.len() < UNKNOWN_MAX;
                let name = if room || unknown.contains_key(&address) {
                    address
                } else {
                    "others".to_owned()
                };
                *unknown.entry(name).or_default() += 1;
            }
            Err(_) => *unreadable += 1,
        });
    }

    fn write(&mut self, _: SimTime, command: Command, out: &mut Vec<u8>) {
        write(command, out);
    }

    /// A Surveyor sends everything without request and needs no heartbeat.
    fn keep_up(&mut self, _: SimTime, _: &mut Vec<u8>) {}

    fn has_boat_modes(&self) -> bool {
        true
    }

    fn shown(&self, command: Command) -> Shown {
        // In whole percentages, as sent: the boat's report is compared with this.
        let nmea::Command {
            mode,
            heading_deg,
            thrust,
            difference,
            ..
        } = sentence(command).rounded();
        Shown {
            mode,
            heading_deg,
            thrust,
            difference,
        }
    }

    fn text(&self, command: Command) -> String {
        Sentence::Command(sentence(command))
            .line()
            .trim_end()
            .to_owned()
    }

    fn stop_message(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(Command::Zero, &mut bytes);
        write(Command::Standby, &mut bytes);
        bytes
    }

    /// A Surveyor follows only the operator in control, and none of our sentences changes that.
    fn forced_stop_message(&self) -> Vec<u8> {
        self.stop_message()
    }

    /// Ends an incomplete sentence first.
    fn guard_message(&self) -> Vec<u8> {
        [b"\r\n".to_vec(), self.stop_message()].concat()
    }

    fn begin_upload(&mut self, now: SimTime, mission: &Mission) -> Result<(), String> {
        mission_check::check(mission)?;
        self.upload = Some(Upload {
            lines: lines_of(mission),
            due: now,
        });
        Ok(())
    }

    fn continue_upload(&mut self, now: SimTime, out: &mut Vec<u8>) -> UploadStep {
        let Some(upload) = &mut self.upload else {
            return UploadStep::Done;
        };
        if now < upload.due {
            return UploadStep::Waiting;
        }
        upload.due = now + SimTime::from_s(self.upload_gap_s);
        match upload.lines.pop_front() {
            Some(line) => {
                line.write(out);
                UploadStep::Sent
            }
            None => {
                self.upload = None;
                UploadStep::Done
            }
        }
    }

    fn is_uploading(&self) -> bool {
        self.upload.is_some()
    }

    fn abort_upload(&mut self) -> bool {
        self.upload.take().is_some()
    }

    fn due(&self) -> Option<SimTime> {
        self.upload.as_ref().map(|upload| upload.due)
    }

    fn counts(&self) -> [Vec<(String, u64)>; 2] {
        let framed = self.framer.counts();
        let known = named([
            ("sentences in", framed.sentences),
            ("bad checksums", framed.bad_checksum),
            ("overlong", framed.overlong),
            ("broken", framed.broken),
            ("bytes of garbage", framed.garbage),
            ("unreadable", self.unreadable),
        ]);
        let unknown = self
            .unknown
            .iter()
            .map(|(name, count)| (format!("unknown {name}"), *count));
        [known, unknown.collect()]
    }
}

/// The lines of a mission: start of download, settings, emergency recovery point (index 0),
/// waypoints, end.
fn lines_of(mission: &Mission) -> VecDeque<Sentence> {
    // The lines that follow: settings, recovery point, waypoints.
    let count = mission.waypoints.len() + 2;
    let mut lines = VecDeque::from([
        Sentence::Command(pseac(
            Mode::FileDownload,
            [Some(count as f64), Some(0.0), Some(0.0)],
        )),
        Sentence::MissionSettings(MissionSettings {
            throttle_pct: mission.throttle_pct,
        }),
    ]);
    for (index, [lat_deg, lon_deg]) in std::iter::once(&mission.erp)
        .chain(&mission.waypoints)
        .enumerate()
    {
        let at = LatLon {
            lat_deg: *lat_deg,
            lon_deg: *lon_deg,
        };
        lines.push_back(Sentence::Waypoint(Waypoint {
            at,
            index: index as u16,
        }));
    }
    lines.push_back(Sentence::Command(sentence(Command::EndOfUpload)));
    lines
}

/// The reports in a sentence.
fn report(sentence: &Sentence, take: &mut dyn FnMut(Report)) {
    match sentence {
        Sentence::Gga(gga) => {
            let Gga {
                time,
                at,
                quality,
                hdop,
                satellites,
                ..
            } = *gga;
            take(Report::Fix(Fix {
                time,
                at,
                quality: Some(FixQuality::from_gga(quality)),
                hdop,
                satellites,
            }));
            if let Some(time) = gga.time {
                take(Report::Clock(time));
            }
        }
        Sentence::Rmc(rmc) => {
            report_velocity(rmc.course_deg, rmc.speed_kn, take);
            // RMC reports no quality, only whether there is a fix.
            let quality = (!rmc.valid).then_some(FixQuality::NONE);
            take(Report::Fix(Fix {
                time: rmc.time,
                at: rmc.at,
                quality,
                ..Fix::default()
            }));
        }
        Sentence::Vtg(vtg) => {
            let speed_kn = vtg.speed_kn.or(vtg.speed_km_h.map(|km_h| km_h / 1.852));
            report_velocity(vtg.course_true_deg, speed_kn, take);
        }
        Sentence::Attitude(attitude) => {
            if let Some(deg) = attitude.heading_deg {
                take(Report::Heading(Heading {
                    deg,
                    north: North::Compass,
                    yaw_rate_deg_s: attitude.yaw_rate_deg_s,
                }));
            }
            take(Report::Tilt(
                [attitude.roll_deg, attitude.pitch_deg].map(Option::unwrap_or_default),
            ));
        }
        Sentence::Hdt(hdt) => {
            if let Some(deg) = hdt.heading_deg {
                take(Report::Heading(Heading {
                    deg,
                    north: North::True,
                    yaw_rate_deg_s: None,
                }));
            }
        }
        Sentence::ControlState(state) => {
            let ControlState {
                mode,
                heading_deg,
                thrust,
                difference,
                operator,
                ..
            } = *state;
            take(Report::Control(ControlReport {
                shown: Shown {
                    mode,
                    heading_deg,
                    thrust,
                    difference,
                },
                operator,
            }));
        }
        Sentence::Battery(battery) => take(Report::Power(Power {
            volts: battery.volts,
            left_pct: None,
            thruster_a: [battery.port_amps, battery.starboard_amps],
            bilge_a: [battery.port_bilge_amps, battery.starboard_bilge_amps],
        })),
        Sentence::BoatError(error) => take(Report::Error(
            (error.code != "N").then(|| error.code.clone()),
        )),
        _ => {}
    }
}

fn report_velocity(course_deg: Option<f64>, speed_kn: Option<f64>, take: &mut dyn FnMut(Report)) {
    match (course_deg, speed_kn) {
        // Receivers leave the course of a boat at rest blank, which does not mean north.
        (None, Some(speed_kn)) if speed_kn < 0.5 => take(Report::Velocity(Ned::default())),
        (Some(course_deg), Some(speed_kn)) => take(Report::Velocity(
            Ned::toward_deg(course_deg).scaled(speed_kn * M_S_PER_KN),
        )),
        _ => {}
    }
}

/// `PSEAC` with these numbers in its second to fourth fields.
fn pseac(mode: Mode, numbers: [Option<f64>; 3]) -> nmea::Command {
    let [heading_deg, thrust, difference] = numbers;
    nmea::Command {
        mode,
        heading_deg,
        thrust,
        difference,
        ..nmea::Command::default()
    }
}

fn sentence(command: Command) -> nmea::Command {
    match command {
        // Zeros, as in the public drivers that run these boats: an empty field might mean
        // "unchanged".
        Command::Standby => pseac(Mode::Standby, [Some(0.0); 3]),
        Command::Switch(word) => nmea::Command {
            words: word.text().to_owned(),
            ..sentence(Command::Standby)
        },
        Command::Zero => sentence(Command::SetPoint(SetPoint::ZERO)),
        Command::SetPoint(SetPoint::Thrust {
            thrust_pct,
            difference_pct,
        }) => pseac(
            Mode::Thruster,
            [Some(0.0), Some(thrust_pct), Some(difference_pct)],
        ),
        Command::SetPoint(SetPoint::Speed {
            heading_deg,
            speed_m_s,
        }) => pseac(
            Mode::Speed,
            [Some(heading_deg), Some(speed_m_s / M_S_PER_KN), None],
        ),
        // Empty fields, as sent by the only public driver that has used this mode.
        Command::Task(Task::StationKeep) => pseac(Mode::StationKeep, [None; 3]),
        Command::Task(Task::GoToErp) => pseac(Mode::GoToErp, [Some(0.0); 3]),
        Command::Task(Task::Mission) => pseac(Mode::Waypoint, [Some(0.0); 3]),
        Command::Task(Task::Mode(BoatMode::Heading {
            heading_deg,
            thrust_pct,
        })) => pseac(Mode::Heading, [Some(heading_deg), Some(thrust_pct), None]),
        Command::Task(Task::Mode(mode)) => pseac(mode_of(mode), [Some(0.0); 3]),
        Command::EndOfUpload => pseac(Mode::FileDownload, [Some(0.0); 3]),
    }
}

fn mode_of(mode: BoatMode) -> Mode {
    match mode {
        BoatMode::Heading { .. } => Mode::Heading,
        BoatMode::RiverNav => Mode::RiverNav,
        BoatMode::Autopilot => Mode::Autopilot,
        BoatMode::CompassCalibration => Mode::CompassCalibration,
        BoatMode::Depth => Mode::Depth,
        BoatMode::GravityVector => Mode::GravityVector,
    }
}

fn write(command: Command, out: &mut Vec<u8>) {
    Sentence::Command(sentence(command)).write(out);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_boat_should_show_is_what_it_was_sent() {
        for (thrust_pct, difference_pct) in [(40.4, -9.6), (12.5, 0.49), (-33.3, 66.7)] {
            let command = Command::SetPoint(SetPoint::Thrust {
                thrust_pct,
                difference_pct,
            });
            let mut bytes = vec![];
            let mut sent = None;
            write(command, &mut bytes);
            Framer::new().push(&bytes, &mut |body| sent = Sentence::parse(body).ok());
            let Some(Sentence::Command(sent)) = sent else {
                panic!("no command: {bytes:?}")
            };
            let shown = Surveyor::new(1.0).shown(command);
            assert_eq!(
                (shown.thrust, shown.difference),
                (sent.thrust, sent.difference)
            );
        }
    }
}
