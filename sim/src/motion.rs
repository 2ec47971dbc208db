//! One step of motion, for several boats side by side.
//!
//! A boat's step is a long chain of dependent operations, during which the processor mostly waits.
//! Boats are independent, so eight advance together, one per lane. A lane performs the same IEEE
//! operations whatever the other lanes contain and on any processor, so the results do not depend
//! on the grouping.

use crate::hull::{HullModel, Planar};
use crate::lanes::{Lanes, where_at_most};
use primitives::instructions::{Instructions, Kernel};

/// Number of boats in a full row, and in a shorter last row.
// The four stages of a boat's step form one chain of dependent operations; processing eight chains
// side by side takes less than half the time per tick.
const MANY: usize = 8;
const FEW: usize = 4;

/// The forces on a boat over a tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Forcing<T = f64> {
    /// Velocity through the water at the start.
    pub nu_r: Planar<T>,
    /// Force on the hull except resistance and inertial terms, at the start, half-way and at the
    /// end.
    pub tau: [Planar<T>; 3],
    /// The water's own motion half-way (waves and eddies), which affects resistance in addition to
    /// the boat's motion.
    pub water: Planar<T>,
    /// Rate of change of `water`.
    pub water_rate: Planar<T>,
}

/// Motion over one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<T = f64> {
    /// Velocity through the water at the end.
    pub nu_r: Planar<T>,
    /// Velocity through the water half-way.
    pub nu_r_half: Planar<T>,
    /// Change of heading half-way, rad.
    pub turn_half_rad: T,
    /// Change of heading at the end, rad.
    pub turn_rad: T,
}

/// Planar quantities of boats side by side.
type Planars<const N: usize> = Planar<Lanes<f64, N>>;
type Forcings<const N: usize> = Forcing<Lanes<f64, N>>;
type Motions<const N: usize> = Motion<Lanes<f64, N>>;

/// The hulls of a fleet, packed for `advance`.
#[derive(Clone, Debug)]
pub struct Fleet {
    count: usize,
    rows: Vec<Row<MANY>>,
    /// The boats beyond the full rows, if there are at most `FEW`. More than that form an
    /// incomplete row of `rows`.
    last: Option<Row<FEW>>,
    instructions: Instructions,
}

impl Fleet {
    /// The fleet of these hulls.
    pub fn new<'a>(hulls: impl IntoIterator<Item = &'a HullModel>) -> Fleet {
        let hulls: Vec<&HullModel> = hulls.into_iter().collect();
        let left = hulls.len() % MANY;
        let (rows, last) = if left > FEW {
            (&hulls[..], None)
        } else {
            (&hulls[..hulls.len() - left], Some(left))
        };
        let last = last
            .filter(|left| *left > 0)
            .map(|left| Row::new(&hulls[hulls.len() - left..]));
        let rows = rows.chunks(MANY).map(Row::new).collect();
        Fleet {
            count: hulls.len(),
            rows,
            last,
            instructions: Instructions::best(),
        }
    }

    /// Selects the instruction set, which affects only the speed.
    pub(crate) fn set_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// Advances every boat by `dt_s` with a classical fourth-order Runge-Kutta step. Replaces the
    /// contents of `motions`, which is indexed by boat.
    ///
    /// The equation in `nu_r` does not depend on the heading, so no sine or cosine is needed.
    ///
    /// `is_uniform` states that the water moves in the same way everywhere. The water's own motion
    /// is then skipped, with equal results.
    ///
    /// # Panics
    /// If the number of forcings differs from the number of boats.
    pub fn advance(
        &self,
        forcings: &[Forcing],
        dt_s: f64,
        is_uniform: bool,
        motions: &mut Vec<Motion>,
    ) {
        assert_eq!(forcings.len(), self.count, "one forcing per boat");
        motions.clear();
        motions.resize(self.count, Motion::default());
        let places = forcings.chunks(MANY).zip(motions.chunks_mut(MANY));
        for (row, (forcings, motions)) in self.rows.iter().zip(places) {
            self.advance_row(row, forcings, dt_s, is_uniform, motions);
        }
        if let Some(row) = &self.last {
            let first = MANY * self.rows.len();
            self.advance_row(
                row,
                &forcings[first..],
                dt_s,
                is_uniform,
                &mut motions[first..],
            );
        }
    }

    fn advance_row<const N: usize>(
        &self,
        row: &Row<N>,
        forcings: &[Forcing],
        dt_s: f64,
        is_uniform: bool,
        motions: &mut [Motion],
    ) {
        let forcings = Forcings::gather(forcings);
        // There are two compiled versions: a branch inside would keep the loop out of vector
        // registers.
        let moved = if is_uniform {
            self.instructions.run(Advance::<N, true> {
                row,
                forcings: &forcings,
                dt_s,
            })
        } else {
            self.instructions.run(Advance::<N, false> {
                row,
                forcings: &forcings,
                dt_s,
            })
        };
        for (i, motion) in motions.iter_mut().enumerate() {
            *motion = moved.lane(i);
        }
    }
}

