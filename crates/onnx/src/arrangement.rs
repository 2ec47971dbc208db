//! Operators that rearrange numbers, such as reshape, concatenate and slice.
//!
//! Reshaping is free: the output shares the input's place because the order stays the same.

use super::NetworkError;
use super::error::{shape_text, shown};
use super::limit::RANK_MAX;
use super::node::Node;
use super::plan::{Element, Planner, Row, Value};
use super::proto::{self, data_type_name};
use super::step::{Blocks, Step, Work};
use super::tensor::{Numbers, Tensor, product};

pub(super) fn constant(_: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let [attribute] = node.proto.attribute.as_slice() else {
        return Err(node.wrong(format!("{} attributes", node.proto.attribute.len()), "one"));
    };
    let output = node.proto.output.first().map_or("", String::as_str);
    let integers = |shape: Vec<usize>, integers: Vec<i64>| Tensor::new(shape, Numbers::Integers(integers));
    let tensor = match attribute.name.as_str() {
        "value_int" => integers(vec![], vec![node.integer("value_int", 0)?]),
        "value_ints" => {
            let numbers = node.integers("value_ints")?.unwrap_or_default();
            integers(vec![numbers.len()], numbers.to_vec())
        }
        "value_float" => Tensor::new(vec![], Numbers::Floats(vec![node.float("value_float", 0.0)?])),
        "value_floats" => {
            let numbers = node.floats("value_floats")?.unwrap_or_default();
            if numbers.iter().any(|number| !number.is_finite()) {
                return Err(node.wrong("a number that is NaN or infinite", "finite numbers"));
            }
            Tensor::new(vec![numbers.len()], Numbers::Floats(numbers.to_vec()))
        }
        _ => match node.tensor("value")?.and_then(|attribute| attribute.t.as_ref()) {
            Some(proto) => Tensor::read(proto, output)?,
            None => return Err(node.wrong("no tensor", "one")),
        },
    };
    Ok(Value::Constant(tensor))
}

/// Plans `Cast` to floats.
pub(super) fn cast(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let to = node.integer("to", 0)?;
    if to != i64::from(proto::FLOAT) {
        return Err(node.wrong(format!("a Cast to {}", data_type_name(to)), "a Cast to FLOAT"));
    }
    Ok(match planner.value(node, 0)? {
        Value::Computed(row) => Value::Computed(Row { element: Element::Float, ..row }),
        Value::Constant(tensor) => match &*tensor.numbers {
            Numbers::Floats(_) => Value::Constant(tensor),
            Numbers::Integers(integers) => {
                planner.count_weights(Some(integers.len()), 0)?;
                let floats = integers.iter().map(|integer| *integer as f32).collect();
                Value::Constant(Tensor::new(tensor.shape, Numbers::Floats(floats)))
            }
        },
    })
}

pub(super) fn flatten(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let shape = shape_of(&value);
    let axis = match node.integer("axis", 1)? {
        axis if usize::try_from(axis) == Ok(shape.len()) => shape.len(),
        axis => node.axis(axis, shape.len())?,
    };
    let sizes = [&shape[..axis], &shape[axis..]].map(|dims| product(dims).unwrap_or(0));
    reshaped(node, value, sizes.to_vec())
}

pub(super) fn reshape(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let asked = planner.integers(node, 1)?.unwrap_or_default();
    let copies_at_zero = node.integer("allowzero", 0)? == 0;
    let before = shape_of(&value);
    let wrong = || {
        let text: Vec<String> = asked.iter().map(i64::to_string).collect();
        node.wrong(format!("{} reshaped to ({})", shape_text(before), text.join(", ")), "a shape of the same size")
    };
    let mut shape = vec![];
    let mut left_out = None;
    for (i, dim) in asked.iter().enumerate() {
        shape.push(match dim {
            0 if copies_at_zero => *before.get(i).ok_or_else(wrong)?,
            -1 if left_out.is_none() => {
                left_out = Some(i);
                1
            }
            dim => usize::try_from(*dim).map_err(|_| wrong())?,
        });
    }
    if let Some(i) = left_out {
        let others = product(&shape).filter(|others| *others > 0).ok_or_else(wrong)?;
        shape[i] = product(before).unwrap_or(0) / others;
    }
    if product(&shape) != product(before) {
        return Err(wrong());
    }
    reshaped(node, value, shape)
}

