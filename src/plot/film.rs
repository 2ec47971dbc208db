//! Draws one moment of a game: a frame of its film.

use crate::plot::field::{Symbol, View, bounds, draw_field, draw_symbol, fine, is_drawn};
use crate::plot::{Area, Drawing, Drawn, FONT, colour};
use messages::{Frame, VehicleTruth};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use primitives::{Ned, math};
use scenario::{Scenario, Source, Vehicle};

/// The page's water colour.
const WATER: RGBColor = RGBColor(227, 238, 244);
/// Height of the score above the water, and the margin around it, pixels.
const HEAD: u32 = 40;
const MARGIN_M: f64 = 6.0;
/// Minimum length of a drawn boat, pixels.
const HULL_LEAST: f64 = 13.0;

/// Boats are labelled only up to this number of boats.
const NAMES_MAX: usize = 12;

/// The part of a film that does not change.
pub(crate) struct Stage<'a> {
    /// The game's name.
    title: String,
    scenario: &'a Scenario,
    view: View,
}

/// Who plays for a team: the strategies of its simulated boats, or its name without any.
fn players(scenario: &Scenario, team: usize) -> String {
    let mut names: Vec<String> = vec![];
    for vehicle in scenario
        .vehicles
        .iter()
        .filter(|vehicle| vehicle.team.index() == team)
    {
        let name = scenario.strategies[vehicle.strategy].name.replace('_', " ");
        if vehicle.source == Source::Simulated && !names.contains(&name) {
            names.push(name);
        }
    }
    if names.is_empty() {
        scenario.teams[team].name.clone()
    } else {
        names.join(" + ")
    }
}

/// A moment of a game.
pub(crate) struct Moment<'a> {
    pub(crate) stage: &'a Stage<'a>,
    pub(crate) frame: Frame,
    /// The recent positions of each boat, up to now.
    pub(crate) trails: Vec<Vec<Ned>>,
}

impl<'a> Stage<'a> {
    /// A stage with a field of this width, pixels.
    pub(crate) fn new(title: String, scenario: &'a Scenario, width: u32) -> Stage<'a> {
        let (low, high) = bounds(scenario.field.corners.iter());
        let east_m = (low.east - MARGIN_M, high.east + MARGIN_M);
        let north_m = (low.north - MARGIN_M, high.north + MARGIN_M);
        let pixels_per_m = f64::from(width) / (east_m.1 - east_m.0);
        // Scale a tall field so that it is no higher than the picture is wide.
        let wide = f64::from(width);
        let high = (north_m.1 - north_m.0) * pixels_per_m;
        let scale = f64::min(1.0, wide / high);
        let water = (
            (wide * scale).round().max(1.0) as u32,
            (high * scale).round().max(1.0) as u32,
        );
        Stage {
            title,
            scenario,
            view: View {
                east_m,
                north_m,
                water,
                corner: (0, 0),
            },
        }
    }
}

impl Drawing for Moment<'_> {
    fn size(&self) -> (u32, u32) {
        let (wide, high) = self.stage.view.water;
        (wide, high + HEAD)
    }

    fn draw(&self, root: &Area<'_>) -> Drawn {
        let stage = self.stage;
        let (head, water) = root.split_vertically(HEAD);
        self.draw_head(&head)?;
        water.fill(&WATER)?;
        draw_field(&water, &stage.scenario.field, &stage.view)?;
        let boats = || stage.scenario.vehicles.iter().zip(&self.frame.vehicles);
        for ((vehicle, _), trail) in boats().zip(&self.trails) {
            let style = colour::of_team(vehicle.team.index())
                .mix(0.45)
                .stroke_width(2);
            water.draw(&PathElement::new(fine(trail, &stage.view), style))?;
        }
        for (flag, shown) in stage.scenario.field.flags.iter().zip(&self.frame.flags) {
            let carrier = usize::try_from(shown.carrier)
                .ok()
                .and_then(|carrier| self.frame.vehicles.get(carrier));
            let at = carrier.map_or(flag.home, |boat| boat.nav.at());
            if is_drawn(&at) {
                draw_symbol(
                    &water,
                    Symbol::Flag,
                    stage.view.pixel(at),
                    colour::of_team(flag.team.index()),
                )?;
            }
        }
        let mut drawn = boats().filter(|(_, truth)| is_drawn(&truth.nav.at()));
        drawn.try_for_each(|(vehicle, truth)| self.draw_boat(&water, vehicle, truth))
    }
}

