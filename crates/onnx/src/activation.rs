//! Transcendental functions with the same bits on every machine, in single precision.

/// The hyperbolic tangent, accurate to about three units in the last place.
///
/// This is the rational function of Eigen (`generic_fast_tanh_float`), which ONNX Runtime also
/// uses. It has only sums, products and one division, so that computing a layer's values
/// vectorises. `libm::tanhf` takes longer than the layer's sums.
#[inline]
pub fn tanh(x: f32) -> f32 {
    const ODD: [f32; 7] = [
        -2.760_768_5e-16,
        2.000_188e-13,
        -8.604_672e-11,
        5.122_297e-8,
        1.485_722_4e-5,
        6.372_619_3e-4,
        4.893_524_6e-3,
    ];
    const EVEN: [f32; 4] = [1.198_258_4e-6, 1.185_347_1e-4, 2.268_434_6e-3, 4.893_525e-3];
    /// From this value up, the result is 1 in single precision.
    const END: f32 = 7.905_311;
    /// Up to this value, the result is `x`, which is more accurate than the quotient.
    const LINEAR: f32 = 0.0004;
    let above = if x < -END { -END } else { x };
    let inside = if above > END { END } else { above };
    let square = inside * inside;
    let [of_odd, of_even] = [&ODD[..], &EVEN].map(|factors| {
        factors
            .iter()
            .fold(0.0, |sum, factor| sum * square + factor)
    });
    let quotient = inside * of_odd / of_even;
    if x.abs() < LINEAR { x } else { quotient }
}

/// The logistic function, 1 / (1 + exp(-x)).
pub(super) fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + libm::expf(-x))
}

/// ln(1 + exp(x)), without overflow.
pub(super) fn softplus(x: f32) -> f32 {
    if x > 0.0 {
        x + libm::log1pf(libm::expf(-x))
    } else {
        libm::log1pf(libm::expf(x))
    }
}

/// The Gaussian error linear unit: x times the normal distribution function.
pub(super) fn gelu(x: f32) -> f32 {
    0.5 * x * (1.0 + libm::erff(x * std::f32::consts::FRAC_1_SQRT_2))
}

/// The approximation of [`gelu`] with a hyperbolic tangent.
pub(super) fn gelu_by_tanh(x: f32) -> f32 {
    // sqrt(2 / pi)
    const FACTOR: f32 = 0.797_884_6;
    0.5 * x * (1.0 + tanh(FACTOR * (x + 0.044_715 * x * x * x)))
}

#[cfg(test)]
mod tests {
    use super::tanh;

    #[test]
    fn the_hyperbolic_tangent_is_that_of_libm_to_four_units_in_the_last_place() {
        const ERROR_MAX: f32 = 4.0 * f32::EPSILON;
        let mut worst = (0.0, 0.0);
        // From 1e-9 to 30 in steps of a tenth of a percent, with both signs.
        let numbers =
            std::iter::successors(Some(1e-9_f32), |x| Some(x * 1.001)).take_while(|x| *x < 30.0);
        for x in numbers.flat_map(|x| [x, -x]) {
            let got = tanh(x);
            let want = libm::tanhf(x);
            assert!(got.abs() <= 1.0, "{x}: {got}");
            let error = ((got - want) / want).abs();
            worst = if error > worst.1 { (x, error) } else { worst };
        }
        assert!(worst.1 < ERROR_MAX, "{worst:?}");
    }

    #[test]
    fn the_hyperbolic_tangent_of_what_is_not_finite_is_the_usual_one() {
        assert_eq!(
            [0.0, -0.0, f32::INFINITY, f32::NEG_INFINITY, f32::MAX].map(|x| tanh(x).to_bits()),
            [
                0.0_f32.to_bits(),
                (-0.0_f32).to_bits(),
                tanh(30.0).to_bits(),
                tanh(-30.0).to_bits(),
                tanh(30.0).to_bits()
            ]
        );
        assert!(tanh(f32::NAN).is_nan());
    }
}
