//! The comparison of two recorded games in text form.

use analysis::{Comparison, Pair, Response, SETTLED_S};
use primitives::printable::add_line;
use std::path::Path;

/// The whole comparison.
pub(super) fn text([a, b]: [&Path; 2], comparison: &Comparison) -> String {
    let mut text = String::new();
    for (name, file, duration_s) in [
        ("A", a, comparison.durations_s[0]),
        ("B", b, comparison.durations_s[1]),
    ] {
        add_line(
            &mut text,
            format_args!("{name}  {}  {duration_s:.1} s", file.display()),
        );
    }
    for note in &comparison.notes {
        add_line(&mut text, format_args!("   {note}"));
    }
    let width = comparison
        .boats
        .iter()
        .map(|pair| pair.boat.len())
        .max()
        .unwrap_or(0)
        .max(8)
        + 2;
    tracks(&mut text, width, comparison);
    responses(&mut text, width, &comparison.boats);
    events(&mut text, comparison);
    text
}

fn tracks(text: &mut String, width: usize, comparison: &Comparison) {
    add_line(
        text,
        format_args!(
            "\ndistance between the tracks over {:.1} s, m",
            comparison.common_s
        ),
    );
    let heads = ["mean", "rms", "max", "at the end", "Fréchet"]
        .map(|head| format!("{head:>12}"))
        .concat();
    add_line(text, format_args!("{:width$}{heads}", ""));
    for Pair { boat, apart, .. } in &comparison.boats {
        let cells = [
            apart.mean_m,
            apart.rms_m,
            apart.max_m,
            apart.final_m,
            apart.frechet_m,
        ];
        let cells = cells.map(|metres| format!("{metres:>12.2}")).concat();
        add_line(text, format_args!("{boat:width$}{cells}"));
    }
    *text += "Fréchet: discrete Fréchet distance (Eiter and Mannila 1994), which ignores delays\n";
}

/// A measure of a response: its name, unit, decimal places, and accessor.
type Measure = (
    &'static str,
    &'static str,
    usize,
    fn(&Response) -> Option<f64>,
);

const MEASURES: [Measure; 6] = [
    ("heading lag", "s", 1, |response| response.heading_lag_s),
    ("residual", "deg", 1, |response| response.heading_rms_deg),
    ("speed lag", "s", 1, |response| response.speed_lag_s),
    ("gain", "", 2, |response| response.speed_gain),
    ("residual", "m/s", 2, |response| response.speed_rms_m_s),
    ("drift stbd", "m/s", 3, |response| response.cross_track_m_s),
];

fn responses(text: &mut String, width: usize, boats: &[Pair]) {
    add_line(
        text,
        format_args!("\nresponse of the boats to their orders"),
    );
    let heads = MEASURES.map(|(name, ..)| format!("{name:>13}")).concat();
    add_line(
        text,
        format_args!("{:width$}  {heads}{:>22}", "", "drift while holding"),
    );
    let units = MEASURES.map(|(_, unit, ..)| format!("{unit:>13}")).concat();
    add_line(
        text,
        format_args!("{:width$}  {units}{:>22}", "", "north, east m/s"),
    );
    for pair in boats {
        for (game, response) in ["A", "B"].into_iter().zip(&pair.response) {
            let cell = |(_, _, places, of): Measure| match of(response) {
                Some(number) => format!("{:>13}", primitives::math::decimal(number, places)),
                None => format!("{:>13}", "-"),
            };
            let drift = match response.hold_drift_m_s {
                Some(drift) => drift
                    .map(|m_s| primitives::math::decimal(m_s, 3))
                    .join(", "),
                None => "-".to_owned(),
            };
            let name = if game == "A" { pair.boat.as_str() } else { "" };
            add_line(
                text,
                format_args!(
                    "{name:width$}{game} {}{drift:>22}",
                    MEASURES.map(cell).concat()
                ),
            );
        }
    }
    *text += &format!(
        "drift is measured from {SETTLED_S:.0} s after the order to hold; - means that the game has no such \
        measurement\n"
    );
}

fn events(text: &mut String, comparison: &Comparison) {
    add_line(text, format_args!("\n{:20}{:>7}{:>7}", "", "A", "B"));
    for (team, points) in &comparison.score {
        let [a, b] =
            points.map(|points| points.map_or("-".to_owned(), |points| points.to_string()));
        add_line(
            text,
            format_args!("{:20}{a:>7}{b:>7}", format!("score of {team}")),
        );
    }
    let found = &comparison.events;
    for (kind, [a, b]) in &found.counts {
        add_line(
            text,
            format_args!("{:20}{a:>7}{b:>7}", kind.replace('_', " ")),
        );
    }
    let tolerance_s = found.tolerance_s;
    add_line(
        text,
        format_args!("\n{} events match within {tolerance_s:.1} s", found.in_both),
    );
    for (name, only) in [("A", &found.only_in_a), ("B", &found.only_in_b)] {
        if !only.is_empty() {
            add_line(text, format_args!("only in {name}:"));
        }
        for event in only {
            add_line(
                text,
                format_args!("{:>7.1} s  {}", event.at_s, event.sentence()),
            );
        }
    }
}
