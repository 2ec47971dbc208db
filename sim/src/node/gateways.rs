//! Accepts or refuses gateways' reports, without a network or clock.

use super::membership::Membership;
use messages::external::NavReport;
use messages::refusal::{Refusal, Refusals};
use primitives::SimTime;

/// Maximum age of a fix, one day: longer than any game.
const OLDEST: SimTime = SimTime(86_400_000_000_000);

/// Checks a report that arrived at game time `now`. Returns the time of its fix if accepted.
pub fn accept(
    gateways: &mut Membership,
    report: &NavReport,
    now: SimTime,
    refusals: &mut Refusals,
) -> Option<SimTime> {
    let vehicle = report.vehicle;
    let seq = report.stamp.seq;
    let mut own = gateways.vehicles_of(report.ticket).peekable();
    let refusal = if own.peek().is_none() {
        Refusal::Ticket
    } else if !own.any(|own| own == vehicle) {
        Refusal::NotYours
    // Reports may arrive out of order after a link failure: an older position must not replace a
    // newer one.
    } else if gateways.has_taken(vehicle, seq) {
        Refusal::WrongTick
    } else if report.age_ns < 0 {
        Refusal::BadNumber
    } else {
        drop(own);
        gateways.note_taken(vehicle, seq);
        gateways.welcome_back(report.ticket);
        // The age comes from the gateway's own clock; using the time of the fix would require
        // synchronised clocks.
        return Some(now - SimTime(report.age_ns).min(OLDEST));
    };
    refusals.count(refusal);
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node::membership::tests::{NOW, membership, request};
    use messages::picture::Nav;
    use messages::{Message, Role, Stamp};
    use primitives::VehicleId;

    /// A gateway with ticket 7 for some of the real boats, which are blue one (0) and red one (2).
    fn gateways(vehicles: &[&str]) -> Membership {
        let mut gateways = membership(Role::Gateway, true);
        gateways.join(&request(Role::Gateway, "a", vehicles), 7, NOW);
        gateways
    }

    fn report(ticket: u64, seq: u64, vehicle: u16) -> NavReport {
        let stamp = Stamp {
            seq,
            version: NavReport::VERSION,
            ..Stamp::default()
        };
        NavReport {
            stamp,
            ticket,
            vehicle: VehicleId(vehicle),
            valid: true,
            age_ns: 30,
            nav: Nav::default(),
        }
    }

    #[test]
    fn a_report_of_an_own_boat_is_taken_with_the_time_of_its_fix() {
        let mut gateways = gateways(&["red_one", "blue_one"]);
        let mut refusals = Refusals::default();
        assert_eq!(
            accept(&mut gateways, &report(7, 0, 2), NOW, &mut refusals),
            Some(SimTime(70))
        );
        let long_ago = NavReport {
            age_ns: i64::MAX,
            valid: false,
            ..report(7, 1, 2)
        };
        assert_eq!(
            accept(&mut gateways, &long_ago, NOW, &mut refusals),
            Some(NOW - OLDEST)
        );
        assert_eq!(refusals.total(), 0);
    }

    #[test]
    fn what_does_not_fit_is_counted_and_the_next_is_taken() {
        let mut gateways = gateways(&["blue_one"]);
        assert!(
            accept(
                &mut gateways,
                &report(7, 5, 0),
                NOW,
                &mut Refusals::default()
            )
            .is_some()
        );
        for (wrong, refusal) in [
            (report(8, 6, 0), Refusal::Ticket),
            (report(7, 6, 2), Refusal::NotYours),
            (report(7, 6, 1), Refusal::NotYours),
            (report(7, 6, 999), Refusal::NotYours),
            (report(7, 5, 0), Refusal::WrongTick),
            (report(7, 4, 0), Refusal::WrongTick),
            (
                NavReport {
                    age_ns: -1,
                    ..report(7, 6, 0)
                },
                Refusal::BadNumber,
            ),
            (
                NavReport {
                    age_ns: i64::MIN,
                    ..report(7, 6, 0)
                },
                Refusal::BadNumber,
            ),
        ] {
            let mut refusals = Refusals::default();
            assert_eq!(
                accept(&mut gateways, &wrong, NOW, &mut refusals),
                None,
                "{wrong:?}"
            );
            assert_eq!(refusals, Refusals::from([(refusal, 1)]), "{wrong:?}");
        }
        assert!(
            accept(
                &mut gateways,
                &report(7, 6, 0),
                NOW,
                &mut Refusals::default()
            )
            .is_some()
        );
    }

    #[test]
    fn a_gateway_that_was_lost_is_back_with_its_next_report() {
        let mut gateways = gateways(&["blue_one"]);
        gateways.gone("a");
        assert!(gateways.vacant().eq([VehicleId(0), VehicleId(2)]));
        assert!(
            accept(
                &mut gateways,
                &report(7, 3, 0),
                NOW,
                &mut Refusals::default()
            )
            .is_some()
        );
        assert!(
            gateways.vacant().eq([VehicleId(2)]),
            "no other node had taken its boat"
        );
    }
}
