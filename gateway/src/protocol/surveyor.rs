//! The Surveyor's protocol: reports from its sentences, sentences from commands.

use super::report::{ControlReport, Fix, Heading, North, Power, Report, Shown};
use super::surveyor_upload::{Next, Upload};
use super::{Command, UploadStep, mission_check};
use crate::nmea::{self, ControlState, FixQuality, Framer, Gga, M_S_PER_KN, Mode, ParseError, Sentence};
use crate::set_point::SetPoint;
use crate::supervisor::Task;
use messages::external::{BoatMode, Mission};
use primitives::SimTime;
use primitives::frame::Ned;
use std::collections::BTreeMap;

/// Maximum number of unknown sentence names stored.
const UNKNOWN_MAX: usize = 64;

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
        Surveyor { framer: Framer::new(), upload: None, upload_gap_s, unreadable: 0, unknown: BTreeMap::new() }
    }

    pub(super) fn begin_link(&mut self) {
        // Bytes from the new link must not complete a truncated sentence.
        self.framer.push(b"\r\n", &mut |_| {});
        self.upload = None;
    }

    pub(super) fn read(&mut self, bytes: &[u8], take: &mut dyn FnMut(Report)) {
        let Surveyor { framer, unreadable, unknown, .. } = self;
        framer.push(bytes, &mut |body| match Sentence::parse(body) {
            Ok(sentence) => report(&sentence, take),
            Err(ParseError::Unknown { address }) => {
                // Names arrive over a wire that may carry noise: without a limit they would fill
                // the memory.
                let room = unknown.len() < UNKNOWN_MAX;
                let name = if room || unknown.contains_key(&address) { address } else { "others".to_owned() };
                *unknown.entry(name).or_default() += 1;
            }
            Err(_) => *unreadable += 1,
        });
    }

    pub(super) fn begin_upload(&mut self, now: SimTime, mission: &Mission) -> Result<(), String> {
        mission_check::check(mission)?;
        self.upload = Some(Upload::new(mission, self.upload_gap_s, now));
        Ok(())
    }

    pub(super) fn continue_upload(&mut self, now: SimTime, out: &mut Vec<u8>) -> UploadStep {
        match self.upload.as_mut().map(|upload| upload.next(now)) {
            Some(Next::Line(line)) => {
                line.write(out);
                UploadStep::Sent
            }
            Some(Next::Wait) => UploadStep::Waiting,
            Some(Next::Done) | None => {
                self.upload = None;
                UploadStep::Done
            }
        }
    }

    pub(super) fn is_uploading(&self) -> bool {
        self.upload.is_some()
    }

    pub(super) fn abort_upload(&mut self) -> bool {
        self.upload.take().is_some()
    }

    pub(super) fn due(&self) -> Option<SimTime> {
        self.upload.as_ref().map(Upload::due)
    }

    pub(super) fn counts(&self) -> [Vec<(String, u64)>; 2] {
        let framed = self.framer.counts();
        let known = [
            ("sentences in", framed.sentences),
            ("bad checksums", framed.bad_checksum),
            ("overlong", framed.overlong),
            ("broken", framed.broken),
            ("bytes of garbage", framed.garbage),
            ("unreadable", self.unreadable),
        ];
        let unknown = self.unknown.iter().map(|(name, count)| (format!("unknown {name}"), *count));
        [known.into_iter().map(|(name, count)| (name.to_owned(), count)).collect(), unknown.collect()]
    }
}

/// The reports in a sentence.
fn report(sentence: &Sentence, take: &mut dyn FnMut(Report)) {
    match sentence {
        Sentence::Gga(gga) => {
            let Gga { time, at, quality, hdop, satellites, .. } = *gga;
            take(Report::Fix(Fix { time, at, quality: Some(FixQuality::from_gga(quality)), hdop, satellites }));
            gga.time.into_iter().for_each(|time| take(Report::Clock(time)));
        }
        Sentence::Rmc(rmc) => {
            velocity(rmc.course_deg, rmc.speed_kn).into_iter().for_each(|velocity| take(Report::Velocity(velocity)));
            // It contains no quality, only whether there is a fix.
            let quality = (!rmc.valid).then_some(FixQuality::NONE);
            take(Report::Fix(Fix { time: rmc.time, at: rmc.at, quality, ..Fix::default() }));
        }
        Sentence::Vtg(vtg) => {
            let speed_kn = vtg.speed_kn.or(vtg.speed_km_h.map(|km_h| km_h / 1.852));
            let velocity = velocity(vtg.course_true_deg, speed_kn);
            velocity.into_iter().for_each(|velocity| take(Report::Velocity(velocity)));
        }
        Sentence::Attitude(attitude) => {
            let yaw_rate_deg_s = attitude.yaw_rate_deg_s;
            let heading = attitude.heading_deg.map(|deg| Heading { deg, north: North::Compass, yaw_rate_deg_s });
            heading.into_iter().for_each(|heading| take(Report::Heading(heading)));
            take(Report::Tilt([attitude.roll_deg, attitude.pitch_deg].map(Option::unwrap_or_default)));
        }
        Sentence::Hdt(hdt) => {
            let heading = hdt.heading_deg.map(|deg| Heading { deg, north: North::True, yaw_rate_deg_s: None });
            heading.into_iter().for_each(|heading| take(Report::Heading(heading)));
        }
        Sentence::ControlState(state) => {
            let ControlState { mode, heading_deg, thrust, difference, operator, .. } = *state;
            take(Report::Control(ControlReport { shown: Shown { mode, heading_deg, thrust, difference }, operator }));
        }
        Sentence::Battery(battery) => take(Report::Power(Power {
            volts: battery.volts,
            thruster_a: [battery.port_amps, battery.starboard_amps],
            bilge_a: [battery.port_bilge_amps, battery.starboard_bilge_amps],
        })),
        Sentence::BoatError(error) => take(Report::Error((error.code != "N").then(|| error.code.clone()))),
        _ => {}
    }
}

