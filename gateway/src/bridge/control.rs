//! Who commands the boat, and whether it follows its commands, according to its own reports.

use super::command_echo::CommandEcho;
use crate::config::ControlWatch;
use crate::nmea::{Mode, Operator};
use crate::protocol::{ControlReport, Shown};
use crate::supervisor::ControlFault;
use primitives::SimTime;

/// The boat's last control report, and the expected one.
#[derive(Clone, Debug)]
pub(super) struct ControlLog {
    watch: ControlWatch,
    /// The last control state that the boat reported, and when.
    reported: Option<(SimTime, ControlReport)>,
    /// The mode last sent to the boat.
    sent: Option<Mode>,
    /// Start of the period in which the boat has reported a different mode.
    mismatch_since: Option<SimTime>,
    pub(super) echo: CommandEcho,
}

impl ControlLog {
    pub(super) fn new(watch: ControlWatch) -> ControlLog {
        ControlLog {
            watch,
            reported: None,
            sent: None,
            mismatch_since: None,
            echo: CommandEcho::new(watch),
        }
    }

    pub(super) fn observe(&mut self, now: SimTime, report: &ControlReport) {
        let ControlReport { shown, operator } = *report;
        self.reported = Some((now, *report));
        if operator.is_none_or(|operator| operator == Operator::Secondary) {
            self.echo.observe(now, shown);
        } else {
            // Under another operator's control, the boat correctly echoes that operator's commands:
            // discard what was learned from echoes of ours.
            self.echo = CommandEcho::new(self.watch);
        }
        let mismatch = self.sent.is_some_and(|sent| sent != shown.mode);
        self.mismatch_since = mismatch.then(|| self.mismatch_since.unwrap_or(now));
    }

    /// Records a sent command in the form in which the boat should echo it.
    pub(super) fn note_sent(&mut self, now: SimTime, shown: Shown) {
        self.echo.note_sent(now, shown);
        let mode = shown.mode;
        if self.sent != Some(mode) {
            self.sent = Some(mode);
            let matches = self.mode() == Some(mode);
            // The clock starts when the mode is ordered, not when the boat first reports a
            // different one: a boat that reports rarely must not get twice the echo time.
            self.mismatch_since = (!matches).then_some(now);
        }
    }

    /// The mode that the boat reports.
    pub(super) fn mode(&self) -> Option<Mode> {
        self.reported.map(|(_, report)| report.shown.mode)
    }

    /// Age of the boat's last report, s.
    pub(super) fn age_s(&self, now: SimTime) -> Option<f64> {
        self.reported.map(|(at, _)| (now - at).as_s())
    }

    /// The operator that the boat reports.
    pub(super) fn operator(&self) -> Option<Operator> {
        self.reported.and_then(|(_, report)| report.operator)
    }

    /// The mode that the boat has reported for longer than `echo_s` instead of the one sent.
    pub(super) fn mode_mismatch(&self, now: SimTime) -> Option<Mode> {
        let since = self.mismatch_since?;
        let (at, report) = self.reported?;
        // A report from before the command does not show its effect.
        ((now - since).as_s() > self.watch.echo_s && at > since).then_some(report.shown.mode)
    }

    /// Why we do not command the boat now, according to its reports, if so.
    pub(super) fn fault(&self, now: SimTime) -> Option<ControlFault> {
        // Some boats report no operator. For these, the owner can declare in the file that the
        // gateway commands them; otherwise, silence means that someone else may command the boat.
        let silent = (!self.watch.assumed).then_some(ControlFault::Unknown);
        let Some((at, report)) = self.reported else {
            return silent;
        };
        // The assumption covers a boat that never reports, not one that has stopped reporting.
        if (now - at).as_s() > self.watch.age_max_s {
            return Some(ControlFault::Unknown);
        }
        let is_ours = report.operator.map_or(self.watch.assumed, |operator| {
            operator == Operator::Secondary
        });
        match (report.operator, self.mode_mismatch(now)) {
            // Check foreign orders first: a boat with two masters also appears to disobey or not to
            // listen, and the operator must learn that there is another gateway.
            _ if is_ours && self.echo.is_foreign(now) => Some(ControlFault::ForeignOrders),
            (_, None) if is_ours && self.echo.is_deaf(now) => Some(ControlFault::Deaf),
            (_, Some(mode)) if is_ours => Some(ControlFault::Disobeyed(mode.letter())),
            (Some(Operator::Secondary), _) => None,
            (Some(other), _) => Some(ControlFault::TakenOver(other.number())),
            (None, _) => silent,
        }
    }
}
