//! How much water stands over a boat's propellers: the waves there, less what the hull has risen on them.

use super::heading::{HeadingTable, Line};
use super::hull_wave::Patch;
use super::ride::{HEAVE, PITCH, ROLL, response, still};
use super::sine::sum;
use super::wave::{LANES, Phases, PlaneWave, WaveField, lanes};
use game::boat::Boat;
use game::frame::{Body, Pose};
use wide::f32x4;

/// The water over the two propellers of a kind of boat in a field of waves.
#[derive(Clone, Debug)]
pub struct Cover {
    phases: Vec<Phases>,
    /// Port per cosine and per sine of the phase amidships, then starboard, m.
    over: HeadingTable<4>,
}

impl Cover {
    /// The water over propellers at `places` of a boat like this.
    #[must_use]
    pub fn new(field: &WaveField, boat: &Boat, places: [Body; 2]) -> Cover {
        let chunks: Vec<&[PlaneWave]> = field.waves.chunks(LANES).collect();
        let over = HeadingTable::new(chunks.len(), |row, heading_rad| {
            let parts = lanes(chunks[row], |w| {
                let [port, starboard] = places.map(|place| over(w, boat, heading_rad, place));
                [port.0, port.1, starboard.0, starboard.1]
            });
            std::array::from_fn(|part| f32x4::new(parts.map(|parts| parts[part] as f32)))
        });
        Cover { phases: chunks.iter().map(|waves| Phases::new(waves)).collect(), over }
    }

    /// How much higher than in calm the water stands over each propeller, m.
    #[must_use]
    pub fn at(&self, pose: Pose, time_s: f64) -> [f64; 2] {
        let mut tally = Tally::default();
        let (lines, part) = self.lines(pose.psi_rad);
        for (phases, lines) in self.phases.iter().zip(lines) {
            let (sin, cos) = phases.sin_cos(pose.at, time_s);
            tally.add(lines, part, sin, cos);
        }
        tally.cover_m()
    }

    /// The numbers for a heading, for who has the phases at hand.
    #[inline(always)]
    pub(super) fn lines(&self, heading_rad: f64) -> (&[[Line; 4]], f32x4) {
        self.over.at(heading_rad)
    }
}

/// The water over both propellers, summed over the components four at a time.
#[derive(Clone, Copy, Default)]
pub(super) struct Tally {
    port: f32x4,
    starboard: f32x4,
}

impl Tally {
    #[inline(always)]
    pub(super) fn add(&mut self, lines: &[Line; 4], part: f32x4, sin: f32x4, cos: f32x4) {
        self.port += lines[0].after(part) * cos + lines[1].after(part) * sin;
        self.starboard += lines[2].after(part) * cos + lines[3].after(part) * sin;
    }

    #[inline(always)]
    pub(super) fn cover_m(&self) -> [f64; 2] {
        [sum(self.port), sum(self.starboard)]
    }
}

/// What a wave adds to the water over a place, per cosine and per sine of its phase amidships.
fn over(wave: &PlaneWave, boat: &Boat, heading_rad: f64, place: Body) -> (f64, f64) {
    let patch = Patch::new(wave, boat, heading_rad);
    let further_rad = wave.wavenumber_rad_m * (patch.ahead * place.ahead + patch.starboard * place.starboard);
    let (sin, cos) = libm::sincos(further_rad);
    let a = wave.component.amplitude_m;
    let [heave, roll, pitch] = still(wave, boat, heading_rad);
    let answer = |(natural_rad_s, damping)| response(natural_rad_s, damping, wave.component.omega_rad_s);
    let ((heave_real, heave_behind), (roll_real, roll_behind)) = (answer(HEAVE), answer(ROLL));
    let (pitch_real, pitch_behind) = answer(PITCH);
    let (bow_up, starboard_down) = (pitch * place.ahead, roll * place.starboard);
    (
        a * cos - heave * heave_real - bow_up * pitch_behind + starboard_down * roll_behind,
        -a * sin + heave * heave_behind - bow_up * pitch_real + starboard_down * roll_real,
    )
}

#[cfg(test)]
mod tests {
    use super::super::Ride;
    use super::*;
    use game::frame::{Ned, ned_from_body};
    use game::sea::{Spreading, Waves};

    #[test]
    fn it_is_the_surface_less_the_hull_at_that_place() {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/boats/surveyor_m1_8.toml");
        let boat = game::scenario::load_boat(&file).unwrap_or_else(|e| panic!("{e}"));
        let waves = Waves {
            hs_m: 0.3,
            tp_s: 2.5,
            gamma: 3.3,
            from_rad: 0.7,
            spreading: Spreading::CosineSquared,
            components: 64,
            drift_factor: 1.0,
        };
        let field = WaveField::new(&waves, None, 3);
        let places = [-0.33, 0.33].map(|starboard| Body { ahead: -0.7, starboard });
        let (cover, ride) = (Cover::new(&field, &boat, places), Ride::new(&field, &boat));
        for k in 0..200 {
            // Headings of the table, so that nothing is interpolated.
            let psi_rad = f64::from(k % 72) * std::f64::consts::TAU / 72.0;
            let pose = Pose { at: Ned { north: f64::from(k) * 3.1, east: f64::from(k) * -1.7 }, psi_rad };
            let time_s = f64::from(k) * 0.37;
            let attitude = ride.at(pose, Ned::default(), 0.0, time_s);
            for (place, got_m) in places.into_iter().zip(cover.at(pose, time_s)) {
                let at = pose.at + ned_from_body(pose.rotation(), place);
                let risen_m =
                    attitude.heave_up_m + attitude.pitch_rad * place.ahead - attitude.roll_rad * place.starboard;
                let want_m = field.surface(at, time_s).elevation_m - risen_m;
                assert!((got_m - want_m).abs() < 3e-7, "{k}: {got_m} against {want_m}");
            }
        }
    }
}