fn velocity(course_deg: Option<f64>, speed_kn: Option<f64>) -> Option<Ned> {
    match (course_deg, speed_kn) {
        // Receivers leave the course of a boat at rest blank; it is not north.
        (None, Some(speed_kn)) if speed_kn < 0.5 => Some(Ned::default()),
        (Some(course_deg), Some(speed_kn)) => Some(Ned::toward_deg(course_deg).scaled(speed_kn * M_S_PER_KN)),
        _ => None,
    }
}

/// `PSEAC` with these numbers in its second to fourth field.
fn pseac(mode: Mode, numbers: [Option<f64>; 3]) -> nmea::Command {
    let [heading_deg, thrust, difference] = numbers;
    nmea::Command { mode, heading_deg, thrust, difference, ..nmea::Command::default() }
}

fn sentence(command: Command) -> nmea::Command {
    match command {
        // Zeros, as in the public drivers that run these boats: an empty field might mean
        // "unchanged".
        Command::Standby => pseac(Mode::Standby, [Some(0.0); 3]),
        Command::Switch(word) => nmea::Command { words: word.text().to_owned(), ..sentence(Command::Standby) },
        Command::Zero => sentence(Command::SetPoint(SetPoint::ZERO)),
        Command::SetPoint(SetPoint::Thrust { thrust_pct, difference_pct }) => {
            pseac(Mode::Thruster, [Some(0.0), Some(thrust_pct), Some(difference_pct)])
        }
        Command::SetPoint(SetPoint::Speed { heading_deg, speed_m_s }) => {
            pseac(Mode::Speed, [Some(heading_deg), Some(speed_m_s / M_S_PER_KN), None])
        }
        // Empty fields, as sent by the one public driver that has used it.
        Command::Task(Task::StationKeep) => pseac(Mode::StationKeep, [None; 3]),
        Command::Task(Task::GoToErp) => pseac(Mode::GoToErp, [Some(0.0); 3]),
        Command::Task(Task::Mission) => pseac(Mode::Waypoint, [Some(0.0); 3]),
        Command::Task(Task::Mode(BoatMode::Heading { heading_deg, thrust_pct })) => {
            pseac(Mode::Heading, [Some(heading_deg), Some(thrust_pct), None])
        }
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

/// Starts a download of this many lines.
pub(super) fn start_of_download(lines: usize) -> Sentence {
    Sentence::Command(pseac(Mode::FileDownload, [Some(lines as f64), Some(0.0), Some(0.0)]))
}

/// Ends a download, finished or not.
pub(super) fn end_of_download() -> Sentence {
    Sentence::Command(sentence(Command::EndOfUpload))
}

pub(super) fn write(command: Command, out: &mut Vec<u8>) {
    Sentence::Command(sentence(command)).write(out);
}

pub(super) fn shown(command: Command) -> Shown {
    // Compared with what was sent: whole percentages.
    let nmea::Command { mode, heading_deg, thrust, difference, .. } = sentence(command).rounded();
    Shown { mode, heading_deg, thrust, difference }
}

pub(super) fn text(command: Command) -> String {
    let mut bytes = Vec::new();
    write(command, &mut bytes);
    String::from_utf8_lossy(&bytes).trim_end().to_owned()
}

pub(super) fn stop_message() -> Vec<u8> {
    let mut bytes = Vec::new();
    write(Command::Zero, &mut bytes);
    write(Command::Standby, &mut bytes);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_boat_should_show_is_what_it_was_sent() {
        for (thrust_pct, difference_pct) in [(40.4, -9.6), (12.5, 0.49), (-33.3, 66.7)] {
            let command = Command::SetPoint(SetPoint::Thrust { thrust_pct, difference_pct });
            let (mut bytes, mut sent) = (vec![], None);
            write(command, &mut bytes);
            Framer::new().push(&bytes, &mut |body| sent = Sentence::parse(body).ok());
            let Some(Sentence::Command(sent)) = sent else { panic!("no command: {bytes:?}") };
            let shown = shown(command);
            assert_eq!((shown.thrust, shown.difference), (sent.thrust, sent.difference));
        }
    }
}
