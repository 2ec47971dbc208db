//! A user's table: a line of names, then numbers. Errors name the file, line and column.
//!
//! Reads the output of loggers and spreadsheets: columns separated by commas, semicolons or tabs,
//! decimal commas, UTF-16, a line of units, and a last line truncated by a power loss.

use primitives::input_file::utf_8;
use std::io::Read;
use thiserror::Error;

/// Maximum number of rows in a file: more than a day at 50 per second.
const ROWS_MAX: usize = 5_000_000;

/// Maximum file size, bytes.
const BYTES_MAX: u64 = 512 << 20;

/// A file with named columns.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The file's name in messages.
    file: String,
    /// Normalised names: lower case, with `_` between words.
    heads: Vec<String>,
    rows: Vec<(u64, csv::StringRecord)>,
    /// Whether numbers have decimal commas: possible only if commas do not separate columns.
    decimal_commas: bool,
    notes: Vec<Mistake>,
}

/// How cells without a value are spelt, in lower case.
const MISSING: [&str; 6] = ["", "nan", "na", "n/a", "null", "none"];

/// A fault in a file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}{}: {message}", line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct Mistake {
    /// The file.
    pub file: String,
    /// The line, if the fault is in a particular one.
    pub line: Option<u64>,
    /// The column, the value found and the allowed values.
    pub message: String,
}

impl Sheet {
    /// Reads a file; `file` is its name in messages.
    ///
    /// # Errors
    /// If it is not a table, has no rows, or has two columns with the same name.
    pub fn read(file: &str, input: impl Read) -> Result<Sheet, Mistake> {
        let mut bytes = vec![];
        let whole = |message| Mistake {
            file: file.to_owned(),
            line: None,
            message,
        };
        let length = input.take(BYTES_MAX + 1).read_to_end(&mut bytes);
        if length.map_err(|error| whole(format!("cannot be read: {error}")))? as u64 > BYTES_MAX {
            return Err(whole(format!("longer than {BYTES_MAX} bytes")));
        }
        let mut bytes = utf_8(bytes).map_err(&whole)?;
        // A logger that loses power truncates its last line.
        let is_cut = !bytes.ends_with(b"\n");
        // The reader turns a final comment into a row unless its line ends.
        bytes.push(b'\n');
        let wrong = |error: csv::Error| Mistake {
            file: file.to_owned(),
            line: error.position().map(|position| line_of(&bytes, position)),
            message: reason(&error),
        };
        let separator = separator(&bytes);
        let mut reader = csv::ReaderBuilder::new();
        let reader = reader
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .flexible(true)
            .delimiter(separator);
        let mut reader = reader.from_reader(&bytes[..]);
        let heads: Vec<String> = reader
            .headers()
            .map_err(wrong)?
            .iter()
            .map(plain_head)
            .collect();
        let decimal_commas = separator != b',';
        let mut sheet = Sheet {
            file: file.to_owned(),
            heads,
            rows: vec![],
            decimal_commas,
            notes: vec![],
        };
        for (i, head) in sheet.heads.iter().enumerate() {
            if !head.is_empty() && sheet.heads[..i].contains(head) {
                return Err(
                    sheet.mistake(Some(1), format!("two columns named {head}, expected one"))
                );
            }
        }
        let mut is_first = true;
        let mut records = reader.records().peekable();
        while let Some(record) = records.next() {
            let record = record.map_err(wrong)?;
            let line = record
                .position()
                .map_or(0, |position| line_of(&bytes, position));
            if record.len() == 1 && record[0].is_empty() {
                // A blank line.
                continue;
            }
            let is_units = std::mem::take(&mut is_first) && sheet.are_units(&record, line)?;
            if is_units {
                continue;
            }
            if record.len() != sheet.heads.len() {
                let found = record.len();
                let wanted = sheet.heads.len();
                if is_cut && found < wanted && !sheet.rows.is_empty() && records.peek().is_none() {
                    let note = format!(
                        "{found} of {wanted} columns in the last line, which is truncated and ignored"
                    );
                    sheet.notes.push(sheet.mistake(Some(line), note));
                    break;
                }
                let message = format!("{found} columns, expected {wanted} as in the header");
                return Err(sheet.mistake(Some(line), message));
            }
            if sheet.rows.len() == ROWS_MAX {
                return Err(sheet.mistake(Some(line), format!("more than {ROWS_MAX} rows")));
            }
            sheet.rows.push((line, record));
        }
        if sheet.rows.is_empty() {
            return Err(sheet.mistake(None, "no rows below the header".to_owned()));
        }
        Ok(sheet)
    }

