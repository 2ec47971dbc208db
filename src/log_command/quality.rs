//! How sensibly the boats in recorded games behaved.

use crate::minds::Minds;
use crate::progress::Progress;
use crate::{output_file, recording_file, screen};
use analysis::Step;
use analysis::quality::{GameQuality, MindState, Quality};
use anyhow::Result;
use primitives::VehicleId;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Prints the figures for all games together, and writes them as JSON.
pub(super) fn print(files: &[PathBuf], json: Option<&Path>) -> Result<()> {
    let mut sum = Quality::default();
    let mut progress = Progress::of(files.len() as u64, "recordings");
    for file in files {
        sum.merge(&of_recording(file)?);
        progress.add();
    }
    progress.end();
    screen::print(&sum.to_string());
    json.map_or(Ok(()), |path| output_file::write_json(path, "the quality", &sum))
}

fn of_recording(file: &Path) -> Result<Quality> {
    let recording = Arc::new(recording_file::open(file, "read")?);
    let mut minds = Minds::new(Arc::clone(&recording));
    let mut quality = GameQuality::new(recording.scenario());
    let damaged = analysis::for_each_step(&recording, |step| {
        let minds: Vec<_> = (0..step.samples.len()).map(|i| mind_state(&mut minds, &step, i)).collect();
        quality.add(&step, &minds);
    });
    if let Some(remark) = damaged.remark() {
        screen::remark(&format!("{}: {remark}", file.display()));
    }
    Ok(quality.end())
}

/// The state of a boat's mind when it gave the order for a step; known only if the scenario's
/// strategy gives the recorded order.
fn mind_state(minds: &mut Minds, step: &Step, vehicle: usize) -> Option<MindState> {
    let (report, order) = minds.report_of(VehicleId::at(vehicle), step.decision.checked_sub(1)?)?;
    (order == step.samples[vehicle].order).then(|| report.into())
}
