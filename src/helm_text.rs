//! What a helm decided, in words.

use messages::helm::HelmReport;

/// What was decided, or why nothing was.
pub(crate) fn decision(report: &HelmReport) -> String {
    match (report.course_deg, report.speed_m_s, &report.hold) {
        (Some(course_deg), Some(speed_m_s), _) => format!("course {course_deg:.0}°, {speed_m_s:.2} m/s"),
        (_, _, Some(why)) => format!("holds: {why}"),
        _ => "holds".to_owned(),
    }
}
