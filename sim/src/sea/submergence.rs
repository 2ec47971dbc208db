//! Propeller submergence in waves: the surface elevation minus the rise of the hull.

use super::heading::{BINS, HeadingTable, Segment};
use super::patch::{Patch, Patches};
use super::wave::{PlaneWave, WaveField, row_count};
use super::wave_response::{HEAVE, PITCH, ROLL, pressed_m, quasi_static, transfer};
use crate::lanes::{FOLD, LANES, Lanes};
use primitives::frame::Body;
use scenario::boat::Boat;

/// Change of submergence of the two propellers of a kind of boat in a wave field.
#[derive(Clone, Debug)]
pub struct Submergence {
    /// Coefficients of the cosine of the phase amidships for port and starboard, then of its sine,
    /// m.
    change: HeadingTable,
}

impl Submergence {
    /// The submergence of propellers at `places` of this boat.
    pub fn new(field: &WaveField, boat: &Boat, places: [Body; 2]) -> Submergence {
        Submergence::of(field, boat, places, &Patches::new(field, boat))
    }

    /// Like [`Submergence::new`], from waves that are already averaged.
    pub(super) fn of(
        field: &WaveField,
        boat: &Boat,
        places: [Body; 2],
        patches: &Patches,
    ) -> Submergence {
        let waves: Vec<Wave> = field
            .waves
            .iter()
            .map(|wave| Wave::new(wave, boat))
            .collect();
        let further = |bin| {
            let each = patches.of_bin(bin).iter().zip(&waves);
            each.map(|(patch, wave)| {
                places.map(|place| libm::sincos(wave.further_rad(place, patch)))
            })
        };
        // On the opposite heading, a wave's delay at a place becomes an equal lead.
        let phases: Vec<[(f64, f64); 2]> = (0..BINS / 2).flat_map(further).collect();
        let change = HeadingTable::new(row_count(&field.waves), |bin, wave| {
            let Some(patch) = patches.of_bin(bin).get(wave) else {
                return [0.0; FOLD];
            };
            let (half, sign) = if bin < BINS / 2 {
                (bin, 1.0)
            } else {
                (bin - BINS / 2, -1.0)
            };
            let [port, starboard] = [0, 1].map(|side| {
                let (sin, cos) = phases[half * waves.len() + wave][side];
                waves[wave].change_at(places[side], patch, (sign * sin, cos))
            });
            [port.0, starboard.0, port.1, starboard.1]
        });
        Submergence { change }
    }

    /// The numbers for a heading, for [`HullWaves::at_with`](super::HullWaves::at_with), which
    /// already has the phases.
    #[inline(always)]
    pub(super) fn lines(&self, heading_rad: f64) -> &[Segment] {
        self.change.at(heading_rad).0
    }
}

/// Adds the changes caused by a row of waves, given its coefficients, sines and cosines: port, then
/// starboard.
#[inline(always)]
pub(super) fn add(change_m: &mut Lanes<f32>, line: Lanes<f32>, sin: Lanes<f32>, cos: Lanes<f32>) {
    const HALF: usize = LANES / 2;
    for i in 0..HALF {
        change_m.0[i] += line.0[i] * cos.0[i] + line.0[HALF + i] * sin.0[HALF + i];
    }
}

/// The part of a wave's effect that does not depend on the heading.
struct Wave {
    amplitude_m: f64,
    pressed_m: f64,
    wavenumber_rad_m: f64,
    /// The transfer functions of heave, roll and pitch: the parts in phase and lagging.
    heave: (f64, f64),
    roll: (f64, f64),
    pitch: (f64, f64),
}

impl Wave {
    fn new(wave: &PlaneWave, boat: &Boat) -> Wave {
        let [heave, roll, pitch] = [HEAVE, ROLL, PITCH].map(|(natural_rad_s, damping)| {
            transfer(natural_rad_s, damping, wave.component.omega_rad_s)
        });
        Wave {
            amplitude_m: wave.component.amplitude_m,
            pressed_m: pressed_m(wave, boat),
            wavenumber_rad_m: wave.wavenumber_rad_m,
            heave,
            roll,
            pitch,
        }
    }

    /// The wave's phase at a place relative to amidships, rad.
    fn further_rad(&self, place: Body, patch: &Patch) -> f64 {
        self.wavenumber_rad_m * (patch.ahead * place.ahead + patch.starboard * place.starboard)
    }

    /// The wave's contribution to the submergence of a place, as coefficients of the cosine and
    /// sine of its phase amidships, given sine and cosine of [`Wave::further_rad`].
    fn change_at(&self, place: Body, patch: &Patch, (sin, cos): (f64, f64)) -> (f64, f64) {
        let [heave, roll, pitch] = quasi_static(self.pressed_m, patch);
        let bow_up = pitch * place.ahead;
        let starboard_down = roll * place.starboard;
        (
            self.amplitude_m * cos - heave * self.heave.0 - bow_up * self.pitch.1
                + starboard_down * self.roll.1,
            -self.amplitude_m * sin + heave * self.heave.1 - bow_up * self.pitch.0
                + starboard_down * self.roll.0,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::{HullWaves, WaveResponse, waves_from};
    use super::*;
    use primitives::frame::{Ned, Pose, ned_from_body};

    #[test]
    fn it_is_the_surface_less_the_hull_at_that_place() {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../scenarios/boats/surveyor_m1_8.toml");
        let boat = scenario::load_file::<scenario::Boat>(&file).unwrap_or_else(|e| panic!("{e}"));
        let field = WaveField::new(&waves_from(0.7, 0.3, 2.5, 64), None, 3);
        let places = [-0.33, 0.33].map(|starboard| Body {
            ahead: -0.7,
            starboard,
        });
        let submergence = Submergence::new(&field, &boat, places);
        let response = WaveResponse::new(&field, &boat);
        let waves = HullWaves::new(&field, &boat, 1000.0);
        for k in 0..200 {
            // Headings of the table, so that nothing is interpolated.
            let psi_rad = f64::from(k % 72) * std::f64::consts::TAU / 72.0;
            let pose = Pose {
                at: Ned {
                    north: f64::from(k) * 3.1,
                    east: f64::from(k) * -1.7,
                },
                psi_rad,
            };
            let time_s = f64::from(k) * 0.37;
            let attitude = response.at(pose, Ned::default(), 0.0, time_s);
            for (place, got_m) in places
                .into_iter()
                .zip(waves.at_with(&submergence, pose, time_s).1)
            {
                let at = pose.at + ned_from_body(pose.rotation(), place);
                let risen_m = attitude.heave_up_m + attitude.pitch_rad * place.ahead
                    - attitude.roll_rad * place.starboard;
                let want_m = field.surface(at, time_s).elevation_m - risen_m;
                assert!(
                    (got_m - want_m).abs() < 3e-7,
                    "{k}: got {got_m}, want {want_m}"
                );
            }
        }
    }
}
