//! Converts an ONNX file to the plan of a network.

use super::error::{shape_text, shown};
use super::limit::{self, PARAMETERS_MAX, RANK_MAX, at_most};
use super::node::{self, Node};
use super::operator::OPERATORS;
use super::plan::{Element, Plan, Planner, Row, Value};
use super::proto::{
    self, DimensionProto, GraphProto, ModelProto, NodeProto, ValueInfoProto, data_type_name,
};
use super::tensor::Tensor;
use super::{NetworkError, Port};
use prost::Message;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::{Range, RangeInclusive};
use xxhash_rust::xxh3::xxh3_128;

/// Operator set versions with the implemented semantics. Before 7, attributes controlled
/// broadcasting. The last version is that of ONNX 1.23; later semantics are unknown.
const VERSIONS: RangeInclusive<i64> = 7..=28;

/// The beginning of a Git LFS pointer, which replaces a large model in a repository checked out
/// without Git LFS.
const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";

/// Operators whose outputs after the first may be unused.
const WITH_SPARE_OUTPUTS: [&str; 3] = ["BatchNormalization", "Dropout", "LayerNormalization"];

/// Reads a file. Returns its plan and the values before the first evaluation.
pub(super) fn read(file: &[u8]) -> Result<(Plan, Vec<f32>), NetworkError> {
    if file.starts_with(LFS_POINTER) {
        return Err(NetworkError::LfsPointer);
    }
    limit::check(file)?;
    let model = ModelProto::decode(file).map_err(|_| NetworkError::NotOnnx {
        byte: 0,
        found: "a message that is not a ModelProto".to_owned(),
    })?;
    let Some(graph) = &model.graph else {
        return Err(NetworkError::NotOnnx {
            byte: 0,
            found: "a message without a graph".to_owned(),
        });
    };
    let version = version(&model)?;
    let mut planner = Planner::default();
    let inputs = inputs(&mut planner, graph)?;
    let input_size = planner.values.len();
    let needed = needed(graph);
    constants(&mut planner, graph, &needed)?;
    for proto in graph.node.iter().filter(|node| computes(node, &needed)) {
        add(&mut planner, proto, version, &needed)?;
    }
    let mut warnings = vec![];
    let (outputs, places) = outputs(&mut planner, graph, &mut warnings)?
        .into_iter()
        .unzip();
    let Planner { values, steps, .. } = planner;
    let metadata = metadata(&model)?;
    let digest = xxh3_128(file);
    Ok((
        Plan {
            inputs,
            outputs,
            input_size,
            places,
            steps,
            metadata,
            warnings,
            digest,
        },
        values,
    ))
}

/// The names on which an output depends. Nodes that compute only other names are not evaluated.
fn needed(graph: &GraphProto) -> BTreeSet<&str> {
    let mut needed: BTreeSet<&str> = graph.output.iter().map(|info| info.name.as_str()).collect();
    for node in graph.node.iter().rev() {
        if computes(node, &needed) {
            // Omitted inputs have no name.
            needed.extend(
                node.input
                    .iter()
                    .map(String::as_str)
                    .filter(|name| !name.is_empty()),
            );
        }
    }
    needed
}

/// Whether a node computes one of these names.
fn computes(node: &NodeProto, names: &BTreeSet<&str>) -> bool {
    node.output.iter().any(|name| names.contains(name.as_str()))
}

/// The version of ONNX's own operator set.
fn version(model: &ModelProto) -> Result<i64, NetworkError> {
    let own = model.opset_import.iter().find(|set| is_own(&set.domain));
    let allowed = format!("{} to {}", VERSIONS.start(), VERSIONS.end());
    match own {
        Some(set) if VERSIONS.contains(&set.version) => Ok(set.version),
        Some(set) => Err(NetworkError::model(
            format!("opset version {}", set.version),
            allowed,
        )),
        None => Err(NetworkError::model(
            "no opset version (opset_import)",
            allowed,
        )),
    }
}

/// Whether an operator domain is ONNX's own.
fn is_own(domain: &str) -> bool {
    matches!(domain, "" | "ai.onnx")
}