/// Advances boats side by side. Packing and unpacking happen outside: inside, they would keep the
/// numbers out of wide registers.
// Sums are never fused multiply-adds: rustc does not contract, and we use no such intrinsic.
struct Advance<'a, const N: usize, const UNIFORM: bool> {
    row: &'a Row<N>,
    forcings: &'a Forcings<N>,
    dt_s: f64,
}

impl<const N: usize, const UNIFORM: bool> Kernel for Advance<'_, N, UNIFORM> {
    type Output = Motions<N>;

    #[inline(always)]
    fn run(self) -> Motions<N> {
        self.row.advance::<UNIFORM>(self.forcings, self.dt_s)
    }
}

/// Resistance of a hull that drifts sideways at this speed, N.
pub(crate) fn cross_flow_newton(hull: &HullModel, drift_m_s: f64) -> f64 {
    let (sway, _) = Row::<FEW>::new(&[hull]).crossflow(Lanes::splat(drift_m_s), Lanes::splat(0.0));
    hull.hull.sway_linear_kg_s * drift_m_s + sway.0[0]
}

impl<const N: usize> Planars<N> {
    const ZERO: Planars<N> = Planars {
        surge: Lanes([0.0; N]),
        sway: Lanes([0.0; N]),
        yaw: Lanes([0.0; N]),
    };

    #[inline(always)]
    fn gather(each: impl Fn(usize) -> Planar) -> Planars<N> {
        let mut all = Planars::ZERO;
        for i in 0..N {
            let planar = each(i);
            (all.surge.0[i], all.sway.0[i], all.yaw.0[i]) = (planar.surge, planar.sway, planar.yaw);
        }
        all
    }

    #[inline(always)]
    fn lane(&self, i: usize) -> Planar {
        Planar {
            surge: self.surge.0[i],
            sway: self.sway.0[i],
            yaw: self.yaw.0[i],
        }
    }

    /// Applies `f` to each component of the parts.
    #[inline(always)]
    fn zip<const M: usize>(
        parts: [Planars<N>; M],
        f: impl Fn([Lanes<f64, N>; M]) -> Lanes<f64, N>,
    ) -> Planars<N> {
        Planars {
            surge: f(parts.map(|p| p.surge)),
            sway: f(parts.map(|p| p.sway)),
            yaw: f(parts.map(|p| p.yaw)),
        }
    }

    /// `self + step * rate`.
    #[inline(always)]
    fn stepped(self, step: f64, rate: Planars<N>) -> Planars<N> {
        Planars::zip([self, rate], |[x, rate]| x + Lanes::splat(step) * rate)
    }
}

impl<const N: usize> Forcings<N> {
    /// Packs one to `N` boats and fills the remaining lanes.
    fn gather(forcings: &[Forcing]) -> Forcings<N> {
        // Unused lanes repeat the last boat, to avoid division by zero.
        let forcing = |i: usize| &forcings[i.min(forcings.len() - 1)];
        Forcings {
            nu_r: Planars::gather(|i| forcing(i).nu_r),
            tau: [0, 1, 2].map(|when| Planars::gather(|i| forcing(i).tau[when])),
            water: Planars::gather(|i| forcing(i).water),
            water_rate: Planars::gather(|i| forcing(i).water_rate),
        }
    }
}

impl<const N: usize> Motions<N> {
    fn lane(&self, i: usize) -> Motion {
        Motion {
            nu_r: self.nu_r.lane(i),
            nu_r_half: self.nu_r_half.lane(i),
            turn_half_rad: self.turn_half_rad.0[i],
            turn_rad: self.turn_rad.0[i],
        }
    }
}

