//! The wave spectrum (JONSWAP), the directional spreading, and the components that represent them.
//!
//! JONSWAP (Hasselmann et al. 1973) in terms of Hs and Tp, with the normalisation of Goda and
//! DNV-RP-C205:
//!
//! ```text
//! S(w) = (1 - 0.287 ln g) 5/16 Hs^2 wp^4 w^-5 exp(-5/4 (wp/w)^4) g^exp(-(w - wp)^2 / (2 s^2 wp^2))
//! s = 0.07 below the peak, 0.09 above
//! ```

use super::wave::Component;
use primitives::stream::Stream;
use scenario::sea::{Spreading, Waves};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The frequency band used, in peak frequencies. At γ = 3.3 it contains 99.8 % of the variance and
/// 96 % of the second moment.
pub const BAND: (f64, f64) = (0.5, 5.0);

/// Number of pieces of the curves below.
const PIECES: usize = 2048;

/// The golden ratio's fractional part.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Spectral density of the surface elevation, m² s, at the angular frequency `omega_rad_s` > 0.
pub fn jonswap_m2_s(waves: &Waves, omega_rad_s: f64) -> f64 {
    Jonswap::new(waves).density_m2_s(omega_rad_s)
}

/// The spectrum of a sea, with precomputed factors.
struct Jonswap {
    peak_rad_s: f64,
    log_gamma: f64,
    scale_m2: f64,
}

impl Jonswap {
    fn new(waves: &Waves) -> Jonswap {
        let log_gamma = libm::log(waves.gamma);
        let scale_m2 = (1.0 - 0.287 * log_gamma) * 0.3125 * waves.hs_m * waves.hs_m;
        Jonswap {
            peak_rad_s: TAU / waves.tp_s,
            log_gamma,
            scale_m2,
        }
    }

    fn density_m2_s(&self, omega_rad_s: f64) -> f64 {
        let ratio = self.peak_rad_s / omega_rad_s;
        let ratio_4 = ratio * ratio * ratio * ratio;
        let width = if omega_rad_s <= self.peak_rad_s {
            0.07
        } else {
            0.09
        };
        let off = (omega_rad_s / self.peak_rad_s - 1.0) / width;
        let shape = libm::exp(self.log_gamma * libm::exp(-0.5 * off * off) - 1.25 * ratio_4);
        self.scale_m2 * ratio_4 / omega_rad_s * shape
    }
}

/// Spectral density of the surface elevation over frequency, m²/Hz, at `frequency_hz` > 0.
pub fn density_m2_hz(waves: &Waves, frequency_hz: f64) -> f64 {
    TAU * jonswap_m2_s(waves, TAU * frequency_hz)
}

