//! Identification: finds the parameters of a boat file with which the model reproduces a recorded
//! run.
//!
//! Open [`fit`] first; `problem` defines the minimised function.

mod fit;
mod log;
mod parameter;
mod problem;
mod rollout;

pub use fit::{Confused, Estimate, Fit, NoFit, Quality, Step, fit, names, parameters};
pub use log::Log;
pub use parameter::{PARAMETERS, Parameter};
pub use rollout::Setting;

use std::fmt::Write;

/// A boat file with the fitted parameters and everything else from `base`. `log` is the log's name.
#[must_use]
pub fn written(fit: &Fit, base: &str, log: &str) -> String {
    let mut text = format!("# Fitted to {} by squall identify: value ± 95 %.\n", log.replace(['\n', '\r'], " "));
    let mut line = |args: std::fmt::Arguments<'_>| {
        text.write_fmt(args).expect("writing to a String cannot fail");
        text.push('\n');
    };
    for quality in &fit.qualities {
        line(format_args!(
            "# {}: rms {:.4} {}, R² {:.4}",
            quality.channel, quality.rms, quality.unit, quality.r_squared
        ));
    }
    line(format_args!("\nbase = {base:?}"));
    for table in ["hull", "thruster"] {
        let mut of_table = fit.estimates.iter().filter(|estimate| estimate.parameter.table == table).peekable();
        if of_table.peek().is_some() {
            line(format_args!("\n[{table}]"));
        }
        for estimate in of_table {
            let (key, value, plus_minus) = (estimate.parameter.key, estimate.value, estimate.plus_minus);
            line(format_args!("{key} = {value:.6} # ± {plus_minus:.6}, was {}", estimate.before));
        }
    }
    text
}
