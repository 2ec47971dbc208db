//! CSV tables. Columns are recognised by their names or mapped by the user.

use crate::{Found, ImportError, Quantity, file_error};
use primitives::LatLon;
use primitives::math::sin_cos_deg;
use recording::logs::name_of;
use std::path::Path;
use std::str::FromStr;
use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;
use trial::{Sheet, plain_head};

/// The meanings of columns: the name in `--map`, the names that loggers use (in lower case, without
/// a unit), and the unit assumed if neither the map nor the column's name states one. For times
/// without a unit, the magnitude of each value determines it.
const MEANINGS: [(&str, &[&str], &str); 15] = [
    (
        "t",
        &[
            "t",
            "time",
            "timestamp",
            "epoch",
            "utc",
            "datetime",
            "date_time",
        ],
        "",
    ),
    ("boat", &["boat", "vehicle", "name", "id"], ""),
    ("lat", &["lat", "latitude"], "deg"),
    ("lon", &["lon", "lng", "long", "longitude"], "deg"),
    ("x", &["x", "east", "easting"], "m"),
    ("y", &["y", "north", "northing"], "m"),
    ("height", &["height", "altitude", "alt"], "m"),
    (
        "heading",
        &["heading", "hdg", "hdt", "true_heading", "yaw"],
        "deg",
    ),
    ("course", &["course", "cog"], "deg"),
    ("speed", &["speed", "sog", "ground_speed"], "m_s"),
    ("surge", &["surge"], "m_s"),
    ("sway", &["sway"], "m_s"),
    ("yaw_rate", &["yaw_rate", "rot"], "deg_s"),
    ("port", &["port"], "pct"),
    ("starboard", &["starboard"], "pct"),
];

/// Units, each with the factor that converts it to the unit used here: s, m, m/s, degrees, degrees
/// per second or per cent.
const UNITS: [(&str, f64); 18] = [
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("ns", 1e-9),
    ("deg", 1.0),
    ("degrees", 1.0),
    ("rad", 57.295_779_513_082_32),
    ("m", 1.0),
    ("km", 1000.0),
    ("m_s", 1.0),
    ("kn", 1852.0 / 3600.0),
    ("knots", 1852.0 / 3600.0),
    ("km_h", 1.0 / 3.6),
    ("deg_s", 1.0),
    ("deg_min", 1.0 / 60.0),
    ("rad_s", 57.295_779_513_082_32),
    ("pct", 1.0),
    ("fraction", 100.0),
];

/// The meanings of a table's columns: `speed=SOG:kn,heading=HDT:deg,t=epoch_ms`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map(Vec<Mapped>);

#[derive(Clone, Debug, PartialEq)]
struct Mapped {
    meaning: &'static str,
    /// The column's name, as typed.
    column: String,
    factor: Option<f64>,
}

impl FromStr for Map {
    type Err = String;

    fn from_str(text: &str) -> Result<Map, String> {
        let mapped = |entry: &str| -> Result<Mapped, String> {
            let Some((wanted, column)) = entry.split_once('=') else {
                return Err(format!(
                    "{entry:?}: expected MEANING=COLUMN or MEANING=COLUMN:UNIT"
                ));
            };
            let meaning = MEANINGS.iter().find(|(name, ..)| *name == wanted.trim());
            let Some((meaning, ..)) = meaning else {
                let known: Vec<&str> = MEANINGS.iter().map(|(name, ..)| *name).collect();
                return Err(format!(
                    "unknown meaning {wanted:?}; expected {}",
                    known.join(", ")
                ));
            };
            let (column, unit) = column.split_once(':').unwrap_or((column, ""));
            let factor = if unit.is_empty() {
                None
            } else {
                let unit = plain_head(unit);
                let factor = factor_of(&unit).ok_or_else(|| {
                    let known: Vec<&str> = UNITS.iter().map(|(name, _)| *name).collect();
                    format!("unknown unit {unit:?}; expected {}", known.join(", "))
                })?;
                Some(factor)
            };
            Ok(Mapped {
                meaning,
                column: column.trim().to_owned(),
                factor,
            })
        };
        let entries = text.split(',').filter(|entry| !entry.trim().is_empty());
        entries.map(mapped).collect::<Result<_, _>>().map(Map)
    }
}

fn factor_of(unit: &str) -> Option<f64> {
    UNITS
        .iter()
        .find(|(name, _)| *name == unit)
        .map(|(_, factor)| *factor)
}

/// A column of the table.
#[derive(Clone, Copy)]
struct Column {
    index: usize,
    /// Factor that converts to the unit used here; `None` if the unit is unknown.
    factor: Option<f64>,
}

/// Finds the column with a meaning: the mapped one, or else one with a usual name, with or without
/// a unit.
fn find(sheet: &Sheet, map: Option<&Map>, wanted: &str) -> Result<Option<Column>, ImportError> {
    let heads = sheet.heads();
    let (_, names, default) = MEANINGS
        .iter()
        .find(|(name, ..)| *name == wanted)
        .expect("a meaning of the table above");
    // The unit at the end of a column's name, preferring the longest: `m_s` rather than `s`.
    let unit_of = |head: &str| {
        let units = UNITS.iter().filter(|(unit, _)| {
            head.strip_suffix(unit)
                .is_some_and(|rest| rest.ends_with('_'))
        });
        units.max_by_key(|(unit, _)| unit.len()).copied()
    };
    let default = factor_of(default);
    let mapped = map.and_then(|map| map.0.iter().rfind(|mapped| mapped.meaning == wanted));
    if let Some(mapped) = mapped {
        let head = plain_head(&mapped.column);
        let index = sheet.column(&head).ok_or_else(|| {
            let message = format!(
                "no column {:?} for {wanted}; columns found: {}",
                mapped.column,
                heads.join(", ")
            );
            sheet.mistake(Some(1), message)
        })?;
        let named = unit_of(&head).map(|(_, factor)| factor);
        let factor = mapped.factor.or(named).or(default);
        return Ok(Some(Column { index, factor }));
    }
    let usual = heads.iter().enumerate().find_map(|(index, head)| {
        let unit = unit_of(head);
        let bare = unit.map_or(head.as_str(), |(unit, _)| {
            head[..head.len() - unit.len()].trim_end_matches('_')
        });
        let factor = unit.map(|(_, factor)| factor).or(default);
        let is_usual = names.contains(&bare) || names.contains(&head.as_str());
        is_usual.then_some(Column { index, factor })
    });
    Ok(usual)
}

