//! Places a field on the globe: converts metres north and east of a datum to latitude and
//! longitude, and back.
//!
//! Distance and azimuth are those of the geodesic from the datum on the WGS 84 ellipsoid (Karney
//! 2013, by geographiclib): the azimuthal equidistant map. All points on one bearing from the datum
//! lie on a straight line, at their true distances.
//!
//! - On a plane that touches the ellipsoid at the datum (ENU), distances are `s^3 / 6 R^2` shorter:
//!   4 µm at 1 km, 4 mm at 10 km.
//! - MOOS's `LatLong2LocalGrid` is a different map, of a sphere with the ellipsoid's radius at the
//!   position's latitude: 200 m from a datum at 42 degrees north, the two differ by 0.4 m. Boats on
//!   one field must use the same map.

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use primitives::{LatLon, Ned};

/// The map of one field.
#[derive(Clone, Debug)]
pub struct LocalFrame {
    datum: LatLon,
    earth: Geodesic,
}

impl LocalFrame {
    /// The map around `datum`.
    pub fn new(datum: LatLon) -> LocalFrame {
        // geographiclib rather than a tangent plane of our own, which would be accurate enough for
        // a field but would need its own tests.
        LocalFrame {
            datum,
            earth: Geodesic::wgs84(),
        }
    }

    /// Metres from the datum; non-finite for a position off the globe.
    pub fn ned(&self, at: LatLon) -> Ned {
        let LatLon { lat_deg, lon_deg } = at;
        let datum = self.datum;
        let (distance_m, azimuth_deg, _, _): (f64, f64, f64, f64) =
            self.earth
                .inverse(datum.lat_deg, datum.lon_deg, lat_deg, lon_deg);
        Ned::toward_deg(azimuth_deg).scaled(distance_m)
    }

