//! The table of a boat that `squall identify` reads.

use crate::{Logs, Quantity};

/// Maximum gap between two measurements across which a value is interpolated, s.
const GAP_MAX_S: f64 = 2.0;
/// Time after which the thrust counts as unknown if a command is not repeated, s.
const COMMAND_MAX_S: f64 = 5.0;
/// A missing yaw rate is estimated from the headings this long before and after, s.
const YAW_S: f64 = 0.5;

/// The measured columns.
const MEASURED: [(&str, Quantity); 6] = [
    ("x_m", Quantity::X),
    ("y_m", Quantity::Y),
    ("heading_deg", Quantity::Heading),
    ("surge_m_s", Quantity::Surge),
    ("sway_m_s", Quantity::Sway),
    ("yaw_rate_deg_s", Quantity::YawRate),
];

/// The log of a boat as CSV with the columns of `squall identify`. It has one row for each
/// position, except while the thrust is unknown. Other measurements are interpolated, and commands
/// keep their last value. Columns without any value are omitted.
pub fn table(logs: &Logs, boat: &str) -> String {
    let times = logs
        .series(boat, Quantity::X)
        .map_or(&[][..], Vec::as_slice);
    let first_s = times.first().map_or(0.0, |(at_s, _)| *at_s);
    let commands = [
        ("port_pct", Quantity::Port),
        ("starboard_pct", Quantity::Starboard),
    ];
    let commands = commands
        .iter()
        .filter(|(_, side)| logs.series(boat, *side).is_some());
    let commands: Vec<_> = commands.collect();
    let measured = MEASURED.iter().filter(|(_, quantity)| {
        let source = match quantity {
            Quantity::YawRate => Quantity::Heading,
            Quantity::Surge => Quantity::Speed,
            quantity => *quantity,
        };
        logs.series(boat, *quantity).is_some() || logs.series(boat, source).is_some()
    });
    let measured: Vec<_> = measured.collect();
    let heads = measured.iter().chain(&commands).map(|(head, _)| *head);
    let mut text = String::from("t_s");
    heads.for_each(|head| text.extend([",", head]));
    text.push('\n');
    let mut before_s = f64::NEG_INFINITY;
    for (at_s, _) in times {
        // Before the first command, and long after the last one, the thrust is unknown.
        let commanded: Vec<Option<f64>> = commands
            .iter()
            .map(|(_, side)| {
                let (given_s, value) = logs.newest_at(boat, *side, *at_s)?;
                (at_s - given_s <= COMMAND_MAX_S).then_some(value)
            })
            .collect();
        // Skip a second position with the same time, for example from another NMEA sentence.
        if *at_s - before_s < 1e-3 || commanded.iter().any(Option::is_none) {
            continue;
        }
        before_s = *at_s;
        text.push_str(&format!("{:.4}", at_s - first_s));
        let values = measured
            .iter()
            .map(|(_, quantity)| value(logs, boat, *quantity, *at_s));
        for value in values.chain(commanded) {
            let value = value.map_or(String::new(), |value| format!("{value:.9}"));
            text.extend([",", &value]);
        }
        text.push('\n');
    }
    text
}

/// A measurement at a time; `None` in a gap.
fn value(logs: &Logs, boat: &str, quantity: Quantity, at_s: f64) -> Option<f64> {
    let near = |quantity, at_s| {
        let series = logs.series(boat, quantity)?;
        let next = series.partition_point(|(time_s, _)| *time_s <= at_s);
        let before_s = series.get(next.checked_sub(1)?)?.0;
        let after_s = series.get(next).map_or(at_s, |(after_s, _)| *after_s);
        (after_s - before_s <= GAP_MAX_S).then(|| logs.at(boat, quantity, at_s))?
    };
    match (quantity, near(quantity, at_s)) {
        (Quantity::Surge, None) => near(Quantity::Speed, at_s),
        (Quantity::YawRate, None) => {
            let [before, after] = [-YAW_S, YAW_S].map(|by_s| near(Quantity::Heading, at_s + by_s));
            Some((after? - before?) / (2.0 * YAW_S))
        }
        (Quantity::Heading, found) => found.map(|deg| deg.rem_euclid(360.0)),
        (_, found) => found,
    }
}
