//! The plan of a network: the place of every number, and the steps that compute them.

use super::NetworkError;
use super::Port;
use super::error::{shape_text, shown};
use super::limit::{PARAMETERS_MAX, PRODUCTS_MAX, RANK_MAX, VALUES_MAX, at_most};
use super::node::Node;
use super::step::{Step, Work};
use super::tensor::{Numbers, Tensor, product};
use std::collections::BTreeMap;
use std::ops::Range;

/// The constant part of a network.
pub(super) struct Plan {
    pub(super) inputs: Vec<Port>,
    pub(super) outputs: Vec<Port>,
    pub(super) input_size: usize,
    pub(super) places: Vec<Range<usize>>,
    pub(super) steps: Vec<Step>,
    pub(super) metadata: BTreeMap<String, String>,
    pub(super) warnings: Vec<String>,
    pub(super) digest: u128,
}

/// The largest integer up to which all integers are exact as floats.
const INTEGER_MAX: u64 = 1 << 24;

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Element {
    Float,
    /// An integer of up to 24 bits stored as a float: an index.
    Integer,
}

/// Computed numbers, with their place among all values.
#[derive(Clone)]
pub(super) struct Row {
    pub(super) place: Range<usize>,
    pub(super) shape: Vec<usize>,
    pub(super) element: Element,
}

/// The value of a name in a graph.
#[derive(Clone)]
pub(super) enum Value {
    Constant(Tensor),
    Computed(Row),
}

impl Value {
    pub(super) fn is_integer(&self) -> bool {
        match self {
            Value::Constant(tensor) => matches!(&*tensor.numbers, Numbers::Integers(_)),
            Value::Computed(row) => row.element == Element::Integer,
        }
    }
}

/// A plan under construction.
#[derive(Default)]
pub(super) struct Planner {
    known: BTreeMap<String, Value>,
    /// The locations of constants that steps read like computed numbers.
    placed: BTreeMap<String, Range<usize>>,
    pub(super) values: Vec<f32>,
    pub(super) steps: Vec<Step>,
    parameters: usize,
    products: usize,
}

impl Planner {
    /// Assigns a value to a name that has none yet.
    pub(super) fn define(&mut self, name: &str, value: Value) -> Result<(), NetworkError> {
        if self.known.contains_key(name) {
            return Err(NetworkError::tensor(
                name,
                "a second definition",
                "each name defined once",
            ));
        }
        self.known.insert(name.to_owned(), value);
        Ok(())
    }

    pub(super) fn value(&self, node: &Node, index: usize) -> Result<Value, NetworkError> {
        let Some(name) = node.input(index) else {
            return Err(node.wrong(format!("no input {index}"), "an input"));
        };
        let value = self.known.get(name).cloned();
        // Valid files list nodes after those whose outputs they use, so this also rejects cycles.
        let expected = "an input of the graph, an initializer, or the output of an earlier node";
        value.ok_or_else(|| node.wrong(format!("the undefined input `{}`", shown(name)), expected))
    }

    /// Input `index` of a node as floats that steps can read.
    pub(super) fn row(&mut self, node: &Node, index: usize) -> Result<Row, NetworkError> {
        let tensor = match self.value(node, index)? {
            Value::Computed(Row {
                element: Element::Integer,
                ..
            }) => {
                return Err(node.wrong(
                    format!("integers as input {index}"),
                    "FLOAT numbers; add a Cast before the node",
                ));
            }
            Value::Computed(row) => return Ok(row),
            Value::Constant(tensor) => tensor,
        };
        let place = self.place(
            node.input(index).unwrap_or_default(),
            floats(node, index, &tensor)?,
        )?;
        Ok(Row {
            place,
            shape: tensor.shape,
            element: Element::Float,
        })
    }

