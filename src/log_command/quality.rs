//! Judges how sensibly the boats behaved in recorded games.

use crate::minds::Minds;
use crate::progress::Progress;
use crate::{output_file, recording_file, screen};
use analysis::Step;
use analysis::quality::{GameQuality, MindState, Quality};
use anyhow::Result;
use primitives::VehicleId;
use recording::FRAME;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Prints the figures for all games combined, and writes them as JSON if requested.
pub(super) fn print(files: &[PathBuf], json: Option<&Path>) -> Result<()> {
    let mut sum = Quality::default();
    let mut progress = Progress::of(0, "decisions");
    for file in files {
        sum.merge(&of_recording(file, &mut progress)?);
    }
    progress.end();
    screen::print(&sum.to_string());
    json.map_or(Ok(()), |path| {
        output_file::write_json(path, "the quality report", &sum)
    })
}

fn of_recording(file: &Path, progress: &mut Progress) -> Result<Quality> {
    let recording = Arc::new(recording_file::open(file, "read")?);
    progress.expect(
        recording
            .bag()
            .topics()
            .get(FRAME)
            .map_or(0, |count| *count as u64),
    );
    let mut minds = Minds::new(Arc::clone(&recording));
    let mut quality = GameQuality::new(recording.scenario());
    let damaged = analysis::for_each_step(&recording, |step| {
        let minds: Vec<_> = (0..step.samples.len())
            .map(|i| mind_state(&mut minds, &step, i))
            .collect();
        quality.add(&step, &minds);
        progress.add_with(|| file.display().to_string());
    });
    if let Some(remark) = damaged.remark() {
        screen::remark(&format!("{}: {remark}", file.display()));
    }
    Ok(quality.end())
}

/// The state of a boat's mind when it gave the order for a step; known only if the scenario's
/// strategy reproduces the recorded order.
fn mind_state(minds: &mut Minds, step: &Step, vehicle: usize) -> Option<MindState> {
    let id = VehicleId::at(vehicle);
    let order = minds.decide(id, step.decision.checked_sub(1)?, false)?;
    (order == step.samples[vehicle].order)
        .then(|| minds.report(id).map(MindState::from))
        .flatten()
}
