//! Networks as ONNX files.

use super::Perceptron;
use onnx::{Head, Layer, NetworkError};
use std::collections::BTreeMap;

impl Perceptron {
    /// This network as an ONNX file, from `observation` to `output`; if `bounded`, the hyperbolic
    /// tangent is applied to every output.
    ///
    /// # Errors
    /// [`NetworkError`] if a weight is not finite.
    pub fn onnx(
        &self,
        output: &str,
        bounded: bool,
        metadata: BTreeMap<String, String>,
    ) -> Result<Vec<u8>, NetworkError> {
        let layers = self.sizes().len() - 1;
        let mut layers: Vec<Layer> = (0..layers).map(|i| self.onnx_layer(i)).collect();
        let last = layers.pop().map(|layer| Head {
            name: output.to_owned(),
            layer,
        });
        let network = onnx::Perceptron {
            hidden: layers,
            heads: last.into_iter().collect(),
            bounded,
            metadata,
        };
        network.onnx()
    }

    fn onnx_layer(&self, i: usize) -> Layer {
        let inputs = self.sizes()[i];
        let outputs = self.sizes()[i + 1];
        let (weights, biases) = self.layer(i);
        // Weights are grouped by input in this network, but by output in ONNX files.
        let turned =
            (0..outputs).flat_map(|to| (0..inputs).map(move |from| weights[from * outputs + to]));
        Layer {
            inputs,
            outputs,
            weights: turned.collect(),
            biases: biases.to_vec(),
        }
    }
}
