//! Who commands the boat, and whether it follows its commands: by its own report.

use super::command_echo::CommandEcho;
use crate::config::ControlWatch;
use crate::nmea::{Mode, Operator};
use crate::protocol::{ControlReport, Shown};
use crate::supervisor::Control;
use primitives::SimTime;

/// The boat's last control state.
#[derive(Clone, Copy, Debug)]
struct Report {
    at: SimTime,
    mode: Mode,
    operator: Option<Operator>,
}

/// What the boat last reported, and what it should report.
#[derive(Clone, Debug)]
pub(super) struct ControlLog {
    watch: ControlWatch,
    reported: Option<Report>,
    /// The mode that the boat was last sent.
    sent: Option<Mode>,
    /// Since when it has reported another one.
    mismatch_since: Option<SimTime>,
    echo: CommandEcho,
}

impl ControlLog {
    pub(super) fn new(watch: ControlWatch) -> ControlLog {
        ControlLog { watch, reported: None, sent: None, mismatch_since: None, echo: CommandEcho::new(watch) }
    }

    /// Forgets everything: the boat may be another one now.
    pub(super) fn forget(&mut self) {
        *self = ControlLog::new(self.watch);
    }

    pub(super) fn observe(&mut self, now: SimTime, report: &ControlReport) {
        let ControlReport { shown, operator } = *report;
        self.reported = Some(Report { at: now, mode: shown.mode, operator });
        if operator.is_none_or(|operator| operator == Operator::Secondary) {
            self.echo.observe(now, shown);
        } else {
            // Under another operator the boat shows that one's commands, rightly; what was
            // learned about ours ends.
            self.echo = CommandEcho::new(self.watch);
        }
        let mismatch = self.sent.is_some_and(|sent| sent != shown.mode);
        self.mismatch_since = mismatch.then(|| self.mismatch_since.unwrap_or(now));
    }

    /// The boat was sent what it should show as this.
    pub(super) fn note_sent(&mut self, now: SimTime, shown: Shown) {
        self.echo.note_sent(now, shown);
        let mode = shown.mode;
        if self.sent != Some(mode) {
            self.sent = Some(mode);
            let matches = self.mode() == Some(mode);
            // The clock starts when the mode is ordered, not when the boat first shows another
            // one: a boat that reports once in a while must not get a second echo time for
            // free.
            self.mismatch_since = (!matches).then_some(now);
        }
    }

    /// Somebody else was heard to order the boat about.
    pub(super) fn note_foreign(&mut self, now: SimTime) {
        self.echo.note_foreign(now);
    }

    /// The mode that the boat reports.
    pub(super) fn mode(&self) -> Option<Mode> {
        self.reported.map(|report| report.mode)
    }

    /// How old its last report is, s.
    pub(super) fn age_s(&self, now: SimTime) -> Option<f64> {
        self.reported.map(|report| (now - report.at).as_s())
    }

    /// Who the boat reports commands it.
    pub(super) fn operator(&self) -> Option<Operator> {
        self.reported.and_then(|report| report.operator)
    }

    /// The mode that the boat has reported in place of the one it was sent for longer than `echo_s`.
    pub(super) fn mode_mismatch(&self, now: SimTime) -> Option<Mode> {
        let since = self.mismatch_since?;
        let report = self.reported?;
        // A report from before the command says nothing about it.
        ((now - since).as_s() > self.watch.echo_s && report.at > since).then_some(report.mode)
    }

    /// Who commands the boat now.
    pub(super) fn control(&self, now: SimTime) -> Control {
        // Some boats report no operator. Their owner says in the file that the gateway commands
        // them; without that word silence means that somebody else may.
        let silent = if self.watch.assumed { Control::Granted } else { Control::Unknown };
        let Some(report) = self.reported else { return silent };
        // An assumption covers a boat that never reports, not one that has stopped to.
        if (now - report.at).as_s() > self.watch.age_max_s {
            return Control::Unknown;
        }
        let is_ours = report.operator.map_or(self.watch.assumed, |operator| operator == Operator::Secondary);
        match (report.operator, self.mode_mismatch(now)) {
            // Foreign orders come first: a boat with two masters also disobeys and looks deaf,
            // and the operator has to know that there is another gateway.
            _ if is_ours && self.echo.is_foreign(now) => Control::Foreign,
            (_, None) if is_ours && self.echo.is_deaf(now) => Control::Deaf,
            (Some(Operator::Secondary), None) => Control::Granted,
            (Some(Operator::Secondary), Some(mode)) => Control::Disobeys(mode.letter()),
            (Some(other), _) => Control::Other(other.number()),
            (None, Some(mode)) if self.watch.assumed => Control::Disobeys(mode.letter()),
            (None, _) => silent,
        }
    }
}
