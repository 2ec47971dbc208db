//! Plots as SVG and PNG files: panels with axes and units, each with a few lines and a legend.

pub(crate) mod colour;
pub(crate) mod field;
pub(crate) mod film;
pub(crate) mod game;
pub(crate) mod polar;
pub(crate) mod sea;
pub(crate) mod training;
pub(crate) mod trial;

use crate::output_file;
use anyhow::Context;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// A page of panels of one kind.
pub(crate) struct Page<P> {
    /// What stands on top.
    pub(crate) title: String,
    /// Panels per row.
    pub(crate) columns: usize,
    /// Width and height of a panel, pixels.
    pub(crate) panel: (u32, u32),
    /// Row by row.
    pub(crate) panels: Vec<P>,
}

/// One diagram with lines.
pub(crate) struct Panel {
    /// What it shows.
    pub(crate) title: String,
    /// Name and unit along the horizontal axis.
    pub(crate) x: String,
    /// Name and unit along the vertical axis.
    pub(crate) y: String,
    /// Whether a metre is as long on both axes: for maps.
    pub(crate) equal: bool,
    /// What is drawn.
    pub(crate) lines: Vec<Line>,
    /// What is said where nothing is drawn.
    pub(crate) absent: &'static str,
    /// Places that are pointed out.
    pub(crate) marks: Vec<Mark>,
}

impl Panel {
    /// A diagram of these lines, with axes of their own and nothing pointed out. Without lines it says what is absent.
    pub(crate) fn of(title: &str, [x, y]: [&str; 2], lines: Vec<Line>, absent: &'static str) -> Panel {
        Panel { title: title.into(), x: x.into(), y: y.into(), equal: false, lines, absent, marks: vec![] }
    }
}

/// A line through points; where a number is not finite it has a gap.
#[derive(Default)]
pub(crate) struct Line {
    /// What the legend calls it; without a name it is not in there.
    pub(crate) name: String,
    /// Horizontal and vertical.
    pub(crate) points: Vec<(f64, f64)>,
    /// Whether what lies between it and 0 is filled.
    pub(crate) filled: bool,
    /// Its colour; none is that of its place among the lines.
    pub(crate) colour: Option<RGBColor>,
}

/// A dot with a name beside it.
pub(crate) struct Mark {
    /// What it is called.
    pub(crate) name: String,
    /// Horizontal and vertical.
    pub(crate) at: (f64, f64),
}

impl Line {
    /// A line with nothing under it.
    pub(crate) fn of(name: &str, points: Vec<(f64, f64)>) -> Line {
        Line { name: name.into(), points, ..Line::default() }
    }
}

/// The usual size of a panel, pixels.
pub(crate) const PANEL: (u32, u32) = (560, 400);
pub(crate) const TITLE_HEIGHT: u32 = 44;
pub(crate) const FONT: &str = "sans-serif";
const CAPTION: (&str, u32) = (FONT, 16);
/// How much of a line's colour is in what it fills.
const FILLING: f64 = 0.25;
/// Colours that people with any colour vision tell apart (Okabe and Ito 2008).
pub(crate) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

/// Where something is drawn.
pub(crate) type Area<B> = DrawingArea<B, Shift>;

/// How lines are made thick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ink {
    /// By their width: a viewer knows what to do at sharp corners.
    Vector,
    /// By lines beside each other: of a series, the library's thick ones stick out at sharp corners, and have gaps.
    Pixels,
}

impl Ink {
    /// How wide a stroke is.
    pub(crate) fn width(self) -> u32 {
        match self {
            Ink::Vector => 2,
            Ink::Pixels => 1,
        }
    }

    /// Where strokes are, pixels right and down.
    pub(crate) fn strokes(self) -> &'static [(i32, i32)] {
        match self {
            Ink::Vector => &[(0, 0)],
            Ink::Pixels => &[(0, 0), (1, 0), (0, 1)],
        }
    }
}

/// Something that can be drawn into a file.
pub(crate) trait Drawing {
    /// Width and height, pixels.
    fn size(&self) -> (u32, u32);

