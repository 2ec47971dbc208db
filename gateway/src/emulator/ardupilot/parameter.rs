//! The parameters of an emulated ArduPilot boat: a few of the real ones, by the names that versions up to 4.6 have.

use crate::mavlink::dialect::{MavMessage, MavParamType, PARAM_VALUE_DATA};

/// Name and value at the beginning.
const BEGINNING: [(&str, f32); 10] = [
    ("SYSID_THISMAV", super::SYSTEM as f32),
    ("SYSID_MYGCS", 255.0),
    ("INITIAL_MODE", 4.0),
    ("FRAME_CLASS", 2.0),
    ("CRUISE_SPEED", 2.0),
    ("WP_SPEED", 2.0),
    ("FS_GCS_ENABLE", 0.0),
    ("FS_TIMEOUT", 1.5),
    ("FS_ACTION", 2.0),
    ("RC_OVERRIDE_TIME", 3.0),
];

/// All of them.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    values: [f32; BEGINNING.len()],
}

impl Parameters {
    pub(super) fn new() -> Parameters {
        Parameters { values: BEGINNING.map(|(_, value)| value) }
    }

    /// The value of one; 0 if there is none of this name.
    pub(super) fn value(&self, name: &str) -> f64 {
        index_of(name).map_or(0.0, |index| f64::from(self.values[index]))
    }

    /// Takes a message of the parameter protocol; the answers to it.
    pub(super) fn answer(&mut self, message: &MavMessage) -> Vec<MavMessage> {
        let indices: Vec<usize> = match message {
            MavMessage::PARAM_REQUEST_LIST(_) => (0..BEGINNING.len()).collect(),
            MavMessage::PARAM_REQUEST_READ(read) => {
                let by_index = usize::try_from(read.param_index).ok().filter(|index| *index < BEGINNING.len());
                by_index.or_else(|| index_of(read.param_id.to_str().ok()?)).into_iter().collect()
            }
            MavMessage::PARAM_SET(set) => {
                let index = set.param_id.to_str().ok().and_then(index_of);
                if let Some(index) = index.filter(|_| set.param_value.is_finite()) {
                    self.values[index] = set.param_value;
                }
                index.into_iter().collect()
            }
            _ => vec![],
        };
        indices.into_iter().map(|index| self.message(index)).collect()
    }

    fn message(&self, index: usize) -> MavMessage {
        MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: self.values[index],
            param_count: BEGINNING.len() as u16,
            param_index: index as u16,
            param_id: BEGINNING[index].0.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        })
    }
}

fn index_of(name: &str) -> Option<usize> {
    BEGINNING.iter().position(|(known, _)| *known == name)
}
