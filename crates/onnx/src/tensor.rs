//! A constant of a network: weights, or integers such as a shape.

use super::NetworkError;
use super::error::{shape_text, shown};
use super::limit::{PARAMETERS_MAX, RANK_MAX, at_most};
use super::proto::{
    BFLOAT16, BOOL, DOUBLE, EXTERNAL, FLOAT, FLOAT16, INT32, INT64, TensorProto, data_type_name,
};
use half::{bf16, f16};
use std::rc::Rc;

/// Numbers with a shape; the last dimension varies fastest.
#[derive(Clone)]
pub(super) struct Tensor {
    pub(super) shape: Vec<usize>,
    /// Shared by tensors with the same numbers in different shapes.
    pub(super) numbers: Rc<Numbers>,
}

pub(super) enum Numbers {
    /// Floats, none of them NaN.
    Floats(Vec<f32>),
    Integers(Vec<i64>),
}

impl Tensor {
    pub(super) fn new(shape: Vec<usize>, numbers: Numbers) -> Tensor {
        Tensor {
            shape,
            numbers: Rc::new(numbers),
        }
    }

    /// Reads a tensor. `name` appears in errors.
    pub(super) fn read(proto: &TensorProto, name: &str) -> Result<Tensor, NetworkError> {
        if proto.data_location == EXTERNAL || !proto.external_data.is_empty() {
            let expected = "its numbers: export the model with external_data=False";
            return Err(NetworkError::tensor(
                name,
                "a reference to another file",
                expected,
            ));
        }
        if proto.dims.len() > RANK_MAX {
            let found = format!("{} dimensions", proto.dims.len());
            return Err(NetworkError::tensor(
                name,
                found,
                format!("at most {RANK_MAX}"),
            ));
        }
        let shape = proto
            .dims
            .iter()
            .map(|dim| usize::try_from(*dim).ok())
            .collect::<Option<Vec<usize>>>();
        let Some(shape) = shape else {
            return Err(NetworkError::tensor(
                name,
                "a negative dimension",
                "dimensions of 0 or more",
            ));
        };
        // Only one-dimensional tensors can be empty, such as the shape of a single number.
        if product(&shape) == Some(0) && shape.len() > 1 {
            return Err(NetworkError::tensor(
                name,
                shape_text(&shape),
                "dimensions of 1 or more",
            ));
        }
        let count = at_most(
            &format!("numbers of tensor `{}`", shown(name)),
            product(&shape),
            PARAMETERS_MAX,
        )?;
        // Fields hold 16-bit floats and booleans as 32-bit integers.
        let bits = || listed(proto, &low_halves(&proto.int32_data), u16::from_le_bytes).into_iter();
        let numbers = match proto.data_type {
            FLOAT => Numbers::Floats(listed(proto, &proto.float_data, f32::from_le_bytes)),
            FLOAT16 => Numbers::Floats(bits().map(|bits| f16::from_bits(bits).to_f32()).collect()),
            BFLOAT16 => {
                Numbers::Floats(bits().map(|bits| bf16::from_bits(bits).to_f32()).collect())
            }
            BOOL => Numbers::Integers(match &proto.raw_data {
                Some(raw) => raw.iter().map(|byte| i64::from(*byte)).collect(),
                None => proto
                    .int32_data
                    .iter()
                    .map(|number| i64::from(*number))
                    .collect(),
            }),
            DOUBLE => Numbers::Floats(
                listed(proto, &proto.double_data, f64::from_le_bytes)
                    .into_iter()
                    .map(|number| number as f32)
                    .collect(),
            ),
            INT64 => Numbers::Integers(listed(proto, &proto.int64_data, i64::from_le_bytes)),
            INT32 => Numbers::Integers(
                listed(proto, &proto.int32_data, i32::from_le_bytes)
                    .into_iter()
                    .map(i64::from)
                    .collect(),
            ),
            other => {
                let found = data_type_name(other.into());
                return Err(NetworkError::tensor(
                    name,
                    found,
                    "FLOAT, FLOAT16, BFLOAT16, DOUBLE, INT32, INT64 or BOOL numbers",
                ));
            }
        };
        let (found, has_nan) = match &numbers {
            Numbers::Floats(floats) => (floats.len(), floats.iter().any(|float| float.is_nan())),
            Numbers::Integers(integers) => (integers.len(), false),
        };
        if found != count || !whole(proto) {
            let found = format!("{found} numbers");
            return Err(NetworkError::tensor(
                name,
                found,
                format!("{count} for {}", shape_text(&shape)),
            ));
        }
        if has_nan {
            return Err(NetworkError::tensor(name, "NaN", "numbers"));
        }
        Ok(Tensor::new(shape, numbers))
    }

    pub(super) fn len(&self) -> usize {
        match &*self.numbers {
            Numbers::Floats(floats) => floats.len(),
            Numbers::Integers(integers) => integers.len(),
        }
    }
}

/// The size of a shape, unless it overflows.
pub(super) fn product(shape: &[usize]) -> Option<usize> {
    // A zero dimension makes the product zero, however large the others are.
    if shape.contains(&0) {
        Some(0)
    } else {
        shape
            .iter()
            .try_fold(1_usize, |all, dim| all.checked_mul(*dim))
    }
}

/// The numbers of a tensor: its raw data, or the field of their type.
fn listed<T: Copy, const SIZE: usize>(
    proto: &TensorProto,
    field: &[T],
    read: fn([u8; SIZE]) -> T,
) -> Vec<T> {
    match &proto.raw_data {
        Some(raw) => raw.as_chunks().0.iter().map(|bytes| read(*bytes)).collect(),
        None => field.to_vec(),
    }
}

fn low_halves(integers: &[i32]) -> Vec<u16> {
    integers.iter().map(|integer| *integer as u16).collect()
}

/// Whether the raw data divides into whole elements.
fn whole(proto: &TensorProto) -> bool {
    let size = match proto.data_type {
        BOOL => 1,
        FLOAT16 | BFLOAT16 => 2,
        DOUBLE | INT64 => 8,
        _ => 4,
    };
    proto
        .raw_data
        .as_ref()
        .is_none_or(|raw| raw.len() % size == 0)
}
