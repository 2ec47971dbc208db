//! The Enter key in the terminal of a gateway.

use bus::clock;
use rustix::fs::OFlags;
use std::fs::{File, OpenOptions};
use std::io::Read;
use std::os::unix::fs::OpenOptionsExt;
use std::time::Duration;

/// How often the terminal is polled.
const POLL: Duration = Duration::from_millis(50);

/// Calls `pressed` whenever Enter is pressed in this process's terminal, if it has one.
///
/// The system suspends a background process that reads from its terminal, while its boat continues.
/// Therefore the thread reads only while this process is in the foreground, and no read blocks.
pub fn on_enter(pressed: impl Fn() + Send + 'static) {
    let flags = OFlags::NONBLOCK.bits().cast_signed();
    let Ok(mut terminal) = OpenOptions::new()
        .read(true)
        .custom_flags(flags)
        .open("/dev/tty")
    else {
        return;
    };
    let read = move || {
        let mut bytes = [0; 256];
        loop {
            clock::rest(POLL);
            if !is_in_foreground(&terminal) {
                continue;
            }
            match terminal.read(&mut bytes) {
                Ok(0) => return,
                Ok(count) if bytes[..count].contains(&b'\n') => pressed(),
                Ok(_) => {}
                Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => {}
                // The terminal was closed.
                Err(_) => return,
            }
        }
    };
    // If the thread cannot start, only the key does not work.
    drop(
        std::thread::Builder::new()
            .name("terminal key".to_owned())
            .spawn(read),
    );
}

fn is_in_foreground(terminal: &File) -> bool {
    rustix::termios::tcgetpgrp(terminal).is_ok_and(|group| group == rustix::process::getpgrp())
}
