//! The table of games as Parquet, for notebooks.

use crate::metric::METRICS;
use crate::plan::Plan;
use crate::study::Row;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};
use std::sync::Arc;

/// A column with its values.
enum Column {
    Whole(String, Vec<i64>),
    /// NaN is none.
    Number(String, Vec<f64>),
    Text(String, Vec<String>),
}

/// The file.
pub(crate) fn bytes(plan: &Plan, rows: &[Row]) -> Result<Vec<u8>, ParquetError> {
    let columns = columns(plan, rows);
    let fields = columns.iter().map(Column::field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("games").with_fields(fields).build()?);
    let mut writer = SerializedFileWriter::new(vec![], schema, Arc::new(WriterProperties::builder().build()))?;
    let mut group = writer.next_row_group()?;
    let mut columns = columns.iter();
    while let Some(mut column) = group.next_column()? {
        let Some(values) = columns.next() else { break };
        match values {
            Column::Whole(_, values) => drop(column.typed::<Int64Type>().write_batch(values, None, None)?),
            Column::Number(_, values) => {
                let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_finite())).collect();
                let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
                column.typed::<DoubleType>().write_batch(&known, Some(&levels), None)?;
            }
            Column::Text(_, values) => {
                let values: Vec<ByteArray> = values.iter().map(|value| value.as_str().into()).collect();
                column.typed::<ByteArrayType>().write_batch(&values, None, None)?;
            }
        }
        column.close()?;
    }
    group.close()?;
    writer.into_inner()
}

impl Column {
    fn field(&self) -> Result<TypePtr, ParquetError> {
        let (name, physical, repetition, logical) = match self {
            Column::Whole(name, _) => (name, Physical::INT64, Repetition::REQUIRED, None),
            Column::Number(name, _) => (name, Physical::DOUBLE, Repetition::OPTIONAL, None),
            Column::Text(name, _) => (name, Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String)),
        };
        let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        Ok(Arc::new(builder.with_logical_type(logical).build()?))
    }
}

fn columns(plan: &Plan, rows: &[Row]) -> Vec<Column> {
    let jobs: Vec<_> = rows.iter().map(|row| plan.job(row.index)).collect();
    let whole = |name: &str, values: Vec<i64>| Column::Whole(name.to_owned(), values);
    let text = |name: &str, values: Vec<String>| Column::Text(name.to_owned(), values);
    let mut columns = vec![
        whole("game", jobs.iter().map(|job| job.index as i64).collect()),
        whole("point", jobs.iter().map(|job| job.point as i64).collect()),
        text("entry", jobs.iter().map(|job| plan.sweep().entries[job.entry].name.clone()).collect()),
        whole("seed", jobs.iter().map(|job| job.seed as i64).collect()),
        text("side", jobs.iter().map(|job| plan.teams()[job.side].clone()).collect()),
    ];
    for (k, axis) in plan.sweep().axes.iter().enumerate() {
        let value = |point: usize| &plan.points()[point].values[k];
        let numbers: Option<Vec<f64>> = jobs.iter().map(|job| value(job.point).number()).collect();
        columns.push(match numbers {
            Some(numbers) => Column::Number(axis.key.clone(), numbers),
            None => text(&axis.key, jobs.iter().map(|job| value(job.point).to_string()).collect()),
        });
    }
    for (m, metric) in METRICS.iter().enumerate() {
        let number = |row: &Row| row.result.as_ref().map_or(f64::NAN, |numbers| numbers[m]);
        columns.push(Column::Number(metric.name.to_owned(), rows.iter().map(number).collect()));
    }
    columns.push(text("digest", rows.iter().map(|row| row.digest.clone()).collect()));
    columns
        .push(text("error", rows.iter().map(|row| row.result.as_ref().err().cloned().unwrap_or_default()).collect()));
    columns
}
