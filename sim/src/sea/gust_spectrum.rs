//! Gusts by their spectrum: a sum of waves whose lengths and phases are drawn once.
//!
//! Each wave stands for a band of frequencies, all bands equally wide on a logarithmic scale, with the variance that
//! the spectrum has in its band. The sum is then scaled to variance 1, so what lies outside of the bands is made up for
//! inside.

use game::sea::GustSpectrum;
use game::stream::Stream;
use std::f64::consts::TAU;

/// The slowest gust, Hz: one hour, about the gap between weather and turbulence (van der Hoven 1957).
pub const FREQUENCY_MIN_HZ: f64 = 1.0 / 3600.0;
/// The fastest gust, Hz: the limit that the Norwegian Petroleum Directorate gives for its spectrum.
pub const FREQUENCY_MAX_HZ: f64 = 0.5;
/// Grid points in the shortest wave.
pub(super) const STEPS_PER_WAVE: f64 = 8.0;
/// Pieces over which Simpson's rule goes in a band: even.
const PIECES: u32 = 16;

/// The frequency (Hz) times the spectral density of a gust, over any constant: the shape of the spectrum at a height
/// above the water in a wind of `speed_10m_m_s`.
#[must_use]
pub fn shape(spectrum: GustSpectrum, frequency_hz: f64, speed_10m_m_s: f64, height_m: f64) -> f64 {
    match spectrum {
        GustSpectrum::Davenport => {
            let x = 1200.0 * frequency_hz / speed_10m_m_s;
            4.0 * x * x / libm::pow(1.0 + x * x, 4.0 / 3.0)
        }
        GustSpectrum::Harris => {
            let x = 1800.0 * frequency_hz / speed_10m_m_s;
            4.0 * x / libm::pow(2.0 + x * x, 5.0 / 6.0)
        }
        GustSpectrum::Froya => {
            let height = libm::pow(height_m / 10.0, 2.0 / 3.0);
            let x = 172.0 * frequency_hz * height * libm::pow(speed_10m_m_s / 10.0, -0.75);
            frequency_hz / libm::pow(1.0 + libm::pow(x, 0.468), 5.0 / (3.0 * 0.468))
        }
    }
}

/// The share of the variance between the slowest and the fastest gust that lies between two frequencies.
fn variance(shape: &dyn Fn(f64) -> f64, from_hz: f64, to_hz: f64) -> f64 {
    let log_ratio = libm::log(to_hz / from_hz);
    let at = |i: u32| shape(from_hz * libm::exp(log_ratio * f64::from(i) / f64::from(PIECES)));
    let inner: f64 = (1..PIECES).map(|i| if i % 2 == 1 { 4.0 * at(i) } else { 2.0 * at(i) }).sum();
    (at(0) + inner + at(PIECES)) * log_ratio / (3.0 * f64::from(PIECES))
}

/// One wave.
#[derive(Clone, Copy, Debug)]
struct Wave {
    amplitude: f64,
    turns_per_step: f64,
    phase_turns: f64,
}

/// Waves along the wind or across it, on a grid of [`STEPS_PER_WAVE`] points in the shortest: of variance 1.
#[derive(Clone, Debug)]
pub(super) struct Waves(Vec<Wave>);

impl Waves {
    /// Waves for `shape` (frequency times density over frequency in Hz), drawn from `stream`.
    pub(super) fn draw(shape: &dyn Fn(f64) -> f64, components: u32, stream: &mut Stream) -> Waves {
        let count = f64::from(components.max(1));
        let log_ratio = libm::log(FREQUENCY_MAX_HZ / FREQUENCY_MIN_HZ) / count;
        let edge_hz = |i: f64| FREQUENCY_MIN_HZ * libm::exp(log_ratio * i);
        let mut waves: Vec<Wave> = (0..components.max(1))
            .map(|i| {
                let (from_hz, to_hz) = (edge_hz(f64::from(i)), edge_hz(f64::from(i + 1)));
                let frequency_hz = from_hz * libm::exp(log_ratio * stream.unit());
                Wave {
                    amplitude: (2.0 * variance(shape, from_hz, to_hz)).sqrt(),
                    turns_per_step: frequency_hz / (FREQUENCY_MAX_HZ * STEPS_PER_WAVE),
                    phase_turns: stream.unit(),
                }
            })
            .collect();
        let total: f64 = waves.iter().map(|wave| 0.5 * wave.amplitude * wave.amplitude).sum();
        for wave in &mut waves {
            wave.amplitude /= total.sqrt();
        }
        Waves(waves)
    }

