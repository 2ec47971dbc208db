//! Evaluates a trained policy, an ONNX network, one row at a time, with the same bits on every
//! machine.
//!
//! In a general runtime, the order of sums depends on the processor and the batch size; a game must
//! depend on neither. In this crate, the operations and their order are fixed when the file is
//! read. Shapes are checked at that time, so that [`Network::evaluate`] neither fails nor
//! allocates. `operator.rs` lists the supported operators. Files come from PyTorch or from
//! [`Perceptron`]. In PyTorch, export the part of a policy that outputs logits with
//! `torch.onnx.export(…, external_data=False)`.

mod activation;
mod arrangement;
mod elementwise;
mod error;
mod limit;
mod linear;
mod node;
mod normalisation;
mod operator;
mod perceptron;
mod plan;
mod proto;
mod reader;
mod row;
mod step;
mod tensor;
#[cfg(test)]
mod tests;

pub use activation::tanh;
pub use error::NetworkError;
pub use perceptron::{Head, Layer, Perceptron};

use plan::Plan;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// An input or an output of a network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name in the file.
    pub name: String,
    /// Values per row.
    pub size: usize,
    /// Whether the values are integers, such as the index of an action.
    pub is_integer: bool,
}

/// An evaluable network. Clones share their weights.
#[derive(Clone)]
pub struct Network {
    plan: Arc<Plan>,
    /// Inputs, constants and computed values, in evaluation order.
    values: Vec<f32>,
}

impl Network {
    /// Reads an ONNX file. A first dimension that is 1 or has no size is the batch dimension; only
    /// one row of it is evaluated.
    ///
    /// # Errors
    /// If the bytes are not an ONNX file, exceed the limits on memory or time, or use an
    /// unsupported shape or operator; or if weights are non-finite or outside the file.
    pub fn read(bytes: &[u8]) -> Result<Network, NetworkError> {
        let (plan, values) = reader::read(bytes)?;
        Ok(Network {
            plan: Arc::new(plan),
            values,
        })
    }

    /// The inputs, in the order of [`Network::evaluate`].
    pub fn inputs(&self) -> &[Port] {
        &self.plan.inputs
    }

    /// The outputs, in file order.
    pub fn outputs(&self) -> &[Port] {
        &self.plan.outputs
    }

    /// The author's metadata in the file: `metadata_props`.
    pub fn metadata(&self) -> &BTreeMap<String, String> {
        &self.plan.metadata
    }

    /// Differences between the file's declarations and what it computes, such as an output's shape.
    pub fn warnings(&self) -> &[String] {
        &self.plan.warnings
    }

    /// 128-bit XXH3 digest of the file.
    pub fn digest(&self) -> u128 {
        self.plan.digest
    }

    /// The number of values in all inputs together.
    pub fn input_size(&self) -> usize {
        self.plan.input_size
    }

    /// Computes all outputs for one row of each input; `input` concatenates the rows.
    ///
    /// # Panics
    /// If the number of values is not [`Network::input_size`].
    pub fn evaluate(&mut self, input: &[f32]) {
        assert_eq!(
            input.len(),
            self.plan.input_size,
            "length of the network's input"
        );
        self.values[..input.len()].copy_from_slice(input);
        for step in &self.plan.steps {
            step.take(&mut self.values);
        }
    }

    /// Output number `index` of the last evaluation.
    ///
    /// # Panics
    /// If `index` is out of range.
    pub fn output(&self, index: usize) -> &[f32] {
        &self.values[self.plan.places[index].clone()]
    }
}

impl fmt::Debug for Network {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = formatter.debug_struct("Network");
        shown
            .field("inputs", &self.inputs())
            .field("outputs", &self.outputs())
            .finish_non_exhaustive()
    }
}
