//! Propeller submergence in waves: the elevation of the surface there, less the rise of the hull.

use super::heading::{HeadingTable, Segment};
use super::hull_wave::Patch;
use super::sine::sum;
use super::wave::{LANES, PlaneWave, WaveField, lanes};
use super::wave_response::{HEAVE, PITCH, ROLL, quasi_static, transfer};
use game::boat::Boat;
use game::frame::Body;
use wide::f32x4;

/// How the submergence of the two propellers of a kind of boat changes in a field of waves.
#[derive(Clone, Debug)]
pub struct Submergence {
    /// Port per cosine and per sine of the phase amidships, then starboard, m.
    change: HeadingTable<4>,
}

impl Submergence {
    /// That of propellers at `places` of a boat like this.
    #[must_use]
    pub fn new(field: &WaveField, boat: &Boat, places: [Body; 2]) -> Submergence {
        let chunks: Vec<&[PlaneWave]> = field.waves.chunks(LANES).collect();
        let change = HeadingTable::new(chunks.len(), |row, heading_rad| {
            let parts = lanes(chunks[row], |w| {
                let [port, starboard] = places.map(|place| change_of(w, boat, heading_rad, place));
                [port.0, port.1, starboard.0, starboard.1]
            });
            std::array::from_fn(|part| f32x4::new(parts.map(|parts| parts[part] as f32)))
        });
        Submergence { change }
    }

    /// The numbers for a heading, for [`HullWaves::at_with`](super::HullWaves::at_with), which has the phases at hand.
    #[inline(always)]
    pub(super) fn lines(&self, heading_rad: f64) -> (&[[Segment; 4]], f32x4) {
        self.change.at(heading_rad)
    }
}

/// The submergence of both propellers, summed over the components four at a time.
#[derive(Clone, Copy, Default)]
pub(super) struct PropellerSums {
    port: f32x4,
    starboard: f32x4,
}

impl PropellerSums {
    #[inline(always)]
    pub(super) fn add(&mut self, lines: &[Segment; 4], fraction: f32x4, sin: f32x4, cos: f32x4) {
        self.port += lines[0].at_fraction(fraction) * cos + lines[1].at_fraction(fraction) * sin;
        self.starboard += lines[2].at_fraction(fraction) * cos + lines[3].at_fraction(fraction) * sin;
    }

    #[inline(always)]
    pub(super) fn submergence_change_m(&self) -> [f64; 2] {
        [sum(self.port), sum(self.starboard)]
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