    /// The columns' names.
    pub fn heads(&self) -> &[String] {
        &self.heads
    }

    /// The index of a column, if it exists.
    pub fn column(&self, head: &str) -> Option<usize> {
        self.heads.iter().position(|known| known == head)
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The line of a row in the file.
    pub fn line(&self, row: usize) -> Option<u64> {
        self.rows.get(row).map(|(line, _)| *line)
    }

    /// The content of a row and column; the row must exist.
    pub fn text(&self, row: usize, column: usize) -> &str {
        self.rows[row].1.get(column).unwrap_or_default()
    }

    /// Notes on content that was ignored when the file was read.
    pub fn notes(&self) -> &[Mistake] {
        &self.notes
    }

    /// Whether a cell has no value: empty, NaN, N/A or the like.
    pub fn is_missing(&self, row: usize, column: usize) -> bool {
        MISSING.contains(&self.text(row, column).to_lowercase().as_str())
    }

    /// Whether the (first) row contains the units of the columns: its cells are empty or repeat the
    /// ends of the column names.
    fn are_units(&self, record: &csv::StringRecord, line: u64) -> Result<bool, Mistake> {
        let is_word = |cell: &str| {
            self.parse(cell).is_none() && !MISSING.contains(&cell.to_lowercase().as_str())
        };
        if !record.iter().any(is_word)
            || !record.iter().all(|cell| cell.is_empty() || is_word(cell))
        {
            return Ok(false);
        }
        for (head, unit) in self.heads.iter().zip(record) {
            let words = words(unit);
            let end = format!("_{}", plain_unit(&words));
            if !words.is_empty() && head.contains('_') && !head.ends_with(&end) {
                let message = format!("{head} has the unit {unit}, expected the unit in its name");
                return Err(self.mistake(Some(line), message));
            }
        }
        Ok(true)
    }

    fn parse(&self, text: &str) -> Option<f64> {
        match text.split_once(',') {
            Some((whole, decimals)) if self.decimal_commas && !decimals.contains([',', '.']) => {
                format!("{whole}.{decimals}").parse().ok()
            }
            _ => text.parse().ok(),
        }
    }

    /// The number in a row and column, within `low` to `high`.
    ///
    /// # Errors
    /// If it is not a number, or out of range.
    pub fn number(
        &self,
        row: usize,
        column: usize,
        (low, high): (f64, f64),
    ) -> Result<f64, Mistake> {
        let text = self.text(row, column);
        let found = if text.is_empty() {
            "empty".to_owned()
        } else {
            text.to_owned()
        };
        // A setting computed as full ahead may exceed the limit by a rounding error.
        let slack = 1e-9 * (high - low);
        match self.parse(text) {
            Some(number) if (low - slack..=high + slack).contains(&number) => {
                Ok(number.clamp(low, high))
            }
            _ => {
                let expected = format!("expected {} to {}", short(low), short(high));
                Err(self.mistake(
                    Some(self.rows[row].0),
                    format!("{} is {found}, {expected}", self.heads[column]),
                ))
            }
        }
    }

    /// A fault in the file, or in one of its lines.
    pub fn mistake(&self, line: Option<u64>, message: String) -> Mistake {
        Mistake {
            file: self.file.clone(),
            line,
            message,
        }
    }

    /// The times in column `t_s`, strictly increasing, from 0 to `high_s`.
    ///
    /// # Errors
    /// If they are not strictly increasing, or out of this range.
    pub fn times(&self, high_s: f64) -> Result<Vec<f64>, Mistake> {
        self.times_from(high_s, |_| 0.0)
    }

    /// Like [`Sheet::times`], but relative to the first row, whose time may be from any clock.
    ///
    /// # Errors
    /// If they are not strictly increasing, or span more than `high_s`.
    pub fn times_from_first(&self, high_s: f64) -> Result<Vec<f64>, Mistake> {
        self.times_from(high_s, |first_s| first_s)
    }

    fn times_from(&self, high_s: f64, start: fn(f64) -> f64) -> Result<Vec<f64>, Mistake> {
        let missing = || {
            self.mistake(
                Some(1),
                format!(
                    "missing column t_s; columns found: {}",
                    self.heads.join(", ")
                ),
            )
        };
        let column = self.column("t_s").ok_or_else(missing)?;
        let first_s = self
            .rows
            .first()
            .and_then(|_| self.parse(self.text(0, column)))
            .filter(|t_s| t_s.is_finite());
        let start_s = first_s.map_or(0.0, start);
        let mut times_s: Vec<f64> = Vec::with_capacity(self.rows.len());
        for row in 0..self.rows.len() {
            let t_s = self.number(row, column, (start_s, start_s + high_s))?;
            let since_s = t_s - start_s;
            if let Some(before_s) = times_s.last().filter(|before_s| since_s <= **before_s) {
                let before_s = before_s + start_s;
                let message = format!(
                    "t_s is {t_s}, expected more than {before_s}, its value in the previous row"
                );
                return Err(self.mistake(Some(self.rows[row].0), message));
            }
            times_s.push(since_s);
        }
        Ok(times_s)
    }
}

/// The line of a record. The reader returns the end of the previous record, which may be followed
/// by blank lines and comments.
fn line_of(bytes: &[u8], position: &csv::Position) -> u64 {
    let rest = bytes.get(position.byte() as usize..).unwrap_or_default();
    let lines = rest
        .split(|byte| *byte == b'\n')
        .map(|line| line.strip_suffix(b"\r").unwrap_or(line));
    position.line()
        + lines
            .take_while(|line| line.is_empty() || line.starts_with(b"#"))
            .count() as u64
}

/// The column separator: the most frequent of comma, semicolon and tab in the first line.
fn separator(bytes: &[u8]) -> u8 {
    let mut lines = bytes.split(|byte| *byte == b'\n');
    let header = lines
        .find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"))
        .unwrap_or_default();
    // Every other part is inside quotes.
    let plain = header.split(|byte| *byte == b'"').step_by(2);
    let count = |separator: u8| {
        plain
            .clone()
            .flatten()
            .filter(|byte| **byte == separator)
            .count()
    };
    // Of several equally frequent separators, the last is used.
    [b'\t', b';', b',']
        .into_iter()
        .max_by_key(|separator| count(*separator))
        .unwrap_or(b',')
}

/// A normalised column name: `Port (rad/s)` is `port_rad_s`.
pub fn plain_head(head: &str) -> String {
    let joined = words(head.trim_start_matches('\u{feff}'));
    for side in ["port", "starboard"] {
        if let Some(unit) = joined
            .strip_prefix(side)
            .and_then(|rest| rest.strip_prefix('_'))
        {
            return format!("{side}_{}", plain_unit(unit));
        }
    }
    joined
}

/// The words of a name or a unit, in lower case and joined: `deg/s` is `deg_s`.
fn words(text: &str) -> String {
    let spelt = text.to_lowercase().replace('%', "pct");
    let words: Vec<&str> = spelt
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    words.join("_")
}

/// A unit as spelt in column names.
fn plain_unit(unit: &str) -> &str {
    match unit {
        "n" | "newtons" => "newton",
        "percent" | "per_cent" => "pct",
        "rad_per_s" | "radps" | "rads" => "rad_s",
        other => other,
    }
}

/// A limit with at most six digits, rather than 13.225999999999999.
fn short(number: f64) -> String {
    let text = format!("{number:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn reason(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(text: &str) -> Result<Sheet, Mistake> {
        Sheet::read("in.csv", text.as_bytes())
    }

    #[test]
    fn units_are_read_in_several_spellings() {
        for (head, want) in [
            ("port_rad_s", "port_rad_s"),
            (" Port (rad/s)", "port_rad_s"),
            ("\u{feff}t_s", "t_s"),
            ("t [s]", "t_s"),
            ("starboard (%)", "starboard_pct"),
            ("starboard [N]", "starboard_newton"),
            ("portfolio", "portfolio"),
        ] {
            assert_eq!(plain_head(head), want, "{head:?}");
        }
    }

    #[test]
    fn mistakes_are_named_by_file_line_and_column() {
        for (text, want) in [
            ("", "in.csv: no rows"),
            ("t_s,a\n", "in.csv: no rows"),
            ("t_s,t_s\n0,1\n", "in.csv:1: two columns named t_s"),
            ("t_s,a\n0,1\n1\n", "in.csv:3: 1 columns, expected 2"),
            ("t_s,a\n0,1\n \n1,2,3\n", "in.csv:4: 3 columns, expected 2"),
            (
                "t_s,a\n0,1\n # no remark\n",
                "in.csv:3: 1 columns, expected 2",
            ),
            ("t_s,a\n0", "in.csv:2: 1 columns, expected 2"),
            (
                "t_s;a\n0,0;1\n0,5,5;1\n",
                "in.csv:3: t_s is 0,5,5, expected 0 to 100",
            ),
            (
                "t_s,speed_m_s\ns,kn\n0,1\n",
                "in.csv:2: speed_m_s has the unit kn, expected the unit in its name",
            ),
            (
                "x,a\n0,1\n",
                "in.csv:1: missing column t_s; columns found: x, a",
            ),
            (
                "t_s,a\n0,1\nnan,1\n",
                "in.csv:3: t_s is nan, expected 0 to 100",
            ),
            (
                "t_s,a\n0,1\n-1,1\n",
                "in.csv:3: t_s is -1, expected 0 to 100",
            ),
            (
                "t_s,a\n0,1\n\n# a remark\n1e9,1\n",
                "in.csv:5: t_s is 1e9, expected 0 to 100",
            ),
            (
                "t_s,a\n0,1\n,1\n",
                "in.csv:3: t_s is empty, expected 0 to 100",
            ),
            (
                "t_s,a\n0,1\n2,1\n2,3\n",
                "in.csv:4: t_s is 2, expected more than 2, its value in the previous row",
            ),
        ] {
            let error = sheet(text)
                .and_then(|sheet| sheet.times(100.0))
                .expect_err(text);
            assert!(error.to_string().starts_with(want), "{text:?}: {error}");
        }
    }

    #[test]
    fn lines_of_spaces_count_for_nothing_and_the_last_line_needs_no_end() {
        for text in [
            "t_s,a\n0,1\n \t\n2,3\n \n",
            "t_s,a\n0,1\n2,3\n ",
            "t_s,a\n0,1\n2,3",
            "t_s,a\n0,1\n2,3\n# a remark",
            "t_s,a\n0,1\n2,3\r\n#",
            "t_s,a\n0,1\n2,\"3\"\n",
        ] {
            let times_s = sheet(text).and_then(|sheet| sheet.times(100.0));
            assert_eq!(times_s, Ok(vec![0.0, 2.0]), "{text:?}");
        }
    }

    /// Each is in the format of some logger or spreadsheet.
    #[test]
    fn tables_of_other_programs_are_read() {
        let utf_16: Vec<u8> = "\u{feff}t_s\ta\r\n0\t1\r\n1,5\t3\r\n"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        for bytes in [
            &b"t_s;a\n0,0;1,0\n1,5;3,0\n"[..],
            b"t_s;a\n0.0;1.0\n1.5;3.0\n",
            b"t_s\ta\n0\t1\n1.5\t3\n",
            b"t_s,a\ns,\n0,1\n1.5,3\n",
            b"# a comment; with a semicolon\nt_s,a\n0,1\n1.5,3\n",
            b"t_s,a\n0,1\n1.5,3\n1",
            b"t_s, \ta\n0,1\n1.5,3\n",
            &utf_16,
        ] {
            let sheet = Sheet::read("in.csv", bytes).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(
                sheet.times(100.0),
                Ok(vec![0.0, 1.5]),
                "{}",
                String::from_utf8_lossy(bytes)
            );
            assert_eq!(sheet.number(1, 1, (0.0, 9.0)), Ok(3.0));
        }
        let cut = sheet("t_s,a\n0,1\n1.5").expect("the rest is good");
        let notes: Vec<String> = cut.notes().iter().map(ToString::to_string).collect();
        assert_eq!(
            notes,
            ["in.csv:3: 1 of 2 columns in the last line, which is truncated and ignored"]
        );
    }

    #[test]
    fn times_of_a_clock_count_from_the_first_row() {
        let sheet = sheet("t_s,a\n1718000000.0,1\n1718000000.5,n/a\n").expect("a table");
        assert_eq!(sheet.times_from_first(100.0), Ok(vec![0.0, 0.5]));
        assert!(sheet.is_missing(1, 1) && !sheet.is_missing(0, 1));
        let error = sheet
            .times(100.0)
            .expect_err("no time of a trial")
            .to_string();
        assert!(
            error.contains("t_s is 1718000000.0, expected 0 to 100"),
            "{error}"
        );
    }

    #[test]
    fn what_is_no_text_is_refused() {
        let error = Sheet::read("in.csv", &b"t_s,a\n0,\xff\xfe\n"[..]).expect_err("no text");
        assert!(error.to_string().contains("not UTF-8"), "{error}");
    }
}
