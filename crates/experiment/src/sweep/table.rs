//! The table of games: one line of CSV per game as it is played, and all of them as Parquet.

use super::metric::{METRICS, Metrics};
use super::plan::{Job, Plan};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use std::sync::Arc;

/// The record of a game.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The game's place in the plan.
    pub job: Job,
    /// The number of boats in the game.
    pub boats: usize,
    /// Digest of the final state and all events, in hex; empty if the game could not start.
    pub digest: String,
    /// The measurements, or why the game could not start.
    pub result: Result<Metrics, String>,
}

/// The type of a column in the Parquet file.
#[derive(Clone, Copy)]
enum Kind {
    Whole,
    /// A missing number is empty in the CSV.
    Number,
    Text,
}

/// The columns before the axes.
const FIRST: [(&str, Kind); 6] = [
    ("game", Kind::Whole),
    ("point", Kind::Whole),
    ("entry", Kind::Text),
    ("seed", Kind::Whole),
    ("side", Kind::Text),
    (BOATS, Kind::Whole),
];
/// The column that only the CSV has: the number of the game's lines in the table of boats.
const BOATS: &str = "boats";
/// The last columns.
const LAST: [(&str, Kind); 2] = [("digest", Kind::Text), ("error", Kind::Text)];

/// The columns; the values of an axis are numbers if all of them are numeric.
fn columns(plan: &Plan) -> impl Iterator<Item = (&str, Kind)> {
    let is_number = |axis: usize| {
        plan.points()
            .iter()
            .all(|point| point[axis].number().is_some())
    };
    let kind = move |axis: usize| {
        if is_number(axis) {
            Kind::Number
        } else {
            Kind::Text
        }
    };
    let axes = plan
        .sweep()
        .axes
        .iter()
        .enumerate()
        .map(move |(i, axis)| (axis.key.as_str(), kind(i)));
    FIRST
        .into_iter()
        .chain(axes)
        .chain(METRICS.map(|metric| (metric.name, Kind::Number)))
        .chain(LAST)
}

fn cells<'a>(plan: &'a Plan, row: &'a Row) -> impl Iterator<Item = String> + 'a {
    let Row {
        job,
        boats,
        digest,
        result,
    } = row;
    let first = [
        job.index.to_string(),
        job.point.to_string(),
        plan.sweep().entries[job.entry].name.clone(),
        job.seed.to_string(),
        plan.teams()[job.side].clone(),
        boats.to_string(),
    ];
    let axes = plan.points()[job.point].iter().map(ToString::to_string);
    let why = result
        .as_ref()
        .err()
        .map(String::as_str)
        .unwrap_or_default();
    // Each game must be a single line.
    let why = why.split_whitespace().collect::<Vec<_>>().join(" ");
    first
        .into_iter()
        .chain(axes)
        .chain(metrics_cells(result))
        .chain([digest.clone(), why])
}

/// The first line of the CSV.
pub(super) fn csv_head(plan: &Plan) -> String {
    record(columns(plan).map(|(name, _)| name.to_owned()))
}

/// A game's line of the CSV.
pub(super) fn csv_line(plan: &Plan, row: &Row) -> String {
    record(cells(plan, row))
}

/// The games with complete lines, from the first on, each with the offset of the end of its line.
pub(super) fn csv_rows<'a>(
    plan: &'a Plan,
    text: &'a str,
) -> impl Iterator<Item = (Row, usize)> + 'a {
    let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
    let text = &text[..(whole.len() + 1).min(text.len())];
    let metrics_from = FIRST.len() + plan.sweep().axes.len();
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut record = csv::StringRecord::new();
    let of_record = move |index: usize, record: &csv::StringRecord| {
        if record.len() != metrics_from + METRICS.len() + LAST.len()
            || record[0].parse() != Ok(index)
        {
            return None;
        }
        let [digest, why] = [0, 1].map(|i| record[metrics_from + METRICS.len() + i].to_owned());
        let result = if why.is_empty() {
            Ok(metrics_in(record.iter().skip(metrics_from))?)
        } else {
            Err(why)
        };
        Some(Row {
            job: plan.job(index),
            boats: record[5].parse().ok()?,
            digest,
            result,
        })
    };
    (0..plan.games()).map_while(move |index| {
        let is_there = reader.read_record(&mut record).ok()?;
        let row = if is_there {
            of_record(index, &record)?
        } else {
            return None;
        };
        Some((row, reader.position().byte() as usize))
    })
}

