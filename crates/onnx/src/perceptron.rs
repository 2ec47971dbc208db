//! Writes a multilayer perceptron from a trainer as an ONNX file.

use super::proto::{
    AttributeProto, DimensionProto, FLOAT, GraphProto, ModelProto, NodeProto, OperatorSetIdProto,
    StringStringEntryProto, TensorProto, TensorShapeProto, TensorTypeProto, TypeProto,
    ValueInfoProto,
};
use super::{Network, NetworkError};
use prost::Message;
use std::collections::BTreeMap;

/// Format and operator set versions of written files: those of ONNX 1.12, which all runtimes
/// support.
const IR_VERSION: i64 = 8;
const OPERATORS_VERSION: i64 = 17;

/// The name of the input.
const INPUT: &str = "observation";

/// Dense layers with the hyperbolic tangent between them and at least one output.
#[derive(Clone, Debug, PartialEq)]
pub struct Perceptron {
    /// The hidden layers, each followed by the hyperbolic tangent.
    pub hidden: Vec<Layer>,
    /// The outputs, each a layer after the last hidden layer.
    pub heads: Vec<Head>,
    /// Whether the hyperbolic tangent follows each output.
    pub bounded: bool,
    /// The metadata of the file.
    pub metadata: BTreeMap<String, String>,
}

/// A dense layer: each output is a bias plus a weighted sum of the inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Number of inputs.
    pub inputs: usize,
    /// Number of outputs.
    pub outputs: usize,
    /// `outputs` rows of `inputs` weights, as in PyTorch.
    pub weights: Vec<f32>,
    /// One bias per output.
    pub biases: Vec<f32>,
}

/// An output of a perceptron.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Its name.
    pub name: String,
    /// Its weights.
    pub layer: Layer,
}

impl Perceptron {
    /// This perceptron as an ONNX file; the same perceptron always gives the same bytes.
    ///
    /// # Errors
    /// If sizes do not match, a number is non-finite, or [`Network::read`] would reject the file
    /// for any other reason.
    pub fn onnx(&self) -> Result<Vec<u8>, NetworkError> {
        let first = self
            .hidden
            .first()
            .or_else(|| self.heads.first().map(|head| &head.layer));
        let inputs = first.map_or(0, |layer| layer.inputs);
        let mut graph = GraphProto {
            name: "policy".to_owned(),
            ..GraphProto::default()
        };
        graph.input.push(port(INPUT, inputs));
        let mut last = INPUT.to_owned();
        for (i, layer) in self.hidden.iter().enumerate() {
            let sums = format!("hidden.{i}.sums");
            dense(&mut graph, &format!("hidden.{i}"), layer, &last, &sums);
            last = format!("hidden.{i}.output");
            graph.node.push(node("Tanh", [&sums], &last));
        }
        for (i, head) in self.heads.iter().enumerate() {
            let sums = if self.bounded {
                format!("head.{i}.sums")
            } else {
                head.name.clone()
            };
            dense(&mut graph, &format!("head.{i}"), &head.layer, &last, &sums);
            graph
                .node
                .extend(self.bounded.then(|| node("Tanh", [&sums], &head.name)));
            graph.output.push(port(&head.name, head.layer.outputs));
        }
        let entry = |(key, value): (&String, &String)| StringStringEntryProto {
            key: key.clone(),
            value: value.clone(),
        };
        let model = ModelProto {
            ir_version: IR_VERSION,
            producer_name: "squall".to_owned(),
            graph: Some(graph),
            opset_import: vec![OperatorSetIdProto {
                domain: String::new(),
                version: OPERATORS_VERSION,
            }],
            metadata_props: self.metadata.iter().map(entry).collect(),
        };
        let bytes = model.encode_to_vec();
        // All checks on files are in [`Network::read`].
        Network::read(&bytes)?;
        Ok(bytes)
    }
}

fn dense(graph: &mut GraphProto, name: &str, layer: &Layer, input: &str, output: &str) {
    let [weight, bias] = ["weight", "bias"].map(|part| format!("{name}.{part}"));
    graph.initializer.push(tensor(
        &weight,
        &[layer.outputs, layer.inputs],
        &layer.weights,
    ));
    graph
        .initializer
        .push(tensor(&bias, &[layer.outputs], &layer.biases));
    let transposed = AttributeProto {
        name: "transB".to_owned(),
        i: Some(1),
        r#type: 2,
        ..AttributeProto::default()
    };
    let gemm = node("Gemm", [input, &weight, &bias], output);
    graph.node.push(NodeProto {
        name: name.to_owned(),
        attribute: vec![transposed],
        ..gemm
    });
}

fn node<const INPUTS: usize>(operator: &str, inputs: [&str; INPUTS], output: &str) -> NodeProto {
    NodeProto {
        input: inputs.map(str::to_owned).to_vec(),
        output: vec![output.to_owned()],
        name: output.to_owned(),
        op_type: operator.to_owned(),
        ..NodeProto::default()
    }
}

fn tensor(name: &str, shape: &[usize], numbers: &[f32]) -> TensorProto {
    TensorProto {
        dims: shape.iter().map(|dim| *dim as i64).collect(),
        data_type: FLOAT,
        name: name.to_owned(),
        raw_data: Some(
            numbers
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect(),
        ),
        ..TensorProto::default()
    }
}

/// An input or output with a batch dimension.
fn port(name: &str, size: usize) -> ValueInfoProto {
    let batch = DimensionProto {
        dim_param: Some("batch".to_owned()),
        ..DimensionProto::default()
    };
    let row = DimensionProto {
        dim_value: Some(size as i64),
        ..DimensionProto::default()
    };
    let shape = Some(TensorShapeProto {
        dim: vec![batch, row],
    });
    let tensor_type = Some(TensorTypeProto {
        elem_type: FLOAT,
        shape,
    });
    ValueInfoProto {
        name: name.to_owned(),
        r#type: Some(TypeProto { tensor_type }),
    }
}
