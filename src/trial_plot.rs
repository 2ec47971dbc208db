//! A trial on one page: track, speeds, heading and yaw rate, and what drove the boat.

use crate::plot::{self, Line, Page, Panel};
use anyhow::Result;
use arena::trial::{Command, Sample};
use game::angle::wrap_pi;
use std::path::Path;

/// Draws a trial into a file.
pub(crate) fn write(path: &Path, title: &str, samples: &[Sample]) -> Result<()> {
    let track = samples.iter().map(|sample| (sample.at.east, sample.at.north)).collect();
    let panels = vec![
        Panel {
            title: "Track".into(),
            x: "x (east) in m".into(),
            y: "y (north) in m".into(),
            equal: true,
            lines: vec![line("", track)],
            absent: "",
            marks: vec![],
        },
        over_time(
            "Velocity over the ground",
            "m/s",
            vec![
                series("speed", samples, Sample::speed_m_s),
                series("surge", samples, |sample| sample.nu.surge),
                series("sway", samples, |sample| sample.nu.sway),
            ],
        ),
        over_time("Heading, turns counted on", "degrees", vec![headings(samples)]),
        over_time("Yaw rate", "degrees per s", vec![series("", samples, |sample| sample.nu.yaw.to_degrees())]),
    ];
    let drive = drive(samples);
    let panels = panels.into_iter().chain(drive).collect();
    plot::write_svg(path, &Page { title: title.to_owned(), columns: 2, panels })
}

/// Thrusts where there are thrusters; commands in per cent.
fn drive(samples: &[Sample]) -> Vec<Panel> {
    let told = |which: usize| {
        move |sample: &Sample| match sample.command {
            Command::Thrust { port, starboard } => 100.0 * [port, starboard][which],
            Command::Impose { thrust, rudder } => [thrust, rudder][which],
            Command::Hold => 0.0,
            Command::Steer { .. } => f64::NAN,
        }
    };
    let imposed = samples.iter().any(|sample| matches!(sample.command, Command::Impose { .. }));
    let names = if imposed { ["thrust", "rudder"] } else { ["port", "starboard"] };
    let mut panels = vec![];
    if samples.iter().all(|sample| !matches!(sample.command, Command::Steer { .. })) {
        let lines = vec![series(names[0], samples, told(0)), series(names[1], samples, told(1))];
        panels.push(over_time("Commands", "% of full", lines));
    }
    if samples.iter().any(|sample| sample.thrusts_newton[0].is_finite()) {
        let lines = vec![
            series("port", samples, |sample| sample.thrusts_newton[0]),
            series("starboard", samples, |sample| sample.thrusts_newton[1]),
        ];
        panels.push(over_time("Thrust", "N", lines));
    }
    panels
}

fn over_time(title: &str, unit: &str, lines: Vec<Line>) -> Panel {
    Panel {
        title: title.to_owned(),
        x: "time in s".into(),
        y: unit.to_owned(),
        equal: false,
        lines,
        absent: "",
        marks: vec![],
    }
}

fn series(name: &str, samples: &[Sample], of: impl Fn(&Sample) -> f64) -> Line {
    line(name, samples.iter().map(|sample| (sample.t_s, of(sample))).collect())
}

fn headings(samples: &[Sample]) -> Line {
    let mut psi_rad = samples.first().map_or(0.0, |sample| sample.psi_rad);
    let mut on = |sample: &Sample| {
        psi_rad += wrap_pi(sample.psi_rad - psi_rad);
        (sample.t_s, psi_rad.to_degrees())
    };
    line("", samples.iter().map(&mut on).collect())
}

fn line(name: &str, points: Vec<(f64, f64)>) -> Line {
    Line { name: name.to_owned(), points, filled: false }
}
