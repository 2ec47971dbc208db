//! The part of a bridge that needs the field: navigation, geofence, the box about the bow, set-points.

use super::Site;
use crate::geodesy::LocalFrame;
use crate::geofence::{BowWatch, GeofenceWatch};
use crate::nav_estimate::NavEstimator;
use crate::set_point::SetPointMapper;
use game::external::Mission;
use game::gateway::{BoatProtocol, Gateway};

/// What only works where the field is known.
pub(super) struct OnSite {
    pub(super) estimator: NavEstimator,
    pub(super) geofence: GeofenceWatch,
    pub(super) bow: BowWatch,
    pub(super) set_points: SetPointMapper,
}

impl OnSite {
    pub(super) fn new(gateway: &Gateway, site: &Site) -> OnSite {
        let Gateway { nav, limits, geofence, halt, compass, protocol, .. } = gateway;
        let frame = LocalFrame::new(site.field.plan.datum);
        let compass_to_true_rad = match protocol {
            BoatProtocol::Surveyor => site.compass_to_true_rad(*compass),
            // Its headings are true, and so are those that it is sent.
            BoatProtocol::Mavlink => 0.0,
        };
        OnSite {
            set_points: SetPointMapper::new(gateway, compass_to_true_rad),
            estimator: NavEstimator::new(frame, *nav, compass_to_true_rad, limits.speed_max_m_s),
            geofence: GeofenceWatch::new(&site.field, *geofence),
            bow: BowWatch::new(*halt, site.length_m),
        }
    }

    /// Whether all places of a mission are inside of the geofence.
    pub(super) fn contains(&self, mission: &Mission) -> bool {
        let places = std::iter::once(&mission.erp).chain(&mission.waypoints);
        // The upload refuses invalid positions with a better reason.
        let spots = places.filter(|[lat_deg, lon_deg]| lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0);
        spots
            .map(|[lat_deg, lon_deg]| self.estimator.place(*lat_deg, *lon_deg))
            .all(|place| self.geofence.contains(place))
    }
}
