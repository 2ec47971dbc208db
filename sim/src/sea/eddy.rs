//! An eddy in the water: the vortex of Lamb and Oseen.
//!
//! v(r) = Γ / (2 π r) (1 − exp(−r² / a²)), clockwise seen from above where Γ > 0. The flow is fastest at r = √α a with
//! e^α = 1 + 2 α, α = 1.2564, where it is Γ / (2 π a) (1 − e^−α) / √α.

use game::Field;
use game::frame::Ned;
use game::sea::{EddiesByLot, Eddy};
use game::stream::Stream;

/// The root of e^α = 1 + 2 α other than 0.
pub const ALPHA: f64 = 1.256_431_208_626_169_7;
/// From where on e^−s is less than half the last bit of 1.
const FAR: f64 = 40.0;

/// An eddy, ready for computing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vortex {
    centre: Ned,
    /// 1 / a².
    per_radius_squared: f64,
    /// Γ / (2 π a²): the rate at which the core turns, rad/s clockwise.
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

    /// The water's velocity, m/s.
    #[inline]
    pub(super) fn at(&self, place: Ned) -> Ned {
        let from_centre = place - self.centre;
        let s = from_centre.dot(from_centre) * self.per_radius_squared;
        let rate = if s == 0.0 {
            self.core_rad_s
        } else if s > FAR {
            self.core_rad_s / s
        } else {
            -self.core_rad_s * libm::expm1(-s) / s
        };
        Ned { north: -rate * from_centre.east, east: rate * from_centre.north }
    }
}

/// Eddies drawn from the stream `eddies` of this seed: evenly over the field, turning either way.
#[must_use]
pub fn draw(lot: &EddiesByLot, field: &Field, seed: u64) -> Vec<Eddy> {
    let mut stream = Stream::new(seed, "eddies");
    let draw_one = |_| {
        let along_m = stream.between(0.0, field.plan.width_m);
        let across_m = stream.between(0.0, field.plan.depth_m);
        let radius_m = stream.between(lot.radius_m.0, lot.radius_m.1);
        let peak_m_s = stream.between(lot.peak_m_s.0, lot.peak_m_s.1);
        let sense = if stream.bits() & 1 == 0 { 1.0 } else { -1.0 };
        Eddy { centre: field.at(along_m, across_m), radius_m, peak_m_s: sense * peak_m_s }
    };
    (0..lot.count).map(draw_one).collect()
}
