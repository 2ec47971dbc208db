//! Wave forces and orbital velocities on one kind of hull in the horizontal plane.
//!
//! First order: the water's orbital motion, averaged over the hull, which filters out the waves that are shorter than it
//! is. The average velocity is for the drag, and the average acceleration for the force (mass + added mass) · acceleration:
//! Froude-Krylov and diffraction of waves that are long against the hull (Fossen 2021, ch. 10). The acceleration at the
//! surface is −g times its gradient, so a force by the slope on top of this would count the waves twice.
//!
//! Second order: the drift force, which varies with the groups of waves (Newman 1974).

use super::heading::{HeadingTable, Segment};
use super::submergence::{self, Submergence};
use super::wave::{Phases, PlaneWave, WaveField, row_count, row_of, side_by_side, waves_of_row};
use crate::hull::Planar;
use crate::lanes::{FOLD, LANES, Lanes, ROW};
use game::boat::Boat;
use game::frame::Pose;
use game::instructions::{Instructions, Kernel};

/// The waves at one hull, in its own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WaveSample {
    /// Velocity of the water, averaged over the hull, and the rate at which it turns (m/s, m/s, rad/s).
    pub velocity: Planar,
    /// Its rate of change at a fixed place (m/s², m/s², rad/s²).
    pub acceleration: Planar,
    /// Second-order force (N, N, N m). It has no moment.
    pub drift_newton: Planar,
}

/// The waves of a field, averaged over one kind of hull.
///
/// A component's direction from the bow enters through the heading only, so everything that takes more than a product
/// is looked up by heading. The drift force is that of Newman's approximation,
///
/// ```text
/// F = (mean F) |sum c e^(i theta)|^2 / sum c^2        c = a R
/// ```
///
/// whose mean over time is the mean drift force exactly. In long-crested waves this is |sum a sqrt(T) e^(i theta)|²;
/// where they spread, the groups set the size, and the mean over the directions the direction.
#[derive(Clone, Debug)]
pub struct HullWaves {
    instructions: Instructions,
    blocks: Vec<Block>,
    /// For each component, velocity per cosine of the phase in surge and sway, per sine of it in yaw; and a R, which does not
    /// depend on the heading.
    lines: HeadingTable,
    /// The mean drift force over the sum of c²: surge, sway, and nothing twice.
    drift: HeadingTable,
}

/// Sixteen components side by side: what does not depend on the heading.
#[derive(Clone, Copy, Debug)]
struct Block {
    phases: Phases,
    rows: [Row; FOLD],
}

/// The factors on the cosine and on the sine of the phase, of four components, for each of the four numbers of a line. As
/// time goes on the phase falls by ω: (cos)' = ω sin, (sin)' = −ω cos.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Surge, sway, fall of yaw's rate, drift in phase.
    of_cos: Lanes<f32>,
    /// Rates of surge and sway, yaw, drift a quarter turn off.
    of_sin: Lanes<f32>,
}

impl Row {
    fn new(waves: &[PlaneWave]) -> Row {
        let (one, omega_rad_s) = ([1.0; ROW], row_of(waves, |w| w.component.omega_rad_s));
        Row {
            of_cos: Lanes::of_row([one, one, omega_rad_s, one]),
            of_sin: Lanes::of_row([omega_rad_s, omega_rad_s, one, one]),
        }
    }
}

