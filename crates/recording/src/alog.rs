//! Reads `.alog` files of MOOS, from one or more communities of a game, as a recording of that
//! game.
//!
//! The communities' clocks are aligned by `LOGSTART`. The game begins when `AQUATICUS_GAME` or
//! `AQUATICUS_GAME_ALL` becomes `play`, or with the first position. A boat's motion is taken from
//! `NAV_GT_…`, else from `NAV_…` in its own log, else from node reports. Tags for which no tag
//! manager logged a result count as boundary tags.

use crate::logs::{Logs, Quantity, name_of};
use crate::{Bag, RecordingError};
use primitives::input_file;
use scenario::Scenario;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The first bytes of every log.
const MAGIC: &[u8] = b"%%%%%%%%";
/// Variables of the log's own boat, with their source.
const OWN: [(&str, Quantity, u8); 10] = [
    ("NAV_GT_X", Quantity::X, 0),
    ("NAV_GT_Y", Quantity::Y, 0),
    ("NAV_GT_HEADING", Quantity::Heading, 0),
    ("NAV_GT_SPEED", Quantity::Speed, 0),
    ("NAV_X", Quantity::X, 1),
    ("NAV_Y", Quantity::Y, 1),
    ("NAV_HEADING", Quantity::Heading, 1),
    ("NAV_SPEED", Quantity::Speed, 1),
    ("TAGGED", Quantity::Tagged, 0),
    ("HAS_FLAG", Quantity::HasFlag, 0),
];
/// Fields of node reports.
const REPORTED: [(&str, Quantity); 4] = [
    ("X", Quantity::X),
    ("Y", Quantity::Y),
    ("HDG", Quantity::Heading),
    ("SPD", Quantity::Speed),
];

/// Whether a file is a log, judged by its content.
pub fn is_log(path: &Path) -> bool {
    // Opening a named pipe would block until it has a writer.
    if !path.is_file() {
        return false;
    }
    let mut start = [0; MAGIC.len()];
    std::fs::File::open(path)
        .and_then(|mut file| file.read_exact(&mut start))
        .is_ok_and(|()| start == MAGIC)
}

/// The game in these logs. If `is_known`, `game` is the scenario of the logged game; otherwise its
/// boats and field are replaced with the logged boats and a field around their tracks.
///
/// # Errors
/// [`RecordingError::Log`] with file and line.
pub fn read(files: &[PathBuf], game: Scenario, is_known: bool) -> Result<Bag, RecordingError> {
    let mut logs = Logs::default();
    files.iter().try_for_each(|file| add(&mut logs, file))?;
    logs.sort();
    let all = files.iter().map(|file| file.display().to_string());
    let all = all.collect::<Vec<_>>().join(", ");
    let bytes = logs
        .recording(game, is_known)
        .map_err(|reason| RecordingError::Log(format!("{all}: {reason}")))?;
    Bag::of(bytes)
}

/// Adds a log.
///
/// # Errors
/// [`RecordingError`] with file and line.
pub fn add(logs: &mut Logs, path: &Path) -> Result<(), RecordingError> {
    let bytes = input_file::read(path, input_file::TABLE_BYTES_MAX).map_err(|reason| {
        let path = path.to_owned();
        RecordingError::File { path, reason }
    })?;
    let mut name = name_of(&path.file_stem().unwrap_or_default().to_string_lossy());
    let (mut own, mut start_s) = (vec![], None);
    for (i, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        let wrong = |reason| RecordingError::Log(format!("{}:{}: {reason}", path.display(), i + 1));
        if let Some((_, start)) = line.split_once("% LOGSTART") {
            start_s = Some(number(start).map_err(wrong)?);
        }
        let (time, rest) = next_word(&line);
        let (key, rest) = next_word(rest);
        // The source comes before the value.
        let (_, value) = next_word(rest);
        let value = value.trim();
        // Values can span several lines, and the last line can be incomplete.
        let (Ok(time_s), false) = (time.parse::<f64>(), value.is_empty()) else {
            continue;
        };
        let start_s = start_s.ok_or_else(|| wrong("no LOGSTART line above this one".to_owned()))?;
        let row = (start_s + time_s, key, value);
        if let Some((_, quantity, source)) = OWN.iter().find(|(own, ..)| *own == key) {
            let value = number(value).map_err(wrong)?;
            own.push((*quantity, *source, (row.0, value)));
        } else if let Some(boat) = add_row(logs, row).map_err(wrong)? {
            name = boat;
        }
    }
    for (quantity, source, point) in own {
        logs.push(&name, quantity, source, point);
    }
    Ok(())
}

