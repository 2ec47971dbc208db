//! Queries the agent of a boat for a report of its helm.

use anyhow::{Context, Result, bail};
use bus::clock;
use command_line::observer::Observer;
use messages::helm::{HelmQuestion, HelmReport};
use messages::topic;
use primitives::VehicleId;
use shore::page::is_sound;
use std::time::Duration;

/// Silence after which a boat is assumed to have no agent.
pub(crate) const SILENCE: Duration = Duration::from_secs(10);

/// The helm report of a vehicle; `None` if it currently has no agent.
pub(crate) fn report(
    observer: &Observer,
    vehicle: VehicleId,
    question: HelmQuestion,
) -> Result<Option<HelmReport>> {
    let question = serde_json::to_vec(&question).context("cannot encode the question as JSON")?;
    let key = topic::helm(&observer.game, &observer.info.scenario, vehicle);
    let Some(answer) = observer.bus.ask_node(&key, question, bus::ANSWER)? else {
        return Ok(None);
    };
    let report: Option<HelmReport> =
        serde_json::from_slice(&answer).context("the agent uses a different version of Squall")?;
    let name = &observer.info.scenario.vehicles[vehicle.index()].name;
    let report = report.with_context(|| format!("the agent of {name} has no helm"))?;
    if !is_sound(&report, vehicle, observer.info.scenario.vehicles.len()) {
        bail!("the helm report of {name} is invalid");
    }
    Ok(Some(report))
}

/// The helm report of a vehicle that has an agent. Repeats the query if a busy link dropped the
/// reply.
pub(crate) fn report_of_agent(
    observer: &Observer,
    vehicle: VehicleId,
    question: HelmQuestion,
) -> Result<HelmReport> {
    let start = clock::now();
    loop {
        let asked = clock::now();
        if let Some(report) = report(observer, vehicle, question)? {
            return Ok(report);
        }
        // If no node serves this boat, report this before the reply times out.
        let is_answered_for = clock::since(asked) >= bus::ANSWER;
        if !is_answered_for || clock::since(start) >= SILENCE {
            bail!(
                "{} has no agent",
                observer.info.scenario.vehicles[vehicle.index()].name
            );
        }
    }
}