impl HullWaves {
    /// The waves of `field` on a boat like this in water of this density.
    #[must_use]
    pub fn new(field: &WaveField, boat: &Boat, water_density_kg_m3: f64) -> HullWaves {
        let block = |waves: &[PlaneWave]| Block {
            phases: Phases::new(waves),
            rows: std::array::from_fn(|row| Row::new(waves_of_row(waves, row))),
        };
        let lines = HeadingTable::new(row_count(&field.waves), |row, heading_rad| {
            let waves = waves_of_row(&field.waves, row);
            let speeds: [Planar; ROW] = side_by_side(waves, |w| orbital_velocity(w, boat, heading_rad));
            let single = |part: fn(&Planar) -> f64| speeds.each_ref().map(|v| part(v) as f32);
            let reflected_m = row_of(waves, |w| w.reflected_m(boat.draught_m));
            [single(|v| v.surge), single(|v| v.sway), single(|v| v.yaw), reflected_m]
        });
        let reflected_m2: f64 = field.waves.iter().map(|w| w.reflected_m(boat.draught_m)).map(|c| c * c).sum();
        let per_m2 = if reflected_m2 > 0.0 { 1.0 / reflected_m2 } else { 0.0 };
        let drift = HeadingTable::new(1, |_, heading_rad| {
            let mean = field.mean_drift_newton(boat, water_density_kg_m3, heading_rad);
            let mut numbers = [[0.0; ROW]; FOLD];
            (numbers[0][0], numbers[1][0]) = ((per_m2 * mean.surge) as f32, (per_m2 * mean.sway) as f32);
            numbers
        });
        let blocks = field.waves.chunks(LANES).map(block).collect();
        HullWaves { instructions: field.instructions, blocks, lines, drift }
    }

    pub(super) fn set_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// The waves at a boat.
    #[must_use]
    pub fn at(&self, pose: Pose, time_s: f64) -> WaveSample {
        self.sample(&self.instructions.run(At { waves: self, pose, time_s }), pose.psi_rad)
    }

    /// The waves at a boat, and how much deeper than in calm water its propellers are, m.
    #[must_use]
    pub fn at_with(&self, submergence: &Submergence, pose: Pose, time_s: f64) -> (WaveSample, [f64; 2]) {
        let (sums, change_m) = self.instructions.run(AtWith { waves: self, submergence, pose, time_s });
        (self.sample(&sums, pose.psi_rad), [change_m.sum(0), change_m.sum(1)])
    }

    /// The sums over the components, and those of the submergence whose lines are given.
    #[inline(always)]
    fn sums(&self, submergence: Option<&[Segment]>, pose: Pose, time_s: f64) -> (Sums, Lanes<f32>) {
        let mut sums = Sums { of_cos: Lanes::splat(0.0), of_sin: Lanes::splat(0.0) };
        let mut change_m = Lanes::splat(0.0);
        let (lines, fraction) = self.lines.at(pose.psi_rad);
        for (n, (block, lines)) in self.blocks.iter().zip(lines.as_chunks::<FOLD>().0).enumerate() {
            let (sin, cos) = block.phases.sin_cos(pose.at, time_s);
            for (i, (row, line)) in block.rows.iter().zip(lines).enumerate() {
                let (line, sin, cos) = (line.at_fraction(fraction), sin.row(i), cos.row(i));
                sums.of_cos += line * (row.of_cos * cos);
                sums.of_sin += line * (row.of_sin * sin);
                if let Some(lines) = submergence {
                    submergence::add(&mut change_m, lines[FOLD * n + i].at_fraction(fraction), sin, cos);
                }
            }
        }
        (sums, change_m)
    }

    fn sample(&self, Sums { of_cos, of_sin }: &Sums, heading_rad: f64) -> WaveSample {
        let (in_phase, off_phase) = (of_cos.sum(3), of_sin.sum(3));
        let groups_m2 = in_phase * in_phase + off_phase * off_phase;
        let (drift, fraction) = self.drift.at(heading_rad);
        let mean = drift[0].at_fraction(fraction);
        let [surge, sway] = [mean.0[0], mean.0[ROW]].map(|mean| f64::from(mean) * groups_m2);
        WaveSample {
            velocity: Planar { surge: of_cos.sum(0), sway: of_cos.sum(1), yaw: of_sin.sum(2) },
            acceleration: Planar { surge: of_sin.sum(0), sway: of_sin.sum(1), yaw: -of_cos.sum(2) },
            drift_newton: Planar { surge, sway, yaw: 0.0 },
        }
    }
}

