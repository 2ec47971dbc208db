//! A multilayer perceptron with hyperbolic tangents after all layers except the last.

use nalgebra::{DMatrixView, DMatrixViewMut};
use onnx::tanh;
use primitives::stream::Stream;
use serde::{Deserialize, Serialize};

/// A multilayer perceptron.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Perceptron {
    /// Row sizes of the input, the hidden layers and the output.
    sizes: Vec<usize>,
    /// By layer: the weights from each input to all outputs, then the biases.
    parameters: Vec<f32>,
}

/// Data of the forward pass that the backward pass needs: the rows of every layer, input first.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    layers: Vec<Vec<f32>>,
}

impl Trace {
    /// The output, rows × values.
    pub fn output(&self) -> &[f32] {
        self.layers.last().map_or(&[], Vec::as_slice)
    }
}

/// The indices of a layer's parameters.
#[derive(Clone, Copy)]
struct Layer {
    inputs: usize,
    outputs: usize,
    weights: usize,
    biases: usize,
    end: usize,
}

impl Perceptron {
    /// Random orthogonal weights with a gain of √2, or `output_gain` in the last layer, and zero
    /// biases (as for PPO in Andrychowicz and others, ICLR 2021).
    ///
    /// # Panics
    /// With fewer than two sizes, or a size of 0.
    pub fn new(sizes: &[usize], output_gain: f32, stream: &mut Stream) -> Perceptron {
        assert!(sizes.len() >= 2 && !sizes.contains(&0), "{sizes:?}");
        let count = sizes.windows(2).map(|pair| (pair[0] + 1) * pair[1]).sum();
        let mut network = Perceptron {
            sizes: sizes.to_vec(),
            parameters: vec![0.0; count],
        };
        let last = sizes.len() - 2;
        for (i, layer) in network.layers().enumerate().collect::<Vec<_>>() {
            let gain = if i == last {
                output_gain
            } else {
                std::f32::consts::SQRT_2
            };
            let weights = orthogonal(layer.inputs, layer.outputs, stream);
            let place = &mut network.parameters[layer.weights..layer.biases];
            place
                .iter_mut()
                .zip(weights)
                .for_each(|(place, weight)| *place = gain * weight as f32);
        }
        network
    }

    /// Row size of each layer, input first.
    pub fn sizes(&self) -> &[usize] {
        &self.sizes
    }

    /// All weights and biases.
    pub fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    /// All weights and biases, mutable.
    pub fn parameters_mut(&mut self) -> &mut [f32] {
        &mut self.parameters
    }

    /// The weights of a layer, inputs × outputs, and its biases.
    pub fn layer(&self, i: usize) -> (&[f32], &[f32]) {
        let layer = self.layers().nth(i).expect("the layer exists");
        (
            &self.parameters[layer.weights..layer.biases],
            &self.parameters[layer.biases..layer.end],
        )
    }

    fn layers(&self) -> impl Iterator<Item = Layer> + use<> {
        let mut end = 0;
        let sizes = self.sizes.clone();
        (1..sizes.len()).map(move |i| {
            let inputs = sizes[i - 1];
            let outputs = sizes[i];
            let weights = end;
            let biases = weights + inputs * outputs;
            end = biases + outputs;
            Layer {
                inputs,
                outputs,
                weights,
                biases,
                end,
            }
        })
    }

    /// Computes the output for every row of `input`, rows × values. Keeps the data for the backward
    /// pass in `trace`, reusing its memory.
    pub fn forward(&self, input: &[f32], trace: &mut Trace) {
        let rows = input.len() / self.sizes[0];
        debug_assert_eq!(input.len(), rows * self.sizes[0]);
        trace.layers.resize(self.sizes.len(), Vec::new());
        trace.layers[0].clear();
        trace.layers[0].extend_from_slice(input);
        let last = self.sizes.len() - 2;
        for (i, layer) in self.layers().enumerate() {
            let (before, after) = trace.layers.split_at_mut(i + 1);
            let before = &before[i];
            let after = &mut after[0];
            let biases = &self.parameters[layer.biases..layer.end];
            after.clear();
            (0..rows).for_each(|_| after.extend_from_slice(biases));
            // Rows are stored consecutively, so a column-major library sees every matrix
            // transposed.
            let weights = columns(
                &self.parameters[layer.weights..layer.biases],
                layer.outputs,
                layer.inputs,
            );
            // For networks of a few hundred units this is faster than JAX, torch, burn and candle,
            // each measured for one PPO update.
            columns_mut(after, layer.outputs, rows).gemm(
                1.0,
                &weights,
                &columns(before, layer.inputs, rows),
                1.0,
            );
            if i < last {
                // The rational approximation from the model evaluator: libm's tanh would take most
                // of the time, and a policy must compute the same values on the boat as in
                // training.
                after.iter_mut().for_each(|number| *number = tanh(*number));
            }
        }
    }

