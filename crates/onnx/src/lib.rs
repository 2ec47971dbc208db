//! A trained policy: a network from an ONNX file, evaluated one row at a time with the same bits on
//! every machine.
//!
//! A general runtime chooses the order of its sums by processor and batch size, and a game must
//! depend on neither. Here the operations and their order are fixed when the file is read. Shapes
//! are checked then, and [`Network::evaluate`] neither fails nor allocates. `operator.rs` lists the
//! operators. Files come from PyTorch (`torch.onnx.export(…, external_data=False)`, of the part of
//! a policy that outputs logits) or from [`Perceptron`].

mod activation;
mod arrangement;
mod elementwise;
mod error;
mod limit;
mod linear;
mod node;
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
pub use perceptron::{Activation, Head, Layer, Normalisation, Perceptron};

use plan::Plan;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// An input or an output of a network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name in the file.
    pub name: String,
    /// The number of values in a row.
    pub size: usize,
}

/// A network that can be evaluated. Clones share their weights.
#[derive(Clone)]
pub struct Network {
    plan: Arc<Plan>,
    /// Inputs, constants and all computed values, in order of evaluation.
    values: Vec<f32>,
}

impl Network {
    /// Reads an ONNX file. A first dimension of 1 or without a size is the batch dimension,
    /// evaluated as one row.
    ///
    /// # Errors
    /// If the bytes are not an ONNX file, need too much memory or time, have weights that are not
    /// finite or not in the file, or have a shape or an operator that is not supported.
    pub fn read(bytes: &[u8]) -> Result<Network, NetworkError> {
        let (plan, values) = reader::read(bytes)?;
        Ok(Network { plan: Arc::new(plan), values })
    }

    /// The inputs, in the argument order of [`Network::evaluate`].
    #[must_use]
    pub fn inputs(&self) -> &[Port] {
        &self.plan.inputs
    }

    /// The outputs, in the file's order.
    #[must_use]
    pub fn outputs(&self) -> &[Port] {
        &self.plan.outputs
    }

    /// The file's metadata, written by its author: `metadata_props`.
    #[must_use]
    pub fn metadata(&self) -> &BTreeMap<String, String> {
        &self.plan.metadata
    }

    /// XXH3 digest, 128 bits, of the file's bytes.
    #[must_use]
    pub fn digest(&self) -> u128 {
        self.plan.digest
    }

    /// The number of values that [`Network::evaluate`] takes for all inputs together.
    #[must_use]
    pub fn input_size(&self) -> usize {
        self.plan.input_size
    }

    /// Computes all outputs for one row of each input, the inputs concatenated.
    ///
    /// # Panics
    /// If the number of values is not [`Network::input_size`].
    pub fn evaluate(&mut self, input: &[f32]) {
        assert_eq!(input.len(), self.plan.input_size, "numbers of the network's input");
        self.values[..input.len()].copy_from_slice(input);
        for step in &self.plan.steps {
            step.take(&mut self.values);
        }
    }

    /// Output number `index` of the last evaluation.
    ///
    /// # Panics
    /// If `index` is out of range.
    #[must_use]
    pub fn output(&self, index: usize) -> &[f32] {
        &self.values[self.plan.places[index].clone()]
    }

    /// The output with this name in the last evaluation, if it exists.
    #[must_use]
    pub fn output_named(&self, name: &str) -> Option<&[f32]> {
        let index = self.plan.outputs.iter().position(|port| port.name == name)?;
        Some(self.output(index))
    }

    /// Whether all outputs of the last evaluation are finite numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        (0..self.plan.places.len()).all(|index| self.output(index).iter().all(|number| number.is_finite()))
    }
}

impl fmt::Debug for Network {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = formatter.debug_struct("Network");
        shown.field("inputs", &self.inputs()).field("outputs", &self.outputs()).finish_non_exhaustive()
    }
}
