//! Where a node listens, where it connects, and whether it scouts.

use crate::error::reason;
use crate::keys::{Bundle, Identity};
use crate::open_files::OpenFiles;
use crate::zenoh_threads::check_threads_for_keys;
use crate::{BusError, Token, access, random_bytes};
use messages::topic::{self, GameName};
use scenario::Scenario;
use serde_json::json;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use zenoh::Config;

/// The default port of a hub, if free.
pub const DEFAULT_PORT: u16 = 7447;

/// zenoh's settings for a link. Only zenoh's own messages, such as declarations, wait for a
/// congested link, for up to 100,000 µs. A link that cannot accept even these is closed. A batch
/// has up to 64 kB; the queues have space for answers of a megabyte, and for all urgent messages
/// that may be sent at once. Messages reassembled from fragments have a size limit.
const LINKS: [(&str, &str); 5] = [
    // zenoh would wait a millisecond for a free slot before dropping a message. It waits in a
    // thread that serves all nodes, so a single stopped observer would slow down all of them.
    (
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop",
        "0",
    ),
    (
        "transport/link/tx/queue/congestion_control/block/wait_before_close",
        "100000",
    ),
    ("transport/link/tx/queue/size/real_time", "16"),
    ("transport/link/tx/queue/size/data_low", "16"),
    ("transport/link/rx/max_message_size", "16777216"),
];

/// Maximum length of a picture or frame, bytes per boat of the game; a test encodes them.
const BOAT_BYTES: usize = 128;
/// Space for data in a batch of zenoh's, bytes.
const BATCH_BYTES: usize = 65_000;
/// The smallest and the largest queue of zenoh's, in batches. A longer one would delay boats on
/// slow links, which would receive old pictures first.
const QUEUE: (usize, usize) = (2, 16);
/// The most boats of a game over a network. Joining agents receive the scenario, whose length grows
/// by about 230 bytes per boat; of a game with 5,000 boats, half of the agents never received it.
const BOATS_MAX: usize = 4_000;

/// The length, in batches, of a queue for the pictures of a game with this many boats. A queue
/// drops a message that needs more batches than it has: with zenoh's two, no agent of a game with
/// 1,100 boats ever received a picture.
fn queue_for(boats: usize) -> usize {
    ((boats * BOAT_BYTES).div_ceil(BATCH_BYTES) + 1).clamp(QUEUE.0, QUEUE.1)
}

/// How a hub treats messages from other nodes. All are dropped if they would have to wait for their
/// outgoing link. An answer inherits the settings of its query. The longest answers need the
/// priority `data_low`, because only its queue has space for them: a scenario with a neural network
/// has 216 kB.
fn qos(game: &GameName) -> String {
    let long = [
        topic::scenario(game),
        topic::events(game),
        topic::water(game),
    ];
    json!([
        { "messages": ["put", "delete", "query"], "flows": ["ingress"], "overwrite": { "congestion_control": "drop" } },
        { "messages": ["query"], "flows": ["ingress"], "key_exprs": long, "overwrite": { "priority": "data_low" } },
    ])
    .to_string()
}

/// A hub's limits for other nodes. A helm report fits into a message of 2 MB, a join request into a
/// query of 64 kB, and the orders for a thousand boats into 256 kB. A connecting node has
/// `ACCEPT_MS` to identify itself.
const MESSAGE_MAX: usize = 1 << 21;
const QUESTION_MAX: usize = 1 << 16;
const PUBLISHED_MAX: usize = 1 << 18;
const ACCEPT_MS: usize = 5000;
/// Maximum number of nodes linked to a hub, and of pending connections, if the process may open
/// four times as many files.
const NODES_MAX: usize = 1000;
pub(crate) const FILES_MAX: u64 = 4 * NODES_MAX as u64;

/// Size limit of a zenoh configuration, bytes.
const CONFIG_MAX: u64 = 1 << 20;

/// How a node reaches the other nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Net {
    /// Endpoints to listen on, for example `tcp/0.0.0.0:7447`. Only a hub listens.
    pub listen: Vec<String>,
    /// Endpoints to connect to, for example `tcp/192.168.1.5:7447`.
    pub connect: Vec<String>,
    /// Whether to discover nodes by multicast on the local network, and be discovered.
    pub lan: bool,
    /// A zenoh configuration (JSON5) as a starting point: access control, interfaces, buffers and
    /// so on.
    pub config_file: Option<PathBuf>,
    /// The game's token, if known.
    pub token: Option<Token>,
    /// The keys of this node, in a game with keys: links are then encrypted and mutually
    /// authenticated. The process must have called [`restart_for_keys`](crate::restart_for_keys)
    /// first.
    pub keys: Option<Arc<Bundle>>,
}

