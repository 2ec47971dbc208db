//! The running program: its name, and the prefix of its gateway commands.

use std::sync::OnceLock;

/// The name and command prefix of a program.
#[derive(Debug)]
pub struct Program {
    /// Its name, the prefix of all error messages.
    pub name: &'static str,
    /// The prefix of a gateway command as the user types it.
    pub gateway: &'static str,
}

static PROGRAM: OnceLock<Program> = OnceLock::new();

/// Sets the running program. `main` calls this first; later calls have no effect.
pub fn set(program: Program) {
    drop(PROGRAM.set(program));
}

fn this() -> &'static Program {
    PROGRAM.get_or_init(|| Program { name: "squall", gateway: "squall gateway" })
}

/// The program's name.
pub fn name() -> &'static str {
    this().name
}

/// The prefix of its gateway commands: `squall gateway` or `squall-gateway`.
pub fn gateway() -> &'static str {
    this().gateway
}

/// Replaces `{gateway}` in a text by the prefix of gateway commands.
pub fn text(template: &str) -> String {
    template.replace("{gateway}", gateway())
}
