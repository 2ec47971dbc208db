//! The best point of several functions in pieces, by branch and bound.
//!
//! A branch takes one piece of every function, one function after the other; what is left of the domain is the box that
//! all pieces taken so far share. There the sum of what was taken is linear, so its largest value is at a corner; with the
//! most that the functions still to come reach on that box it bounds the branch, and a branch that cannot beat the best
//! point found is cut off (Benjamin 2002). The pieces of a function stand in a tree of boxes that know the most their pieces
//! reach, so that the pieces that meet a box, and the most they reach, are found without looking at all of them.
//!
//! Weighted slopes and values are rounded to [`STEP`] first. From there on everything is integers: the maximum is exact
//! for the rounded pieces, and of equal points the one that comes first in the order of their numbers, axis by axis, is
//! taken, whatever the order of functions or pieces.

use super::domain::{AXES_MAX, Domain, Point};
use super::fixed::{FUNCTIONS_MAX, Weight};
use super::piecewise::{Piece, Piecewise};

/// The step to which weighted slopes and values are rounded.
pub const STEP: f64 = 1.0 / 65_536.0;

/// The best point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimum {
    /// Where it is.
    pub at: Point,
    /// The weighted sum there.
    pub value: f64,
    /// How many branches were looked at.
    pub branches: u64,
}

/// The point of the domain with the largest weighted sum.
///
/// # Panics
/// With more than [`FUNCTIONS_MAX`] functions.
#[must_use]
pub fn best(domain: &Domain, functions: &[(f64, &Piecewise)]) -> Optimum {
    assert!(functions.len() <= FUNCTIONS_MAX, "more than {FUNCTIONS_MAX} functions");
    let mut trees: Vec<Tree> = functions.iter().map(|(weight, function)| Tree::new(*weight, function)).collect();
    // Few pieces first: the upper branches are few then, and large.
    trees.sort_by_key(|tree| tree.pieces.len());
    let whole = Cell { low: Point::default(), high: domain.last() };
    let mut search = Search { trees: &trees, best: i64::MIN, at: Point::default(), branches: 0 };
    search.descend(0, &whole, &Linear::default());
    Optimum { at: search.at, value: search.best as f64 * STEP, branches: search.branches }
}

/// The weighted sum at a point, the plain way: for tests and plots.
#[must_use]
pub fn sum(functions: &[(f64, &Piecewise)], at: &Point) -> f64 {
    let piece = |function: &Piecewise| function.pieces().iter().find(|piece| piece.holds(at)).copied();
    let of = |(weight, function): &(f64, &Piecewise)| {
        piece(function).map_or(0, |piece| Linear::new(Weight::new(*weight), &piece).at(at))
    };
    functions.iter().map(of).sum::<i64>() as f64 * STEP
}

/// A box of grid points, ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    low: Point,
    high: Point,
}

impl Cell {
    /// What two boxes share.
    fn shared(&self, other: &Cell) -> Option<Cell> {
        let mut shared = *self;
        for a in 0..AXES_MAX {
            shared.low[a] = self.low[a].max(other.low[a]);
            shared.high[a] = self.high[a].min(other.high[a]);
            if shared.low[a] > shared.high[a] {
                return None;
            }
        }
        Some(shared)
    }

    /// Whether two boxes share a point.
    fn meets(&self, other: &Cell) -> bool {
        (0..AXES_MAX).all(|a| self.low[a] <= other.high[a] && other.low[a] <= self.high[a])
    }

    /// The smallest box around two.
    fn around(&self, other: &Cell) -> Cell {
        Cell {
            low: std::array::from_fn(|a| self.low[a].min(other.low[a])),
            high: std::array::from_fn(|a| self.high[a].max(other.high[a])),
        }
    }
}

/// A linear function in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Linear {
    slope: [i64; AXES_MAX],
    at_zero: i64,
}

impl Linear {
    fn new(weight: Weight, piece: &Piece) -> Linear {
        let steps = |x: f64| (x * weight.value() / STEP).round() as i64;
        Linear { slope: piece.slope.map(steps), at_zero: steps(piece.at_zero) }
    }

    fn plus(&self, other: &Linear) -> Linear {
        Linear { slope: std::array::from_fn(|a| self.slope[a] + other.slope[a]), at_zero: self.at_zero + other.at_zero }
    }

    fn at(&self, at: &Point) -> i64 {
        (0..AXES_MAX).fold(self.at_zero, |sum, a| sum + self.slope[a] * i64::from(at[a]))
    }

    /// The corner of a box where it is largest; of several the lowest.
    fn corner(&self, cell: &Cell) -> Point {
        std::array::from_fn(|a| if self.slope[a] > 0 { cell.high[a] } else { cell.low[a] })
    }

    /// The most it reaches on a box.
    fn most(&self, cell: &Cell) -> i64 {
        self.at(&self.corner(cell))
    }
}

/// A box in a tree: over all of its pieces, with the most they reach.
#[derive(Clone, Copy, Debug)]
struct Node {
    cell: Cell,
    most: i64,
    /// The first of two nodes beneath, or the number of a piece.
    next: Next,
}

#[derive(Clone, Copy, Debug)]
enum Next {
    Nodes(usize, usize),
    Piece(usize),
}