/// The cells of a game's measurements; empty if it could not start.
fn metrics_cells(result: &Result<Metrics, String>) -> impl Iterator<Item = String> + use<> {
    let numbers = result
        .as_ref()
        .map_or([f64::NAN; METRICS.len()], |metrics| metrics.0);
    numbers.into_iter().map(cell_of)
}

/// A number that parses back to the same bits; empty for NaN.
pub(super) fn cell_of(number: f64) -> String {
    if number.is_finite() {
        number.to_string()
    } else {
        String::new()
    }
}

/// The measurements in the first cells, as written by [`metrics_cells`].
fn metrics_in<'a>(cells: impl Iterator<Item = &'a str>) -> Option<Metrics> {
    let numbers: Option<Vec<f64>> = cells.take(METRICS.len()).map(number_of).collect();
    Some(Metrics(numbers?.try_into().ok()?))
}

/// A number as written by [`cell_of`].
fn number_of(cell: &str) -> Option<f64> {
    if cell.is_empty() {
        Some(f64::NAN)
    } else {
        cell.parse().ok()
    }
}

/// A line of CSV.
pub(super) fn record(cells: impl IntoIterator<Item = String>) -> String {
    let mut writer = csv::WriterBuilder::new().from_writer(vec![]);
    writer
        .write_record(cells.into_iter().collect::<Vec<_>>())
        .expect("memory takes it");
    String::from_utf8(writer.into_inner().expect("memory takes it")).expect("cells are text")
}

/// A column of the Parquet file.
fn field(name: &str, kind: Kind) -> Result<TypePtr, ParquetError> {
    let (physical, repetition, logical) = match kind {
        Kind::Whole => (Physical::INT64, Repetition::REQUIRED, None),
        Kind::Number => (Physical::DOUBLE, Repetition::OPTIONAL, None),
        Kind::Text => (
            Physical::BYTE_ARRAY,
            Repetition::REQUIRED,
            Some(LogicalType::String),
        ),
    };
    let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
    Ok(Arc::new(builder.with_logical_type(logical).build()?))
}

/// The Parquet file, for notebooks.
pub(super) fn parquet(plan: &Plan, rows: &[Row]) -> Result<Vec<u8>, ParquetError> {
    let lines: Vec<Vec<String>> = rows.iter().map(|row| cells(plan, row).collect()).collect();
    let columns = || {
        columns(plan)
            .enumerate()
            .filter(|(_, (name, _))| *name != BOATS)
    };
    let fields = columns()
        .map(|(_, (name, kind))| field(name, kind))
        .collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(
        Type::group_type_builder("games")
            .with_fields(fields)
            .build()?,
    );
    let mut writer = SerializedFileWriter::new(
        vec![],
        schema,
        Arc::new(WriterProperties::builder().build()),
    )?;
    let mut group = writer.next_row_group()?;
    for (i, (_, kind)) in columns() {
        let Some(mut column) = group.next_column()? else {
            break;
        };
        let cells = lines.iter().map(|line| line[i].as_str());
        match kind {
            Kind::Whole => {
                let values: Vec<i64> = cells
                    .filter_map(|cell| cell.parse::<u64>().ok())
                    .map(|whole| whole as i64)
                    .collect();
                column
                    .typed::<Int64Type>()
                    .write_batch(&values, None, None)?;
            }
            Kind::Number => {
                let levels: Vec<i16> = cells
                    .clone()
                    .map(|cell| i16::from(!cell.is_empty()))
                    .collect();
                let known: Vec<f64> = cells.filter_map(|cell| cell.parse().ok()).collect();
                column
                    .typed::<DoubleType>()
                    .write_batch(&known, Some(&levels), None)?;
            }
            Kind::Text => {
                let values: Vec<ByteArray> = cells.map(ByteArray::from).collect();
                column
                    .typed::<ByteArrayType>()
                    .write_batch(&values, None, None)?;
            }
        }
        column.close()?;
    }
    group.close()?;
    writer.into_inner()
}
