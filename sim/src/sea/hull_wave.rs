//! Wave forces and orbital velocities on one kind of hull in the horizontal plane.
//!
//! First order: the water's orbital motion, averaged over the hull, which filters out the waves that are shorter than it
//! is. The average velocity is for the drag, and the average acceleration for the force (mass + added mass) · acceleration:
//! Froude-Krylov and diffraction of waves that are long against the hull (Fossen 2021, ch. 10). The acceleration at the
//! surface is −g times its gradient, so a force by the slope on top of this would count the waves twice.
//!
//! Second order: the drift force, which varies with the groups of waves (Newman 1974).

use super::heading::HeadingTable;
use super::sine::sum;
use super::submergence::{PropellerSums, Submergence};
use super::wave::{LANES, Phases, PlaneWave, WaveField, lanes, side_by_side};
use crate::hull::Planar;
use game::boat::Boat;
use game::frame::Pose;
use wide::f32x4;

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
    rows: Vec<Row>,
    /// Velocity per cosine of the phase in surge and sway; per sine of it in yaw.
    velocity: HeadingTable<3>,
    /// The mean drift force over the sum of c²: surge, sway, and nothing twice.
    drift: HeadingTable<1>,
}

/// Four components side by side: what does not depend on the heading.
#[derive(Clone, Copy, Debug)]
struct Row {
    phases: Phases,
    omega_rad_s: f32x4,
    /// a R.
    reflected_m: f32x4,
}

impl HullWaves {
    /// The waves of `field` on a boat like this in water of this density.
    #[must_use]
    pub fn new(field: &WaveField, boat: &Boat, water_density_kg_m3: f64) -> HullWaves {
        let chunks: Vec<&[PlaneWave]> = field.waves.chunks(LANES).collect();
        let row = |waves: &&[PlaneWave]| Row {
            phases: Phases::new(waves),
            omega_rad_s: side_by_side(waves, |w| w.component.omega_rad_s),
            reflected_m: side_by_side(waves, |w| w.reflected_m(boat.draught_m)),
        };
        let velocity = HeadingTable::new(chunks.len(), |row, heading_rad| {
            let speeds = lanes(chunks[row], |w| orbital_velocity(w, boat, heading_rad));
            let single = |fraction: fn(&Planar) -> f64| f32x4::new(speeds.each_ref().map(|v| fraction(v) as f32));
            [single(|v| v.surge), single(|v| v.sway), single(|v| v.yaw)]
        });
        let reflected_m2: f64 = field.waves.iter().map(|w| w.reflected_m(boat.draught_m)).map(|c| c * c).sum();
        let per_m2 = if reflected_m2 > 0.0 { 1.0 / reflected_m2 } else { 0.0 };
        let drift = HeadingTable::new(1, |_, heading_rad| {
            let mean = field.mean_drift_newton(boat, water_density_kg_m3, heading_rad);
            [f32x4::new([(per_m2 * mean.surge) as f32, (per_m2 * mean.sway) as f32, 0.0, 0.0])]
        });
        HullWaves { rows: chunks.iter().map(row).collect(), velocity, drift }
    }

    /// The waves at a boat.
    #[must_use]
    pub fn at(&self, pose: Pose, time_s: f64) -> WaveSample {
        self.summed(pose, time_s, |_, _, _, _| ())
    }

    /// The waves at a boat, and how much deeper than in calm water its propellers are, m.
    #[must_use]
    pub fn at_with(&self, submergence: &Submergence, pose: Pose, time_s: f64) -> (WaveSample, [f64; 2]) {
        let (mut depths, (lines, _)) = (PropellerSums::default(), submergence.lines(pose.psi_rad));
        let sample = self.summed(pose, time_s, |row, fraction, sin, cos| depths.add(&lines[row], fraction, sin, cos));
        (sample, depths.submergence_change_m())
    }

    /// The sum over the components; `also` gets each row's number, the place between two headings, sine and cosine.
    #[inline(always)]
    fn summed(&self, pose: Pose, time_s: f64, mut also: impl FnMut(usize, f32x4, f32x4, f32x4)) -> WaveSample {
        let mut sums = Sums::default();
        let (lines, fraction) = self.velocity.at(pose.psi_rad);
        for (i, (row, lines)) in self.rows.iter().zip(lines).enumerate() {
            let (sin, cos) = row.phases.sin_cos(pose.at, time_s);
            sums.add(row, lines.each_ref().map(|line| line.at_fraction(fraction)), sin, cos);
            also(i, fraction, sin, cos);
        }
        self.sample(&sums, pose.psi_rad)
    }

    #[inline(always)]
    fn sample(&self, sums: &Sums, heading_rad: f64) -> WaveSample {
        let (in_phase, off_phase) = (sum(sums.reflected_cos), sum(sums.reflected_sin));
        let groups_m2 = in_phase * in_phase + off_phase * off_phase;
        let (drift, fraction) = self.drift.at(heading_rad);
        let [surge, sway, ..] = drift[0][0].at_fraction(fraction).to_array().map(|mean| f64::from(mean) * groups_m2);
        WaveSample {
            velocity: Planar { surge: sum(sums.surge), sway: sum(sums.sway), yaw: sum(sums.yaw) },
            acceleration: Planar { surge: sum(sums.surge_rate), sway: sum(sums.sway_rate), yaw: -sum(sums.yaw_fall) },
            drift_newton: Planar { surge, sway, yaw: 0.0 },
        }
    }
}

/// Sums over the components, four side by side.
#[derive(Clone, Copy, Default)]
struct Sums {
    surge: f32x4,
    sway: f32x4,
    yaw: f32x4,
    surge_rate: f32x4,
    sway_rate: f32x4,
    /// The rate of `yaw`, negative.
    yaw_fall: f32x4,
    reflected_sin: f32x4,
    reflected_cos: f32x4,
}

impl Sums {
    /// Adds four components of these velocities. As time goes on the phase falls by ω: (cos)' = ω sin, (sin)' = −ω cos.
    #[inline(always)]
    fn add(&mut self, row: &Row, [surge, sway, yaw]: [f32x4; 3], sin: f32x4, cos: f32x4) {
        let (sin_rate, cos_rate) = (row.omega_rad_s * cos, row.omega_rad_s * sin);
        self.surge += surge * cos;
        self.sway += sway * cos;
        self.yaw += yaw * sin;
        self.surge_rate += surge * cos_rate;
        self.sway_rate += sway * cos_rate;
        self.yaw_fall += yaw * sin_rate;
        self.reflected_sin += row.reflected_m * sin;
        self.reflected_cos += row.reflected_m * cos;
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
