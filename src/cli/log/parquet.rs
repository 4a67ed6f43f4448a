//! The scalars of a log as Parquet: doubles, one row group, no compression (the numbers of a simulation hardly shrink).

use std::fs::File;
use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::{DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::record::Table;

/// Writes `table` to `file`: `time`, `step`, then its columns; what the log does not say is null.
///
/// # Errors
/// Those of the file.
pub(super) fn write(file: File, table: &Table) -> Result<()> {
    let mut fields = vec![
        field("time", Physical::DOUBLE, Repetition::REQUIRED)?,
        field("step", Physical::INT64, Repetition::REQUIRED)?,
    ];
    // Units by column, for readers that look at the file's metadata.
    let mut notes = vec![KeyValue::new("unit.time".to_owned(), "s".to_owned())];
    for column in &table.columns {
        fields.push(field(&column.name, Physical::DOUBLE, Repetition::OPTIONAL)?);
        notes.push(KeyValue::new(
            format!("unit.{}", column.name),
            column.unit.clone(),
        ));
        let key = format!("description.{}", column.name);
        notes.push(KeyValue::new(key, column.description.clone()));
    }
    let schema = Type::group_type_builder("sandgate")
        .with_fields(fields)
        .build()?;
    let properties = WriterProperties::builder()
        .set_created_by(concat!("sandgate ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(notes))
        .build();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))?;
    let mut rows = writer.next_row_group()?;
    doubles(&mut rows, &table.time, None)?;
    if let Some(mut column) = rows.next_column()? {
        let steps: Vec<i64> = table.step.iter().map(|s| s.cast_signed()).collect();
        column
            .typed::<Int64Type>()
            .write_batch(&steps, None, None)?;
        column.close()?;
    }
    for column in &table.columns {
        let known: Vec<f64> = column
            .values
            .iter()
            .copied()
            .filter(|v| !v.is_nan())
            .collect();
        let levels: Vec<i16> = column
            .values
            .iter()
            .map(|v| i16::from(!v.is_nan()))
            .collect();
        doubles(&mut rows, &known, Some(&levels))?;
    }
    rows.close()?;
    writer.close()?;
    Ok(())
}

fn field(name: &str, physical: Physical, repetition: Repetition) -> Result<TypePtr> {
    let built = Type::primitive_type_builder(name, physical).with_repetition(repetition);
    Ok(Arc::new(built.build()?))
}

fn doubles(
    rows: &mut SerializedRowGroupWriter<'_, File>,
    values: &[f64],
    levels: Option<&[i16]>,
) -> Result<()> {
    if let Some(mut column) = rows.next_column()? {
        column
            .typed::<DoubleType>()
            .write_batch(values, levels, None)?;
        column.close()?;
    }
    Ok(())
}
