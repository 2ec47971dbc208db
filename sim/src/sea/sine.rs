//! Sine and cosine of four angles at once, the same bits on every machine.
//!
//! The sea asks for thousands of them a tick. Only sums, products and differences are taken, each rounded by IEEE 754
//! and none fused, so neither the processor nor the platform's C library has a say in the result.

use wide::f64x4;

/// 1.5 · 2^52: what is added to it is rounded to a whole number, half to even, for the mantissa has no bit left behind
/// the point. Good for magnitudes below 2^51.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// sin π r = r (S0 + S1 r² + ...), minimax for |r| ≤ 1/2 by Remez' exchange: off by 1.4e-11 at most.
const SIN: [f64; 6] = [
    3.141_592_653_243_753_5,
    -5.167_712_741_221_658,
    2.550_162_794_723_009_4,
    -0.599_247_404_921_521_5,
    0.082_031_230_209_691_8,
    -0.007_000_500_458_596_019,
];

/// cos π r = C0 + C1 r² + ..., likewise: off by 8e-13 at most.
const COS: [f64; 7] = [
    0.999_999_999_999_251_8,
    -4.934_802_200_250_964,
    4.058_712_107_589_445,
    -1.335_262_316_149_123,
    0.235_325_443_434_391_16,
    -0.025_776_340_770_731_9,
    0.001_840_021_894_814_297,
];

/// The largest error of [`sin_cos_turns`], apart from what the angle itself was rounded by.
#[cfg(test)]
pub(crate) const ERROR: f64 = 6e-11;

/// Sine and cosine of angles in turns: 1 is all the way round. Within 6e-11 up to 2^51 turns either way.
///
/// In turns the reduction is a subtraction without error, however far round the angle is.
/// The polynomials are of half the angle, between a quarter turn either way, and no quadrant has to be told apart.
#[inline(always)]
pub(crate) fn sin_cos_turns(turns: f64x4) -> (f64x4, f64x4) {
    let rounder = f64x4::splat(ROUNDER);
    let r = turns - ((turns + rounder) - rounder);
    let x = r * r;
    let powers = [x, x * x, (x * x) * (x * x)];
    let sin_half = cubic([SIN[0], SIN[1], SIN[2], SIN[3]], powers) + line(SIN[4], SIN[5], x) * powers[2];
    let sin_half = sin_half * r;
    let high = line(COS[4], COS[5], x) + f64x4::splat(COS[6]) * powers[1];
    let cos_half = cubic([COS[0], COS[1], COS[2], COS[3]], powers) + high * powers[2];
    let sin_twice = sin_half + sin_half;
    (sin_twice * cos_half, f64x4::ONE - sin_twice * sin_half)
}

/// c0 + c1 x + c2 x² + c3 x³, of x, x² and more (Estrin): a chain half as long as Horner's, so less waiting.
#[inline(always)]
fn cubic(c: [f64; 4], [x, x2, _]: [f64x4; 3]) -> f64x4 {
    line(c[0], c[1], x) + line(c[2], c[3], x) * x2
}

/// c0 + c1 x.
#[inline(always)]
fn line(c0: f64, c1: f64, x: f64x4) -> f64x4 {
    f64x4::splat(c0) + f64x4::splat(c1) * x
}

/// The sum of four numbers, always in the same order.
#[inline(always)]
pub(crate) fn sum(lanes: f64x4) -> f64 {
    let [a, b, c, d] = lanes.to_array();
    (a + b) + (c + d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::stream::Stream;

    fn one(turns: f64) -> (f64, f64) {
        let (sin, cos) = sin_cos_turns(f64x4::splat(turns));
        (sin.to_array()[0], cos.to_array()[0])
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
        [0x3fe2_cf23_0473_ae62, 0x3fe9_e377_9b99_14cf],
        [0x3fee_6f0e_1342_9dfe, 0xbfd3_c6ef_3725_a160],
        [0x3fef_bf67_5480_e651, 0x3fc0_0aeb_5da0_1cd8],
        [0x3fe6_575f_013d_6f67, 0x3fe6_e8f3_a08e_8cae],
    ];
}
