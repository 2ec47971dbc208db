//! The rights of other nodes at a hub: the rules for zenoh's access control.
//!
//! Everything that no rule allows is denied. The rules bind nodes linked to the hub, not the hub's
//! own session. Therefore no rule covers the sim's own actions: publishing pictures and gateway
//! reports, answering its queries, declaring its liveliness token, and receiving orders, navigation
//! and reports. Without keys, all other nodes have the same rights; with keys, each has the rights
//! of its role.
//!
//! Topics that the hub forwards are spelled out here, so that nodes cannot invent others. zenoh
//! 1.10 would panic, and kill the sim, if it had to send a key longer than 65535 bytes.

use crate::keys::Identity;
use messages::topic::{self, GameName};
use scenario::{Scenario, Vehicle};
use serde_json::{Value, json};

/// The rights of a node, as topic patterns. `{team}` expands to each of its teams, `{boat}` to each
/// of its boats. Only topics received by the sim alone may have wildcards.
struct Rights {
    publishes: &'static [&'static str],
    hears: &'static [&'static str],
    asks: &'static [&'static str],
    answers: &'static [&'static str],
}

/// Any node that reaches a hub without keys.
const ANYBODY: Rights = Rights {
    publishes: &[
        // Allow all levels below, not just one: without keys, the team in the topic proves nothing,
        // and the sim checks the ticket of each order anyway.
        "order/**",
        "say/{team}",
        "policy/{boat}",
        "nav/{boat}",
        // The sim forwards reports that carry the gateway's ticket. Without keys, any node can
        // publish as a gateway, but none can publish as the sim.
        "report/status/{boat}",
        "report/link/{boat}",
        "control",
        // Anyone who sees danger must be able to stop boats without a secret: without a token and,
        // in games with keys, in any role.
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
/// A team's agents, and policies that propose actions to them. They receive neither the true state
/// nor other teams' pictures and messages.
const TEAM: Rights = Rights {
    publishes: &[
        "order/{team}/*",
        "say/{team}",
        "policy/{boat}",
        "control",
        "stop/{boat}",
    ],
    hears: &[
        "picture/{team}",
        "say/{team}",
        "policy/{boat}",
        "run",
        "control",
        "released",
    ],
    asks: &["scenario", "join/agent/{team}"],
    answers: &["helm/{boat}"],
};
const GATEWAY: Rights = Rights {
    publishes: &[
        "nav/{boat}",
        "report/status/{boat}",
        "report/link/{boat}",
        "control",
        "stop/{boat}",
    ],
    hears: &[
        "external/{boat}",
        "run",
        "control",
        "stop/{boat}",
        "released",
    ],
    asks: &["scenario", "join/gateway/{boat}"],
    answers: &["operate/{boat}"],
};
// An observer receives everything that is published and the decisions of helms. Like every node it
// may stop boats, but it may change nothing else.
const OBSERVER: Rights = Rights {
    publishes: &["control", "stop/{boat}"],
    asks: &["scenario", "events", "water", "helm/{boat}"],
    answers: &[],
    ..ANYBODY
};
// The only role admitted to `operate`: with keys no additional token is required, since it would be
// a second secret for the same right.
const OPERATOR: Rights = Rights {
    publishes: &["control", "stop/{boat}", "policy/{boat}"],
    asks: &[
        "scenario",
        "events",
        "water",
        "helm/{boat}",
        "control",
        "operate/{boat}",
    ],
    ..OBSERVER
};

fn rights(identity: &Identity) -> &'static Rights {
    match identity {
        // The sim opens the hub; no node links as the sim.
        Identity::Sim => &Rights {
            publishes: &[],
            hears: &[],
            asks: &[],
            answers: &[],
        },
        Identity::Team(_) => &TEAM,
        Identity::Gateway(_) => &GATEWAY,
        Identity::Observer => &OBSERVER,
        Identity::Operator => &OPERATOR,
    }
}

/// Whether a node may query `key` at all; without the right, it never gets a reply.
pub(crate) fn may_ask(identity: &Identity, key: &str) -> bool {
    // Check only the kind of topic, so that a node without the right does not wait for a reply. The
    // hub's rule, with topics spelled out, is binding.
    let kind = key.split('/').nth(2);
    rights(identity)
        .asks
        .iter()
        .any(|pattern| pattern.split('/').next() == kind)
}

/// Nodes with the same rights, and the teams and boats that these rights cover.
struct Subject {
    id: String,
    rights: &'static Rights,
    teams: Vec<String>,
    boats: Vec<String>,
}

impl Subject {
    /// The topics for these patterns: one for each team or boat.
    fn keys(&self, game: &GameName, patterns: &[&str]) -> Vec<String> {
        // A rule that denies `frame` does not deny `*`, although `*` includes `frame`; a rule that
        // allows `order/*` does not allow `**`. Therefore all rules allow, and those for outgoing
        // messages have no wildcards.
        let spelled_out = |pattern: &&str| -> Vec<String> {
            if pattern.contains("{team}") {
                self.teams
                    .iter()
                    .map(|team| pattern.replace("{team}", team))
                    .collect()
            } else if pattern.contains("{boat}") {
                self.boats
                    .iter()
                    .map(|boat| pattern.replace("{boat}", boat))
                    .collect()
            } else {
                vec![(*pattern).to_owned()]
            }
        };
        patterns
            .iter()
            .flat_map(spelled_out)
            .map(|topic| topic::matching(game, &topic))
            .collect()
    }

    /// Access rules for kinds of messages, directions (as seen from the hub) and topics.
    fn rules(&self, game: &GameName) -> Vec<Value> {
        let Rights {
            publishes,
            hears,
            asks,
            answers,
        } = self.rights;
        // A node that does not know the game's name searches for all games.
        let tokens = vec![topic::all_alive(game), topic::everyone_alive()];
        let rules: [(&[&str], &[&str], Vec<String>); 10] = [
            (&["put"], &["ingress"], self.keys(game, publishes)),
            (&["put"], &["egress"], self.keys(game, hears)),
            (
                &["declare_subscriber"],
                &["ingress"],
                self.keys(game, hears),
            ),
            (&["query"], &["ingress"], self.keys(game, asks)),
            (&["reply"], &["egress"], self.keys(game, asks)),
            (
                &["declare_queryable", "reply"],
                &["ingress"],
                self.keys(game, answers),
            ),
            (&["query"], &["egress"], self.keys(game, answers)),
            // Subscriptions and queryables are not secret: publishers must know them.
            (
                &["declare_subscriber", "declare_queryable"],
                &["egress"],
                vec![topic::matching(game, "**")],
            ),
            // Outward only: a token declared by another node in the sim's name would be believed.
            // Agents and gateways declare none for the same reason; the hub sees their links.
            (
                &["liveliness_token"],
                &["egress"],
                vec![topic::all_alive(game)],
            ),
            (
                &["liveliness_query", "declare_liveliness_subscriber"],
                &["ingress", "egress"],
                tokens,
            ),
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

/// The subjects of a game, with or without keys.
fn subjects(scenario: &Scenario, has_keys: bool) -> Vec<Subject> {
    let names = |boats: Vec<&Vehicle>| -> Vec<String> {
        boats.into_iter().map(|boat| boat.name.clone()).collect()
    };
    let teams: Vec<String> = scenario
        .teams
        .iter()
        .map(|team| team.name.clone())
        .collect();
    let boats = names(scenario.vehicles.iter().collect());
    let subject = |identity: Identity, teams: &[String], boats: &[String]| Subject {
        id: identity.to_string(),
        rights: rights(&identity),
        teams: teams.to_vec(),
        boats: boats.to_vec(),
    };
    if !has_keys {
        return vec![Subject {
            id: "anybody".to_owned(),
            rights: &ANYBODY,
            teams,
            boats,
        }];
    }
    let mut subjects: Vec<Subject> = [Identity::Observer, Identity::Operator]
        .map(|identity| subject(identity, &teams, &boats))
        .into();
    for (i, team) in teams.iter().enumerate() {
        let own = names(
            scenario
                .vehicles
                .iter()
                .filter(|boat| boat.team.index() == i)
                .collect(),
        );
        subjects.push(subject(
            Identity::Team(team.clone()),
            std::slice::from_ref(team),
            &own,
        ));
    }
    // There may be keys for one gateway per boat, or for one machine that runs all gateways.
    let externals = names(
        scenario
            .externals()
            .map(|boat| &scenario.vehicles[boat.index()])
            .collect(),
    );
    for boat in &externals {
        subjects.push(subject(
            Identity::Gateway(Some(boat.clone())),
            &[],
            std::slice::from_ref(boat),
        ));
    }
    subjects.push(subject(Identity::Gateway(None), &[], &externals));
    subjects
}

/// zenoh's `access_control` setting for the hub of a game, with or without keys.
pub(crate) fn control(game: &GameName, scenario: &Scenario, has_keys: bool) -> Value {
    let all = subjects(scenario, has_keys);
    let mut rules = Vec::new();
    let mut policies = Vec::new();
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
        // Deny by default: anything that a later zenoh adds or a node invents stays closed until a
        // rule above opens it.
        "enabled": true, "default_permission": "deny", "rules": rules,
        "subjects": all.iter().map(subject).collect::<Vec<Value>>(), "policies": policies,
    })
}
