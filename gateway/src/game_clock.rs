//! The game time as a gateway knows it: from the sim's answer to a join, from the stamps of orders,
//! and from its own clock.

use messages::external::ExternalOrder;
use primitives::SimTime;

/// Detects orders with a time that the game cannot have reached, or from before the boat joined.
/// The game runs at most as fast as the gateway's clock, so game time minus gateway time can only
/// fall: because of delays, pauses, or a sim that does not keep up. The largest observed difference
/// is the best estimate. When the boat joins, the difference is at most the game time in the sim's
/// answer minus our own time of the request.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GameClock {
    ahead_max: SimTime,
    joined: Option<Joined>,
}

/// The state of a game that the boat has joined.
#[derive(Clone, Copy, Debug)]
struct Joined {
    /// Game time when the boat joined.
    since: SimTime,
    /// Upper bound of game time minus our own, from the join.
    most: SimTime,
    seen: Option<SimTime>,
}

/// The verdict on the time of an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OrderTime {
    /// The order may be current.
    Plausible,
    /// The game has not reached this time, or has not sent the picture that the order answers.
    Ahead,
    /// The order is from before the boat joined, or the boat has not joined.
    BeforeJoining,
}

impl GameClock {
    /// A clock that has no game yet; it accepts stamps at most this far ahead.
    pub(crate) fn new(ahead_max: SimTime) -> GameClock {
        GameClock {
            ahead_max,
            joined: None,
        }
    }

    /// Records that the boat has joined a game: its request was sent at our time `asked`, and the
    /// game's time was `since` at some later moment.
    pub(crate) fn join(&mut self, asked: SimTime, since: SimTime) {
        // The answer was created after the request, so the game is at most this far ahead of our
        // clock. The answer's travel time is unknown, and only makes the bound safer.
        let most = SimTime(since.0.saturating_sub(asked.0));
        self.joined = Some(Joined {
            since,
            most,
            seen: None,
        });
    }

    /// Checks the time of an order that arrived at `now`.
    pub(crate) fn check(&mut self, now: SimTime, order: &ExternalOrder) -> OrderTime {
        let stamp = order.stamp.valid_ns;
        let given = order.given_ns;
        let Some(joined) = &mut self.joined else {
            return OrderTime::BeforeJoining;
        };
        if stamp < joined.since {
            return OrderTime::BeforeJoining;
        }
        // Anyone may have sent the order, with any stamp.
        let difference = SimTime(stamp.0.saturating_sub(now.0));
        let known = joined.seen.unwrap_or(joined.most);
        // An order far in the future would count as newer than all later real ones, and block the
        // sim's orders until then.
        if given > stamp
            || stamp >= SimTime::NEVER
            || difference.0.saturating_sub(known.0) > self.ahead_max.0
        {
            return OrderTime::Ahead;
        }
        // Keep only the largest difference: a game that pauses or slows down falls behind our
        // clock, which is not suspicious.
        joined.seen = Some(joined.seen.map_or(difference, |seen| seen.max(difference)));
        OrderTime::Plausible
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::{Order, Stamp, VehicleOrder};
    use primitives::VehicleId;

    fn order(stamp_s: f64, given_s: f64) -> ExternalOrder {
        let stamp = Stamp {
            valid_ns: SimTime::from_s(stamp_s),
            ..Stamp::default()
        };
        let order = VehicleOrder::new(VehicleId(0), Order::Hold);
        ExternalOrder {
            stamp,
            given_ns: SimTime::from_s(given_s),
            order,
            others_m: vec![],
        }
    }

    fn joined(asked_s: f64, since_s: f64) -> GameClock {
        let mut clock = GameClock::new(SimTime::from_s(1.0));
        clock.join(SimTime::from_s(asked_s), SimTime::from_s(since_s));
        clock
    }

    fn check(clock: &mut GameClock, now_s: f64, stamp_s: f64, given_s: f64) -> OrderTime {
        clock.check(SimTime::from_s(now_s), &order(stamp_s, given_s))
    }

    #[test]
    fn what_the_game_has_not_come_to_is_refused_and_what_comes_next_is_not() {
        let mut clock = joined(99.9, 7.0);
        let mut take = |now_s, stamp_s, given_s| check(&mut clock, now_s, stamp_s, given_s);
        for far_s in [8.2, 100.0, 1e9, 9e9, f64::MAX] {
            assert_eq!(
                take(100.0, far_s, 6.9),
                OrderTime::Ahead,
                "the first, at {far_s}"
            );
        }
        assert_eq!(take(100.0, 7.0, 6.9), OrderTime::Plausible);
        for far_s in [8.2, 100.0, 1e9, 9e9, f64::MAX] {
            assert_eq!(take(100.1, far_s, 6.9), OrderTime::Ahead, "{far_s}");
        }
        assert_eq!(
            take(100.1, 7.1, 7.2),
            OrderTime::Ahead,
            "it answers a picture that does not exist yet"
        );
        // Late orders, then punctual ones, a pause of the game, and its continuation.
        for (now_s, stamp_s) in [
            (100.1, 7.1),
            (103.0, 7.2),
            (103.1, 10.1),
            (200.0, 10.2),
            (200.1, 10.3),
        ] {
            assert_eq!(
                take(now_s, stamp_s, stamp_s - 0.1),
                OrderTime::Plausible,
                "{now_s} {stamp_s}"
            );
        }
    }

    #[test]
    fn what_was_ordered_before_the_boat_joined_is_not_for_it() {
        let mut clock = GameClock::new(SimTime::from_s(1.0));
        assert_eq!(
            check(&mut clock, 100.0, 7.0, 6.9),
            OrderTime::BeforeJoining,
            "the boat has not joined"
        );
        clock = joined(100.0, 7.0);
        for before_s in [6.99, 0.0, -1e300] {
            assert_eq!(
                check(&mut clock, 100.1, before_s, -1e300),
                OrderTime::BeforeJoining,
                "{before_s}"
            );
        }
        assert_eq!(check(&mut clock, 100.1, 7.0, 6.0), OrderTime::Plausible);
        clock.join(SimTime::from_s(200.0), SimTime::from_s(1000.0));
        assert_eq!(
            check(&mut clock, 200.2, 7.1, 7.0),
            OrderTime::BeforeJoining,
            "from another game"
        );
        assert_eq!(
            check(&mut clock, 200.2, 1000.1, 1000.0),
            OrderTime::Plausible
        );
    }

    #[test]
    fn an_answer_that_took_its_time_refuses_nothing_that_the_sim_orders() {
        // Requested at 100 s; answered five seconds later, at 7 s of the game.
        let mut clock = joined(100.0, 7.0);
        assert_eq!(check(&mut clock, 105.0, 7.0, 6.9), OrderTime::Plausible);
        assert_eq!(check(&mut clock, 105.1, 7.1, 7.0), OrderTime::Plausible);
    }
}
