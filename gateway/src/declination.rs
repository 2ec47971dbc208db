//! Declination: how far a compass points east of true north, by the World Magnetic Model of 2025.
//!
//! The model is one of the earth's core. Iron in the ground turns a compass by some degrees more in places, and
//! the compass of a boat has its own faults.

use crate::nmea::Date;
use game::LatLon;
use thiserror::Error;
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::{self, Month};
use world_magnetic_model::uom::si::angle::degree;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;

/// Years of WMM2025, both included.
const YEARS: (u16, u16) = (2025, 2029);

/// Why there is no declination.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum DeclinationError {
    /// The model does not hold then.
    #[error("the magnetic model does not know {}-{:02}-{:02}, expected a date from 2025 to 2029", .0.year, .0.month, .0.day)]
    Date(Date),
    /// Not a place on earth.
    #[error("{}, {} is no place on earth, expected latitude -90 to 90 and longitude -180 to 180", .0.lat_deg, .0.lon_deg)]
    Position(LatLon),
}

/// Degrees from true to magnetic north at the ellipsoid's surface, east positive: true = magnetic + declination.
///
/// # Errors
/// [`DeclinationError`] for a date before 2025 or after 2029, or a position off the globe.
pub fn declination_deg(at: LatLon, date: Date) -> Result<f64, DeclinationError> {
    let day = day(date).ok_or(DeclinationError::Date(date))?;
    // The model is in single precision: 1 m of position, far finer than it is right.
    let (lat, lon) = (Angle::new::<degree>(at.lat_deg as f32), Angle::new::<degree>(at.lon_deg as f32));
    let field = GeomagneticField::new(Length::new::<meter>(0.0), lat, lon, day);
    let field = field.map_err(|_| DeclinationError::Position(at))?;
    Ok(f64::from(field.declination().get::<degree>()))
}

/// The date as the model takes it, if it is one that the model is for.
fn day(date: Date) -> Option<time::Date> {
    let month = Month::try_from(date.month).ok()?;
    let day = time::Date::from_calendar_date(i32::from(date.year), month, date.day).ok()?;
    // The crate knows the model of 2020 too, which was made with older measurements.
    (YEARS.0..=YEARS.1).contains(&date.year).then_some(day)
}
