//! What others may do at a hub: the rules for zenoh's access control.
//!
//! Everything is denied that no rule allows. The rules bind whoever is linked with the hub, not the hub's own session: so what
//! only the sim may do (publish pictures and what gateways report, answer the queries that are its own, be alive as the sim,
//! hear orders, navigation and reports) needs no rule at all. Without keys, all others have the same rights; with keys each has those of its part.
//!
//! What the hub sends on has a topic that is spelled out here, none that others can make up: zenoh 1.10 panics, and the sim with
//! it, where it has to send a key of more than 65535 bytes.

use crate::keys::Identity;
use messages::topic::{self, GameName};
use scenario::{Scenario, Vehicle};
use serde_json::{Value, json};

/// What somebody may do, by patterns of topics. `{team}` stands for each of its teams, `{boat}` for each of its boats; only what the
/// sim alone hears may have wildcards.
struct Rights {
    publishes: &'static [&'static str],
    hears: &'static [&'static str],
    asks: &'static [&'static str],
    answers: &'static [&'static str],
}

/// Anybody who reaches a hub without keys.
const ANYBODY: Rights = Rights {
    publishes: &[
        // Everything below, not one level: without keys the team in the key says nothing, and
        // the sim checks the ticket of each order anyway.
        "order/**",
        "say/{team}",
        "policy/{boat}",
        "nav/{boat}",
        // Reports go to the sim with the gateway's ticket, and on from there: without keys
        // anybody can publish as a gateway, but nobody can publish what the sim does.
        "report/status/{boat}",
        "report/link/{boat}",
        "control",
        // Whoever sees danger must not look for a secret first, so everybody may stop boats:
        // without a token and, with keys, by any part of the game.
        "stop/{boat}",
    ],
    hears: &[
        "stop/{boat}",
        "frame",
        "picture/{team}",
        "say/{team}",
        "policy/{boat}",
        "external/{boat}",
        "run",
        "control",
        "released",
        "status/{boat}",
        "link/{boat}",
    ],
    asks: &[
        "scenario",
        "events",
        "water",
        "join/agent",
        "join/agent/{team}",
        "join/gateway",
        "join/gateway/{boat}",
        "control",
        "helm/{boat}",
        "operate/{boat}",
    ],
    answers: &["helm/{boat}", "operate/{boat}"],
};
/// The agents of a team, and policies that propose to them: no truth, and nothing of other teams.
const TEAM: Rights = Rights {
    publishes: &["order/{team}/*", "say/{team}", "policy/{boat}", "control", "stop/{boat}"],
    hears: &["picture/{team}", "say/{team}", "policy/{boat}", "run", "control", "released"],
    asks: &["scenario", "join/agent/{team}"],
    answers: &["helm/{boat}"],
};
const GATEWAY: Rights = Rights {
    publishes: &["nav/{boat}", "report/status/{boat}", "report/link/{boat}", "control", "stop/{boat}"],
    hears: &["external/{boat}", "frame", "run", "control", "stop/{boat}", "released"],
    asks: &["scenario", "join/gateway/{boat}"],
    answers: &["operate/{boat}"],
};
// It sees all that is published, and what helms decide, but changes nothing: only stops are
// open to it, as to everybody.
const OBSERVER: Rights = Rights {
    publishes: &["control", "stop/{boat}"],
    asks: &["scenario", "events", "water", "helm/{boat}"],
    answers: &[],
    ..ANYBODY
};
// The only part that is let through to `operate`: with keys no token is asked for as well,
// since it would be a second secret for the same right.
const OPERATOR: Rights = Rights {
    publishes: &["control", "stop/{boat}", "policy/{boat}"],
    asks: &["scenario", "events", "water", "helm/{boat}", "control", "operate/{boat}"],
    ..OBSERVER
};

fn rights(identity: &Identity) -> &'static Rights {
    match identity {
        // It opens the hub: nobody is linked as the sim.
        Identity::Sim => &Rights { publishes: &[], hears: &[], asks: &[], answers: &[] },
        Identity::Team(_) => &TEAM,
        Identity::Gateway(_) => &GATEWAY,
        Identity::Observer => &OBSERVER,
        Identity::Operator => &OPERATOR,
    }
}

/// Whether somebody may ask at `key` at all: no answer comes where it may not.
pub(crate) fn may_ask(identity: &Identity, key: &str) -> bool {
    // By the kind alone: this check only spares a node that may not ask the wait for an answer.
    // What binds is the rule at the hub, which is spelled out.
    let kind = key.split('/').nth(2);
    rights(identity).asks.iter().any(|pattern| pattern.split('/').next() == kind)
}

/// The rules for whoever has the rights, for its teams and boats.
struct Subject {
    id: String,
    rights: &'static Rights,
    teams: Vec<String>,
    boats: Vec<String>,
}

