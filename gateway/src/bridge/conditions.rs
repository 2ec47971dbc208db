//! The current conditions, on which the supervisor bases its decisions.

use super::Bridge;
use super::on_site::OnSite;
use crate::supervisor::{Conditions, NavFault};
use primitives::SimTime;
use primitives::frame::Ned;

/// Positions of other boats expire after this time, s.
const OTHERS_AGE_MAX_S: f64 = 2.0;

impl Bridge {
    pub(super) fn conditions_at(&mut self, now: SimTime) -> Conditions {
        let (others_at, others) = &self.others;
        let known: &[Ned] = if (now - *others_at).as_s() <= OTHERS_AGE_MAX_S {
            others
        } else {
            &[]
        };
        let mut nav_fault = Some(NavFault::NoField);
        let mut thrust_fault = None;
        let mut inside = false;
        let mut blocked = false;
        let mut recovery_point = false;
        if let Some(site) = &mut self.on_site {
            recovery_point = self
                .recovery_point
                .taken()
                .is_some_and(|erp| site.is_way_to(now, erp));
            let OnSite {
                estimator,
                geofence,
                bow,
                ..
            } = site;
            (nav_fault, thrust_fault) = (estimator.fault(now), estimator.thrust_fault(now));
            if let Some((nav, _)) = estimator.nav(now) {
                // Use the faster of reported and measured speed at once: otherwise, with a log
                // stuck at zero, the boat could cross the fence before the instrument check finds
                // the fault.
                inside = geofence.is_inside(
                    now,
                    nav.at(),
                    (estimator.fastest_velocity_m_s(), nav.yaw_rate_rad_s),
                );
                blocked = bow.is_blocked(now, &nav, known);
            }
        }
        // The age counts from arrival by our own clock: the clocks of sim and gateway are not
        // synchronised.
        let ttl_s = self.plan.gateway.order_ttl_s;
        let order_fresh = self
            .order
            .is_some_and(|current| (now - current.came).as_s() <= ttl_s);
        Conditions {
            link: self.link_up,
            hung_s: self.hung_s,
            control: self.control.fault(now),
            nav: nav_fault,
            thrust: thrust_fault,
            recovery_point,
            inside,
            battery_low: self.battery.is_low(now),
            blocked,
            order_fresh,
            may_rearm: self.rearm.is_allowed(now, order_fresh),
        }
    }
}