    /// Adds the gradient of a loss with respect to all parameters to `gradient`. `by_output` is the
    /// loss's gradient with respect to the outputs, rows × values; it is overwritten. Writes the
    /// gradient with respect to the inputs to `by_input`, if given.
    pub fn backward(
        &self,
        trace: &Trace,
        by_output: &mut Vec<f32>,
        gradient: &mut [f32],
        by_input: Option<&mut Vec<f32>>,
    ) {
        let rows = by_output.len() / self.sizes[self.sizes.len() - 1];
        let layers: Vec<Layer> = self.layers().collect();
        let mut by_before = Vec::new();
        for (i, layer) in layers.iter().enumerate().rev() {
            let before = &trace.layers[i];
            let (weights, biases) =
                gradient[layer.weights..layer.end].split_at_mut(layer.inputs * layer.outputs);
            for row in by_output.chunks_exact(layer.outputs) {
                biases
                    .iter_mut()
                    .zip(row)
                    .for_each(|(sum, number)| *sum += number);
            }
            let by = columns(by_output, layer.outputs, rows);
            // A copy, not a strided view: nalgebra 0.35's product of such a view with a matrix of
            // up to five rows wrote beyond the end of the result.
            let turned = transposed(before, layer.inputs);
            columns_mut(weights, layer.outputs, layer.inputs).gemm(
                1.0,
                &by,
                &columns(&turned, rows, layer.inputs),
                1.0,
            );
            if i == 0 && by_input.is_none() {
                break;
            }
            by_before.clear();
            by_before.resize(rows * layer.inputs, 0.0);
            let weights = &self.parameters[layer.weights..layer.biases];
            let turned = transposed(weights, layer.outputs);
            columns_mut(&mut by_before, layer.inputs, rows).gemm(
                1.0,
                &columns(&turned, layer.inputs, layer.outputs),
                &by,
                0.0,
            );
            if i > 0 {
                // The derivative of the hyperbolic tangent.
                by_before
                    .iter_mut()
                    .zip(before)
                    .for_each(|(by, number)| *by *= 1.0 - number * number);
            }
            std::mem::swap(by_output, &mut by_before);
        }
        if let Some(by_input) = by_input {
            std::mem::swap(by_input, by_output);
        }
    }
}

/// A column-major matrix.
fn columns(numbers: &[f32], height: usize, width: usize) -> DMatrixView<'_, f32> {
    DMatrixView::from_slice(numbers, height, width)
}

fn columns_mut(numbers: &mut [f32], height: usize, width: usize) -> DMatrixViewMut<'_, f32> {
    DMatrixViewMut::from_slice(numbers, height, width)
}

/// Converts row-major numbers to column-major.
fn transposed(numbers: &[f32], width: usize) -> Vec<f32> {
    let height = numbers.len() / width;
    let mut turned = vec![0.0; numbers.len()];
    for (i, row) in numbers.chunks_exact(width).enumerate() {
        turned[i..]
            .iter_mut()
            .step_by(height)
            .zip(row)
            .for_each(|(place, number)| *place = *number);
    }
    turned
}

/// A random row-major matrix with orthonormal rows or columns, whichever are fewer: normal numbers
/// after the Gram-Schmidt process.
fn orthogonal(rows: usize, columns: usize, stream: &mut Stream) -> Vec<f64> {
    let count = rows.min(columns);
    let length = rows.max(columns);
    let mut vectors: Vec<Vec<f64>> = Vec::with_capacity(count);
    while vectors.len() < count {
        let mut vector: Vec<f64> = (0..length).map(|_| stream.normal()).collect();
        for other in &vectors {
            let along: f64 = vector.iter().zip(other).map(|(a, b)| a * b).sum();
            vector
                .iter_mut()
                .zip(other)
                .for_each(|(number, other)| *number -= along * other);
        }
        let size = vector
            .iter()
            .map(|number| number * number)
            .sum::<f64>()
            .sqrt();
        if size > 1e-6 {
            vector.iter_mut().for_each(|number| *number /= size);
            vectors.push(vector);
        }
    }
    let at = |row: usize, column: usize| {
        if rows <= columns {
            vectors[row][column]
        } else {
            vectors[column][row]
        }
    };
    (0..rows * columns)
        .map(|i| at(i / columns, i % columns))
        .collect()
}
