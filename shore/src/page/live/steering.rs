//! The wheels of boats that pages steer: one page at a time has one.

use game::VehicleId;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// A page that is silent for so long has let go.
const SILENCE: Duration = Duration::from_secs(2);

/// Who has which wheel, and said so last when.
#[derive(Clone, Debug, Default)]
pub(super) struct Steering(BTreeMap<VehicleId, (u64, Instant)>);

impl Steering {
    /// A page wants to steer; whether it has the wheel now.
    pub(super) fn grip(&mut self, vehicle: VehicleId, page: u64, now: Instant) -> bool {
        self.expire(now);
        let (holder, at) = self.0.entry(vehicle).or_insert((page, now));
        if *holder == page {
            *at = now;
        }
        *holder == page
    }

    /// A page lets go; whether it had the wheel.
    pub(super) fn let_go(&mut self, vehicle: VehicleId, page: u64) -> bool {
        let has = self.holder(vehicle) == Some(page);
        if has {
            self.0.remove(&vehicle);
        }
        has
    }

    /// A page goes, and lets go of all it has.
    pub(super) fn leave(&mut self, page: u64) {
        self.0.retain(|_, (holder, _)| *holder != page);
    }

    /// Frees the wheels of those who are silent; whether there were any.
    pub(super) fn expire(&mut self, now: Instant) -> bool {
        let before = self.0.len();
        self.0.retain(|_, (_, at)| now.saturating_duration_since(*at) < SILENCE);
        self.0.len() != before
    }

    /// Who has this one.
    pub(super) fn holder(&self, vehicle: VehicleId) -> Option<u64> {
        self.0.get(&vehicle).map(|(holder, _)| *holder)
    }

    /// All that somebody has.
    pub(super) fn held(&self) -> impl Iterator<Item = VehicleId> + '_ {
        self.0.keys().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::clock;

    #[test]
    fn one_page_has_the_wheel_until_it_lets_go_goes_or_is_silent() {
        let start = clock::now();
        let later = |s: f64| start + Duration::from_secs_f64(s);
        let (a, b) = (VehicleId(0), VehicleId(1));
        let mut wheels = Steering::default();
        assert!(wheels.grip(a, 1, start) && !wheels.grip(a, 2, later(1.9)) && wheels.grip(b, 2, start));
        assert!(!wheels.let_go(a, 2) && wheels.let_go(a, 1) && wheels.grip(a, 2, later(1.9)));
        assert!(!wheels.expire(later(1.0)) && wheels.expire(later(2.5)), "b is free");
        assert_eq!(wheels.held().collect::<Vec<_>>(), [a]);
        assert!(wheels.grip(a, 2, later(3.0)) && !wheels.grip(a, 3, later(4.9)) && wheels.grip(a, 3, later(5.1)));
        wheels.leave(3);
        assert_eq!(wheels.holder(a), None);
    }
}
