//! Horizontal wave forces and orbital velocities on one kind of hull.
//!
//! First order: the water's orbital motion averaged over the hull, which filters out waves shorter
//! than the hull. The average velocity determines the drag, the average acceleration the force
//! (mass + added mass) · acceleration: Froude-Krylov and diffraction of waves long compared with
//! the hull (Fossen 2021, ch. 10). The acceleration at the surface is −g times its gradient, so an
//! additional slope force would count the waves twice.
//!
//! Second order: the drift force, which varies with the groups of waves (Newman 1974).

use super::heading::{HeadingTable, Segment};
use super::patch::{Patch, Patches};
use super::submergence::{self, Submergence};
use super::wave::{Block, PlaneWave, WaveField, blocks, row_count, row_of};
use crate::hull::Planar;
use crate::lanes::{FOLD, Lanes, ROW};
use primitives::frame::Pose;
use primitives::instructions::{Instructions, Kernel};
use scenario::boat::Boat;

/// The waves at one hull, in body axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WaveSample {
    /// Velocity of the water averaged over the hull, and its rate of rotation (m/s, m/s, rad/s).
    pub velocity: Planar,
    /// Rate of change of `velocity` at a fixed place (m/s², m/s², rad/s²).
    pub acceleration: Planar,
    /// Second-order force (N, N, N m), without a moment.
    pub drift_newton: Planar,
}

/// The waves of a field, averaged over one kind of hull.
///
/// The heading alone determines a component's direction from the bow, so everything but the final
/// products is looked up by heading. The drift force is Newman's approximation,
///
/// ```text
/// F = (mean F) |sum c e^(i theta)|^2 / sum c^2        c = a R
/// ```
///
/// whose time average is exactly the mean drift force. In long-crested waves it is |sum a sqrt(T)
/// e^(i theta)|², where a² T is a wave's mean drift force; in spread waves, the groups determine
/// the magnitude and the mean over the directions determines the direction.
#[derive(Clone, Debug)]
pub struct HullWaves {
    instructions: Instructions,
    blocks: Vec<Block<Row>>,
    /// For each component: coefficients of the velocity in surge and sway (of the phase's cosine)
    /// and in yaw (of its sine), and `a R`, which does not depend on the heading.
    lines: HeadingTable,
    /// The mean drift force divided by the sum of c²: surge, sway, and two zeros.
    drift: HeadingTable,
}

/// For four components: factors on the cosine and on the sine of the phase, for each of the four
/// numbers of a line. The phase decreases at the rate ω: (cos)' = ω sin, (sin)' = −ω cos.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Surge, sway, decrease of the yaw rate, drift in phase.
    of_cos: Lanes<f32>,
    /// Rates of surge and sway, yaw, drift in quadrature.
    of_sin: Lanes<f32>,
}

impl Row {
    fn new(waves: &[PlaneWave]) -> Row {
        let one = [1.0; ROW];
        let omega_rad_s = row_of(waves, |w| w.component.omega_rad_s);
        Row {
            of_cos: Lanes::of_row([one, one, omega_rad_s, one]),
            of_sin: Lanes::of_row([omega_rad_s, omega_rad_s, one, one]),
        }
    }
}

impl HullWaves {
    /// The waves of `field` on this boat, in water of this density.
    pub fn new(field: &WaveField, boat: &Boat, water_density_kg_m3: f64) -> HullWaves {
        HullWaves::of(field, boat, water_density_kg_m3, &Patches::new(field, boat))
    }

    /// Like [`HullWaves::new`], from waves that are already averaged.
    pub(super) fn of(
        field: &WaveField,
        boat: &Boat,
        water_density_kg_m3: f64,
        patches: &Patches,
    ) -> HullWaves {
        let speeds_m_s: Vec<f64> = field
            .waves
            .iter()
            .map(|wave| orbital_speed_m_s(wave, boat))
            .collect();
        let reflected_m = field.reflected_m(boat);
        let lines = HeadingTable::new(row_count(&field.waves), |bin, wave| {
            let Some(patch) = patches.of_bin(bin).get(wave) else {
                return [0.0; FOLD];
            };
            let Planar { surge, sway, yaw } = orbital_velocity(speeds_m_s[wave], patch);
            [surge, sway, yaw, reflected_m[wave]]
        });
        let reflected_m2: f64 = reflected_m.iter().map(|c| c * c).sum();
        // Dividing by this sum makes the time average equal to the mean drift in closed form.
        let per_m2 = if reflected_m2 > 0.0 {
            1.0 / reflected_m2
        } else {
            0.0
        };
        let drift = HeadingTable::new(1, |bin, number| {
            if number > 0 {
                return [0.0; FOLD];
            }
            let travels = patches
                .of_bin(bin)
                .iter()
                .map(|patch| (patch.ahead, patch.starboard));
            let mean = field.drift_of(
                boat,
                water_density_kg_m3,
                reflected_m.iter().copied().zip(travels),
            );
            [per_m2 * mean.surge, per_m2 * mean.sway, 0.0, 0.0]
        });
        let blocks = blocks(&field.waves, Row::new);
        HullWaves {
            instructions: field.instructions,
            blocks,
            lines,
            drift,
        }
    }

