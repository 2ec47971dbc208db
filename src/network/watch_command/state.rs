//! The state of a game in text form: score, boats and events.

use super::Rates;
use crate::style;
use messages::topic::GameName;
use messages::{Frame, GameInfo, VehicleTruth};
use primitives::angle::compass_deg_from_rad;
use scenario::Scenario;

/// One view of the game.
pub(super) fn page(
    info: &GameInfo,
    game: &GameName,
    frame: &Frame,
    events: &[String],
    rates: &Rates,
) -> String {
    let scenario = &info.scenario;
    let mut text = format!(
        "{}  {}  {:.1} s of {:.0} s  {:.0}x  {:.0} frames/s\n",
        game.as_str(),
        info.pace,
        frame.stamp.valid_ns.as_s(),
        scenario.rules.time_limit.as_s(),
        rates.factor,
        rates.frames_hz
    );
    text += &format!("{}\n", score(scenario, frame));
    boats(scenario, frame).for_each(|line| text += &format!("{line}\n"));
    events.iter().for_each(|line| text += &format!("{line}\n"));
    text
}

/// The state of the game on one line.
pub(super) fn line(scenario: &Scenario, frame: &Frame, rates: &Rates) -> String {
    let lost = frame.vehicles.iter().filter(|boat| boat.agent_lost).count();
    let lost = if lost > 0 {
        format!("  {lost} without an agent")
    } else {
        String::new()
    };
    format!(
        "{:>7.1} s  {}  {:.0}x  {:.0} frames/s{lost}\n",
        frame.stamp.valid_ns.as_s(),
        score(scenario, frame),
        rates.factor,
        rates.frames_hz
    )
}

fn score(scenario: &Scenario, frame: &Frame) -> String {
    let teams = scenario.teams.iter().zip(&frame.score);
    teams
        .map(|(team, score)| format!("{} {score}", team.name))
        .collect::<Vec<_>>()
        .join("  ")
}

/// One line for each boat, for small fleets.
fn boats<'a>(scenario: &'a Scenario, frame: &'a Frame) -> impl Iterator<Item = String> + 'a {
    const SHOWN: usize = 12;
    let boats = scenario.vehicles.iter().zip(&frame.vehicles).take(SHOWN);
    boats.map(|(vehicle, boat)| {
        let nav = &boat.nav;
        let speed_m_s = nav.speed_m_s();
        format!(
            "{} x {:>7.1}  y {:>7.1}  {:>5.1}°  {:>4.2} m/s  {}",
            style::team(vehicle.team.index(), &format!("{:<14}", vehicle.name)),
            nav.east_m,
            nav.north_m,
            compass_deg_from_rad(nav.psi_rad),
            speed_m_s,
            state(boat)
        )
    })
}

fn state(boat: &VehicleTruth) -> String {
    let words = [
        (boat.agent_lost, "NO AGENT"),
        (boat.quarantined, "QUARANTINED"),
        (boat.carrying >= 0, "carries a flag"),
        (boat.tagged, "tagged"),
        (boat.disabled, "out of action"),
        (boat.outside, "off the field"),
    ];
    words
        .iter()
        .filter(|(holds, _)| *holds)
        .map(|(_, word)| *word)
        .collect::<Vec<_>>()
        .join(", ")
}
