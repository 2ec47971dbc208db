//! A chart of the field with tracks, as SVG and PNG files.

use crate::plot::{Area, Drawing, Drawn, FONT, colour};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use primitives::{Ned, math};
use rules::field::{Field, Obstacle};

/// A chart of the field.
pub(crate) struct Chart<'a> {
    /// The title above the chart.
    pub(crate) title: String,
    pub(crate) field: &'a Field,
    /// Name of each team.
    pub(crate) teams: Vec<String>,
    /// The tracks of the boats.
    pub(crate) tracks: Vec<Track>,
    /// Places of events.
    pub(crate) spots: Vec<Spot>,
}

/// The track of a boat.
pub(crate) struct Track {
    /// The label at its start; empty if there would be too many labels.
    pub(crate) name: String,
    pub(crate) colour: RGBColor,
    /// Positions from the start on.
    pub(crate) places: Vec<Ned>,
}

/// The place of an event.
pub(crate) struct Spot {
    /// What happened there.
    pub(crate) symbol: Symbol,
    /// Its position.
    pub(crate) at: Ned,
    /// The team concerned.
    pub(crate) team: usize,
}

/// The symbol of a spot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Symbol {
    /// A ring: a boat's start.
    Start,
    /// A triangle: a flag was grabbed.
    Grab,
    /// A star: a flag was captured.
    Capture,
    /// A cross: a boat was tagged.
    Tag,
    /// A flag on its staff: the position of a flag.
    Flag,
}

const LEGEND: [(Symbol, &str); 5] = [
    (Symbol::Flag, "flag"),
    (Symbol::Start, "start"),
    (Symbol::Grab, "grab"),
    (Symbol::Capture, "capture"),
    (Symbol::Tag, "tagged"),
];

/// Maximum size of the water, pixels.
const WATER_MAX: (f64, f64) = (1100.0, 820.0);
/// Margins for title, legend, labels at the left and below, and the border, pixels.
const TITLE: u32 = 48;
const BELOW: u32 = 44;
const LABELS: (u32, u32) = (64, 42);
const MARGIN: u32 = 24;
const GREY: RGBColor = RGBColor(90, 90, 90);
/// Resolution of tracks, pixels.
const FINE: f64 = 0.7;

/// The visible part of the world, and its scale.
pub(super) struct View {
    pub(super) east_m: (f64, f64),
    pub(super) north_m: (f64, f64),
    /// Width and height of the water, pixels.
    pub(super) water: (u32, u32),
    /// The top left corner of the water, pixels.
    pub(super) corner: (u32, u32),
}

impl View {
    /// A view of the field and all tracks with a margin of water, at the same scale in both
    /// directions.
    fn of(chart: &Chart<'_>) -> View {
        let corners = chart.field.corners.iter();
        let places = corners.chain(chart.tracks.iter().flat_map(|track| &track.places));
        let (low, high) = bounds(places.filter(|place| is_drawn(place)));
        let margin_m = 0.04 * (high - low).length();
        let wide_m = high.east - low.east + 2.0 * margin_m;
        let high_m = high.north - low.north + 2.0 * margin_m;
        let pixels_per_m = f64::min(WATER_MAX.0 / wide_m, WATER_MAX.1 / high_m);
        // The legend needs a minimum width, however narrow the field is.
        let wide = (wide_m * pixels_per_m).max(560.0);
        let middle_m = 0.5 * (low.east + high.east);
        let half_m = 0.5 * wide / pixels_per_m;
        View {
            east_m: (middle_m - half_m, middle_m + half_m),
            north_m: (low.north - margin_m, high.north + margin_m),
            water: (wide.round() as u32, (high_m * pixels_per_m).round() as u32),
            corner: (MARGIN + LABELS.0, TITLE),
        }
    }

    fn size(&self) -> (u32, u32) {
        (
            self.water.0 + LABELS.0 + 2 * MARGIN,
            TITLE + self.water.1 + LABELS.1 + BELOW + MARGIN,
        )
    }

    /// A position in pixels.
    pub(super) fn pixel(&self, at: Ned) -> (i32, i32) {
        let right =
            (at.east - self.east_m.0) / (self.east_m.1 - self.east_m.0) * f64::from(self.water.0);
        let down = (self.north_m.1 - at.north) / (self.north_m.1 - self.north_m.0)
            * f64::from(self.water.1);
        (
            (right + f64::from(self.corner.0)).round() as i32,
            (down + f64::from(self.corner.1)).round() as i32,
        )
    }
}

