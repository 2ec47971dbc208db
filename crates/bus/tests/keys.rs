//! Keys of a game: which nodes are admitted, what each may do, and the errors of refused nodes.

use bus::keys::{Bundle, Identity, make};
use bus::{Bus, BusError, Delivery, Net, Priority, Query, Watched, clock};
use messages::topic::{self, GameName};
use scenario::Scenario;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(10);
const DAY: Duration = Duration::from_secs(24 * 3600);

fn game() -> GameName {
    GameName::new("keys").expect("a name")
}

/// A scenario in which blue one and red one are real boats.
fn scenario() -> Scenario {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/mixed_2v2.toml");
    scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

fn team(name: &str) -> Identity {
    Identity::Team(name.to_owned())
}

/// Keys for all identities and for a sim at these hosts, valid for this long.
fn keys(hosts: &[&str], valid: Duration) -> tempfile::TempDir {
    bus::restart_for_keys().expect("the tests start again");
    let folder = tempfile::tempdir().expect("a folder");
    let boat = Identity::Gateway(Some("red_one".to_owned()));
    let sim = Identity::Sim;
    let any = Identity::Gateway(None);
    let all = [
        sim,
        team("blue"),
        team("red"),
        any,
        boat,
        Identity::Observer,
        Identity::Operator,
    ];
    let hosts: Vec<String> = hosts.iter().map(|host| (*host).to_owned()).collect();
    make(folder.path(), &all, &hosts, valid).expect("keys");
    folder
}

fn bundle(keys: &tempfile::TempDir, identity: &str) -> Option<Arc<Bundle>> {
    Some(Arc::new(
        Bundle::load(&keys.path().join(identity)).expect("good keys"),
    ))
}

/// A hub, and its endpoint.
fn hub(keys: Option<Arc<Bundle>>) -> (Result<Bus, BusError>, String) {
    hub_over("tcp", keys)
}

fn hub_over(transport: &str, keys: Option<Arc<Bundle>>) -> (Result<Bus, BusError>, String) {
    let endpoint = format!(
        "{transport}/127.0.0.1:{}",
        bus::free_port(false).expect("a port")
    );
    let net = Net {
        listen: vec![endpoint.clone()],
        keys,
        ..Net::default()
    };
    (Bus::hub(&net, &game(), &scenario()), endpoint)
}

fn leaf(endpoint: &str, keys: Option<Arc<Bundle>>) -> Result<Bus, BusError> {
    Bus::leaf(&Net {
        connect: vec![endpoint.to_owned()],
        keys,
        ..Net::default()
    })
}

fn refused(endpoint: &str, keys: Option<Arc<Bundle>>) -> String {
    match leaf(endpoint, keys) {
        Ok(_) => panic!("it is admitted"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn whose_keys_do_not_fit_is_told_why() {
    let own = keys(&["127.0.0.1"], DAY);
    let foreign = keys(&["127.0.0.1"], DAY);
    let elsewhere = keys(&["sim.example"], DAY);
    let (sim, endpoint) = hub(bundle(&own, "sim"));
    let _sim = sim.expect("it listens");
    let blue = leaf(&endpoint, bundle(&own, "team-blue")).expect("it is admitted");
    assert_eq!(
        blue.keys.as_ref().map(|keys| &keys.identity),
        Some(&team("blue"))
    );
    let text = refused(&endpoint, bundle(&foreign, "team-blue"));
    assert!(
        text.contains("different authority") && text.contains(endpoint.trim_start_matches("tcp/")),
        "{text}"
    );
    assert!(
        matches!(leaf(&endpoint, None), Err(BusError::NeedsKeys(_))),
        "no keys"
    );
    let text = refused(&endpoint, bundle(&own, "sim"));
    assert!(text.contains("are only for serving games"), "{text}");
    let (sim, endpoint) = hub(bundle(&own, "team-blue"));
    let text = sim.err().expect("only the sim's keys serve").to_string();
    assert!(text.contains("not those of team-blue"), "{text}");
    assert!(
        matches!(leaf(&endpoint, None), Err(BusError::Open { .. })),
        "nothing is listening"
    );
    let (sim, endpoint) = hub(bundle(&elsewhere, "sim"));
    let _sim = sim.expect("it listens");
    let text = refused(&endpoint, bundle(&elsewhere, "observer"));
    assert!(
        text.contains("--host 127.0.0.1") && text.contains("sim.example"),
        "{text}"
    );
    let (sim, endpoint) = hub(None);
    let _sim = sim.expect("it listens");
    let text = refused(&endpoint, bundle(&own, "observer"));
    assert!(text.contains("does not use TLS"), "{text}");
}

#[test]
fn keys_that_are_over_or_no_keys_are_refused_before_anything_is_opened() {
    let own = keys(&["localhost"], Duration::ZERO);
    clock::rest(Duration::from_millis(1100));
    let problem = |path: &Path| Bundle::load(path).expect_err("it is refused").to_string();
    let text = problem(&own.path().join("observer"));
    assert!(
        text.contains("certificate.pem") && text.contains("expired at"),
        "{text}"
    );
    let text = problem(own.path());
    assert!(
        text.contains(
            "the bundles gateway, gateway-red_one, observer, operator, sim, team-blue, team-red"
        ),
        "{text}"
    );
    let own = keys(&["localhost"], DAY);
    let folder = own.path().join("observer");
    std::fs::copy(own.path().join("operator/key.pem"), folder.join("key.pem"))
        .expect("it is copied");
    let text = problem(&folder);
    assert!(
        text.contains("key.pem: is not the key of certificate.pem"),
        "{text}"
    );
    for (file, damaged, want) in [
        ("key.pem", "", "key.pem: contains no PEM private key"),
        (
            "certificate.pem",
            "-----BEGIN CERTIFICATE-----\n!\n-----END CERTIFICATE-----\n",
            "certificate.pem: is damaged",
        ),
        (
            "certificate.pem",
            "hello",
            "certificate.pem: contains no PEM certificate",
        ),
        (
            "authority.pem",
            "",
            "authority.pem: contains no PEM certificate",
        ),
    ] {
        let folder = own.path().join("team-red");
        let before = std::fs::read(folder.join(file)).expect("it is there");
        std::fs::write(folder.join(file), damaged).expect("it is written");
        let text = problem(&folder);
        assert!(text.contains(want), "{text}");
        std::fs::write(folder.join(file), before).expect("it is written");
        assert!(Bundle::load(&folder).is_ok());
    }
}

#[test]
fn keys_are_for_their_owner_only_and_never_written_over() {
    use std::os::unix::fs::PermissionsExt;
    let own = keys(&["localhost"], DAY);
    let mode = |path: &str| {
        own.path()
            .join(path)
            .metadata()
            .expect("it is there")
            .permissions()
            .mode()
            & 0o777
    };
    assert_eq!(
        [mode("sim"), mode("sim/key.pem"), mode("team-blue/key.pem")],
        [0o700, 0o600, 0o600]
    );
    let again = make(own.path(), &[Identity::Observer], &[], DAY)
        .expect_err("it already exists")
        .to_string();
    assert!(again.contains("observer"), "{again}");
    assert_eq!(
        Bundle::load(&own.path().join("sim"))
            .expect("good keys")
            .hosts,
        ["localhost"]
    );
}

/// Whether `to` receives messages published by `from`. False if only a later message arrives.
fn is_heard(from: &Bus, to: &Bus, word: &str, free: &str) -> bool {
    let heard = Arc::new(Watched::new((false, false)));
    let [of_word, of_free] = [Arc::clone(&heard), Arc::clone(&heard)];
    let key = |word: &str| topic::matching(&game(), word);
    let _subscriptions = (
        to.subscribe(key(word), move |_| {
            of_word.visit(|(heard, _)| *heard = true)
        })
        .expect("open"),
        to.subscribe(key(free), move |_| {
            of_free.visit(|(_, heard)| *heard = true)
        })
        .expect("open"),
    );
    // QUIC datagrams are subject to the same rights as reliable messages.
    let publisher = |word| {
        from.publisher_with(key(word), Priority::Normal, Delivery::Newest)
            .expect("open")
    };
    let asked = publisher(word);
    let sure = publisher(free);
    let start = clock::now();
    while !heard.wait(Duration::from_millis(20), |(_, free)| *free) {
        assert!(clock::since(start) < LIMIT, "nothing gets through at all");
        asked.send_raw(vec![1]).expect("open");
        sure.send_raw(vec![1]).expect("open");
    }
    // Publish once more, now that all nodes know each other.
    asked.send_raw(vec![1]).expect("open");
    heard.visit(|(_, free)| *free = false);
    sure.send_raw(vec![1]).expect("open");
    assert!(heard.wait(LIMIT, |(_, free)| *free), "it came before");
    heard.visit(|(word, _)| *word)
}

fn check(who: &str, did: bool, words: &str, what: &str) {
    let may = words.split(' ').any(|word| who == word);
    assert_eq!(did, may, "{who} {what}");
}

/// Topics that the sim publishes, and their receivers.
const HEARD: [(&str, &str); 9] = [
    ("frame", "observer operator"),
    ("picture/blue", "team-blue observer operator"),
    ("picture/red", "team-red observer operator"),
    ("say/blue", "team-blue observer operator"),
    (
        "external/red_one",
        "gateway gateway-red_one observer operator",
    ),
    ("external/blue_one", "gateway observer operator"),
    ("order/blue/x", ""),
    ("nav/red_one", ""),
    (
        "released",
        "team-blue team-red gateway gateway-red_one observer operator",
    ),
];
/// Topics that other nodes publish, and the nodes whose messages the sim receives.
const PUBLISHED: [(&str, &str); 17] = [
    ("order/blue/x", "team-blue"),
    ("order/red/x", "team-red"),
    ("order/x", ""),
    ("say/red", "team-red"),
    ("policy/blue_two", "team-blue operator"),
    ("nav/blue_one", "gateway"),
    ("nav/red_one", "gateway gateway-red_one"),
    ("report/status/red_one", "gateway gateway-red_one"),
    ("report/link/blue_one", "gateway"),
    (
        "stop/red_one",
        "team-red gateway gateway-red_one observer operator",
    ),
    ("status/red_one", ""),
    ("link/red_one", ""),
    ("frame", ""),
    ("picture/blue", ""),
    ("external/red_one", ""),
    ("run", ""),
    ("released", ""),
];
/// Keys that other nodes query, and the nodes that the sim answers.
const ASKED: [(&str, &str); 11] = [
    (
        "scenario",
        "team-blue team-red gateway gateway-red_one observer operator",
    ),
    ("events", "observer operator"),
    ("water", "observer operator"),
    ("join/agent/blue", "team-blue"),
    ("join/agent/red", "team-red"),
    ("join/agent", ""),
    ("join/gateway/red_one", "gateway gateway-red_one"),
    ("join/gateway/blue_one", "gateway"),
    ("control", "operator"),
    ("operate/red_one", "operator"),
    ("helm/red_two", "observer operator"),
];

#[test]
fn each_role_may_do_only_what_it_needs() {
    check_rights("tcp");
}

#[test]
fn rights_over_quic_are_the_same() {
    check_rights("quic");
}

fn check_rights(transport: &str) {
    let own = keys(&["127.0.0.1"], DAY);
    let (sim, endpoint) = hub_over(transport, bundle(&own, "sim"));
    let sim = sim.expect("it listens");
    let node = |identity: &str| leaf(&endpoint, bundle(&own, identity)).expect("it is admitted");
    let nodes = [
        "team-blue",
        "team-red",
        "gateway",
        "gateway-red_one",
        "observer",
        "operator",
    ]
    .map(|name| (name, node(name)));
    for (word, who) in HEARD {
        for (name, bus) in &nodes {
            check(
                name,
                is_heard(&sim, bus, word, "run"),
                who,
                &format!("hears {word}"),
            );
        }
    }
    for (word, who) in PUBLISHED {
        for (name, bus) in &nodes {
            check(
                name,
                is_heard(bus, &sim, word, "control"),
                who,
                &format!("publishes {word}"),
            );
        }
    }
    let answer = |query: Query| query.answer(b"1".to_vec());
    for (word, who) in ASKED {
        let key = topic::matching(&game(), word);
        let _queryable = sim.answer(key.clone(), answer).expect("open");
        for (name, bus) in &nodes {
            let limit = if who.split(' ').any(|word| word == *name) {
                LIMIT
            } else {
                Duration::from_millis(150)
            };
            let asked = bus.ask(&key, vec![], limit).expect("open");
            check(name, asked.is_some(), who, &format!("asks {word}"));
        }
    }
    for (name, bus) in &nodes {
        let asked: Result<Option<u8>, BusError> =
            bus.request(&topic::control(&game()), &1, Duration::from_millis(150));
        assert_eq!(
            matches!(asked, Err(BusError::NotAllowed { .. })),
            *name != "operator",
            "{name} is told at once"
        );
    }
    // An operator's query reaches the gateway of the boat and no other.
    let operator = &nodes[5].1;
    for (i, who) in [(0, false), (2, true), (3, true), (4, false)] {
        let _queryable = nodes[i]
            .1
            .answer(topic::matching(&game(), "operate/red_one"), answer)
            .expect("open");
        let key = topic::operate(&game(), "red_one");
        let start = clock::now();
        let mut is_answered = false;
        while !is_answered
            && clock::since(start)
                < if who {
                    LIMIT
                } else {
                    Duration::from_millis(500)
                }
        {
            is_answered = operator
                .ask(&key, vec![], Duration::from_millis(100))
                .expect("open")
                .is_some();
        }
        assert_eq!(is_answered, who, "{} answers for red_one", nodes[i].0);
    }
}
