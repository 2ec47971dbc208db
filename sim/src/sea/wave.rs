//! A wave field: a sum of plane waves with separate heights, frequencies and directions.
//!
//! Linear (Airy) theory: elevation a cos θ with θ = k·x − ω t + φ and ω² = g k tanh k h. A moving
//! boat encounters a wave at the frequency ω − k·V, because the field is evaluated at the boat's
//! position. The effects on a hull are in [`HullWaves`](super::HullWaves).

use super::sine::sin_cos_turns;
use super::spectrum;
use crate::hull::Planar;
use crate::lanes::{FOLD, LANES, Lanes, ROW};
use primitives::frame::Ned;
use primitives::instructions::{Instructions, Kernel};
use scenario::boat::Boat;
use scenario::sea::{GRAVITY_M_S2, Waves};
use std::f64::consts::TAU;

/// One plane wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Half its height, m.
    pub amplitude_m: f64,
    /// Angular frequency at a fixed place, rad/s.
    pub omega_rad_s: f64,
    /// Compass bearing towards which it travels.
    pub toward_rad: f64,
    /// Phase at the datum at the start of the game; 0 is a crest.
    pub phase_rad: f64,
}

/// A component with its wavenumber from the dispersion relation.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneWave {
    pub(super) component: Component,
    /// Unit vector of the direction of travel.
    pub(super) toward: Ned,
    pub(super) wavenumber_rad_m: f64,
    depth_m: f64,
}

impl PlaneWave {
    fn new(component: Component, depth_m: f64) -> PlaneWave {
        let (east, north) = libm::sincos(component.toward_rad);
        let wavenumber_rad_m = wavenumber_rad_m(component.omega_rad_s, depth_m);
        PlaneWave {
            component,
            toward: Ned { north, east },
            wavenumber_rad_m,
            depth_m,
        }
    }

    /// k h; infinite in deep water.
    fn depth_rad(&self) -> f64 {
        self.wavenumber_rad_m * self.depth_m
    }

    /// Horizontal orbital velocity at a depth, over a ω: cosh k(z + h) / sinh k h.
    pub(super) fn orbital_at(&self, below_m: f64) -> f64 {
        // Use decaying exponentials, because sinh and cosh overflow in deep water.
        self.decay_at(below_m) / (1.0 - libm::exp(-2.0 * self.depth_rad()))
    }

    /// Wave pressure at a depth, over ρ g a: cosh k(z + h) / cosh k h.
    pub(super) fn pressure_at(&self, below_m: f64) -> f64 {
        self.decay_at(below_m) / (1.0 + libm::exp(-2.0 * self.depth_rad()))
    }

    /// 2 e^(−k h) cosh k(z + h).
    fn decay_at(&self, below_m: f64) -> f64 {
        let k = self.wavenumber_rad_m;
        // A boat may be placed in water shallower than its draught.
        let below_m = below_m.min(self.depth_m);
        libm::exp(-k * below_m) * (1.0 + libm::exp(-2.0 * k * (self.depth_m - below_m)))
    }

    /// Twice the ratio of group speed to phase speed, 1 + 2kh / sinh 2kh: 1 in deep water, 2 in
    /// shallow water.
    fn group_factor(&self) -> f64 {
        let twice = 2.0 * self.depth_rad();
        // Beyond this the quotient is less than 1e-15, and further on the hyperbolic sine
        // overflows.
        if twice > 40.0 {
            1.0
        } else {
            1.0 + twice / libm::sinh(twice)
        }
    }

    /// Stokes drift averaged over a draught, m/s.
    fn stokes_m_s(&self, draught_m: f64) -> f64 {
        let k = self.wavenumber_rad_m;
        let draught_m = draught_m.min(self.depth_m);
        let bottom = libm::exp(-2.0 * self.depth_rad());
        // Numerator: sinh 2kh − sinh 2k(h − T). The code divides both the numerator and sinh² k h
        // by e^(2kh) / 2.
        let at_keel = libm::exp(-2.0 * k * draught_m);
        let layer = (1.0 - at_keel) * (1.0 + bottom * bottom / at_keel);
        let a = self.component.amplitude_m;
        0.5 * a * a * self.component.omega_rad_s * layer
            / (draught_m * (1.0 - bottom) * (1.0 - bottom))
    }

    /// The square root of the part of a hull's drift force that depends on neither its length and
    /// beam nor the wave's direction: a R, from 1/2 ρ g a² R², where a hull of draught T reflects
    /// the fraction R = 1 − e^(−2kT) of the wave. Finite depth as in Longuet-Higgins (1977).
    pub(super) fn reflected_m(&self, draught_m: f64) -> f64 {
        let reflected = 1.0 - libm::exp(-2.0 * self.wavenumber_rad_m * draught_m);
        self.component.amplitude_m * reflected * self.group_factor().sqrt()
    }
}

