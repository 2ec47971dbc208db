//! The turning points of a recorded game, and each boat's contribution.

use super::Args;
use crate::progress::Progress;
use crate::{output_file, recording_file, scenario_files, screen, stop, whatif_command};
use anyhow::{Context, Result};
use experiment::Estimate;
use experiment::turning::{self, BoatDecision, Plan, Report};
use primitives::printable::add_line;
use scenario::{Kind, load_file};
use std::path::Path;
use std::process::ExitCode;

/// Ratio of the number of futures for the curve to the number of games for comparing each boat.
const FUTURES_PER_GAME: usize = 20;
/// Maximum number of values that the curve shows.
const CURVE_COLUMNS: usize = 60;

pub(super) fn print(args: &Args, file: &Path) -> Result<ExitCode> {
    let recording = recording_file::open(file, "continue")?;
    let past = whatif_command::past(&recording)
        .with_context(|| format!("cannot continue {}", file.display()))?;
    let out = args
        .json
        .clone()
        .unwrap_or_else(|| recording::turning_points_of(file));
    output_file::check(&out, "the turning points")?;
    let futures = args.futures as usize;
    let plan = Plan {
        futures,
        futures_of_boat: futures / FUTURES_PER_GAME,
        baseline: load_file(&scenario_files::find(&args.baseline, Kind::STRATEGY)?)?,
    };
    let stop = stop::on_ctrl_c()?;
    let games = turning::games(&past.scenario, &plan);
    let mut progress = Progress::of(games as u64, "futures");
    let run = (args.jobs.threads(games), &*stop);
    let report = turning::turning_points(&past, &plan, run, || progress.add());
    progress.end();
    let Some(report) = report.map_err(anyhow::Error::msg)? else {
        return Ok(stop::interrupted());
    };
    screen::print(&text(&report, &args.baseline, &plan));
    output_file::write_json(&out, "the turning points", &report)?;
    if args.json.is_none() {
        screen::remark(&format!(
            "wrote {}; squall replay {} shows the curve",
            out.display(),
            file.display()
        ));
    }
    Ok(ExitCode::SUCCESS)
}

fn text(report: &Report, baseline: &str, plan: &Plan) -> String {
    let [team, _] = &report.teams;
    let mut text = format!(
        "{team}'s chance of winning, from {} futures; a draw counts half\n\n{}",
        plan.futures,
        curve(report)
    );
    text += "\nWhat turned the game, with the 95 % interval of each change\n";
    if report.turning_points.is_empty() {
        text += "  no clear change; use more --futures to detect smaller ones\n";
    }
    for turn in &report.turning_points {
        let [before, after] = turn.chance.map(|chance| 100.0 * chance);
        add_line(
            &mut text,
            format_args!(
                "{:>7.1} s  {before:.0} % -> {after:.0} %  ({})",
                turn.from_s,
                range(&turn.change, 100.0, 0, " %")
            ),
        );
        for event in &turn.events {
            add_line(
                &mut text,
                format_args!("{:>13.1} s  {}", event.at_s, event.sentence()),
            );
        }
        for boat in &turn.decisions {
            add_line(&mut text, format_args!("{:>15}  {}", "", decision(boat)));
        }
    }
    add_line(
        &mut text,
        format_args!(
            "\nWhat each boat contributed, compared with {baseline} in its place, over {} games\n\
             {:<20}{:>26}{:>26}",
            plan.futures_of_boat, "", "chance of winning", "points ahead"
        ),
    );
    for boat in &report.boats {
        let cell = |estimate: &Estimate, times: f64, digits: usize, unit: &str| {
            let mean = estimate.mean * times + 0.0;
            let range = range(estimate, times, digits, unit);
            format!("{mean:+.digits$}{unit} ({range})")
        };
        add_line(
            &mut text,
            format_args!(
                "{:<20}{:>26}{:>26}",
                boat.vehicle,
                cell(&boat.chance, 100.0, 0, " %"),
                cell(&boat.margin, 1.0, 1, "")
            ),
        );
    }
    text
}

/// A bar for each moment, or for as many as fit.
fn curve(report: &Report) -> String {
    const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let curve = &report.curve;
    let columns = curve.len().min(CURVE_COLUMNS);
    let bar = |column: usize| {
        let point = &curve[column * (curve.len() - 1) / (columns - 1).max(1)];
        BARS[((point.chance.mean * 8.0) as usize).min(7)]
    };
    let bars: String = (0..columns).map(bar).collect();
    let [Some(first), Some(last)] = [curve.first(), curve.last()] else {
        return String::new();
    };
    let percent = |chance: f64| format!("{:.0} %", 100.0 * chance);
    format!(
        "{:>5} {bars} {}\n{:<6}{:<width$}{:.0} s\n",
        percent(first.chance.mean),
        percent(last.chance.mean),
        "",
        "0 s",
        last.at_s,
        width = columns.saturating_sub(5).max(4),
    )
}

fn decision(boat: &BoatDecision) -> String {
    let BoatDecision {
        vehicle,
        mode,
        course_deg,
        speed_m_s,
    } = boat;
    match (course_deg, speed_m_s) {
        (Some(course), Some(speed)) => {
            format!("{vehicle}: {mode}, {course:03.0}° at {speed:.1} m/s")
        }
        _ => format!("{vehicle}: {mode}, holding"),
    }
}

/// An interval, such as `12 to 51 %`.
fn range(estimate: &Estimate, times: f64, digits: usize, unit: &str) -> String {
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => {
            let [low, high] = [low, high].map(|bound| bound * times + 0.0);
            format!("{low:+.digits$} to {high:+.digits$}{unit}")
        }
        _ => "no interval".to_owned(),
    }
}
