//! An onlooker: a session that watches a game and asks about it.

use crate::net_args::LeafArgs;
use anyhow::{Context, Result, anyhow, bail};
use bus::Bus;
use bus::lookout::{self, Missing};
use game::VehicleId;
use game::helm::{HelmQuestion, HelmReport};
use game::message::Notice;
use game::topic::{self, GameName, Part};
use std::time::Duration;

const ANSWER: Duration = Duration::from_secs(2);

/// Somebody who looks on.
pub(crate) struct Onlooker {
    pub(crate) bus: Bus,
    pub(crate) game: GameName,
    pub(crate) notice: Notice,
}

impl Onlooker {
    /// Comes to a game that runs.
    pub(crate) fn come(leaf: &LeafArgs) -> Result<Onlooker> {
        let bus = Bus::leaf(&leaf.net()?).context("no game to watch")?;
        let game = match &leaf.game {
            Some(game) => game.clone(),
            None => now(lookout::only_game(&bus))?,
        };
        let notice = now(lookout::notice(&bus, &game))?;
        Ok(Onlooker { bus, game, notice })
    }

    /// The vehicle of this name.
    pub(crate) fn vehicle(&self, name: &str) -> Result<VehicleId> {
        Ok(self.notice.scenario.vehicle_named(name)?)
    }

    /// What a vehicle's helm thinks; nothing if nobody minds it now.
    pub(crate) fn helm(&self, vehicle: VehicleId, question: HelmQuestion) -> Result<Option<HelmReport>> {
        let question = serde_json::to_vec(&question).context("a question is JSON")?;
        let key = topic::helm(&self.game, &self.notice.scenario, vehicle);
        let Some(answer) = self.bus.ask(&key, question, ANSWER)? else { return Ok(None) };
        let report: Option<HelmReport> =
            serde_json::from_slice(&answer).context("the agent is of another version of Squall")?;
        let name = &self.notice.scenario.vehicles[vehicle.index()].name;
        let report = report.with_context(|| format!("the mind of {name} goes by no helm"))?;
        if !is_sound(&report, vehicle, self.notice.scenario.vehicles.len()) {
            bail!("the answer about the helm of {name} makes no sense");
        }
        Ok(Some(report))
    }

    /// Whether the game's sim is still there.
    pub(crate) fn is_on(&self) -> Result<bool> {
        Ok(!self.bus.who_is_alive(&topic::all_alive(&self.game, Part::Sim), ANSWER)?.is_empty())
    }
}

/// Whether a report is about this vehicle and of one piece: an agent that answers is not therefore right.
fn is_sound(report: &HelmReport, vehicle: VehicleId, vehicles: usize) -> bool {
    let is_grid = (1..=3600).contains(&report.courses)
        && (2..=1000).contains(&report.speeds)
        && report.speed_max_m_s.is_finite()
        && report.speed_max_m_s > 0.0;
    let is_whole = |count: usize| count == 0 || count == report.courses * report.speeds;
    report.vehicle == vehicle
        && is_grid
        && report.functions.iter().all(|function| {
            is_whole(function.utilities.len()) && function.contact.is_none_or(|contact| contact.index() < vehicles)
        })
}

/// What must be there now.
fn now<T>(found: Result<T, Missing>) -> Result<T> {
    found.map_err(|missing| match missing {
        Missing::Yet(reason) => anyhow!(reason),
        Missing::Forever(refusal) => anyhow!(refusal),
    })
}

#[cfg(test)]
mod tests {
    use super::is_sound;
    use game::VehicleId;
    use game::helm::{FunctionReport, HelmReport};

    fn report(courses: usize, utilities: usize, contact: u16) -> HelmReport {
        let function = FunctionReport {
            behaviour: "go".to_owned(),
            contact: Some(VehicleId(contact)),
            weight: 1.0,
            utility: None,
            utilities: vec![0.0; utilities],
        };
        HelmReport {
            vehicle: VehicleId(0),
            at: game::SimTime::ZERO,
            program: String::new(),
            mode: String::new(),
            course_deg: None,
            speed_m_s: None,
            hold: None,
            value: None,
            courses,
            speeds: 2,
            speed_max_m_s: 1.0,
            behaviours: vec![],
            variables: vec![],
            functions: vec![function],
        }
    }

    #[test]
    fn answers_that_make_no_sense_are_told_from_those_that_do() {
        let good = report(8, 16, 1);
        assert!(is_sound(&good, VehicleId(0), 2) && is_sound(&report(8, 0, 1), VehicleId(0), 2));
        assert!(!is_sound(&good, VehicleId(1), 2), "of another boat");
        assert!(!is_sound(&good, VehicleId(0), 1), "about a boat that is not there");
        for bad in [report(8, 15, 1), report(usize::MAX, 0, 1), HelmReport { speed_max_m_s: f64::NAN, ..good }] {
            assert!(!is_sound(&bad, VehicleId(0), 2), "{bad:?}");
        }
    }
}