/// Hulls side by side: the constants of [`HullModel`].
#[derive(Clone, Debug)]
struct Row<const N: usize> {
    m_surge: Lanes<f64, N>,
    m_cross: Lanes<f64, N>,
    /// m plus the replacement for A22 in the Coriolis terms.
    m_munk: Lanes<f64, N>,
    /// The replacement for A22 minus A11, for the Munk moment.
    munk: Lanes<f64, N>,
    inverse_surge: Lanes<f64, N>,
    inverse_sway: Lanes<f64, N>,
    inverse_cross: Lanes<f64, N>,
    inverse_yaw: Lanes<f64, N>,
    surge_linear: Lanes<f64, N>,
    surge_quadratic: Lanes<f64, N>,
    sway_linear: Lanes<f64, N>,
    sway_lift: Lanes<f64, N>,
    yaw_linear: Lanes<f64, N>,
    yaw_quadratic: Lanes<f64, N>,
    yaw_lift: Lanes<f64, N>,
    crossflow: Lanes<f64, N>,
    crossflow_half_m: Lanes<f64, N>,
}

impl<const N: usize> Row<N> {
    /// Packs one to `N` hulls and fills the remaining lanes.
    fn new(hulls: &[&HullModel]) -> Row<N> {
        let each = |f: fn(&HullModel) -> f64| {
            Lanes(std::array::from_fn(|i| f(hulls[i.min(hulls.len() - 1)])))
        };
        Row {
            m_surge: each(|m| m.m_surge),
            m_cross: each(|m| m.m_cross),
            m_munk: each(|m| m.hull.mass_kg + m.munk_sway),
            munk: each(|m| m.munk_sway - m.hull.added_surge_kg),
            inverse_surge: each(|m| m.inverse_surge),
            inverse_sway: each(|m| m.inverse_sway),
            inverse_cross: each(|m| m.inverse_cross),
            inverse_yaw: each(|m| m.inverse_yaw),
            surge_linear: each(|m| m.hull.surge_linear_kg_s),
            surge_quadratic: each(|m| m.hull.surge_quadratic_kg_m),
            sway_linear: each(|m| m.hull.sway_linear_kg_s),
            sway_lift: each(|m| m.hull.sway_lift_kg_m),
            yaw_linear: each(|m| m.hull.yaw_linear_kg_m2_s),
            yaw_quadratic: each(|m| m.hull.yaw_quadratic_kg_m2),
            yaw_lift: each(|m| m.hull.yaw_lift_kg_m),
            crossflow: each(|m| m.crossflow),
            crossflow_half_m: each(|m| 0.5 * m.hull.crossflow_length_m),
        }
    }

    /// The acceleration under `tau` at the velocity `nu_r`. Resistance acts on the velocity
    /// relative to the oscillating water, `nu_r - water`.
    #[inline(always)]
    fn acceleration<const UNIFORM: bool>(
        &self,
        nu_r: Planars<N>,
        tau: Planars<N>,
        water: Planars<N>,
    ) -> Planars<N> {
        // M nu_r' + C(nu_r) nu_r + D(nu_r) nu_r = tau (Fossen 2021, ch. 6), row by row. A current
        // constant in time and space adds no term relative to the water; it only changes the
        // position.
        let Planars {
            surge: u,
            sway: v,
            yaw: r,
        } = nu_r;
        // Waves move the water past the hull: their velocity is in this resistance, their
        // acceleration in `tau`. An additional force from the surface slope would count them twice.
        let past = if UNIFORM {
            nu_r
        } else {
            Planars::zip([nu_r, water], |[boat, water]| boat - water)
        };
        let (y_cross, n_cross) = self.crossflow(past.sway, past.yaw);
        let speed = past.surge.abs();
        let x = tau.surge + self.m_munk * v * r + self.m_cross * r * r
            - (self.surge_linear + self.surge_quadratic * speed) * past.surge;
        let y = tau.sway
            - self.m_surge * u * r
            - (self.sway_linear + self.sway_lift * speed) * past.sway
            - y_cross;
        let n = tau.yaw
            - self.m_cross * u * r
            - self.munk * u * v
            - (self.yaw_linear + self.yaw_quadratic * past.yaw.abs() + self.yaw_lift * speed)
                * past.yaw
            - n_cross;
        Planars {
            surge: self.inverse_surge * x,
            sway: self.inverse_sway * y + self.inverse_cross * n,
            yaw: self.inverse_cross * y + self.inverse_yaw * n,
        }
    }

