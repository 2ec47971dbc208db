//! Sine and cosine of sixteen angles at once, bit-identical on every machine.
//!
//! The sea needs thousands of both per tick. The code here uses only sums, products and
//! differences, each rounded as IEEE 754 requires and none fused. Neither the processor nor the
//! platform's C library therefore affects the result.
//!
//! The angle is reduced to half a turn in double precision. Sine, cosine and the sums over waves
//! are in single precision, with twice as many numbers per instruction. A wave is then accurate to
//! a millionth of its height.

use crate::lanes::Lanes;

/// 1.5 · 2^52: adding it rounds a number to an integer, half to even, because the mantissa has no
/// bits left after the point. Valid for magnitudes below 2^51.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// sin π r = r (S0 + S1 r² + ...), minimax for |r| ≤ 1/2 by the Remez exchange: error at most
/// 3.4e-9, before rounding.
#[expect(clippy::approx_constant, reason = "close to π, but not π")]
const SIN: [f32; 5] = [
    3.141_592_6,
    -5.167_707,
    2.550_031_4,
    -0.598_045_2,
    0.077_220_13,
];

/// cos π r = C0 + C1 r² + ..., in the same way: error at most 4.7e-8.
const COS: [f32; 5] = [
    0.999_999_95,
    -4.934_793,
    4.058_412,
    -1.331_880_2,
    0.219_696_8,
];

/// The largest error of [`sin_cos_turns`], apart from rounding of the angle itself.
#[cfg(test)]
pub(super) const ERROR: f64 = 1.2e-6;

/// Sine and cosine of angles in turns (1 is a full turn). Accurate to 1.2e-6 up to ±2^51 turns.
///
/// In turns the reduction is an exact subtraction, however large the angle. The polynomials take
/// half the angle, within ± a quarter turn, so the quadrants need no special cases.
#[inline(always)]
pub(super) fn sin_cos_turns(turns: Lanes<f64>) -> (Lanes<f32>, Lanes<f32>) {
    let rounder = Lanes::<f64>::splat(ROUNDER);
    // Reduce in double precision, so that a phase is as accurate after a day as at the start. The
    // rest is in single precision, which takes half the time.
    let r = (turns - ((turns + rounder) - rounder)).single();
    let x = r * r;
    let sin_half = quartic(SIN, x) * r;
    let cos_half = quartic(COS, x);
    let sin_twice = sin_half + sin_half;
    (
        sin_twice * cos_half,
        Lanes::<f32>::splat(1.0) - sin_twice * sin_half,
    )
}

/// c0 + c1 x + ... + c4 x⁴ (Estrin): a shorter dependency chain than Horner's.
#[inline(always)]
fn quartic(c: [f32; 5], x: Lanes<f32>) -> Lanes<f32> {
    let c = c.map(Lanes::<f32>::splat);
    let x2 = x * x;
    (c[0] + c[1] * x) + ((c[2] + c[3] * x) + c[4] * x2) * x2
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::stream::Stream;

    fn one(turns: f64) -> (f64, f64) {
        let (sin, cos) = sin_cos_turns(Lanes::<f64>::splat(turns));
        (f64::from(sin.0[0]), f64::from(cos.0[0]))
    }

    /// libm's values for the same angle, reduced to half a turn without error.
    fn truth(turns: f64) -> (f64, f64) {
        let rest = turns - libm::rint(turns);
        libm::sincos(std::f64::consts::TAU * rest)
    }

    #[test]
    fn sine_and_cosine_agree_with_libm_from_nothing_to_2_to_the_40_turns() {
        let mut stream = Stream::new(1, "test");
        let mut worst = 0.0_f64;
        for scale in [1e-12, 1.0, 100.0, 2e5, (1_u64 << 40) as f64] {
            for _ in 0..100_000 {
                let turns = stream.between(-scale, scale);
                let (sin, cos) = one(turns);
                let (want_sin, want_cos) = truth(turns);
                let error = (sin - want_sin).abs().max((cos - want_cos).abs());
                assert!(error < ERROR, "{turns} turns: error {error}");
                worst = worst.max(error);
            }
        }
        assert!(
            worst > 0.1 * ERROR,
            "{worst}: the stated error is far from the real one"
        );
    }

    #[test]
    fn the_edges_of_the_reduction_are_as_good_as_its_middle() {
        for whole in [-3.0, 0.0, 1.0, 86_401.0] {
            for quarter in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                for nudge in [-1e-9, 0.0, 1e-9] {
                    let turns = whole + 0.25 * quarter + nudge;
                    let (sin, cos) = one(turns);
                    let (want_sin, want_cos) = truth(turns);
                    assert!(
                        (sin - want_sin).abs() < ERROR && (cos - want_cos).abs() < ERROR,
                        "{turns} turns"
                    );
                }
            }
        }
    }
}
