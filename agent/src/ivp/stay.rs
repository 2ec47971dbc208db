//! Staying within a region: how long every course and speed would take to leave it.

use wide::f32x8;

/// The most edges of a region.
pub const EDGES_MAX: usize = 8;

/// One edge of a convex region, as a half plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edge {
    /// The outward normal, a unit vector: its part to the north.
    pub normal_north: f64,
    /// Its part to the east.
    pub normal_east: f64,
    /// How far inside of the edge the own ship is, m; negative outside.
    pub inside_m: f64,
}

/// Utility of the time until a straight run leaves a convex region: 0 before `soon_s`, 100 after `late_s`, linear in
/// between; the edge that is worst for a candidate counts.
///
/// Outside of an edge, candidates that do not come back through it are worth nothing, and the others the more the faster
/// they come back: 100 when they do so with the fastest speed of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stay {
    edges: [Edge; EDGES_MAX],
    count: usize,
    /// Velocity that wind and current add to every candidate, to the north, m/s.
    pub drift_north_m_s: f64,
    /// Velocity that wind and current add to every candidate, to the east, m/s.
    pub drift_east_m_s: f64,
    /// Leaving before this is worth nothing, s.
    pub soon_s: f64,
    /// Leaving after this is as good as staying, s.
    pub late_s: f64,
}

impl Stay {
    /// Inside of no edge yet, without drift.
    #[must_use]
    pub fn new(soon_s: f64, late_s: f64) -> Stay {
        Stay { soon_s, late_s, ..Stay::default() }
    }

    /// With another edge.
    ///
    /// # Panics
    /// Beyond eight.
    #[must_use]
    pub fn and(mut self, edge: Edge) -> Stay {
        assert!(self.count < EDGES_MAX, "more than {EDGES_MAX} edges");
        self.edges[self.count] = edge;
        self.count += 1;
        self
    }

    /// With this drift, m/s.
    #[must_use]
    pub fn drifting(mut self, north_m_s: f64, east_m_s: f64) -> Stay {
        (self.drift_north_m_s, self.drift_east_m_s) = (north_m_s, east_m_s);
        self
    }

    /// The edges.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges[..self.count]
    }

    /// The function in single precision; none if a number is none.
    pub(super) fn ready(&self, speed_max_m_s: f64) -> Option<Ready> {
        let sound = |x: f64| x.is_finite() && x.abs() < 1e7;
        let edges = self.edges().iter().all(|e| sound(e.normal_north) && sound(e.normal_east) && sound(e.inside_m));
        let rest = [self.drift_north_m_s, self.drift_east_m_s, self.soon_s, self.late_s];
        let sound = edges && rest.into_iter().all(sound);
        debug_assert!(sound, "{self:?}");
        if !sound {
            return None;
        }
        let width_s = self.late_s - self.soon_s;
        Some(Ready {
            sides: self.edges.map(|edge| Side {
                north: edge.normal_north as f32,
                east: edge.normal_east as f32,
                inside: edge.inside_m as f32,
                drift: (edge.normal_north * self.drift_north_m_s + edge.normal_east * self.drift_east_m_s) as f32,
            }),
            count: self.count,
            soon: self.soon_s as f32,
            slope: if width_s > 0.0 { (100.0 / width_s).min(1e12) } else { 1e12 } as f32,
            speed_max: speed_max_m_s as f32,
        })
    }
}

/// One edge in single precision.
#[derive(Clone, Copy, Debug)]
struct Side {
    north: f32,
    east: f32,
    inside: f32,
    /// How fast the drift alone goes out, m/s.
    drift: f32,
}

/// The function in single precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    sides: [Side; EDGES_MAX],
    count: usize,
    soon: f32,
    slope: f32,
    speed_max: f32,
}

impl Ready {
    /// Utilities of eight candidates.
    #[inline(always)]
    pub(super) fn utility(&self, north: f32x8, east: f32x8, speed: f32x8) -> f32x8 {
        let mut worst = f32x8::splat(100.0);
        for side in &self.sides[..self.count] {
            worst = worst.fast_min(self.of_side(side, north, east, speed));
        }
        worst
    }

    /// What no speed from `slow` to `fast` exceeds, on each of eight courses: for one edge and course utility only rises or
    /// only falls with speed, and rounding keeps that order.
    #[inline]
    pub(super) fn bound(&self, north: f32x8, east: f32x8, slow: f32x8, fast: f32x8) -> f32x8 {
        let mut worst = f32x8::splat(100.0);
        for side in &self.sides[..self.count] {
            let (at_slow, at_fast) = (self.of_side(side, north, east, slow), self.of_side(side, north, east, fast));
            worst = worst.fast_min(at_slow.fast_max(at_fast));
        }
        worst
    }

    /// Utilities as far as one edge is concerned.
    #[inline(always)]
    fn of_side(&self, side: &Side, north: f32x8, east: f32x8, speed: f32x8) -> f32x8 {
        let full = f32x8::splat(100.0);
        let along = f32x8::splat(side.north) * north + f32x8::splat(side.east) * east;
        let out_m_s = along * speed + f32x8::splat(side.drift);
        let utility = if side.inside < 0.0 {
            (-out_m_s) * f32x8::splat(100.0 / self.speed_max)
        } else {
            let leaving = out_m_s.simd_ge(f32x8::splat(1e-9));
            let time_s = f32x8::splat(side.inside) / out_m_s.fast_max(f32x8::splat(1e-9));
            leaving.bitselect((time_s - f32x8::splat(self.soon)) * f32x8::splat(self.slope), full)
        };
        utility.fast_max(f32x8::ZERO).fast_min(full)
    }
}
