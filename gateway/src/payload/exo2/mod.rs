//! The measurements of an EXO2 sonde (YSI), read from its conversation with a client.
//!
//! Its signal output adapter accepts commands as ASCII lines: the answer to `para` is the codes of
//! its output parameters, the answer to `data` a number for each of them. It echoes its input and
//! shows a prompt, `#`. A server at the sonde may accept the same commands by HTTP and answer with
//! only the line: `GET /data` is `data`, and `POST /data` has a command as its body.

mod line;
mod parameter;
#[cfg(test)]
mod tests;

pub use parameter::parameter;

use line::Lines;
use serde::Serialize;

/// Maximum number of parameters accepted.
const PARAMETERS_MAX: usize = 128;

/// A query to the sonde.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// The codes of its parameters.
    Parameters,
    /// Their values.
    Values,
}

/// A measurement at one moment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// A value for each parameter, in the order of the sonde.
    pub values: Vec<Value>,
}

/// A measured value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// The code of the parameter.
    pub code: u16,
    /// Its name, or `unknown`.
    pub name: &'static str,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// The value as the sonde sent it.
    pub value: f64,
}

/// The state of a sonde, regardless of who queries it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sonde {
    /// The codes of its output parameters, as last reported.
    codes: Vec<u16>,
    /// How often it has reported them.
    pub told: u64,
    /// Number of measurements received.
    pub measured: u64,
}

/// One connection to a sonde, as observed.
#[derive(Clone, Debug, Default)]
pub struct Conversation {
    to_sonde: Lines,
    from_sonde: Lines,
    /// The last query, if unanswered.
    asked: Option<Command>,
}

impl Command {
    /// The command as the sonde receives it, without the end of the line.
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
            [word] => [Command::Parameters, Command::Values]
                .into_iter()
                .find(|c| c.word().eq_ignore_ascii_case(word)),
            _ => None,
        }
    }
}

impl Conversation {
    /// Adds bytes, `outward` if to the sonde. Returns the measurement if they complete an answer.
    pub fn read_bytes(
        &mut self,
        outward: bool,
        bytes: &[u8],
        sonde: &mut Sonde,
    ) -> Vec<Measurement> {
        let mut measurements = vec![];
        for byte in bytes {
            let lines = if outward {
                &mut self.to_sonde
            } else {
                &mut self.from_sonde
            };
            if let Some(line) = lines.push_byte(*byte) {
                measurements.extend(self.read(outward, &line, sonde));
            }
        }
        measurements
    }

    /// Ends one direction: an HTTP/1.0 server ends its answer this way.
    pub fn end(&mut self, outward: bool, sonde: &mut Sonde) -> Option<Measurement> {
        let line = if outward {
            self.to_sonde.end()
        } else {
            self.from_sonde.end()
        };
        self.read(outward, &line?, sonde)
    }

    fn read(&mut self, outward: bool, line: &str, sonde: &mut Sonde) -> Option<Measurement> {
        if outward {
            self.asked = Command::of(line);
            return None;
        }
        // Without a preceding query, a line may not be an answer: the sonde also shows prompts, and
        // may be set to send by itself.
        let asked = self.asked?;
        let answer = line.trim_start_matches(['#', ' ', '\t']);
        // The echo may be on the same line.
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
                // A torn line has fewer numbers, and each would get the wrong name.
                if values.len() != sonde.codes.len() {
                    return None;
                }
                sonde.measured += 1;
                let named = sonde.codes.iter().zip(values).map(|(code, value)| {
                    let (name, unit) = parameter(*code).unwrap_or(("unknown", ""));
                    Value {
                        code: *code,
                        name,
                        unit,
                        value,
                    }
                });
                Some(Measurement {
                    values: named.collect(),
                })
            }
        };
        // Only after an answer that was parsed: its echo precedes it, on a line of its own.
        self.asked = None;
        measurement
    }
}

/// The numbers in a line that contains nothing else.
fn numbers<T>(line: &str, read: impl Fn(&str) -> Option<T>) -> Option<Vec<T>> {
    let numbers: Option<Vec<T>> = line.split_whitespace().map(read).collect();
    numbers.filter(|numbers| (1..=PARAMETERS_MAX).contains(&numbers.len()))
}
