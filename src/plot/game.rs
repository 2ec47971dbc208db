//! Plots of a recorded game: tracks, score and every boat.

use crate::plot::field::{Chart, Spot, Symbol, Track};
use crate::plot::{self, Line, Page, Panel, colour};
use analysis::{BoatSeries, GameSeries, Sample, ordered_m_s};
use anyhow::Result;
use messages::Order;
use plotters::style::RGBColor;
use primitives::angle::compass_deg_from_rad;
use recording::Header;
use rules::event::Event;
use std::path::Path;

/// With more boats than this, the chart has no names: they would hide it.
const NAMES_MAX: usize = 12;
/// Size of a panel as wide as a page, pixels.
const WIDE: (u32, u32) = (1120, 300);
/// The colour of ordered values.
const ORDERED: RGBColor = RGBColor(90, 90, 90);
const TIME: &str = "simulated time in s";

/// Draws a game into files in a folder; returns the number of plots.
pub(crate) fn write(dir: &Path, header: &Header, series: &GameSeries) -> Result<usize> {
    plot::write_both(&dir.join("tracks"), &chart(header, series))?;
    plot::write_both(&dir.join("score"), &score(header, series))?;
    for boat in &series.boats {
        plot::write_both(
            &dir.join(format!("boat_{}", boat.name)),
            &boat_page(header, series, boat),
        )?;
    }
    Ok(2 + series.boats.len())
}

fn title(header: &Header, what: &str) -> String {
    let scenario = &header.info.scenario;
    format!("{}, seed {}: {what}", scenario.name, scenario.seed)
}

/// The colours of a team's boats: from the team colour to a mix with half white.
fn shades(series: &GameSeries) -> Vec<RGBColor> {
    let shade = |(i, boat): (usize, &BoatSeries)| {
        let mates =
            |boats: &[BoatSeries]| boats.iter().filter(|other| other.team == boat.team).count();
        let place = mates(&series.boats[..i]);
        let all = mates(&series.boats);
        let white = if all > 1 {
            0.5 * place as f64 / (all - 1) as f64
        } else {
            0.0
        };
        let mix = |part: u8| (f64::from(part) + white * (255.0 - f64::from(part))).round() as u8;
        let RGBColor(red, green, blue) = colour::of_team(boat.team);
        RGBColor(mix(red), mix(green), mix(blue))
    };
    series.boats.iter().enumerate().map(shade).collect()
}

fn chart<'a>(header: &'a Header, series: &GameSeries) -> Chart<'a> {
    let named = series.boats.len() <= NAMES_MAX;
    let track = |(boat, colour): (&BoatSeries, RGBColor)| Track {
        name: if named {
            boat.name.clone()
        } else {
            String::new()
        },
        colour,
        places: boat.track().collect(),
    };
    let start = |boat: &BoatSeries| {
        Some(Spot {
            symbol: Symbol::Start,
            at: boat.track().next()?,
            team: boat.team,
        })
    };
    let mut spots: Vec<Spot> = series.boats.iter().filter_map(start).collect();
    for logged in &series.events {
        let symbol = match logged.event {
            Event::Grabbed { .. } => Symbol::Grab,
            Event::Captured { .. } => Symbol::Capture,
            Event::Tagged { .. } => Symbol::Tag,
            _ => continue,
        };
        let boat = logged
            .event
            .vehicle()
            .and_then(|vehicle| series.boats.get(vehicle.index()));
        let place = |boat: &BoatSeries| {
            boat.samples
                .get(series.sample_at(logged.at.as_s()))
                .map(|sample| sample.truth.at())
        };
        if let Some((boat, at)) = boat.and_then(|boat| Some((boat, place(boat)?))) {
            spots.push(Spot {
                symbol,
                at,
                team: boat.team,
            });
        }
    }
    Chart {
        title: title(header, "tracks"),
        field: &header.info.scenario.field,
        teams: series.teams.clone(),
        tracks: series.boats.iter().zip(shades(series)).map(track).collect(),
        spots,
    }
}

/// The score as a step function.
fn score(header: &Header, series: &GameSeries) -> Page {
    let steps = |team: usize| {
        let points = series
            .score
            .iter()
            .map(|score| score.get(team).copied().unwrap_or(0));
        let mut line: Vec<(f64, f64)> = vec![];
        for (time_s, points) in series.times_s.iter().zip(points.map(f64::from)) {
            let before = line.last().map_or(points, |last| last.1);
            if before != points {
                line.push((*time_s, before));
            }
            line.push((*time_s, points));
        }
        line
    };
    let line = |(team, name): (usize, &String)| Line {
        colour: Some(colour::of_team(team)),
        ..Line::of(name, steps(team))
    };
    let lines = series.teams.iter().enumerate().map(line).collect();
    let panels = vec![Panel::of(
        "Score",
        [TIME, "points"],
        lines,
        "nothing was recorded",
    )];
    Page {
        title: title(header, "score"),
        columns: 1,
        panel: WIDE,
        panels,
    }
}

/// Speed, heading and navigation error of a boat.
fn boat_page(header: &Header, series: &GameSeries, boat: &BoatSeries) -> Page {
    let series = |of: &dyn Fn(&Sample) -> Option<f64>| -> Vec<(f64, f64)> {
        let samples = series.times_s.iter().zip(&boat.samples);
        samples
            .map(|(time_s, sample)| (*time_s, of(sample).unwrap_or(f64::NAN)))
            .collect()
    };
    let ordered = |points| Line {
        colour: Some(ORDERED),
        ..Line::of("ordered", points)
    };
    let sailed = |points| Line {
        colour: Some(colour::of_team(boat.team)),
        ..Line::of("sailed", points)
    };
    let speed = |sample: &Sample| ordered_m_s(sample.order);
    let heading = |sample: &Sample| match sample.order {
        Order::Steer { heading_rad, .. } => Some(compass_deg_from_rad(heading_rad)),
        Order::Hold | Order::Turn { .. } | Order::Thrust { .. } => None,
    };
    let speeds = vec![
        ordered(series(&speed)),
        sailed(series(&|sample| Some(sample.truth.surge_m_s))),
    ];
    let headings = vec![
        ordered(unwound(series(&heading))),
        sailed(unwound(series(&|sample| {
            Some(compass_deg_from_rad(sample.truth.psi_rad))
        }))),
    ];
    let error = Line {
        colour: Some(colour::of_team(boat.team)),
        ..Line::of("", series(&Sample::nav_error_m))
    };
    let is_known = error.points.iter().any(|(_, error_m)| error_m.is_finite());
    let absent = "no picture showed the estimated position of this boat";
    let panels = vec![
        Panel::of("Speed ahead, over the ground", [TIME, "m/s"], speeds, ""),
        Panel::of("Heading", [TIME, plot::COMPASS], headings, ""),
        Panel::of(
            "Error of its own navigation",
            [TIME, "m"],
            if is_known { vec![error] } else { vec![] },
            absent,
        ),
    ];
    Page {
        title: title(header, &boat.name),
        columns: 1,
        panel: WIDE,
        panels,
    }
}

/// Headings with a gap where they pass north, so that no line crosses the panel.
fn unwound(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut line: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for (time_s, heading_deg) in points {
        if line
            .last()
            .is_some_and(|last| (last.1 - heading_deg).abs() > 180.0)
        {
            line.push((time_s, f64::NAN));
        }
        line.push((time_s, heading_deg));
    }
    line
}