    /// Cross-flow drag in sway and yaw (strip theory): ½ρ C_d T ∫ [1, x] |v + x r| (v + x r) dx.
    ///
    /// The integral is computed in closed form: a sum over strips would be slower and depend on
    /// their number. Let s = r L/2 be the cross-flow that the turn adds at the bow. If |s| ≤ |v|,
    /// the flow has one sign along the hull and the integrand is a polynomial; if |s| > |v|, the
    /// sign changes at x = −v/r, where two polynomials meet.
    #[inline(always)]
    fn crossflow(&self, v: Lanes<f64, N>, r: Lanes<f64, N>) -> (Lanes<f64, N>, Lanes<f64, N>) {
        let number = Lanes::<f64, N>::splat;
        let half = self.crossflow_half_m;
        let s = r * half;
        let v_2 = v * v;
        let s_2 = s * s;
        let half_2 = half * half;
        let same_side = (s.abs(), v.abs());
        let from = v / where_at_most(same_side, number(1.0), r);
        let side = self.crossflow.with_signs_of(where_at_most(same_side, v, r));
        let sway = where_at_most(
            same_side,
            number(2.0) * half * (v_2 + s_2 * number(1.0 / 3.0)),
            number(2.0 / 3.0) * from * (v_2 + number(3.0) * s_2),
        );
        let yaw = where_at_most(
            same_side,
            number(4.0 / 3.0) * half_2 * s * v,
            half_2 * (v_2 + number(0.5) * s_2) - v_2 * (from * from) * number(1.0 / 6.0),
        );
        (side * sway, side * yaw)
    }