/// The wavenumber with ω² = g k tanh k h; in deep water ω² = g k. `depth_m` may be infinite.
pub fn wavenumber_rad_m(omega_rad_s: f64, depth_m: f64) -> f64 {
    let deep = omega_rad_s * omega_rad_s / GRAVITY_M_S2;
    if deep * depth_m > 20.0 {
        // tanh is 1 to the last bit.
        return deep;
    }
    // Start from Eckart (1952), within 5 %, then take four or five steps of Newton's method. In
    // finite depth the dispersion relation has no closed solution.
    let mut k = deep / libm::tanh(deep * depth_m).sqrt();
    for _ in 0..20 {
        let tanh = libm::tanh(k * depth_m);
        let step = (k * tanh - deep) / (tanh + k * depth_m * (1.0 - tanh * tanh));
        k -= step;
        if step.abs() <= 1e-15 * k {
            break;
        }
    }
    k
}

/// Phases of sixteen components, in turns: they decrease by `per_s` and increase by `per_north_m`
/// and `per_east_m`.
///
/// After a day the phase of the fastest wave is about 10^5 turns, which an f64 stores to 10^-11
/// turns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Phases {
    start: Lanes<f64>,
    per_s: Lanes<f64>,
    per_north_m: Lanes<f64>,
    per_east_m: Lanes<f64>,
}

impl Phases {
    fn new(waves: &[PlaneWave]) -> Phases {
        Phases {
            start: Lanes(side_by_side(waves, |w| w.component.phase_rad / TAU)),
            per_s: Lanes(side_by_side(waves, |w| w.component.omega_rad_s / TAU)),
            per_north_m: Lanes(side_by_side(waves, |w| {
                w.wavenumber_rad_m * w.toward.north / TAU
            })),
            per_east_m: Lanes(side_by_side(waves, |w| {
                w.wavenumber_rad_m * w.toward.east / TAU
            })),
        }
    }

    /// Sine and cosine of the phases at a place and time.
    #[inline(always)]
    pub(super) fn sin_cos(&self, at: Ned, time_s: f64) -> (Lanes<f32>, Lanes<f32>) {
        sin_cos_turns(self.along(at) + (self.start - self.per_s * Lanes::<f64>::splat(time_s)))
    }

    /// The rate of the phases for a moving observer, rad/s: minus the frequency of encounter.
    #[inline(always)]
    pub(super) fn rate_rad_s(&self, velocity_m_s: Ned) -> Lanes<f32> {
        ((self.along(velocity_m_s) - self.per_s) * Lanes::<f64>::splat(TAU)).single()
    }

    /// The increase of the phases along a displacement.
    #[inline(always)]
    fn along(&self, way: Ned) -> Lanes<f64> {
        self.per_north_m * Lanes::<f64>::splat(way.north)
            + self.per_east_m * Lanes::<f64>::splat(way.east)
    }
}

/// `part` of each wave, up to the number of lanes. Lanes without a wave are 0.
pub(super) fn side_by_side<T: Default, const N: usize>(
    waves: &[PlaneWave],
    part: impl Fn(&PlaneWave) -> T,
) -> [T; N] {
    std::array::from_fn(|lane| waves.get(lane).map_or_else(T::default, &part))
}

/// [`side_by_side`] for one number of each of a row's waves, in single precision.
pub(super) fn row_of(waves: &[PlaneWave], part: impl Fn(&PlaneWave) -> f64) -> [f32; ROW] {
    side_by_side(waves, |w| part(w) as f32)
}

/// The number of rows for these waves, rounded up to fill all lanes.
pub(super) fn row_count(waves: &[PlaneWave]) -> usize {
    FOLD * waves.len().div_ceil(LANES)
}

/// Sixteen components side by side: everything independent of the heading.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<R> {
    pub(super) phases: Phases,
    pub(super) rows: [R; FOLD],
}

/// These waves in blocks, with rows made by `row`; the last rows have fewer waves or none.
pub(super) fn blocks<R>(waves: &[PlaneWave], row: impl Fn(&[PlaneWave]) -> R) -> Vec<Block<R>> {
    let block = |waves: &[PlaneWave]| Block {
        phases: Phases::new(waves),
        rows: std::array::from_fn(|i| row(waves.chunks(ROW).nth(i).unwrap_or_default())),
    };
    waves.chunks(LANES).map(block).collect()
}

/// The effect of four wave components on the surface: on its elevation, its slope to the north and
/// its slope to the east; and zero.
#[derive(Clone, Copy, Debug)]
struct SurfaceRow {
    per_cos: Lanes<f32>,
    per_sin: Lanes<f32>,
}

