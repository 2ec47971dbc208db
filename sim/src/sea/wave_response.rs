//! Heave, roll and pitch of a hull in waves, for sensors and observers.
//!
//! The hull follows the surface, averaged over its area, like three damped springs. The response
//! does not affect the horizontal motion.

use super::heading::HeadingTable;
use super::patch::{Patch, Patches};
use super::wave::{Block, PlaneWave, WaveField, blocks, row_count, row_of};
use crate::lanes::{FOLD, Lanes, ROW};
use primitives::frame::{Ned, Pose};
use primitives::instructions::{Instructions, Kernel};
use scenario::boat::Boat;

/// Natural frequency, rad/s, and damping ratio: those of the Otter in Fossen's Marine Systems
/// Simulator, and similar for any hull of that length.
pub(super) const HEAVE: (f64, f64) = (7.5, 0.3);
pub(super) const ROLL: (f64, f64) = (7.4, 0.2);
pub(super) const PITCH: (f64, f64) = (8.6, 0.4);

/// Heave, roll and pitch of a hull, and their rates. Angles as in NED: roll is positive with the
/// starboard side down, pitch with the bow up. Heave is the height above the position at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Height, m.
    pub heave_up_m: f64,
    /// Roll, rad.
    pub roll_rad: f64,
    /// Pitch, rad.
    pub pitch_rad: f64,
    /// Rate of heave, m/s.
    pub heave_up_m_s: f64,
    /// Rate of roll, rad/s.
    pub roll_rad_s: f64,
    /// Rate of pitch, rad/s.
    pub pitch_rad_s: f64,
    /// Acceleration of heave, m/s².
    pub heave_up_m_s2: f64,
}

/// The response of one kind of boat to the waves of a field.
///
/// Heave, roll and pitch respond to a wave of frequency ω with wn² / (wn² − ω² + 2 i ζ wn ω) times
/// the plane that best fits the wave pressure at the draught. The frequency is that at a fixed
/// place: the boat's own speed changes the frequency of encounter, but not the response.
#[derive(Clone, Debug)]
pub struct WaveResponse {
    instructions: Instructions,
    blocks: Vec<Block<Row>>,
    /// Coefficients before the springs respond: heave (of the phase's cosine), roll and pitch (of
    /// its sine), and zero.
    quasi_static: HeadingTable,
}

/// The responses in heave, roll and pitch to four components, and zero, as factors on the sine and
/// the cosine of the phase. The phase decreases with time, so a lagging response has a leading
/// phase.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// The response to the cosine of the phase in heave, and to its sine in roll and pitch.
    value: Passed,
    /// Their derivatives with respect to the phase.
    slope: Passed,
}

/// A factor on the sine and one on the cosine.
#[derive(Clone, Copy, Debug)]
struct Passed {
    of_sin: Lanes<f32>,
    of_cos: Lanes<f32>,
}

impl Passed {
    #[inline(always)]
    fn of(&self, sin: Lanes<f32>, cos: Lanes<f32>) -> Lanes<f32> {
        self.of_sin * sin + self.of_cos * cos
    }
}

impl Row {
    fn new(waves: &[PlaneWave]) -> Row {
        let part = |spring: (f64, f64), pick: fn((f64, f64)) -> f64| {
            row_of(waves, |w| {
                pick(transfer(spring.0, spring.1, w.component.omega_rad_s))
            })
        };
        let real = |spring| part(spring, |(real, _)| real);
        let behind = |spring| part(spring, |(_, behind)| behind);
        let minus = |numbers: [f32; ROW]| numbers.map(|number| -number);
        let springs = |heave: [f32; ROW], roll_and_pitch: &dyn Fn((f64, f64)) -> [f32; ROW]| {
            Lanes::of_row([
                heave,
                roll_and_pitch(ROLL),
                roll_and_pitch(PITCH),
                [0.0; ROW],
            ])
        };
        Row {
            value: Passed {
                of_sin: springs(minus(behind(HEAVE)), &real),
                of_cos: springs(real(HEAVE), &behind),
            },
            slope: Passed {
                of_sin: springs(minus(real(HEAVE)), &|spring| minus(behind(spring))),
                of_cos: springs(minus(behind(HEAVE)), &real),
            },
        }
    }
}

/// Real part, and minus the imaginary part, of wn² / (wn² − ω² + 2 i ζ wn ω).
pub(super) fn transfer(natural_rad_s: f64, damping: f64, omega_rad_s: f64) -> (f64, f64) {
    let ratio = omega_rad_s / natural_rad_s;
    let real = 1.0 - ratio * ratio;
    let imaginary = 2.0 * damping * ratio;
    let size = real * real + imaginary * imaginary;
    // A damped spring driven by the surface. Typical seas peak at or below half of its natural
    // frequency, so a hull mostly follows the surface.
    (real / size, imaginary / size)
}

