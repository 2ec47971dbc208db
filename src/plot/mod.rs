//! Plots as SVG files: panels with axes and units, each with a few lines and a legend.

mod axis;
pub(crate) mod gap;
pub(crate) mod sea;
pub(crate) mod trial;

use crate::output_file;
use crate::plot::axis::Axis;
use anyhow::Context;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// A page of panels.
pub(crate) struct Page {
    /// The title above the page.
    pub(crate) title: String,
    /// Panels per row.
    pub(crate) columns: usize,
    /// Width and height of one panel, pixels.
    pub(crate) panel: (u32, u32),
    /// Panels in row order.
    pub(crate) panels: Vec<Panel>,
}

/// One diagram with lines.
pub(crate) struct Panel {
    /// The title of the panel.
    pub(crate) title: &'static str,
    /// Name and unit along the horizontal axis.
    pub(crate) x: &'static str,
    /// Name and unit along the vertical axis.
    pub(crate) y: &'static str,
    /// Whether both axes have the same scale, for maps.
    pub(crate) equal: bool,
    /// The lines to draw.
    pub(crate) lines: Vec<Line>,
    /// The message shown if there are no lines.
    pub(crate) absent: &'static str,
    /// Named points in the panel.
    pub(crate) marks: Vec<Mark>,
}

impl Panel {
    fn coloured(&self) -> impl Iterator<Item = (&Line, RGBColor)> {
        self.lines.iter().zip(COLOURS.iter().copied().cycle())
    }

    /// A panel with these lines, independent axes and no marks. Without lines it shows the message
    /// `absent`.
    pub(crate) fn of(
        title: &'static str,
        [x, y]: [&'static str; 2],
        lines: Vec<Line>,
        absent: &'static str,
    ) -> Panel {
        Panel {
            title,
            x,
            y,
            equal: false,
            lines,
            absent,
            marks: vec![],
        }
    }
}

/// A line through points, with a gap at every non-finite number.
#[derive(Default)]
pub(crate) struct Line {
    /// The line's name in the legend; an unnamed line is not listed.
    pub(crate) name: String,
    /// Points: horizontal and vertical value.
    pub(crate) points: Vec<(f64, f64)>,
    /// Whether the area between the line and 0 is filled.
    pub(crate) filled: bool,
}

/// A named dot.
pub(crate) struct Mark {
    /// The name beside the dot.
    pub(crate) name: String,
    /// Horizontal and vertical value.
    pub(crate) at: (f64, f64),
}

impl Line {
    /// An unfilled line.
    pub(crate) fn of(name: &str, points: Vec<(f64, f64)>) -> Line {
        Line {
            name: name.into(),
            points,
            ..Line::default()
        }
    }
}

/// The usual size of a panel, pixels.
pub(crate) const PANEL: (u32, u32) = (560, 400);
const TITLE_HEIGHT: u32 = 44;
const FONT: &str = "sans-serif";
const CAPTION: (&str, u32) = (FONT, 16);
/// Left edge of a panel's title, height of a title row, and length of a line sample in the legend,
/// pixels.
const HEADER_LEFT: i32 = 76;
const HEADER_ROW: i32 = 22;
const KEY: i32 = 18;
/// Opacity of filled areas.
const FILLING: f64 = 0.25;
/// Colours that people with any kind of colour vision can distinguish (Okabe and Ito 2008).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

/// A part of the drawing; the program draws only SVG.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

type Drawn<T = ()> = Result<T, DrawingAreaErrorKind<std::io::Error>>;

impl Page {
    /// Writes the page to a file.
    pub(crate) fn write(&self, path: &Path) -> anyhow::Result<()> {
        let svg = self.svg().context("cannot draw");
        output_file::write(
            path,
            "the plot",
            svg.with_context(|| path.display().to_string())?,
        )
    }

