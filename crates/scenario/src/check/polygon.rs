//! Checks a polygon of a file.

use primitives::frame::Ned;
use rules::field::{do_meet, turn};

/// Checks that no two sides of a polygon meet, except adjacent sides at their common corner.
///
/// # Errors
/// The index of the faulty corner, and the reason.
pub fn check_corners(corners: &[Ned]) -> Result<(), (usize, String)> {
    let count = corners.len();
    let side = |i: usize| (corners[i], corners[(i + 1) % count]);
    for i in 0..count {
        if corners[i] == side(i).1 {
            return Err((
                i,
                "polygon has two corners at the same position, expected distinct corners".into(),
            ));
        }
        // Adjacent sides share a corner, but must not fold back onto each other.
        let crossing = (i + 1..count).find(|&j| {
            let is_next = j == i + 1;
            let is_before = (j + 1) % count == i;
            match (is_next, is_before) {
                (true, _) => folds_back(corners[i], corners[j], side(j).1),
                (_, true) => folds_back(corners[j], corners[i], side(i).1),
                _ => do_meet(side(i), side(j)),
            }
        });
        if let Some(j) = crossing {
            return Err((
                j,
                format!(
                    "polygon is self-intersecting: sides {} and {} cross",
                    i + 1,
                    j + 1
                ),
            ));
        }
    }
    Ok(())
}

fn folds_back(a: Ned, b: Ned, c: Ned) -> bool {
    turn(a, b, c) == 0.0 && (a - b).dot(c - b) > 0.0
}
