//! Heave, roll and pitch of a hull in waves, as sensors measure them and observers see them.
//!
//! It follows the surface, averaged over the hull, as three damped springs would. Nothing of it acts back on the
//! horizontal motion.

use super::heading::HeadingTable;
use super::hull_wave::Patch;
use super::sine::sum;
use super::wave::{LANES, Phases, PlaneWave, WaveField, lanes, side_by_side};
use game::boat::Boat;
use game::frame::{Ned, Pose};
use wide::f32x4;

/// Natural frequency, rad/s, and damping ratio: those of the Otter in Fossen's Marine Systems Simulator. A hull as long as
/// the Otter has much the same.
pub(super) const HEAVE: (f64, f64) = (7.5, 0.3);
pub(super) const ROLL: (f64, f64) = (7.4, 0.2);
pub(super) const PITCH: (f64, f64) = (8.6, 0.4);

/// Heave, roll and pitch of a hull, and their rates. Angles are as in NED: roll is positive with the
/// starboard side down, pitch with the bow up. Heave is the height above where it floats at rest, up.
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
/// Heave, roll and pitch respond to a wave of the frequency ω with wn² / (wn² − ω² + 2 i ζ wn ω) times the surface
/// at the draught, its best-fitting plane. The frequency is that at a fixed place: the change of the response with a boat's
/// own speed is left out, the frequency of encounter is not.
#[derive(Clone, Debug)]
pub struct WaveResponse {
    rows: Vec<Row>,
    /// Heave per cosine, roll and pitch per sine of the phase, before the springs respond.
    quasi_static: HeadingTable<3>,
}

/// Four components side by side: what does not depend on the heading.
#[derive(Clone, Copy, Debug)]
struct Row {
    phases: Phases,
    heave: Transfer,
    roll: Transfer,
    pitch: Transfer,
}

/// A spring's transfer function at four frequencies: the parts in phase with the waves and a quarter turn behind.
#[derive(Clone, Copy, Debug)]
struct Transfer {
    real: f32x4,
    behind: f32x4,
}

impl Transfer {
    fn new(waves: &[PlaneWave], (natural_rad_s, damping): (f64, f64)) -> Transfer {
        let fraction = |pick: fn((f64, f64)) -> f64| {
            side_by_side(waves, |w| pick(transfer(natural_rad_s, damping, w.component.omega_rad_s)))
        };
        Transfer { real: fraction(|(real, _)| real), behind: fraction(|(_, behind)| behind) }
    }

    /// The sine and cosine of the phase as the spring passes them on. The phase falls with time, so what lags has a phase
    /// that is ahead.
    #[inline(always)]
    fn apply(&self, sin: f32x4, cos: f32x4) -> (f32x4, f32x4) {
        (self.real * sin + self.behind * cos, self.real * cos - self.behind * sin)
    }
}

/// The real fraction, and minus the imaginary fraction, of wn² / (wn² − ω² + 2 i ζ wn ω).
pub(super) fn transfer(natural_rad_s: f64, damping: f64, omega_rad_s: f64) -> (f64, f64) {
    let ratio = omega_rad_s / natural_rad_s;
    let (real, imaginary) = (1.0 - ratio * ratio, 2.0 * damping * ratio);
    let size = real * real + imaginary * imaginary;
    (real / size, imaginary / size)
}

impl WaveResponse {
    /// The response of a boat like this to the waves of `field`.
    #[must_use]
    pub fn new(field: &WaveField, boat: &Boat) -> WaveResponse {
        let chunks: Vec<&[PlaneWave]> = field.waves.chunks(LANES).collect();
        let row = |waves: &&[PlaneWave]| Row {
            phases: Phases::new(waves),
            heave: Transfer::new(waves, HEAVE),
            roll: Transfer::new(waves, ROLL),
            pitch: Transfer::new(waves, PITCH),
        };
        let quasi_static = HeadingTable::new(chunks.len(), |row, heading_rad| {
            let parts = lanes(chunks[row], |w| quasi_static(w, boat, heading_rad));
            [0, 1, 2].map(|n| f32x4::new(parts.map(|part| part[n] as f32)))
        });
        WaveResponse { rows: chunks.iter().map(row).collect(), quasi_static }
    }

    /// The attitude of a boat that moves over the ground at this velocity and turns at this rate.
    #[must_use]
    pub fn at(&self, pose: Pose, velocity_m_s: Ned, turn_rad_s: f64, time_s: f64) -> Attitude {
        let (mut heave, mut roll, mut pitch) = (f32x4::ZERO, f32x4::ZERO, f32x4::ZERO);
        let (mut heave_rate, mut roll_rate, mut pitch_rate) = (f32x4::ZERO, f32x4::ZERO, f32x4::ZERO);
        let mut heave_acceleration = f32x4::ZERO;
        let (lines, fraction) = self.quasi_static.at(pose.psi_rad);
        let turn = f32x4::splat(turn_rad_s as f32);
        for (row, lines) in self.rows.iter().zip(lines) {
            let (sin, cos) = row.phases.sin_cos(pose.at, time_s);
            let rate = row.phases.rate_rad_s(velocity_m_s);
            let now = [lines[0].at_fraction(fraction), lines[1].at_fraction(fraction), lines[2].at_fraction(fraction)];

            let (heave_sin, heave_cos) = row.heave.apply(sin, cos);
            heave += now[0] * heave_cos;
            let swing = now[0] * rate;
            heave_rate += lines[0].per_rad() * turn * heave_cos - swing * heave_sin;
            heave_acceleration -= swing * rate * heave_cos;

            let (roll_sin, roll_cos) = row.roll.apply(sin, cos);
            roll += now[1] * roll_sin;
            roll_rate += lines[1].per_rad() * turn * roll_sin + now[1] * rate * roll_cos;

            let (pitch_sin, pitch_cos) = row.pitch.apply(sin, cos);
            pitch += now[2] * pitch_sin;
            pitch_rate += lines[2].per_rad() * turn * pitch_sin + now[2] * rate * pitch_cos;
        }
        Attitude {
            heave_up_m: sum(heave),
            roll_rad: sum(roll),
            pitch_rad: sum(pitch),
            heave_up_m_s: sum(heave_rate),
            roll_rad_s: sum(roll_rate),
            pitch_rad_s: sum(pitch_rate),
            heave_up_m_s2: sum(heave_acceleration),
        }
    }
}

/// Heave, roll and pitch of the plane that fits a wave's pressure at the draught best: heave per cosine, roll and pitch
/// per sine of the phase amidships. Where the surface rises ahead the bow goes up; where it rises to starboard, that side.
pub(super) fn quasi_static(wave: &PlaneWave, boat: &Boat, heading_rad: f64) -> [f64; 3] {
    let patch = Patch::new(wave, boat, heading_rad);
    let a = wave.component.amplitude_m * wave.pressure_at(boat.draught_m);
    [a * patch.mean_x * patch.mean_y, a * patch.tilt_y * patch.mean_x, -a * patch.tilt_x * patch.mean_y]
}