    fn svg(&self) -> Drawn<String> {
        let mut svg = String::new();
        provide_font();
        let rows = self.panels.len().div_ceil(self.columns);
        let size = (
            self.panel.0 * self.columns as u32,
            TITLE_HEIGHT + self.panel.1 * rows as u32,
        );
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        let (top, rest) = root.split_vertically(TITLE_HEIGHT);
        top.draw(&Text::new(
            self.title.clone(),
            (24, 14),
            (FONT, 20).into_font(),
        ))?;
        let areas = rest.split_evenly((rows, self.columns));
        for (area, panel) in areas.iter().zip(&self.panels) {
            if panel.lines.is_empty() {
                draw_absent(area, panel)?;
            } else {
                draw_lines(area, panel)?;
            }
        }
        root.present()?;
        drop((root, top, rest, areas));
        Ok(svg)
    }
}

fn draw_lines(area: &Area<'_>, panel: &Panel) -> Drawn {
    let area = draw_header(area, panel)?;
    let ((x0, x1), (y0, y1)) = ranges(panel, area.dim_in_pixel());
    let x_axis = Axis::new(panel.x, (x0, x1));
    let y_axis = Axis::new(panel.y, (y0, y1));
    let x_places = x_axis.places;
    let y_places = y_axis.places;
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .margin_top(0)
        .margin_right(24)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(x_axis, y_axis)?;
    chart
        .configure_mesh()
        .x_desc(panel.x)
        .y_desc(panel.y)
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(222, 222, 222))
        .x_label_formatter(&|x| primitives::math::decimal(*x, x_places))
        .y_label_formatter(&|y| primitives::math::decimal(*y, y_places))
        .draw()?;
    for (line, colour) in panel.coloured() {
        for piece in pieces(&line.points) {
            if line.filled {
                chart.draw_series([Polygon::new(down_to_0(piece), colour.mix(FILLING))])?;
            }
            chart.draw_series(LineSeries::new(
                piece.iter().copied(),
                colour.stroke_width(2),
            ))?;
        }
    }
    let rises = rises(&panel.marks);
    for mark in panel
        .marks
        .iter()
        .filter(|mark| mark.at.0.is_finite() && mark.at.1.is_finite())
    {
        // Put the name on the side with more space, and away from the line between marks.
        let (side, right) = if mark.at.0 > 0.5 * (x0 + x1) {
            (HPos::Right, -1)
        } else {
            (HPos::Left, 1)
        };
        let style = (FONT, 12)
            .into_font()
            .into_text_style(&area)
            .pos(Pos::new(side, VPos::Center));
        let name = Text::new(
            mark.name.clone(),
            (7 * right, if rises { 6 * right } else { -6 * right }),
            style,
        );
        chart.draw_series([EmptyElement::at(mark.at)
            + Circle::new((0, 0), 3, BLACK.filled())
            + name])?;
    }
    Ok(())
}

/// Draws the title and the names of the lines, beside it or in rows below; returns the rest of the
/// area.
fn draw_header<'a>(area: &Area<'a>, panel: &Panel) -> Drawn<Area<'a>> {
    let style = (FONT, 12)
        .into_font()
        .into_text_style(area)
        .pos(Pos::new(HPos::Left, VPos::Center));
    let left = HEADER_LEFT;
    let right = area.dim_in_pixel().0 as i32 - 24;
    let title = CAPTION
        .into_font()
        .into_text_style(area)
        .pos(Pos::new(HPos::Left, VPos::Center));
    let mut at = left + area.estimate_text_size(panel.title, &title)?.0 as i32 + 32;
    let mut rows = 0;
    let mut places = vec![];
    let named = || {
        panel
            .coloured()
            .filter(|(line, _)| !line.name.is_empty() && !pieces(&line.points).is_empty())
    };
    for (line, _) in named() {
        let width = KEY + 6 + area.estimate_text_size(&line.name, &style)?.0 as i32;
        if at > left && at + width > right {
            (at, rows) = (left, rows + 1);
        }
        places.push((at, HEADER_ROW * rows + HEADER_ROW / 2 + 4));
        at += width + 20;
    }
    area.draw(&Text::new(panel.title, (left, HEADER_ROW / 2 + 4), title))?;
    for ((line, colour), (x, y)) in named().zip(places) {
        area.draw(&PathElement::new(
            [(x, y), (x + KEY, y)],
            colour.stroke_width(2),
        ))?;
        area.draw(&Text::new(
            line.name.clone(),
            (x + KEY + 6, y),
            style.clone(),
        ))?;
    }
    Ok(area.split_vertically(HEADER_ROW * (rows + 1) + 12).1)
}

/// Draws a panel that has no data.
fn draw_absent(area: &Area<'_>, panel: &Panel) -> Drawn {
    let area = area.margin(12, 12, 12, 24).titled(panel.title, CAPTION)?;
    let (wide, high) = area.dim_in_pixel();
    let frame = RGBColor(222, 222, 222).stroke_width(1);
    area.draw(&Rectangle::new(
        [(0, 0), (wide as i32 - 1, high as i32 - 1)],
        frame,
    ))?;
    let style = CAPTION
        .into_font()
        .color(&RGBColor(120, 120, 120))
        .pos(Pos::new(HPos::Center, VPos::Center));
    area.draw(&Text::new(
        panel.absent,
        (wide as i32 / 2, high as i32 / 2),
        style,
    ))
}

/// The horizontal and vertical range of a panel.
fn ranges(panel: &Panel, size: (u32, u32)) -> ((f64, f64), (f64, f64)) {
    let (mut x0, mut x1) = extent(panel, panel.x, |p| p.0);
    let (mut y0, mut y1) = extent(panel, panel.y, |p| p.1);
    if panel.equal {
        // The size of the panel without the labels.
        let wide = f64::from(size.0) - 100.0;
        let high = f64::from(size.1) - 52.0;
        let metres_per_pixel = f64::max((x1 - x0) / wide, (y1 - y0) / high);
        (x0, x1) = about_middle(x0, x1, wide * metres_per_pixel);
        (y0, y1) = about_middle(y0, y1, high * metres_per_pixel);
    }
    ((x0, x1), (y0, y1))
}

