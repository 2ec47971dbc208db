//! How a game came near to a failure: at which times a distance was less than ever before.

/// Distances are told apart by this much, m.
const STEP_M: f64 = 0.25;

/// A distance in the course of a game: its least value until each time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Approach {
    /// When it was less than ever before, s, and how many steps it was then; by rising time, by falling distance.
    steps: Vec<(f64, i64)>,
}

impl Approach {
    /// The distance at a time.
    pub(crate) fn add(&mut self, at_s: f64, distance_m: f64) {
        if !distance_m.is_finite() {
            return;
        }
        let step = (distance_m / STEP_M).floor() as i64;
        if self.steps.last().is_none_or(|(_, least)| step < *least) {
            self.steps.push((at_s, step));
        }
    }

    /// The least distance of the game, in steps.
    pub(crate) fn least(&self) -> Option<i64> {
        self.steps.last().map(|(_, step)| *step)
    }

    /// When it first was below so many steps, s.
    pub(crate) fn first_below(&self, step: i64) -> Option<f64> {
        let place = self.steps.partition_point(|(_, least)| *least >= step);
        self.steps.get(place).map(|(at_s, _)| *at_s)
    }

    /// As a cell of a table.
    pub(crate) fn to_cell(&self) -> String {
        let cells: Vec<String> = self.steps.iter().map(|(at_s, step)| format!("{at_s}:{step}")).collect();
        cells.join(";")
    }

    /// What a cell of a table says.
    pub(crate) fn of_cell(cell: &str) -> Option<Approach> {
        let step = |text: &str| {
            let (at_s, step) = text.split_once(':')?;
            Some((at_s.parse().ok()?, step.parse().ok()?))
        };
        let steps: Option<Vec<(f64, i64)>> = cell.split(';').filter(|text| !text.is_empty()).map(step).collect();
        Some(Approach { steps: steps? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_known_when_a_distance_was_first_less_and_a_cell_keeps_all_of_it() {
        let mut approach = Approach::default();
        for (at_s, distance_m) in [(0.0, 5.1), (0.1, 4.9), (0.2, 4.95), (0.3, 6.0), (0.4, 2.0), (0.5, -0.1)] {
            approach.add(at_s, distance_m);
        }
        assert_eq!(approach.least(), Some(-1));
        let below = |distance_m: f64| approach.first_below((distance_m / STEP_M) as i64);
        assert_eq!([5.25, 5.0, 4.5, 2.0, 0.0].map(below), [Some(0.0), Some(0.1), Some(0.4), Some(0.5), Some(0.5)]);
        assert_eq!(below(-0.25), None);
        assert_eq!(Approach::of_cell(&approach.to_cell()), Some(approach));
        assert_eq!(Approach::of_cell(""), Some(Approach::default()));
        assert_eq!(Approach::of_cell("1:2;x"), None);
    }
}
