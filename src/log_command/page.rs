//! The summary of a recorded game in text form.

use analysis::{BoatStatistics, Gateway, NavigationError, SteeringError, Summary, Topic, Traffic};
use primitives::printable::add_line;
use recording::{Bag, Damaged, utc};
use std::collections::BTreeMap;

/// The whole summary.
pub(super) fn text(summary: &Summary) -> String {
    let mut text = head(summary);
    if !summary.events.is_empty() {
        text += &format!("\n{}", events(summary));
    }
    text += &boats(&summary.boats);
    for gateway in &summary.gateways {
        text += &gateway_text(gateway);
    }
    text + &topics(&summary.topics)
}

/// The summary of a gateway's own recording.
pub(super) fn gateway(bag: &Bag) -> String {
    let [boat, version, commit] = ["vehicle", "version", "commit"].map(|key| bag.fact(key));
    let gateway = analysis::gateway_of(bag, boat);
    let mut text = format!("gateway of {boat}\n");
    add_line(
        &mut text,
        format_args!(
            "recorded {} by Squall {version} ({commit})",
            utc::text(bag.began_utc_ns)
        ),
    );
    let duration_s = bag
        .messages()
        .map(|message| message.at)
        .max()
        .unwrap_or_default()
        .as_s();
    add_line(
        &mut text,
        format_args!("{duration_s:.1} s, {:.1} MB", bag.size() as f64 * 1e-6),
    );
    if bag.is_cut {
        add_line(
            &mut text,
            format_args!("the file ends before the gateway did; the figures below are incomplete"),
        );
    }
    damaged(&mut text, &gateway.damaged);
    text += &gateway_text(&gateway);
    text += &topics(&analysis::topics(bag));
    add_line(
        &mut text,
        format_args!(
            "\nreplay it through the codec and the supervisor with: squall gateway replay"
        ),
    );
    text
}

fn damaged(text: &mut String, damaged: &Damaged) {
    if let Some(remark) = damaged.remark() {
        add_line(text, format_args!("{remark}"));
    }
}

/// The events, one per line.
pub(super) fn events(summary: &Summary) -> String {
    summary
        .events
        .iter()
        .map(|event| format!("{:>7.1} s  {}\n", event.at_s, event.sentence()))
        .collect()
}

fn head(summary: &Summary) -> String {
    let Summary {
        scenario,
        seed,
        version,
        commit,
        pace,
        duration_s,
        wall_s,
        bytes,
        ..
    } = summary;
    let mut text = format!("{}  {scenario}  seed {seed}\n", summary.game);
    add_line(
        &mut text,
        format_args!(
            "recorded {} by {}",
            utc::text(summary.began_utc_ns),
            if commit.is_empty() {
                "other programs".to_owned()
            } else {
                format!("Squall {version} ({commit})")
            }
        ),
    );
    let megabytes = *bytes as f64 * 1e-6;
    add_line(
        &mut text,
        format_args!("{pace}, {duration_s:.1} s in {wall_s:.1} s of real time, {megabytes:.1} MB"),
    );
    if summary.is_cut {
        add_line(
            &mut text,
            format_args!("the file ends before the game did; the figures below are incomplete"),
        );
    }
    if let Some(dropped) = summary.dropped.filter(|dropped| *dropped > 0) {
        add_line(
            &mut text,
            format_args!("{dropped} messages are missing: the disk was too slow"),
        );
    }
    damaged(&mut text, &summary.damaged);
    let score: Vec<String> = summary
        .score
        .iter()
        .map(|(team, points)| format!("{team} {points}"))
        .collect();
    let end = match (&summary.winner, summary.is_cut) {
        (Some(team), _) => format!("{team} wins"),
        (None, true) => "undecided at the end of this recording".to_owned(),
        (None, false) if summary.events.iter().any(|event| event.event == "ended") => {
            "a draw".to_owned()
        }
        (None, false) => "cut short".to_owned(),
    };
    add_line(&mut text, format_args!("{}  {end}", score.join("  ")));
    if let Some(digest) = &summary.digest {
        add_line(&mut text, format_args!("digest {digest}"));
    }
    text
}