fn metadata(model: &ModelProto) -> Result<BTreeMap<String, String>, NetworkError> {
    let mut metadata = BTreeMap::new();
    for entry in &model.metadata_props {
        if metadata
            .insert(entry.key.clone(), entry.value.clone())
            .is_some()
        {
            let found = format!("two metadata entries `{}`", shown(&entry.key));
            return Err(NetworkError::model(found, "unique keys"));
        }
    }
    Ok(metadata)
}

/// Lays out the graph's inputs. Files of early versions list initializers among them.
fn inputs(planner: &mut Planner, graph: &GraphProto) -> Result<Vec<Port>, NetworkError> {
    let constants: BTreeSet<&str> = graph
        .initializer
        .iter()
        .map(|tensor| tensor.name.as_str())
        .collect();
    let mut ports = vec![];
    for info in graph
        .input
        .iter()
        .filter(|info| !constants.contains(info.name.as_str()))
    {
        let shape = shape(info)?;
        if shape.contains(&0) {
            return Err(NetworkError::tensor(
                &info.name,
                shape_text(&shape),
                "dimensions of 1 or more",
            ));
        }
        if shape.len() > 1 && shape[0] != 1 {
            let expected = "a first dimension (the batch) of 1 or without a size";
            return Err(NetworkError::tensor(
                &info.name,
                shape_text(&shape),
                expected,
            ));
        }
        let row = planner.new_row(shape)?;
        ports.push(Port {
            name: info.name.clone(),
            size: row.place.len(),
            is_integer: false,
        });
        planner.define(&info.name, Value::Computed(row))?;
    }
    if ports.is_empty() {
        return Err(NetworkError::model("no input", "at least one"));
    }
    Ok(ports)
}

