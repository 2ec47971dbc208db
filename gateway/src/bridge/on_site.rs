//! The part of a bridge that needs the field: navigation, geofence, the box around the bow, and
//! set-points.

use super::Site;
use crate::bow_watch::BowWatch;
use crate::config::{BoatProtocol, CompassFrame, Gateway};
use crate::geodesy::LocalFrame;
use crate::geofence::GeofenceWatch;
use crate::nav_estimate::NavEstimator;
use crate::set_point::SetPointMapper;
use crate::supervisor::Task;
use messages::external::{BoatMode, GeofenceReport, Mission};
use primitives::SimTime;
use primitives::frame::Ned;

/// The parts that work only with a known field.
pub(super) struct OnSite {
    pub(super) estimator: NavEstimator,
    pub(super) geofence: GeofenceWatch,
    pub(super) bow: BowWatch,
    pub(super) set_points: SetPointMapper,
}

impl OnSite {
    pub(super) fn new(gateway: &Gateway, site: &Site) -> OnSite {
        let Gateway {
            nav,
            limits,
            geofence,
            halt,
            compass,
            protocol,
            ..
        } = gateway;
        let frame = LocalFrame::new(site.field.plan.datum);
        // Correction from the boat's headings to true headings, rad.
        let compass_to_true_rad = match (protocol, compass) {
            (BoatProtocol::Surveyor, CompassFrame::Magnetic) => site.declination_rad,
            // MAVLink boats report and receive true headings.
            (BoatProtocol::Surveyor, CompassFrame::True) | (BoatProtocol::Mavlink, _) => 0.0,
        };
        OnSite {
            set_points: SetPointMapper::new(gateway, compass_to_true_rad),
            estimator: NavEstimator::new(frame, *nav, compass_to_true_rad, limits.speed_max_m_s),
            geofence: GeofenceWatch::new(&site.field, geofence, site.coasting),
            bow: BowWatch::new(*halt, site.length_m),
        }
    }

    /// The first part of a mission that is outside the geofence, if any: a waypoint, the recovery
    /// point, a leg, or the path to the first waypoint.
    pub(super) fn outside(&self, now: SimTime, mission: &Mission) -> Option<String> {
        // The upload rejects invalid positions with a better reason.
        let on_globe =
            |[lat_deg, lon_deg]: &&[f64; 2]| lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0;
        let place = |[lat_deg, lon_deg]: &[f64; 2]| self.estimator.place(*lat_deg, *lon_deg);
        let area = &self.geofence.area;
        let places = std::iter::once(&mission.erp)
            .chain(&mission.waypoints)
            .filter(on_globe);
        if !places.map(place).all(|place| area.contains(place)) {
            return Some("a waypoint or the recovery point is outside the geofence".to_owned());
        }
        let boat = self.estimator.nav(now).map(|(nav, _)| nav.at());
        // The path to the first waypoint is also a leg: the boat drives straight there, whatever
        // lies in between.
        let way: Vec<Ned> = boat
            .into_iter()
            .chain(mission.waypoints.iter().filter(on_globe).map(place))
            .collect();
        let first = usize::from(boat.is_none());
        let leg = way
            .windows(2)
            .position(|leg| !area.contains_way(leg[0], leg[1]))?
            + first;
        let from = if leg == 0 {
            "the boat".to_owned()
        } else {
            format!("waypoint {leg}")
        };
        Some(format!(
            "the leg from {from} to waypoint {} leaves the geofence or crosses a keep-out",
            leg + 1
        ))
    }

    /// Whether the geofence allows the straight path from the boat to its recovery point.
    pub(super) fn is_way_to(&self, now: SimTime, [lat_deg, lon_deg]: [f64; 2]) -> bool {
        let erp = self.estimator.place(lat_deg, lon_deg);
        let from = self.estimator.nav(now).map_or(erp, |(nav, _)| nav.at());
        // A boat outside may drive back in: that is when it needs a recovery point most.
        self.geofence.area.leads_in(from, erp)
    }

    /// A task with its heading converted to the boat's compass frame.
    pub(super) fn by_compass(&self, task: Task) -> Task {
        match task {
            Task::Mode(BoatMode::Heading {
                heading_deg,
                thrust_pct,
            }) => {
                let heading_deg = self.set_points.compass_deg(heading_deg.to_radians());
                Task::Mode(BoatMode::Heading {
                    heading_deg,
                    thrust_pct,
                })
            }
            task => task,
        }
    }

    /// The geofence, for display.
    pub(super) fn geofence_report(&self, now: SimTime) -> GeofenceReport {
        let area = &self.geofence.area;
        let nav = self.estimator.nav(now).map(|(nav, _)| nav);
        let at = nav.map(|nav| nav.at());
        let yaw_rate_rad_s = nav.map_or(0.0, |nav| nav.yaw_rate_rad_s);
        let way = self
            .geofence
            .stopping_way(now, (self.estimator.fastest_velocity_m_s(), yaw_rate_rad_s));
        GeofenceReport {
            outline: area.outline.clone(),
            keep_out: area.keep_out.clone(),
            clearance_m: at.map(|at| area.clearance_m(at)),
            stopping_m: at.map(|_| way.length()),
            stops_at: at.map(|at| at + way),
        }
    }
}
