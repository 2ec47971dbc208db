//! Mistakes in strategies.

mod behaviour;
mod expression;
mod guard;
mod mode;
mod reach;
mod role;
mod safety;
mod shape;
mod variable;

/// What a file says that is laid over a sound one.
const BASE: &str = "base = \"s.toml\"\n";

/// The same, with variables.
const VARIABLES: &str = r#"base = "s.toml"
variables.alarmed = false
variables.laps = 0
variables.phase = { values = ["go", "return"], shared = true }
"#;

/// Checks that broken strategies, which begin with `head`, are reported as they say themselves.
fn assert_broken(head: &str, cases: &str) {
    crate::assert_broken("strategies/x.toml", head, cases);
}
