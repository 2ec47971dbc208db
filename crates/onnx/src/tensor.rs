//! A constant of a network: weights, or integers such as a shape.

use super::NetworkError;
use super::error::{shape_text, shown};
use super::limit::{PARAMETERS_MAX, RANK_MAX, at_most};
use super::proto::{DOUBLE, EXTERNAL, FLOAT, INT32, INT64, TensorProto, data_type_name};
use std::rc::Rc;

/// Numbers with a shape; the last dimension varies fastest.
#[derive(Clone)]
pub(super) struct Tensor {
    pub(super) shape: Vec<usize>,
    /// Shared by tensors with the same numbers in other shapes.
    pub(super) numbers: Rc<Numbers>,
}

pub(super) enum Numbers {
    /// Finite floats.
    Floats(Vec<f32>),
    Integers(Vec<i64>),
}

impl Tensor {
    pub(super) fn new(shape: Vec<usize>, numbers: Numbers) -> Tensor {
        Tensor { shape, numbers: Rc::new(numbers) }
    }

    /// Reads a tensor. `name` appears in errors.
    pub(super) fn read(proto: &TensorProto, name: &str) -> Result<Tensor, NetworkError> {
        if proto.data_location == EXTERNAL || !proto.external_data.is_empty() {
            let expected = "its numbers: export the model with external_data=False";
            return Err(NetworkError::tensor(name, "a reference to another file", expected));
        }
        if proto.dims.len() > RANK_MAX {
            let found = format!("{} dimensions", proto.dims.len());
            return Err(NetworkError::tensor(name, found, format!("at most {RANK_MAX}")));
        }
        let shape = proto.dims.iter().map(|dim| usize::try_from(*dim).ok()).collect::<Option<Vec<usize>>>();
        let Some(shape) = shape else {
            return Err(NetworkError::tensor(name, "a negative dimension", "dimensions of 0 or more"));
        };
        let count = at_most(&format!("numbers of tensor `{}`", shown(name)), product(&shape), PARAMETERS_MAX)?;
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
                "finite numbers",
            ));
        }
        Ok(Tensor::new(shape, numbers))
    }
}

/// The size of a shape, unless it overflows.
pub(super) fn product(shape: &[usize]) -> Option<usize> {
    // A zero dimension makes the product zero, however large the others are.
    if shape.contains(&0) { Some(0) } else { shape.iter().try_fold(1_usize, |all, dim| all.checked_mul(*dim)) }
}

/// The numbers of a tensor: its raw data, or the field of their type.
fn listed<T: Copy, const SIZE: usize>(proto: &TensorProto, field: &[T], read: fn([u8; SIZE]) -> T) -> Vec<T> {
    match &proto.raw_data {
        Some(raw) => raw.as_chunks().0.iter().map(|bytes| read(*bytes)).collect(),
        None => field.to_vec(),
    }
}

/// Whether the raw data divides into whole elements.
fn whole(proto: &TensorProto) -> bool {
    let size = if matches!(proto.data_type, DOUBLE | INT64) { 8 } else { 4 };
    proto.raw_data.as_ref().is_none_or(|raw| raw.len() % size == 0)
}
