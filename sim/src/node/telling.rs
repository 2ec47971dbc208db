//! What onlookers ask a sim for, and what is heard for them only.

use crate::contest::Contest;
use crate::sea::WaveField;
use game::Scenario;
use game::external::LinkBytes;
use game::message::{Message, PolicyProposal, Say};
use game::outcome::EventOutcome;
use game::water::Water;

/// The waves of a game.
#[must_use]
pub fn water(contest: &Contest) -> Water {
    Water { waves: contest.world().sea().waves().map(WaveField::plane_waves).unwrap_or_default() }
}

/// The waves, as JSON.
pub(super) fn water_json(contest: &Contest) -> Vec<u8> {
    serde_json::to_vec(&water(contest)).expect("waves are JSON")
}

/// Everything that has happened so far, as JSON.
pub(super) fn story(contest: &Contest) -> Vec<u8> {
    let scenario = contest.scenario();
    let events = contest.events().iter().map(|logged| EventOutcome::new(scenario, logged));
    serde_json::to_vec(&events.collect::<Vec<_>>()).expect("events are JSON")
}

/// Topics that are heard only to be written down, with their schemas: words, proposals, and what gateways tell.
pub(super) fn heard_topics(scenario: &Scenario) -> Vec<(String, Option<&'static str>)> {
    let boats = scenario.vehicles.iter().map(|vehicle| &vehicle.name);
    let real = || scenario.externals().map(|vehicle| &scenario.vehicles[vehicle.index()].name);
    let says = scenario.teams.iter().map(|team| (format!("say/{}", team.name), Some(Say::SCHEMA)));
    let proposals = boats.map(|name| (format!("policy/{name}"), Some(PolicyProposal::SCHEMA)));
    let links = real().map(|name| (format!("link/{name}"), Some(LinkBytes::SCHEMA)));
    let statuses = real().map(|name| (format!("status/{name}"), None));
    says.chain(proposals).chain(links).chain(statuses).collect()
}