/// The columns that are read as numbers.
const NUMBERS: [(&str, Quantity); 8] = [
    ("x", Quantity::X),
    ("y", Quantity::Y),
    ("height", Quantity::Height),
    ("heading", Quantity::Heading),
    ("surge", Quantity::Surge),
    ("sway", Quantity::Sway),
    ("yaw_rate", Quantity::YawRate),
    ("port", Quantity::Port),
];

pub(crate) fn read(path: &Path, boat: &str, map: Option<&Map>) -> Result<Found, ImportError> {
    let file = primitives::input_file::open(path).map_err(|error| file_error(path, error))?;
    let sheet = Sheet::read(&path.display().to_string(), file)?;
    let column = |wanted| find(&sheet, map, wanted);
    let Some(time) = column("t")? else {
        let message = format!(
            "no time column; name one with --map t=COLUMN; columns found: {}",
            sheet.heads().join(", ")
        );
        return Err(sheet.mistake(Some(1), message).into());
    };
    let name = column("boat")?;
    let place = column("lat")?.zip(column("lon")?);
    let (speed, course) = (column("speed")?, column("course")?);
    let mut numbers = vec![];
    for (wanted, quantity) in NUMBERS
        .into_iter()
        .chain([("starboard", Quantity::Starboard)])
    {
        numbers.extend(column(wanted)?.map(|column| (column, quantity)));
    }
    let mut found = Found {
        has_utc: true,
        ..Found::default()
    };
    for row in 0..sheet.rows() {
        let number = |column: Column| -> Result<Option<f64>, ImportError> {
            if sheet.is_missing(row, column.index) {
                return Ok(None);
            }
            let number = sheet.number(row, column.index, (-1e19, 1e19))?;
            Ok(Some(column.factor.unwrap_or(1.0) * number))
        };
        let at_s = match sheet.number(row, time.index, (-1e19, 1e19)) {
            Ok(number) => number * time.factor.unwrap_or_else(|| second_per_unit(number)),
            Err(_) => date_and_time(sheet.text(row, time.index)).ok_or_else(|| {
                let message = format!(
                    "{} is {:?}, expected a number, or a date and time such as 2026-05-01T12:00:00Z",
                    sheet.heads()[time.index],
                    sheet.text(row, time.index)
                );
                sheet.mistake(sheet.line(row), message)
            })?,
        };
        found.has_utc &= at_s > 1e8;
        let named = name.map(|name| name_of(sheet.text(row, name.index)));
        let boat = named
            .as_deref()
            .filter(|name| !name.is_empty())
            .unwrap_or(boat);
        for (column, quantity) in &numbers {
            if let Some(value) = number(*column)? {
                found.logs.push(boat, *quantity, 0, (at_s, value));
            }
        }
        if let Some((lat, lon)) = place
            && let (Some(lat_deg), Some(lon_deg)) = (number(lat)?, number(lon)?)
        {
            let at = LatLon { lat_deg, lon_deg };
            found.positions.push(boat, 0, at_s, at);
        }
        if let Some(speed) = speed.map_or(Ok(None), number)? {
            match course.map_or(Ok(None), number)? {
                Some(course_deg) => {
                    let (sin, cos) = sin_cos_deg(course_deg);
                    found
                        .logs
                        .push(boat, Quantity::North, 0, (at_s, speed * cos));
                    found
                        .logs
                        .push(boat, Quantity::East, 0, (at_s, speed * sin));
                }
                None => found.logs.push(boat, Quantity::Speed, 0, (at_s, speed)),
            }
        }
    }
    let notes = sheet.notes().iter().map(ToString::to_string);
    found.notes.extend(notes);
    if !found.has_utc {
        let note = "times are not UTC; they count from an unknown moment";
        found.notes.push(note.to_owned());
    }
    Ok(found)
}

/// Seconds per unit of a time that states no unit, guessed from its magnitude. Large numbers are
/// assumed to be UNIX times of this century.
fn second_per_unit(number: f64) -> f64 {
    match number.abs() {
        size if size > 1e17 => 1e-9,
        size if size > 1e14 => 1e-6,
        size if size > 1e11 => 1e-3,
        _ => 1.0,
    }
}

/// A time written as a number or as a date and time, s.
pub(crate) fn time_of(text: &str) -> Option<f64> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    let number = number.map(|number| number * second_per_unit(number));
    number.or_else(|| date_and_time(text))
}

/// Converts a date and time in ISO 8601 to s since 1970. Without an offset, it is in UTC.
fn date_and_time(text: &str) -> Option<f64> {
    let text = text.trim();
    let with_offset = OffsetDateTime::parse(&text.replacen(' ', "T", 1), &Rfc3339);
    let at = with_offset.ok().or_else(|| {
        // Without an offset.
        let text = format!("{}Z", text.replacen(' ', "T", 1));
        OffsetDateTime::parse(&text, &Rfc3339).ok()
    })?;
    Some(1e-9 * at.unix_timestamp_nanos() as f64)
}
