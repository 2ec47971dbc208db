//! Polar plots of a helm's objective functions: coloured discs with north on top.

use super::heat;
use crate::plot::{self, Area, Diagram, Drawn};
use game::math;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A disc: course as its angle, clockwise from north, speed as its radius, colour as the value.
pub(crate) struct PolarPlot {
    /// What it shows.
    pub(crate) title: String,
    /// How many courses there are.
    pub(crate) courses: usize,
    /// The highest speed, m/s.
    pub(crate) speed_max_m_s: f64,
    /// A row of speeds for each course.
    pub(crate) values: Vec<f64>,
    /// The values at the ends of the colour scale.
    pub(crate) range: (f64, f64),
    /// The chosen course, compass degrees, and speed, m/s.
    pub(crate) chosen: Option<(f64, f64)>,
}

/// Size of a panel, pixels.
pub(crate) const PANEL: (u32, u32) = (520, 500);
/// The middle of the disc in its panel, and the radius of the highest speed.
const MIDDLE: (f64, f64) = (225.0, 268.0);
const RADIUS: f64 = 180.0;
/// The colour scale: left and right edge, top and bottom.
const SCALE: [i32; 4] = [444, 460, 88, 448];
/// The side of a square of one colour, pixels.
const GRAIN: i32 = 2;
/// Steps of the colour scale.
const SHADES: usize = 64;
const GREY: RGBColor = RGBColor(90, 90, 90);

/// How many stand beside each other at most.
pub(crate) const COLUMNS_MAX: usize = 3;

impl Diagram for PolarPlot {
    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        area.draw(&Text::new(self.title.clone(), (24, 12), (plot::FONT, 15).into_font()))?;
        draw_disc(area, self)?;
        draw_axes(area, self)?;
        draw_scale(area, self)?;
        let Some((course_deg, speed_m_s)) = self.chosen else { return Ok(()) };
        let at = place(course_deg, RADIUS * speed_m_s / self.speed_max_m_s);
        area.draw(&Circle::new(at, 8, BLACK.filled()))?;
        area.draw(&Circle::new(at, 6, WHITE.filled()))?;
        area.draw(&Circle::new(at, 3, BLACK.filled()))
    }
}

/// The disc, row by row of its grains, each a few stretches of one colour. Stretches reach a pixel under those that are drawn after them,
/// so that no gap shows.
fn draw_disc<B: DrawingBackend>(area: &Area<B>, plot: &PolarPlot) -> Drawn<B> {
    let grain = GRAIN;
    let rim = rim(plot);
    let (x0, y0) = place(0.0, 0.0);
    let rows = (rim.ceil() as i32) / grain;
    for row in -rows..=rows {
        let y = row * grain;
        let half = ((rim * rim - f64::from(y * y)).max(0.0).sqrt().floor() as i32) / grain;
        let value = |i: i32| value_at(plot, i * grain, y);
        let shades: Vec<usize> = (-half..=half).map(|i| shade(value(i), plot.range)).collect();
        let mut x = x0 - half * grain;
        for stretch in shades.chunk_by(|a, b| a == b) {
            let right = x + stretch.len() as i32 * grain;
            let under = grain - 1;
            let corners = [(x, y0 + y), (right + under, y0 + y + grain + under)];
            area.draw(&Rectangle::new(corners, colour_of(stretch[0]).filled()))?;
            x = right;
        }
    }
    Ok(())
}

/// The radius of the disc: half a step more than that of the highest speed.
fn rim(plot: &PolarPlot) -> f64 {
    let speeds = plot.values.len() / plot.courses;
    RADIUS * (1.0 + 0.5 / (speeds - 1) as f64)
}

/// The value of the course and speed nearest to a place, in pixels right and down of the middle.
fn value_at(plot: &PolarPlot, x: i32, y: i32) -> f64 {
    let speeds = plot.values.len() / plot.courses;
    let turn = math::atan2(f64::from(x), f64::from(-y)) / std::f64::consts::TAU;
    let course = (turn.rem_euclid(1.0) * plot.courses as f64).round() as usize % plot.courses;
    let speed = math::length(f64::from(x), f64::from(y)) / RADIUS * (speeds - 1) as f64;
    plot.values[course * speeds + (speed.round() as usize).min(speeds - 1)]
}

/// Rings of speed and the four quarters of the compass.
fn draw_axes<B: DrawingBackend>(area: &Area<B>, plot: &PolarPlot) -> Drawn<B> {
    let text = |pos, size: u32, colour: &RGBColor| (plot::FONT, size).into_font().color(colour).pos(pos);
    let centre = Pos::new(HPos::Center, VPos::Center);
    let rim = rim(plot);
    area.draw(&Circle::new(place(0.0, 0.0), rim.round() as i32, GREY.stroke_width(1)))?;
    let ring_m_s = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0].into_iter().find(|step| plot.speed_max_m_s / step <= 4.0);
    let ring_m_s = ring_m_s.unwrap_or(0.25 * plot.speed_max_m_s);
    for i in 1..=4 {
        let speed_m_s = f64::from(i) * ring_m_s;
        let radius = RADIUS * speed_m_s / plot.speed_max_m_s;
        if radius > RADIUS + 1.0 {
            break;
        }
        area.draw(&Circle::new(place(0.0, 0.0), radius.round() as i32, WHITE.mix(0.45).stroke_width(1)))?;
        let at = place(45.0, radius);
        let label = format!("{}", (speed_m_s * 100.0).round() / 100.0);
        // A light ground keeps the number readable on every colour.
        area.draw(&Circle::new(at, 8, WHITE.mix(0.75).filled()))?;
        area.draw(&Text::new(label, at, text(centre, 12, &BLACK)))?;
    }
    for (course_deg, name) in [(0.0, "N"), (90.0, "E"), (180.0, "S"), (270.0, "W")] {
        area.draw(&PathElement::new([place(course_deg, rim + 2.0), place(course_deg, rim + 7.0)], GREY))?;
        area.draw(&Text::new(name, place(course_deg, rim + 17.0), text(centre, 14, &GREY)))?;
    }
    let below = (MIDDLE.0 as i32, (MIDDLE.1 + rim) as i32 + 36);
    let name = format!("course, north up; speed from the middle out, to {:.2} m/s", plot.speed_max_m_s);
    area.draw(&Text::new(name, below, text(centre, 12, &GREY)))
}

