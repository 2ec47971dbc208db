//! The sea: the forces and water velocities that waves, wind and current exert on a boat at its place and time.
//!
//! Open [`SeaNow::forcing`] first: the only place where the sea acts on boats. Everything here is a function of the
//! scenario, the seed and the time; the sea remembers nothing, so a world that goes back in time finds the same sea.

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

/// Propellers are this share of the length astern of midships.
const PROPELLER_ASTERN: f64 = 0.4;

/// What was made for hulls of different size, which is large and shared.
type Made<const N: usize, T> = Vec<([f64; N], Arc<T>)>;

/// The sea of a game, and how each kind of boat lies in it. Copies share the tables, which are large.
#[derive(Clone, Debug)]
pub struct SeaModel {
    waves: Option<WaveField>,
    wind: Option<WindField>,
    current: CurrentField,
    /// Hulls of different size; kinds of boat that differ in other things share one.
    shapes: Made<3, Shape>,
    /// Propeller submergence, by size of hull and place of the propellers.
    submergences: Made<4, Submergence>,
    kinds: Vec<Kind>,
    /// Half a tick, and as seconds.
    half_tick: SimTime,
    half_s: f64,
}

/// A size of hull in the waves.
#[derive(Clone, Debug)]
struct Shape {
    waves: HullWaves,
    response: WaveResponse,
    /// The part of Stokes drift that a drifting hull does not already get from the orbital motion.
    rise_drift_m_s: Ned,
}

#[derive(Clone, Debug)]
struct Kind {
    length_m: f64,
    /// Index into the shapes, where there are waves.
    shape: usize,
    windage: Windage,
    /// The mean wind at the height of its windage, m/s.
    wind_mean_m_s: f64,
    /// Index into the submergences, where propellers ventilate.
    submergence: Option<usize>,
}

/// The sea at one moment.
#[derive(Clone, Copy, Debug)]
pub struct SeaNow<'a> {
    model: &'a SeaModel,
    current: CurrentNow<'a>,
    now: SimTime,
    /// The same half a tick later, in s: when waves are taken.
    middle_s: f64,
}

/// How the sea acts on a boat over a tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct SeaForcing {
    /// The velocity of the water over the ground without the orbital motion of waves, m/s.
    pub current_m_s: Ned,
    /// The orbital velocity of the waves and the water's rotation, half-way through the tick, in the boat's axes.
    pub water: Planar,
    /// The rate at which that changes.
    pub water_rate: Planar,
    /// Wind, wave and drift forces in the boat's axes.
    pub force: Planar,
    /// By how much its propellers are deeper than in calm water, where they ventilate, m.
    pub submergence_change_m: [f64; 2],
}