impl Drawing for Chart<'_> {
    fn size(&self) -> (u32, u32) {
        View::of(self).size()
    }

    fn draw(&self, root: &Area<'_>) -> Drawn {
        let view = View::of(self);
        root.draw(&Text::new(
            self.title.clone(),
            (24, 16),
            (FONT, 20).into_font(),
        ))?;
        draw_axes(root, &view)?;
        draw_field(root, self.field, &view)?;
        for track in &self.tracks {
            root.draw(&PathElement::new(
                fine(&track.places, &view),
                track.colour.stroke_width(2),
            ))?;
        }
        for flag in &self.field.flags {
            draw_symbol(
                root,
                Symbol::Flag,
                view.pixel(flag.home),
                colour::of_team(flag.team.index()),
            )?;
        }
        for spot in self.spots.iter().filter(|spot| is_drawn(&spot.at)) {
            draw_symbol(
                root,
                spot.symbol,
                view.pixel(spot.at),
                colour::of_team(spot.team),
            )?;
        }
        draw_names(root, self, &view)?;
        draw_legend(root, self, &view)
    }
}

/// Draws the frame of the water with its scales in metres.
fn draw_axes(root: &Area<'_>, view: &View) -> Drawn {
    let area = root.margin(TITLE, BELOW + MARGIN, MARGIN, MARGIN);
    let mut axes = ChartBuilder::on(&area)
        .x_label_area_size(LABELS.1)
        .y_label_area_size(LABELS.0)
        .build_cartesian_2d(view.east_m.0..view.east_m.1, view.north_m.0..view.north_m.1)?;
    // The view places everything that is drawn: the axes must agree with it.
    for (east_m, north_m) in [
        (view.east_m.0, view.north_m.0),
        (view.east_m.1, view.north_m.1),
    ] {
        let on_axes = axes.backend_coord(&(east_m, north_m));
        let drawn = view.pixel(Ned {
            north: north_m,
            east: east_m,
        });
        let off = on_axes.0.abs_diff(drawn.0).max(on_axes.1.abs_diff(drawn.1));
        assert!(
            off <= 2,
            "the axes are not where the field is: {on_axes:?} instead of {drawn:?}"
        );
    }
    axes.configure_mesh()
        .x_desc("x (east) in m")
        .y_desc("y (north) in m")
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
        .x_labels(12)
        .y_labels(10)
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(232, 232, 232))
        .x_label_formatter(&|x| primitives::math::decimal(*x, 0))
        .y_label_formatter(&|y| primitives::math::decimal(*y, 0))
        .draw()
}

/// Draws zones in their teams' colours, the outline, the scrimmage line, and obstacles.
pub(super) fn draw_field(root: &Area<'_>, field: &Field, view: &View) -> Drawn {
    let pixels = |places: &[Ned]| {
        places
            .iter()
            .map(|place| view.pixel(*place))
            .collect::<Vec<_>>()
    };
    for (team, zone) in field.zones.iter().enumerate() {
        root.draw(&Polygon::new(
            pixels(&zone.corners),
            colour::of_team(team).mix(0.08),
        ))?;
    }
    let outline: Vec<Ned> = field
        .corners
        .iter()
        .chain(field.corners.first())
        .copied()
        .collect();
    root.draw(&PathElement::new(pixels(&outline), GREY.stroke_width(1)))?;
    root.draw(&PathElement::new(
        pixels(&field.scrimmage),
        GREY.mix(0.6).stroke_width(1),
    ))?;
    for obstacle in &field.plan.obstacles {
        let corners = match obstacle {
            Obstacle::Polygon { corners } => corners.clone(),
            Obstacle::Circle { centre, radius_m } => {
                let toward = |i: i32| Ned::toward_deg(10.0 * f64::from(i));
                (0..36)
                    .map(|i| *centre + toward(i).scaled(*radius_m))
                    .collect()
            }
        };
        root.draw(&Polygon::new(pixels(&corners), GREY.mix(0.5)))?;
    }
    Ok(())
}

