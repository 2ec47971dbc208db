//! A field laid on the globe: metres north and east of a datum, and back to latitude and longitude.
//!
//! Distance and azimuth are those of the geodesic from the datum on the WGS 84 ellipsoid (Karney 2013, by
//! geographiclib): the azimuthal equidistant map. Everything on one bearing from the datum is on one line, at its
//! true distance.
//!
//! - A plane that touches the ellipsoid at the datum (ENU) is `s^3 / 6 R^2` shorter: 4 um at 1 km, 4 mm at 10 km.
//! - MOOS's `LatLong2LocalGrid` uses a sphere with the ellipsoid's radius at that latitude, and is not this map:
//!   200 m from a datum at 42 degrees north it is 0.4 m off. Boats that share a field must share the map.

use game::{LatLon, Ned, math};
use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};

/// The map of one field.
#[derive(Clone, Debug)]
pub struct LocalFrame {
    datum: LatLon,
    earth: Geodesic,
}

impl LocalFrame {
    /// The map around `datum`.
    #[must_use]
    pub fn new(datum: LatLon) -> LocalFrame {
        LocalFrame { datum, earth: Geodesic::wgs84() }
    }

    /// Where (0, 0) is.
    #[must_use]
    pub fn datum(&self) -> LatLon {
        self.datum
    }

    /// Metres from the datum; not a number for what is no position.
    #[must_use]
    pub fn ned(&self, at: LatLon) -> Ned {
        let (LatLon { lat_deg, lon_deg }, datum) = (at, self.datum);
        let (distance_m, azimuth_deg, _): (f64, f64, f64) =
            self.earth.inverse(datum.lat_deg, datum.lon_deg, lat_deg, lon_deg);
        Ned::toward_deg(azimuth_deg).scaled(distance_m)
    }

    /// The position of a point of the field, longitude in -180 to 180.
    #[must_use]
    pub fn lat_lon(&self, at: Ned) -> LatLon {
        let azimuth_deg = math::atan2(at.east, at.north).to_degrees();
        let (lat_deg, lon_deg) = self.earth.direct(self.datum.lat_deg, self.datum.lon_deg, azimuth_deg, at.length());
        LatLon { lat_deg, lon_deg }
    }
}
