//! The charge of a lithium battery from its voltage.

use primitives::math;

/// Voltage of a cell at rest by the fraction of charge left; typical of NMC cells.
const CELL_V: [(f64, f64); 9] = [
    (0.0, 3.00),
    (0.05, 3.30),
    (0.1, 3.42),
    (0.2, 3.50),
    (0.3, 3.57),
    (0.5, 3.70),
    (0.7, 3.85),
    (0.9, 4.05),
    (1.0, 4.18),
];

/// Voltage of a cell at rest with this fraction of its charge left, V.
#[cfg(any(feature = "emulator", test))]
pub(crate) fn cell_volts(left: f64) -> f64 {
    math::interpolate(CELL_V, left)
}

/// The fraction of charge left in a cell with this voltage at rest (V); `None` if a lithium cell
/// cannot have this voltage. Under load, the result is too low.
pub(crate) fn charge_left(cell_v: f64) -> Option<f64> {
    let charge = math::interpolate(CELL_V.map(|(left, volts)| (volts, left)), cell_v);
    (2.5..=4.4).contains(&cell_v).then_some(charge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_charge_and_the_voltage_of_a_cell_match() {
        // Boats reported 24.8 V on seven cells with 15433 of 57741 left.
        assert!((charge_left(24.8 / 7.0).unwrap() - 15433.0 / 57741.0).abs() < 0.02);
        for left in [0.0, 0.07, 0.5, 0.95, 1.0] {
            assert!(
                (charge_left(cell_volts(left)).unwrap() - left).abs() < 1e-9,
                "{left}"
            );
        }
        assert_eq!(
            [2.0, 2.9, 4.3, 5.0].map(charge_left),
            [None, Some(0.0), Some(1.0), None]
        );
    }
}