impl WaveResponse {
    /// The response of this boat to the waves of `field`.
    pub fn new(field: &WaveField, boat: &Boat) -> WaveResponse {
        WaveResponse::of(field, boat, &Patches::new(field, boat))
    }

    /// Like [`WaveResponse::new`], from waves that are already averaged.
    pub(super) fn of(field: &WaveField, boat: &Boat, patches: &Patches) -> WaveResponse {
        // Waves that are short compared with the draught have little effect: the hull follows the
        // pressure at its keel, not the surface.
        let pressed_m: Vec<f64> = field
            .waves
            .iter()
            .map(|wave| pressed_m(wave, boat))
            .collect();
        // Tabulate by heading: averaging each wave over the hull is most of the work, and the
        // average changes little between ticks.
        let quasi_static = HeadingTable::new(row_count(&field.waves), |bin, wave| {
            let Some(patch) = patches.of_bin(bin).get(wave) else {
                return [0.0; FOLD];
            };
            let [heave, roll, pitch] = quasi_static(pressed_m[wave], patch);
            [heave, roll, pitch, 0.0]
        });
        let blocks = blocks(&field.waves, Row::new);
        WaveResponse {
            instructions: field.instructions,
            blocks,
            quasi_static,
        }
    }

    pub(super) fn set_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// The attitude of a boat with this velocity over the ground and yaw rate.
    pub fn at(&self, pose: Pose, velocity_m_s: Ned, turn_rad_s: f64, time_s: f64) -> Attitude {
        let Sums {
            values,
            rates,
            heave_acceleration,
        } = self.instructions.run(At {
            response: self,
            pose,
            velocity_m_s,
            turn_rad_s,
            time_s,
        });
        Attitude {
            heave_up_m: values.sum(0),
            roll_rad: values.sum(1),
            pitch_rad: values.sum(2),
            heave_up_m_s: rates.sum(0),
            roll_rad_s: rates.sum(1),
            pitch_rad_s: rates.sum(2),
            heave_up_m_s2: heave_acceleration.sum(0),
        }
    }
}

/// Sums over the rows, for heave, roll and pitch.
struct Sums {
    values: Lanes<f32>,
    rates: Lanes<f32>,
    heave_acceleration: Lanes<f32>,
}

/// The part of [`WaveResponse::at`] that computes the sums. Building the attitude here would affect
/// register allocation.
struct At<'a> {
    response: &'a WaveResponse,
    pose: Pose,
    velocity_m_s: Ned,
    turn_rad_s: f64,
    time_s: f64,
}

impl Kernel for At<'_> {
    type Output = Sums;

    #[inline(always)]
    fn run(self) -> Sums {
        let nothing = Lanes::<f32>::splat(0.0);
        let mut sums = Sums {
            values: nothing,
            rates: nothing,
            heave_acceleration: nothing,
        };
        let (lines, fraction) = self.response.quasi_static.at(self.pose.psi_rad);
        let turn = Lanes::<f32>::splat(self.turn_rad_s as f32);
        for (block, lines) in self.response.blocks.iter().zip(lines.as_chunks::<FOLD>().0) {
            let (sin, cos) = block.phases.sin_cos(self.pose.at, self.time_s);
            let rate_rad_s = block.phases.rate_rad_s(self.velocity_m_s);
            for (i, (row, line)) in block.rows.iter().zip(lines).enumerate() {
                let sin = sin.row(i);
                let cos = cos.row(i);
                let rate_rad_s = rate_rad_s.row(i);
                let value = row.value.of(sin, cos);
                let now = line.at_fraction(fraction);
                let swing = now * rate_rad_s;
                sums.values += now * value;
                sums.rates += line.per_rad() * turn * value + swing * row.slope.of(sin, cos);
                sums.heave_acceleration = sums.heave_acceleration - swing * rate_rad_s * value;
            }
        }
        sums
    }
}

/// The amplitude of a wave's pressure at the draught, as a height of water, m.
pub(super) fn pressed_m(wave: &PlaneWave, boat: &Boat) -> f64 {
    wave.component.amplitude_m * wave.pressure_at(boat.draught_m)
}

/// Heave, roll and pitch of the plane that best fits a pressure of this amplitude: heave as a
/// factor on the cosine of the phase amidships, roll and pitch on its sine. A surface rising ahead
/// lifts the bow; one rising to starboard lifts that side.
pub(super) fn quasi_static(pressed_m: f64, patch: &Patch) -> [f64; 3] {
    let a = pressed_m;
    [
        a * patch.mean_x * patch.mean_y,
        a * patch.tilt_y * patch.mean_x,
        -a * patch.tilt_x * patch.mean_y,
    ]
}
