//! Whose gateway brings which real boat: the start_positions, the tickets, and which reports are accepted from whom.
//!
//! No network and no clock in here: the node tells it what came, and asks what follows.

use super::agents::Refused;
use game::external::NavReport;
use game::message::{JoinReply, JoinRequest};
use game::picture::Nav;
use game::scenario::Source;
use game::{Scenario, SimTime, VehicleId};

/// A fix is never taken to be older than this, a day: longer than any game.
const OLDEST: SimTime = SimTime(86_400_000_000_000);

/// A gateway that moored.
#[derive(Clone, Debug)]
struct Moored {
    gateway: String,
    ticket: u64,
    /// Whether it is there: its process has not died.
    present: bool,
    /// The number of its newest report.
    newest: Option<u64>,
}

/// A vehicle as the gateways knows it.
#[derive(Clone, Debug)]
struct StartPosition {
    name: String,
    source: Source,
    moored: Option<Moored>,
}

/// A report that may be taken in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighted {
    /// Which boat.
    pub vehicle: VehicleId,
    /// Where it was.
    pub nav: Nav,
    /// When, in the time of the game.
    pub fix_at: SimTime,
    /// Whether that can be relied on.
    pub valid: bool,
}

/// Where real boats lie: who brings them.
pub struct Gateways {
    /// By vehicle.
    start_positions: Vec<StartPosition>,
    /// What was refused so far.
    pub refused: Refused,
}

