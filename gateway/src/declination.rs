//! Declination: the angle of magnetic north east of true north, from the World Magnetic Model of
//! 2025.
//!
//! The model covers only the field of the earth's core. In some places, iron in the ground deflects
//! a compass by several more degrees, and a boat's compass has its own errors.

use crate::nmea::Date;
use primitives::LatLon;
use thiserror::Error;
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::{self, Month};
use world_magnetic_model::uom::si::angle::degree;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;

/// First and last year of WMM2025.
// The declination changes from year to year, and the model covers five years. Later dates are
// rejected rather than extrapolated; the file can state the declination instead.
const YEARS: (u16, u16) = (2025, 2029);

/// Why the declination is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum DeclinationError {
    /// The model does not cover this date.
    #[error("the magnetic model does not cover {}-{:02}-{:02}, expected a date from 2025 to 2029", .0.year, .0.month, .0.day)]
    Date(Date),
    /// The position is not on the globe.
    #[error("{}, {} is not on the globe, expected latitude -90 to 90 and longitude -180 to 180", .0.lat_deg, .0.lon_deg)]
    Position(LatLon),
}

/// Degrees from true to magnetic north at the ellipsoid's surface, east positive: true = magnetic +
/// declination.
///
/// # Errors
/// [`DeclinationError`] for a date before 2025 or after 2029, or a position off the globe.
pub fn declination_deg(at: LatLon, date: Date) -> Result<f64, DeclinationError> {
    let day = day(date).ok_or(DeclinationError::Date(date))?;
    // The model uses single precision, which is accurate to 1 m of position, far below its own
    // error.
    let lat = Angle::new::<degree>(at.lat_deg as f32);
    let lon = Angle::new::<degree>(at.lon_deg as f32);
    let field = GeomagneticField::new(Length::new::<meter>(0.0), lat, lon, day);
    let field = field.map_err(|_| DeclinationError::Position(at))?;
    Ok(f64::from(field.declination().get::<degree>()))
}

/// The date in the model's format, if the model covers it.
fn day(date: Date) -> Option<time::Date> {
    let month = Month::try_from(date.month).ok()?;
    let day = time::Date::from_calendar_date(i32::from(date.year), month, date.day).ok()?;
    // The crate also contains the model of 2020, which is based on older measurements.
    (YEARS.0..=YEARS.1).contains(&date.year).then_some(day)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lat_deg: f64, lon_deg: f64) -> LatLon {
        LatLon { lat_deg, lon_deg }
    }

    fn on(year: u16, month: u8, day: u8) -> Date {
        Date { year, month, day }
    }

    #[test]
    fn published_values_of_the_model_are_met() {
        for line in include_str!("declination.csv").lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            let day: Vec<u16> = cells[2]
                .split('-')
                .map(|part| part.parse().unwrap())
                .collect();
            let date = on(day[0], day[1] as u8, day[2] as u8);
            let got_deg = declination_deg(at(number(0), number(1)), date).unwrap();
            assert!(
                (got_deg - number(3)).abs() <= number(4),
                "{line}: {got_deg}"
            );
        }
    }

    #[test]
    fn the_model_holds_for_five_years() {
        for (date, known) in [
            (on(2024, 12, 31), false),
            (on(2025, 1, 1), true),
            (on(2028, 2, 29), true),
            (on(2029, 12, 31), true),
            (on(2030, 1, 1), false),
            (on(2026, 2, 29), false),
            (on(2026, 13, 1), false),
            (on(2026, 0, 0), false),
        ] {
            let got = declination_deg(at(42.0, -71.0), date);
            assert_eq!(got.is_ok(), known, "{date:?}");
            assert_eq!(got.err(), (!known).then_some(DeclinationError::Date(date)));
        }
    }

    #[test]
    fn a_position_off_the_globe_is_refused() {
        for (lat_deg, lon_deg) in [
            (90.1, 0.0),
            (0.0, 180.1),
            (f64::NAN, 0.0),
            (0.0, f64::INFINITY),
        ] {
            let error = declination_deg(at(lat_deg, lon_deg), on(2026, 1, 1)).unwrap_err();
            assert!(error.to_string().contains("is not on the globe"), "{error}");
        }
        for pole_deg in [-90.0, 90.0] {
            assert!(
                declination_deg(at(pole_deg, 0.0), on(2026, 1, 1))
                    .unwrap()
                    .is_finite()
            );
        }
    }
}