/// Plans `Squeeze`, which removes dimensions of 1.
pub(super) fn squeeze(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let shape = shape_of(&value);
    let mut keeps: Vec<bool> = shape.iter().map(|_| true).collect();
    match axes(planner, node)? {
        Some(axes) => {
            for axis in axes {
                keeps[node.axis(axis, shape.len())?] = false;
            }
        }
        None => keeps = shape.iter().map(|dim| *dim != 1).collect(),
    }
    let is_left_out = |(dim, keeps): (&usize, &bool)| !keeps && *dim != 1;
    if shape.iter().zip(&keeps).any(is_left_out) {
        return Err(node.wrong(format!("axes of {} that are not 1", shape_text(shape)), "axes of 1"));
    }
    let shape = shape.iter().zip(keeps).filter(|(_, keeps)| *keeps).map(|(dim, _)| *dim).collect();
    reshaped(node, value, shape)
}

/// Plans `Unsqueeze`, which inserts dimensions of 1.
pub(super) fn unsqueeze(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let Some(axes) = axes(planner, node)? else { return Err(node.wrong("no axes", "axes")) };
    let rank = shape_of(&value).len() + axes.len();
    let mut is_new = vec![false; rank];
    for axis in axes {
        let axis = node.axis(axis, rank)?;
        if std::mem::replace(&mut is_new[axis], true) {
            return Err(node.wrong(format!("axis {axis} twice"), "each axis once"));
        }
    }
    let mut old = shape_of(&value).iter().copied();
    let shape = is_new.iter().map(|is_new| if *is_new { 1 } else { old.next().unwrap_or(1) }).collect();
    reshaped(node, value, shape)
}

pub(super) fn concat(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let rows = (0..node.proto.input.len()).map(|i| planner.row(node, i)).collect::<Result<Vec<Row>, _>>()?;
    let mut shape = rows[0].shape.clone();
    if !node.has("axis") {
        return Err(node.wrong("no axis", "an axis"));
    }
    let axis = node.axis(node.integer("axis", 0)?, shape.len())?;
    let mut sum = Some(0_usize);
    for row in &rows {
        let same = |(i, dim): (usize, &usize)| i == axis || *dim == shape[i];
        if row.shape.len() != shape.len() || !row.shape.iter().enumerate().all(same) {
            let found = format!("{} next to {}", shape_text(&row.shape), shape_text(&shape));
            return Err(node.wrong(found, format!("shapes that differ only in axis {axis}")));
        }
        sum = sum.and_then(|sum| sum.checked_add(row.shape[axis]));
    }
    shape[axis] = sum.unwrap_or(usize::MAX);
    let output = planner.new_row(shape)?;
    let count = product(&output.shape[..axis]).unwrap_or(0);
    let whole = product(&output.shape[axis..]).unwrap_or(0);
    let mut at = 0;
    for row in rows {
        let size = row.place.len() / count;
        let blocks = Blocks { count, size, from: (0, size), to: (at, whole) };
        planner.steps.push(Step { work: Work::Copy(blocks), input: row.place, output: output.place.clone() });
        at += size;
    }
    Ok(Value::Computed(output))
}

