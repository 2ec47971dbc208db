//! A key in the terminal of a gateway: Enter.

use bus::clock;
use rustix::fs::OFlags;
use std::fs::{File, OpenOptions};
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::time::Duration;

/// How often the terminal is looked at.
const LOOK: Duration = Duration::from_millis(50);

/// Calls `pressed` whenever Enter is pressed in the terminal of this process, as long as that is there.
///
/// A process in the background that reads from its terminal is suspended by the system, and its boat goes on: so nothing is read
/// while this one is not in the foreground, and no read waits.
pub fn on_enter(pressed: impl Fn() + Send + 'static) {
    let flags = OFlags::NONBLOCK.bits().cast_signed();
    let Ok(mut terminal) = OpenOptions::new().read(true).custom_flags(flags).open("/dev/tty") else { return };
    let read = move || {
        let mut bytes = [0; 256];
        loop {
            clock::rest(LOOK);
            if !is_in_foreground(&terminal) {
                continue;
            }
            match terminal.read(&mut bytes) {
                Ok(0) => return,
                Ok(count) if bytes[..count].contains(&b'\n') => pressed(),
                Ok(_) => {}
                Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => {}
                // The terminal is gone.
                Err(_) => return,
            }
        }
    };
    // Without a thread for it there is no key; nothing else is lost.
    drop(std::thread::Builder::new().name("terminal key".to_owned()).spawn(read));
}

fn is_in_foreground(terminal: &File) -> bool {
    rustix::termios::tcgetpgrp(terminal).is_ok_and(|group| group == rustix::process::getpgrp())
}
