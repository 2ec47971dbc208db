//! The report of a tournament as tables, in text form and as CSV.

use super::rating_table::{cycles, ratings};
use super::report::{Cell, Report, Row};
use crate::estimate::Estimate;
use crate::jobs::strategy_option;
use primitives::printable::add_line;
use scenario::argument_for;

/// A column: its name in the CSV file, its heading in the text, and its value.
type Column = (&'static str, &'static str, fn(&Row) -> Estimate);

const COLUMNS: [Column; 7] = [
    ("score", "score", |row| row.score),
    ("grabs", "grabs", |row| row.grabs),
    ("captures", "captures", |row| row.captures),
    ("tags", "tags", |row| row.tags),
    ("tagged", "tagged", |row| row.tagged),
    ("out_of_bounds", "out of bounds", |row| row.out_of_bounds),
    ("collisions", "collisions", |row| row.collisions),
];

/// The default width of tables without a terminal, characters.
pub const WIDTH: usize = 120;

/// The report in text form, with tables of at most `columns` characters if names allow it; each
/// command stays on one line.
pub fn text(report: &Report, columns: usize) -> String {
    let mut text = String::new();
    let own = report.sea.iter().map(|sea| format!(", sea {sea}"));
    let seas = report.seas.iter().map(|sea| format!(", {}", sea.sea));
    let sea: String = own.chain(seas).collect();
    add_line(
        &mut text,
        format_args!("{}: {}{sea}", report.tournament, report.game),
    );
    match report.matrix.first() {
        None => add_line(
            &mut text,
            format_args!("no result: no seed has all its games"),
        ),
        Some(Cell { games, seeds, .. }) => {
            let count = report.seeds_counted;
            let first = seeds.first;
            let last = seeds.last;
            add_line(
                &mut text,
                format_args!("{games} games per pairing, half of them on each side"),
            );
            let few = report.entries.iter().all(|row| row.rating.low.is_none());
            let [interval, end] = if few {
                ["", ": too few for confidence intervals"]
            } else {
                [" ± 95 %", ""]
            };
            add_line(
                &mut text,
                format_args!(
                    "means per game{interval}, over {count} seeds from {first} to {last}{end}\n"
                ),
            );
            entries(&mut text, report, columns);
            ratings(&mut text, report, columns);
            cycles(&mut text, report);
            match &report.challenger {
                Some(challenger) => pairings(&mut text, report, challenger),
                None => matrix(&mut text, report, columns),
            }
        }
    }
    missing(&mut text, report);
    again(&mut text, report);
    text
}

pub(super) fn names(report: &Report) -> Vec<&str> {
    report.entries.iter().map(|row| row.name.as_str()).collect()
}

fn width(names: &[&str]) -> usize {
    names
        .iter()
        .map(|name| name.len())
        .max()
        .unwrap_or(0)
        .max(6)
        + 1
}

/// A heading with a cell for each entry.
pub(super) type Cells = (String, Vec<String>);

/// A line for each entry.
fn entries(text: &mut String, report: &Report, columns: usize) {
    let count = |words, of: fn(&Row) -> u64| cells(report, words, |row| of(row).to_string());
    let counts = [
        count("won", |row| row.wins),
        count("drawn", |row| row.draws),
        count("lost", |row| row.losses),
    ];
    let means = COLUMNS
        .iter()
        .map(|(_, words, of)| cells(report, words, |row| of(row).shown(1.0, 2)));
    table(
        text,
        &names(report),
        &counts.into_iter().chain(means).collect::<Vec<_>>(),
        columns,
    );
}

pub(super) fn cells(report: &Report, heading: &str, of: impl Fn(&Row) -> String) -> Cells {
    (heading.to_owned(), report.entries.iter().map(of).collect())
}

/// A table with a line for each entry. Columns beyond the width are moved to a second table below.
pub(super) fn table(text: &mut String, names: &[&str], cells: &[Cells], columns: usize) {
    let name = width(names);
    let wide = |(heading, cells): &Cells| {
        cells
            .iter()
            .chain([heading])
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or(0)
            + 2
    };
    let mut rest = cells;
    while !rest.is_empty() {
        let mut sum = name;
        let fits = rest.iter().take_while(|cells| {
            sum += wide(cells);
            sum <= columns
        });
        let (block, others) = rest.split_at(fits.count().max(1));
        let line = |entry: &str, of: &dyn Fn(&Cells) -> String| {
            let cells: String = block
                .iter()
                .map(|cells| format!("{:>1$}", of(cells), wide(cells)))
                .collect();
            format!("{entry:name$}{cells}")
        };
        add_line(
            text,
            format_args!("{}", line("", &|(heading, _)| heading.clone())),
        );
        for (i, entry) in names.iter().enumerate() {
            add_line(
                text,
                format_args!("{}", line(entry, &|(_, cells)| cells[i].clone())),
            );
        }
        rest = others;
        if !rest.is_empty() {
            text.push('\n');
        }
    }
}

/// The wins of each entry against each other entry.
fn matrix(text: &mut String, report: &Report, columns: usize) {
    add_line(
        text,
        format_args!("\nrow against column: won % / drawn %, and the score difference per game"),
    );
    let against = |column: &Row| {
        let cell = |row: &Row| {
            let cell = report
                .matrix
                .iter()
                .find(|cell| cell.row == row.name && cell.column == column.name);
            cell.map_or("-".to_owned(), beaten)
        };
        cells(report, &column.name, cell)
    };
    table(
        text,
        &names(report),
        &report.entries.iter().map(against).collect::<Vec<_>>(),
        columns,
    );
}

