//! The result of a game as a table.

use command_line::number::significant;
use rules::count::Counts;
use sim::Report;

/// The table, with the remarks below it.
pub(crate) fn text(report: &Report) -> String {
    let outcome = &report.outcome;
    let width = outcome
        .counts
        .boats
        .keys()
        .map(String::len)
        .max()
        .unwrap_or(0)
        .max(8)
        + 2;
    let mut text = format!(
        "\n{:width$} score  grabs  captures  tags  tagged  out of bounds  collisions\n",
        ""
    );
    for (team, counts) in &outcome.counts.teams {
        text += &row((team, width), outcome.score.teams[team], counts);
        let of_team = outcome
            .counts
            .boats
            .iter()
            .filter(|(boat, _)| outcome.boats.get(*boat) == Some(team));
        for (boat, counts) in of_team {
            text += &row(
                (&format!("  {boat}"), width),
                outcome.score.boats[boat],
                counts,
            );
        }
    }
    let end = match (&outcome.winner, report.run.cut_short) {
        (_, true) => "cut short".to_owned(),
        (Some(team), _) => format!("{team} wins"),
        (None, _) => "a draw".to_owned(),
    };
    let run = &report.run;
    text += &format!(
        "\n{end} after {:.0} s ({} ticks, {} {} s, {}x real time)\n",
        outcome.duration_s,
        outcome.ticks,
        run.pace.replace("in process", "computed in"),
        significant(run.wall_s),
        significant(outcome.duration_s / run.wall_s.max(1e-9))
    );
    text += &format!(
        "{}  seed {}  digest {}\n",
        outcome.scenario, outcome.seed, outcome.digest
    );
    if !outcome.random {
        text += "nothing in this game is random: it is the same for every seed\n";
    }
    if outcome.ends_differ {
        text += "wind, waves or current favour one end of the field\n";
    }
    if run.overruns > 0 {
        text += &format!(
            "{} decision ticks began late: the pace was not kept\n",
            run.overruns
        );
    }
    if run.refused.total() > 0 {
        text += &format!("refused: {}\n", run.refused);
    }
    text
}

fn row((name, width): (&str, usize), score: u32, counts: &Counts) -> String {
    let Counts {
        grabs,
        captures,
        tags,
        tagged,
        out_of_bounds,
        collisions,
        ..
    } = counts;
    format!(
        "{name:width$}{score:>6}{grabs:>7}{captures:>10}{tags:>6}{tagged:>8}{out_of_bounds:>15}{collisions:>12}\n"
    )
}