/// The components that represent this sea, by ascending frequency.
///
/// The band is divided into one stratum per component. All strata have equal fractions of the mean
/// of the normalised variance and the normalised second moment (that of the velocities). A
/// component carries the variance of its stratum. Its frequency is drawn from the spectrum within
/// the stratum: every moment is right on average, and the frequencies have no common multiple after
/// which the sea would repeat itself. Each has one direction, so that the sea is the same process
/// everywhere (Jefferys 1987). Directions are quantiles of the spreading at multiples of the golden
/// ratio: a few neighbouring frequencies cover all directions, and neither side is favoured.
pub(super) fn components(waves: &Waves, seed: u64) -> Vec<Component> {
    let mut stream = Stream::new(seed, "waves");
    let count = waves.components as usize;
    let peak_rad_s = TAU / waves.tp_s;
    // The shape does not depend on the height, and exists even for zero height.
    let shape = Waves {
        hs_m: 1.0,
        ..waves.clone()
    };
    let jonswap = Jonswap::new(&shape);
    let densities: Vec<f64> = points(BAND)
        .map(|x| jonswap.density_m2_s(x * peak_rad_s))
        .collect();
    let energy = Curve::new(BAND, densities.iter().copied());
    let second = Curve::new(
        BAND,
        points(BAND)
            .zip(&densities)
            .map(|(x, density)| x * x * density),
    );
    // With strata of equal energy, only a handful would represent the short waves, which cause the
    // slopes.
    let both = Curve {
        x: energy.x,
        up_to: (0..=PIECES)
            .map(|i| 0.5 * (energy.up_to[i] + second.up_to[i]))
            .collect(),
    };
    let spread = spread(waves.spreading);
    let first_quantile = stream.unit();

    // The renormalisation replaces the variance outside the band. With amplitudes taken directly
    // from the density, Hs has an error of up to 6 % for 16 to 64 components.
    let variance_m2 = waves.hs_m * waves.hs_m / 16.0;
    let mut below = 0.0;
    (0..count)
        .map(|i| {
            let above = if i + 1 == count {
                1.0
            } else {
                energy.share_at(both.at((i + 1) as f64 / count as f64))
            };
            let share = above - below;
            let x = energy.at(below + stream.unit() * share);
            below = above;
            // Use one direction per frequency, because several at one frequency lock into a
            // standing pattern.
            let quantile = first_quantile + i as f64 * GOLDEN;
            Component {
                amplitude_m: (2.0 * variance_m2 * share).sqrt(),
                omega_rad_s: x * peak_rad_s,
                toward_rad: waves.from_rad
                    + PI
                    + spread
                        .as_ref()
                        .map_or(0.0, |s| s.at(quantile - quantile.floor())),
                phase_rad: TAU * stream.unit(),
            }
        })
        .collect()
}

/// The spreading as a curve over the angle from the mean direction.
fn spread(spreading: Spreading) -> Option<Curve> {
    let (half_rad, density): (f64, &dyn Fn(f64) -> f64) = match spreading {
        Spreading::None => return None,
        Spreading::CosineSquared => (FRAC_PI_2, &|mu| {
            let cos = libm::cos(mu);
            cos * cos
        }),
        Spreading::Cosine2s { s } => (PI, &move |mu| libm::pow(libm::cos(0.5 * mu).abs(), 2.0 * s)),
    };
    let interval = (-half_rad, half_rad);
    Some(Curve::new(interval, points(interval).map(density)))
}

/// The ends of the [`PIECES`] equal pieces of an interval.
fn points(x: (f64, f64)) -> impl Iterator<Item = f64> {
    let step = (x.1 - x.0) / PIECES as f64;
    (0..=PIECES).map(move |i| x.0 + step * i as f64)
}

/// A cumulative density over an interval: linear between [`PIECES`] + 1 points.
struct Curve {
    x: (f64, f64),
    /// The cumulative fraction at each point.
    up_to: Vec<f64>,
}

impl Curve {
    /// Integrates densities at the [`points`] of the interval by the trapezoidal rule. At least one
    /// density must be positive.
    fn new(x: (f64, f64), mut densities: impl Iterator<Item = f64>) -> Curve {
        let mut up_to = Vec::with_capacity(PIECES + 1);
        up_to.push(0.0);
        let mut sum = 0.0;
        let mut last = densities.next().unwrap_or_default();
        for next in densities {
            sum += 0.5 * (last + next);
            last = next;
            up_to.push(sum);
        }
        for share in &mut up_to {
            *share /= sum;
        }
        Curve { x, up_to }
    }

    /// The quantile for `share`.
    fn at(&self, share: f64) -> f64 {
        let i = self
            .up_to
            .partition_point(|up_to| *up_to <= share)
            .clamp(1, PIECES);
        let low = self.up_to[i - 1];
        let high = self.up_to[i];
        let part = if high > low {
            (share - low) / (high - low)
        } else {
            0.0
        };
        self.x.0 + (self.x.1 - self.x.0) * (((i - 1) as f64 + part) / PIECES as f64)
    }

    /// The cumulative fraction at `x`.
    fn share_at(&self, x: f64) -> f64 {
        let place = (x - self.x.0) / (self.x.1 - self.x.0) * PIECES as f64;
        let i = (place as usize).min(PIECES - 1);
        self.up_to[i] + (self.up_to[i + 1] - self.up_to[i]) * (place - i as f64)
    }
}
