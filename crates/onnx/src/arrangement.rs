//! Operators that rearrange numbers, such as reshape, concatenate and slice.
//!
//! Reshaping is free: the order stays the same, so the output shares the input's memory.

use super::NetworkError;
use super::elementwise::{self, Function};
use super::error::{shape_text, shown};
use super::limit::{PARAMETERS_MAX, RANK_MAX, VALUES_MAX, at_most};
use super::node::{Node, from_start};
use super::plan::{Element, Planner, Row, Value};
use super::proto::{self, data_type_name};
use super::step::{Step, Work};
use super::tensor::{Numbers, Tensor, product};

pub(super) fn constant(_: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let [attribute] = node.proto.attribute.as_slice() else {
        return Err(node.wrong(format!("{} attributes", node.proto.attribute.len()), "one"));
    };
    let output = node.proto.output.first().map_or("", String::as_str);
    let integers =
        |shape: Vec<usize>, integers: Vec<i64>| Tensor::new(shape, Numbers::Integers(integers));
    let tensor = match attribute.name.as_str() {
        "value_int" => integers(vec![], vec![node.integer("value_int", 0)?]),
        "value_ints" => {
            let numbers = node.integers("value_ints")?.unwrap_or_default();
            integers(vec![numbers.len()], numbers.to_vec())
        }
        "value_float" => Tensor::new(
            vec![],
            Numbers::Floats(vec![node.float("value_float", 0.0)?]),
        ),
        "value_floats" => {
            let numbers = node.floats("value_floats")?.unwrap_or_default();
            if numbers.iter().any(|number| !number.is_finite()) {
                return Err(node.wrong("a number that is NaN or infinite", "finite numbers"));
            }
            Tensor::new(vec![numbers.len()], Numbers::Floats(numbers.to_vec()))
        }
        _ => match node
            .tensor("value")?
            .and_then(|attribute| attribute.t.as_ref())
        {
            Some(proto) => Tensor::read(proto, output)?,
            None => return Err(node.wrong("no tensor", "one")),
        },
    };
    Ok(Value::Constant(tensor))
}

/// Plans `Cast` between floats, all evaluated in single precision, and integers.
pub(super) fn cast(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let to = node.integer("to", 0)?;
    let is_among = |types: &[i32]| types.iter().any(|each| i64::from(*each) == to);
    let element = if is_among(&proto::FLOATS) {
        Element::Float
    } else if is_among(&proto::INTEGERS) {
        Element::Integer
    } else {
        return Err(node.wrong(
            format!(
                "a Cast to {}",
                data_type_name(to).trim_end_matches(" numbers")
            ),
            "a Cast to FLOAT or INT64",
        ));
    };
    Ok(match planner.value(node, 0)? {
        Value::Computed(row) if row.element == Element::Float && element == Element::Integer => {
            let row = elementwise::apply(planner, Function::Truncate, row)?;
            Value::Computed(Row { element, ..row })
        }
        Value::Computed(row) => Value::Computed(Row { element, ..row }),
        Value::Constant(tensor) => {
            let numbers = match (&*tensor.numbers, element) {
                (Numbers::Floats(floats), Element::Integer) => {
                    Numbers::Integers(floats.iter().map(|float| *float as i64).collect())
                }
                (Numbers::Integers(integers), Element::Float) => {
                    Numbers::Floats(integers.iter().map(|integer| *integer as f32).collect())
                }
                _ => return Ok(Value::Constant(tensor)),
            };
            planner.count_weights(Some(tensor.len()), 0)?;
            Value::Constant(Tensor::new(tensor.shape, numbers))
        }
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
        node.wrong(
            format!("{} reshaped to ({})", shape_text(before), text.join(", ")),
            "a shape of the same size",
        )
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
        let others = product(&shape)
            .filter(|others| *others > 0)
            .ok_or_else(wrong)?;
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
        return Err(node.wrong(
            format!("axes of {} that are not 1", shape_text(shape)),
            "axes of length 1",
        ));
    }
    let shape = shape
        .iter()
        .zip(keeps)
        .filter(|(_, keeps)| *keeps)
        .map(|(dim, _)| *dim)
        .collect();
    reshaped(node, value, shape)
}

/// Plans `Unsqueeze`, which inserts dimensions of 1.
pub(super) fn unsqueeze(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let Some(axes) = axes(planner, node)? else {
        return Err(node.wrong("no axes", "axes"));
    };
    let rank = shape_of(&value).len() + axes.len();
    let mut is_new = vec![false; rank];
    for axis in axes {
        let axis = node.axis(axis, rank)?;
        if std::mem::replace(&mut is_new[axis], true) {
            return Err(node.wrong(format!("axis {axis} twice"), "each axis once"));
        }
    }
    let mut old = shape_of(&value).iter().copied();
    let shape = is_new
        .iter()
        .map(|is_new| if *is_new { 1 } else { old.next().unwrap_or(1) })
        .collect();
    reshaped(node, value, shape)
}

pub(super) fn concat(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    if let Some(joined) = joined_integers(planner, node)? {
        return Ok(Value::Constant(joined));
    }
    let rows = (0..node.proto.input.len())
        .map(|i| planner.row(node, i))
        .collect::<Result<Vec<Row>, _>>()?;
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
        let work = Work::Spread {
            size,
            offset: at,
            distance: whole,
        };
        planner.steps.push(Step {
            work,
            input: row.place,
            output: output.place.clone(),
        });
        at += size;
    }
    Ok(Value::Computed(output))
}

