//! The parts of an accepted file that are evaluated, and their maximum cost.

use super::*;

/// Ten names for the same weights cost ten times the work.
#[test]
fn weights_are_counted_wherever_they_are_used() {
    let mut model = sound();
    graph(&mut model)
        .initializer
        .push(tensor("large", &[1000, 1000], &vec![0.5; 1_000_000]));
    graph(&mut model)
        .initializer
        .push(tensor("first", &[2, 1000], &vec![0.5; 2_000]));
    graph(&mut model)
        .node
        .push(node("MatMul", &["x", "first"], "layer 0"));
    for i in 0..10 {
        graph(&mut model).node.push(node(
            "MatMul",
            &[&format!("layer {i}"), "large"],
            &format!("layer {}", i + 1),
        ));
    }
    graph(&mut model).output.push(port("layer 10", &[0, 1000]));
    let error = Network::read(&model.encode_to_vec())
        .expect_err("too many")
        .to_string();
    assert!(error.starts_with("weights: found 10"), "{error}");
}

#[test]
fn numbers_that_double_with_each_node_are_refused() {
    let mut model = sound();
    let graph = graph(&mut model);
    for i in 0..40 {
        let from = if i == 0 {
            "x".to_owned()
        } else {
            format!("double {i}")
        };
        let concat = node("Concat", &[&from, &from], &format!("double {}", i + 1));
        graph.node.push(NodeProto {
            attribute: vec![integer("axis", 1)],
            ..concat
        });
    }
    graph.output.push(port("double 40", &[0, 2]));
    let error = Network::read(&model.encode_to_vec())
        .expect_err("too many")
        .to_string();
    assert!(
        error.starts_with("numbers in an evaluation: found 10"),
        "{error}"
    );
}

/// Nodes and numbers that no output needs may be of any kind.
#[test]
fn what_no_output_needs_is_not_evaluated() {
    let mut model = sound();
    let graph = graph(&mut model);
    graph
        .node
        .push(node("Multinomial", &["sums", "unused"], "sample"));
    graph.initializer.push(TensorProto {
        data_type: 8,
        ..tensor("unused", &[1], &[])
    });
    let mut network = Network::read(&model.encode_to_vec()).expect("the node is not needed");
    network.evaluate(&[1.0, 10.0]);
    assert_eq!(network.output(0), [0.0, 52.0, 163.0]);
}

#[test]
fn a_declared_output_that_deviates_is_a_warning() {
    let mut model = sound();
    graph(&mut model).output[0] = port("y", &[32, 3]);
    let network = Network::read(&model.encode_to_vec()).expect("the declared shape has no effect");
    assert_eq!(
        network.warnings(),
        ["output `y`: declared as 32 x 3, computed as the shape 1 x 3"]
    );
    assert_eq!(network.outputs()[0].size, 3);
    assert!(
        Network::read(&sound().encode_to_vec())
            .expect("the model is valid")
            .warnings()
            .is_empty()
    );
}

/// A second output of a dropout, its mask, has no meaning in inference.
#[test]
fn only_the_first_output_of_a_normalisation_can_be_used() {
    let mut model = sound();
    let graph = graph(&mut model);
    let dropout = node("Dropout", &["sums"], "kept");
    with_node(
        graph,
        NodeProto {
            output: vec!["kept".to_owned(), "mask".to_owned()],
            ..dropout
        },
    );
    graph.output.push(port("mask", &[0, 3]));
    let error = Network::read(&model.encode_to_vec())
        .expect_err("the mask is used")
        .to_string();
    assert!(
        error.contains("found a use of the output `mask`"),
        "{error}"
    );
    model
        .graph
        .as_mut()
        .expect("the model has a graph")
        .output
        .pop();
    Network::read(&model.encode_to_vec()).expect("the mask is unused");
}

/// The shape of a view may be computed from constants.
#[test]
fn constant_integers_are_computed_when_the_file_is_read() {
    for (operator, lists, want) in [
        ("Max", &[&[1, 1][..], &[0, 3], &[1, 2]][..], true),
        ("Max", &[&[1, 3]], true),
        ("Mul", &[&[1, 3], &[1]], true),
        ("Add", &[&[1, 3], &[1]], false),
        ("Where", &[&[1, 0], &[1, 9], &[9, 3]], true),
    ] {
        let mut model = sound();
        let graph = graph(&mut model);
        let names: Vec<String> = (0..lists.len()).map(|i| format!("list {i}")).collect();
        for (name, list) in names.iter().zip(lists) {
            let proto = TensorProto {
                data_type: INT64,
                int64_data: list.to_vec(),
                ..tensor(name, &[list.len() as i64], &[])
            };
            graph.initializer.push(proto);
        }
        with_node(graph, node("Reshape", &["sums", "shape"], "z"));
        graph.node.insert(
            0,
            node(
                operator,
                &names.iter().map(String::as_str).collect::<Vec<_>>(),
                "shape",
            ),
        );
        assert_eq!(
            Network::read(&model.encode_to_vec()).is_ok(),
            want,
            "{operator} of {lists:?}"
        );
    }
}