impl Gateways {
    /// The gateways of a game that no gateway has come to yet.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Gateways {
        let start_positions = scenario.vehicles.iter();
        let start_positions =
            start_positions.map(|v| StartPosition { name: v.name.clone(), source: v.source, moored: None });
        Gateways { start_positions: start_positions.collect(), refused: Refused::default() }
    }

    /// Lets a gateway moor, or not. `ticket` is what it will have to show.
    ///
    /// A gateway that asks again for what it has gets it again: its answer was lost on the way.
    pub fn moor(&mut self, request: &JoinRequest, ticket: u64) -> JoinReply {
        let refused = |reason: String| JoinReply::Refused { reason };
        if request.version != game::VERSION {
            return refused(format!(
                "the gateway is Squall {}, the sim is Squall {}: use the same version",
                request.version,
                game::VERSION
            ));
        }
        if request.vehicles.is_empty() {
            return refused("the gateway names no vehicle".to_owned());
        }
        let mut vehicles = Vec::new();
        for name in &request.vehicles {
            let Some(i) = self.start_positions.iter().position(|start_position| start_position.name == *name) else {
                return refused(format!("there is no vehicle {name:?}; {}", self.on_offer()));
            };
            if self.start_positions[i].source != Source::External {
                return refused(format!("{name} is simulated in this game; {}", self.on_offer()));
            }
            let holder = self.start_positions[i].moored.as_ref().filter(|moored| moored.present);
            if holder.is_some_and(|moored| moored.gateway != request.agent) {
                return JoinReply::Busy { vehicle: name.clone() };
            }
            if vehicles.contains(&VehicleId::at(i)) {
                return refused(format!("the gateway names {name:?} twice"));
            }
            vehicles.push(VehicleId::at(i));
        }
        for vehicle in &vehicles {
            let moored = Moored { gateway: request.agent.clone(), ticket, present: true, newest: None };
            self.start_positions[vehicle.index()].moored = Some(moored);
        }
        JoinReply::Granted { ticket, vehicles }
    }

    /// Takes a report that came at `now`, in the time of the game.
    pub fn take(&mut self, report: &NavReport, now: SimTime) -> Option<Sighted> {
        let (vehicle, seq) = (report.vehicle, report.stamp.seq);
        let shows = |moored: &Moored| moored.ticket == report.ticket;
        if !self.start_positions.iter().filter_map(|start_position| start_position.moored.as_ref()).any(shows) {
            self.refused.ticket += 1;
            return None;
        }
        let start_position = self.start_positions.get_mut(vehicle.index());
        let Some(moored) =
            start_position.and_then(|start_position| start_position.moored.as_mut()).filter(|moored| shows(moored))
        else {
            self.refused.not_yours += 1;
            return None;
        };
        if moored.newest.is_some_and(|newest| newest >= seq) {
            self.refused.wrong_tick += 1;
            return None;
        }
        if report.age_ns < 0 {
            self.refused.bad_number += 1;
            return None;
        }
        // One that was given up and speaks again is back.
        (moored.newest, moored.present) = (Some(seq), true);
        let fix_at = now - SimTime(report.age_ns).min(OLDEST);
        Some(Sighted { vehicle, nav: report.nav, fix_at, valid: report.valid })
    }

    /// A gateway process died: its start_positions are free again. It may still come back to those that nobody takes.
    pub fn gone(&mut self, gateway: &str) {
        let moored = self.start_positions.iter_mut().filter_map(|start_position| start_position.moored.as_mut());
        moored.filter(|moored| moored.gateway == gateway).for_each(|moored| moored.present = false);
    }

    /// The real boats, with whether a gateway is there for them.
    pub fn externals(&self) -> impl Iterator<Item = (VehicleId, bool)> {
        let externals = self
            .start_positions
            .iter()
            .enumerate()
            .filter(|(_, start_position)| start_position.source == Source::External);
        externals.map(|(i, start_position)| {
            (VehicleId::at(i), start_position.moored.as_ref().is_some_and(|moored| moored.present))
        })
    }

    /// Which vehicles gateways can bring, in words.
    fn on_offer(&self) -> String {
        let names: Vec<&str> =
            self.externals().map(|(vehicle, _)| self.start_positions[vehicle.index()].name.as_str()).collect();
        match names.is_empty() {
            true => "no vehicle is external: the game has none, or is a rehearsal".to_owned(),
            false => format!("external is {}", names.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::message::{Message, Stamp};
    use std::path::Path;

    /// Blue one and red one are real boats: vehicles 0 and 2.
    fn gateways() -> Gateways {
        let game = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/mixed_2v2.toml");
        Gateways::new(&game::scenario::load(&game).unwrap_or_else(|e| panic!("{e}")))
    }

    fn ask(gateway: &str, vehicles: &[&str]) -> JoinRequest {
        let vehicles = vehicles.iter().map(|name| (*name).to_owned()).collect();
        JoinRequest { version: game::VERSION.to_owned(), agent: gateway.to_owned(), vehicles }
    }

    fn report(ticket: u64, seq: u64, vehicle: u16) -> NavReport {
        let stamp = Stamp { seq, version: NavReport::VERSION, ..Stamp::default() };
        NavReport { stamp, ticket, vehicle: VehicleId(vehicle), valid: true, age_ns: 30, nav: Nav::default() }
    }

    fn granted(ticket: u64, vehicles: &[u16]) -> JoinReply {
        JoinReply::Granted { ticket, vehicles: vehicles.iter().map(|v| VehicleId(*v)).collect() }
    }

    const NOW: SimTime = SimTime(100);

    #[test]
    fn a_report_of_an_own_boat_is_taken_with_the_time_of_its_fix() {
        let mut gateways = gateways();
        assert_eq!(gateways.moor(&ask("a", &["red_one", "blue_one"]), 7), granted(7, &[2, 0]));
        let want = Sighted { vehicle: VehicleId(2), nav: Nav::default(), fix_at: SimTime(70), valid: true };
        assert_eq!(gateways.take(&report(7, 0, 2), NOW), Some(want));
        let long_ago = NavReport { age_ns: i64::MAX, valid: false, ..report(7, 1, 2) };
        assert_eq!(gateways.take(&long_ago, NOW), Some(Sighted { fix_at: NOW - OLDEST, valid: false, ..want }));
        assert_eq!(gateways.refused.total(), 0);
    }

    #[test]
    fn what_does_not_fit_is_counted() {
        let mut gateways = gateways();
        gateways.moor(&ask("a", &["blue_one"]), 7);
        assert!(gateways.take(&report(7, 5, 0), NOW).is_some());
        for (wrong, count) in [
            (report(8, 6, 0), (|r| r.ticket) as fn(&Refused) -> u64),
            (report(7, 6, 2), |r| r.not_yours),
            (report(7, 6, 1), |r| r.not_yours),
            (report(7, 6, 999), |r| r.not_yours),
            (report(7, 5, 0), |r| r.wrong_tick),
            (report(7, 4, 0), |r| r.wrong_tick),
            (NavReport { age_ns: -1, ..report(7, 6, 0) }, |r| r.bad_number),
            (NavReport { age_ns: i64::MIN, ..report(7, 6, 0) }, |r| r.bad_number),
        ] {
            let before = (count(&gateways.refused), gateways.refused.total());
            assert_eq!(gateways.take(&wrong, NOW), None, "{wrong:?}");
            assert_eq!((count(&gateways.refused), gateways.refused.total()), (before.0 + 1, before.1 + 1), "{wrong:?}");
        }
        assert!(gateways.take(&report(7, 6, 0), NOW).is_some(), "none of it stands in the way of the next");
    }

    #[test]
    fn a_berth_is_free_again_when_its_gateway_is_gone_and_the_old_one_has_no_say() {
        let mut gateways = gateways();
        gateways.moor(&ask("a", &["blue_one"]), 1);
        assert_eq!(gateways.externals().collect::<Vec<_>>(), [(VehicleId(0), true), (VehicleId(2), false)]);
        assert_eq!(gateways.moor(&ask("b", &["blue_one"]), 2), JoinReply::Busy { vehicle: "blue_one".to_owned() });
        gateways.gone("a");
        assert!(gateways.externals().all(|(_, is_there)| !is_there));
        assert_eq!(gateways.moor(&ask("b", &["blue_one"]), 2), granted(2, &[0]));
        assert_eq!(gateways.take(&report(1, 9, 0), NOW), None);
        assert_eq!(gateways.refused.ticket, 1);
        assert!(gateways.take(&report(2, 0, 0), NOW).is_some());
    }

    #[test]
    fn a_gateway_that_speaks_or_asks_again_has_its_berth_again() {
        let mut gateways = gateways();
        gateways.moor(&ask("a", &["blue_one"]), 1);
        gateways.gone("a");
        assert!(gateways.take(&report(1, 3, 0), NOW).is_some(), "nobody has taken its start_position");
        assert_eq!(gateways.moor(&ask("b", &["blue_one"]), 2), JoinReply::Busy { vehicle: "blue_one".to_owned() });
        assert_eq!(gateways.moor(&ask("a", &["blue_one"]), 3), granted(3, &[0]), "the answer was lost on the way");
        assert_eq!(gateways.take(&report(1, 4, 0), NOW), None, "the newer ticket counts");
        assert!(gateways.take(&report(3, 0, 0), NOW).is_some(), "and counts its reports anew");
    }

    #[test]
    fn the_quay_says_why_it_has_no_berth() {
        let mut gateways = gateways();
        let other = JoinRequest { version: "0.0.1".to_owned(), ..ask("a", &["blue_one"]) };
        for (request, why) in [
            (other, "0.0.1"),
            (ask("a", &[]), "names no vehicle"),
            (ask("a", &["green_one"]), "there is no vehicle \"green_one\"; external is blue_one, red_one"),
            (ask("a", &["blue_one", "blue_two"]), "blue_two is simulated in this game; external is blue_one, red_one"),
            (ask("a", &["blue_one", "blue_one"]), "twice"),
        ] {
            let JoinReply::Refused { reason } = gateways.moor(&request, 1) else { panic!("{request:?} may moor") };
            assert!(reason.contains(why), "{reason}");
        }
        assert!(gateways.externals().all(|(_, is_there)| !is_there));
        let game = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/pav01_vs_pav01.toml");
        let mut none = Gateways::new(&game::scenario::load(&game).unwrap_or_else(|e| panic!("{e}")));
        let JoinReply::Refused { reason } = none.moor(&ask("a", &["blue_one"]), 1) else { panic!("it may moor") };
        assert!(reason.contains("or is a rehearsal"), "{reason}");
    }
}