impl SurfaceRow {
    fn new(waves: &[PlaneWave]) -> SurfaceRow {
        let nothing = [0.0; ROW];
        let slope = |part: fn(Ned) -> f64| {
            row_of(waves, |w| {
                -w.component.amplitude_m * w.wavenumber_rad_m * part(w.toward)
            })
        };
        SurfaceRow {
            per_cos: Lanes::of_row([
                row_of(waves, |w| w.component.amplitude_m),
                nothing,
                nothing,
                nothing,
            ]),
            per_sin: Lanes::of_row([
                nothing,
                slope(|toward| toward.north),
                slope(|toward| toward.east),
                nothing,
            ]),
        }
    }
}

/// The surface at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Height above still water, m.
    pub elevation_m: f64,
    /// Gradient of the elevation: rise per metre to the north and to the east.
    pub slope: Ned,
}

/// The waves of a game.
#[derive(Clone, Debug)]
pub struct WaveField {
    pub(super) waves: Vec<PlaneWave>,
    pub(super) drift_factor: f64,
    pub(super) instructions: Instructions,
    blocks: Vec<Block<SurfaceRow>>,
}

impl WaveField {
    /// The field drawn from this spectrum by the seed's stream `waves`, in water of this depth
    /// (`None` is deep).
    pub fn new(waves: &Waves, depth_m: Option<f64>, seed: u64) -> WaveField {
        WaveField::of(
            &spectrum::components(waves, seed),
            depth_m,
            waves.drift_factor,
        )
    }

    /// The field of these components: a regular wave, or a sea measured elsewhere.
    pub fn of(components: &[Component], depth_m: Option<f64>, drift_factor: f64) -> WaveField {
        // Use an infinite depth rather than a merely large one: every formula above has a limit
        // there and needs no special case.
        let depth_m = depth_m.unwrap_or(f64::INFINITY);
        let waves: Vec<PlaneWave> = components
            .iter()
            .map(|c| PlaneWave::new(*c, depth_m))
            .collect();
        let blocks = blocks(&waves, SurfaceRow::new);
        WaveField {
            waves,
            drift_factor,
            instructions: Instructions::best(),
            blocks,
        }
    }

    /// Makes this field, and everything built from it, use these instructions. The choice affects
    /// only the speed.
    pub fn with_instructions(self, instructions: Instructions) -> WaveField {
        WaveField {
            instructions,
            ..self
        }
    }

    /// The components.
    pub fn components(&self) -> impl ExactSizeIterator<Item = &Component> {
        self.waves.iter().map(|w| &w.component)
    }

    /// The components for observers.
    pub fn plane_waves(&self) -> Vec<messages::water::PlaneWave> {
        let plane = |wave: &PlaneWave| messages::water::PlaneWave {
            amplitude_m: wave.component.amplitude_m,
            wavenumber_rad_m: wave.wavenumber_rad_m,
            toward_rad: wave.component.toward_rad,
            omega_rad_s: wave.component.omega_rad_s,
            phase_rad: wave.component.phase_rad,
        };
        self.waves.iter().map(plane).collect()
    }

    /// The surface at a place and time.
    pub fn surface(&self, at: Ned, time_s: f64) -> Surface {
        let sums = self.instructions.run(SurfaceAt {
            blocks: &self.blocks,
            at,
            time_s,
        });
        Surface {
            elevation_m: sums.sum(0),
            slope: Ned {
                north: sums.sum(1),
                east: sums.sum(2),
            },
        }
    }

    /// Significant wave height: four standard deviations of the elevation, m.
    pub fn hs_m(&self) -> f64 {
        4.0 * self.mean(|_| 1.0).sqrt()
    }

    /// Length of a wave of this period in this field's water, m.
    pub fn wavelength_m(&self, period_s: f64) -> f64 {
        let depth_m = self.waves.first().map_or(f64::INFINITY, |w| w.depth_m);
        TAU / wavenumber_rad_m(TAU / period_s, depth_m)
    }

    /// Standard deviation of the horizontal orbital velocity at the surface, both directions
    /// combined, m/s.
    pub fn orbital_rms_m_s(&self) -> f64 {
        self.mean(|w| {
            let per_m = w.component.omega_rad_s * w.orbital_at(0.0);
            per_m * per_m
        })
        .sqrt()
    }

    /// Root mean square of the gradient of the surface, as an angle, rad.
    pub fn slope_rms_rad(&self) -> f64 {
        libm::atan(
            self.mean(|w| w.wavenumber_rad_m * w.wavenumber_rad_m)
                .sqrt(),
        )
    }