impl Moment<'_> {
    fn draw_head(&self, head: &Area<'_>) -> Drawn {
        let style = |colour: RGBColor, side| {
            (FONT, 18)
                .into_font()
                .color(&colour)
                .pos(Pos::new(side, VPos::Center))
        };
        let wide = head.dim_in_pixel().0 as i32;
        let y = HEAD as i32 / 2;
        head.draw(&Text::new(
            self.stage.title.clone(),
            (12, y),
            style(BLACK, HPos::Left),
        ))?;
        let tenths = (10.0 * self.frame.stamp.valid_ns.as_s().max(0.0)).round() as u64;
        let clock = format!(
            "{:02}:{:02}.{}",
            tenths / 600,
            tenths / 10 % 60,
            tenths % 10
        );
        head.draw(&Text::new(clock, (wide - 12, y), style(BLACK, HPos::Right)))?;
        // `learned 3 : 3 strategy 3`, as on the page.
        let sides: [(&str, i32, HPos); 2] = [(" :", 6, HPos::Right), ("", 8, HPos::Left)];
        for (team, (points, (end, at, side))) in self.frame.score.iter().zip(sides).enumerate() {
            let players = players(self.stage.scenario, team);
            let text = if team == 0 {
                format!("{players} {points}{end}")
            } else {
                format!("{points} {players}")
            };
            head.draw(&Text::new(
                text,
                (wide / 2 + at, y),
                style(colour::of_team(team), side),
            ))?;
        }
        Ok(())
    }

    /// Draws a hull with a pointed bow; for a tagged boat, only the outline.
    fn draw_boat(&self, water: &Area<'_>, vehicle: &Vehicle, truth: &VehicleTruth) -> Drawn {
        let Stage { scenario, view, .. } = self.stage;
        let centre = view.pixel(truth.nav.at());
        let colour = colour::of_team(vehicle.team.index());
        let pixels_per_m = f64::from(view.water.0) / (view.east_m.1 - view.east_m.0);
        let half = 0.5 * (scenario.boats[vehicle.boat].length_m * pixels_per_m).max(HULL_LEAST);
        let (sin, cos) = math::sin_cos(truth.nav.psi_rad);
        let corner = |(ahead, aside): (f64, f64)| {
            let north = half * (ahead * cos - aside * sin);
            let east = half * (ahead * sin + aside * cos);
            (
                centre.0 + east.round() as i32,
                centre.1 - north.round() as i32,
            )
        };
        let hull = [
            (1.2, 0.0),
            (0.4, 0.5),
            (-1.0, 0.5),
            (-1.0, -0.5),
            (0.4, -0.5),
            (1.2, 0.0),
        ]
        .map(corner);
        let inside = if truth.tagged {
            WHITE.filled()
        } else {
            colour.filled()
        };
        water.draw(&Polygon::new(hull.to_vec(), inside))?;
        let edge = if truth.tagged {
            colour.stroke_width(2)
        } else {
            BLACK.stroke_width(1)
        };
        water.draw(&PathElement::new(hull.to_vec(), edge))?;
        let style = (FONT, 13)
            .into_font()
            .color(&BLACK)
            .pos(Pos::new(HPos::Center, VPos::Top));
        let name = if scenario.vehicles.len() <= NAMES_MAX {
            vehicle.name.replace('_', " ")
        } else {
            String::new()
        };
        water.draw(&Text::new(
            name,
            (centre.0, centre.1 + half.round() as i32 + 4),
            style,
        ))
    }
}
