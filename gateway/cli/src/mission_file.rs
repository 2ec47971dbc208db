//! Reads missions from `.sea` files, which contain the lines to be sent to a boat.

use anyhow::{Context, Result, anyhow};
use gateway::nmea::{Command, Framer, Mode, Sentence, checksum};
use messages::external::Mission;
use std::path::Path;

/// Size limit of a mission file, bytes: far more than a boat accepts.
const BYTES_MAX: u64 = 1 << 20;

/// Reads the mission in a `.sea` file.
pub(super) fn read(path: &Path) -> Result<Mission> {
    let bytes = primitives::input_file::read(path, BYTES_MAX)
        .with_context(|| format!("cannot read {}", path.display()))?;
    mission_of(&String::from_utf8_lossy(&bytes)).map_err(|(line, why)| {
        let place = line.map_or(String::new(), |line| format!(":{line}"));
        anyhow!("{}{place}: {why}", path.display())
    })
}

/// Parses the content of a mission file; an error names the line and the mistake.
pub fn read_mission(text: &str) -> Result<Mission, String> {
    mission_of(text)
        .map_err(|(line, why)| line.map_or(why.clone(), |line| format!("line {line}: {why}")))
}

/// A mistake: its line number, if known, and a description.
type Mistake = (Option<usize>, String);

/// The state defined by a mission's lines so far.
#[derive(Default)]
struct Lines {
    throttle_pct: Option<f64>,
    places: Vec<[f64; 2]>,
    /// Number of mission lines so far: settings and waypoints.
    count: usize,
    /// The number of the line that announces the count of mission lines to the boat, and that
    /// count.
    announced: Option<(usize, f64)>,
}

fn mission_of(text: &str) -> Result<Mission, Mistake> {
    let mut lines = Lines::default();
    for (i, line) in text.lines().enumerate() {
        // Several sentences may be on one line.
        let mut sentences = line.trim().split('$');
        let before = sentences.next().unwrap_or_default();
        let wrong = |why: String| (Some(i + 1), why);
        if !before.is_empty() {
            return Err(wrong(format!(
                "{before:?} is not a sentence; sentences start with $"
            )));
        }
        for sentence in sentences {
            lines
                .take(i + 1, &sentence_of(sentence.trim()).map_err(wrong)?)
                .map_err(wrong)?;
        }
    }
    lines.mission()
}

/// Parses the sentence after a `$`.
fn sentence_of(text: &str) -> Result<Sentence, String> {
    let mut found = None;
    Framer::new().push(format!("${text}\r\n").as_bytes(), &mut |body| {
        found = Some(Sentence::parse(body))
    });
    if let Some(parsed) = found {
        return parsed.map_err(|e| e.to_string());
    }
    Err(match text.rsplit_once('*') {
        Some((body, stated)) if stated.len() == 2 && body.is_ascii() && !body.contains('*') => {
            format!(
                "the checksum is {stated}, expected {:02X}",
                checksum(body.as_bytes())
            )
        }
        _ => format!("{text:?} does not end with * and a checksum of two digits"),
    })
}

impl Lines {
    fn take(&mut self, line: usize, sentence: &Sentence) -> Result<(), String> {
        match sentence {
            Sentence::MissionSettings(_) if self.throttle_pct.is_some() => {
                return Err("a second PSEAR, expected only one".to_owned());
            }
            Sentence::MissionSettings(settings) => self.throttle_pct = Some(settings.throttle_pct),
            Sentence::Waypoint(waypoint) => {
                let next = self.places.len();
                if usize::from(waypoint.index) != next {
                    return Err(format!(
                        "waypoint {}, expected {next}; waypoints must be in order, beginning with 0, the recovery point",
                        waypoint.index
                    ));
                }
                self.places.push([waypoint.at.lat_deg, waypoint.at.lon_deg]);
            }
            Sentence::Command(Command {
                mode: Mode::FileDownload,
                heading_deg,
                ..
            }) => {
                let announced = heading_deg.unwrap_or(0.0);
                if announced > 0.0 {
                    self.announced = Some((line, announced));
                }
                return Ok(());
            }
            Sentence::Command(Command {
                mode: Mode::Waypoint | Mode::Standby,
                ..
            }) => return Ok(()),
            _ => return Err("unexpected sentence, expected PSEAR or OIWPL".to_owned()),
        }
        self.count += 1;
        Ok(())
    }

