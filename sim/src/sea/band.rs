//! The variance of a wave field by frequency band, to compare with the requested spectrum.

use super::WaveField;
use super::spectrum::BAND;
use std::f64::consts::TAU;

/// A frequency band of a wave field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower and upper limit, Hz.
    pub range_hz: (f64, f64),
    /// Variance of the elevation from its components, m².
    pub variance_m2: f64,
}

impl Band {
    /// The mean spectral density, m²/Hz.
    pub fn density_m2_hz(&self) -> f64 {
        self.variance_m2 / (self.range_hz.1 - self.range_hz.0)
    }
}

/// The frequency range of the components of a sea with this peak period, Hz.
pub fn range_hz(tp_s: f64) -> (f64, f64) {
    (BAND.0 / tp_s, BAND.1 / tp_s)
}

impl WaveField {
    /// Divides `range_hz` into `count` equal bands. A component outside the range is added to the
    /// nearest band, so that the variances add up to that of the sea.
    pub fn bands(&self, range_hz: (f64, f64), count: usize) -> Vec<Band> {
        let width_hz = (range_hz.1 - range_hz.0) / count as f64;
        let edge_hz = |i: usize| range_hz.0 + i as f64 * width_hz;
        let empty = |i: usize| Band {
            range_hz: (edge_hz(i), edge_hz(i + 1)),
            variance_m2: 0.0,
        };
        let mut bands: Vec<Band> = (0..count).map(empty).collect();
        for component in self.components() {
            // The conversion turns a negative number or NaN into 0.
            let place = ((component.omega_rad_s / TAU - range_hz.0) / width_hz) as usize;
            // The last band includes all components above the range.
            bands[place.min(count - 1)].variance_m2 +=
                0.5 * component.amplitude_m * component.amplitude_m;
        }
        bands
    }
}

#[cfg(test)]
mod tests {
    use super::super::spectrum::density_m2_hz;
    use super::super::wave::Component;
    use super::super::waves_from;
    use super::*;
    use scenario::sea::Waves;

    #[test]
    fn many_components_hold_in_each_band_what_was_asked_for() {
        /// Tolerance for strata at the edges of a band, as a fraction of the highest density.
        const TOLERANCE: f64 = 0.03;
        for gamma in [1.0, 3.3] {
            let waves = Waves {
                gamma,
                ..waves_from(1.0, 0.5, 3.0, 4000)
            };
            let bands = WaveField::new(&waves, None, 5).bands(range_hz(3.0), 30);
            let highest = bands.iter().map(Band::density_m2_hz).fold(0.0, f64::max);
            for band in bands {
                let (low_hz, high_hz) = band.range_hz;
                let at = |i: i32| {
                    density_m2_hz(
                        &waves,
                        low_hz + (high_hz - low_hz) * (f64::from(i) + 0.5) / 100.0,
                    )
                };
                let want = (0..100).map(at).sum::<f64>() / 100.0;
                let got = band.density_m2_hz();
                assert!(
                    (got - want).abs() < TOLERANCE * highest,
                    "{gamma}, {low_hz} Hz: {got}, want {want}"
                );
            }
        }
    }

    #[test]
    fn what_lies_beyond_the_range_is_not_lost() {
        let wave = |hz: f64| Component {
            amplitude_m: 0.2,
            omega_rad_s: TAU * hz,
            toward_rad: 0.0,
            phase_rad: 0.0,
        };
        let field = WaveField::of(&[wave(0.01), wave(0.15), wave(9.0)], None, 1.0);
        let held: Vec<f64> = field
            .bands((0.1, 0.4), 3)
            .iter()
            .map(|band| band.variance_m2)
            .collect();
        assert!(
            (held[0] - 0.04).abs() < 1e-12 && held[1] == 0.0 && (held[2] - 0.02).abs() < 1e-12,
            "{held:?}"
        );
    }
}
