//! The result of a game as a table.

use game::count::Counts;
use sim::node::Report;
use std::fmt::Write;

/// The table with what stands below it.
pub(crate) fn text(report: &Report) -> String {
    let outcome = &report.outcome;
    let mut text = String::new();
    let width = outcome.counts.boats.keys().map(String::len).max().unwrap_or(0).max(8) + 2;
    line(&mut text, format_args!(""));
    line(
        &mut text,
        format_args!(
            "{:width$}{:>6}{:>7}{:>10}{:>6}{:>8}{:>15}{:>12}",
            "", "score", "grabs", "captures", "tags", "tagged", "out of bounds", "collisions"
        ),
    );
    for (team, counts) in &outcome.counts.teams {
        row(&mut text, (team, width), outcome.score.teams[team], counts);
        let of_team = outcome.counts.boats.iter().filter(|(boat, _)| outcome.boats.get(*boat) == Some(team));
        for (boat, counts) in of_team {
            row(&mut text, (&format!("  {boat}"), width), outcome.score.boats[boat], counts);
        }
    }
    line(&mut text, format_args!(""));
    let end = match (&outcome.winner, report.run.cut_short) {
        (_, true) => "cut short".to_owned(),
        (Some(team), _) => format!("{team} wins"),
        (None, _) => "a draw".to_owned(),
    };
    let run = &report.run;
    line(
        &mut text,
        format_args!(
            "{end} after {:.0} s ({} ticks, {} {:.1} s, {:.0}x real time)",
            outcome.duration_s,
            outcome.ticks,
            run.pace,
            run.wall_s,
            outcome.duration_s / run.wall_s.max(1e-9)
        ),
    );
    line(&mut text, format_args!("{}  seed {}  digest {}", outcome.scenario, outcome.seed, outcome.digest));
    if run.overruns > 0 {
        line(&mut text, format_args!("{} decision ticks began late: the pace was not kept", run.overruns));
    }
    if run.refused.total() > 0 {
        line(&mut text, format_args!("refused: {}", run.refused));
    }
    text
}

fn row(text: &mut String, (name, width): (&str, usize), score: u32, counts: &Counts) {
    let Counts { grabs, captures, tags, tagged, out_of_bounds, collisions, .. } = counts;
    line(
        text,
        format_args!(
            "{name:width$}{score:>6}{grabs:>7}{captures:>10}{tags:>6}{tagged:>8}{out_of_bounds:>15}{collisions:>12}"
        ),
    );
}

fn line(text: &mut String, args: std::fmt::Arguments<'_>) {
    text.write_fmt(args).expect("writing to a String cannot fail");
    text.push('\n');
}
