//! The decision of a helm as a string.

use messages::helm::HelmReport;

/// The decision, or the reason why there is none.
pub(crate) fn decision(report: &HelmReport) -> String {
    match (report.course_deg, report.speed_m_s, &report.hold) {
        (Some(course_deg), Some(speed_m_s), _) => {
            format!("course {course_deg:.0}°, {speed_m_s:.2} m/s")
        }
        (_, _, Some(why)) => format!("holds: {why}"),
        _ => "holds".to_owned(),
    }
}
