//! The game's time as a gateway knows it: from the stamps of orders, and its own clock.

use game::SimTime;
use game::external::ExternalOrder;

/// Tells orders that come from a time the game cannot have come to.
///
/// The game goes no faster than the gateway's clock, so the difference of the two can only shrink: by delays, pauses, and a
/// sim that does not keep up. The largest that was seen is the best that is known.
#[derive(Clone, Copy, Debug)]
pub struct GameClock {
    ahead_max: SimTime,
    /// Time of the game less our own.
    difference: Option<SimTime>,
}

impl GameClock {
    /// One that knows no game yet, and takes stamps that are ahead of it by this much at most.
    #[must_use]
    pub fn new(ahead_max: SimTime) -> GameClock {
        GameClock { ahead_max, difference: None }
    }

    /// Another game, or none.
    pub fn forget(&mut self) {
        self.difference = None;
    }

    /// Takes the stamp of an order, unless the game cannot have come to it or to the picture that the order answers; says
    /// whether it did. The first is taken as it is.
    pub fn take(&mut self, now: SimTime, order: &ExternalOrder) -> bool {
        let (stamp, given) = (order.stamp.valid_ns, order.given_ns);
        // Anybody may have sent it, with any number.
        let difference = SimTime(stamp.0.saturating_sub(now.0));
        let known = self.difference.unwrap_or(difference);
        if given > stamp || stamp >= SimTime::NEVER || difference.0.saturating_sub(known.0) > self.ahead_max.0 {
            return false;
        }
        self.difference = Some(known.max(difference));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::message::{Stamp, VehicleOrder};
    use game::{Order, VehicleId};

    fn order(stamp_s: f64, given_s: f64) -> ExternalOrder {
        let stamp = Stamp { valid_ns: SimTime::from_s(stamp_s), ..Stamp::default() };
        let order = VehicleOrder::new(VehicleId(0), Order::Hold);
        ExternalOrder { stamp, given_ns: SimTime::from_s(given_s), order }
    }

    #[test]
    fn what_the_game_has_not_come_to_is_refused_and_what_comes_next_is_not() {
        let mut clock = GameClock::new(SimTime::from_s(1.0));
        let mut take = |now_s: f64, stamp_s, given_s| clock.take(SimTime::from_s(now_s), &order(stamp_s, given_s));
        assert!(take(100.0, 7.0, 6.9), "the first");
        for far_s in [8.2, 100.0, 1e9, 9e9, f64::MAX] {
            assert!(!take(100.1, far_s, 6.9), "{far_s}");
        }
        assert!(!take(100.1, 7.1, 7.2), "it answers a picture that there is not yet");
        assert!(take(100.1, 7.1, 7.0));
        // Late ones, and those that came on time after them.
        assert!(take(103.0, 7.2, 7.1) && take(103.1, 10.1, 10.0));
        // A pause of the game, and going on.
        assert!(take(200.0, 10.2, 10.1) && take(200.1, 10.3, 10.2));
        clock.forget();
        assert!(clock.take(SimTime::from_s(200.2), &order(1000.0, 0.0)), "another game");
        assert!(!clock.take(SimTime::from_s(200.3), &order(-1e300, 0.0)), "{clock:?}");
    }
}
