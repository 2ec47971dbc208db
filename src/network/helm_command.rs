//! `squall helm`: prints one decision of a boat's helm as a table, and optionally writes it as CSV.

use super::{helm_page, helm_query};
use crate::screen;
use anyhow::{Context, Result, bail};
use command_line::leaf_args::LeafArgs;
use command_line::observer::Observer;
use messages::helm::{HelmQuestion, HelmReport};
use scenario::Scenario;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Name of the vehicle
    #[arg(long, value_name = "NAME")]
    vehicle: String,
    #[command(flatten)]
    leaf: LeafArgs,
    /// Writes the utility of every course and speed, for each behaviour and in total, to this file
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// The name of the sum of all behaviours.
const COLLECTIVE: &str = "collective";

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let observer = Observer::connect(&args.leaf)?;
    let vehicle = observer.vehicle(&args.vehicle)?;
    let report = helm_query::report_of_agent(&observer, vehicle, HelmQuestion { functions: true })?;
    let scenario = &observer.info.scenario;
    if report
        .functions
        .iter()
        .any(|function| function.utilities.is_empty())
    {
        bail!(
            "the helm of {} has made no decision since the query; try again",
            args.vehicle
        );
    }
    screen::print(&helm_page::page(scenario, &report));
    if let Some(path) = &args.csv {
        write_csv(path, scenario, &report)
            .with_context(|| format!("cannot write the utilities to {}", path.display()))?;
    }
    observer.bus.close();
    Ok(ExitCode::SUCCESS)
}

/// One row for each objective function, course and speed; then the sums. The helm chooses the
/// largest sum.
fn write_csv(path: &Path, scenario: &Scenario, report: &HelmReport) -> Result<()> {
    let mut csv = csv::Writer::from_path(path)?;
    csv.write_record([
        "behaviour",
        "contact",
        "weight",
        "course_deg",
        "speed_m_s",
        "utility",
    ])?;
    let mut write =
        |behaviour: &str, contact: &str, weight: f64, utilities: &mut dyn Iterator<Item = f64>| {
            for (i, utility) in utilities.enumerate() {
                let k = (i / report.speeds) as f64;
                let j = (i % report.speeds) as f64;
                let course_deg = 360.0 * k / report.courses as f64;
                let speed_m_s = report.speed_max_m_s * j / (report.speeds - 1) as f64;
                let numbers =
                    [weight, course_deg, speed_m_s, utility].map(|number| number.to_string());
                let [weight, course, speed, utility] = numbers.each_ref().map(String::as_str);
                csv.write_record([behaviour, contact, weight, course, speed, utility])?;
            }
            anyhow::Ok(())
        };
    for function in &report.functions {
        let contact = function.contact.map_or("", |contact| {
            scenario.vehicles[contact.index()].name.as_str()
        });
        let utilities = &mut function.utilities.iter().map(|utility| f64::from(*utility));
        write(&function.behaviour, contact, function.weight, utilities)?;
    }
    let weight: f64 = report
        .functions
        .iter()
        .map(|function| function.weight)
        .sum();
    write(
        COLLECTIVE,
        "",
        weight,
        &mut report.sum(report.functions.iter()).into_iter(),
    )?;
    Ok(csv.flush()?)
}
