//! A position as sentences carry it: degrees and minutes run together, then a letter.

use super::number::number;

/// One of the two coordinates.
pub(super) struct Axis {
    degree_digits: usize,
    degrees_max: u32,
    letters: [char; 2],
    /// What is expected in its first and in its second field.
    pub(super) expected: &'static str,
    pub(super) expected_letter: &'static str,
}

pub(super) const LATITUDE: Axis = Axis {
    degree_digits: 2,
    degrees_max: 90,
    letters: ['N', 'S'],
    expected: "ddmm.mmmm up to 90 degrees",
    expected_letter: "N or S",
};

pub(super) const LONGITUDE: Axis = Axis {
    degree_digits: 3,
    degrees_max: 180,
    letters: ['E', 'W'],
    expected: "dddmm.mmmm up to 180 degrees",
    expected_letter: "E or W",
};

impl Axis {
    /// The sign of a letter: north and east are positive.
    pub(super) fn sign(&self, letter: &str) -> Option<f64> {
        let place = self.letters.iter().position(|known| letter.chars().eq([*known]))?;
        Some([1.0, -1.0][place])
    }

    /// Degrees from `ddmm.mmmm`. All digits before the point must be there: without its zeros a position could be
    /// another position.
    pub(super) fn degrees(&self, text: &str) -> Option<f64> {
        let whole = text.split('.').next().unwrap_or_default();
        if whole.len() != self.degree_digits + 2 || !whole.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let (degrees, minutes) = text.split_at_checked(self.degree_digits)?;
        let degrees = number(degrees)?;
        let minutes = number(minutes).filter(|minutes| *minutes < 60.0)?;
        let size_deg = degrees + minutes / 60.0;
        (size_deg <= f64::from(self.degrees_max)).then_some(size_deg)
    }

    /// `ddmm.mmmm,N` with so many decimals of minutes. It is whole steps that are split, so minutes carry.
    pub(super) fn printed(&self, angle_deg: f64, decimals: u32) -> Option<String> {
        if !angle_deg.is_finite() || angle_deg.abs() > f64::from(self.degrees_max) {
            return None;
        }
        let steps_per_minute = 10_u32.pow(decimals);
        // At most 180 * 60 * 100 000 steps.
        let steps = (angle_deg.abs() * f64::from(60 * steps_per_minute)).round() as u32;
        let (minutes, part) = (steps / steps_per_minute, steps % steps_per_minute);
        let letter = self.letters[usize::from(angle_deg < 0.0 && steps > 0)];
        let (degree_digits, part_digits) = (self.degree_digits, decimals as usize);
        let (degrees, minutes) = (minutes / 60, minutes % 60);
        Some(format!("{degrees:0degree_digits$}{minutes:02}.{part:0part_digits$},{letter}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minutes_carry_into_degrees() {
        for (angle_deg, want) in [
            (0.0, "0000.00000,N"),
            (-0.0, "0000.00000,N"),
            (-1e-9, "0000.00000,N"),
            (42.358436, "4221.50616,N"),
            (41.0 + 59.999_994 / 60.0, "4159.99999,N"),
            (41.0 + 59.999_996 / 60.0, "4200.00000,N"),
            (-(8.0 + 59.999_999 / 60.0), "0900.00000,S"),
            (89.999_999_99, "9000.00000,N"),
            (90.0, "9000.00000,N"),
        ] {
            assert_eq!(LATITUDE.printed(angle_deg, 5).as_deref(), Some(want), "{angle_deg}");
        }
        assert_eq!(LONGITUDE.printed(-179.999_999_99, 5).as_deref(), Some("18000.00000,W"));
        assert_eq!(LONGITUDE.printed(-71.087448, 5).as_deref(), Some("07105.24688,W"));
        assert_eq!(LONGITUDE.printed(-80.372_288_3, 4).as_deref(), Some("08022.3373,W"));
        for nowhere in [90.000_001, -91.0, f64::NAN, f64::INFINITY] {
            assert_eq!(LATITUDE.printed(nowhere, 5), None, "{nowhere}");
        }
    }

    #[test]
    fn a_coordinate_has_all_its_digits_and_stays_on_the_globe() {
        for (text, want_deg) in [
            ("4221.50616", Some(42.358436)),
            ("0000", Some(0.0)),
            ("0030", Some(0.5)),
            ("9000.0000", Some(90.0)),
            ("9000.0001", None),
            ("9100.0", None),
            ("4260.0", None),
            ("4259.9999999", Some(42.999_999_998_333)),
            ("421.50616", None),
            ("042.5", None),
            ("04221.5", None),
            ("-221.5", None),
            ("+221.5", None),
            ("42 1.5", None),
            ("4221.", None),
            ("4221.5.5", None),
            ("4221.5e1", None),
            ("nan", None),
            ("४२21", None),
        ] {
            let got_deg = LATITUDE.degrees(text);
            let near = match (got_deg, want_deg) {
                (Some(got_deg), Some(want_deg)) => (got_deg - want_deg).abs() < 1e-12,
                (got_deg, want_deg) => got_deg == want_deg,
            };
            assert!(near, "{text:?}: {got_deg:?}, not {want_deg:?}");
        }
    }
}