    /// Input `index` of a node as numbers of this kind.
    pub(super) fn row_of(
        &mut self,
        node: &Node,
        index: usize,
        element: Element,
    ) -> Result<Row, NetworkError> {
        if element == Element::Float {
            return self.row(node, index);
        }
        let tensor = match self.value(node, index)? {
            Value::Computed(row) => return Ok(row),
            Value::Constant(tensor) => tensor,
        };
        let Numbers::Integers(integers) = &*tensor.numbers else {
            return Err(node.wrong(format!("floats as input {index}"), "INT64 numbers"));
        };
        if let Some(large) = integers
            .iter()
            .find(|integer| integer.unsigned_abs() > INTEGER_MAX)
        {
            return Err(node.wrong(
                format!("the integer {large}"),
                format!("a magnitude of at most {INTEGER_MAX}"),
            ));
        }
        let floats: Vec<f32> = integers.iter().map(|integer| *integer as f32).collect();
        let row = self.new_constant(tensor.shape, &floats)?;
        Ok(Row { element, ..row })
    }

    /// The place of this constant among the values.
    pub(super) fn place(
        &mut self,
        name: &str,
        floats: &[f32],
    ) -> Result<Range<usize>, NetworkError> {
        if let Some(place) = self.placed.get(name) {
            return Ok(place.clone());
        }
        let Row { place, .. } = self.new_constant(vec![], floats)?;
        self.placed.insert(name.to_owned(), place.clone());
        Ok(place)
    }

    /// Input `index` of a node, which must be constant.
    pub(super) fn constant(&self, node: &Node, index: usize) -> Result<Tensor, NetworkError> {
        match self.value(node, index)? {
            Value::Constant(tensor) => Ok(tensor),
            Value::Computed(_) => Err(node.wrong(
                format!("a computed input {index}"),
                "a constant (initializer)",
            )),
        }
    }

    /// Input `index` of a node as constant integers, if any.
    pub(super) fn integers(
        &self,
        node: &Node,
        index: usize,
    ) -> Result<Option<Vec<i64>>, NetworkError> {
        if node.input(index).is_none() {
            return Ok(None);
        }
        match &*self.constant(node, index)?.numbers {
            Numbers::Integers(integers) if integers.len() <= RANK_MAX => Ok(Some(integers.clone())),
            Numbers::Integers(integers) => {
                let found = format!("{} integers as input {index}", integers.len());
                Err(node.wrong(found, format!("at most {RANK_MAX}")))
            }
            Numbers::Floats(_) => {
                Err(node.wrong(format!("floats as input {index}"), "INT64 numbers"))
            }
        }
    }

    /// A new constant that steps can read.
    pub(super) fn new_constant(
        &mut self,
        shape: Vec<usize>,
        floats: &[f32],
    ) -> Result<Row, NetworkError> {
        let place = self.room(Some(floats.len()))?;
        self.values[place.clone()].copy_from_slice(floats);
        Ok(Row {
            place,
            shape,
            element: Element::Float,
        })
    }

    /// Evaluates the steps from number `first` on, which read only constants, and removes them and
    /// their values from the plan. Returns the result as a constant.
    pub(super) fn fold(
        &mut self,
        first: usize,
        values: usize,
        row: Row,
    ) -> Result<Value, NetworkError> {
        for step in self.steps.drain(first..) {
            step.take(&mut self.values);
        }
        let floats = self.values[row.place].to_vec();
        if floats.iter().any(|float| float.is_nan()) {
            return Err(NetworkError::at(
                "a constant of the model",
                "NaN",
                "numbers",
            ));
        }
        self.values.truncate(values);
        self.placed.retain(|_, place| place.end <= values);
        self.count_weights(Some(floats.len()), 0)?;
        let numbers = match row.element {
            Element::Float => Numbers::Floats(floats),
            Element::Integer => {
                Numbers::Integers(floats.into_iter().map(|float| float as i64).collect())
            }
        };
        Ok(Value::Constant(Tensor::new(row.shape, numbers)))
    }

    /// Whether all inputs of a node are constants.
    pub(super) fn is_constant(&self, node: &Node) -> bool {
        let mut names = node
            .proto
            .input
            .iter()
            .filter(|name| !name.is_empty())
            .peekable();
        names.peek().is_some()
            && names.all(|name| matches!(self.known.get(name), Some(Value::Constant(_))))
    }

