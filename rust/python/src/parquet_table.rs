//! `thenar.parquet`: a table of columns as the bytes of an Apache Parquet file.

use ::parquet::basic::{LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::{Type, TypePtr};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::Arc;

/// Level of a value that is there; one that is missing has level 0.
const THERE: i16 = 1;

/// A column; what is missing is null.
enum Column {
    Numbers(Vec<Option<f64>>),
    Texts(Vec<Option<String>>),
}

impl Column {
    fn rows(&self) -> usize {
        match self {
            Column::Numbers(values) => values.len(),
            Column::Texts(values) => values.len(),
        }
    }

    fn schema(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let (physical, logical) = match self {
            Column::Numbers(_) => (Physical::DOUBLE, None),
            Column::Texts(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let made = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()?;
        Ok(Arc::new(made))
    }
}

/// The bytes of an Apache Parquet file with the columns of a dictionary: names to lists of numbers or of texts, all of one
/// length; None is null, and a column of None alone is one of numbers. Not compressed; the same table gives the same bytes.
/// Raises `ValueError` naming the column that is of another length or kind.
#[pyfunction]
pub fn parquet<'py>(
    py: Python<'py>,
    columns: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyBytes>> {
    let mut table: Vec<(String, Column)> = Vec::with_capacity(columns.len());
    for (name, values) in columns {
        let name: String = name.extract()?;
        let column = column(&name, &values)?;
        if let Some((first, other)) = table.first()
            && other.rows() != column.rows()
        {
            return Err(PyValueError::new_err(format!(
                "column '{name}' has {} rows, but '{first}' has {}; give each the same number",
                column.rows(),
                other.rows()
            )));
        }
        table.push((name, column));
    }
    let bytes = written(&table).map_err(|error| {
        PyValueError::new_err(format!("the table cannot be written as Parquet: {error}"))
    })?;
    Ok(PyBytes::new(py, &bytes))
}

fn column(name: &str, values: &Bound<'_, PyAny>) -> PyResult<Column> {
    if let Ok(numbers) = values.extract::<Vec<Option<f64>>>() {
        return Ok(Column::Numbers(numbers));
    }
    values
        .extract::<Vec<Option<String>>>()
        .map(Column::Texts)
        .map_err(|_| {
            PyValueError::new_err(format!(
                "column '{name}' holds neither numbers nor texts alone; make every value the one or the other, or None"
            ))
        })
}

fn written(table: &[(String, Column)]) -> Result<Vec<u8>, ParquetError> {
    let fields = table
        .iter()
        .map(|(name, column)| column.schema(name))
        .collect::<Result<Vec<_>, _>>()?;
    let schema = Type::group_type_builder("table")
        .with_fields(fields)
        .build()?;
    let properties = WriterProperties::builder()
        .set_created_by(format!("thenar {}", env!("CARGO_PKG_VERSION")))
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, column) in table {
        let Some(mut chunk) = group.next_column()? else {
            break;
        };
        match column {
            Column::Numbers(values) => {
                let there: Vec<f64> = values.iter().flatten().copied().collect();
                let typed = chunk.typed::<DoubleType>();
                typed.write_batch(&there, Some(&levels(values)), None)?;
            }
            Column::Texts(values) => {
                let there: Vec<ByteArray> = values
                    .iter()
                    .flatten()
                    .map(|text| ByteArray::from(text.as_str()))
                    .collect();
                let typed = chunk.typed::<ByteArrayType>();
                typed.write_batch(&there, Some(&levels(values)), None)?;
            }
        }
        chunk.close()?;
    }
    group.close()?;
    writer.into_inner()
}

fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
    let level = |value: &Option<T>| if value.is_some() { THERE } else { 0 };
    values.iter().map(level).collect()
}
