//! The game's time as a gateway knows it: from the sim's answer when it joins, from the stamps of orders, and its own clock.

use messages::external::ExternalOrder;
use primitives::SimTime;

/// Tells orders that come from a time the game cannot have come to, and from before the boat joined it.
///
/// The game goes no faster than the gateway's clock, so the difference of the two can only shrink: by delays, pauses, and a
/// sim that does not keep up. The largest that was seen is the best that is known. When the boat joins, the difference is no
/// larger than that of the time in the sim's answer and of our own when it was asked.
#[derive(Clone, Copy, Debug)]
pub struct GameClock {
    ahead_max: SimTime,
    joined: Option<Joined>,
}

/// What is known of a game that the boat has joined.
#[derive(Clone, Copy, Debug)]
struct Joined {
    /// Time of the game then.
    since: SimTime,
    /// Time of the game less our own, at most and as far as orders have shown it.
    most: SimTime,
    seen: Option<SimTime>,
}

/// What the time of an order says of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderTime {
    /// It may be what the sim wants now.
    Plausible,
    /// The game has not come to it, or not to the picture that it answers.
    Ahead,
    /// It is from before the boat joined, or the boat has not.
    BeforeJoining,
}

impl GameClock {
    /// One that knows no game yet, and takes stamps that are ahead of it by this much at most.
    #[must_use]
    pub fn new(ahead_max: SimTime) -> GameClock {
        GameClock { ahead_max, joined: None }
    }

    /// The boat, which asked at the time `asked` of our own, has joined a game whose time was `since` at some moment after
    /// that.
    pub fn join(&mut self, asked: SimTime, since: SimTime) {
        // The answer was made after it was asked for, so the game cannot be further ahead of
        // our clock than this; how long the answer travelled is unknown, and only makes the
        // bound safer.
        let most = SimTime(since.0.saturating_sub(asked.0));
        self.joined = Some(Joined { since, most, seen: None });
    }

    /// Checks the time of an order that came at `now`.
    pub fn check(&mut self, now: SimTime, order: &ExternalOrder) -> OrderTime {
        let (stamp, given) = (order.stamp.valid_ns, order.given_ns);
        let Some(joined) = &mut self.joined else { return OrderTime::BeforeJoining };
        if stamp < joined.since {
            return OrderTime::BeforeJoining;
        }
        // Anybody may have sent it, with any number.
        let difference = SimTime(stamp.0.saturating_sub(now.0));
        let known = joined.seen.unwrap_or(joined.most);
        // An order far in the future would count as newer than all real ones that follow, and
        // silence the sim until then.
        if given > stamp || stamp >= SimTime::NEVER || difference.0.saturating_sub(known.0) > self.ahead_max.0 {
            return OrderTime::Ahead;
        }
        // Only the largest difference is kept: a game that pauses or slows down falls behind
        // our clock, which makes nothing suspicious.
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
        let stamp = Stamp { valid_ns: SimTime::from_s(stamp_s), ..Stamp::default() };
        let order = VehicleOrder::new(VehicleId(0), Order::Hold);
        ExternalOrder { stamp, given_ns: SimTime::from_s(given_s), order }
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
            assert_eq!(take(100.0, far_s, 6.9), OrderTime::Ahead, "the first, at {far_s}");
        }
        assert_eq!(take(100.0, 7.0, 6.9), OrderTime::Plausible);
        for far_s in [8.2, 100.0, 1e9, 9e9, f64::MAX] {
            assert_eq!(take(100.1, far_s, 6.9), OrderTime::Ahead, "{far_s}");
        }
        assert_eq!(take(100.1, 7.1, 7.2), OrderTime::Ahead, "it answers a picture that there is not yet");
        // Late ones and those that came on time after them; a pause of the game, and going on.
        for (now_s, stamp_s) in [(100.1, 7.1), (103.0, 7.2), (103.1, 10.1), (200.0, 10.2), (200.1, 10.3)] {
            assert_eq!(take(now_s, stamp_s, stamp_s - 0.1), OrderTime::Plausible, "{now_s} {stamp_s}");
        }
    }

    #[test]
    fn what_was_ordered_before_the_boat_joined_is_not_for_it() {
        let mut clock = GameClock::new(SimTime::from_s(1.0));
        assert_eq!(check(&mut clock, 100.0, 7.0, 6.9), OrderTime::BeforeJoining, "nobody has let it in");
        clock = joined(100.0, 7.0);
        for before_s in [6.99, 0.0, -1e300] {
            assert_eq!(check(&mut clock, 100.1, before_s, -1e300), OrderTime::BeforeJoining, "{before_s}");
        }
        assert_eq!(check(&mut clock, 100.1, 7.0, 6.0), OrderTime::Plausible);
        clock.join(SimTime::from_s(200.0), SimTime::from_s(1000.0));
        assert_eq!(check(&mut clock, 200.2, 7.1, 7.0), OrderTime::BeforeJoining, "of another game");
        assert_eq!(check(&mut clock, 200.2, 1000.1, 1000.0), OrderTime::Plausible);
    }

    #[test]
    fn an_answer_that_took_its_time_refuses_nothing_that_the_sim_orders() {
        // Asked at 100 s; answered, at 7 s of the game, five seconds later.
        let mut clock = joined(100.0, 7.0);
        assert_eq!(check(&mut clock, 105.0, 7.0, 6.9), OrderTime::Plausible);
        assert_eq!(check(&mut clock, 105.1, 7.1, 7.0), OrderTime::Plausible);
    }
}