/// Adds a row. Returns the name of the log's own boat, if the row contains it.
fn add_row(
    logs: &mut Logs,
    (at_s, key, value): (f64, &str, &str),
) -> Result<Option<String>, String> {
    let field = |name: &str| {
        let mut parts = value.split(',');
        parts.find_map(|part| part.trim().strip_prefix(name)?.strip_prefix('='))
    };
    if key.starts_with("NODE_REPORT") {
        let name = name_of(field("NAME").ok_or("NAME is missing")?);
        if let Some(team) = field("GROUP") {
            logs.set_team(&name, &name_of(team));
        }
        let sent = field("TIME").and_then(|time| time.parse().ok());
        let sent_s = sent.filter(|sent_s| f64::abs(sent_s - at_s) < 10.0);
        for (field_name, quantity) in REPORTED {
            if let Some(text) = field(field_name) {
                let point = (sent_s.unwrap_or(at_s), number(text)?);
                logs.push(&name, quantity, 2, point);
            }
        }
        return Ok((key == "NODE_REPORT_LOCAL").then_some(name));
    }
    if let Some((tagged, by)) = field("tagged").zip(field("source")) {
        logs.push_tag(at_s, &name_of(tagged), &name_of(by));
    }
    let (whose, quantity) = match key {
        "AQUATICUS_GAME" | "AQUATICUS_GAME_ALL" => ("", Quantity::Play),
        "TAGGED_VEHICLES" => return Ok(None),
        _ if key.ends_with("SCORES") => (&key[..key.len() - 7], Quantity::Scores),
        _ if key.starts_with("TAGGED_") => (&key[7..], Quantity::Tagged),
        _ if key.starts_with("HAS_FLAG_") => (&key[9..], Quantity::HasFlag),
        _ => return Ok(None),
    };
    // Other values of these variables, such as `pause`, are ignored.
    if let Ok(value) = number(value) {
        logs.push(&name_of(whose), quantity, 0, (at_s, value));
    }
    Ok(None)
}

fn next_word(text: &str) -> (&str, &str) {
    let text = text.trim();
    text.split_once(char::is_whitespace).unwrap_or((text, ""))
}

fn number(text: &str) -> Result<f64, String> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" | "play" => Ok(1.0),
        "false" | "stop" => Ok(0.0),
        text => {
            let number = text.parse().ok().filter(|number| f64::is_finite(*number));
            number.ok_or_else(|| format!("{text:?} is not a number"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recording;
    use messages::Frame;

    const BLUE: &str = "%% LOGSTART 1000.0\n1.0 NODE_REPORT_LOCAL p NAME=Blue_1,GROUP=blue\n\
        1.0 NAV_X p 10\n1.0 NAV_Y p -20\n3.0 NAV_X p 14\n3.0 NAV_Y p -20\n2.0 NAV_HEADING p 90\n\
        2.0 TAGGED p false\n3.0 HAS_FLAG p true\n3.1 APPCAST p two\nlines\n3.2 NAV_X";
    const SHORE: &str = "%% LOGSTART 1001.0\n0.5 NODE_REPORT p NAME=red_1,X=50,Y=5,SPD=1,HDG=0\n\
        1.0 TAG_RESULT_RED_1 p event=1,source=red_1,tagged=blue_1\n1.0 TAGGED_BLUE_1 p true\n\
        1.5 RED_SCORES p 2\n2.0 AQUATICUS_GAME_ALL p stop\n";

    fn read_text(texts: &[&str]) -> Result<Recording, RecordingError> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |(i, text)| {
            let path = folder.path().join(format!("{i}.txt"));
            std::fs::write(&path, format!("%%%%%%%%%%\n{text}")).expect("it is written");
            assert!(is_log(&path));
            path
        };
        let files: Vec<PathBuf> = texts.iter().enumerate().map(file).collect();
        let game = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../scenarios/games/pav01_vs_pav01.toml"
        );
        let game = scenario::load(Path::new(game)).unwrap_or_else(|e| panic!("{e}"));
        read(&files, game, false).and_then(Recording::of_bag)
    }

    #[test]
    fn logs_of_several_clocks_become_one_recording() {
        let recording = read_text(&[BLUE, SHORE]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(recording.header().began_utc_ns, 1_001_000_000_000);
        let frames: Vec<Frame> = recording
            .frames()
            .map(|frame| frame.expect("sound"))
            .collect();
        let (middle, last) = (&frames[10], frames.last().expect("frames"));
        let blue = middle.vehicles[0];
        assert_eq!(
            (blue.nav.east_m, blue.nav.north_m, blue.tagged),
            (12.0, -20.0, true)
        );
        assert_eq!(
            (last.vehicles[0].carrying, last.score.clone(), last.over),
            (1, vec![0, 2], true)
        );
        assert_eq!(last.vehicles[1].nav.east_m, 50.0);
        let ending = recording.ending().expect("an ending");
        let told = ending.outcome.events.iter().map(|event| event.sentence());
        assert_eq!(
            told.collect::<Vec<_>>(),
            [
                "blue_1 is tagged by red_1",
                "blue_1 grabs the red flag",
                "red wins"
            ]
        );
    }

    #[test]
    fn errors_name_file_and_line() {
        for (text, want) in [
            (
                "1.0 NAV_X p 1\n",
                "0.txt:2: no LOGSTART line above this one",
            ),
            (
                "%% LOGSTART 1\n1 NAV_X p east\n",
                "0.txt:3: \"east\" is not a number",
            ),
            (
                "%% LOGSTART 1\n1 NODE_REPORT p X=1\n",
                "0.txt:3: NAME is missing",
            ),
            ("%% LOGSTART 1\n", "0.txt: no boat has a position"),
        ] {
            let error = read_text(&[text]).expect_err("it is wrong").to_string();
            assert!(error.ends_with(want), "{error}");
        }
        let far = SHORE.replace("1001.0", "900000.0");
        let error = read_text(&[BLUE, &far]).expect_err("two games").to_string();
        assert!(error.ends_with("are they all from one game?"), "{error}");
    }

    #[test]
    fn a_log_that_is_too_long_is_not_read() {
        let long = tempfile::NamedTempFile::new().expect("a file");
        let sized = long.as_file().set_len(input_file::TABLE_BYTES_MAX + 1);
        sized.expect("it takes no space");
        let error = add(&mut Logs::default(), long.path()).expect_err("refused");
        assert!(error.to_string().contains("it is longer than"), "{error}");
    }
}