/// All inputs of a node, which must be lists of constant integers, joined into one list: a shape.
fn joined_integers(planner: &mut Planner, node: &Node) -> Result<Option<Tensor>, NetworkError> {
    let mut joined = vec![];
    for index in 0..node.proto.input.len() {
        let Value::Constant(tensor) = planner.value(node, index)? else {
            return Ok(None);
        };
        match &*tensor.numbers {
            Numbers::Integers(integers) if tensor.shape.len() == 1 => {
                joined.extend_from_slice(integers)
            }
            _ => return Ok(None),
        }
        at_most("numbers of a constant", Some(joined.len()), PARAMETERS_MAX)?;
    }
    planner.count_weights(Some(joined.len()), 0)?;
    Ok(Some(Tensor::new(
        vec![joined.len()],
        Numbers::Integers(joined),
    )))
}

/// Plans `Slice`, one axis after the other.
pub(super) fn slice(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let mut value = planner.value(node, 0)?;
    let starts = integers(planner, node, 1, "starts")?;
    let ends = integers(planner, node, 2, "ends")?;
    let axes = integers(planner, node, 3, "axes")?;
    let (Some(starts), Some(ends)) = (starts, ends) else {
        return Err(node.wrong("no bounds", "starts and ends"));
    };
    let axes = axes.unwrap_or_else(|| (0..).take(starts.len()).collect());
    let steps = planner
        .integers(node, 4)?
        .unwrap_or_else(|| vec![1; starts.len()]);
    if starts.len() > RANK_MAX
        || [ends.len(), axes.len(), steps.len()]
            .iter()
            .any(|length| *length != starts.len())
    {
        let found = format!(
            "{} starts, {} ends, {} axes and {} steps",
            starts.len(),
            ends.len(),
            axes.len(),
            steps.len()
        );
        return Err(node.wrong(found, "the same number of each, one per axis"));
    }
    for (i, axis) in axes.iter().enumerate() {
        let axis = node.axis(*axis, shape_of(&value).len())?;
        value = slice_axis(planner, node, value, axis, (starts[i], ends[i], steps[i]))?;
    }
    Ok(value)
}

