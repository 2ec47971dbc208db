//! Cycles among entries: each beats the next, and the last beats the first.

use std::collections::{BTreeSet, VecDeque};

/// The shortest cycle through each pair of entries of which the first beats the second, shortest
/// cycles first. Each starts with its lowest index.
pub(super) fn cycles(beats: &[Vec<bool>]) -> Vec<Vec<usize>> {
    let count = beats.len();
    let pairs = (0..count).flat_map(|one| (0..count).map(move |other| (one, other)));
    let through = |(one, other): (usize, usize)| {
        let mut cycle = beats[one][other].then(|| path(beats, other, one))??;
        let first = (0..cycle.len()).min_by_key(|place| cycle[*place])?;
        cycle.rotate_left(first);
        Some((cycle.len(), cycle))
    };
    let found: BTreeSet<(usize, Vec<usize>)> = pairs.filter_map(through).collect();
    found.into_iter().map(|(_, cycle)| cycle).collect()
}

/// The shortest chain of victories between two entries, both included.
fn path(beats: &[Vec<bool>], from: usize, to: usize) -> Option<Vec<usize>> {
    let mut before = vec![None; beats.len()];
    let mut queue = VecDeque::from([from]);
    while let Some(at) = queue.pop_front() {
        if at == to {
            let steps = std::iter::successors(Some(to), |at| before[*at].filter(|_| *at != from));
            let mut path: Vec<usize> = steps.collect();
            path.reverse();
            return Some(path);
        }
        for next in (0..beats.len()).filter(|next| beats[at][*next]) {
            if next != from && before[next].is_none() {
                before[next] = Some(at);
                queue.push_back(next);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_victory_within_a_cycle_is_part_of_a_shortest_one() {
        let of = |count: usize, pairs: &[(usize, usize)]| {
            let row = |one| (0..count).map(move |other| pairs.contains(&(one, other)));
            cycles(&(0..count).map(|one| row(one).collect()).collect::<Vec<_>>())
        };
        assert_eq!(of(3, &[(0, 1), (1, 2), (0, 2)]), Vec::<Vec<usize>>::new());
        assert_eq!(of(4, &[(0, 3), (3, 1), (1, 0), (0, 2)]), [[0, 3, 1]]);
        // Two cycles share a victory; the longer of them is also the shortest one through 2 and 3.
        let both = [(0, 1), (1, 4), (4, 0), (1, 2), (2, 3), (3, 0)];
        assert_eq!(of(5, &both), [vec![0, 1, 4], vec![0, 1, 2, 3]]);
    }
}