/// The south-west and the north-east corner of an area that contains all these places.
pub(super) fn bounds<'a>(places: impl Iterator<Item = &'a Ned>) -> (Ned, Ned) {
    let nothing = (
        Ned {
            north: f64::MAX,
            east: f64::MAX,
        },
        Ned {
            north: f64::MIN,
            east: f64::MIN,
        },
    );
    places.fold(nothing, |(low, high), place| {
        let low = Ned {
            north: low.north.min(place.north),
            east: low.east.min(place.east),
        };
        (
            low,
            Ned {
                north: high.north.max(place.north),
                east: high.east.max(place.east),
            },
        )
    })
}

/// Whether a position can be drawn: false for positions from a damaged recording or a boat with
/// non-finite numbers.
pub(super) fn is_drawn(place: &Ned) -> bool {
    [place.north, place.east]
        .iter()
        .all(|number| number.abs() < 1e6)
}

/// The pixels of a track, without points that change nothing.
pub(super) fn fine(places: &[Ned], view: &View) -> Vec<(i32, i32)> {
    let least_m = FINE * (view.east_m.1 - view.east_m.0) / f64::from(view.water.0);
    let mut kept: Vec<Ned> = vec![];
    for place in places.iter().filter(|place| is_drawn(place)) {
        if kept
            .last()
            .is_none_or(|last| last.distance(*place) >= least_m)
        {
            kept.push(*place);
        }
    }
    kept.into_iter().map(|place| view.pixel(place)).collect()
}

pub(super) fn draw_symbol(
    root: &Area<'_>,
    symbol: Symbol,
    at: (i32, i32),
    colour: RGBColor,
) -> Drawn {
    let off = |(right, down): (i32, i32)| (at.0 + right, at.1 + down);
    let edge = BLACK.stroke_width(1);
    let solid = |corners: Vec<(i32, i32)>| {
        let corners: Vec<(i32, i32)> = corners.into_iter().map(off).collect();
        root.draw(&Polygon::new(corners.clone(), colour.filled()))?;
        let closed = corners.iter().chain(corners.first()).copied();
        root.draw(&PathElement::new(closed.collect::<Vec<_>>(), edge))
    };
    match symbol {
        Symbol::Start => {
            root.draw(&Circle::new(at, 6, WHITE.filled()))?;
            root.draw(&Circle::new(at, 6, colour.stroke_width(3)))
        }
        Symbol::Grab => solid(vec![(0, -8), (7, 5), (-7, 5)]),
        Symbol::Capture => solid(star(10.0)),
        Symbol::Tag => {
            for corners in [[(-5, -5), (5, 5)], [(-5, 5), (5, -5)]] {
                root.draw(&PathElement::new(corners.map(off), WHITE.stroke_width(5)))?;
                root.draw(&PathElement::new(corners.map(off), colour.stroke_width(3)))?;
            }
            Ok(())
        }
        Symbol::Flag => {
            root.draw(&PathElement::new(
                [(0, 2), (0, -18)].map(off),
                BLACK.stroke_width(2),
            ))?;
            solid(vec![(1, -18), (14, -13), (1, -8)])?;
            root.draw(&Circle::new(at, 3, BLACK.filled()))
        }
    }
}

/// The corners of a star, relative to its centre.
fn star(radius: f64) -> Vec<(i32, i32)> {
    let corner = |i: i32| {
        let (sin, cos) = math::sin_cos_deg(36.0 * f64::from(i));
        let radius = if i % 2 == 0 { radius } else { 0.45 * radius };
        (
            (radius * sin).round() as i32,
            (-radius * cos).round() as i32,
        )
    };
    (0..10).map(corner).collect()
}

/// Draws names beside the starts on a light background, so that tracks do not hide them.
fn draw_names(root: &Area<'_>, chart: &Chart<'_>, view: &View) -> Drawn {
    for track in chart.tracks.iter().filter(|track| !track.name.is_empty()) {
        let Some(start) = track.places.first() else {
            continue;
        };
        let at = view.pixel(*start);
        // Place the name away from the middle of the field, where there are fewer tracks, and away
        // from the edge, where space ends.
        let is_right = start.east > 0.5 * (view.east_m.0 + view.east_m.1);
        let (side, x) = if is_right {
            (HPos::Right, at.0 - 11)
        } else {
            (HPos::Left, at.0 + 11)
        };
        let wide = 8 + 7 * track.name.chars().count() as i32;
        let left = if is_right { x - wide } else { x };
        let ground = Rectangle::new(
            [(left - 1, at.1 - 9), (left + wide, at.1 + 8)],
            WHITE.mix(0.75).filled(),
        );
        root.draw(&ground)?;
        let x = if is_right { x - 3 } else { x + 3 };
        let style = (FONT, 14)
            .into_font()
            .color(&BLACK)
            .pos(Pos::new(side, VPos::Center));
        root.draw(&Text::new(track.name.clone(), (x, at.1), style))?;
    }
    Ok(())
}

