//! The running program: its name, and the prefix of its gateway commands.

use std::sync::OnceLock;

/// The program's name, and the prefix of a gateway command as the user types it.
static PROGRAM: OnceLock<[&str; 2]> = OnceLock::new();

/// Sets the running program: its name, which begins all error messages, and the prefix of its
/// gateway commands. `main` calls this first; later calls have no effect.
pub fn set(name: &'static str, gateway: &'static str) {
    let _ = PROGRAM.set([name, gateway]);
}

/// The program's name.
pub fn name() -> &'static str {
    PROGRAM.get().map_or("squall", |[name, _]| name)
}

/// The prefix of its gateway commands: `squall gateway` or `squall-gateway`.
pub fn gateway() -> &'static str {
    PROGRAM
        .get()
        .map_or("squall gateway", |[_, gateway]| gateway)
}

/// Replaces `{gateway}` in a string with the prefix of gateway commands.
pub fn text(template: &str) -> String {
    template.replace("{gateway}", gateway())
}