/// Selects every `step`-th element of an axis from `start` to `end`; backwards if `step` is
/// negative.
fn slice_axis(
    planner: &mut Planner,
    node: &Node,
    value: Value,
    axis: usize,
    (start, end, step): (i64, i64, i64),
) -> Result<Value, NetworkError> {
    let shape = shape_of(&value).to_vec();
    let length = shape[axis] as i64;
    let start_at = from_start(start, shape[axis]);
    let end_at = from_start(end, shape[axis]);
    let selected: Vec<usize> = match step {
        0 => return Err(node.wrong("step 0", "a step other than 0")),
        1.. => {
            let range = start_at.clamp(0, length)..end_at.clamp(0, length);
            range
                .step_by(usize::try_from(step).unwrap_or(usize::MAX))
                .map(|i| i as usize)
                .collect()
        }
        _ => {
            let range = end_at.clamp(-1, length - 1) + 1..=start_at.clamp(-1, length - 1);
            let size = usize::try_from(step.unsigned_abs()).unwrap_or(usize::MAX);
            range.rev().step_by(size).map(|i| i as usize).collect()
        }
    };
    if selected.is_empty() {
        let found = format!(
            "the empty range {start} to {end} of axis {axis} of {}",
            shape_text(&shape)
        );
        return Err(node.wrong(found, "at least one number"));
    }
    select(planner, value, axis, &selected, &[selected.len()])
}

/// Plans `Gather` with constant indices.
pub(super) fn gather(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let shape = shape_of(&value);
    let axis = node.axis(node.integer("axis", 0)?, shape.len())?;
    let indices = planner.constant(node, 1)?;
    let Numbers::Integers(integers) = &*indices.numbers else {
        return Err(node.wrong("floats as input 1", "INT64 numbers"));
    };
    let length = shape[axis];
    let index = |index: &i64| match usize::try_from(from_start(*index, length)) {
        Ok(at) if at < length => Ok(at),
        _ => Err(node.wrong(
            format!("index {index}"),
            format!("an index into {length} numbers"),
        )),
    };
    let selected = integers
        .iter()
        .map(index)
        .collect::<Result<Vec<usize>, _>>()?;
    select(planner, value, axis, &selected, &indices.shape)
}

/// Selects these elements of an axis, which becomes the dimensions `dims`.
fn select(
    planner: &mut Planner,
    value: Value,
    axis: usize,
    selected: &[usize],
    dims: &[usize],
) -> Result<Value, NetworkError> {
    let before = shape_of(&value);
    let outer = product(&before[..axis]).unwrap_or(0);
    let inner = product(&before[axis + 1..]).unwrap_or(0);
    let length = before[axis];
    let shape = [&before[..axis], dims, &before[axis + 1..]].concat();
    rearranged(planner, value, shape, || {
        let rows =
            (0..outer).flat_map(|row| selected.iter().map(move |index| row * length + index));
        rows.flat_map(|row| (0..inner).map(move |i| (row * inner + i) as u32))
            .collect()
    })
}

pub(super) fn transpose(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let rank = shape_of(&value).len();
    let order = match node.integers("perm")? {
        Some(axes) => axes
            .iter()
            .map(|axis| node.axis(*axis, rank))
            .collect::<Result<Vec<usize>, _>>()?,
        None => (0..rank).rev().collect(),
    };
    let mut sorted = order.clone();
    sorted.sort_unstable();
    if !sorted.into_iter().eq(0..rank) {
        let found = shown(&format!("{order:?}"));
        return Err(node.wrong(
            format!("perm = {found}"),
            format!("each of {rank} axes once"),
        ));
    }
    let (shape, strides) = permuted(shape_of(&value), &order);
    rearranged(planner, value, shape.clone(), || strided(&shape, &strides))
}

/// The row with its axes in a different order.
pub(super) fn transposed_row(
    planner: &mut Planner,
    row: Row,
    order: &[usize],
) -> Result<Row, NetworkError> {
    let (shape, strides) = permuted(&row.shape, order);
    picked(planner, row, shape.clone(), || strided(&shape, &strides))
}

/// The dimensions and strides of a shape with its axes in a different order.
fn permuted(before: &[usize], order: &[usize]) -> (Vec<usize>, Vec<usize>) {
    let strides = strides(before);
    order
        .iter()
        .map(|axis| (before[*axis], strides[*axis]))
        .unzip()
}

