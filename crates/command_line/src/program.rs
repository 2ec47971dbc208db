//! The program that runs: its name, and how people type its gateway commands.

use std::sync::OnceLock;

/// What a program says of itself.
#[derive(Debug)]
pub struct Program {
    /// Its name, before everything that goes wrong.
    pub name: &'static str,
    /// What people type before a gateway command.
    pub gateway: &'static str,
}

static PROGRAM: OnceLock<Program> = OnceLock::new();

/// Says which program this is. The first time counts: `main` does it before anything else.
pub fn set(program: Program) {
    drop(PROGRAM.set(program));
}

fn this() -> &'static Program {
    PROGRAM.get_or_init(|| Program { name: "squall", gateway: "squall gateway" })
}

/// Its name.
pub fn name() -> &'static str {
    this().name
}

/// How its gateway commands begin: `squall gateway` or `squall-gateway`.
pub fn gateway() -> &'static str {
    this().gateway
}

/// A text in which `{gateway}` is how its gateway commands begin.
pub fn text(template: &str) -> String {
    template.replace("{gateway}", gateway())
}
