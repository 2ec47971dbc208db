//! What an EXO2 sonde (YSI) measures, read from what it and a client say to each other.
//!
//! Its signal output adapter takes commands as lines of ASCII: `para` is answered by the codes of the parameters that it outputs, `data` by a
//! number for each of them. It echoes what it is sent and shows a prompt, `#`. A server at the sonde may take the same commands by HTTP
//! and answer by the line alone: `GET /data` is `data`, and `POST /data` has a command as its body.

mod line;
mod parameter;
#[cfg(test)]
mod tests;

pub use parameter::parameter;

use line::Lines;
use serde::Serialize;

/// The most parameters that are believed.
const PARAMETERS_MAX: usize = 128;

/// What one side asks the sonde for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// The codes of its parameters.
    Parameters,
    /// Their values.
    Values,
}

/// What the sonde measured at one moment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// A value for each parameter, in the order of the sonde.
    pub values: Vec<Value>,
}

/// A value that was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// The code of the parameter.
    pub code: u16,
    /// Its name, `unknown` where the code is.
    pub name: &'static str,
    /// Its unit; empty for what has none.
    pub unit: &'static str,
    /// The value as the sonde sent it.
    pub value: f64,
}

/// What is known of a sonde, whoever asked it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sonde {
    /// The codes of the parameters that it outputs, as it last said.
    codes: Vec<u16>,
    /// How often it has said so.
    pub told: u64,
    /// How many measurements have come.
    pub measured: u64,
}

/// One connection to a sonde, read from outside.
#[derive(Clone, Debug, Default)]
pub struct Conversation {
    to_sonde: Lines,
    from_sonde: Lines,
    /// What was asked last, and is not answered.
    asked: Option<Command>,
}

impl Command {
    /// As the sonde is sent it, without the end of the line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Command::Parameters => "para",
            Command::Values => "data",
        }
    }

    /// The command in a line to the sonde, which may be the first of an HTTP request.
    fn of(line: &str) -> Option<Command> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["GET", "/data", _] => Some(Command::Values),
            [word] => [Command::Parameters, Command::Values].into_iter().find(|c| c.word().eq_ignore_ascii_case(word)),
            _ => None,
        }
    }
}

impl Conversation {
    /// Takes bytes, those to the sonde being `outward`; what was measured, where they complete an answer.
    pub fn read_bytes(&mut self, outward: bool, bytes: &[u8], sonde: &mut Sonde) -> Vec<Measurement> {
        let mut measurements = vec![];
        for byte in bytes {
            let lines = if outward { &mut self.to_sonde } else { &mut self.from_sonde };
            if let Some(line) = lines.push_byte(*byte) {
                measurements.extend(self.read(outward, &line, sonde));
            }
        }
        measurements
    }

    /// Nothing more comes this way: a server of HTTP/1.0 ends its answer so.
    pub fn end(&mut self, outward: bool, sonde: &mut Sonde) -> Option<Measurement> {
        let line = if outward { self.to_sonde.end() } else { self.from_sonde.end() };
        self.read(outward, &line?, sonde)
    }

    fn read(&mut self, outward: bool, line: &str, sonde: &mut Sonde) -> Option<Measurement> {
        if outward {
            self.asked = Command::of(line);
            return None;
        }
        // Without a question before it a line is not known to be an answer: the sonde also
        // prompts, and may be set to talk by itself.
        let asked = self.asked?;
        let answer = line.trim_start_matches(['#', ' ', '\t']);
        // The echo may be in the same line.
        let answer = answer.strip_prefix(asked.word()).unwrap_or(answer);
        let measurement = match asked {
            Command::Parameters => {
                sonde.codes = numbers(answer, |text| text.parse().ok().filter(|code| *code > 0))?;
                sonde.told += 1;
                None
            }
            Command::Values => {
                let is_number = |number: &f64| number.is_finite();
                let values = numbers(answer, |text| text.parse().ok().filter(is_number))?;
                // A torn line has fewer numbers, and each would get the name of another.
                if values.len() != sonde.codes.len() {
                    return None;
                }
                sonde.measured += 1;
                let named = sonde.codes.iter().zip(values).map(|(code, value)| {
                    let (name, unit) = parameter(*code).unwrap_or(("unknown", ""));
                    Value { code: *code, name, unit, value }
                });
                Some(Measurement { values: named.collect() })
            }
        };
        // Only after an answer that was understood: its echo comes before it, in a line of its
        // own.
        self.asked = None;
        measurement
    }
}

/// The numbers in a line in which there is nothing else.
fn numbers<T>(line: &str, read: impl Fn(&str) -> Option<T>) -> Option<Vec<T>> {
    let numbers: Option<Vec<T>> = line.split_whitespace().map(read).collect();
    numbers.filter(|numbers| (1..=PARAMETERS_MAX).contains(&numbers.len()))
}