/// Plans `Expand` to a constant shape.
pub(super) fn expand(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let (asked, dims) = asked_shape(planner, node, 1)?;
    let shape = dims.and_then(|dims| elementwise::broadcast(shape_of(&value), &dims));
    let Some(shape) = shape.filter(|shape| shape.len() <= RANK_MAX) else {
        let found = format!("{} expanded to {asked:?}", shape_text(shape_of(&value)));
        return Err(node.wrong(found, "dimensions that are equal or 1"));
    };
    let before = shape_of(&value).to_vec();
    rearranged(planner, value, shape.clone(), || repeated(&before, &shape))
}

/// The row, repeated to a shape along its dimensions of 1.
pub(super) fn expanded_row(
    planner: &mut Planner,
    row: Row,
    shape: &[usize],
) -> Result<Row, NetworkError> {
    let before = row.shape.clone();
    picked(planner, row, shape.to_vec(), || repeated(&before, shape))
}

/// The indices of a shape's numbers, repeated to a new shape along its dimensions of 1 and along
/// new leading ones.
pub(super) fn repeated(before: &[usize], shape: &[usize]) -> Vec<u32> {
    let own = strides(before)
        .into_iter()
        .zip(before)
        .map(|(stride, dim)| if *dim == 1 { 0 } else { stride });
    let strides: Vec<usize> = vec![0; shape.len() - before.len()]
        .into_iter()
        .chain(own)
        .collect();
    strided(shape, &strides)
}

/// The shape in input `index` of a node: as given, and its dimensions if none is negative.
fn asked_shape(
    planner: &Planner,
    node: &Node,
    index: usize,
) -> Result<(Vec<i64>, Option<Vec<usize>>), NetworkError> {
    let asked = planner.integers(node, index)?.unwrap_or_default();
    let dims = asked.iter().map(|dim| usize::try_from(*dim).ok()).collect();
    Ok((asked, dims))
}

/// Plans `Shape`: the dimensions of its input, all of which are constant.
pub(super) fn shape(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let value = planner.value(node, 0)?;
    let dims: Vec<i64> = shape_of(&value).iter().map(|dim| *dim as i64).collect();
    let rank = dims.len();
    let at = |index: i64| from_start(index, rank).clamp(0, rank as i64) as usize;
    let start = at(node.integer("start", 0)?);
    let end = at(node.integer("end", rank as i64)?);
    let dims = dims.get(start..end).unwrap_or_default().to_vec();
    Ok(Value::Constant(Tensor::new(
        vec![dims.len()],
        Numbers::Integers(dims),
    )))
}

/// Plans `ConstantOfShape`.
pub(super) fn constant_of_shape(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let (_, dims) = asked_shape(planner, node, 0)?;
    let size = dims.as_deref().and_then(product);
    let size = at_most("numbers of a constant", size, VALUES_MAX)?;
    planner.count_weights(Some(size), 0)?;
    let value = match node
        .tensor("value")?
        .and_then(|attribute| attribute.t.as_ref())
    {
        Some(proto) => Some(Tensor::read(proto, "value")?),
        None => None,
    };
    let numbers = match value.as_ref().map(|tensor| &*tensor.numbers) {
        None => Numbers::Floats(vec![0.0; size]),
        Some(Numbers::Floats(floats)) if floats.len() == 1 => {
            Numbers::Floats(vec![floats[0]; size])
        }
        Some(Numbers::Integers(integers)) if integers.len() == 1 => {
            Numbers::Integers(vec![integers[0]; size])
        }
        Some(_) => return Err(node.wrong("several values", "a single number")),
    };
    Ok(Value::Constant(Tensor::new(
        dims.unwrap_or_default(),
        numbers,
    )))
}

/// The distance between neighbours along each dimension.
fn strides(shape: &[usize]) -> Vec<usize> {
    (0..shape.len())
        .map(|axis| product(&shape[axis + 1..]).unwrap_or(0))
        .collect()
}