impl SeaModel {
    /// This sea over this field, for these kinds of boat and ticks of this length, with the randomness that `seeds` choose.
    #[must_use]
    pub fn new(sea: &Sea, boats: &[Boat], field: &Field, tick: SimTime, seeds: &Seeds) -> SeaModel {
        let waves = sea.waves.as_ref().map(|waves| WaveField::new(waves, sea.depth_m, seeds.first()));
        // No lower than half a metre: the profile of the wind is a power of the height, and has
        // no sense at the water itself.
        let highest = boats.iter().map(|boat| boat.windage.height_m).fold(0.5, f64::max);
        // Wind of no speed is no wind, whatever the boat makes by its own way.
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
                wind_mean_m_s: model.wind.as_ref().map_or(0.0, |wind| wind.mean_m_s(boat.windage.height_m)),
            };
            model.kinds.push(kind);
        }
        model
    }

    /// The index of the boat's propeller submergence, made if it is the first of it, if the propellers can ventilate.
    fn submergence_of(&mut self, boat: &Boat, patches: &mut Made<2, Patches>) -> Option<usize> {
        let (Drive::Thrusters { thruster, .. }, Some(field)) = (&boat.drive, &self.waves) else { return None };
        // For boats whose propellers never draw air this costs nothing.
        thruster.flaws.ventilation?;
        // By size and not by name: tables take most of the time in which a game is made, and
        // strategies often differ where hulls do not.
        let size = [boat.length_m, boat.beam_m, boat.draught_m, thruster.arm_m];
        Some(index_of(&mut self.submergences, size, || {
            let ahead = -PROPELLER_ASTERN * boat.length_m;
            let places = [-1.0, 1.0].map(|side| Body { ahead, starboard: side * thruster.arm_m });
            Submergence::of(field, boat, places, patches_of(patches, field, boat))
        }))
    }

    /// The index of the boat's shape, made if it is the first of it.
    fn shape_of(&mut self, boat: &Boat, water_density_kg_m3: f64, patches: &mut Made<2, Patches>) -> usize {
        let Some(field) = &self.waves else { return 0 };
        index_of(&mut self.shapes, [boat.length_m, boat.beam_m, boat.draught_m], || {
            let patches = patches_of(patches, field, boat);
            Shape {
                waves: HullWaves::of(field, boat, water_density_kg_m3, patches),
                response: WaveResponse::of(field, boat, patches),
                rise_drift_m_s: field.rise_drift_m_s(boat.draught_m),
            }
        })
    }

    /// Works its waves out with these instructions. Which ones changes nothing but how long it takes.
    pub(crate) fn set_instructions(&mut self, instructions: Instructions) {
        self.waves = self.waves.take().map(|waves| waves.with_instructions(instructions));
        for (_, shape) in &mut self.shapes {
            let shape = Arc::make_mut(shape);
            shape.waves.set_instructions(instructions);
            shape.response.set_instructions(instructions);
        }
    }

    /// Has at hand what is asked for at `now`. Only for speed: without it everything is the same to the last bit.
    pub fn prepare(&mut self, now: SimTime) {
        self.current.prepare(now);
        if let Some(wind) = &mut self.wind {
            wind.prepare(now);
        }
    }

    /// Whether the water moves everywhere alike.
    #[inline]
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        self.waves.is_none() && self.current.is_uniform()
    }

    /// The sea at `now`.
    #[inline]
    #[must_use]
    pub fn at_time(&self, now: SimTime) -> SeaNow<'_> {
        // In whole nanoseconds: the time of a wave has the same bits whether the game has come
        // here or was set here.
        let middle_s = (now + self.half_tick).as_s();
        SeaNow { model: self, current: self.current.at_time(now), now, middle_s }
    }
}

