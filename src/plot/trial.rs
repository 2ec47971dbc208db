//! A trial on one page: track, speeds, heading, yaw rate, and thrusts or commands.

use crate::plot::{self, Line, Page, Panel};
use anyhow::Result;
use std::path::Path;
use trial::{Command, Sample};

/// Draws a trial to a file.
pub(crate) fn write(path: &Path, title: &str, samples: &[Sample]) -> Result<()> {
    let track = samples
        .iter()
        .map(|sample| (sample.at.east, sample.at.north))
        .collect();
    let panels = vec![
        Panel {
            equal: true,
            ..Panel::of(
                "Track",
                ["x (east) in m", "y (north) in m"],
                vec![Line::of("", track)],
                "",
            )
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
        over_time("Heading, unwrapped", "degrees", vec![headings(samples)]),
        over_time(
            "Yaw rate",
            "degrees per s",
            vec![series("", samples, |sample| sample.nu.yaw.to_degrees())],
        ),
    ];
    let drive = drive(samples);
    let panels = panels.into_iter().chain(drive).collect();
    Page {
        title: title.to_owned(),
        columns: 2,
        panel: plot::PANEL,
        panels,
    }
    .write(path)
}

/// Panels of thrusts if the boat has thrusters; otherwise of commands in per cent.
fn drive(samples: &[Sample]) -> Vec<Panel> {
    let told = |which: usize| {
        move |sample: &Sample| match sample.command {
            Command::Thrust { port, starboard } => 100.0 * [port, starboard][which],
            Command::Impose { thrust, rudder } => [thrust, rudder][which],
            Command::Hold => 0.0,
            Command::Steer { .. } => f64::NAN,
        }
    };
    let imposed = samples
        .iter()
        .any(|sample| matches!(sample.command, Command::Impose { .. }));
    let names = if imposed {
        ["thrust", "rudder"]
    } else {
        ["port", "starboard"]
    };
    let mut panels = vec![];
    if samples
        .iter()
        .all(|sample| !matches!(sample.command, Command::Steer { .. }))
    {
        let lines = vec![
            series(names[0], samples, told(0)),
            series(names[1], samples, told(1)),
        ];
        panels.push(over_time("Commands", "% of full", lines));
    }
    if samples
        .iter()
        .any(|sample| sample.thrusts_newton[0].is_finite())
    {
        let lines = vec![
            series("port", samples, |sample| sample.thrusts_newton[0]),
            series("starboard", samples, |sample| sample.thrusts_newton[1]),
        ];
        panels.push(over_time("Thrust", "N", lines));
    }
    panels
}

fn over_time(title: &'static str, unit: &'static str, lines: Vec<Line>) -> Panel {
    Panel::of(title, ["time in s", unit], lines, "")
}

fn series(name: &str, samples: &[Sample], of: impl Fn(&Sample) -> f64) -> Line {
    Line::of(
        name,
        samples
            .iter()
            .map(|sample| (sample.t_s, of(sample)))
            .collect(),
    )
}

fn headings(samples: &[Sample]) -> Line {
    let start_rad = samples.first().map_or(0.0, |sample| sample.psi_rad);
    let on =
        |(sample, turned_rad): (&Sample, f64)| (sample.t_s, (start_rad + turned_rad).to_degrees());
    Line::of(
        "",
        samples
            .iter()
            .zip(trial::turned_rad(samples))
            .map(on)
            .collect(),
    )
}