    /// Stokes drift averaged over a hull's draught, m/s. At the depth z, a wave contributes a² ω k
    /// cosh 2k(z + h) / (2 sinh² k h).
    pub fn stokes_drift_m_s(&self, draught_m: f64) -> Ned {
        self.drift_m_s(|w| w.stokes_m_s(draught_m))
    }

    /// The part of Stokes drift that arises because water moves faster where it has risen: a² ω k
    /// sinh² k(z + h) / (2 sinh² k h), in deep water half of the total. A body that moves with the
    /// oscillating water experiences the other part anyway.
    pub fn rise_drift_m_s(&self, draught_m: f64) -> Ned {
        // cosh 2x = 2 sinh² x + 1.
        self.drift_m_s(|w| {
            let bottom = libm::exp(-2.0 * w.depth_rad());
            let a = w.component.amplitude_m;
            let flat = a * a * w.component.omega_rad_s * w.wavenumber_rad_m * bottom
                / ((1.0 - bottom) * (1.0 - bottom));
            0.5 * w.stokes_m_s(draught_m) - flat
        })
    }

    fn drift_m_s(&self, speed_m_s: impl Fn(&PlaneWave) -> f64) -> Ned {
        self.waves.iter().fold(Ned::default(), |drift, w| {
            drift + w.toward.scaled(speed_m_s(w))
        })
    }

    /// Mean second-order force on a hull on this heading, in body axes: the momentum that the waves
    /// lose by reflection (Maruo 1960), with the hull's sides and ends taken as walls:
    ///
    /// ```text
    /// X = sum 1/2 rho g a^2 R^2 B cos b |cos b|     Y = sum 1/2 rho g a^2 R^2 L sin b |sin b|     R = 1 - e^(-2kT)
    /// ```
    ///
    /// with b the angle between the heading and the wave's direction of travel. R is only a rough
    /// estimate of the hull's reflection, hence `drift_factor`.
    pub fn mean_drift_newton(
        &self,
        boat: &Boat,
        water_density_kg_m3: f64,
        heading_rad: f64,
    ) -> Planar {
        let travel = |wave: &PlaneWave| {
            let (sin, cos) = libm::sincos(wave.component.toward_rad - heading_rad);
            (cos, sin)
        };
        let parts = self
            .reflected_m(boat)
            .into_iter()
            .zip(self.waves.iter().map(travel));
        self.drift_of(boat, water_density_kg_m3, parts)
    }

    /// [`PlaneWave::reflected_m`] of each wave.
    pub(super) fn reflected_m(&self, boat: &Boat) -> Vec<f64> {
        self.waves
            .iter()
            .map(|wave| wave.reflected_m(boat.draught_m))
            .collect()
    }

    /// Like [`WaveField::mean_drift_newton`], given each wave's reflected part and its direction of
    /// travel in body axes.
    pub(super) fn drift_of(
        &self,
        boat: &Boat,
        water_density_kg_m3: f64,
        waves: impl Iterator<Item = (f64, (f64, f64))>,
    ) -> Planar {
        let mut surge = 0.0;
        let mut sway = 0.0;
        for (reflected_m, (cos, sin)) in waves {
            surge += reflected_m * reflected_m * cos * cos.abs();
            sway += reflected_m * reflected_m * sin * sin.abs();
        }
        let scale = self.drift_factor * 0.5 * water_density_kg_m3 * GRAVITY_M_S2;
        Planar {
            surge: scale * boat.beam_m * surge,
            sway: scale * boat.length_m * sway,
            yaw: 0.0,
        }
    }

    /// The variance of a quantity with the amplitude `per_m` for each metre of wave amplitude,
    /// given the square of `per_m`.
    fn mean(&self, per_m_squared: impl Fn(&PlaneWave) -> f64) -> f64 {
        self.waves
            .iter()
            .map(|w| 0.5 * w.component.amplitude_m * w.component.amplitude_m * per_m_squared(w))
            .sum()
    }
}

/// Sums over the rows: elevation and slopes at a place and time.
struct SurfaceAt<'a> {
    blocks: &'a [Block<SurfaceRow>],
    at: Ned,
    time_s: f64,
}

impl Kernel for SurfaceAt<'_> {
    type Output = Lanes<f32>;

    #[inline(always)]
    fn run(self) -> Lanes<f32> {
        let mut sums = Lanes::<f32>::splat(0.0);
        for block in self.blocks {
            let (sin, cos) = block.phases.sin_cos(self.at, self.time_s);
            for (i, row) in block.rows.iter().enumerate() {
                sums += row.per_cos * cos.row(i) + row.per_sin * sin.row(i);
            }
        }
        sums
    }
}