/// Sums over the rows: the numbers of [`Row`].
struct Sums {
    of_cos: Lanes<f32>,
    of_sin: Lanes<f32>,
}

/// [`HullWaves::at`], but for what is done with the sums: done here, it would decide how these lie in the registers.
struct At<'a> {
    waves: &'a HullWaves,
    pose: Pose,
    time_s: f64,
}

impl Kernel for At<'_> {
    type Output = Sums;

    #[inline(always)]
    fn run(self) -> Sums {
        self.waves.sums(None, self.pose, self.time_s).0
    }
}

/// The same of [`HullWaves::at_with`].
struct AtWith<'a> {
    waves: &'a HullWaves,
    submergence: &'a Submergence,
    pose: Pose,
    time_s: f64,
}

impl Kernel for AtWith<'_> {
    type Output = (Sums, Lanes<f32>);

    #[inline(always)]
    fn run(self) -> (Sums, Lanes<f32>) {
        self.waves.sums(Some(self.submergence.lines(self.pose.psi_rad)), self.pose, self.time_s)
    }
}

/// Orbital velocity of a wave at half the draught, averaged over the hull as a rectangle of its length and beam: per
/// cosine of the phase amidships in surge and sway, and per sine of it in yaw.
///
/// Yaw is the rate at which a rigid line along the hull turns that has the same first moment of the transverse
/// velocity, the mean of x v over the mean of x².
pub(super) fn orbital_velocity(wave: &PlaneWave, boat: &Boat, heading_rad: f64) -> Planar {
    let patch = Patch::new(wave, boat, heading_rad);
    let component = &wave.component;
    let speed_m_s = component.amplitude_m * component.omega_rad_s * wave.orbital_at(0.5 * boat.draught_m);
    Planar {
        surge: speed_m_s * patch.ahead * patch.mean_x * patch.mean_y,
        sway: speed_m_s * patch.starboard * patch.mean_x * patch.mean_y,
        yaw: -speed_m_s * patch.starboard * patch.tilt_x * patch.mean_y,
    }
}

/// A plane wave under a rectangle, length by beam.
pub(super) struct Patch {
    /// The wave's travel in the boat's axes: a unit vector.
    pub(super) ahead: f64,
    pub(super) starboard: f64,
    /// What is left of it in the mean over the length, and over the beam.
    pub(super) mean_x: f64,
    pub(super) mean_y: f64,
    /// The slope of the straight line that fits it best over the length and over the beam, per −sine of the phase, 1/m.
    pub(super) tilt_x: f64,
    pub(super) tilt_y: f64,
}

impl Patch {
    pub(super) fn new(wave: &PlaneWave, boat: &Boat, heading_rad: f64) -> Patch {
        let (starboard, ahead) = libm::sincos(wave.component.toward_rad - heading_rad);
        let (k_x, k_y) = (wave.wavenumber_rad_m * ahead, wave.wavenumber_rad_m * starboard);
        let (x, y) = (0.5 * k_x * boat.length_m, 0.5 * k_y * boat.beam_m);
        Patch { ahead, starboard, mean_x: mean(x), mean_y: mean(y), tilt_x: k_x * tilt(x), tilt_y: k_y * tilt(y) }
    }
}

/// The mean of cos over −`half_rad` to `half_rad`: sin u / u.
fn mean(half_rad: f64) -> f64 {
    if half_rad.abs() < 1e-4 { 1.0 - half_rad * half_rad / 6.0 } else { libm::sin(half_rad) / half_rad }
}

/// The slope of the line that fits sin best over −`half_rad` to `half_rad`: 3 (sin u − u cos u) / u³.
fn tilt(half_rad: f64) -> f64 {
    let u = half_rad;
    if u.abs() < 0.01 {
        return 1.0 - u * u / 10.0;
    }
    let (sin, cos) = libm::sincos(u);
    3.0 * (sin - u * cos) / (u * u * u)
}
