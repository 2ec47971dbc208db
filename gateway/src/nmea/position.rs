//! A position as it appears in sentences: degrees and minutes without a separator, then a letter.

use super::number::number;

/// One of the two coordinates.
pub(super) struct Axis {
    degree_digits: usize,
    degrees_max: u32,
    letters: [char; 2],
    /// The expected contents of its first and second field.
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
    /// The sign for a letter: north and east are positive.
    pub(super) fn sign(&self, letter: &str) -> Option<f64> {
        let place = self
            .letters
            .iter()
            .position(|known| letter.chars().eq([*known]))?;
        Some([1.0, -1.0][place])
    }

    /// Degrees from `ddmm.mmmm`. All digits before the point are required.
    pub(super) fn degrees(&self, text: &str) -> Option<f64> {
        let whole = text.split('.').next().unwrap_or_default();
        // Without a leading zero, degrees shift into minutes: the longitude 8022.3 could mean 802
        // degrees or 80.
        if whole.len() != self.degree_digits + 2 || !whole.bytes().all(|byte| byte.is_ascii_digit())
        {
            return None;
        }
        let (degrees, minutes) = text.split_at_checked(self.degree_digits)?;
        let degrees = number(degrees)?;
        let minutes = number(minutes).filter(|minutes| *minutes < 60.0)?;
        let size_deg = degrees + minutes / 60.0;
        (size_deg <= f64::from(self.degrees_max)).then_some(size_deg)
    }

    /// `ddmm.mmmm,N` with this many decimal places of minutes. Rounds to whole steps first, so that
    /// minutes carry into degrees.
    pub(super) fn printed(&self, angle_deg: f64, decimals: u32) -> Option<String> {
        if !angle_deg.is_finite() || angle_deg.abs() > f64::from(self.degrees_max) {
            return None;
        }
        let steps_per_minute = 10_u32.pow(decimals);
        // At most 180 * 60 * 100 000 steps. In whole steps, 59.999996 minutes become the next
        // degree and never "60.00000".
        let steps = (angle_deg.abs() * f64::from(60 * steps_per_minute)).round() as u32;
        let minutes = steps / steps_per_minute;
        let part = steps % steps_per_minute;
        // A coordinate that rounds to zero is north or east: "0000.00000,S" would be a second
        // representation of the same position.
        let letter = self.letters[usize::from(angle_deg < 0.0 && steps > 0)];
        let degree_digits = self.degree_digits;
        let part_digits = decimals as usize;
        let degrees = minutes / 60;
        let minutes = minutes % 60;
        Some(format!(
            "{degrees:0degree_digits$}{minutes:02}.{part:0part_digits$},{letter}"
        ))
    }
}
