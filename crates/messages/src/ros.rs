//! The `.msg` definitions, with which tools decode our messages.

/// Name and content of every definition, sorted by name.
pub const DEFINITIONS: [(&str, &str); 21] = [
    ("Contact", include_str!("../msg/Contact.msg")),
    ("EventRecord", include_str!("../msg/EventRecord.msg")),
    ("ExternalOrder", include_str!("../msg/ExternalOrder.msg")),
    ("FlagView", include_str!("../msg/FlagView.msg")),
    ("Frame", include_str!("../msg/Frame.msg")),
    ("Imu", include_str!("../msg/Imu.msg")),
    ("InputRecord", include_str!("../msg/InputRecord.msg")),
    ("Inputs", include_str!("../msg/Inputs.msg")),
    ("LinkBytes", include_str!("../msg/LinkBytes.msg")),
    ("Nav", include_str!("../msg/Nav.msg")),
    ("NavReport", include_str!("../msg/NavReport.msg")),
    ("Orders", include_str!("../msg/Orders.msg")),
    ("OwnBoat", include_str!("../msg/OwnBoat.msg")),
    ("Picture", include_str!("../msg/Picture.msg")),
    ("PolicyProposal", include_str!("../msg/PolicyProposal.msg")),
    ("Say", include_str!("../msg/Say.msg")),
    ("SeaView", include_str!("../msg/SeaView.msg")),
    ("Stamp", include_str!("../msg/Stamp.msg")),
    ("VehicleOrder", include_str!("../msg/VehicleOrder.msg")),
    ("VehicleTruth", include_str!("../msg/VehicleTruth.msg")),
    ("Word", include_str!("../msg/Word.msg")),
];

/// The package of all our definitions.
const PACKAGE: &str = "squall_msgs/";

fn definition(name: &str) -> Option<&'static str> {
    DEFINITIONS
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, text)| *text)
}

/// A definition with all nested definitions, in the format of ROS 2 recordings; `None` for an
/// unknown name. `schema` is that of a [`Message`](crate::Message), such as
/// `squall_msgs/msg/Frame`.
pub fn full_definition(schema: &str) -> Option<String> {
    let mut names = vec![schema.rsplit('/').next()?];
    let mut text = definition(names[0])?.to_owned();
    let mut next = 0;
    while next < names.len() {
        let parts = definition(names[next])?
            .lines()
            .filter_map(|line| line.trim_start().strip_prefix(PACKAGE));
        for part in parts {
            let name = part.split([' ', '[']).next()?;
            if !names.contains(&name) {
                names.push(name);
                let bar = "=".repeat(80);
                text.push_str(&format!(
                    "{bar}\nMSG: {PACKAGE}{name}\n{}",
                    definition(name)?
                ));
            }
        }
        next += 1;
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_definition_names_each_part_once() {
        let text = full_definition("squall_msgs/msg/Frame").expect("it is ours");
        let parts: Vec<&str> = text
            .lines()
            .filter_map(|line| line.strip_prefix("MSG: "))
            .collect();
        let want = [
            "Stamp",
            "VehicleTruth",
            "SeaView",
            "FlagView",
            "EventRecord",
            "Nav",
        ];
        assert_eq!(parts, want.map(|name| format!("squall_msgs/{name}")));
        assert_eq!(full_definition("squall_msgs/msg/Whale"), None);
    }

    #[test]
    fn all_definitions_are_listed() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("msg");
        assert_eq!(
            std::fs::read_dir(folder)
                .expect("the folder is there")
                .count(),
            DEFINITIONS.len()
        );
        assert!(DEFINITIONS.is_sorted());
    }
}
