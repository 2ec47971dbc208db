//! Rejected files and the reasons reported.

mod accepted;

use super::Network;
use super::proto::{
    AttributeProto, DOUBLE, DimensionProto, EXTERNAL, FLOAT, GraphProto, INT64, ModelProto,
    NodeProto, OperatorSetIdProto, StringStringEntryProto, TensorProto, TensorShapeProto,
    TensorTypeProto, TypeProto, ValueInfoProto,
};
use prost::Message;

/// `AttributeProto.AttributeType`.
const OF_FLOAT: i32 = 1;
const OF_INTEGER: i32 = 2;

fn tensor(name: &str, dims: &[i64], numbers: &[f32]) -> TensorProto {
    let name = name.to_owned();
    let dims = dims.to_vec();
    let float_data = numbers.to_vec();
    TensorProto {
        name,
        dims,
        data_type: FLOAT,
        float_data,
        ..TensorProto::default()
    }
}

fn node(operator: &str, inputs: &[&str], output: &str) -> NodeProto {
    let input = inputs.iter().map(|&name| name.to_owned()).collect();
    let name = format!("{output} node");
    let op_type = operator.to_owned();
    NodeProto {
        input,
        output: vec![output.to_owned()],
        name,
        op_type,
        ..NodeProto::default()
    }
}

fn integer(name: &str, i: i64) -> AttributeProto {
    AttributeProto {
        name: name.to_owned(),
        i: Some(i),
        r#type: OF_INTEGER,
        ..AttributeProto::default()
    }
}

