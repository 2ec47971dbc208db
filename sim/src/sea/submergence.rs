//! Propeller submergence in waves: the elevation of the surface there, less the rise of the hull.

use super::heading::{HeadingTable, Segment};
use super::hull_wave::Patch;
use super::wave::{PlaneWave, WaveField, row_count, side_by_side, waves_of_row};
use super::wave_response::{HEAVE, PITCH, ROLL, quasi_static, transfer};
use crate::lanes::{LANES, Lanes, ROW};
use game::boat::Boat;
use game::frame::Body;

/// How the submergence of the two propellers of a kind of boat changes in a field of waves.
#[derive(Clone, Debug)]
pub struct Submergence {
    /// Port and starboard per cosine of the phase amidships, then both per sine, m.
    change: HeadingTable,
}

impl Submergence {
    /// That of propellers at `places` of a boat like this.
    #[must_use]
    pub fn new(field: &WaveField, boat: &Boat, places: [Body; 2]) -> Submergence {
        let change = HeadingTable::new(row_count(&field.waves), |row, heading_rad| {
            let parts: [[f64; 4]; ROW] = side_by_side(waves_of_row(&field.waves, row), |w| {
                let [port, starboard] = places.map(|place| change_of(w, boat, heading_rad, place));
                [port.0, starboard.0, port.1, starboard.1]
            });
            std::array::from_fn(|part| parts.map(|parts| parts[part] as f32))
        });
        Submergence { change }
    }

    /// The numbers for a heading, for [`HullWaves::at_with`](super::HullWaves::at_with), which has the phases at hand.
    #[inline(always)]
    pub(super) fn lines(&self, heading_rad: f64) -> &[Segment] {
        self.change.at(heading_rad).0
    }
}

/// Adds what the waves of a row change, by these numbers of it, sines and cosines: the first for port, the second for starboard.
#[inline(always)]
pub(super) fn add(change_m: &mut Lanes<f32>, line: Lanes<f32>, sin: Lanes<f32>, cos: Lanes<f32>) {
    const HALF: usize = LANES / 2;
    for i in 0..HALF {
        change_m.0[i] += line.0[i] * cos.0[i] + line.0[HALF + i] * sin.0[HALF + i];
    }
}

/// What a wave adds to the submergence of a place, per cosine and per sine of its phase amidships.
fn change_of(wave: &PlaneWave, boat: &Boat, heading_rad: f64, place: Body) -> (f64, f64) {
    let patch = Patch::new(wave, boat, heading_rad);
    let further_rad = wave.wavenumber_rad_m * (patch.ahead * place.ahead + patch.starboard * place.starboard);
    let (sin, cos) = libm::sincos(further_rad);
    let a = wave.component.amplitude_m;
    let [heave, roll, pitch] = quasi_static(wave, boat, heading_rad);
    let transfer_of = |(natural_rad_s, damping)| transfer(natural_rad_s, damping, wave.component.omega_rad_s);
    let ((heave_real, heave_behind), (roll_real, roll_behind)) = (transfer_of(HEAVE), transfer_of(ROLL));
    let (pitch_real, pitch_behind) = transfer_of(PITCH);
    let (bow_up, starboard_down) = (pitch * place.ahead, roll * place.starboard);
    (
        a * cos - heave * heave_real - bow_up * pitch_behind + starboard_down * roll_behind,
        -a * sin + heave * heave_behind - bow_up * pitch_real + starboard_down * roll_real,
    )
}

#[cfg(test)]
mod tests {
    use super::super::{HullWaves, WaveResponse, waves_from};
    use super::*;
    use game::frame::{Ned, Pose, ned_from_body};

    #[test]
    fn it_is_the_surface_less_the_hull_at_that_place() {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/boats/surveyor_m1_8.toml");
        let boat = game::scenario::load_boat(&file).unwrap_or_else(|e| panic!("{e}"));
        let field = WaveField::new(&waves_from(0.7, 0.3, 2.5, 64), None, 3);
        let places = [-0.33, 0.33].map(|starboard| Body { ahead: -0.7, starboard });
        let (submergence, response) = (Submergence::new(&field, &boat, places), WaveResponse::new(&field, &boat));
        let waves = HullWaves::new(&field, &boat, 1000.0);
        for k in 0..200 {
            // Headings of the table, so that nothing is interpolated.
            let psi_rad = f64::from(k % 72) * std::f64::consts::TAU / 72.0;
            let pose = Pose { at: Ned { north: f64::from(k) * 3.1, east: f64::from(k) * -1.7 }, psi_rad };
            let time_s = f64::from(k) * 0.37;
            let attitude = response.at(pose, Ned::default(), 0.0, time_s);
            for (place, got_m) in places.into_iter().zip(waves.at_with(&submergence, pose, time_s).1) {
                let at = pose.at + ned_from_body(pose.rotation(), place);
                let risen_m =
                    attitude.heave_up_m + attitude.pitch_rad * place.ahead - attitude.roll_rad * place.starboard;
                let want_m = field.surface(at, time_s).elevation_m - risen_m;
                assert!((got_m - want_m).abs() < 3e-7, "{k}: {got_m} against {want_m}");
            }
        }
    }
}
