//! Who commands the boat, and whether it does what it was sent: by its own words, PSEAD.

use crate::nmea::{ControlState, Mode, Operator};
use crate::supervisor::Control;
use game::SimTime;
use game::gateway::ControlWatch;

/// What the boat last said, and what it should say.
#[derive(Clone, Debug)]
pub(super) struct ControlLog {
    watch: ControlWatch,
    said: Option<(SimTime, Mode, Option<Operator>)>,
    /// The mode it was last sent.
    sent: Option<Mode>,
    /// Since when it has shown another one.
    astray_since: Option<SimTime>,
}

impl ControlLog {
    pub(super) fn new(watch: ControlWatch) -> ControlLog {
        ControlLog { watch, said: None, sent: None, astray_since: None }
    }

    /// The boat may be another one now.
    pub(super) fn forget(&mut self) {
        *self = ControlLog::new(self.watch);
    }

    pub(super) fn take(&mut self, now: SimTime, state: &ControlState) {
        self.said = Some((now, state.mode, state.operator));
        let astray = self.sent.is_some_and(|sent| sent != state.mode);
        self.astray_since = astray.then(|| self.astray_since.unwrap_or(now));
    }

    /// The boat was sent this mode.
    pub(super) fn note_sent(&mut self, now: SimTime, mode: Mode) {
        if self.sent != Some(mode) {
            self.sent = Some(mode);
            let shows = self.said.is_some_and(|(_, said, _)| said == mode);
            self.astray_since = (!shows).then_some(now);
        }
    }

    /// The mode that the boat shows.
    pub(super) fn mode(&self) -> Option<Mode> {
        self.said.map(|(_, mode, _)| mode)
    }

    /// Who the boat says commands it.
    pub(super) fn operator(&self) -> Option<Operator> {
        self.said.and_then(|(.., operator)| operator)
    }

    /// The mode that the boat shows in place of the one it was sent, for longer than it may.
    pub(super) fn astray(&self, now: SimTime) -> Option<Mode> {
        let since = self.astray_since?;
        let (said_at, mode, _) = self.said?;
        // What it said before it could know is no disobedience.
        ((now - since).as_s() > self.watch.echo_s && said_at > since).then_some(mode)
    }

    /// What it comes to.
    pub(super) fn control(&self, now: SimTime) -> Control {
        let silent = if self.watch.assumed { Control::Granted } else { Control::Unknown };
        let Some((said_at, _, operator)) = self.said else { return silent };
        if (now - said_at).as_s() > self.watch.age_max_s {
            return Control::Unknown;
        }
        match (operator, self.astray(now)) {
            (Some(Operator::Secondary), None) => Control::Granted,
            (Some(Operator::Secondary), Some(mode)) => Control::Disobeys(mode.letter()),
            (Some(other), _) => Control::Other(other.number()),
            (None, Some(mode)) if self.watch.assumed => Control::Disobeys(mode.letter()),
            (None, _) => silent,
        }
    }
}