    /// Draws it onto a white ground of this size.
    fn draw<B: DrawingBackend>(&self, root: &Area<B>, ink: Ink) -> Drawn<B>;
}

/// Something that can be drawn onto a part of a page.
pub(crate) trait Diagram {
    /// Draws it onto a white ground of any size.
    fn draw<B: DrawingBackend>(&self, area: &Area<B>, ink: Ink) -> Drawn<B>;
}

/// What comes of drawing.
pub(crate) type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Draws as the text of an SVG.
pub(crate) fn svg(drawing: &impl Drawing) -> anyhow::Result<String> {
    let mut svg = String::new();
    draw_on(SVGBackend::with_string(&mut svg, drawing.size()), drawing, Ink::Vector).context("cannot draw")?;
    Ok(svg)
}

/// Draws into an SVG file.
pub(crate) fn write_svg(path: &Path, drawing: &impl Drawing) -> anyhow::Result<()> {
    let svg = svg(drawing).with_context(|| path.display().to_string())?;
    output_file::write(path, "the plot", svg)
}

/// Draws as pixels, three bytes each: red, green and blue.
pub(crate) fn pixels(drawing: &impl Drawing) -> anyhow::Result<Vec<u8>> {
    let (wide, high) = drawing.size();
    let mut pixels = vec![0; 3 * wide as usize * high as usize];
    draw_on(BitMapBackend::with_buffer(&mut pixels, (wide, high)), drawing, Ink::Pixels).context("cannot draw")?;
    Ok(pixels)
}

/// Draws into a PNG file, three bytes a pixel.
pub(crate) fn write_png(path: &Path, drawing: &impl Drawing) -> anyhow::Result<()> {
    let (wide, high) = drawing.size();
    let pixels = pixels(drawing).with_context(|| path.display().to_string())?;
    let mut file = vec![];
    let mut encoder = png::Encoder::new(&mut file, wide, high);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&pixels)?;
    output_file::write(path, "the plot", file)
}

/// Draws into an SVG and a PNG file of this name.
pub(crate) fn write_both(stem: &Path, drawing: &impl Drawing) -> anyhow::Result<()> {
    write_svg(&stem.with_extension("svg"), drawing)?;
    write_png(&stem.with_extension("png"), drawing)
}

fn draw_on<B: DrawingBackend>(backend: B, drawing: &impl Drawing, ink: Ink) -> Drawn<B> {
    provide_font();
    let root = backend.into_drawing_area();
    root.fill(&WHITE)?;
    drawing.draw(&root, ink)?;
    root.present()
}

impl<P> Page<P> {
    fn rows(&self) -> usize {
        self.panels.len().div_ceil(self.columns)
    }
}

impl<P: Diagram> Drawing for Page<P> {
    fn size(&self) -> (u32, u32) {
        (self.panel.0 * self.columns as u32, TITLE_HEIGHT + self.panel.1 * self.rows() as u32)
    }

    fn draw<B: DrawingBackend>(&self, root: &Area<B>, ink: Ink) -> Drawn<B> {
        let (top, rest) = root.split_vertically(TITLE_HEIGHT);
        top.draw(&Text::new(self.title.clone(), (24, 14), (FONT, 20).into_font()))?;
        let areas = rest.split_evenly((self.rows(), self.columns));
        areas.iter().zip(&self.panels).try_for_each(|(area, panel)| panel.draw(area, ink))
    }
}

impl Diagram for Panel {
    fn draw<B: DrawingBackend>(&self, area: &Area<B>, ink: Ink) -> Drawn<B> {
        if self.lines.is_empty() { draw_absent(area, self) } else { draw_lines(area, self, ink) }
    }
}

