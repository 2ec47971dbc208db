//! The names that `rmw_zenoh` gives to topics, services, nodes and messages: keys, liveliness
//! tokens and attachments, as specified in its design document.
//!
//! The crate `hiroz-protocol` implements these too, in twelve times as much code. It is
//! experimental, and would tie the bridge to its own zenoh version.

use crate::type_hash::type_hash;
use xxhash_rust::xxh3::xxh3_128;

/// The quality of service of all endpoints: reliable, volatile, keep the last ten messages. Empty
/// parts select the defaults.
const QOS: &str = "::,10:,:,:,,";

/// The kind of an endpoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Publishes a topic.
    Publisher,
    /// Subscribes to a topic.
    Subscription,
    /// Answers a service.
    Service,
}

/// A node as named in its tokens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// The ROS domain.
    pub domain: u32,
    /// The identifier of the node's session.
    pub session: String,
    /// The node's number in the session.
    pub id: u32,
    /// The node's name. Nodes have no namespace.
    pub name: String,
}

/// Converts `std_msgs/msg/Header` to its DDS name: `std_msgs::msg::dds_::Header_`.
fn dds_name(type_name: &str) -> String {
    let (package, name) = type_name.rsplit_once('/').unwrap_or_default();
    format!("{}::dds_::{name}_", package.replace('/', "::"))
}

/// The key of a topic's messages or a service's requests. `topic` begins with a slash.
pub fn key(domain: u32, topic: &str, type_name: &str) -> String {
    format!(
        "{domain}/{}/{}/{}",
        topic.trim_start_matches('/'),
        dds_name(type_name),
        type_hash(type_name)
    )
}

impl Node {
    /// The node's token.
    pub fn token(&self) -> String {
        let Node {
            domain,
            session,
            id,
            name,
        } = self;
        format!("@ros2_lv/{domain}/{session}/{id}/{id}/NN/%/%/{name}")
    }

    /// The token of one of the node's endpoints, whose number must be unique among the session's
    /// endpoints and nodes.
    pub fn endpoint_token(
        &self,
        endpoint: u32,
        kind: Kind,
        topic: &str,
        type_name: &str,
    ) -> String {
        let Node {
            domain,
            session,
            id,
            name,
        } = self;
        let kind = match kind {
            Kind::Publisher => "MP",
            Kind::Subscription => "MS",
            Kind::Service => "SS",
        };
        let (topic, dds_name, hash) = (
            topic.replace('/', "%"),
            dds_name(type_name),
            type_hash(type_name),
        );
        format!(
            "@ros2_lv/{domain}/{session}/{id}/{endpoint}/{kind}/%/%/{name}/{topic}/{dds_name}/{hash}/{QOS}"
        )
    }
}

/// The global identifier of the endpoint with this token.
pub fn gid(token: &str) -> [u8; 16] {
    xxh3_128(token.as_bytes()).to_le_bytes()
}

/// The attachment of a message: its number (from 1), the time of sending (ns since 1970), and its
/// sender.
pub fn attachment(sequence: i64, sent_ns: i64, gid: [u8; 16]) -> Vec<u8> {
    [
        &sequence.to_le_bytes()[..],
        &sent_ns.to_le_bytes(),
        &[16],
        &gid,
    ]
    .concat()
}

/// The attachment of an answer: the number and sender in the attachment of the request, with a new
/// time. `None` if `request` is not an attachment.
pub fn answer_attachment(request: &[u8], sent_ns: i64) -> Option<Vec<u8>> {
    let gid = request
        .get(17..33)
        .filter(|_| request.len() == 33 && request[16] == 16)?;
    Some([&request[..8], &sent_ns.to_le_bytes(), &[16], gid].concat())
}

/// Whether ROS 2 accepts `name` as part of the names of topics, nodes and frames.
pub fn is_ros_name(name: &str) -> bool {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(is_word)
        && !name.contains("__")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of `rmw_zenoh`'s design document, applied to other types.
    #[test]
    fn keys_and_tokens_are_those_of_rmw_zenoh() {
        let hash = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a";
        let twist = "geometry_msgs/msg/Twist";
        assert_eq!(
            key(0, "/b/cmd_vel", twist),
            format!("0/b/cmd_vel/geometry_msgs::msg::dds_::Twist_/{hash}")
        );
        let node = Node {
            domain: 2,
            session: "aac3178e146ba6f1".to_owned(),
            id: 0,
            name: "squall".to_owned(),
        };
        assert_eq!(
            node.token(),
            "@ros2_lv/2/aac3178e146ba6f1/0/0/NN/%/%/squall"
        );
        assert_eq!(
            node.endpoint_token(11, Kind::Subscription, "/b/cmd_vel", twist),
            format!(
                "@ros2_lv/2/aac3178e146ba6f1/0/11/MS/%/%/squall/%b%cmd_vel/geometry_msgs::msg::dds_::Twist_/{hash}/{QOS}"
            )
        );
    }

    #[test]
    fn an_answer_names_its_request() {
        let gid = gid("a token");
        let request = attachment(7, 1_000, gid);
        assert_eq!(request.len(), 33);
        assert_eq!(
            answer_attachment(&request, 2_000),
            Some(attachment(7, 2_000, gid))
        );
        for bad in [&request[..32], &[0; 33], b""] {
            assert_eq!(answer_attachment(bad, 0), None, "{bad:?}");
        }
    }

    #[test]
    fn names_of_boats_become_parts_of_topics() {
        for (name, want) in [
            ("blue_1", true),
            ("B", true),
            ("1st", false),
            ("a-b", false),
            ("", false),
            ("a__b", false),
        ] {
            assert_eq!(is_ros_name(name), want, "{name}");
        }
    }
}
