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

use crate::{abridged, problems};

/// A name for the case, the strategy file `x.toml`, and what must be reported for it.
type Broken<'a> = (&'a str, &'a str, &'a [&'a str]);

fn assert_broken(cases: &[Broken<'_>]) {
    for (name, text, want) in cases {
        let got = problems("strategies/x.toml", &[("strategies/x.toml", text.as_bytes())]);
        let got: Vec<String> = got.iter().map(|line| abridged(line)).collect();
        let got: Vec<&str> = got.iter().map(|line| line.strip_prefix("strategies/x.toml:").unwrap_or(line)).collect();
        assert_eq!(got, *want, "{name}");
    }
}
