//! Type hashes of ROS 2 (RIHS01): SHA-256 of a canonical JSON description of a type and of all
//! types nested in it (REP 2016).

use messages::ros::DEFINITIONS;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Definitions of standard types: each begins with `MSG: package/msg/Type`.
const STANDARD: &str = include_str!("../msg/standard.msg");

/// The identifiers of basic types in type descriptions (`type_description_interfaces/FieldType`).
/// `char` is an alias of `uint8`.
const BASIC: [(&str, u8); 14] = [
    ("int8", 2),
    ("uint8", 3),
    ("char", 3),
    ("int16", 4),
    ("uint16", 5),
    ("int32", 6),
    ("uint32", 7),
    ("int64", 8),
    ("uint64", 9),
    ("float32", 10),
    ("float64", 11),
    ("bool", 15),
    ("byte", 16),
    ("string", 17),
];
/// The identifier of a nested type.
const NESTED: u8 = 1;

/// A field of a type description.
#[derive(Debug, PartialEq, Eq)]
struct Field {
    name: String,
    type_id: u8,
    /// Length of an array, or maximum length of a bounded list.
    capacity: u32,
    /// The full name of a nested type, or empty.
    nested: String,
}

impl Field {
    /// Parses a line of a definition: type, name and an optional default. `None` for constants,
    /// comments and empty lines.
    fn parse(line: &str, package: &str) -> Option<Field> {
        let line = line.split('#').next()?;
        let (kind, name) = line.trim().split_once(char::is_whitespace)?;
        let name = name.split_whitespace().next()?;
        if line.contains('=') && !kind.contains("<=") {
            return None;
        }
        // In type identifiers, an array adds 48, a bounded list 96, and any other list 144.
        let (base, list, capacity) =
            match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
                None => (kind, 0, 0),
                Some((base, "")) => (base, 144, 0),
                Some((base, count)) => match count.strip_prefix("<=") {
                    Some(limit) => (base, 96, limit.parse().ok()?),
                    None => (base, 48, count.parse().ok()?),
                },
            };
        let basic = BASIC
            .iter()
            .find(|(name, _)| *name == base)
            .map(|(_, id)| *id);
        let nested = if basic.is_some() {
            String::new()
        } else {
            full_name(base, package)
        };
        Some(Field {
            name: name.to_owned(),
            type_id: basic.unwrap_or(NESTED) + list,
            capacity,
            nested,
        })
    }

    fn json(&self) -> String {
        let Field {
            name,
            type_id,
            capacity,
            nested,
        } = self;
        format!(
            r#"{{"name": "{name}", "type": {{"type_id": {type_id}, "capacity": {capacity}, "string_capacity": 0, "nested_type_name": "{nested}"}}}}"#
        )
    }
}

/// The full name of a type in a definition of `package`: `std_msgs/Header` becomes
/// `std_msgs/msg/Header`.
fn full_name(name: &str, package: &str) -> String {
    match name.split('/').collect::<Vec<_>>()[..] {
        [package, name] => format!("{package}/msg/{name}"),
        [_, _, _] => name.to_owned(),
        _ => format!("{package}/msg/{name}"),
    }
}

/// The definition of a type, without the types nested in it.
pub fn definition(type_name: &str) -> Option<&'static str> {
    if let Some(own) = type_name.strip_prefix("squall_msgs/msg/") {
        return DEFINITIONS
            .iter()
            .find(|(name, _)| *name == own)
            .map(|(_, text)| *text);
    }
    let sections = STANDARD.split("MSG: ").skip(1);
    sections
        .filter_map(|section| section.split_once('\n'))
        .find(|(name, _)| *name == type_name)
        .map(|(_, text)| text)
}

/// The hash of a message or service type, for example of `std_msgs/msg/Header`.
///
/// # Panics
/// If the bridge has no definition of the type or of a type nested in it. A test covers all types
/// in use.
pub fn type_hash(type_name: &str) -> String {
    let mut described = BTreeMap::new();
    describe(type_name, &mut described);
    let own = described.remove(type_name).expect("it was just described");
    // A map iterates in order of names, as required for nested descriptions.
    let nested: Vec<String> = described.into_values().collect();
    let json = format!(
        r#"{{"type_description": {own}, "referenced_type_descriptions": [{}]}}"#,
        nested.join(", ")
    );
    let digest: String = Sha256::digest(json)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    format!("RIHS01_{digest}")
}

/// Adds the descriptions of a type and of all types nested in it.
fn describe(type_name: &str, described: &mut BTreeMap<String, String>) {
    if described.contains_key(type_name) {
        return;
    }
    let package = type_name.split('/').next().unwrap_or_default();
    let text = definition(type_name).unwrap_or_else(|| panic!("no definition of {type_name}"));
    let fields: Vec<Field> = text
        .lines()
        .filter_map(|line| Field::parse(line, package))
        .collect();
    let json: Vec<String> = fields.iter().map(Field::json).collect();
    let json = format!(
        r#"{{"type_name": "{type_name}", "fields": [{}]}}"#,
        json.join(", ")
    );
    described.insert(type_name.to_owned(), json);
    fields
        .iter()
        .filter(|field| !field.nested.is_empty())
        .for_each(|field| describe(&field.nested, described));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hashes from the keys of `rmw_zenoh_cpp` in ROS 2 Jazzy. `tests/ros_peer.py` compares all
    /// types with two other implementations.
    #[test]
    fn hashes_are_those_of_ros_2() {
        for (name, want) in [
            (
                "geometry_msgs/msg/Twist",
                "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
            ),
            (
                "sensor_msgs/msg/Imu",
                "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
            ),
            (
                "nav_msgs/msg/Odometry",
                "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
            ),
            (
                "diagnostic_msgs/msg/DiagnosticArray",
                "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
            ),
            (
                "std_srvs/srv/SetBool",
                "abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a",
            ),
        ] {
            assert_eq!(type_hash(name), format!("RIHS01_{want}"), "{name}");
        }
    }

    #[test]
    fn lines_of_definitions_become_fields() {
        let field = |name: &str, type_id, capacity, nested: &str| {
            Some(Field {
                name: name.to_owned(),
                type_id,
                capacity,
                nested: nested.to_owned(),
            })
        };
        for (line, want) in [
            ("float64 x", field("x", 11, 0, "")),
            ("uint8 level 3  # a default", field("level", 3, 0, "")),
            ("float64[36] covariance", field("covariance", 59, 36, "")),
            ("char[16] gid", field("gid", 51, 16, "")),
            (
                "Nav nav       # as measured = known",
                field("nav", 1, 0, "squall_msgs/msg/Nav"),
            ),
            (
                "std_msgs/Header header",
                field("header", 1, 0, "std_msgs/msg/Header"),
            ),
            (
                "a/srv/B_Request[<=1] request",
                field("request", 97, 1, "a/srv/B_Request"),
            ),
            ("string[] names", field("names", 161, 0, "")),
            ("uint8 HOLD=0", None),
            ("uint8 HOLD = 0", None),
            ("# float64 x", None),
            ("", None),
        ] {
            assert_eq!(Field::parse(line, "squall_msgs"), want, "{line}");
        }
    }

    #[test]
    fn all_own_types_have_definitions_for_what_is_nested_in_them() {
        for (name, _) in DEFINITIONS {
            assert!(
                type_hash(&format!("squall_msgs/msg/{name}")).starts_with("RIHS01_"),
                "{name}"
            );
        }
    }
}
