//! The report for the terminal.

use super::effects::{Effect, Interaction};
use super::metric::Metric;
use super::report::{PointReport, Report};
use crate::estimate::{Estimate, OBSERVATIONS_MIN};

/// The columns shown for each level: the metric, its heading, its factor, and its decimal places.
const COLUMNS: [(&str, &str, f64, usize); 5] = [
    ("win_share", "won %", 100.0, 0),
    ("score", "points", 1.0, 1),
    ("opponent_score", "against", 1.0, 1),
    ("out_of_bounds", "leaves field", 1.0, 1),
    ("contacts", "contacts", 1.0, 1),
];
/// The maximum numbers of interactions and of worst games shown.
const SHOWN: usize = 6;

/// The report in text form, at most 80 columns wide except for commands.
pub fn text(report: &Report) -> String {
    let mut text = String::new();
    let mut line = |line: String| {
        text.push_str(line.trim_end());
        text.push('\n');
    };
    line(format!("{}: {}", report.sweep, report.about));
    line(format!("{} against {}", report.game, report.opponent));
    let done = report.games_done;
    let points = report.points.len();
    let few = report.games_per_point < 2 * OBSERVATIONS_MIN as u64;
    let interval = if few {
        "; too few seeds for ± 95 %"
    } else {
        " ± 95 % over seeds"
    };
    line(format!(
        "{done} of {} games at {points} points; means per game{interval}",
        report.games
    ));
    for effect in &report.effects {
        line(String::new());
        table(effect, &mut line);
    }
    differences(report, &mut line);
    interactions(&report.interactions, &mut line);
    if !report.worst.is_empty() {
        line("\nworst games".to_owned());
        for worst in report.worst.iter().take(SHOWN) {
            let [own, theirs] = worst.score;
            line(format!(
                "  {} {own} : {theirs}  at {}",
                worst.entry,
                worst.values.join(", ")
            ));
            line(format!("    {}", worst.command));
        }
    }
    for failure in report.failures.iter().take(SHOWN) {
        line(format!(
            "\ngame {} could not start: {}\n    {}",
            failure.game, failure.why, failure.command
        ));
    }
    if report.failures.len() > SHOWN {
        line(format!(
            "\nand {} more could not start",
            report.failures.len() - SHOWN
        ));
    }
    text
}

fn table(effect: &Effect, line: &mut impl FnMut(String)) {
    line(format!("{} with {}", effect.entry, effect.axis));
    let heads: String = COLUMNS
        .iter()
        .map(|(_, head, ..)| format!("{head:>13}"))
        .collect();
    line(format!("{:<14}{heads}", ""));
    for level in &effect.levels {
        let cell = |(metric, _, times, digits): &(&str, &str, f64, usize)| {
            let estimate = Metric::place(metric).and_then(|i| level.metrics[i]);
            format!(
                "{:>13}",
                estimate.map_or("-".to_owned(), |estimate| estimate.shown(*times, *digits))
            )
        };
        let label: String = level.label.chars().take(13).collect();
        line(format!(
            "{label:<14}{}",
            COLUMNS.iter().map(cell).collect::<String>()
        ));
    }
}

/// Differences from the first entry in the fraction of games won, at points where they are
/// significant.
fn differences(report: &Report, line: &mut impl FnMut(String)) {
    let Some(index) = Metric::place("win_share") else {
        return;
    };
    for (k, entry) in report.entries.iter().enumerate().skip(1) {
        let of_point = |point: &PointReport| point.differences[k - 1].metrics[index];
        let all: Vec<Estimate> = report.points.iter().filter_map(of_point).collect();
        let sure = |is: fn(&Estimate) -> bool| all.iter().filter(|one| is(one)).count();
        let better = sure(|one| one.low.is_some_and(|low| low > 0.0));
        let worse = sure(|one| one.high.is_some_and(|high| high < 0.0));
        let mean = all.iter().map(|one| one.mean).sum::<f64>() / all.len().max(1) as f64;
        let first = &report.entries[0];
        let pct = 100.0 * mean;
        let count = all.len();
        line(format!(
            "\n{entry} minus {first}, on the same seeds: {pct:+.0} % of games won on average;"
        ));
        line(format!(
            "significantly more at {better} and fewer at {worse} of {count} points"
        ));
    }
}

fn interactions(all: &[Interaction], line: &mut impl FnMut(String)) {
    if all.is_empty() {
        return;
    }
    let matter = all.iter().filter(|one| one.matters);
    line(format!(
        "\nsignificant interactions: {} of {}",
        matter.clone().count(),
        all.len()
    ));
    for one in matter.take(SHOWN) {
        let [low, second, first, both] = one.cells;
        line(format!(
            "  {} of {}: {} with {}",
            one.metric, one.entry, one.axes[0], one.axes[1]
        ));
        line(format!(
            "    both low {low:.2}, second high {second:.2}, first high {first:.2}, both high {both:.2}"
        ));
    }
}
