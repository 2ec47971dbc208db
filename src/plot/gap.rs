//! A real boat in the spread of simulated ones, by quantity over time.

use crate::plot::{self, Line, Page, Panel};
use anyhow::Result;
use std::path::Path;
use trial::identify::Gap;

/// Draws the comparison to a file.
pub(crate) fn write(path: &Path, title: String, gap: &Gap) -> Result<()> {
    let panel = |(name, unit, band): &(&'static str, &'static str, trial::identify::Band)| {
        let line = |name: &str, which: usize| {
            let points = band.iter().map(|(at_s, values)| (*at_s, values[which]));
            Line::of(name, points.collect())
        };
        let lines = vec![
            line("97.5 %", 3),
            line("runs: 2.5 %", 1),
            line("median", 2),
            line("boat", 0),
        ];
        Panel::of(name, ["time in s", unit], lines, "")
    };
    Page {
        title,
        columns: 2,
        panel: plot::PANEL,
        panels: gap.bands.iter().map(panel).collect(),
    }
    .write(path)
}