/// Whether the marks rise from left to right.
fn rises(marks: &[Mark]) -> bool {
    let (Some(first), Some(last)) = (marks.first(), marks.last()) else {
        return true;
    };
    (last.at.0 - first.at.0) * (last.at.1 - first.at.1) >= 0.0
}

/// The outline of the area between a line and 0.
fn down_to_0(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let ends = [points.last(), points.first()];
    points
        .iter()
        .copied()
        .chain(ends.into_iter().flatten().map(|end| (end.0, 0.0)))
        .collect()
}

/// The parts of a line between gaps.
fn pieces(points: &[(f64, f64)]) -> Vec<&[(f64, f64)]> {
    points
        .split(|point| !(point.0.is_finite() && point.1.is_finite()))
        .filter(|piece| !piece.is_empty())
        .collect()
}

/// The range of a panel's points in one direction, with a margin. It has a minimum for each unit,
/// so that an error of a millimetre does not look large.
fn extent(panel: &Panel, axis: &str, of: impl Fn(&(f64, f64)) -> f64) -> (f64, f64) {
    let numbers = panel
        .lines
        .iter()
        .flat_map(|line| &line.points)
        .map(of)
        .filter(|number| number.is_finite());
    let (low, high) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), n| {
        (l.min(n), h.max(n))
    });
    if low > high {
        return (0.0, 1.0);
    }
    let least = LEAST
        .iter()
        .find(|(unit, _)| axis == *unit)
        .map_or(0.0, |(_, least)| *least);
    // A constant gets a margin of a tenth of its value on each side; a line that varies only by
    // rounding counts as constant.
    let constant = 0.2
        * if low == 0.0 && high == 0.0 {
            1.0
        } else {
            low.abs().max(high.abs())
        };
    let is_constant = high - low < 1e-6 * constant;
    let wide = (1.1 * (high - low))
        .max(if is_constant { constant } else { 0.0 })
        .max(least);
    about_middle(low, high, wide)
}

/// Minimum range of an axis, by unit.
const LEAST: [(&str, f64); 5] = [
    ("m", 0.2),
    ("m/s", 0.2),
    ("degrees", 2.0),
    ("degrees per s", 1.0),
    ("N", 1.0),
];

/// The range, widened around its middle.
fn about_middle(low: f64, high: f64, width: f64) -> (f64, f64) {
    let middle = 0.5 * (low + high);
    (middle - 0.5 * width, middle + 0.5 * width)
}

/// Registers the font with which the plotting library measures strings.
fn provide_font() {
    let font = epaint_default_fonts::UBUNTU_LIGHT;
    // Registration fails only for an invalid font; then a plot would report it.
    drop(plotters::style::register_font(
        FONT,
        FontStyle::Normal,
        font,
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(points: Vec<(f64, f64)>) -> Page {
        let line = |name: &str| Line {
            name: name.into(),
            points: points.clone(),
            filled: !name.is_empty(),
        };
        let mark = |at: &(f64, f64)| Mark {
            name: "here".into(),
            at: *at,
        };
        let panel = |equal| Panel {
            equal,
            marks: points.iter().map(mark).collect(),
            ..Panel::of(
                "speed",
                ["t in s", "u in m/s"],
                vec![line("surge"), line("")],
                "",
            )
        };
        Page {
            title: "a trial".into(),
            columns: 2,
            panel: PANEL,
            panels: vec![panel(true), panel(false)],
        }
    }

    fn drawn(points: Vec<(f64, f64)>) -> String {
        page(points).svg().expect("it can be drawn")
    }

    #[test]
    fn a_page_has_titles_units_and_a_legend() {
        let svg = drawn(vec![(0.0, 0.0), (1.0, 2.0), (2.0, 3.0)]);
        for text in ["a trial", "speed", "t in s", "u in m/s", "surge", "here"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn odd_numbers_are_drawn_all_the_same() {
        for points in [
            vec![],
            vec![(0.0, f64::NAN)],
            vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0)],
            vec![(0.0, 5.0), (1.0, 5.0 + 1e-13)],
            vec![(0.0, 0.0), (1e9, -1e9)],
        ] {
            assert!(drawn(points.clone()).ends_with("</svg>\n"), "{points:?}");
        }
    }

    #[test]
    fn what_hardly_varies_is_not_blown_up() {
        let range = |y: &'static str, points: &[f64]| {
            let points = points
                .iter()
                .enumerate()
                .map(|(i, y)| (i as f64, *y))
                .collect();
            ranges(
                &Panel::of("", ["time in s", y], vec![Line::of("", points)], ""),
                (500, 300),
            )
            .1
        };
        assert_eq!(range("m", &[0.0, 0.0]), (-0.1 * 1.0, 0.1 * 1.0));
        let (low, high) = range("m/s", &[0.001, -0.001]);
        assert!(low <= -0.1 && high >= 0.1);
        let (low, high) = range("loss", &[3e-4, 1e-4]);
        assert!(
            low > 0.0 && high < 4e-4,
            "a unit without a least width is shown as it is"
        );
        let (low, high) = range("loss", &[5.0, 5.0 + 1e-13]);
        assert!(low < 4.6 && high > 5.4);
    }
}
