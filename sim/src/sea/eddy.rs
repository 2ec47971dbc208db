//! An eddy: the Lamb-Oseen vortex.
//!
//! v(r) = Γ / (2 π r) (1 − exp(−r² / a²)), clockwise seen from above for Γ > 0. The flow is fastest
//! at r = √α a with e^α = 1 + 2 α, α = 1.2564, where it is Γ / (2 π a) (1 − e^−α) / √α.

use primitives::frame::Ned;
use primitives::stream::Stream;
use rules::Field;
use scenario::sea::{Eddy, RandomEddies};

/// The root of e^α = 1 + 2 α other than 0.
pub const ALPHA: f64 = 1.256_431_208_626_169_7;
/// Value of s beyond which e^−s is less than half the last bit of 1.
const FAR: f64 = 40.0;

/// An eddy with precomputed constants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vortex {
    centre: Ned,
    /// 1 / a².
    per_radius_squared: f64,
    /// Γ / (2 π a²): the rotation rate of the core, rad/s clockwise.
    core_rad_s: f64,
}

impl Vortex {
    pub(super) fn new(eddy: &Eddy) -> Vortex {
        let fastest = -libm::expm1(-ALPHA) / ALPHA.sqrt();
        Vortex {
            centre: eddy.centre,
            per_radius_squared: 1.0 / (eddy.radius_m * eddy.radius_m),
            core_rad_s: eddy.peak_m_s / (fastest * eddy.radius_m),
        }
    }

    /// The water's velocity, m/s, and the rate at which it turns a line along the unit vector
    /// `ahead`, rad/s clockwise.
    ///
    /// Let v = g(s) J d, where d is the vector from the centre, J a quarter turn, and s = d² / a².
    /// Along a unit vector h, the flow across it grows by g + 2 s g' (d·h)² / d² per metre. For a
    /// core rotating at c, s g' = c e^−s − g.
    #[inline]
    pub(super) fn over(&self, place: Ned, ahead: Ned) -> (Ned, f64) {
        let from_centre = place - self.centre;
        let squared = from_centre.dot(from_centre);
        let s = squared * self.per_radius_squared;
        // The fraction of the circulation inside this radius. Use `expm1` instead of `1 - exp`: in
        // the core all digits would cancel.
        let share = if s > FAR { 1.0 } else { -libm::expm1(-s) };
        // The water's angular rate around the centre, rad/s.
        let rate = if s == 0.0 {
            self.core_rad_s
        } else {
            self.core_rad_s * share / s
        };
        let along = from_centre.dot(ahead);
        let fade = if squared == 0.0 {
            0.0
        } else {
            2.0 * (self.core_rad_s * (1.0 - share) - rate) / squared
        };
        let velocity = Ned {
            north: -rate * from_centre.east,
            east: rate * from_centre.north,
        };
        (velocity, rate + fade * along * along)
    }
}

/// Draws eddies from the stream `eddies` of this seed: uniform over the field, with random
/// directions of rotation.
pub fn draw(random: &RandomEddies, field: &Field, seed: u64) -> Vec<Eddy> {
    let mut stream = Stream::new(seed, "eddies");
    let draw_one = |_| {
        let along_m = stream.between(0.0, field.plan.width_m);
        let across_m = stream.between(0.0, field.plan.depth_m);
        let radius_m = stream.between(random.radius_m.0, random.radius_m.1);
        let peak_m_s = stream.between(random.peak_m_s.0, random.peak_m_s.1);
        // Draw all numbers of an eddy, even from a range with a single value, so that fixing a
        // value does not move the next eddy.
        let sense = if stream.bits() & 1 == 0 { 1.0 } else { -1.0 };
        Eddy {
            centre: field.at(along_m, across_m),
            radius_m,
            peak_m_s: sense * peak_m_s,
        }
    };
    (0..random.count).map(draw_one).collect()
}
