//! The sea: the effects of waves, wind and current on a boat at a position and time.
//!
//! Start with [`SeaNow::forcing`], the only place where the sea acts on boats. The sea is a
//! function of scenario, seed and time. It has no memory, so a world reset to an earlier time finds
//! the same sea.

pub mod band;
mod cached_process;
pub mod current;
pub mod eddy;
mod gauss_markov;
mod heading;
mod hull_wave;
mod patch;
mod sine;
pub mod spectrum;
mod submergence;
mod summary;
pub mod wave;
mod wave_response;
pub mod wind;
pub mod windage;

pub use band::Band;
pub use current::{CurrentField, CurrentNow};
pub use hull_wave::{HullWaves, WaveSample};
pub use submergence::Submergence;
pub use summary::{Summary, WaveSummary, WindSummary};
pub use wave::{Component, Surface, WaveField};
pub use wave_response::{Attitude, WaveResponse};
pub use wind::WindField;

use patch::Patches;

use crate::hull::{HullModel, Planar};
use messages::water::Water;
use primitives::SimTime;
use primitives::frame::{Body, Ned, Pose, Rotation};
use primitives::instructions::Instructions;
use primitives::reseed::Seeds;
use rules::Field;
use scenario::Boat;
use scenario::boat::{Drive, Windage};
use scenario::sea::Sea;
use std::sync::Arc;

/// Distance of the propellers astern of the midship point, as a fraction of the length.
const PROPELLER_ASTERN: f64 = 0.4;

/// Tables, one for each size of hull.
type Made<const N: usize, T> = Vec<([f64; N], Arc<T>)>;

/// The sea of a game, with tables for each kind of boat. Clones share the tables, which are large.
#[derive(Clone, Debug)]
pub struct SeaModel {
    waves: Option<WaveField>,
    wind: Option<WindField>,
    current: CurrentField,
    /// Shapes by size of hull; kinds of boat that differ only in other respects share them.
    shapes: Made<3, Shape>,
    /// Propeller submergence, by size of hull and position of the propellers.
    submergences: Made<4, Submergence>,
    kinds: Vec<Kind>,
    half_tick: SimTime,
    half_s: f64,
}

/// A hull of one size in the waves.
#[derive(Clone, Debug)]
struct Shape {
    waves: HullWaves,
    response: WaveResponse,
    /// The part of Stokes drift that a drifting hull does not get from the orbital motion.
    rise_drift_m_s: Ned,
}

#[derive(Clone, Debug)]
struct Kind {
    length_m: f64,
    /// Index into the shapes, if there are waves.
    shape: usize,
    windage: Windage,
    /// The mean wind at the height of the boat's windage, m/s.
    wind_mean_m_s: f64,
    /// Index into the submergences, if the boat's propellers can ventilate.
    submergence: Option<usize>,
}

/// The sea at one moment.
#[derive(Clone, Copy, Debug)]
pub struct SeaNow<'a> {
    model: &'a SeaModel,
    current: CurrentNow<'a>,
    now: SimTime,
    /// The time half a tick later, at which waves are evaluated, s.
    middle_s: f64,
}

/// The sea's effect on a boat over a tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct SeaForcing {
    /// The water's velocity over the ground, without the orbital motion of waves, m/s. Includes the
    /// part of Stokes drift that does not follow from the forces.
    pub current_m_s: Ned,
    /// The waves' orbital velocity and the water's rotation, half-way through the tick, in body
    /// axes.
    pub water: Planar,
    /// Rate of change of `water`.
    pub water_rate: Planar,
    /// Wind, wave and drift forces in body axes.
    pub force: Planar,
    /// Depth of the boat's propellers minus that in calm water, m; zero if they cannot ventilate.
    pub submergence_change_m: [f64; 2],
}

impl SeaModel {
    /// The model of this sea over this field, for these kinds of boat and ticks of this length,
    /// with the randomness of `seeds`.
    pub fn new(sea: &Sea, boats: &[Boat], field: &Field, tick: SimTime, seeds: &Seeds) -> SeaModel {
        let waves = sea
            .waves
            .as_ref()
            .map(|waves| WaveField::new(waves, sea.depth_m, seeds.first()));
        // Use at least half a metre: the wind profile is a power of the height and is meaningless
        // at the surface itself.
        let highest = boats
            .iter()
            .map(|boat| boat.windage.height_m)
            .fold(0.5, f64::max);
        // Zero wind means no wind force, even on a moving boat.
        let wind = sea.wind.as_ref().filter(|wind| wind.speed_10m_m_s > 0.0);
        let wind = wind.map(|wind| WindField::new(wind, highest, field, seeds));
        let mut model = SeaModel {
            current: CurrentField::new(&sea.current, field, seeds),
            shapes: vec![],
            submergences: vec![],
            kinds: vec![],
            half_tick: SimTime(tick.0 / 2),
            half_s: 0.5 * tick.as_s(),
            waves,
            wind,
        };
        let mut patches = Made::new();
        for boat in boats {
            let kind = Kind {
                submergence: model.submergence_of(boat, &mut patches),
                length_m: boat.length_m,
                shape: model.shape_of(boat, sea.water_density_kg_m3, &mut patches),
                windage: boat.windage.clone(),
                wind_mean_m_s: model
                    .wind
                    .as_ref()
                    .map_or(0.0, |wind| wind.mean_m_s(boat.windage.height_m)),
            };
            model.kinds.push(kind);
        }
        model
    }

