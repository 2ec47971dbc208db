//! A compass swing: the boat turns through all headings, and the deviation of its compass is
//! fitted.
//!
//! The deviation is A + B sin h + C cos h + D sin 2h + E cos 2h at the heading h (Bowditch,
//! *American Practical Navigator*, ch. 6), east positive: it is added to the compass reading to
//! obtain the heading.

use primitives::angle::wrap_pi;
use primitives::math;
use std::f64::consts::TAU;

/// Maximum number of pairs stored.
const PAIRS_MAX: usize = 20_000;
/// Number of heading sectors, each of which needs pairs.
const SECTORS: usize = 12;

/// Pairs of compass and true headings.
#[derive(Clone, Debug, Default)]
pub struct CompassSwing {
    /// True heading, and the correction to the compass reading, rad.
    pairs: Vec<(f64, f64)>,
}

/// The deviation of a compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// A to E, degrees.
    pub a_to_e_deg: [f64; 5],
    /// The standard deviation of the residual, degrees.
    pub residual_deg: f64,
    /// The largest absolute deviation on any heading, degrees.
    pub largest_deg: f64,
}

impl CompassSwing {
    /// Adds a compass heading, corrected for declination, and the simultaneous true heading, rad.
    pub fn add_reading(&mut self, compass_rad: f64, true_rad: f64) {
        if self.pairs.len() < PAIRS_MAX && compass_rad.is_finite() && true_rad.is_finite() {
            self.pairs
                .push((true_rad.rem_euclid(TAU), wrap_pi(true_rad - compass_rad)));
        }
    }

    /// The number of 30-degree sectors in which the boat has pointed.
    pub fn sectors(&self) -> usize {
        let sector = |psi_rad: f64| (psi_rad / TAU * SECTORS as f64) as usize % SECTORS;
        let mut seen = [false; SECTORS];
        self.pairs
            .iter()
            .for_each(|(psi_rad, _)| seen[sector(*psi_rad)] = true);
        seen.iter().filter(|seen| **seen).count()
    }

    /// Fits the deviation by least squares, once the boat has pointed in all directions.
    ///
    /// # Errors
    /// The missing condition.
    pub fn fit(&self) -> Result<Deviation, String> {
        let sectors = self.sectors();
        // With only part of the circle, sin h and sin 2h cannot be separated.
        if sectors < SECTORS {
            return Err(format!(
                "{sectors} of {SECTORS} sectors of 30 degrees were swept, expected all of them"
            ));
        }
        // Relative to the mean, so that angles near half a turn do not wrap.
        let [sin, cos] = self.pairs.iter().fold([0.0; 2], |[s, c], (_, off)| {
            let (sin, cos) = math::sin_cos(*off);
            [s + sin, c + cos]
        });
        let mean_rad = math::atan2(sin, cos);
        let mut normal = [[0.0; 5]; 5];
        let mut right = [0.0; 5];
        for (psi_rad, off_rad) in &self.pairs {
            let row = basis(*psi_rad);
            let off_rad = wrap_pi(off_rad - mean_rad);
            for i in 0..5 {
                right[i] += row[i] * off_rad;
                (0..5).for_each(|j| normal[i][j] += row[i] * row[j]);
            }
        }
        let solved = solve_positive_definite(normal, right);
        let mut found =
            solved.ok_or_else(|| "the headings do not determine a deviation curve".to_owned())?;
        found[0] = wrap_pi(found[0] + mean_rad);
        let value = |psi_rad: f64| {
            basis(psi_rad)
                .iter()
                .zip(found)
                .map(|(base, factor)| base * factor)
                .sum::<f64>()
        };
        let squares = self
            .pairs
            .iter()
            .map(|(psi_rad, off)| wrap_pi(off - value(*psi_rad)))
            .map(|rest| rest * rest);
        let residual_rad = (squares.sum::<f64>() / self.pairs.len() as f64).sqrt();
        let largest_rad = (0..360)
            .map(|deg| value(f64::from(deg).to_radians()).abs())
            .fold(0.0, f64::max);
        Ok(Deviation {
            a_to_e_deg: found.map(f64::to_degrees),
            residual_deg: residual_rad.to_degrees(),
            largest_deg: largest_rad.to_degrees(),
        })
    }
}

impl Deviation {
    /// The lines to paste into the boat's file.
    pub fn toml(&self) -> String {
        let names = ["a_deg", "b_deg", "c_deg", "d_deg", "e_deg"].into_iter();
        let lines = names
            .zip(self.a_to_e_deg)
            .map(|(name, value_deg)| format!("{name} = {value_deg:.2}\n"));
        format!(
            "[compass]\n{}noise_deg = {:.2}\n",
            lines.collect::<String>(),
            self.residual_deg
        )
    }
}