impl Net {
    /// The endpoint at which nodes on the same machine reach this hub.
    pub fn local_endpoint(&self) -> Option<String> {
        let first = self.endpoints(&self.listen).into_iter().next()?;
        Some(
            first
                .replace("/0.0.0.0:", "/127.0.0.1:")
                .replace("/[::]:", "/[::1]:"),
        )
    }

    /// The zenoh configuration of a game's hub for at most `nodes` nodes.
    pub(crate) fn hub(
        &self,
        game: &GameName,
        scenario: &Scenario,
        nodes: usize,
    ) -> Result<Config, BusError> {
        if let Some(keys) = self
            .keys
            .as_ref()
            .filter(|keys| keys.identity != Identity::Sim)
        {
            let reason = format!(
                "a sim needs the keys of the role sim, not those of {}",
                keys.identity
            );
            return Err(BusError::Keys(format!(
                "{}: {reason}",
                keys.folder.display()
            )));
        }
        let boats = scenario.vehicles.len();
        if boats > BOATS_MAX {
            return Err(BusError::Open {
                what: "serve the game".to_owned(),
                reason: format!(
                    "it has {boats} boats, expected at most {BOATS_MAX} over a network; play it with --in-process"
                ),
            });
        }
        let mut config = self.base()?;
        set(
            &mut config,
            "transport/link/tx/queue/size/data",
            &queue_for(boats).to_string(),
        )?;
        // A file with its own rules takes precedence.
        if config.get_json("access_control/enabled").ok().as_deref() != Some("true") {
            set(
                &mut config,
                "access_control",
                &access::control(game, scenario, self.keys.is_some()).to_string(),
            )?;
        }
        // A star, not a mesh: in lockstep all nodes exchange messages only with the sim, and a
        // client needs no open port.
        set(&mut config, "mode", "\"router\"")?;
        let listen: Vec<String> = self
            .endpoints(&self.listen)
            .into_iter()
            .map(with_handshake_time)
            .collect();
        set(&mut config, "listen/endpoints", &json!(listen).to_string())?;
        set(&mut config, "connect/endpoints", &self.list(&self.connect))?;
        // Our messages carry simulated time; a hybrid logical timestamp in every sample would only
        // add cost.
        set(&mut config, "timestamping/enabled", "false")?;
        // Whatever a node requests, its messages through the hub never wait; otherwise all others
        // would wait, too.
        set(&mut config, "qos/network", &qos(game))?;
        limit_strangers(&mut config, game, nodes)?;
        Ok(config)
    }

    /// The zenoh configuration of a leaf. It makes a single attempt to connect, and reconnects
    /// after a link failure.
    pub(crate) fn leaf(&self) -> Result<Config, BusError> {
        if let Some(keys) = self
            .keys
            .as_ref()
            .filter(|keys| keys.identity == Identity::Sim)
        {
            let reason = "the sim's keys are only for serving games: use those of a team, a gateway, an observer or an operator";
            return Err(BusError::Keys(format!(
                "{}: {reason}",
                keys.folder.display()
            )));
        }
        let mut config = self.base()?;
        set(&mut config, "mode", "\"client\"")?;
        // Without an endpoint, a leaf on a local network scouts for a hub.
        set(&mut config, "connect/endpoints", &self.list(&self.connect))?;
        // Make only one attempt: the search for a game looks up the place before each attempt,
        // since the next sim may have a different place and token.
        set(&mut config, "connect/timeout_ms", "0")?;
        set(&mut config, "connect/exit_on_failure", "true")?;
        Ok(config)
    }

    pub(crate) fn base(&self) -> Result<Config, BusError> {
        let mut config = match &self.config_file {
            None => Config::default(),
            Some(path) => {
                let refused = |reason| BusError::Open {
                    what: format!("use {}", path.display()),
                    reason,
                };
                // The library would read any file, whatever its type and size.
                primitives::input_file::read(path, CONFIG_MAX)
                    .map_err(|e| refused(e.to_string()))?;
                Config::from_file(path).map_err(|e| refused(reason(&e)))?
            }
        };
        // Two runs on one machine must never meet, and no node may join by accident: zenoh's
        // defaults allow both.
        set(
            &mut config,
            "scouting/multicast/enabled",
            if self.lan { "true" } else { "false" },
        )?;
        set(&mut config, "scouting/gossip/enabled", "false")?;
        for (key, value) in LINKS {
            set(&mut config, key, value)?;
        }
        if let Some(keys) = &self.keys {
            check_threads_for_keys()?;
            let [authority, certificate, key] = keys.files();
            let tls = json!({
                // Verify names, even though local addresses change: zenoh (1.10.2) also trusts the
                // public authorities. None of these certifies `localhost` or private addresses.
                "root_ca_certificate": authority, "enable_mtls": true, "verify_name_on_connect": true,
                "listen_certificate": certificate, "listen_private_key": key,
                "connect_certificate": certificate, "connect_private_key": key,
            });
            set(&mut config, "transport/link/tls", &tls.to_string())?;
            // Endpoints learned from other nodes must also use TLS.
            set(
                &mut config,
                "transport/link/protocols",
                r#"["tls", "quic"]"#,
            )?;
        }
        Ok(config)
    }

