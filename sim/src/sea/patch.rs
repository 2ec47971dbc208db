//! Plane waves averaged over a rectangle, length by beam.
//!
//! All effects of waves on a hull derive from this average, computed once for each wave and each
//! heading of a table.

use super::heading::{self, BINS};
use super::wave::{PlaneWave, WaveField};
use scenario::boat::Boat;

/// A plane wave under a rectangle, length by beam.
#[derive(Clone, Copy)]
pub(super) struct Patch {
    /// The wave's direction of travel in body axes: a unit vector.
    pub(super) ahead: f64,
    pub(super) starboard: f64,
    /// Averaging factors over the length and over the beam.
    pub(super) mean_x: f64,
    pub(super) mean_y: f64,
    /// The slope of the best-fitting straight line over the length and over the beam, as a factor
    /// on minus the sine of the phase, 1/m.
    pub(super) tilt_x: f64,
    pub(super) tilt_y: f64,
}

impl Patch {
    pub(super) fn new(wave: &PlaneWave, boat: &Boat, heading_rad: f64) -> Patch {
        let (starboard, ahead) = libm::sincos(wave.component.toward_rad - heading_rad);
        let k_x = wave.wavenumber_rad_m * ahead;
        let k_y = wave.wavenumber_rad_m * starboard;
        let (mean_x, tilt_x) = fit(0.5 * k_x * boat.length_m);
        let (mean_y, tilt_y) = fit(0.5 * k_y * boat.beam_m);
        Patch {
            ahead,
            starboard,
            mean_x,
            mean_y,
            tilt_x: k_x * tilt_x,
            tilt_y: k_y * tilt_y,
        }
    }

    /// The same wave for the opposite heading.
    fn turned(&self) -> Patch {
        Patch {
            ahead: -self.ahead,
            starboard: -self.starboard,
            tilt_x: -self.tilt_x,
            tilt_y: -self.tilt_y,
            ..*self
        }
    }
}

/// Fits to a wave over phases from −`half_rad` to `half_rad`: the mean of cos, sin u / u, and the
/// slope of the line that best fits sin, 3 (sin u − u cos u) / u³.
fn fit(half_rad: f64) -> (f64, f64) {
    let u = half_rad;
    // Use a series near zero, where the quotient loses its digits.
    if u.abs() < 1e-4 {
        return (1.0 - u * u / 6.0, 1.0 - u * u / 10.0);
    }
    let (sin, cos) = libm::sincos(u);
    let tilt = if u.abs() < 0.01 {
        1.0 - u * u / 10.0
    } else {
        3.0 * (sin - u * cos) / (u * u * u)
    };
    (sin / u, tilt)
}

/// The averaged waves of a field under hulls of one length and beam, by heading of a table.
pub(super) struct Patches {
    waves: usize,
    /// Grouped by heading, in table order.
    patches: Vec<Patch>,
}

impl Patches {
    pub(super) fn new(field: &WaveField, boat: &Boat) -> Patches {
        let of_bin = |bin| {
            field
                .waves
                .iter()
                .map(move |wave| Patch::new(wave, boat, heading::of_bin(bin)))
        };
        let mut patches: Vec<Patch> = (0..BINS / 2).flat_map(of_bin).collect();
        // On the opposite heading, the same wave comes from the other end: this saves half of the
        // sines at the start of a game.
        patches.extend_from_within(..);
        let half = patches.len() / 2;
        patches[half..]
            .iter_mut()
            .for_each(|patch| *patch = patch.turned());
        Patches {
            waves: field.waves.len(),
            patches,
        }
    }

    /// The waves, one by one, for a heading of the table.
    pub(super) fn of_bin(&self, bin: usize) -> &[Patch] {
        &self.patches[bin * self.waves..(bin + 1) * self.waves]
    }
}

#[cfg(test)]
mod tests {
    use super::super::waves_from;
    use super::*;

    #[test]
    fn those_of_a_table_are_the_waves_on_its_headings() {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../scenarios/boats/surveyor_m1_8.toml");
        let boat = scenario::load_file::<scenario::Boat>(&file).unwrap_or_else(|e| panic!("{e}"));
        let field = WaveField::new(&waves_from(0.7, 0.3, 2.5, 20), None, 3);
        let patches = Patches::new(&field, &boat);
        for bin in 0..BINS {
            let want = field
                .waves
                .iter()
                .map(|wave| Patch::new(wave, &boat, heading::of_bin(bin)));
            for (want, got) in want.zip(patches.of_bin(bin)) {
                let numbers =
                    |p: &Patch| [p.ahead, p.starboard, p.mean_x, p.mean_y, p.tilt_x, p.tilt_y];
                for (want, got) in numbers(&want).into_iter().zip(numbers(got)) {
                    assert!((want - got).abs() < 1e-12, "{bin}: got {got}, want {want}");
                }
            }
        }
    }
}