/// The dimensions of an input. The first, the batch, counts as 1 if its size is missing.
fn shape(info: &ValueInfoProto) -> Result<Vec<usize>, NetworkError> {
    let wrong =
        |found: String, expected: &str| Err(NetworkError::tensor(&info.name, found, expected));
    let Some(tensor) = info
        .r#type
        .as_ref()
        .and_then(|r#type| r#type.tensor_type.as_ref())
    else {
        return wrong(
            "something that is not a tensor".to_owned(),
            "a tensor of FLOAT numbers",
        );
    };
    if !proto::FLOATS.contains(&tensor.elem_type) {
        return wrong(data_type_name(tensor.elem_type.into()), "FLOAT numbers");
    }
    let Some(shape) = &tensor.shape else {
        return wrong("an input without a shape".to_owned(), "a shape");
    };
    if shape.dim.len() > RANK_MAX {
        return wrong(
            format!("{} dimensions", shape.dim.len()),
            &format!("at most {RANK_MAX}"),
        );
    }
    let mut dims = vec![];
    for (i, dim) in shape.dim.iter().enumerate() {
        match dim.dim_value {
            Some(number) => match usize::try_from(number) {
                Ok(number) => dims.push(number),
                Err(_) => {
                    return wrong(
                        format!("dimension {i} of {number}"),
                        "dimensions of 1 or more",
                    );
                }
            },
            None if i == 0 => dims.push(1),
            None => {
                let found = format!(
                    "dimension {i} without a size (`{}`)",
                    shown(dim.dim_param())
                );
                return wrong(found, "a size for every dimension except the first");
            }
        }
    }
    Ok(dims)
}

fn constants(
    planner: &mut Planner,
    graph: &GraphProto,
    needed: &BTreeSet<&str>,
) -> Result<(), NetworkError> {
    let mut numbers = Some(0_usize);
    for proto in graph
        .initializer
        .iter()
        .filter(|proto| needed.contains(proto.name.as_str()))
    {
        let tensor = Tensor::read(proto, &proto.name)?;
        numbers = numbers.and_then(|all| all.checked_add(tensor.len()));
        at_most("numbers of the initializers", numbers, PARAMETERS_MAX)?;
        planner.define(&proto.name, Value::Constant(tensor))?;
    }
    Ok(())
}

fn add(
    planner: &mut Planner,
    proto: &NodeProto,
    version: i64,
    needed: &BTreeSet<&str>,
) -> Result<(), NetworkError> {
    let known = OPERATORS
        .iter()
        .find(|operator| operator.name == proto.op_type && is_own(&proto.domain));
    let Some(operator) = known else {
        let names: Vec<&str> = OPERATORS.iter().map(|operator| operator.name).collect();
        let of_domain = if is_own(&proto.domain) {
            String::new()
        } else {
            format!("{}.", shown(&proto.domain))
        };
        return Err(NetworkError::at(
            format!("node `{}`", node::name(proto)),
            format!("the operator {of_domain}{}", shown(&proto.op_type)),
            format!(
                "one of {}: export the model without this operator",
                names.join(", ")
            ),
        ));
    };
    let node = Node {
        proto,
        operator: operator.name,
        version,
    };
    node.check_attributes(operator.attributes)?;
    if !operator.inputs.contains(&proto.input.len()) {
        let least = operator.inputs.start();
        let most = operator.inputs.end();
        let expected = if least == most {
            least.to_string()
        } else {
            format!("{least} to {most}")
        };
        return Err(node.wrong(format!("{} inputs", proto.input.len()), expected));
    }
    let output = match proto.output.as_slice() {
        [output] => output,
        [output, spare @ ..] if WITH_SPARE_OUTPUTS.contains(&operator.name) => {
            if let Some(name) = spare.iter().find(|name| needed.contains(name.as_str())) {
                return Err(node.wrong(
                    format!("a use of the output `{}`", shown(name)),
                    "a use of the first output",
                ));
            }
            output
        }
        outputs => return Err(node.wrong(format!("{} outputs", outputs.len()), "one")),
    };
    let is_constant = planner.is_constant(&node);
    let steps = planner.steps.len();
    let values = planner.values.len();
    let value = match (operator.plan)(planner, &node)? {
        Value::Computed(row) if is_constant => planner.fold(steps, values, row)?,
        value => value,
    };
    planner.define(output, value)
}

/// The graph's outputs and their places.
fn outputs(
    planner: &mut Planner,
    graph: &GraphProto,
    warnings: &mut Vec<String>,
) -> Result<Vec<(Port, Range<usize>)>, NetworkError> {
    let mut names = BTreeSet::new();
    let mut outputs = vec![];
    for info in &graph.output {
        let Row {
            place,
            shape: found,
            element,
        } = planner.output(&info.name)?;
        warnings.extend(deviation(info, &found));
        if !names.insert(&info.name) {
            return Err(NetworkError::tensor(
                &info.name,
                "an output named twice",
                "each output once",
            ));
        }
        let is_integer = element == Element::Integer;
        outputs.push((
            Port {
                name: info.name.clone(),
                size: place.len(),
                is_integer,
            },
            place,
        ));
    }
    if outputs.is_empty() {
        return Err(NetworkError::model("no output", "at least one"));
    }
    Ok(outputs)
}

/// How the declared shape or type of an output deviates from the computed one. The deviation does
/// not affect evaluation.
fn deviation(info: &ValueInfoProto, found: &[usize]) -> Option<String> {
    let tensor = info.r#type.as_ref()?.tensor_type.as_ref()?;
    let name = shown(&info.name);
    // Indices are output as floats.
    if !proto::FLOATS.contains(&tensor.elem_type) && !proto::INTEGERS.contains(&tensor.elem_type) {
        let declared = data_type_name(tensor.elem_type.into());
        return Some(format!(
            "output `{name}`: declared as {declared}, computed as floats"
        ));
    }
    let dims = &tensor.shape.as_ref()?.dim;
    let fits = |(dim, found): (&DimensionProto, &usize)| {
        dim.dim_value
            .is_none_or(|value| usize::try_from(value) == Ok(*found))
    };
    if dims.len() == found.len() && dims.iter().zip(found).all(fits) {
        return None;
    }
    let dim = |dim: &DimensionProto| {
        dim.dim_value
            .map_or_else(|| shown(dim.dim_param()), |value| value.to_string())
    };
    let declared: Vec<String> = dims.iter().take(RANK_MAX).map(dim).collect();
    let declared = if dims.is_empty() {
        "a single number".to_owned()
    } else {
        declared.join(" x ")
    };
    Some(format!(
        "output `{name}`: declared as {declared}, computed as {}",
        shape_text(found)
    ))
}