    fn mission(self) -> Result<Mission, Mistake> {
        if let Some((line, announced)) = self.announced
            && announced != self.count as f64
        {
            let why = format!(
                "{announced} lines of PSEAR and OIWPL are announced, but the file has {}",
                self.count
            );
            return Err((Some(line), why));
        }
        let throttle_pct = self
            .throttle_pct
            .ok_or_else(|| (None, "no PSEAR (throttle) sentence".to_owned()))?;
        let mut places = self.places.into_iter();
        match (places.next(), places.as_slice()) {
            (Some(erp), [_, ..]) => Ok(Mission {
                throttle_pct,
                erp,
                waypoints: places.collect(),
            }),
            _ => Err((
                None,
                "expected OIWPL sentences with index 0 (the recovery point) and at least one waypoint"
                    .to_owned(),
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gateway::nmea::with_checksum;

    fn mission() -> Vec<String> {
        let places =
            (0..3).map(|i| with_checksum(&format!("OIWPL,2545.491{i},N,08022.4373,W,{i}")));
        std::iter::once(with_checksum("PSEAR,0,000,20,0,000"))
            .chain(places)
            .collect()
    }

    #[test]
    fn missions_load_with_and_without_the_commands_about_them() {
        let commands = [
            with_checksum("PSEAC,F,4,000,000,"),
            with_checksum("PSEAC,F,000,000,000"),
            with_checksum("PSEAC,W,0,0,0,"),
        ];
        let [start, end, go] = &commands;
        let whole = format!("{start}{}{end}{go}", mission().concat());
        let unbroken = whole.replace("\r\n", "");
        for text in [
            mission().concat(),
            whole.clone(),
            whole.replace("\r\n", "\n\n"),
            unbroken,
        ] {
            let mission =
                mission_of(&text).unwrap_or_else(|(line, why)| panic!("{line:?}: {why}\n{text}"));
            assert_eq!((mission.throttle_pct, mission.waypoints.len()), (20.0, 2));
            assert!(
                (mission.erp[0] - 25.758_183).abs() < 1e-6
                    && (mission.erp[1] + 80.373_955).abs() < 1e-6
            );
        }
    }

    #[test]
    fn the_wrong_line_is_named() {
        let lines = mission();
        let with = |at: usize, text: &str| {
            let mut lines = lines.clone();
            lines[at] = text.to_owned();
            lines.concat()
        };
        for (text, place, why) in [
            (
                with(0, "$PSEAR,0,000,10,0,000*7F\r\n"),
                Some(1),
                "the checksum is 7F, expected 78",
            ),
            (with(1, "hello\r\n"), Some(2), "\"hello\" is not a sentence"),
            (
                with(1, "$OIWPL,2545.4910,N,08022.4373,W,0\r\n"),
                Some(2),
                "does not end with *",
            ),
            (
                with(3, &with_checksum("OIWPL,2545.4912,N,08022.4373,W,3")),
                Some(4),
                "waypoint 3, expected 2",
            ),
            (
                with(2, &with_checksum("OIWPL,2545.4912,X,08022.4373,W,1")),
                Some(3),
                "",
            ),
            (
                with(2, &with_checksum("PSEAC,T,0,20,0,")),
                Some(3),
                "unexpected sentence",
            ),
            (
                with(2, &with_checksum("PSEAR,0,000,20,0,000")),
                Some(3),
                "a second PSEAR",
            ),
            (
                with_checksum("PSEAC,F,3,000,000,") + &lines.concat(),
                Some(1),
                "3 lines of PSEAR and OIWPL are announced, but the file has 4",
            ),
            (lines[1..].concat(), None, "no PSEAR"),
            (lines[..2].concat(), None, "at least one waypoint"),
            (String::new(), None, "no PSEAR"),
        ] {
            let (got, said) = mission_of(&text).expect_err(&text);
            assert!(
                got == place && said.contains(why),
                "{got:?}: {said}, expected {place:?}: {why}"
            );
        }
    }
}
