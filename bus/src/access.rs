//! What others may do at a hub: the rules for zenoh's access control.
//!
//! Everything is denied that no rule allows. The rules bind whoever is linked with the hub, not the hub's own session: so what
//! only the sim may do (publish pictures, answer the queries that are its own, be alive as the sim, hear orders and
//! navigation) needs no rule at all.

use game::topic::{self, GameName};
use serde_json::{Value, json};

/// Messages of these kinds, in these directions (as seen from the hub), on topics that match.
struct Rule {
    messages: &'static [&'static str],
    flows: &'static [&'static str],
    topics: &'static [&'static str],
}

/// What everybody may publish.
const PUBLISHED: &[&str] = &["order/*", "say/*/*", "policy/*", "nav/*", "link/*", "status/*", "control"];
/// What everybody may hear.
const HEARD: &[&str] =
    &["frame", "picture/*", "say/*/*", "policy/*", "external/*", "run", "control", "released", "status/*", "link/*"];
/// What everybody may ask.
const ASKED: &[&str] = &["scenario", "events", "water", "join", "control", "helm/*", "operate/*"];
/// What agents and gateways answer.
const ANSWERED: &[&str] = &["helm/*", "operate/*"];

const RULES: &[Rule] = &[
    Rule { messages: &["put"], flows: &["ingress"], topics: PUBLISHED },
    Rule { messages: &["put"], flows: &["egress"], topics: HEARD },
    Rule { messages: &["declare_subscriber"], flows: &["ingress"], topics: HEARD },
    Rule { messages: &["query"], flows: &["ingress"], topics: ASKED },
    Rule { messages: &["reply"], flows: &["egress"], topics: ASKED },
    Rule { messages: &["declare_queryable", "reply"], flows: &["ingress"], topics: ANSWERED },
    Rule { messages: &["query"], flows: &["egress"], topics: ANSWERED },
    // That somebody subscribes or answers here is no secret: publishers must know it.
    Rule { messages: &["declare_subscriber", "declare_queryable"], flows: &["egress"], topics: &["**"] },
    Rule { messages: &["liveliness_token"], flows: &["ingress"], topics: &["alive/agent/*", "alive/gateway/*"] },
    Rule { messages: &["liveliness_token"], flows: &["egress"], topics: &["alive/*/*"] },
    Rule {
        messages: &["liveliness_query", "declare_liveliness_subscriber"],
        flows: &["ingress", "egress"],
        topics: &["alive/*/*"],
    },
];

/// zenoh's setting `access_control` for the hub of a game.
pub(crate) fn control(game: &GameName) -> Value {
    let rules = RULES.iter().enumerate().map(|(i, rule)| {
        let topics = rule.topics.iter().map(|pattern| topic::matching(game, pattern));
        let mut keys: Vec<String> = topics.collect();
        if rule.messages.contains(&"liveliness_query") {
            // Whoever does not know the game's name looks for all games.
            keys.push(topic::everyone_alive());
        }
        json!({
            "id": i.to_string(), "permission": "allow", "key_exprs": keys,
            "messages": rule.messages, "flows": rule.flows,
        })
    });
    let rules: Vec<Value> = rules.collect();
    let ids: Vec<String> = (0..rules.len()).map(|i| i.to_string()).collect();
    json!({
        "enabled": true, "default_permission": "deny", "rules": rules,
        "subjects": [{ "id": "everybody" }],
        "policies": [{ "rules": ids, "subjects": ["everybody"] }],
    })
}