/// Three tables, so that each fits a terminal of 80 columns: motion, time in each state, and
/// accuracy.
fn boats(boats: &[BoatStatistics]) -> String {
    let width = boats
        .iter()
        .map(|boat| boat.boat.len())
        .max()
        .unwrap_or(0)
        .max(8)
        + 2;
    let mut text = String::new();
    let mut table = |heads: [&str; 2], cells: fn(&BoatStatistics) -> String| {
        add_line(&mut text, format_args!("\n{:width$}{}", "", heads[0]));
        add_line(&mut text, format_args!("{:width$}{}", "", heads[1]));
        for boat in boats {
            add_line(
                &mut text,
                format_args!("{:width$}{}", boat.boat, cells(boat)),
            );
        }
    };
    let heads = [
        "  distance   speed    max  grabs  captures  tags  tagged  collisions",
        "         m     m/s    m/s",
    ];
    table(heads, |boat| {
        let c = &boat.counts;
        let moved = format!(
            "{:>10.0}{:>8.2}{:>7.2}",
            boat.distance_m, boat.speed_mean_m_s, boat.speed_max_m_s
        );
        format!(
            "{moved}{:>7}{:>10}{:>6}{:>8}{:>12}",
            c.grabs, c.captures, c.tags, c.tagged, c.collisions
        )
    });
    let heads = [
        " carrying   tagged  outside no agent     lost",
        "        s        s        s        s        s",
    ];
    table(heads, |boat| {
        let spans_s = [
            boat.carrying_s,
            boat.tagged_s,
            boat.outside_s,
            boat.agent_lost_s,
            boat.nav_lost_s,
        ];
        spans_s.map(|span_s| format!("{span_s:>9.1}")).concat()
    });
    let heads = [
        "      navigation error        tracking error",
        "       rms m    95 % m     rms deg   rms m/s",
    ];
    table(heads, |boat| {
        let none = || format!("{:>12}{:>10}", "-", "-");
        let navigation =
            |error: &NavigationError| format!("{:>12.2}{:>10.2}", error.rms_m, error.p95_m);
        let orders = |error: &SteeringError| {
            format!(
                "{:>12.1}{:>10.2}",
                error.heading_rms_deg, error.speed_rms_m_s
            )
        };
        boat.navigation.as_ref().map_or_else(none, navigation)
            + &boat.steering.as_ref().map_or_else(none, orders)
    });
    let real: Vec<&str> = boats
        .iter()
        .filter(|boat| boat.is_real)
        .map(|boat| boat.boat.as_str())
        .collect();
    if !real.is_empty() {
        let real = real.join(", ");
        add_line(
            &mut text,
            format_args!(
                "{real}: real boats; their true positions are those reported by their gateways"
            ),
        );
    }
    text
}

fn gateway_text(gateway: &Gateway) -> String {
    let state = gateway.state.as_deref().unwrap_or("unknown");
    let failsafes = match gateway.failsafes.len() {
        1 => "1 failsafe".to_owned(),
        count => format!("{count} failsafes"),
    };
    let mut text = format!(
        "\ngateway of {}: {state} at the end, {failsafes}\n",
        gateway.boat
    );
    for failsafe in &gateway.failsafes {
        add_line(
            &mut text,
            format_args!(
                "{:>7.1} s (gateway time)  {}",
                failsafe.at_s, failsafe.cause
            ),
        );
    }
    for (way, traffic) in [
        ("from the boat", &gateway.from_boat),
        ("to the boat", &gateway.to_boat),
    ] {
        let Traffic { bytes, sentences } = traffic;
        let kinds: Vec<String> = sentences
            .iter()
            .map(|(kind, count)| format!("{kind} {count}"))
            .collect();
        add_line(
            &mut text,
            format_args!("  {way:<14}{bytes:>9} bytes  {}", kinds.join("  ")),
        );
    }
    text
}

fn topics(topics: &BTreeMap<String, Topic>) -> String {
    let width = topics.keys().map(String::len).max().unwrap_or(0).max(5) + 2;
    let mut text = String::new();
    add_line(
        &mut text,
        format_args!(
            "\n{:width$}{:>10}{:>10}{:>10}",
            "topic", "messages", "a second", "kB"
        ),
    );
    for (name, topic) in topics {
        let rate = topic
            .rate_hz
            .map_or("-".to_owned(), |rate_hz| format!("{rate_hz:.1}"));
        let kilobytes = topic.bytes as f64 * 1e-3;
        add_line(
            &mut text,
            format_args!(
                "{name:width$}{:>10}{rate:>10}{kilobytes:>10.0}",
                topic.count
            ),
        );
    }
    text
}