fn draw_legend(root: &Area<'_>, chart: &Chart<'_>, view: &View) -> Drawn {
    let y = (TITLE + view.water.1 + LABELS.1 + BELOW / 2) as i32;
    let mut x = (MARGIN + LABELS.0) as i32;
    let name = |text: &str, x: i32| {
        let style = (FONT, 14)
            .into_font()
            .color(&BLACK)
            .pos(Pos::new(HPos::Left, VPos::Center));
        root.draw(&Text::new(text.to_owned(), (x, y), style))
    };
    let width = |text: &str| 8 * text.chars().count() as i32;
    for (i, team) in chart.teams.iter().enumerate() {
        root.draw(&PathElement::new(
            [(x, y), (x + 22, y)],
            colour::of_team(i).stroke_width(3),
        ))?;
        name(team, x + 28)?;
        x += 28 + width(team) + 18;
    }
    for (symbol, text) in LEGEND {
        let middle = if symbol == Symbol::Flag { y + 8 } else { y };
        draw_symbol(root, symbol, (x + 7, middle), GREY)?;
        name(text, x + 24)?;
        x += 24 + width(text) + 18;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rules::field::{Plan, Walls};

    fn field(along_deg: f64) -> Field {
        Field::new(Plan {
            name: "test".into(),
            datum: primitives::LatLon::default(),
            corner: Ned::default(),
            along_deg,
            width_m: 160.0,
            depth_m: 80.0,
            flag_inset_m: 20.0,
            extra_flags: vec![],
            obstacles: vec![Obstacle::Circle {
                centre: Ned::from_xy(80.0, 40.0),
                radius_m: 5.0,
            }],
            walls: Walls::None,
        })
    }

    fn chart(field: &Field, places: Vec<Ned>) -> Chart<'_> {
        let spots = places.last().map(|at| Spot {
            symbol: Symbol::Capture,
            at: *at,
            team: 0,
        });
        Chart {
            title: "a game".into(),
            field,
            teams: vec!["blue".into(), "red".into()],
            spots: spots.into_iter().collect(),
            tracks: vec![Track {
                name: "blue_one".into(),
                colour: colour::of_team(0),
                places,
            }],
        }
    }

    #[test]
    fn a_metre_is_as_long_either_way_and_everything_is_shown() {
        for along_deg in [90.0, 20.0, 0.0] {
            let field = field(along_deg);
            let chart = chart(
                &field,
                vec![Ned::from_xy(-50.0, 10.0), Ned::from_xy(200.0, 10.0)],
            );
            let view = View::of(&chart);
            let (wide, high) = view.size();
            for place in field.corners.iter().chain(&chart.tracks[0].places) {
                let (x, y) = view.pixel(*place);
                assert!(
                    (0..wide as i32).contains(&x) && (0..high as i32).contains(&y),
                    "{place:?} at {along_deg}"
                );
            }
            let a = Ned::default();
            let b = Ned::from_xy(100.0, 0.0);
            let c = Ned::from_xy(0.0, 100.0);
            let east = view.pixel(b).0 - view.pixel(a).0;
            let north = view.pixel(a).1 - view.pixel(c).1;
            assert!(
                (east - north).abs() <= 3,
                "{east} and {north} pixels at {along_deg}"
            );
        }
    }

    #[test]
    fn a_chart_has_names_and_a_legend_and_stands_odd_places() {
        let dir = tempfile::tempdir().expect("a temporary directory");
        for places in [
            vec![],
            vec![
                Ned {
                    north: f64::NAN,
                    east: 1.0,
                },
                Ned::from_xy(5.0, 5.0),
            ],
        ] {
            let stem = dir.path().join("tracks");
            let field = field(90.0);
            crate::plot::write_both(&stem, &chart(&field, places)).expect("it can be drawn");
            let svg = std::fs::read_to_string(stem.with_extension("svg")).expect("it is there");
            for text in [
                "a game",
                "blue",
                "red",
                "capture",
                "tagged",
                "x (east) in m",
            ] {
                assert!(svg.contains(text), "{text}");
            }
            assert!(stem.with_extension("png").exists());
        }
    }
}