    #[inline(always)]
    fn advance<const UNIFORM: bool>(&self, forcings: &Forcings<N>, dt_s: f64) -> Motions<N> {
        let number = Lanes::<f64, N>::splat;
        let Forcings {
            nu_r: start,
            tau,
            water,
            water_rate,
        } = *forcings;
        let half = 0.5 * dt_s;
        let water = if UNIFORM {
            [Planars::ZERO; 3]
        } else {
            [
                water.stepped(-half, water_rate),
                water,
                water.stepped(half, water_rate),
            ]
        };
        // One fourth-order step of 50 ms is close enough to a reference at 20 ms for strict tests;
        // Euler would need much shorter ticks. The thrust at the three times is known in advance,
        // because thrusters have an exact solution.
        let k1 = self.acceleration::<UNIFORM>(start, tau[0], water[0]);
        let k2 = self.acceleration::<UNIFORM>(start.stepped(half, k1), tau[1], water[1]);
        let k3 = self.acceleration::<UNIFORM>(start.stepped(half, k2), tau[1], water[1]);
        let k4 = self.acceleration::<UNIFORM>(start.stepped(dt_s, k3), tau[2], water[2]);
        let sixth = dt_s / 6.0;
        let end = Planars::zip([start, k1, k2, k3, k4], |[x, a, b, c, d]| {
            x + number(sixth) * (a + number(2.0) * (b + c) + d)
        });
        // Cubic through both ends and their slopes; k4 is the slope at the end to third order.
        let eighth = number(dt_s / 8.0);
        let middle = Planars::zip([start, end, k1, k4], |[a, b, at_a, at_b]| {
            number(0.5) * (a + b) + eighth * (at_a - at_b)
        });
        // Integrals of the cubic yaw rate: Simpson over the whole tick, and its first half exactly.
        let turn = number(sixth) * (start.yaw + number(4.0) * middle.yaw + end.yaw);
        let turn_half =
            number(dt_s / 24.0) * (number(5.0) * start.yaw + number(8.0) * middle.yaw - end.yaw);
        Motions {
            nu_r: end,
            nu_r_half: middle,
            turn_half_rad: turn_half,
            turn_rad: turn,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The shipped Otter in salt water.
    fn model() -> HullModel {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/boats/otter.toml");
        let boat = scenario::load_file::<scenario::Boat>(&file).unwrap_or_else(|e| panic!("{e}"));
        HullModel::new(&boat.hull, 1025.0)
    }

    fn adrift(nu_r: Planar) -> Forcing {
        Forcing {
            nu_r,
            ..Forcing::default()
        }
    }

    fn advance(model: &HullModel, forcing: &Forcing, dt_s: f64) -> Planar {
        let mut motions = Vec::new();
        Fleet::new([model]).advance(std::slice::from_ref(forcing), dt_s, false, &mut motions);
        motions[0].nu_r
    }

    fn crossflow(model: &HullModel, v: f64, r: f64) -> (f64, f64) {
        let (sway, yaw) = Row::<FEW>::new(&[model]).crossflow(Lanes::splat(v), Lanes::splat(r));
        (sway.0[0], yaw.0[0])
    }

    #[test]
    fn boats_side_by_side_move_as_each_alone() {
        let mut other = model().hull;
        other.mass_kg = 40.0;
        let models = [model(), HullModel::new(&other, 1000.0)];
        let kinds: [usize; 21] = std::array::from_fn(|i| i * i % 3 % 2);
        let forcing = |i: usize| {
            let x = i as f64;
            let push = |n: f64| Planar {
                surge: 40.0 + n * x,
                sway: n,
                yaw: 5.0 - n * x,
            };
            let nu_r = Planar {
                surge: x,
                sway: 0.3 - 0.2 * x,
                yaw: 0.4 * x - 0.5,
            };
            let water = push(0.01);
            let water_rate = push(0.1);
            Forcing {
                nu_r,
                tau: [0.0, 1.0, 2.0].map(push),
                water,
                water_rate,
            }
        };
        let forcings: Vec<Forcing> = (0..kinds.len()).map(forcing).collect();
        let mut motions = Vec::new();
        for count in 0..=kinds.len() {
            let mut fleet = Fleet::new(kinds[..count].iter().map(|kind| &models[*kind]));
            for set in Instructions::of_this_machine() {
                fleet.set_instructions(set);
                fleet.advance(&forcings[..count], 0.05, false, &mut motions);
                assert_eq!(motions.len(), count);
                for (i, motion) in motions.iter().enumerate() {
                    let alone = advance(&models[kinds[i]], &forcings[i], 0.05);
                    assert_eq!(motion.nu_r, alone, "boat {i} of {count}, {set:?}");
                }
            }
        }
    }

    #[test]
    fn the_closed_form_of_the_cross_flow_agrees_with_many_strips() {
        let model = model();
        let half = 1.05;
        for (v, r) in [
            (0.5, 0.1),
            (-0.5, 0.1),
            (0.1, 1.0),
            (-0.1, 1.0),
            (0.0, -0.7),
            (0.3, 0.0),
            (0.3, -0.285),
            (0.0, 0.0),
        ] {
            let n = 20_000;
            let dx = 2.0 * half / f64::from(n);
            let mut sway = 0.0;
            let mut yaw = 0.0;
            for i in 0..n {
                let x = -half + (f64::from(i) + 0.5) * dx;
                let s: f64 = v + x * r;
                sway += s.abs() * s * dx;
                yaw += x * s.abs() * s * dx;
            }
            let (got_sway, got_yaw) = crossflow(&model, v, r);
            let scale = model.crossflow;
            assert!(
                (got_sway - scale * sway).abs() < 1e-5 * scale,
                "v {v} r {r}: {got_sway} {}",
                scale * sway
            );
            assert!(
                (got_yaw - scale * yaw).abs() < 1e-5 * scale,
                "v {v} r {r}: {got_yaw} {}",
                scale * yaw
            );
        }
    }

    #[test]
    fn inertia_terms_do_no_work_whatever_the_munk_factor() {
        for munk_factor in [0.0, 0.5, 1.0] {
            let mut hull = model().hull;
            hull.munk_factor = munk_factor;
            for zero in [
                &mut hull.surge_linear_kg_s,
                &mut hull.sway_linear_kg_s,
                &mut hull.yaw_linear_kg_m2_s,
            ] {
                *zero = 0.0;
            }
            (hull.yaw_quadratic_kg_m2, hull.crossflow_coefficient) = (0.0, 0.0);
            let model = HullModel::new(&hull, 1025.0);
            let mut nu = Planar {
                surge: 1.5,
                sway: -0.4,
                yaw: 0.6,
            };
            let before = model.energy_joule(nu);
            for _ in 0..2000 {
                nu = advance(&model, &adrift(nu), 0.005);
            }
            let drift = (model.energy_joule(nu) - before).abs() / before;
            assert!(drift < 1e-8, "munk {munk_factor}: energy drifts by {drift}");
        }
    }
}
