//! Identification: finds the parameters of a boat file for which the model reproduces a recorded
//! run.
//!
//! Read [`fit`] first; `problem` defines the minimised function.

mod fit;
mod gap;
mod log;
mod parameter;
mod problem;
mod rollout;

pub(crate) use fit::student_975;
pub use fit::{Confused, Estimate, Fit, NoFit, Quality, Step, fit, names, parameters};
pub use gap::{Band, Change, Frames, Gap, Place, QUANTITIES, Run, TURN_DEG, changes};
pub use log::Log;
pub use parameter::{CURRENT, PARAMETERS, Parameter, WIND};
pub use rollout::Setting;

/// A boat file with the fitted parameters, and everything else from `base`. `log` is the log's
/// name.
pub fn written(fit: &Fit, base: &str, log: &str) -> String {
    let mut text = format!(
        "# Fitted to {} by squall identify: value ± 95 %.\n",
        log.replace(['\n', '\r'], " ")
    );
    for quality in &fit.qualities {
        text += &format!(
            "# {}: rms {:.4} {}, R² {:.4}\n",
            quality.channel, quality.rms, quality.unit, quality.r_squared
        );
    }
    text += &format!("\nbase = {base:?}\n");
    for table in ["hull", "thruster"] {
        let mut of_table = fit
            .estimates
            .iter()
            .filter(|estimate| estimate.parameter.table == table)
            .peekable();
        if of_table.peek().is_some() {
            text += &format!("\n[{table}]\n");
        }
        for estimate in of_table {
            let key = estimate.parameter.key;
            let value = estimate.value;
            let plus_minus = estimate.plus_minus;
            text += &format!(
                "{key} = {value:.6} # ± {plus_minus:.6}, was {}\n",
                estimate.before
            );
        }
    }
    text
}
