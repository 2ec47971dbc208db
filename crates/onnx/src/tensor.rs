//! A constant of a network: weights, or the integers that say how to shape something.

use super::error::shape_text;
use super::limit::{PARAMETERS_MAX, RANK_MAX, at_most};
use super::proto::{DOUBLE, EXTERNAL, FLOAT, INT32, INT64, TensorProto, data_type_name};
use super::{NetworkError, error};
use std::rc::Rc;

/// Numbers in a shape, the last dimension varying fastest.
#[derive(Clone)]
pub(super) struct Tensor {
    pub(super) shape: Vec<usize>,
    /// Shared by those that are the same numbers in another shape.
    pub(super) numbers: Rc<Numbers>,
}

/// The numbers of a tensor.
pub(super) enum Numbers {
    /// Finite ones.
    Floats(Vec<f32>),
    Integers(Vec<i64>),
}

impl Tensor {
    pub(super) fn new(shape: Vec<usize>, numbers: Numbers) -> Tensor {
        Tensor { shape, numbers: Rc::new(numbers) }
    }

    /// The tensor of a file, which messages call `name`.
    pub(super) fn read(proto: &TensorProto, name: &str) -> Result<Tensor, NetworkError> {
        if proto.data_location == EXTERNAL || !proto.external_data.is_empty() {
            return Err(NetworkError::ExternalData { tensor: error::shown(name) });
        }
        if proto.dims.len() > RANK_MAX {
            let found = format!("{} dimensions", proto.dims.len());
            return Err(NetworkError::tensor(name, found, format!("at most {RANK_MAX}")));
        }
        let shape = proto.dims.iter().map(|dim| usize::try_from(*dim).ok()).collect::<Option<Vec<usize>>>();
        let Some(shape) = shape else {
            return Err(NetworkError::tensor(name, "a negative dimension", "dimensions of 0 or more"));
        };
        let count = at_most(&format!("numbers of tensor `{}`", error::shown(name)), product(&shape), PARAMETERS_MAX)?;
        let numbers = match proto.data_type {
            FLOAT => Numbers::Floats(listed(proto, &proto.float_data, f32::from_le_bytes)),
            DOUBLE => Numbers::Floats(
                listed(proto, &proto.double_data, f64::from_le_bytes).into_iter().map(|number| number as f32).collect(),
            ),
            INT64 => Numbers::Integers(listed(proto, &proto.int64_data, i64::from_le_bytes)),
            INT32 => Numbers::Integers(
                listed(proto, &proto.int32_data, i32::from_le_bytes).into_iter().map(i64::from).collect(),
            ),
            other => {
                let found = data_type_name(other.into());
                return Err(NetworkError::tensor(name, found, "FLOAT, DOUBLE, INT32 or INT64 numbers"));
            }
        };
        let (found, is_finite) = match &numbers {
            Numbers::Floats(floats) => (floats.len(), floats.iter().all(|float| float.is_finite())),
            Numbers::Integers(integers) => (integers.len(), true),
        };
        if found != count || !whole(proto) {
            let found = format!("{found} numbers");
            return Err(NetworkError::tensor(name, found, format!("{count} for {}", shape_text(&shape))));
        }
        if !is_finite {
            return Err(NetworkError::tensor(
                name,
                "a number that is NaN or infinite in single precision",
                "finite ones",
            ));
        }
        Ok(Tensor::new(shape, numbers))
    }

    pub(super) fn len(&self) -> usize {
        match &*self.numbers {
            Numbers::Floats(floats) => floats.len(),
            Numbers::Integers(integers) => integers.len(),
        }
    }

    /// The same numbers in another shape of as many.
    pub(super) fn reshaped(&self, shape: Vec<usize>) -> Tensor {
        Tensor { shape, numbers: Rc::clone(&self.numbers) }
    }
}

/// How many numbers a shape holds, if that can be counted.
pub(super) fn product(shape: &[usize]) -> Option<usize> {
    // A zero anywhere makes it zero, however large the others are.
    if shape.contains(&0) { Some(0) } else { shape.iter().try_fold(1_usize, |all, dim| all.checked_mul(*dim)) }
}

/// The numbers of a tensor, which stand in the raw data or else in the field of their type.
fn listed<T: Copy, const SIZE: usize>(proto: &TensorProto, field: &[T], read: fn([u8; SIZE]) -> T) -> Vec<T> {
    match &proto.raw_data {
        Some(raw) => raw.as_chunks().0.iter().map(|bytes| read(*bytes)).collect(),
        None => field.to_vec(),
    }
}

/// Whether the raw data ends with a whole number.
fn whole(proto: &TensorProto) -> bool {
    let size = if matches!(proto.data_type, DOUBLE | INT64) { 8 } else { 4 };
    proto.raw_data.as_ref().is_none_or(|raw| raw.len() % size == 0)
}
