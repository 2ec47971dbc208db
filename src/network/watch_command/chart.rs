//! The field in characters: boats as arrows, flags, the scrimmage line.

use super::Rates;
use crate::style;
use messages::topic::GameName;
use messages::{Frame, GameInfo, VehicleTruth};
use primitives::Ned;
use primitives::angle::compass_deg_from_rad;
use scenario::Scenario;

/// Columns and rows of the chart. A character is twice as high as wide, a field twice as wide as
/// deep.
const COLUMNS: usize = 78;
const ROWS: usize = 20;

/// One picture of the game.
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
    let mut cells = vec![vec![" ".to_owned(); COLUMNS]; ROWS];
    draw_field(scenario, frame, &mut cells);
    draw_boats(scenario, frame, &mut cells);
    text += &format!("+{}+\n", "-".repeat(COLUMNS));
    cells
        .iter()
        .for_each(|row| text += &format!("|{}|\n", row.concat()));
    text += &format!("+{}+\n", "-".repeat(COLUMNS));
    boats(scenario, frame).for_each(|line| text += &format!("{line}\n"));
    events.iter().for_each(|line| text += &format!("{line}\n"));
    text
}

/// The state of the game in one line.
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

/// The cell of a position; positions off the field are shown at its edge. The field's far side is
/// at the top.
fn cell(scenario: &Scenario, at: Ned) -> (usize, usize) {
    let plan = &scenario.field.plan;
    let (along_m, across_m) = scenario.field.along_across(at);
    let index =
        |share: f64, count: usize| (share * count as f64).clamp(0.0, count as f64 - 1.0) as usize;
    (
        ROWS - 1 - index(across_m / plan.depth_m, ROWS),
        index(along_m / plan.width_m, COLUMNS),
    )
}

fn paint(cells: &mut [Vec<String>], (row, column): (usize, usize), team: usize, letter: &str) {
    cells[row][column] = style::team(team, letter);
}

fn draw_field(scenario: &Scenario, frame: &Frame, cells: &mut [Vec<String>]) {
    for row in cells.iter_mut() {
        ":".clone_into(&mut row[COLUMNS / 2]);
    }
    for (flag, view) in scenario.field.flags.iter().zip(&frame.flags) {
        let letter = if view.carrier < 0 { "F" } else { "f" };
        paint(cells, cell(scenario, flag.home), flag.team.index(), letter);
    }
}

fn draw_boats(scenario: &Scenario, frame: &Frame, cells: &mut [Vec<String>]) {
    const ARROWS: [&str; 8] = ["↑", "↗", "→", "↘", "↓", "↙", "←", "↖"];
    for (vehicle, boat) in scenario.vehicles.iter().zip(&frame.vehicles) {
        // The chart shows the field level, so headings are rotated with it.
        let heading_deg = boat.nav.psi_rad.to_degrees() + 90.0 - scenario.field.plan.along_deg;
        let eighth = (compass_deg_from_rad(heading_deg.to_radians()) / 45.0).round() as usize % 8;
        paint(
            cells,
            cell(scenario, boat.nav.at()),
            vehicle.team.index(),
            ARROWS[eighth],
        );
    }
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
