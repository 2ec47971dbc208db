//! Sine and cosine of sixteen angles at once, the same bits on every machine.
//!
//! The sea asks for thousands of them a tick. Only sums, products and differences are taken, each rounded by IEEE 754
//! and none fused, so neither the processor nor the platform's C library has a say in the result.
//!
//! The angle is brought within half a turn in double precision; what follows, sine, cosine and the sums over the waves,
//! is in single, twice as many numbers in the same instruction. A wave is then right to a millionth of its height.

use crate::lanes::Lanes;

/// 1.5 · 2^52: what is added to it is rounded to a whole number, half to even, for the mantissa has no bit left behind
/// the point. Good for magnitudes below 2^51.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// sin π r = r (S0 + S1 r² + ...), minimax for |r| ≤ 1/2 by Remez' exchange: off by 3.4e-9 at most, before rounding.
#[expect(clippy::approx_constant, reason = "near π, and not π")]
const SIN: [f32; 5] = [3.141_592_6, -5.167_707, 2.550_031_4, -0.598_045_2, 0.077_220_13];

/// cos π r = C0 + C1 r² + ..., likewise: off by 4.7e-8 at most.
const COS: [f32; 5] = [0.999_999_95, -4.934_793, 4.058_412, -1.331_880_2, 0.219_696_8];

/// The largest error of [`sin_cos_turns`], apart from what the angle itself was rounded by.
#[cfg(test)]
pub(super) const ERROR: f64 = 1.2e-6;

/// Sine and cosine of angles in turns: 1 is all the way round. Within 1.2e-6 up to 2^51 turns either way.
///
/// In turns the reduction is a subtraction without error, however far round the angle is.
/// The polynomials are of half the angle, between a quarter turn either way, and no quadrant has to be told apart.
#[inline(always)]
pub(super) fn sin_cos_turns(turns: Lanes<f64>) -> (Lanes<f32>, Lanes<f32>) {
    let rounder = Lanes::<f64>::splat(ROUNDER);
    // In double precision, so that a phase is as good after a day as at the start; the rest is
    // in single, which takes half the time.
    let r = (turns - ((turns + rounder) - rounder)).single();
    let x = r * r;
    let sin_half = quartic(SIN, x) * r;
    let cos_half = quartic(COS, x);
    let sin_twice = sin_half + sin_half;
    (sin_twice * cos_half, Lanes::<f32>::splat(1.0) - sin_twice * sin_half)
}

/// c0 + c1 x + ... + c4 x⁴ (Estrin): a chain shorter than Horner's, so less waiting.
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

    /// libm's of the same angle, brought within half a turn without error.
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
                assert!(error < ERROR, "{turns} turns: off by {error}");
                worst = worst.max(error);
            }
        }
        assert!(worst > 0.1 * ERROR, "{worst}: the stated error is far from the real one");
    }

    #[test]
    fn the_edges_of_the_reduction_are_as_good_as_its_middle() {
        for whole in [-3.0, 0.0, 1.0, 86_401.0] {
            for quarter in [-2.0, -1.0, 0.0, 1.0, 2.0] {
                for nudge in [-1e-9, 0.0, 1e-9] {
                    let turns = whole + 0.25 * quarter + nudge;
                    let ((sin, cos), (want_sin, want_cos)) = (one(turns), truth(turns));
                    assert!((sin - want_sin).abs() < ERROR && (cos - want_cos).abs() < ERROR, "{turns} turns");
                }
            }
        }
    }

    #[test]
    fn the_bits_are_pinned() {
        let got = [0.1, 0.3, -7.77, 86_400.123].map(one).map(|(s, c)| [s.to_bits(), c.to_bits()]);
        assert_eq!(got, PINNED, "{got:#018x?}");
    }

    /// Read off once; another value on any machine is a fault.
    const PINNED: [[u64; 2]; 4] = [
        [0x3fe2_cf23_2000_0000, 0x3fe9_e377_a000_0000],
        [0x3fee_6f0d_e000_0000, 0xbfd3_c6ef_8000_0000],
        [0x3fef_bf67_6000_0000, 0x3fc0_0aeb_8000_0000],
        [0x3fe6_575e_e000_0000, 0x3fe6_e8f3_c000_0000],
    ];
}