/// The results of the challenger against each other entry.
fn pairings(text: &mut String, report: &Report, challenger: &str) {
    let width = width(&names(report));
    add_line(
        text,
        format_args!("\n{challenger} against each entry, with its share of decisive games ± 95 %"),
    );
    add_line(
        text,
        format_args!(
            "{:width$}{:>7}{:>7}{:>7}{:>20}{:>16}",
            "", "won", "drawn", "lost", "of decisive", "points"
        ),
    );
    for cell in report
        .matrix
        .iter()
        .filter(|cell| cell.row == challenger && cell.column != challenger)
    {
        let Cell {
            column,
            wins,
            draws,
            losses,
            won_of_decided,
            score: [own, theirs],
            ..
        } = cell;
        let share = won_of_decided.as_ref().map_or("-".to_owned(), share);
        let points = format!("{own:.2} : {theirs:.2}");
        add_line(
            text,
            format_args!("{column:width$}{wins:>7}{draws:>7}{losses:>7}{share:>20}{points:>16}"),
        );
    }
}

/// A percentage with its interval.
fn share(estimate: &Estimate) -> String {
    let pct = |share: f64| (100.0 * share).clamp(0.0, 100.0);
    let interval = estimate.low.zip(estimate.high);
    let interval = interval.map_or(String::new(), |(low, high)| {
        format!(" ({:.0} to {:.0})", pct(low), pct(high))
    });
    format!("{:.0} %{interval}", pct(estimate.mean))
}

fn beaten(cell: &Cell) -> String {
    let pct = |count: u64| 100.0 * count as f64 / cell.games as f64;
    format!(
        "{:.0} / {:.0}  {:+.2}",
        pct(cell.wins),
        pct(cell.draws),
        cell.score_difference
    )
}

/// The games missing from the tables.
fn missing(text: &mut String, report: &Report) {
    /// The maximum number of failures listed.
    const LISTED: usize = 5;
    let Report {
        games_unplayed,
        games_left_out,
        failures,
        ..
    } = report;
    if *games_unplayed > 0 {
        add_line(
            text,
            format_args!("\nCUT SHORT: {games_unplayed} games were not played"),
        );
    }
    if !failures.is_empty() {
        add_line(
            text,
            format_args!("\n{} games could not start:", failures.len()),
        );
    }
    for failure in failures.iter().take(LISTED) {
        let why = failure.why.replace('\n', "; ");
        add_line(
            text,
            format_args!(
                "  {} against {}, seed {}: {why}",
                failure.blue, failure.red, failure.seed
            ),
        );
    }
    if failures.len() > LISTED {
        add_line(text, format_args!("  and {} more", failures.len() - LISTED));
    }
    if *games_left_out > 0 {
        add_line(
            text,
            format_args!(
                "{games_left_out} games are excluded because others of their seed are missing"
            ),
        );
    }
}

/// The command that replays one of the games.
fn again(text: &mut String, report: &Report) {
    let sea = match (&report.sea, report.seas.is_empty()) {
        (Some(sea), _) => format!(" --sea {}", argument_for(sea.as_ref())),
        (None, true) => String::new(),
        (None, false) => " --sea SEA".to_owned(),
    };
    let sides: String = report
        .teams
        .iter()
        .zip(["A", "B"])
        .map(|(team, file)| strategy_option(team, file))
        .collect();
    add_line(
        text,
        format_args!(
            "\nto replay one of these games, insert strategy files for A and B{}:",
            if report.seas.is_empty() {
                ""
            } else {
                ", and a sea"
            }
        ),
    );
    let game = argument_for(report.game.as_ref());
    add_line(
        text,
        format_args!(
            "  squall run {game}{sea}{sides} --seed {} --in-process",
            report.seed
        ),
    );
    for row in &report.entries {
        add_line(
            text,
            format_args!("  {:<16} {}", row.name, argument_for(row.strategy.as_ref())),
        );
    }
}

/// A comma-separated line for each entry. Names contain no commas, and paths are quoted.
pub fn csv(report: &Report) -> String {
    let mut text = String::new();
    let heads: String = COLUMNS
        .iter()
        .map(|(name, _, _)| format!(",{name},{name}_low,{name}_high"))
        .collect();
    add_line(
        &mut text,
        format_args!("name,strategy,games,wins,draws,losses{heads}"),
    );
    for row in &report.entries {
        let number =
            |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
        let numbers = |of: &fn(&Row) -> Estimate| {
            let Estimate { mean, low, high } = of(row);
            format!(",{mean},{},{}", number(low), number(high))
        };
        let cells: String = COLUMNS.iter().map(|(_, _, of)| numbers(of)).collect();
        let Row {
            name,
            strategy,
            games,
            wins,
            draws,
            losses,
            ..
        } = row;
        let strategy = strategy.replace('"', "\"\"");
        add_line(
            &mut text,
            format_args!("{name},\"{strategy}\",{games},{wins},{draws},{losses}{cells}"),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_table_is_cut_into_blocks_that_fit() {
        let cells: Vec<Cells> = ["won", "score"]
            .map(|head| {
                (
                    head.to_owned(),
                    vec!["1.00 ± 0.25".to_owned(), "2".to_owned()],
                )
            })
            .to_vec();
        let shown = |columns| {
            let mut text = String::new();
            table(&mut text, &["attackers", "b"], &cells, columns);
            text
        };
        let wide = "                    won        score\nattackers   1.00 ± 0.25  1.00 ± 0.25\nb                     2            2\n";
        assert_eq!(shown(36), wide);
        let [first, second] = ["won", "score"].map(|head| {
            format!(
                "{:10}{head:>13}\nattackers   1.00 ± 0.25\nb                     2\n",
                ""
            )
        });
        assert_eq!(shown(35), format!("{first}\n{second}"));
        assert_eq!(
            shown(0),
            shown(35),
            "a column is shown however narrow it is"
        );
    }
}