    /// The index of the boat's propeller submergence, created on first use; `None` if the
    /// propellers cannot ventilate.
    fn submergence_of(&mut self, boat: &Boat, patches: &mut Made<2, Patches>) -> Option<usize> {
        let (Drive::Thrusters { thruster, .. }, Some(field)) = (&boat.drive, &self.waves) else {
            return None;
        };
        // Boats whose propellers never draw air do not incur this cost.
        thruster.flaws.ventilation?;
        // Share tables by size, not by name: they dominate the time to create a game, and boats
        // with different strategies often have the same hull.
        let size = [boat.length_m, boat.beam_m, boat.draught_m, thruster.arm_m];
        Some(index_of(&mut self.submergences, size, || {
            let ahead = -PROPELLER_ASTERN * boat.length_m;
            let places = [-1.0, 1.0].map(|side| Body {
                ahead,
                starboard: side * thruster.arm_m,
            });
            Submergence::of(field, boat, places, patches_of(patches, field, boat))
        }))
    }

    /// The index of the boat's shape; created on first use.
    fn shape_of(
        &mut self,
        boat: &Boat,
        water_density_kg_m3: f64,
        patches: &mut Made<2, Patches>,
    ) -> usize {
        let Some(field) = &self.waves else { return 0 };
        index_of(
            &mut self.shapes,
            [boat.length_m, boat.beam_m, boat.draught_m],
            || {
                let patches = patches_of(patches, field, boat);
                Shape {
                    waves: HullWaves::of(field, boat, water_density_kg_m3, patches),
                    response: WaveResponse::of(field, boat, patches),
                    rise_drift_m_s: field.rise_drift_m_s(boat.draught_m),
                }
            },
        )
    }

    /// Selects the instruction set for waves, which affects only the speed.
    pub(crate) fn set_instructions(&mut self, instructions: Instructions) {
        self.waves = self
            .waves
            .take()
            .map(|waves| waves.with_instructions(instructions));
        for (_, shape) in &mut self.shapes {
            let shape = Arc::make_mut(shape);
            shape.waves.set_instructions(instructions);
            shape.response.set_instructions(instructions);
        }
    }

    /// Caches the values needed at `now`. This only saves time: the results have the same bits.
    pub fn prepare(&mut self, now: SimTime) {
        self.current.prepare(now);
        if let Some(wind) = &mut self.wind {
            wind.prepare(now);
        }
    }

    /// Whether the water moves in the same way everywhere.
    #[inline]
    pub fn is_uniform(&self) -> bool {
        self.waves.is_none() && self.current.is_uniform()
    }

    /// The sea at `now`.
    #[inline]
    pub fn at_time(&self, now: SimTime) -> SeaNow<'_> {
        // Use whole nanoseconds, so that wave times have the same bits in a played and in a
        // restored game.
        let middle_s = (now + self.half_tick).as_s();
        SeaNow {
            model: self,
            current: self.current.at_time(now),
            now,
            middle_s,
        }
    }
}

