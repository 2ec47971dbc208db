//! The ratings and cycles of a tournament in text form.

use super::file::EntryKind;
use super::nash::Nash;
use super::rating::Rating;
use super::report::{Report, Row};
use super::table::{cells, names, table};
use crate::estimate::Estimate;
use primitives::printable::add_line;
use std::collections::BTreeSet;
use std::path::Path;

/// The ratings of the entries, in all seas and in each.
pub(super) fn ratings(text: &mut String, report: &Report, columns: usize) {
    let kinds: BTreeSet<EntryKind> = report.entries.iter().map(|row| row.kind).collect();
    let interval = |Rating { low, high, .. }: Rating| {
        let interval = low.zip(high);
        interval.map_or("too few seeds".to_owned(), |(low, high)| {
            format!("{low:.0} to {high:.0}")
        })
    };
    let mut all = vec![
        cells(report, "Elo", |row| format!("{:.0}", row.rating.elo)),
        cells(report, "", |row| interval(row.rating)),
    ];
    if kinds.len() > 1 {
        all.insert(0, cells(report, "kind", |row| row.kind.name().to_owned()));
    }
    let nash = |of: fn(Nash) -> Estimate, times: f64| {
        move |row: &Row| {
            row.nash
                .map_or("-".to_owned(), |nash| range(of(nash), times))
        }
    };
    let has_nash = report.entries.iter().all(|row| row.nash.is_some());
    if has_nash {
        all.push(cells(report, "Nash %", nash(|nash| nash.share, 100.0)));
        all.push(cells(report, "against it", nash(|nash| nash.lead, 1.0)));
    }
    for sea in &report.seas {
        let rating = |row: &Row| {
            let own = sea.entries.iter().find(|own| own.name == row.name);
            own.map_or("-".to_owned(), |own| shown(own.rating))
        };
        all.push(cells(report, &stem(&sea.sea), rating));
    }
    add_line(
        text,
        format_args!(
            "\nratings with 95 % intervals. Elo: a lead of 100 means an expected score of 64 %"
        ),
    );
    if has_nash {
        add_line(
            text,
            format_args!(
                "Nash: share in the mixture of entries that no entry beats, and Elo points against it"
            ),
        );
    }
    table(text, &names(report), &all, columns);
}

/// A rating with half the width of its interval.
fn shown(Rating { elo, high, .. }: Rating) -> String {
    let half = high.map_or(String::new(), |high| format!(" ± {:.0}", high - elo));
    format!("{elo:.0}{half}")
}

/// An estimate multiplied by `times`, with its interval, as whole numbers.
fn range(Estimate { mean, low, high }: Estimate, times: f64) -> String {
    // Rounding a small negative number would give -0.
    let whole = |number: f64| format!("{:.0}", (times * number).round() + 0.0);
    let interval = low.zip(high).map_or(String::new(), |(low, high)| {
        format!(" ({} to {})", whole(low), whole(high))
    });
    format!("{}{interval}", whole(mean))
}

/// The cycles of entries.
pub(super) fn cycles(text: &mut String, report: &Report) {
    /// The maximum number of cycles listed.
    const LISTED: usize = 5;
    if report.cycles.is_empty() {
        return;
    }
    add_line(
        text,
        format_args!("\ncycles: each entry beats the next, with a 95 % interval above 50 %"),
    );
    for cycle in report.cycles.iter().take(LISTED) {
        add_line(text, format_args!("{} > {}", cycle.join(" > "), cycle[0]));
    }
    if report.cycles.len() > LISTED {
        add_line(
            text,
            format_args!("and {} more", report.cycles.len() - LISTED),
        );
    }
}

/// A scenario file by its name.
fn stem(path: &str) -> String {
    let stem = Path::new(path).file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}