    pub(super) fn set_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// The waves at a boat.
    pub fn at(&self, pose: Pose, time_s: f64) -> WaveSample {
        self.sample(
            &self.instructions.run(At {
                waves: self,
                pose,
                time_s,
            }),
            pose.psi_rad,
        )
    }

    /// The waves at a boat, and the depth of its propellers minus that in calm water, m.
    pub fn at_with(
        &self,
        submergence: &Submergence,
        pose: Pose,
        time_s: f64,
    ) -> (WaveSample, [f64; 2]) {
        let (sums, change_m) = self.instructions.run(AtWith {
            waves: self,
            submergence,
            pose,
            time_s,
        });
        (
            self.sample(&sums, pose.psi_rad),
            [change_m.sum(0), change_m.sum(1)],
        )
    }

    /// Sums over the components, with those of the submergence if its lines are given.
    #[inline(always)]
    fn sums(&self, submergence: Option<&[Segment]>, pose: Pose, time_s: f64) -> (Sums, Lanes<f32>) {
        let mut sums = Sums {
            of_cos: Lanes::splat(0.0),
            of_sin: Lanes::splat(0.0),
        };
        let mut change_m = Lanes::splat(0.0);
        let (lines, fraction) = self.lines.at(pose.psi_rad);
        for (n, (block, lines)) in self
            .blocks
            .iter()
            .zip(lines.as_chunks::<FOLD>().0)
            .enumerate()
        {
            // Evaluated at the boat's position, which yields the frequency of encounter. Adding
            // that frequency explicitly would pair it with the wrong wavenumber.
            let (sin, cos) = block.phases.sin_cos(pose.at, time_s);
            for (i, (row, line)) in block.rows.iter().zip(lines).enumerate() {
                let line = line.at_fraction(fraction);
                let sin = sin.row(i);
                let cos = cos.row(i);
                sums.of_cos += line * (row.of_cos * cos);
                sums.of_sin += line * (row.of_sin * sin);
                if let Some(lines) = submergence {
                    submergence::add(
                        &mut change_m,
                        lines[FOLD * n + i].at_fraction(fraction),
                        sin,
                        cos,
                    );
                }
            }
        }
        (sums, change_m)
    }

    fn sample(&self, Sums { of_cos, of_sin }: &Sums, heading_rad: f64) -> WaveSample {
        let in_phase = of_cos.sum(3);
        let off_phase = of_sin.sum(3);
        // The squared envelope: in Newman's approximation, drift follows the wave groups.
        let groups_m2 = in_phase * in_phase + off_phase * off_phase;
        let (drift, fraction) = self.drift.at(heading_rad);
        let mean = drift[0].at_fraction(fraction);
        let [surge, sway] = [mean.0[0], mean.0[ROW]].map(|mean| f64::from(mean) * groups_m2);
        WaveSample {
            velocity: Planar {
                surge: of_cos.sum(0),
                sway: of_cos.sum(1),
                yaw: of_sin.sum(2),
            },
            acceleration: Planar {
                surge: of_sin.sum(0),
                sway: of_sin.sum(1),
                yaw: -of_cos.sum(2),
            },
            drift_newton: Planar {
                surge,
                sway,
                yaw: 0.0,
            },
        }
    }
}

/// Sums over the rows, named as in [`Row`].
struct Sums {
    of_cos: Lanes<f32>,
    of_sin: Lanes<f32>,
}

/// The part of [`HullWaves::at`] that computes the sums. Building the sample here would affect
/// register allocation.
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

/// Like [`At`], for [`HullWaves::at_with`].
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
        self.waves.sums(
            Some(self.submergence.lines(self.pose.psi_rad)),
            self.pose,
            self.time_s,
        )
    }
}

/// The amplitude of a wave's orbital velocity at half the draught, m/s.
pub(super) fn orbital_speed_m_s(wave: &PlaneWave, boat: &Boat) -> f64 {
    wave.component.amplitude_m * wave.component.omega_rad_s * wave.orbital_at(0.5 * boat.draught_m)
}

/// Orbital velocity with this amplitude, averaged over a rectangle of the hull's length and beam:
/// the coefficients of the cosine of the phase amidships for surge and sway, and of its sine for
/// yaw.
///
/// Yaw is the rotation rate of a rigid line along the hull with the same first moment of the
/// transverse velocity: the mean of x v over the mean of x².
pub(super) fn orbital_velocity(speed_m_s: f64, patch: &Patch) -> Planar {
    Planar {
        surge: speed_m_s * patch.ahead * patch.mean_x * patch.mean_y,
        sway: speed_m_s * patch.starboard * patch.mean_x * patch.mean_y,
        yaw: -speed_m_s * patch.starboard * patch.tilt_x * patch.mean_y,
    }
}