    /// Endpoints in zenoh's form: with keys, TCP becomes TLS. QUIC carries messages that are not
    /// [reliable](crate::Delivery) in datagrams; without keys, zenoh calls it reliable UDP.
    pub(crate) fn endpoints(&self, endpoints: &[String]) -> Vec<String> {
        let zenoh_form = |endpoint: &String| match (endpoint.split_once('/'), self.keys.is_some()) {
            (Some(("tcp", address)), true) => format!("tls/{address}"),
            (Some(("quic", address)), true) if !address.contains('?') => {
                format!("quic/{address}?mixed_rel=1")
            }
            (Some(("quic", address)), false) if !address.contains('?') => {
                format!("udp/{address}?rel=1;mixed_rel=1")
            }
            _ => endpoint.clone(),
        };
        endpoints.iter().map(zenoh_form).collect()
    }

    /// The ports on which this node listens.
    pub(crate) fn ports(&self) -> Vec<u16> {
        self.listen
            .iter()
            .filter_map(|endpoint| address(endpoint).rsplit(':').next()?.parse().ok())
            .collect()
    }

    fn list(&self, endpoints: &[String]) -> String {
        serde_json::to_string(&self.endpoints(endpoints)).expect("a list of strings is JSON")
    }
}

/// A TLS endpoint whose handshake has the same timeout as the steps after it.
fn with_handshake_time(endpoint: String) -> String {
    if !endpoint.starts_with("tls/") {
        return endpoint;
    }
    let separator = if endpoint.contains('#') { ';' } else { '#' };
    // The TLS listener has a separate timeout besides `accept_timeout`. It also waits 0.1 s after
    // each failed handshake, during which no other node can connect; the build settings in
    // `.cargo/config.toml` remove that.
    format!("{endpoint}{separator}tls_handshake_timeout_ms={ACCEPT_MS}")
}

/// The number of nodes that a hub with this limit on open files has space for.
pub(crate) fn nodes_max(files: OpenFiles) -> usize {
    usize::try_from(files.usual / 4).map_or(NODES_MAX, |nodes| nodes.min(NODES_MAX))
}

/// Limits the memory and files that linked or connecting nodes can make a hub hold.
fn limit_strangers(config: &mut Config, game: &GameName, nodes: usize) -> Result<(), BusError> {
    let all = topic::matching(game, "**");
    let smaller = |messages: &[&str], size: usize| json!({ "messages": messages, "flows": ["ingress"], "key_exprs": [&all], "size_limit": size });
    let filters = json!([
        smaller(&["put", "delete"], PUBLISHED_MAX),
        smaller(&["query"], QUESTION_MAX)
    ]);
    for (key, value) in [
        ("transport/unicast/max_sessions", nodes.to_string()),
        // zenoh would refuse the newcomer; `crate::admission` ends another connection first.
        ("transport/unicast/accept_pending", (2 * nodes).to_string()),
        ("transport/unicast/accept_timeout", ACCEPT_MS.to_string()),
        // This limit is smaller than a leaf's: each link keeps the fragments of a message until
        // they are complete.
        (
            "transport/link/rx/max_message_size",
            MESSAGE_MAX.to_string(),
        ),
        ("low_pass_filter", filters.to_string()),
    ] {
        set(config, key, &value)?;
    }
    Ok(())
}

pub(crate) fn set(config: &mut Config, key: &str, value: &str) -> Result<(), BusError> {
    config
        .insert_json5(key, value)
        .map_err(|e| BusError::Setting {
            key: key.to_owned(),
            value: value.to_owned(),
            reason: reason(&e),
        })
}

/// Host and port of an endpoint, for example `127.0.0.1:7447` of `tcp/127.0.0.1:7447#iface=lo`.
pub(crate) fn address(endpoint: &str) -> &str {
    let address = endpoint
        .split_once('/')
        .map_or(endpoint, |(_, address)| address);
    address.split(['?', '#']).next().unwrap_or(address)
}