    /// Their sum at a grid point.
    pub(super) fn at(&self, index: i64) -> f64 {
        let wave_at = |wave: &Wave| {
            let turns = wave.turns_per_step * index as f64 + wave.phase_turns;
            wave.amplitude * libm::cos(TAU * (turns - turns.floor()))
        };
        self.0.iter().map(wave_at).sum()
    }

    /// The correlation of neighbours on the grid.
    pub(super) fn neighbour_correlation(&self) -> f64 {
        let part = |wave: &Wave| 0.5 * wave.amplitude * wave.amplitude * libm::cos(TAU * wave.turns_per_step);
        self.0.iter().map(part).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEED_M_S: f64 = 8.0;

    fn davenport(frequency_hz: f64) -> f64 {
        shape(GustSpectrum::Davenport, frequency_hz, SPEED_M_S, 1.5)
    }

    #[test]
    fn the_variance_in_a_band_is_davenport_s_integral() {
        // ∫ 4x / (1 + x²)^(4/3) dx = −6 (1 + x²)^(−1/3).
        let primitive =
            |f: f64| -6.0 * libm::pow(1.0 + (1200.0 * f / SPEED_M_S) * (1200.0 * f / SPEED_M_S), -1.0 / 3.0);
        for (from_hz, to_hz) in [(0.001, 0.0015), (0.01, 0.015), (0.1, 0.2)] {
            let got = variance(&davenport, from_hz, to_hz);
            let want = primitive(to_hz) - primitive(from_hz);
            assert!((got / want - 1.0).abs() < 1e-6, "{from_hz} to {to_hz} Hz: {got}, not {want}");
        }
    }

    #[test]
    fn the_waves_have_variance_one_and_each_the_share_of_its_band() {
        for spectrum in [GustSpectrum::Davenport, GustSpectrum::Harris, GustSpectrum::Froya] {
            let shape = |f: f64| shape(spectrum, f, SPEED_M_S, 1.5);
            let waves = Waves::draw(&shape, 40, &mut Stream::new(1, "test")).0;
            let total: f64 = waves.iter().map(|wave| 0.5 * wave.amplitude * wave.amplitude).sum();
            assert!((total - 1.0).abs() < 1e-12, "{spectrum:?}: {total}");
            // By brute force: the midpoint rule with 100 000 pieces, over the shape itself.
            let log_range = libm::log(FREQUENCY_MAX_HZ / FREQUENCY_MIN_HZ);
            let mut by_band = [0.0; 40];
            for i in 0..100_000 {
                let place = (f64::from(i) + 0.5) / 100_000.0;
                by_band[(place * 40.0) as usize] += shape(FREQUENCY_MIN_HZ * libm::exp(log_range * place));
            }
            let all: f64 = by_band.iter().sum();
            for (band, wave) in waves.iter().enumerate() {
                let got = 0.5 * wave.amplitude * wave.amplitude;
                let frequency_hz = wave.turns_per_step * STEPS_PER_WAVE * FREQUENCY_MAX_HZ;
                let place = libm::log(frequency_hz / FREQUENCY_MIN_HZ) / log_range * 40.0;
                assert!((got - by_band[band] / all).abs() < 1e-5, "{spectrum:?}, band {band}: {got}");
                assert!((place - band as f64 - 0.5).abs() <= 0.5 + 1e-9, "{spectrum:?}, band {band}: at {place}");
            }
        }
    }

    #[test]
    fn each_spectrum_peaks_where_its_formula_does() {
        // Where fS is largest: Davenport x = √3; Harris χ = √3; Frøya f̄^0.468 = 1 / (5/3 − 1) = 3/2.
        let froya_hz = libm::pow(1.5, 1.0 / 0.468) / 172.0;
        for (spectrum, peak_hz) in [
            (GustSpectrum::Davenport, 3.0_f64.sqrt() * 10.0 / 1200.0),
            (GustSpectrum::Harris, 3.0_f64.sqrt() * 10.0 / 1800.0),
            (GustSpectrum::Froya, froya_hz),
        ] {
            let at = |f: f64| shape(spectrum, f, 10.0, 10.0);
            assert!(at(peak_hz) > at(peak_hz * 1.01) && at(peak_hz) > at(peak_hz * 0.99), "{spectrum:?}");
        }
    }
}