/// One function's weighted pieces.
struct Tree {
    pieces: Vec<(Cell, Linear)>,
    nodes: Vec<Node>,
    root: Option<usize>,
}

impl Tree {
    fn new(weight: f64, function: &Piecewise) -> Tree {
        let weight = Weight::new(weight);
        let weighted = |piece: &Piece| (Cell { low: piece.low, high: piece.high }, Linear::new(weight, piece));
        let pieces: Vec<(Cell, Linear)> = function.pieces().iter().map(weighted).collect();
        let mut order: Vec<usize> = (0..pieces.len()).collect();
        let mut tree = Tree { nodes: Vec::with_capacity(2 * pieces.len()), pieces, root: None };
        tree.root = tree.grow(&mut order);
        tree
    }

    /// A tree over these pieces: halved in the middle, across the longest side.
    fn grow(&mut self, order: &mut [usize]) -> Option<usize> {
        if let [only] = *order {
            let (cell, linear) = self.pieces[only];
            return Some(self.push(Node { cell, most: linear.most(&cell), next: Next::Piece(only) }));
        }
        let cells = order.iter().map(|&i| self.pieces[i].0);
        let all = cells.reduce(|a, b| a.around(&b))?;
        let side = (0..AXES_MAX).max_by_key(|&a| all.high[a] - all.low[a]).unwrap_or(0);
        order.sort_by_key(|&i| (self.pieces[i].0.low[side], i));
        let (left, right) = order.split_at_mut(order.len() / 2);
        let (left, right) = (self.grow(left)?, self.grow(right)?);
        let most = self.nodes[left].most.max(self.nodes[right].most);
        Some(self.push(Node { cell: all, most, next: Next::Nodes(left, right) }))
    }

    fn push(&mut self, node: Node) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// The most that a piece that meets the box reaches anywhere, if it is more than `known`; else that.
    fn ceiling(&self, node: usize, cell: &Cell, known: i64) -> i64 {
        let node = &self.nodes[node];
        if node.most <= known || !node.cell.meets(cell) {
            return known;
        }
        match node.next {
            Next::Piece(i) => {
                let (own, linear) = &self.pieces[i];
                own.shared(cell).map_or(known, |shared| linear.most(&shared).max(known))
            }
            Next::Nodes(a, b) => {
                let (first, second) = if self.nodes[a].most >= self.nodes[b].most { (a, b) } else { (b, a) };
                self.ceiling(second, cell, self.ceiling(first, cell, known))
            }
        }
    }

    /// Adds the pieces that meet the box to a list.
    fn meeting(&self, node: usize, cell: &Cell, found: &mut Vec<usize>) {
        let node = &self.nodes[node];
        if !node.cell.meets(cell) {
            return;
        }
        match node.next {
            Next::Piece(i) => found.push(i),
            Next::Nodes(a, b) => {
                self.meeting(a, cell, found);
                self.meeting(b, cell, found);
            }
        }
    }
}

/// A branch that may be taken.
struct Branch {
    bound: i64,
    cell: Cell,
    linear: Linear,
}

struct Search<'a> {
    trees: &'a [Tree],
    best: i64,
    at: Point,
    branches: u64,
}

impl Search<'_> {
    /// Looks at all branches within a box, from function number `depth` on, on which those before come to `taken`.
    fn descend(&mut self, depth: usize, cell: &Cell, taken: &Linear) {
        self.branches += 1;
        let Some(tree) = self.trees.get(depth) else {
            let at = taken.corner(cell);
            let value = taken.at(&at);
            if value > self.best || value == self.best && at < self.at {
                (self.best, self.at) = (value, at);
            }
            return;
        };
        let mut found = Vec::new();
        if let Some(root) = tree.root {
            tree.meeting(root, cell, &mut found);
        }
        let mut branches: Vec<Branch> = Vec::with_capacity(found.len());
        for i in found {
            let (own, linear) = &tree.pieces[i];
            let Some(shared) = own.shared(cell) else { continue };
            let linear = taken.plus(linear);
            let bound = linear.most(&shared) + self.to_come(depth + 1, &shared);
            if !self.is_hopeless(bound, &shared) {
                branches.push(Branch { bound, cell: shared, linear });
            }
        }
        // The most promising first: what it finds cuts off others.
        branches.sort_by(|a, b| b.bound.cmp(&a.bound).then_with(|| a.cell.low.cmp(&b.cell.low)));
        for branch in branches {
            if !self.is_hopeless(branch.bound, &branch.cell) {
                self.descend(depth + 1, &branch.cell, &branch.linear);
            }
        }
    }

    /// The most that the functions from number `depth` on reach on a box.
    fn to_come(&self, depth: usize, cell: &Cell) -> i64 {
        let most = |tree: &Tree| match tree.root {
            Some(root) => tree.ceiling(root, cell, i64::MIN),
            None => 0,
        };
        self.trees[depth..].iter().map(most).sum()
    }

    /// Whether no point of a box can take the place of the best one.
    fn is_hopeless(&self, bound: i64, cell: &Cell) -> bool {
        bound < self.best || bound == self.best && cell.low >= self.at
    }
}