/// The legend of colours.
fn draw_scale<B: DrawingBackend>(area: &Area<B>, plot: &PolarPlot) -> Drawn<B> {
    let [left, right, top, bottom] = SCALE;
    let y = |share: f64| bottom - (share * f64::from(bottom - top)).round() as i32;
    for i in 0..SHADES {
        let (low, high) = (i as f64 / SHADES as f64, (i + 1) as f64 / SHADES as f64);
        area.draw(&Rectangle::new([(left, y(high)), (right, y(low))], colour_of(i).filled()))?;
    }
    area.draw(&Rectangle::new([(left, top), (right, bottom)], GREY.stroke_width(1)))?;
    let (low, high) = plot.range;
    let places = if high - low >= 20.0 { 0 } else { 2 };
    for i in 0..=4 {
        let share = f64::from(i) / 4.0;
        let style = (plot::FONT, 12).into_font().color(&GREY).pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&PathElement::new([(right, y(share)), (right + 4, y(share))], GREY))?;
        let value = format!("{:.places$}", low + share * (high - low));
        area.draw(&Text::new(value, (right + 8, y(share)), style))?;
    }
    Ok(())
}

/// A place on the disc, in pixels of the panel.
fn place(course_deg: f64, radius: f64) -> (i32, i32) {
    let (sin, cos) = math::sin_cos(course_deg.to_radians());
    ((MIDDLE.0 + radius * sin).round() as i32, (MIDDLE.1 - radius * cos).round() as i32)
}

/// Where a value is on the scale; one that is not a number is at its lower end.
fn shade(value: f64, (low, high): (f64, f64)) -> usize {
    let share = if high > low { (value - low) / (high - low) } else { 0.0 };
    ((share * SHADES as f64) as usize).min(SHADES - 1)
}

fn colour_of(shade: usize) -> RGBColor {
    heat::of_share(shade as f64 / (SHADES - 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{Page, TITLE_HEIGHT};
    use resvg::tiny_skia::Pixmap;

    fn plot(values: Vec<f64>) -> PolarPlot {
        PolarPlot {
            title: "keep_clear: weight 300".into(),
            courses: 36,
            speed_max_m_s: 3.5,
            values,
            range: (0.0, 100.0),
            chosen: Some((90.0, 3.5)),
        }
    }

    /// Red, green and blue at a place of a picture that is one panel wide.
    fn pixel(picture: &Pixmap, at: (i32, i32)) -> [u8; 3] {
        let pixel = picture.pixel(at.0 as u32, at.1 as u32 + TITLE_HEIGHT).expect("it is on the picture");
        [pixel.red(), pixel.green(), pixel.blue()]
    }

    #[test]
    fn north_is_up_east_is_right_and_speed_goes_outwards() {
        let dir = tempfile::tempdir().expect("a temporary directory");
        let (png, svg) = (dir.path().join("plot.png"), dir.path().join("plot.svg"));
        // East at more than half the speed is good, everything else is not.
        let good = |k: usize, j: usize| (6..=12).contains(&k) && j >= 5;
        let values = (0..36 * 8).map(|i| if good(i / 8, i % 8) { 100.0 } else { 0.0 }).collect();
        let page = Page { title: "blue_one".into(), columns: 1, panel: PANEL, panels: vec![plot(values)] };
        plot::write_png(&png, &page).expect("it can be drawn");
        plot::write_svg(&svg, &page).expect("it can be drawn");
        let picture = Pixmap::load_png(&png).expect("it is PNG");
        let (best, worst) = ([253, 231, 37], [68, 1, 84]);
        for (course_deg, speed, want) in
            [(80.0, 0.75, best), (80.0, 0.4, worst), (10.0, 0.75, worst), (190.0, 0.75, worst), (280.0, 0.75, worst)]
        {
            assert_eq!(
                pixel(&picture, place(course_deg, RADIUS * speed)),
                want,
                "{course_deg}° at {speed} of the speed"
            );
        }
        let text = std::fs::read_to_string(&svg).expect("it is there");
        for part in ["blue_one", "keep_clear: weight 300", "#FDE725", "#440154", "3.50 m/s", "\n100\n"] {
            assert!(text.contains(part), "{part}");
        }
    }

    #[test]
    fn odd_values_have_a_colour_too() {
        for value in [f64::NAN, -5.0, 100.0, 1e300, f64::INFINITY] {
            assert!(shade(value, (0.0, 100.0)) < SHADES && shade(value, (1.0, 1.0)) < SHADES);
        }
        assert_eq!(shade(f64::NAN, (0.0, 100.0)), 0);
    }
}
