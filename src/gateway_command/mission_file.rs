//! Missions in `.sea` files: the lines that a boat receives.

use anyhow::{Context, Result, bail};
use game::external::Mission;
use gateway::nmea::{Framer, Sentence};
use std::path::Path;

/// The longest mission file, bytes: many times what a boat takes.
const BYTES_MAX: u64 = 1 << 20;

/// The mission in a `.sea` file.
pub(super) fn read(path: &Path) -> Result<Mission> {
    let bytes = game::input_file::read(path, BYTES_MAX).with_context(|| format!("cannot read {}", path.display()))?;
    let (mut throttle_pct, mut places, mut wrong) = (None, Vec::new(), None);
    let mut framer = Framer::new();
    framer.push(&[bytes.as_slice(), b"\r\n"].concat(), &mut |body| match Sentence::parse(body) {
        Ok(Sentence::MissionSettings(settings)) => throttle_pct = Some(settings.throttle_pct),
        Ok(Sentence::Waypoint(waypoint)) => places.push((waypoint.index, [waypoint.at.lat_deg, waypoint.at.lon_deg])),
        Ok(Sentence::Command(_)) => {}
        Ok(_) => wrong = Some(format!("{body:?} has no place in a mission")),
        Err(e) => wrong = Some(e.to_string()),
    });
    let counts = framer.counts();
    let unread = counts.bad_checksum + counts.broken + counts.overlong + counts.garbage;
    if unread > 0 {
        wrong = Some(format!(
            "{} wrong checksums, {} lines that are no sentences",
            counts.bad_checksum,
            unread - counts.bad_checksum
        ));
    }
    places.sort_by_key(|(index, _)| *index);
    let in_order = places.iter().enumerate().all(|(i, (index, _))| usize::from(*index) == i);
    if let Some(wrong) = wrong {
        bail!("{}: {wrong}", path.display());
    }
    if !in_order || places.len() < 2 {
        bail!(
            "{}: waypoints {:?}, expected 0 (the recovery point), 1 and so on",
            path.display(),
            places.iter().map(|(i, _)| i).collect::<Vec<_>>()
        );
    }
    let throttle_pct = throttle_pct.with_context(|| format!("{}: no PSEAR line with the throttle", path.display()))?;
    let mut places = places.into_iter().map(|(_, place)| place);
    let erp = places.next().context("a recovery point is there")?;
    Ok(Mission { throttle_pct, erp, waypoints: places.collect() })
}
