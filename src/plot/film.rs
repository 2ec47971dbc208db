//! Draws one moment of a game: a frame of its film.

use crate::plot::field::{Symbol, View, bounds, draw_field, draw_symbol, fine, is_drawn};
use crate::plot::{Area, Drawing, Drawn, FONT, colour};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use primitives::{Ned, math};
use rules::field::Field;

/// The page's water colour.
const WATER: RGBColor = RGBColor(227, 238, 244);
/// Height of the score above the water, and the margin around it, pixels.
const HEAD: u32 = 40;
const MARGIN_M: f64 = 6.0;
/// Minimum length of a drawn boat, pixels.
const HULL_LEAST: f64 = 13.0;

/// The part of a film that does not change.
pub(crate) struct Stage<'a> {
    /// The game's name.
    pub(crate) title: String,
    pub(crate) field: &'a Field,
    /// Name of each team.
    pub(crate) teams: Vec<String>,
    view: View,
}

/// A boat at a moment.
pub(crate) struct Boat {
    pub(crate) name: String,
    pub(crate) team: usize,
    pub(crate) at: Ned,
    pub(crate) psi_rad: f64,
    pub(crate) length_m: f64,
    pub(crate) tagged: bool,
    /// Its recent positions, up to now.
    pub(crate) trail: Vec<Ned>,
}

/// A moment of a game.
pub(crate) struct Moment<'a> {
    pub(crate) stage: &'a Stage<'a>,
    pub(crate) t_s: f64,
    /// Points by team.
    pub(crate) score: Vec<u32>,
    pub(crate) boats: Vec<Boat>,
    /// The team and position of each flag.
    pub(crate) flags: Vec<(usize, Ned)>,
}

impl<'a> Stage<'a> {
    /// A stage with a field of this width, pixels.
    pub(crate) fn new(title: String, field: &'a Field, teams: Vec<String>, width: u32) -> Stage<'a> {
        let (low, high) = bounds(field.corners.iter());
        let (east_m, north_m) =
            ((low.east - MARGIN_M, high.east + MARGIN_M), (low.north - MARGIN_M, high.north + MARGIN_M));
        let pixels_per_m = f64::from(width) / (east_m.1 - east_m.0);
        // Scale a tall field so that it is no higher than the picture is wide.
        let (wide, high) = (f64::from(width), (north_m.1 - north_m.0) * pixels_per_m);
        let scale = f64::min(1.0, wide / high);
        let water = ((wide * scale).round().max(1.0) as u32, (high * scale).round().max(1.0) as u32);
        Stage { title, field, teams, view: View { east_m, north_m, water, corner: (0, 0) } }
    }

    fn pixels_per_m(&self) -> f64 {
        f64::from(self.view.water.0) / (self.view.east_m.1 - self.view.east_m.0)
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
        draw_field(&water, stage.field, &stage.view)?;
        for boat in &self.boats {
            let trail = colour::of_team(boat.team).mix(0.45).stroke_width(2);
            water.draw(&PathElement::new(fine(&boat.trail, &stage.view), trail))?;
        }
        for (team, at) in self.flags.iter().filter(|(_, at)| is_drawn(at)) {
            draw_symbol(&water, Symbol::Flag, stage.view.pixel(*at), colour::of_team(*team))?;
        }
        self.boats.iter().filter(|boat| is_drawn(&boat.at)).try_for_each(|boat| self.draw_boat(&water, boat))
    }
}

impl Moment<'_> {
    fn draw_head(&self, head: &Area<'_>) -> Drawn {
        let style = |colour: RGBColor, side| (FONT, 18).into_font().color(&colour).pos(Pos::new(side, VPos::Center));
        let (wide, y) = (head.dim_in_pixel().0 as i32, HEAD as i32 / 2);
        head.draw(&Text::new(self.stage.title.clone(), (12, y), style(BLACK, HPos::Left)))?;
        let tenths = (10.0 * self.t_s.max(0.0)).round() as u64;
        let clock = format!("{:02}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10);
        head.draw(&Text::new(clock, (wide - 12, y), style(BLACK, HPos::Right)))?;
        let step = 150;
        let mut x = wide / 2 - step * (self.stage.teams.len() as i32 - 1) / 2;
        for (team, (name, points)) in self.stage.teams.iter().zip(&self.score).enumerate() {
            head.draw(&Text::new(format!("{name} {points}"), (x, y), style(colour::of_team(team), HPos::Center)))?;
            x += step;
        }
        Ok(())
    }

    /// Draws a hull with a pointed bow; for a tagged boat, only the outline.
    fn draw_boat(&self, water: &Area<'_>, boat: &Boat) -> Drawn {
        let (centre, colour) = (self.stage.view.pixel(boat.at), colour::of_team(boat.team));
        let half = 0.5 * (boat.length_m * self.stage.pixels_per_m()).max(HULL_LEAST);
        let (sin, cos) = math::sin_cos(boat.psi_rad);
        let corner = |(ahead, aside): (f64, f64)| {
            let (north, east) = (half * (ahead * cos - aside * sin), half * (ahead * sin + aside * cos));
            (centre.0 + east.round() as i32, centre.1 - north.round() as i32)
        };
        let hull = [(1.2, 0.0), (0.4, 0.5), (-1.0, 0.5), (-1.0, -0.5), (0.4, -0.5), (1.2, 0.0)].map(corner);
        let inside = if boat.tagged { WHITE.filled() } else { colour.filled() };
        water.draw(&Polygon::new(hull.to_vec(), inside))?;
        let edge = if boat.tagged { colour.stroke_width(2) } else { BLACK.stroke_width(1) };
        water.draw(&PathElement::new(hull.to_vec(), edge))?;
        let style = (FONT, 13).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Top));
        water.draw(&Text::new(boat.name.clone(), (centre.0, centre.1 + half.round() as i32 + 4), style))
    }
}