    /// Input `index` of a node as a bound: a single constant number, possibly infinite, if any.
    pub(super) fn bound(&self, node: &Node, index: usize) -> Result<Option<f32>, NetworkError> {
        if node.input(index).is_none() {
            return Ok(None);
        }
        let tensor = self.constant(node, index)?;
        match numbers(node, index, &tensor)? {
            [number] => Ok(Some(*number)),
            several => Err(node.wrong(
                format!("{} numbers as input {index}", several.len()),
                "a single number",
            )),
        }
    }

    /// Reserves a place for a node's output.
    pub(super) fn new_row(&mut self, shape: Vec<usize>) -> Result<Row, NetworkError> {
        let place = self.room(product(&shape))?;
        Ok(Row {
            place,
            shape,
            element: Element::Float,
        })
    }

    /// Adds a step with an output of this shape. Returns the output.
    pub(super) fn add(
        &mut self,
        work: Work,
        input: Range<usize>,
        shape: Vec<usize>,
    ) -> Result<Row, NetworkError> {
        let output = self.new_row(shape)?;
        self.steps.push(Step {
            work,
            input,
            output: output.place.clone(),
        });
        Ok(output)
    }

    fn room(&mut self, size: Option<usize>) -> Result<Range<usize>, NetworkError> {
        if size == Some(0) {
            return Err(NetworkError::at(
                "a value of the model",
                "no numbers",
                "at least one",
            ));
        }
        let start = self.values.len();
        let end = size.and_then(|size| start.checked_add(size));
        let end = at_most("numbers in an evaluation", end, VALUES_MAX)?;
        self.values.resize(end, 0.0);
        Ok(start..end)
    }

    /// Counts weights, each of which is multiplied by `rows` numbers in an evaluation.
    pub(super) fn count_weights(
        &mut self,
        weights: Option<usize>,
        rows: usize,
    ) -> Result<(), NetworkError> {
        let parameters = weights.and_then(|weights| weights.checked_add(self.parameters));
        self.parameters = at_most("weights", parameters, PARAMETERS_MAX)?;
        let products =
            weights.and_then(|weights| weights.checked_mul(rows)?.checked_add(self.products));
        self.products = at_most("multiplications in an evaluation", products, PRODUCTS_MAX)?;
        Ok(())
    }

    /// The value of an output, in a place from which it can be read.
    pub(super) fn output(&mut self, name: &str) -> Result<Row, NetworkError> {
        match self.known.get(name).cloned() {
            Some(Value::Computed(row)) => Ok(row),
            Some(Value::Constant(Tensor { shape, numbers })) => match &*numbers {
                Numbers::Floats(floats) => Ok(Row {
                    place: self.place(name, floats)?,
                    shape,
                    element: Element::Float,
                }),
                Numbers::Integers(_) => Err(NetworkError::tensor(
                    name,
                    "constant integers as an output",
                    "floats",
                )),
            },
            None => Err(NetworkError::tensor(
                name,
                "an output that no node computes",
                "the output of a node",
            )),
        }
    }
}

/// A constant of a node as a non-empty list of finite floats.
pub(super) fn floats<'a>(
    node: &Node,
    index: usize,
    tensor: &'a Tensor,
) -> Result<&'a [f32], NetworkError> {
    let floats = numbers(node, index, tensor)?;
    if floats.iter().all(|float| float.is_finite()) {
        return Ok(floats);
    }
    let found = format!("a number in input {index} that is infinite in single precision");
    Err(node.wrong(found, "finite numbers"))
}

/// A constant of a node as a non-empty list of floats, none of them NaN.
fn numbers<'a>(node: &Node, index: usize, tensor: &'a Tensor) -> Result<&'a [f32], NetworkError> {
    match &*tensor.numbers {
        Numbers::Floats(floats) if !floats.is_empty() => Ok(floats),
        Numbers::Floats(_) => Err(node.wrong(
            format!("{} as input {index}", shape_text(&tensor.shape)),
            "at least one number",
        )),
        Numbers::Integers(_) => {
            Err(node.wrong(format!("integers as input {index}"), "FLOAT numbers"))
        }
    }
}
