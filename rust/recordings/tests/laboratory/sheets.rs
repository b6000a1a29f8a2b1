//! Workbooks made cell by cell, as testing machines save them.
#![allow(clippy::unwrap_used, dead_code)]

use std::io::Write;

const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006/relationships";

/// Rows of cells: what can be read as a number is one.
pub type Rows = Vec<Vec<String>>;

/// A row of texts.
pub fn row(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|cell| cell.to_string()).collect()
}

/// Twenty samples at 0.1 s, 0.05 N and 0.1 mm each; the last column falls from 10 mm by 0.1 mm each.
pub fn samples() -> Rows {
    let numbers = |k: i32| {
        [
            0.1 * f64::from(k),
            0.05 * f64::from(k),
            0.1 * f64::from(k),
            10.0 - 0.1 * f64::from(k),
        ]
    };
    (0..20)
        .map(|k| numbers(k).iter().map(f64::to_string).collect())
        .collect()
}

/// An .xlsx of sheets.
pub fn workbook(sheets: &[(&str, Rows)]) -> Vec<u8> {
    let relation = |id: usize, kind: &str, target: &str| {
        format!("<Relationship Id=\"rId{id}\" Type=\"{OFFICE}/{kind}\" Target=\"{target}\"/>")
    };
    let (mut names, mut relations) = (String::new(), String::new());
    let mut members = Vec::new();
    for (k, (name, rows)) in sheets.iter().enumerate() {
        let id = k + 1;
        names += &format!("<sheet name=\"{name}\" sheetId=\"{id}\" r:id=\"rId{id}\"/>");
        relations += &relation(id, "worksheet", &format!("worksheets/sheet{id}.xml"));
        let body = format!(
            "<worksheet xmlns=\"{MAIN}\"><sheetData>{}</sheetData></worksheet>",
            cells(rows)
        );
        members.push((format!("xl/worksheets/sheet{id}.xml"), body));
    }
    members.push((
        "xl/workbook.xml".into(),
        format!(
            "<workbook xmlns=\"{MAIN}\" xmlns:r=\"{OFFICE}\"><sheets>{names}</sheets></workbook>"
        ),
    ));
    let package =
        |inner: &str| format!("<Relationships xmlns=\"{PACKAGE}\">{inner}</Relationships>");
    members.push(("xl/_rels/workbook.xml.rels".into(), package(&relations)));
    members.push((
        "_rels/.rels".into(),
        package(&relation(1, "officeDocument", "xl/workbook.xml")),
    ));
    zipped(&members)
}

fn cells(rows: &Rows) -> String {
    let mut text = String::new();
    for (k, row) in rows.iter().enumerate() {
        text += &format!("<row r=\"{}\">", k + 1);
        for (column, cell) in row.iter().enumerate().filter(|(_, cell)| !cell.is_empty()) {
            let at = format!(
                "{}{}",
                char::from(b'A' + u8::try_from(column).unwrap()),
                k + 1
            );
            text += &match cell.parse::<f64>() {
                Ok(number) => format!("<c r=\"{at}\"><v>{number}</v></c>"),
                Err(_) if cell.starts_with('#') => {
                    format!("<c r=\"{at}\" t=\"e\"><v>{cell}</v></c>")
                }
                Err(_) => format!("<c r=\"{at}\" t=\"inlineStr\"><is><t>{cell}</t></is></c>"),
            };
        }
        text += "</row>";
    }
    text
}

/// A zip of texts, packed.
pub fn zipped<B: AsRef<[u8]>>(members: &[(String, B)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated);
    for (name, bytes) in members {
        archive.start_file(name.as_str(), options).unwrap();
        archive.write_all(bytes.as_ref()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}
