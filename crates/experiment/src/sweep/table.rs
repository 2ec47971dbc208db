//! The table of games: one line of CSV per game as it is played, and all of them as Parquet.

use super::AxisValue;
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
    /// Digest of the final state and of all events, hex; empty if it could not start.
    pub digest: String,
    /// The measurements, or why it could not start.
    pub result: Result<Metrics, String>,
}

/// The columns before the axes.
const FIRST: [&str; 6] = ["game", "point", "entry", "seed", "side", BOATS];
/// The column that only the CSV has: the number of the game's lines in the table of boats.
const BOATS: &str = "boats";
/// The last columns.
const LAST: [&str; 2] = ["digest", "error"];

enum Cell {
    Whole(u64),
    /// NaN for a missing number.
    Number(f64),
    Value(AxisValue),
    Text(String),
}

impl Cell {
    fn into_text(self) -> String {
        match self {
            Cell::Whole(whole) => whole.to_string(),
            Cell::Number(number) => cell_of(number),
            Cell::Value(value) => value.to_string(),
            Cell::Text(text) => text,
        }
    }
}

/// The names of the columns.
fn columns(plan: &Plan) -> impl Iterator<Item = &str> {
    let axes = plan.sweep().axes.iter().map(|axis| axis.key.as_str());
    FIRST.into_iter().chain(axes).chain(METRICS.iter().map(|metric| metric.name)).chain(LAST)
}

fn cells<'a>(plan: &'a Plan, row: &'a Row) -> impl Iterator<Item = Cell> + 'a {
    let Row { job, boats, digest, result } = row;
    let first = [
        Cell::Whole(job.index as u64),
        Cell::Whole(job.point as u64),
        Cell::Text(plan.sweep().entries[job.entry].name.clone()),
        Cell::Whole(job.seed),
        Cell::Text(plan.teams()[job.side].clone()),
        Cell::Whole(*boats as u64),
    ];
    let axes = plan.points()[job.point].values.iter().map(|value| Cell::Value(value.clone()));
    let metrics = METRICS.iter().map(|metric| Cell::Number(result.as_ref().map_or(f64::NAN, |all| metric.of(all))));
    let why = result.as_ref().err().map(String::as_str).unwrap_or_default();
    // Each game must be a single line.
    let why = why.split_whitespace().collect::<Vec<_>>().join(" ");
    first.into_iter().chain(axes).chain(metrics).chain([Cell::Text(digest.clone()), Cell::Text(why)])
}

/// The first line of the CSV.
pub(super) fn csv_head(plan: &Plan) -> String {
    record(columns(plan).map(str::to_owned))
}

/// A game's line of the CSV.
pub(super) fn csv_line(plan: &Plan, row: &Row) -> String {
    record(cells(plan, row).map(Cell::into_text))
}

/// The games with complete lines, from the first on, each with the offset of its line's end.
pub(super) fn csv_rows<'a>(plan: &'a Plan, text: &'a str) -> impl Iterator<Item = (Row, usize)> + 'a {
    let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
    let text = &text[..(whole.len() + 1).min(text.len())];
    let metrics_from = FIRST.len() + plan.sweep().axes.len();
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
    let mut record = csv::StringRecord::new();
    let of_record = move |index: usize, record: &csv::StringRecord| {
        if record.len() != metrics_from + METRICS.len() + LAST.len() || record[0].parse() != Ok(index) {
            return None;
        }
        let mut numbers = record.iter().skip(metrics_from);
        let metrics = Metrics::from_each(|_| numbers.next().and_then(number_of).ok_or(()));
        let [digest, why] = [0, 1].map(|i| record[metrics_from + METRICS.len() + i].to_owned());
        let result = if why.is_empty() { Ok(metrics.ok()?) } else { Err(why) };
        Some(Row { job: plan.job(index), boats: record[5].parse().ok()?, digest, result })
    };
    (0..plan.games()).map_while(move |index| {
        let is_there = reader.read_record(&mut record).ok()?;
        let row = if is_there { of_record(index, &record)? } else { return None };
        Some((row, reader.position().byte() as usize))
    })
}