impl Subject {
    /// Topics of these patterns.
    fn keys(&self, game: &GameName, patterns: &[&str]) -> Vec<String> {
        // A rule that denies `frame` does not deny `*`, which means `frame` among others; a
        // rule that allows `order/*` does not allow `**`. So there are only rules that allow,
        // and none has a wildcard where something goes out.
        let spelled_out = |pattern: &&str| -> Vec<String> {
            if pattern.contains("{team}") {
                self.teams.iter().map(|team| pattern.replace("{team}", team)).collect()
            } else if pattern.contains("{boat}") {
                self.boats.iter().map(|boat| pattern.replace("{boat}", boat)).collect()
            } else {
                vec![(*pattern).to_owned()]
            }
        };
        patterns.iter().flat_map(spelled_out).map(|topic| topic::matching(game, &topic)).collect()
    }

    /// The rules: messages of these kinds, in these directions (as seen from the hub), on these topics.
    fn rules(&self, game: &GameName) -> Vec<Value> {
        let Rights { publishes, hears, asks, answers } = self.rights;
        // Whoever does not know the game's name looks for all games.
        let tokens = vec![topic::all_alive(game), topic::everyone_alive()];
        let rules: [(&[&str], &[&str], Vec<String>); 10] = [
            (&["put"], &["ingress"], self.keys(game, publishes)),
            (&["put"], &["egress"], self.keys(game, hears)),
            (&["declare_subscriber"], &["ingress"], self.keys(game, hears)),
            (&["query"], &["ingress"], self.keys(game, asks)),
            (&["reply"], &["egress"], self.keys(game, asks)),
            (&["declare_queryable", "reply"], &["ingress"], self.keys(game, answers)),
            (&["query"], &["egress"], self.keys(game, answers)),
            // That somebody subscribes or answers here is no secret: publishers must know it.
            (&["declare_subscriber", "declare_queryable"], &["egress"], vec![topic::matching(game, "**")]),
            // Only outward: a token that others show in the sim's name would be believed.
            // Agents and gateways have none for the same reason; the hub sees their links.
            (&["liveliness_token"], &["egress"], vec![topic::all_alive(game)]),
            (&["liveliness_query", "declare_liveliness_subscriber"], &["ingress", "egress"], tokens),
        ];
        let mut json = Vec::new();
        for (messages, flows, keys) in rules {
            if !keys.is_empty() {
                let id = format!("{} {}", self.id, json.len());
                json.push(json!({
                    "id": id, "permission": "allow", "key_exprs": keys, "messages": messages, "flows": flows,
                }));
            }
        }
        json
    }
}

/// Those whom a game knows, with or without keys.
fn subjects(scenario: &Scenario, has_keys: bool) -> Vec<Subject> {
    let names = |boats: Vec<&Vehicle>| -> Vec<String> { boats.into_iter().map(|boat| boat.name.clone()).collect() };
    let teams: Vec<String> = scenario.teams.iter().map(|team| team.name.clone()).collect();
    let boats = names(scenario.vehicles.iter().collect());
    let subject = |identity: Identity, teams: &[String], boats: &[String]| Subject {
        id: identity.to_string(),
        rights: rights(&identity),
        teams: teams.to_vec(),
        boats: boats.to_vec(),
    };
    if !has_keys {
        return vec![Subject { id: "anybody".to_owned(), rights: &ANYBODY, teams, boats }];
    }
    let mut subjects: Vec<Subject> =
        [Identity::Observer, Identity::Operator].map(|identity| subject(identity, &teams, &boats)).into();
    for (i, team) in teams.iter().enumerate() {
        let own = names(scenario.vehicles.iter().filter(|boat| boat.team.index() == i).collect());
        subjects.push(subject(Identity::Team(team.clone()), std::slice::from_ref(team), &own));
    }
    // Keys may be made for one gateway on each boat, or for one machine that has all of them.
    let externals = names(scenario.externals().map(|boat| &scenario.vehicles[boat.index()]).collect());
    for boat in &externals {
        subjects.push(subject(Identity::Gateway(Some(boat.clone())), &[], std::slice::from_ref(boat)));
    }
    subjects.push(subject(Identity::Gateway(None), &[], &externals));
    subjects
}

/// zenoh's setting `access_control` for the hub of a game, with or without keys.
pub(crate) fn control(game: &GameName, scenario: &Scenario, has_keys: bool) -> Value {
    let all = subjects(scenario, has_keys);
    let (mut rules, mut policies) = (Vec::new(), Vec::new());
    for subject in &all {
        let own = subject.rules(game);
        let ids: Vec<&Value> = own.iter().map(|rule| &rule["id"]).collect();
        policies.push(json!({ "rules": ids, "subjects": [&subject.id] }));
        rules.extend(own);
    }
    let subject = |subject: &Subject| {
        if has_keys {
            json!({ "id": &subject.id, "cert_common_names": [&subject.id] })
        } else {
            json!({ "id": &subject.id })
        }
    };
    json!({
        // Deny by default: what a later zenoh adds, or somebody makes up, is closed until it is
        // written down above.
        "enabled": true, "default_permission": "deny", "rules": rules,
        "subjects": all.iter().map(subject).collect::<Vec<Value>>(), "policies": policies,
    })
}
