//! The parameters of an emulated ArduPilot boat: a subset of the real ones, with their names up to
//! version 4.6.

use crate::mavlink::dialect::{
    MavMessage, MavParamError, MavParamType, PARAM_ERROR_DATA, PARAM_VALUE_DATA,
};
use ::mavlink::types::CharArray;

/// Names, initial values and types.
const BEGINNING: [(&str, f32, MavParamType); 11] = [
    ("SYSID_THISMAV", super::SYSTEM as f32, INT16),
    ("SYSID_MYGCS", 255.0, INT16),
    ("INITIAL_MODE", 4.0, INT8),
    ("FRAME_CLASS", 2.0, INT8),
    ("CRUISE_SPEED", 2.0, REAL32),
    ("WP_SPEED", 2.0, REAL32),
    ("FS_GCS_ENABLE", 0.0, INT8),
    ("FS_GCS_TIMEOUT", 5.0, REAL32),
    ("FS_TIMEOUT", 1.5, REAL32),
    ("FS_ACTION", 2.0, INT8),
    ("RC_OVERRIDE_TIME", 3.0, REAL32),
];
const INT8: MavParamType = MavParamType::MAV_PARAM_TYPE_INT8;
const INT16: MavParamType = MavParamType::MAV_PARAM_TYPE_INT16;
const REAL32: MavParamType = MavParamType::MAV_PARAM_TYPE_REAL32;

/// The index in replies to requests by name.
const BY_NAME: u16 = u16::MAX;

/// All parameters.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    values: [f32; BEGINNING.len()],
}

impl Parameters {
    pub(super) fn new() -> Parameters {
        Parameters {
            values: BEGINNING.map(|(_, value, _)| value),
        }
    }

    /// The value of a parameter; 0 if it does not exist.
    pub(super) fn value(&self, name: &str) -> f64 {
        index_of(name).map_or(0.0, |index| f64::from(self.values[index]))
    }

    /// Handles a message of the parameter protocol. Returns the replies, or `None` for any other
    /// message.
    pub(super) fn answer(
        &mut self,
        from: (u8, u8),
        message: &MavMessage,
    ) -> Option<Vec<MavMessage>> {
        let one = match message {
            MavMessage::PARAM_REQUEST_LIST(_) => {
                return Some(
                    (0..BEGINNING.len())
                        .map(|index| self.message(index, index as u16))
                        .collect(),
                );
            }
            MavMessage::PARAM_REQUEST_READ(read) => {
                let by_index = usize::try_from(read.param_index)
                    .ok()
                    .filter(|index| *index < BEGINNING.len());
                let index = by_index.or_else(|| index_of(read.param_id.to_str().ok()?));
                match index {
                    Some(index) => self.message(index, by_index.map_or(BY_NAME, |_| index as u16)),
                    None => error(
                        from,
                        read.param_id,
                        read.param_index,
                        MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST,
                    ),
                }
            }
            MavMessage::PARAM_SET(set) => {
                let refuse = |reason| error(from, set.param_id, -1, reason);
                match set.param_id.to_str().ok().and_then(index_of) {
                    None => refuse(MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST),
                    Some(index) if !is_allowed(BEGINNING[index].0, set.param_value) => {
                        refuse(MavParamError::MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE)
                    }
                    Some(index) => {
                        self.values[index] = match BEGINNING[index].2 {
                            INT8 => f32::from(set.param_value as i8),
                            INT16 => f32::from(set.param_value as i16),
                            _ => set.param_value,
                        };
                        self.message(index, BY_NAME)
                    }
                }
            }
            _ => return None,
        };
        Some(vec![one])
    }

    fn message(&self, index: usize, param_index: u16) -> MavMessage {
        MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
            param_value: self.values[index],
            param_count: BEGINNING.len() as u16,
            param_index,
            param_id: BEGINNING[index].0.into(),
            param_type: BEGINNING[index].2,
        })
    }
}

fn index_of(name: &str) -> Option<usize> {
    BEGINNING
        .iter()
        .position(|(known, ..)| known.eq_ignore_ascii_case(name))
}

/// Whether a parameter may have a value: the boat must keep a valid system number.
fn is_allowed(name: &str, value: f32) -> bool {
    value.is_finite()
        && (name != "SYSID_THISMAV" || (1.0..=255.0).contains(&value) && value.fract() == 0.0)
}

fn error(
    from: (u8, u8),
    param_id: CharArray<16>,
    param_index: i16,
    error: MavParamError,
) -> MavMessage {
    let (target_system, target_component) = from;
    MavMessage::PARAM_ERROR(PARAM_ERROR_DATA {
        param_index,
        target_system,
        target_component,
        param_id,
        error,
    })
}
