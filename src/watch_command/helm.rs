//! One boat's helm, live.

use super::rest;
use crate::onlooker::Onlooker;
use crate::{helm_page, screen};
use anyhow::{Result, bail};
use game::helm::HelmQuestion;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A boat without a mind for this long has none, s.
const SILENCE_S: f64 = 10.0;

/// Shows what the helm of the vehicle of this name thinks until the game is over, this often.
pub(super) fn watch(onlooker: &Onlooker, name: &str, pause: Duration, stop: &AtomicBool) -> Result<()> {
    let vehicle = onlooker.vehicle(name)?;
    let scenario = &onlooker.notice.scenario;
    let live = std::io::stdout().is_terminal();
    let mut last = None;
    let mut silent_s = 0.0;
    while !stop.load(Ordering::Relaxed) {
        match onlooker.helm(vehicle, HelmQuestion { functions: false })? {
            Some(report) => {
                silent_s = 0.0;
                // On paper a decision is told once.
                if live {
                    screen::print(&format!("\x1b[H\x1b[J{}", helm_page::page(scenario, &report)));
                } else if last.replace(report.at) != Some(report.at) {
                    screen::print(&helm_page::line(scenario, &report));
                }
            }
            None if !onlooker.is_on()? => return Ok(()),
            None if silent_s >= SILENCE_S => bail!("nobody minds {name}"),
            None => silent_s += pause.as_secs_f64(),
        }
        rest(pause);
    }
    Ok(())
}