/// The indices of a shape's numbers, in order, if each dimension has this stride.
fn strided(shape: &[usize], strides: &[usize]) -> Vec<u32> {
    let mut indices = vec![0_u32];
    for (dim, stride) in shape.iter().zip(strides) {
        let along = |base: &u32| {
            let base = *base;
            (0..*dim).map(move |i| base + (i * stride) as u32)
        };
        indices = indices.iter().flat_map(along).collect();
    }
    indices
}

/// The numbers at these indices of a value, in a new shape. `from` is called once the shape is
/// known to be small enough.
fn rearranged(
    planner: &mut Planner,
    value: Value,
    shape: Vec<usize>,
    from: impl FnOnce() -> Vec<u32>,
) -> Result<Value, NetworkError> {
    if shape.len() > RANK_MAX {
        let found = format!("{} dimensions", shape.len());
        return Err(NetworkError::at(
            "a value of the model",
            found,
            format!("at most {RANK_MAX}"),
        ));
    }
    match value {
        Value::Constant(_) if product(&shape) == Some(0) => Err(NetworkError::at(
            "a constant of the model",
            "no numbers",
            "at least one",
        )),
        Value::Constant(tensor) => {
            planner.count_weights(product(&shape), 0)?;
            let from = from();
            let numbers = match &*tensor.numbers {
                Numbers::Floats(floats) => {
                    Numbers::Floats(from.iter().map(|i| floats[*i as usize]).collect())
                }
                Numbers::Integers(integers) => {
                    Numbers::Integers(from.iter().map(|i| integers[*i as usize]).collect())
                }
            };
            Ok(Value::Constant(Tensor::new(shape, numbers)))
        }
        Value::Computed(row) => Ok(Value::Computed(picked(planner, row, shape, from)?)),
    }
}

/// Like [`rearranged`], for computed numbers.
fn picked(
    planner: &mut Planner,
    row: Row,
    shape: Vec<usize>,
    from: impl FnOnce() -> Vec<u32>,
) -> Result<Row, NetworkError> {
    // The shape is checked first, because `from` has the same length.
    let output = Row {
        element: row.element,
        ..planner.new_row(shape)?
    };
    planner.steps.push(Step {
        work: Work::Pick(from()),
        input: row.place,
        output: output.place.clone(),
    });
    Ok(output)
}

/// Integers given as an attribute in old files and as an input in newer ones.
fn integers(
    planner: &Planner,
    node: &Node,
    input: usize,
    name: &str,
) -> Result<Option<Vec<i64>>, NetworkError> {
    Ok(match planner.integers(node, input)? {
        Some(integers) => Some(integers),
        None => node.integers(name)?.map(<[i64]>::to_vec),
    })
}

/// The axes of a `Squeeze`, `Unsqueeze` or `Reduce…`.
pub(super) fn axes(planner: &Planner, node: &Node) -> Result<Option<Vec<i64>>, NetworkError> {
    match integers(planner, node, 1, "axes")? {
        Some(axes) if axes.len() > RANK_MAX => Err(node.wrong(
            format!("{} axes", axes.len()),
            format!("at most {RANK_MAX}"),
        )),
        axes => Ok(axes),
    }
}

pub(super) fn shape_of(value: &Value) -> &[usize] {
    match value {
        Value::Constant(tensor) => &tensor.shape,
        Value::Computed(row) => &row.shape,
    }
}

/// The same numbers in a different shape of the same size.
fn reshaped(node: &Node, value: Value, shape: Vec<usize>) -> Result<Value, NetworkError> {
    if shape.len() > RANK_MAX {
        let output = node.proto.output.first();
        let found = format!("{} dimensions", shape.len());
        let name = shown(output.map_or("", String::as_str));
        return Err(node.wrong(
            format!("{found} of `{name}`"),
            format!("at most {RANK_MAX}"),
        ));
    }
    Ok(match value {
        Value::Constant(tensor) => Value::Constant(Tensor { shape, ..tensor }),
        Value::Computed(row) => Value::Computed(Row { shape, ..row }),
    })
}