/// Whether an endpoint, for example `tcp/127.0.0.1:7447`, is reachable from this machine only.
pub fn is_loopback(endpoint: &str) -> bool {
    let address = address(endpoint);
    match address.parse::<SocketAddr>() {
        Ok(address) => address.ip().is_loopback(),
        Err(_) => address
            .rsplit_once(':')
            .is_some_and(|(host, _)| host == "localhost"),
    }
}

/// Whether two endpoints have the same host and port. All names of the loopback interface count as
/// one host, whatever the protocol.
pub fn is_same_place(one: &str, other: &str) -> bool {
    let port = |endpoint| address(endpoint).rsplit_once(':').map(|(_, port)| port);
    let is_same_host = is_loopback(one) && is_loopback(other) && port(one) == port(other);
    is_same_host || address(one) == address(other)
}

/// The range of [`free_port`]: registered ports that systems do not give to outgoing connections
/// (Linux starts at 32768, others at 49152; RFC 6335). A port in those ranges can be taken between
/// the check and `listen`, even by a client that keeps trying to reach that very port.
const FREE_PORTS: std::ops::Range<u16> = 20_000..32_768;

/// A loopback TCP port that was free a moment ago: the default port if preferred and free,
/// otherwise a different one.
///
/// # Errors
/// If none of the ports tried is free.
pub fn free_port(prefer_default: bool) -> std::io::Result<u16> {
    let is_free = |port: u16| {
        TcpListener::bind(("127.0.0.1", port)).and_then(|listener| listener.local_addr())
    };
    if prefer_default && let Ok(free) = is_free(DEFAULT_PORT) {
        return Ok(free.port());
    }
    let any = || {
        FREE_PORTS.start + u16::from_le_bytes(random_bytes()) % (FREE_PORTS.end - FREE_PORTS.start)
    };
    let free = (0..100)
        .find_map(|_| is_free(any()).ok())
        .map_or_else(|| is_free(0), Ok)?;
    Ok(free.port())
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::picture::OwnBoat;
    use messages::{Frame, Picture, VehicleTruth};
    use primitives::{VehicleId, codec};

    #[test]
    fn the_longest_pictures_and_frames_fit_into_the_queue() {
        for boats in [4, 500, 1_100, BOATS_MAX] {
            let frame = Frame {
                vehicles: vec![VehicleTruth::default(); boats],
                ..Frame::default()
            };
            let own = OwnBoat::new(VehicleId(0), Default::default());
            let picture = Picture {
                own: vec![own; boats],
                ..Picture::default()
            };
            for bytes in [codec::encode(&frame).len(), codec::encode(&picture).len()] {
                let batches = bytes.div_ceil(BATCH_BYTES);
                assert!(
                    batches < queue_for(boats).max(2),
                    "{boats} boats: {bytes} bytes"
                );
            }
        }
    }

    #[test]
    fn only_loopback_is_limited_to_this_machine() {
        for (endpoint, is_ours) in [
            ("tcp/127.0.0.1:7447", true),
            ("tcp/127.3.2.1:7447", true),
            ("tcp/[::1]:7447", true),
            ("tcp/localhost:7447", true),
            ("tcp/127.0.0.1:7447#iface=lo", true),
            ("tcp/0.0.0.0:7447", false),
            ("tcp/[::]:7447", false),
            ("tcp/192.168.1.5:7447", false),
            ("udp/localhost.example:7447", false),
            ("tcp/boat.local:7447", false),
            ("tcp/7447", false),
            ("", false),
        ] {
            assert_eq!(is_loopback(endpoint), is_ours, "{endpoint}");
        }
    }

    #[test]
    fn places_are_compared_by_host_and_port() {
        for other in [
            "tcp/localhost:7447",
            "tcp/[::1]:7447",
            "quic/127.0.0.1:7447",
            "udp/127.0.0.1:7447?rel=1",
        ] {
            assert!(is_same_place("tcp/127.0.0.1:7447", other), "{other}");
        }
        for other in [
            "tcp/127.0.0.1:7448",
            "tcp/192.168.1.5:7447",
            "tcp/localhost",
        ] {
            assert!(!is_same_place("tcp/127.0.0.1:7447", other), "{other}");
        }
        assert!(is_same_place(
            "tcp/boat.local:7447",
            "quic/boat.local:7447#iface=wlan0"
        ));
    }

    /// A client whose own port is its target port connects to itself, which blocks the port for
    /// listeners.
    #[test]
    fn who_retries_to_reach_a_free_port_does_not_take_it() {
        let port = free_port(false).unwrap();
        let retries = 2 * usize::from(u16::MAX);
        assert!(
            (0..retries).all(|_| std::net::TcpStream::connect(("127.0.0.1", port)).is_err()),
            "{port}"
        );
        TcpListener::bind(("127.0.0.1", port)).unwrap();
    }
}