impl SeaNow<'_> {
    /// How the sea acts on a boat of this kind, with this hull, in the tick that begins now. `nu` is its velocity over the ground
    /// along its axes.
    #[inline]
    #[must_use]
    pub fn forcing(&self, kind: usize, hull: &HullModel, pose: Pose, rotation: Rotation, nu: Planar) -> SeaForcing {
        let boat = &self.model.kinds[kind];
        let (current_m_s, turning_rad_s) = self.current.over_hull(pose.at, rotation);
        let mut forcing = SeaForcing {
            current_m_s,
            water: Planar { yaw: turning_rad_s, ..Planar::default() },
            ..SeaForcing::default()
        };
        if let Some(wind) = &self.model.wind {
            // At the beginning of the tick: gusts last for seconds, a tick for hundredths.
            let air_m_s = wind.at(pose.at, boat.wind_mean_m_s, self.now);
            let past = windage::wind_past_boat(rotation, air_m_s, nu);
            forcing.force = windage::wind_force(&boat.windage, boat.length_m, windage::AIR_DENSITY_KG_M3, past);
        }
        if self.model.waves.is_some() {
            self.add_waves(boat, hull, pose, rotation, nu, &mut forcing);
        }
        forcing
    }

    /// Waves are taken half-way through the tick, where the boat will be by then.
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
        let (half_s, shape) = (self.model.half_s, &self.model.shapes[boat.shape].1);
        let velocity_m_s = nu.in_ned(rotation);
        // In the middle of the tick, once: its rate of change is known there as well, and three
        // evaluations would triple the largest part of a tick.
        let middle = Pose { at: pose.at + velocity_m_s.scaled(half_s), psi_rad: pose.psi_rad + half_s * nu.yaw };
        let (waves, submergence_change_m) = match boat.submergence.map(|index| &self.model.submergences[index].1) {
            None => (shape.waves.at(middle, self.middle_s), [0.0; 2]),
            Some(submergence) => shape.waves.at_with(submergence, middle, self.middle_s),
        };
        forcing.submergence_change_m = submergence_change_m;
        // Linear waves carry nothing in the mean. What floats in real ones drifts (Stokes), and
        // this part of it does not come out of the forces.
        forcing.current_m_s = forcing.current_m_s + shape.rise_drift_m_s;
        forcing.water = forcing.water.plus(1.0, waves.velocity);
        forcing.water_rate = waves.acceleration;
        // Long waves push the water that the hull displaces, and that it would carry along, as they push water
        // (Froude-Krylov and diffraction; Newman 1977, ch. 6).
        forcing.force = forcing.force.plus(1.0, hull.force_of(waves.acceleration)).plus(1.0, waves.drift_newton);
    }

    /// The waves, if there are any.
    #[must_use]
    pub fn waves(&self) -> Option<&WaveField> {
        self.model.waves.as_ref()
    }

    /// The waves as observers draw them; none on calm water.
    #[must_use]
    pub fn water(&self) -> Water {
        Water { waves: self.waves().map(WaveField::plane_waves).unwrap_or_default() }
    }

    /// The current at a place, m/s: what carries a point boat along.
    #[must_use]
    pub fn current_at(&self, at: Ned) -> Ned {
        self.current.at(at)
    }

    /// How much higher the water stands at a place than in calm, m.
    #[must_use]
    pub fn elevation_m(&self, at: Ned) -> f64 {
        self.model.waves.as_ref().map_or(0.0, |waves| waves.surface(at, self.now.as_s()).elevation_m)
    }

    /// The velocity of the air 10 m above the water, m/s.
    #[must_use]
    pub fn wind_at(&self, at: Ned) -> Ned {
        // At ten metres, the height for which winds are told and Beaufort numbers are defined,
        // not at a boat's.
        self.model.wind.as_ref().map_or_else(Ned::default, |wind| wind.at(at, wind.mean_m_s(10.0), self.now))
    }

    /// The attitude of a boat of this kind in the waves now.
    #[must_use]
    pub fn attitude(&self, kind: usize, pose: Pose, rotation: Rotation, nu: Planar) -> Attitude {
        if self.model.waves.is_none() {
            return Attitude::default();
        }
        let velocity_m_s = nu.in_ned(rotation);
        self.model.shapes[self.model.kinds[kind].shape].1.response.at(pose, velocity_m_s, nu.yaw, self.now.as_s())
    }
}

/// The waves under a hull of this length and beam.
fn patches_of<'a>(made: &'a mut Made<2, Patches>, field: &WaveField, boat: &Boat) -> &'a Patches {
    let index = index_of(made, [boat.length_m, boat.beam_m], || Patches::new(field, boat));
    &made[index].1
}

/// The place of what was made for this size, made now if it is the first of it.
fn index_of<const N: usize, T>(made: &mut Made<N, T>, size: [f64; N], make: impl FnOnce() -> T) -> usize {
    made.iter().position(|(other, _)| *other == size).unwrap_or_else(|| {
        made.push((size, Arc::new(make())));
        made.len() - 1
    })
}

/// A short-crested sea for tests.
#[cfg(test)]
fn waves_from(from_rad: f64, hs_m: f64, tp_s: f64, components: u32) -> scenario::sea::Waves {
    let spreading = scenario::sea::Spreading::CosineSquared;
    scenario::sea::Waves { hs_m, tp_s, gamma: 3.3, from_rad, spreading, components, drift_factor: 1.0 }
}