/// Plans `Slice`, one axis after the other.
pub(super) fn slice(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let mut row = planner.row(node, 0)?;
    let (starts, ends) = (integers(planner, node, 1, "starts")?, integers(planner, node, 2, "ends")?);
    let axes = integers(planner, node, 3, "axes")?;
    let (Some(starts), Some(ends)) = (starts, ends) else { return Err(node.wrong("no bounds", "starts and ends")) };
    let axes = axes.unwrap_or_else(|| (0..).take(starts.len()).collect());
    let steps = planner.integers(node, 4)?.unwrap_or_else(|| vec![1; starts.len()]);
    if starts.len() > RANK_MAX || [ends.len(), axes.len(), steps.len()].iter().any(|length| *length != starts.len()) {
        let found =
            format!("{} starts, {} ends, {} axes and {} steps", starts.len(), ends.len(), axes.len(), steps.len());
        return Err(node.wrong(found, "the same number of each, one per axis"));
    }
    for (i, axis) in axes.iter().enumerate() {
        let axis = node.axis(*axis, row.shape.len())?;
        row = slice_axis(planner, node, row, axis, (starts[i], ends[i], steps[i]))?;
    }
    Ok(Value::Computed(row))
}

/// Selects every `step`-th element of an axis from `start` to `end`.
fn slice_axis(
    planner: &mut Planner,
    node: &Node,
    input: Row,
    axis: usize,
    (start, end, step): (i64, i64, i64),
) -> Result<Row, NetworkError> {
    let length = input.shape[axis];
    let clamped = |index: i64| {
        let from_start = if index < 0 { index.saturating_add_unsigned(length as u64) } else { index };
        usize::try_from(from_start.max(0)).unwrap_or(usize::MAX).min(length)
    };
    let (from, to) = (clamped(start), clamped(end));
    if to <= from {
        let found = format!("the empty range {start} to {end} of axis {axis} of {}", shape_text(&input.shape));
        return Err(node.wrong(found, "at least one number"));
    }
    let outer = product(&input.shape[..axis]).unwrap_or(0);
    let inner = product(&input.shape[axis + 1..]).unwrap_or(0);
    let Some(step) = usize::try_from(step).ok().filter(|step| *step == 1 || *step > 1 && outer == 1) else {
        return Err(node.wrong(format!("step {step} of axis {axis}"), "1, or more on the first axis after the batch"));
    };
    let count = (to - from).div_ceil(step);
    let mut shape = input.shape;
    shape[axis] = count;
    let blocks = if step == 1 {
        let size = count * inner;
        Blocks { count: outer, size, from: (from * inner, length * inner), to: (0, size) }
    } else {
        Blocks { count, size: inner, from: (from * inner, step.min(length) * inner), to: (0, inner) }
    };
    planner.add(Work::Copy(blocks), input.place, shape)
}

/// Integers that are an attribute in old files and an input in newer ones.
fn integers(planner: &Planner, node: &Node, input: usize, name: &str) -> Result<Option<Vec<i64>>, NetworkError> {
    Ok(match planner.integers(node, input)? {
        Some(integers) => Some(integers),
        None => node.integers(name)?.map(<[i64]>::to_vec),
    })
}

/// The axes of a `Squeeze` or `Unsqueeze`.
fn axes(planner: &Planner, node: &Node) -> Result<Option<Vec<i64>>, NetworkError> {
    match integers(planner, node, 1, "axes")? {
        Some(axes) if axes.len() > RANK_MAX => {
            Err(node.wrong(format!("{} axes", axes.len()), format!("at most {RANK_MAX}")))
        }
        axes => Ok(axes),
    }
}

fn shape_of(value: &Value) -> &[usize] {
    match value {
        Value::Constant(tensor) => &tensor.shape,
        Value::Computed(row) => &row.shape,
    }
}

/// The same numbers in another shape of the same size.
fn reshaped(node: &Node, value: Value, shape: Vec<usize>) -> Result<Value, NetworkError> {
    if shape.len() > RANK_MAX {
        let (output, found) = (node.proto.output.first(), format!("{} dimensions", shape.len()));
        let name = shown(output.map_or("", String::as_str));
        return Err(node.wrong(format!("{found} of `{name}`"), format!("at most {RANK_MAX}")));
    }
    Ok(match value {
        Value::Constant(tensor) => Value::Constant(Tensor { shape, ..tensor }),
        Value::Computed(row) => Value::Computed(Row { shape, ..row }),
    })
}