fn draw_lines<B: DrawingBackend>(area: &Area<B>, panel: &Panel, ink: Ink) -> Drawn<B> {
    let has_names = panel.lines.iter().any(|line| !line.name.is_empty());
    let ((x0, x1), (y0, y1)) = ranges(panel, has_names, area.dim_in_pixel());
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(24)
        .caption(&panel.title, CAPTION)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(x0..x1, y0..y1)?;
    chart
        .configure_mesh()
        .x_desc(&panel.x)
        .y_desc(&panel.y)
        .axis_desc_style((FONT, 14))
        .label_style((FONT, 12))
        .x_labels(8)
        .y_labels(8)
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(222, 222, 222))
        .x_label_formatter(&|x| label(*x, x1 - x0))
        .y_label_formatter(&|y| label(*y, y1 - y0))
        .draw()?;
    // Tracks turn every way, and the library's thin lines have gaps where they go back.
    let ink = if panel.equal { Ink::Vector } else { ink };
    let (wide, high) = chart.plotting_area().dim_in_pixel();
    let pixel = ((x1 - x0) / f64::from(wide.max(1)), (y0 - y1) / f64::from(high.max(1)));
    for (line, colour) in panel.lines.iter().zip(COLOURS.iter().cycle()) {
        let colour = line.colour.unwrap_or(*colour);
        let style = colour.stroke_width(ink.width());
        for (i, piece) in pieces(&line.points).into_iter().enumerate() {
            if line.filled {
                chart.draw_series([Polygon::new(down_to_0(piece), colour.mix(FILLING))])?;
            }
            for (right, down) in ink.strokes() {
                let beside = (f64::from(*right) * pixel.0, f64::from(*down) * pixel.1);
                let points = piece.iter().map(move |(x, y)| (x + beside.0, y + beside.1));
                let drawn = chart.draw_series(LineSeries::new(points, style))?;
                if i == 0 && (*right, *down) == (0, 0) && !line.name.is_empty() {
                    let key = colour.stroke_width(2);
                    drawn.label(&line.name).legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], key));
                }
            }
        }
    }
    let rises = rises(&panel.marks);
    for mark in panel.marks.iter().filter(|mark| mark.at.0.is_finite() && mark.at.1.is_finite()) {
        // The name goes where there is room for it, and not onto the line from mark to mark.
        let (side, right) = if mark.at.0 > 0.5 * (x0 + x1) { (HPos::Right, -1) } else { (HPos::Left, 1) };
        let style = (FONT, 12).into_font().into_text_style(area).pos(Pos::new(side, VPos::Center));
        let name = Text::new(mark.name.clone(), (7 * right, if rises { 6 * right } else { -6 * right }), style);
        chart.draw_series([EmptyElement::at(mark.at) + Circle::new((0, 0), 3, BLACK.filled()) + name])?;
    }
    if has_names && panel.lines.iter().any(|line| !pieces(&line.points).is_empty()) {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font((FONT, 12))
            .draw()?;
    }
    Ok(())
}

/// A panel of what there is not.
fn draw_absent<B: DrawingBackend>(area: &Area<B>, panel: &Panel) -> Drawn<B> {
    let area = area.margin(12, 12, 12, 24).titled(&panel.title, CAPTION)?;
    let (wide, high) = area.dim_in_pixel();
    let frame = RGBColor(222, 222, 222).stroke_width(1);
    area.draw(&Rectangle::new([(0, 0), (wide as i32 - 1, high as i32 - 1)], frame))?;
    let style = CAPTION.into_font().color(&RGBColor(120, 120, 120)).pos(Pos::new(HPos::Center, VPos::Center));
    area.draw(&Text::new(panel.absent, (wide as i32 / 2, high as i32 / 2), style))
}

/// What a panel shows horizontally and vertically.
fn ranges(panel: &Panel, has_names: bool, size: (u32, u32)) -> ((f64, f64), (f64, f64)) {
    let ((mut x0, mut x1), (mut y0, mut y1)) = (extent(panel, |p| p.0), extent(panel, |p| p.1));
    if panel.equal {
        // What labels and title leave of the panel.
        let (wide, high) = (f64::from(size.0) - 100.0, f64::from(size.1) - 105.0);
        let metres_per_pixel = f64::max((x1 - x0) / wide, (y1 - y0) / high);
        (x0, x1) = about_middle(x0, x1, wide * metres_per_pixel);
        (y0, y1) = about_middle(y0, y1, high * metres_per_pixel);
    } else if has_names {
        // Room for the legend above the lines.
        y1 += 0.25 * (y1 - y0);
    }
    ((x0, x1), (y0, y1))
}

