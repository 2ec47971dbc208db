//! `ZDA`, time and date.

use super::field::Fields;
use super::{Date, Line, ParseError, Talker, TimeOfDay};

/// `ZDA`.
#[derive(Clone, Debug, PartialEq)]
pub struct Zda {
    /// Who says so.
    pub talker: Talker,
    /// Time, UTC.
    pub time: Option<TimeOfDay>,
    /// Date, UTC.
    pub date: Option<Date>,
}

impl Zda {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Zda, ParseError> {
        fields.at_least(4)?;
        let date = match (fields.whole(2)?, fields.whole(3)?, fields.whole(4)?) {
            (None, None, None) => None,
            (Some(day), Some(month), Some(year)) => Some(Date { year, month, day }),
            _ => return Err(fields.wrong(2, "a day, month and year, or none of them")),
        };
        if date.is_some_and(|date| !date.is_valid()) {
            return Err(fields.wrong(2, "a date of the calendar"));
        }
        Ok(Zda { talker, time: fields.time(1)?, date })
    }

    /// Writes the local zone as UTC.
    pub(super) fn write(&self, mut line: Line) {
        line.time(self.time);
        match self.date.filter(|date| date.is_valid() && date.year < 10_000) {
            Some(Date { year, month, day }) => line.fixed(&format!("{day:02},{month:02},{year:04}")),
            None => line.fixed(",,"),
        }
        line.fixed("00");
        line.fixed("00");
        line.end();
    }
}