/// An input or output. A dimension of 0 has no size.
fn port(name: &str, dims: &[i64]) -> ValueInfoProto {
    let dim = |dim: &i64| DimensionProto {
        dim_value: Some(*dim).filter(|dim| *dim != 0),
        dim_param: None,
    };
    let shape = Some(TensorShapeProto {
        dim: dims.iter().map(dim).collect(),
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

fn graph(model: &mut ModelProto) -> &mut GraphProto {
    model.graph.as_mut().expect("the model has a graph")
}

/// Two inputs, three outputs: `y = relu(x w + b)`.
fn sound() -> ModelProto {
    let graph = GraphProto {
        node: vec![
            node("Gemm", &["x", "w", "b"], "sums"),
            node("Relu", &["sums"], "y"),
        ],
        initializer: vec![
            tensor("w", &[2, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            tensor("b", &[3], &[-100.0, 0.0, 100.0]),
        ],
        input: vec![port("x", &[0, 2])],
        output: vec![port("y", &[0, 3])],
        ..GraphProto::default()
    };
    ModelProto {
        ir_version: 8,
        graph: Some(graph),
        opset_import: vec![OperatorSetIdProto {
            domain: String::new(),
            version: 17,
        }],
        ..ModelProto::default()
    }
}

/// Inserts a node between the first layer and the output.
fn with_node(graph: &mut GraphProto, node: NodeProto) {
    graph.node[1].input[0].clone_from(&node.output[0]);
    graph.node.insert(1, node);
}

#[test]
fn the_sound_model_is_read() {
    let mut network = Network::read(&sound().encode_to_vec()).expect("the model is valid");
    network.evaluate(&[1.0, 10.0]);
    assert_eq!(network.output(0), [0.0, 52.0, 163.0]);
}

type Change<T> = fn(&mut T);

fn refuse(cases: &[(Change<GraphProto>, &str)]) {
    for (change, want) in cases {
        let mut model = sound();
        change(graph(&mut model));
        refuse_model(&model, want);
    }
}

fn refuse_models(cases: &[(Change<ModelProto>, &str)]) {
    for (change, want) in cases {
        let mut model = sound();
        change(&mut model);
        refuse_model(&model, want);
    }
}

fn refuse_model(model: &ModelProto, want: &str) {
    match Network::read(&model.encode_to_vec()) {
        Ok(_) => panic!("the file was read, expected {want:?}"),
        Err(error) => assert!(
            error.to_string().contains(want),
            "{error}\nexpected {want:?}"
        ),
    }
}

#[test]
fn bytes_that_are_no_model_are_refused() {
    let sound = sound().encode_to_vec();
    let too_long = vec![0; (64 << 20) + 1];
    let cases: [(&[u8], &str); 9] = [
        (
            b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 12345\n",
            "a Git LFS pointer, expected the ONNX file that it points to: run `git lfs pull`",
        ),
        (
            b"",
            "not an ONNX file, or corrupted (a message without a graph at byte 0)",
        ),
        (b"\x89HDF\r\n\x1a\n", "not an ONNX file"),
        (b"PK\x03\x04", "unexpected wire type 3 at byte 2"),
        (&sound[..sound.len() - 1], "bytes remaining"),
        (
            b"\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff",
            "an unterminated number at byte 0",
        ),
        (
            b"\x3a\xff\xff\xff\xff\xff\xff\xff\xff\x7f",
            "a field of 9223372036854775807 bytes with 0 bytes remaining",
        ),
        (b"\x3a\x00", "the model: found no opset version"),
        (
            &too_long,
            "bytes of the file: found 67108865, expected at most 67108864",
        ),
    ];
    for (bytes, want) in cases {
        let error = Network::read(bytes).expect_err(want).to_string();
        assert!(error.contains(want), "{error}\nexpected {want:?}");
    }
}

#[test]
fn models_that_cannot_be_evaluated_are_refused() {
    refuse_models(&[
        (
            |m| m.opset_import.clear(),
            "the model: found no opset version (opset_import), expected 7 to",
        ),
        (
            |m| m.opset_import[0].version = 6,
            "the model: found opset version 6, expected 7 to",
        ),
        (|m| m.opset_import[0].version = 99, "found opset version 99"),
        (
            |m| {
                m.metadata_props = vec![
                    StringStringEntryProto {
                        key: "a\nb".to_owned(),
                        value: String::new()
                    };
                    2
                ]
            },
            "the model: found two metadata entries `a\\nb`",
        ),
    ]);
    refuse(&[
        (
            |g| g.input.clear(),
            "the model: found no input, expected at least one",
        ),
        (
            |g| g.output.clear(),
            "the model: found no output, expected at least one",
        ),
        (
            |g| g.input[0] = port("x", &[4, 2]),
            "tensor `x`: found the shape 4 x 2, expected a first dimension",
        ),
        (
            |g| g.input[0] = port("x", &[1, 0]),
            "tensor `x`: found dimension 1 without a size",
        ),
        (
            |g| g.input[0] = port("x", &[1, -2]),
            "tensor `x`: found dimension 1 of -2",
        ),
        (
            |g| g.input[0] = port("x", &[1; 9]),
            "tensor `x`: found 9 dimensions, expected at most 8",
        ),
        (
            |g| g.input[0] = port("x", &[1, 1 << 40]),
            "numbers in an evaluation: found 1099511627776",
        ),
        (
            |g| g.input[0] = port("x", &[1, i64::MAX, i64::MAX]),
            "numbers in an evaluation: found 18446744073709551615",
        ),
        (
            |g| g.input[0].r#type = None,
            "tensor `x`: found something that is not a tensor",
        ),
        (
            |g| g.output.push(port("z", &[0, 3])),
            "tensor `z`: found an output that no node computes",
        ),
        (
            |g| g.output.push(port("y", &[0, 3])),
            "tensor `y`: found an output named twice",
        ),
    ]);
}

#[test]
fn tensors_that_cannot_be_used_are_refused() {
    refuse(&[
        (
            |g| g.initializer[0].float_data[2] = f32::NAN,
            "tensor `w`: found NaN, expected numbers",
        ),
        (
            |g| g.initializer[1].float_data[0] = f32::INFINITY,
            "(Gemm): found a number in input 2 that is infinite in single precision, expected finite numbers",
        ),
        (
            |g| _ = g.initializer[0].float_data.pop(),
            "tensor `w`: found 5 numbers, expected 6 for the shape 2 x 3",
        ),
        (
            |g| g.initializer[0].raw_data = Some(vec![0; 25]),
            "tensor `w`: found 6 numbers, expected 6",
        ),
        (
            |g| g.initializer[0].dims[0] = -2,
            "tensor `w`: found a negative dimension",
        ),
        (
            |g| g.initializer[0].dims = vec![1 << 40, 0],
            "tensor `w`: found the shape 1099511627776 x 0, expected dimensions",
        ),
        (
            |g| g.initializer[0].dims[0] = i64::MAX,
            "numbers of tensor `w`: found 18446744073709551615",
        ),
        (
            |g| g.initializer[0].dims = vec![1; 9],
            "tensor `w`: found 9 dimensions, expected at most 8",
        ),
        (
            |g| g.initializer[0].data_type = 8,
            "tensor `w`: found STRING numbers, expected FLOAT, FLOAT16, BFLOAT16",
        ),
        (
            |g| g.initializer[0].data_type = 10,
            "tensor `w`: found 0 numbers, expected 6 for the shape 2 x 3",
        ),
        (
            |g| g.initializer[0].data_type = 77,
            "tensor `w`: found element type 77",
        ),
        (
            |g| {
                let doubles = vec![1e39, 1.0, 1.0, 1.0, 1.0, 1.0];
                let proto = TensorProto {
                    data_type: DOUBLE,
                    double_data: doubles,
                    ..tensor("w", &[2, 3], &[])
                };
                g.initializer[0] = proto;
            },
            "(Gemm): found a number in input 1 that is infinite in single precision",
        ),
        (
            |g| g.initializer[0].data_location = EXTERNAL,
            "tensor `w`: found a reference to another file, expected its numbers: export the model with external_data=False",
        ),
        (
            |g| g.initializer[0].name = "x".repeat(300),
            "` (Gemm): found the undefined input `w`",
        ),
        (
            |g| {
                let again = g.initializer[0].clone();
                g.initializer.push(again);
            },
            "tensor `w`: found a second definition",
        ),
    ]);
}

#[test]
fn nodes_that_cannot_be_evaluated_are_refused_by_name() {
    refuse(&[
        (
            |g| g.node[1].op_type = "Conv".to_owned(),
            "node `y node`: found the operator Conv, expected one of Abs, Add,",
        ),
        (
            |g| g.node[1].domain = "com.microsoft".to_owned(),
            "found the operator com.microsoft.Relu",
        ),
        (
            |g| g.node.swap(0, 1),
            "node `y node` (Relu): found the undefined input `sums`",
        ),
        (
            |g| g.node[0].input[0] = "y".to_owned(),
            "node `sums node` (Gemm): found the undefined input `y`",
        ),
        (
            |g| g.initializer.push(tensor("sums", &[1], &[1.0])),
            "tensor `sums`: found a second definition",
        ),
        (
            |g| g.node[0].output.push("z".to_owned()),
            "node `sums node` (Gemm): found 2 outputs, expected one",
        ),
        (
            |g| _ = g.node[1].input.pop(),
            "node `y node` (Relu): found 0 inputs, expected 1",
        ),
        (
            |g| g.node[1].attribute.push(integer("axis", 1)),
            "(Relu): found the attribute axis, expected none",
        ),
        (
            |g| g.node[0].attribute.push(integer("transA", 1)),
            "(Gemm): found the shape 2 x 1 with 2 x 3 weights, expected rows of 2 numbers",
        ),
        (
            |g| g.node[0].attribute.push(integer("transB", 1)),
            "found the shape 1 x 2 with 3 x 2 weights",
        ),
        (
            |g| {
                g.node[0].attribute.push(AttributeProto {
                    r#type: OF_FLOAT,
                    ..integer("transB", 1)
                })
            },
            "(Gemm): found the attribute transB of type 1, expected an integer",
        ),
        (
            |g| g.initializer[1] = tensor("b", &[2], &[1.0, 2.0]),
            "found the shape 2 as input 2, expected one bias, or 3",
        ),
        (
            |g| g.node[0].input[1] = "x".to_owned(),
            "(Gemm): found a computed input 1",
        ),
        (
            |g| with_node(g, node("Add", &["sums", "x"], "z")),
            "(Add): found the shape 1 x 3 with the shape 1 x 2",
        ),
        (
            |g| with_node(g, node("Concat", &["sums", "x"], "z")),
            "(Concat): found no axis, expected an axis",
        ),
        (
            |g| with_node(g, node("Unsqueeze", &["sums"], "z")),
            "(Unsqueeze): found no axes",
        ),
        (
            |g| with_node(g, node("ArgMax", &["sums"], "z")),
            "(ArgMax): found axis 0 of the shape 1 x 3, expected the last",
        ),
        (
            |g| with_node(g, node("Clip", &["sums", "b"], "z")),
            "(Clip): found 3 numbers as input 1, expected a single number",
        ),
    ]);
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table")]
fn arrangements_that_do_not_fit_are_refused() {
    fn with_integers(graph: &mut GraphProto, operator: &str, integers: &[&[i64]]) {
        let names: Vec<String> = (0..integers.len())
            .map(|i| format!("integers {i}"))
            .collect();
        for (name, integers) in names.iter().zip(integers) {
            let int64_data = integers.to_vec();
            let dims = &[int64_data.len() as i64];
            let proto = TensorProto {
                data_type: INT64,
                int64_data,
                ..tensor(name, dims, &[])
            };
            graph.initializer.push(proto);
        }
        let inputs: Vec<&str> = ["sums"]
            .into_iter()
            .chain(names.iter().map(String::as_str))
            .collect();
        with_node(graph, node(operator, &inputs, "z"));
    }
    refuse(&[
        (
            |g| with_integers(g, "Reshape", &[&[1, 4]]),
            "(Reshape): found the shape 1 x 3 reshaped to (1, 4), expected a shape",
        ),
        (
            |g| with_integers(g, "Reshape", &[&[-1, -1]]),
            "reshaped to (-1, -1)",
        ),
        (
            |g| with_integers(g, "Reshape", &[&[-1, 2]]),
            "reshaped to (-1, 2)",
        ),
        (
            |g| with_integers(g, "Reshape", &[&[0, 0, 0]]),
            "reshaped to (0, 0, 0)",
        ),
        (
            |g| with_integers(g, "Reshape", &[&[i64::MAX, i64::MAX, 4]]),
            "reshaped to (9223372036854775807",
        ),
        (
            |g| with_integers(g, "Reshape", &[&[1; 9]]),
            "found 9 integers as input 1, expected at most 8",
        ),
        (
            |g| with_integers(g, "Squeeze", &[&[1]]),
            "(Squeeze): found axes of the shape 1 x 3 that are not 1",
        ),
        (
            |g| with_integers(g, "Squeeze", &[&[-3]]),
            "(Squeeze): found axis -3, expected one of 2 axes",
        ),
        (
            |g| with_integers(g, "Unsqueeze", &[&[1, 1]]),
            "(Unsqueeze): found axis 1 twice",
        ),
        (
            |g| with_integers(g, "Unsqueeze", &[&[0, 1, 2, 3, 4, 5, 6]]),
            "found 9 dimensions of `z`, expected at most 8",
        ),
        (
            |g| with_integers(g, "Slice", &[&[0], &[2], &[1], &[0]]),
            "(Slice): found step 0, expected a step other than 0",
        ),
        (
            |g| with_integers(g, "Slice", &[&[0], &[2], &[1], &[-1]]),
            "(Slice): found the empty range 0 to 2 of axis 1 of the shape 1 x 3",
        ),
        (
            |g| with_integers(g, "Slice", &[&[2], &[1], &[1]]),
            "found the empty range 2 to 1 of axis 1 of the shape 1 x 3",
        ),
        (
            |g| with_integers(g, "Slice", &[&[0], &[2, 3]]),
            "found 1 starts, 2 ends, 1 axes and 1 steps",
        ),
        (
            |g| with_integers(g, "Slice", &[&[i64::MIN], &[i64::MAX], &[i64::MIN]]),
            "found axis -9223372036854775808",
        ),
        (
            |g| with_integers(g, "Gather", &[&[1]]),
            "(Gather): found index 1, expected an index into 1 numbers",
        ),
        (
            |g| with_integers(g, "Expand", &[&[1, 2]]),
            "(Expand): found the shape 1 x 3 expanded to [1, 2]",
        ),
        (
            |g| with_integers(g, "Expand", &[&[-1, 3]]),
            "(Expand): found the shape 1 x 3 expanded to [-1, 3]",
        ),
        (
            |g| with_integers(g, "Expand", &[&[1 << 40, 3]]),
            "numbers in an evaluation: found 3298534883333",
        ),
        (
            |g| with_integers(g, "Expand", &[&[0, 3]]),
            "a value of the model: found no numbers, expected at least one",
        ),
        (
            |g| with_integers(g, "Gather", &[&[]]),
            "a value of the model: found no numbers",
        ),
        (
            |g| with_integers(g, "Slice", &[&[0], &[i64::MAX], &[1], &[-(1 << 44)]]),
            "found the empty range 0 to 9223372036854775807 of axis 1",
        ),
        (
            |g| with_integers(g, "ReduceMean", &[&[2]]),
            "(ReduceMean): found axis 2, expected one of 2 axes",
        ),
        (
            |g| with_integers(g, "Add", &[&[1, 2, 3]]),
            "(Add): found integers as input 1, expected FLOAT numbers",
        ),
    ]);
}