/// Whether marks go up from left to right.
fn rises(marks: &[Mark]) -> bool {
    let (Some(first), Some(last)) = (marks.first(), marks.last()) else { return true };
    (last.at.0 - first.at.0) * (last.at.1 - first.at.1) >= 0.0
}

/// The outline of what lies between a line and 0.
fn down_to_0(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let ends = [points.last(), points.first()];
    points.iter().copied().chain(ends.into_iter().flatten().map(|end| (end.0, 0.0))).collect()
}

/// What can be drawn without gaps.
fn pieces(points: &[(f64, f64)]) -> Vec<&[(f64, f64)]> {
    points.split(|point| !(point.0.is_finite() && point.1.is_finite())).filter(|piece| !piece.is_empty()).collect()
}

/// The range of a panel's points in one direction, with a margin.
fn extent(panel: &Panel, of: impl Fn(&(f64, f64)) -> f64) -> (f64, f64) {
    let numbers = panel.lines.iter().flat_map(|line| &line.points).map(of).filter(|number| number.is_finite());
    let (low, high) = numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), n| (l.min(n), h.max(n)));
    if low > high {
        return (0.0, 1.0);
    }
    // A constant gets a tenth of itself above and below it, and a line of nothing but rounding is a constant.
    let least = (0.1 * low.abs().max(high.abs())).max(1e-3);
    let margin = (0.05 * (high - low)).max(if high - low < 0.01 * least { least } else { 0.0 });
    (low - margin, high + margin)
}

/// The range widened about its middle.
fn about_middle(low: f64, high: f64, width: f64) -> (f64, f64) {
    let middle = 0.5 * (low + high);
    (middle - 0.5 * width, middle + 0.5 * width)
}

/// A number on an axis of this width, with the places that tell its labels apart.
fn label(number: f64, width: f64) -> String {
    // There are up to nine labels at steps of 1, 2 or 5.
    let places = (0..6).find(|places| width >= 5.0 * [1.0, 0.1, 0.01, 0.001, 1e-4, 1e-5][*places]).unwrap_or(6);
    ::game::math::decimal(number, places)
}

/// Gives the plotting library the letters that it measures texts by and draws into pictures.
fn provide_font() {
    let font = epaint_default_fonts::UBUNTU_LIGHT;
    // It cannot fail with a font that is one; a plot without letters would say so itself.
    drop(plotters::style::register_font(FONT, FontStyle::Normal, font));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(points: Vec<(f64, f64)>) -> Page<Panel> {
        let line =
            |name: &str| Line { name: name.into(), points: points.clone(), filled: !name.is_empty(), colour: None };
        let mark = |at: &(f64, f64)| Mark { name: "here".into(), at: *at };
        let panel = |equal| Panel {
            title: "speed".into(),
            x: "t in s".into(),
            y: "u in m/s".into(),
            equal,
            lines: vec![line("surge"), line("")],
            absent: "nothing",
            marks: points.iter().map(mark).collect(),
        };
        Page { title: "a trial".into(), columns: 2, panel: PANEL, panels: vec![panel(true), panel(false)] }
    }

    fn drawn(points: Vec<(f64, f64)>) -> String {
        svg(&page(points))
    }

    fn svg(page: &Page<Panel>) -> String {
        let dir = tempfile::tempdir().expect("a temporary directory");
        let path = dir.path().join("plot.svg");
        write_svg(&path, page).expect("it can be drawn");
        std::fs::read_to_string(path).expect("it is there")
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
    fn a_panel_of_nothing_says_so_under_its_title() {
        let mut page = page(vec![]);
        page.panels[1].lines.clear();
        assert!(svg(&page).contains("nothing") && svg(&page).contains("speed"));
        page.panels.remove(1);
        assert!(!svg(&page).contains("nothing"));
    }

    #[test]
    fn labels_have_the_places_they_need() {
        for (number, width, want) in
            [(3.0, 100.0, "3"), (0.5, 2.0, "0.5"), (-0.0001, 2.0, "0.0"), (0.12, 0.2, "0.12"), (0.05, 0.45, "0.05")]
        {
            assert_eq!(label(number, width), want);
        }
    }
}