/// The basis functions of A to E.
fn basis(psi_rad: f64) -> [f64; 5] {
    let (sin, cos) = math::sin_cos(psi_rad);
    let (sin_2, cos_2) = math::sin_cos(2.0 * psi_rad);
    [1.0, sin, cos, sin_2, cos_2]
}

/// Solves a symmetric system by Cholesky factorisation (Golub and Van Loan, *Matrix Computations*,
/// 4.2.3 and 3.1); `None` if it is not positive definite. A five-by-five system does not justify a
/// matrix library on the boat.
fn solve_positive_definite(matrix: [[f64; 5]; 5], right: [f64; 5]) -> Option<[f64; 5]> {
    let mut lower = matrix;
    let mut x = right;
    for j in 0..5 {
        for k in 0..j {
            (j..5).for_each(|i| lower[i][j] -= lower[j][k] * lower[i][k]);
        }
        if lower[j][j].is_nan() || lower[j][j] <= 0.0 {
            return None;
        }
        let pivot = lower[j][j].sqrt();
        lower[j][j] = pivot;
        (j + 1..5).for_each(|i| lower[i][j] /= pivot);
    }
    for i in 0..5 {
        x[i] /= lower[i][i];
        (i + 1..5).for_each(|k| x[k] -= x[i] * lower[k][i]);
    }
    for i in (0..5).rev() {
        let known: f64 = (i + 1..5).map(|k| lower[k][i] * x[k]).sum();
        x[i] = (x[i] - known) / lower[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn swung(a_to_e_deg: [f64; 5], noise_deg: f64) -> CompassSwing {
        let mut swing = CompassSwing::default();
        for i in 0..720_u32 {
            let psi_rad = (f64::from(i) * 0.97).to_radians();
            let deviation_deg: f64 = basis(psi_rad)
                .iter()
                .zip(a_to_e_deg)
                .map(|(base, factor)| base * factor)
                .sum();
            let noise_deg = if i % 2 == 0 { noise_deg } else { -noise_deg };
            swing.add_reading(psi_rad - (deviation_deg + noise_deg).to_radians(), psi_rad);
        }
        swing
    }

    proptest! {
        #[test]
        fn the_fit_finds_the_deviation(
            a in -179.0..179.0_f64, rest in prop::array::uniform4(-15.0..15.0_f64), noise_deg in 0.0..2.0_f64,
        ) {
            let want = [a, rest[0], rest[1], rest[2], rest[3]];
            let got = swung(want, noise_deg).fit().expect("all headings");
            for (got, want) in got.a_to_e_deg.iter().zip(want) {
                prop_assert!(wrap_pi((got - want).to_radians()).to_degrees().abs() < 0.3, "{got}, expected {want}");
            }
            prop_assert!((got.residual_deg - noise_deg).abs() < 0.1, "{} of {noise_deg}", got.residual_deg);
        }
    }

    #[test]
    fn a_system_that_is_not_positive_definite_has_no_solution() {
        let scaled = |factor: f64| {
            std::array::from_fn(|i| std::array::from_fn(|j| if i == j { factor } else { 0.0 }))
        };
        assert_eq!(
            solve_positive_definite(scaled(4.0), [4.0; 5]),
            Some([1.0; 5])
        );
        for factor in [0.0, -1.0, f64::NAN] {
            assert_eq!(
                solve_positive_definite(scaled(factor), [4.0; 5]),
                None,
                "{factor}"
            );
        }
    }

    #[test]
    fn half_a_circle_is_no_swing() {
        let mut swing = CompassSwing::default();
        (0..180).for_each(|deg| {
            swing.add_reading(f64::from(deg).to_radians(), f64::from(deg).to_radians())
        });
        assert_eq!(
            swing.fit(),
            Err("6 of 12 sectors of 30 degrees were swept, expected all of them".to_owned())
        );
    }

    #[test]
    fn what_is_to_be_pasted_is_what_boat_files_take() {
        let toml = swung([1.0, 2.0, -3.0, 0.5, 0.25], 0.5)
            .fit()
            .expect("all headings")
            .toml();
        assert!(
            toml.starts_with("[compass]\na_deg = 1.00\nb_deg = 2.00\nc_deg = -3.00\n"),
            "{toml}"
        );
        let folder = tempfile::tempdir().expect("a folder");
        let base = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../scenarios/boats/surveyor_m1_8.toml");
        let base = base.canonicalize().expect("it is there");
        let file = folder.path().join("boat.toml");
        std::fs::write(&file, format!("base = {base:?}\n\n{toml}")).expect("written");
        let boat = scenario::load_file::<scenario::Boat>(&file)
            .unwrap_or_else(|problems| panic!("{problems}"));
        let compass = boat.sensors.compass.expect("it has one");
        assert!(
            (compass.deviation_rad[2].to_degrees() + 3.0).abs() < 0.01,
            "{compass:?}"
        );
    }
}