    /// The position of a point of the field, longitude from -180 to 180.
    pub fn lat_lon(&self, at: Ned) -> LatLon {
        let azimuth_deg = at.direction_rad().to_degrees();
        let (lat_deg, lon_deg) = self.earth.direct(
            self.datum.lat_deg,
            self.datum.lon_deg,
            azimuth_deg,
            at.length(),
        );
        LatLon { lat_deg, lon_deg }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::math;
    use proptest::prelude::*;

    /// The datum of MIT's missions, a pavilion.
    const PAVILION: LatLon = LatLon {
        lat_deg: 42.358436,
        lon_deg: -71.087448,
    };

    /// A tenth of the width of a hair.
    const HAIR_M: f64 = 1e-5;

    /// A point on the plane that touches the ellipsoid at the datum, computed in earth-centred
    /// coordinates.
    fn tangent(datum: LatLon, at: LatLon) -> Ned {
        let equator_m = 6_378_137.0;
        let flattening = 1.0 / 298.257_223_563;
        let e2 = flattening * (2.0 - flattening);
        let sin_cos = |at: LatLon| (math::sin_cos_deg(at.lat_deg), math::sin_cos_deg(at.lon_deg));
        let from_centre = |at: LatLon| {
            let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = sin_cos(at);
            let normal_m = equator_m / (1.0 - e2 * sin_lat * sin_lat).sqrt();
            [
                normal_m * cos_lat * cos_lon,
                normal_m * cos_lat * sin_lon,
                normal_m * (1.0 - e2) * sin_lat,
            ]
        };
        let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = sin_cos(datum);
        let there = from_centre(at);
        let here = from_centre(datum);
        let [x, y, z] = std::array::from_fn(|i| there[i] - here[i]);
        let north = -sin_lat * cos_lon * x - sin_lat * sin_lon * y + cos_lat * z;
        Ned {
            north,
            east: -sin_lon * x + cos_lon * y,
        }
    }

    /// `CMOOSGeodesy::LatLong2LocalGrid`, which boats with a MOOS back seat use for their position.
    fn moos(datum: LatLon, at: LatLon) -> Ned {
        let a = 6_378_137.0_f64;
        let b = 6_356_752.0_f64;
        let (sin_lat, cos_lat) = math::sin_cos_deg(at.lat_deg);
        let tan2 = (sin_lat / cos_lat) * (sin_lat / cos_lat);
        let radius_m = b * (1.0 + tan2).sqrt() / ((b * b) / (a * a) + tan2).sqrt();
        let north = at.lat_deg - datum.lat_deg;
        let east = at.lon_deg - datum.lon_deg;
        let sin = |angle_deg: f64| math::sin_cos_deg(angle_deg).0;
        Ned {
            north: radius_m * sin(north),
            east: radius_m * sin(east) * cos_lat,
        }
    }

    #[test]
    fn a_point_195_m_north_east_agrees_with_enu_and_not_with_moos() {
        let at = LatLon {
            lat_deg: 42.3597,
            lon_deg: -71.0858,
        };
        let got = LocalFrame::new(PAVILION).ned(at);
        let published = Ned {
            north: 140.407,
            east: 135.766,
        };
        assert!(got.distance(published) < 0.001, "{got:?}");
        assert!(got.distance(tangent(PAVILION, at)) < HAIR_M, "{got:?}");
        let by_moos = moos(PAVILION, at);
        assert!(
            by_moos.distance(Ned {
                north: 140.493,
                east: 135.353
            }) < 0.001,
            "{by_moos:?}"
        );
        assert!(
            (got.distance(by_moos) - 0.42).abs() < 0.01,
            "{}",
            got.distance(by_moos)
        );
    }

    #[test]
    fn the_tangent_plane_is_shorter_by_a_cube() {
        let frame = LocalFrame::new(PAVILION);
        for (distance_m, shorter_m) in [(1_000.0, 4e-6), (10_000.0, 4e-3)] {
            for bearing_deg in [0.0, 40.0, 90.0, 200.0, 300.0] {
                let ned = Ned::toward_deg(bearing_deg).scaled(distance_m);
                let plane = tangent(PAVILION, frame.lat_lon(ned));
                let got_m = ned.length() - plane.length();
                assert!(
                    (got_m - shorter_m).abs() < 0.1 * shorter_m,
                    "{distance_m} m to {bearing_deg}: {got_m}"
                );
            }
        }
    }

    #[test]
    fn the_datum_is_zero_and_an_invalid_position_is_non_finite() {
        let frame = LocalFrame::new(PAVILION);
        assert_eq!(frame.ned(PAVILION).length(), 0.0);
        let back = frame.lat_lon(Ned::default());
        let apart_deg =
            (back.lat_deg - PAVILION.lat_deg).abs() + (back.lon_deg - PAVILION.lon_deg).abs();
        assert!(apart_deg < 1e-13, "{back:?}");
        for (lat_deg, lon_deg) in [
            (f64::NAN, 0.0),
            (0.0, f64::NAN),
            (f64::INFINITY, 0.0),
            (0.0, f64::INFINITY),
        ] {
            assert!(
                !frame.ned(LatLon { lat_deg, lon_deg }).is_finite(),
                "{lat_deg}, {lon_deg}"
            );
        }
        let nowhere = frame.lat_lon(Ned {
            north: f64::NAN,
            east: 0.0,
        });
        assert!(!nowhere.lat_deg.is_finite(), "{nowhere:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn there_and_back_is_within_a_micrometre(
            lat_deg in -85.0..85.0,
            lon_deg in prop_oneof![-180.0..180.0, 179.9..180.0, -180.0..-179.9],
            bearing_deg in 0.0..360.0,
            distance_m in prop_oneof![0.0..10.0, 0.0..10_000.0],
        ) {
            let frame = LocalFrame::new(LatLon { lat_deg, lon_deg });
            let ned = Ned::toward_deg(bearing_deg).scaled(distance_m);
            let at = frame.lat_lon(ned);
            prop_assert!((-180.0..=180.0).contains(&at.lon_deg), "{at:?}");
            let back = frame.ned(at);
            prop_assert!(back.distance(ned) < 1e-6, "{ned:?} -> {at:?} -> {back:?}");
            let plane = tangent(frame.datum, at);
            prop_assert!(back.distance(plane) < 0.0045, "{back:?} in the plane is {plane:?}");
        }
    }
}
