//! Shows one boat's helm live.

use super::super::helm_page;
use super::super::helm_query::{self, SILENCE};
use crate::screen;
use anyhow::{Result, bail};
use bus::clock;
use command_line::observer::Observer;
use messages::helm::HelmQuestion;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Shows the helm of the vehicle with this name, at this interval, until the game is over.
pub(super) fn watch(
    observer: &Observer,
    name: &str,
    pause: Duration,
    stop: &AtomicBool,
) -> Result<()> {
    let vehicle = observer.vehicle(name)?;
    let scenario = &observer.info.scenario;
    let live = std::io::stdout().is_terminal();
    let mut last = None;
    let mut heard = clock::now();
    while !stop.load(Ordering::Relaxed) {
        match helm_query::report(observer, vehicle, HelmQuestion { functions: false })? {
            Some(report) => {
                heard = clock::now();
                // If output cannot be overwritten, print each decision only once.
                let is_read = match live {
                    true => screen::is_seen(&helm_page::page(scenario, &report)),
                    false if last.replace(report.at) == Some(report.at) => true,
                    false => screen::is_read(&helm_page::line(scenario, &report)),
                };
                if !is_read {
                    return Ok(());
                }
            }
            None if !observer.is_on()? => return Ok(()),
            None if clock::since(heard) > SILENCE => bail!("{name} has no agent"),
            None => {}
        }
        clock::rest(pause);
    }
    Ok(())
}