/// A number that parses back to the same bits; empty for NaN.
pub(super) fn cell_of(number: f64) -> String {
    if number.is_finite() { number.to_string() } else { String::new() }
}

/// The number that [`cell_of`] wrote.
pub(super) fn number_of(cell: &str) -> Option<f64> {
    if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() }
}

/// A line of CSV.
pub(super) fn record(cells: impl IntoIterator<Item = String>) -> String {
    let mut writer = csv::WriterBuilder::new().from_writer(vec![]);
    writer.write_record(cells.into_iter().collect::<Vec<_>>()).expect("memory takes it");
    String::from_utf8(writer.into_inner().expect("memory takes it")).expect("cells are text")
}

/// A column of the Parquet file.
enum Column {
    Whole(Vec<i64>),
    Number(Vec<f64>),
    Text(Vec<String>),
}

impl Column {
    /// A column of these cells, all of one kind; values of an axis are numbers if all of them are.
    fn of(kind: &Cell, cells: Vec<Cell>) -> Column {
        let number = |cell: &Cell| match cell {
            Cell::Number(number) => Some(*number),
            Cell::Value(value) => value.number(),
            Cell::Whole(_) | Cell::Text(_) => None,
        };
        let whole = |cell: &Cell| if let Cell::Whole(whole) = cell { Some(*whole as i64) } else { None };
        let numbers: Option<Vec<f64>> = cells.iter().map(number).collect();
        match (kind, numbers) {
            (Cell::Whole(_), _) => Column::Whole(cells.iter().filter_map(whole).collect()),
            (Cell::Number(_) | Cell::Value(_), Some(numbers)) => Column::Number(numbers),
            _ => Column::Text(cells.into_iter().map(Cell::into_text).collect()),
        }
    }

    fn field(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let (physical, repetition, logical) = match self {
            Column::Whole(_) => (Physical::INT64, Repetition::REQUIRED, None),
            Column::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            Column::Text(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String)),
        };
        let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        Ok(Arc::new(builder.with_logical_type(logical).build()?))
    }
}

/// The Parquet file, for notebooks.
pub(super) fn parquet(plan: &Plan, rows: &[Row]) -> Result<Vec<u8>, ParquetError> {
    let mut by_column: Vec<Vec<Cell>> = columns(plan).map(|_| Vec::with_capacity(rows.len())).collect();
    for row in rows {
        by_column.iter_mut().zip(cells(plan, row)).for_each(|(column, cell)| column.push(cell));
    }
    // A table without games has the same columns.
    let first = Row { job: plan.job(0), boats: 0, digest: String::new(), result: Err(String::new()) };
    let columns: Vec<(&str, Column)> = columns(plan)
        .zip(cells(plan, &first))
        .zip(by_column)
        .filter(|((name, _), _)| *name != BOATS)
        .map(|((name, kind), cells)| (name, Column::of(&kind, cells)))
        .collect();
    let fields = columns.iter().map(|(name, column)| column.field(name)).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("games").with_fields(fields).build()?);
    let mut writer = SerializedFileWriter::new(vec![], schema, Arc::new(WriterProperties::builder().build()))?;
    let mut group = writer.next_row_group()?;
    let mut columns = columns.iter();
    while let Some(mut column) = group.next_column()? {
        let Some((_, values)) = columns.next() else { break };
        match values {
            Column::Whole(values) => drop(column.typed::<Int64Type>().write_batch(values, None, None)?),
            Column::Number(values) => {
                let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_finite())).collect();
                let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
                column.typed::<DoubleType>().write_batch(&known, Some(&levels), None)?;
            }
            Column::Text(values) => {
                let values: Vec<ByteArray> = values.iter().map(|value| value.as_str().into()).collect();
                column.typed::<ByteArrayType>().write_batch(&values, None, None)?;
            }
        }
        column.close()?;
    }
    group.close()?;
    writer.into_inner()
}