impl SeaNow<'_> {
    /// The sea's effect on a boat of this kind with this hull, in the tick that starts now. `nu` is
    /// the boat's velocity over the ground in body axes.
    #[inline]
    pub fn forcing(
        &self,
        kind: usize,
        hull: &HullModel,
        pose: Pose,
        rotation: Rotation,
        nu: Planar,
    ) -> SeaForcing {
        let boat = &self.model.kinds[kind];
        let (current_m_s, turning_rad_s) = self.current.over_hull(pose.at, rotation);
        let mut forcing = SeaForcing {
            current_m_s,
            water: Planar {
                yaw: turning_rad_s,
                ..Planar::default()
            },
            ..SeaForcing::default()
        };
        if let Some(wind) = &self.model.wind {
            // Evaluate the wind at the start of the tick: gusts last for seconds, a tick for
            // hundredths of a second.
            let air_m_s = wind.at(pose.at, boat.wind_mean_m_s, self.now);
            let past = windage::wind_past_boat(rotation, air_m_s, nu);
            forcing.force = windage::wind_force(&boat.windage, boat.length_m, past);
        }
        if self.model.waves.is_some() {
            self.add_waves(boat, hull, pose, rotation, nu, &mut forcing);
        }
        forcing
    }

    /// Adds the waves half-way through the tick, at the boat's predicted position.
    #[inline]
    fn add_waves(
        &self,
        boat: &Kind,
        hull: &HullModel,
        pose: Pose,
        rotation: Rotation,
        nu: Planar,
        forcing: &mut SeaForcing,
    ) {
        let half_s = self.model.half_s;
        let shape = &self.model.shapes[boat.shape].1;
        let velocity_m_s = nu.in_ned(rotation);
        // Evaluate the waves once, in the middle of the tick: the rate of change is also known
        // there, and three evaluations would triple the largest cost of a tick.
        let middle = Pose {
            at: pose.at + velocity_m_s.scaled(half_s),
            psi_rad: pose.psi_rad + half_s * nu.yaw,
        };
        let (waves, submergence_change_m) = match boat
            .submergence
            .map(|index| &self.model.submergences[index].1)
        {
            None => (shape.waves.at(middle, self.middle_s), [0.0; 2]),
            Some(submergence) => shape.waves.at_with(submergence, middle, self.middle_s),
        };
        forcing.submergence_change_m = submergence_change_m;
        // Linear waves have no mean transport. In real waves floating bodies drift (Stokes), and
        // this part of the drift does not follow from the forces.
        forcing.current_m_s = forcing.current_m_s + shape.rise_drift_m_s;
        forcing.water = forcing.water.plus(1.0, waves.velocity);
        forcing.water_rate = waves.acceleration;
        // Long waves accelerate the displaced water and the added mass as they accelerate water
        // (Froude-Krylov and diffraction; Newman 1977, ch. 6).
        forcing.force = forcing
            .force
            .plus(1.0, hull.force_of(waves.acceleration))
            .plus(1.0, waves.drift_newton);
    }

    /// The waves, if there are any.
    pub fn waves(&self) -> Option<&WaveField> {
        self.model.waves.as_ref()
    }

    /// The waves for observers; empty in calm water.
    pub fn water(&self) -> Water {
        Water {
            waves: self.waves().map(WaveField::plane_waves).unwrap_or_default(),
        }
    }

    /// The current at a place, which carries a point boat along, m/s.
    pub fn current_at(&self, at: Ned) -> Ned {
        self.current.at(at)
    }

    /// Height of the water surface above calm level at a place, m.
    pub fn elevation_m(&self, at: Ned) -> f64 {
        self.model
            .waves
            .as_ref()
            .map_or(0.0, |waves| waves.surface(at, self.now.as_s()).elevation_m)
    }

    /// The velocity of the air 10 m above the water, m/s.
    pub fn wind_at(&self, at: Ned) -> Ned {
        // Ten metres is the reference height of wind reports and Beaufort numbers, not a boat's
        // height.
        self.model.wind.as_ref().map_or_else(Ned::default, |wind| {
            wind.at(at, wind.mean_m_s(10.0), self.now)
        })
    }

    /// The current attitude of a boat of this kind in the waves.
    pub fn attitude(&self, kind: usize, pose: Pose, rotation: Rotation, nu: Planar) -> Attitude {
        if self.model.waves.is_none() {
            return Attitude::default();
        }
        let velocity_m_s = nu.in_ned(rotation);
        self.model.shapes[self.model.kinds[kind].shape]
            .1
            .response
            .at(pose, velocity_m_s, nu.yaw, self.now.as_s())
    }
}

/// The averaged waves under a hull of this length and beam.
fn patches_of<'a>(made: &'a mut Made<2, Patches>, field: &WaveField, boat: &Boat) -> &'a Patches {
    let index = index_of(made, [boat.length_m, boat.beam_m], || {
        Patches::new(field, boat)
    });
    &made[index].1
}

/// The index of the entry for this size, created on first use.
fn index_of<const N: usize, T>(
    made: &mut Made<N, T>,
    size: [f64; N],
    make: impl FnOnce() -> T,
) -> usize {
    made.iter()
        .position(|(other, _)| *other == size)
        .unwrap_or_else(|| {
            made.push((size, Arc::new(make())));
            made.len() - 1
        })
}

/// A short-crested sea for tests.
#[cfg(test)]
fn waves_from(from_rad: f64, hs_m: f64, tp_s: f64, components: u32) -> scenario::sea::Waves {
    let spreading = scenario::sea::Spreading::CosineSquared;
    scenario::sea::Waves {
        hs_m,
        tp_s,
        gamma: 3.3,
        from_rad,
        spreading,
        components,
        drift_factor: 1.0,
    }
}
