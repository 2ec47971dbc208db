//! Encodes what the boat is sent: commands as sentences.

use crate::nmea::{Command, M_S_PER_KN, Mode, Sentence};
use crate::set_point::SetPoint;
use crate::supervisor::Task;

/// `PSEAC` with these numbers in its second to fourth field.
fn command(mode: Mode, numbers: [Option<f64>; 3]) -> Command {
    let [heading_deg, thrust, difference] = numbers;
    Command { mode, heading_deg, thrust, difference, ..Command::default() }
}

/// Standby.
pub(super) fn standby() -> Command {
    command(Mode::Standby, [Some(0.0); 3])
}

/// Standby with a switch: its word, or nothing.
pub(super) fn standby_with(word: &str) -> Command {
    Command { words: word.to_owned(), ..standby() }
}

/// A set-point.
pub(super) fn of_set_point(set_point: SetPoint) -> Command {
    match set_point {
        SetPoint::Thrust { thrust_pct, difference_pct } => {
            command(Mode::Thruster, [Some(0.0), Some(thrust_pct), Some(difference_pct)])
        }
        SetPoint::Speed { heading_deg, speed_m_s } => {
            command(Mode::Speed, [Some(heading_deg), Some(speed_m_s / M_S_PER_KN), None])
        }
    }
}

/// The command that begins a task.
pub(super) fn of_task(task: Task) -> Command {
    match task {
        Task::StationKeep => command(Mode::StationKeep, [None; 3]),
        Task::GoToErp => command(Mode::GoToErp, [Some(0.0); 3]),
        Task::Mission => command(Mode::Waypoint, [Some(0.0); 3]),
    }
}

/// The start of a download of so many lines.
pub(super) fn start_of_download(lines: usize) -> Command {
    command(Mode::FileDownload, [Some(lines as f64), Some(0.0), Some(0.0)])
}

/// What ends a download, finished or not.
pub(super) fn end_of_download() -> Command {
    command(Mode::FileDownload, [Some(0.0); 3])
}

/// The bytes of commands, one after the other.
pub(super) fn bytes_of(commands: &[Command]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(32 * commands.len());
    for command in commands {
        Sentence::Command(command.clone()).write(&mut bytes);
    }
    bytes
}
