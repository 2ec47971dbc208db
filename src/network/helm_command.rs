//! `squall helm`: one decision of a boat's helm, in a table, as numbers and as pictures.

use super::{helm_page, helm_query};
use crate::plot::Page;
use crate::{helm_text, plot, screen};
use anyhow::{Context, Result, bail};
use game::Scenario;
use game::helm::{HelmQuestion, HelmReport};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

mod heat;
mod polar;

use command_line::leaf_args::LeafArgs;
use command_line::observer::Observer;
use polar::PolarPlot;

/// Whose, and into which files.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The vehicle, by name
    #[arg(long, value_name = "NAME")]
    vehicle: String,
    #[command(flatten)]
    leaf: LeafArgs,
    /// Writes the utility of every course and speed, by behaviour and in all, into this file
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draws the same into this file, as PNG
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Draws the same into this file, as SVG
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

/// What the sum of all behaviours is called.
const COLLECTIVE: &str = "collective";

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let observer = Observer::connect(&args.leaf)?;
    let vehicle = observer.vehicle(&args.vehicle)?;
    let report = helm_query::report_of_agent(&observer, vehicle, HelmQuestion { functions: true })?;
    let scenario = &observer.info.scenario;
    if report.functions.iter().any(|function| function.utilities.is_empty()) {
        bail!("the helm of {} has not decided since it was asked; ask again", args.vehicle);
    }
    screen::print(&helm_page::page(scenario, &report));
    if let Some(path) = &args.csv {
        write_csv(path, scenario, &report)
            .with_context(|| format!("cannot write the functions to {}", path.display()))?;
    }
    if args.png.is_some() || args.svg.is_some() {
        let title = format!(
            "{} ({}) at {:.1} s: {}; {}",
            args.vehicle,
            report.program,
            report.at.as_s(),
            report.mode,
            helm_text::decision(&report)
        );
        let panels = plots(&report);
        let columns = panels.len().min(polar::COLUMNS_MAX);
        let page = Page { title, columns, panel: polar::PANEL, panels };
        args.png.iter().try_for_each(|path| plot::write_png(path, &page))?;
        args.svg.iter().try_for_each(|path| plot::write_svg(path, &page))?;
    }
    observer.bus.close();
    Ok(ExitCode::SUCCESS)
}

fn course_deg(report: &HelmReport, k: usize) -> f64 {
    360.0 * k as f64 / report.courses as f64
}

fn speed_m_s(report: &HelmReport, j: usize) -> f64 {
    report.speed_max_m_s * j as f64 / (report.speeds - 1) as f64
}

/// A row for each function, course and speed; then the sums, of which the largest is what the helm takes.
fn write_csv(path: &Path, scenario: &Scenario, report: &HelmReport) -> Result<()> {
    let mut csv = csv::Writer::from_path(path)?;
    csv.write_record(["behaviour", "contact", "weight", "course_deg", "speed_m_s", "utility"])?;
    let mut write = |behaviour: &str, contact: &str, weight: f64, utilities: &mut dyn Iterator<Item = f64>| {
        for (i, utility) in utilities.enumerate() {
            let (course, speed) = (course_deg(report, i / report.speeds), speed_m_s(report, i % report.speeds));
            let numbers = [weight, course, speed, utility].map(|number| number.to_string());
            let [weight, course, speed, utility] = numbers.each_ref().map(String::as_str);
            csv.write_record([behaviour, contact, weight, course, speed, utility])?;
        }
        anyhow::Ok(())
    };
    for function in &report.functions {
        let contact = function.contact.map_or("", |contact| scenario.vehicles[contact.index()].name.as_str());
        let utilities = &mut function.utilities.iter().map(|utility| f64::from(*utility));
        write(&function.behaviour, contact, function.weight, utilities)?;
    }
    let weight: f64 = report.functions.iter().map(|function| function.weight).sum();
    write(COLLECTIVE, "", weight, &mut report.sum(report.functions.iter()).into_iter())?;
    Ok(csv.flush()?)
}

/// A picture of all together, then of each behaviour that asked for something.
fn plots(report: &HelmReport) -> Vec<PolarPlot> {
    let plot = |title: String, values: Vec<f64>, range: (f64, f64)| PolarPlot {
        title,
        courses: report.courses,
        speed_max_m_s: report.speed_max_m_s,
        values,
        range,
        chosen: report.course_deg.zip(report.speed_m_s),
    };
    let all = report.sum(report.functions.iter());
    let range = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    let mut plots = vec![plot(format!("{COLLECTIVE}: sum of weight × utility"), all, range)];
    for behaviour in &report.behaviours {
        let of_it = || report.functions.iter().filter(|function| function.behaviour == behaviour.name);
        let weight: f64 = of_it().map(|function| function.weight).sum();
        let contacts = of_it().filter_map(|function| function.contact).collect::<BTreeSet<_>>().len();
        if of_it().next().is_none() {
            continue;
        }
        let about = match contacts {
            0 => String::new(),
            1 => ", 1 contact".to_owned(),
            n => format!(", {n} contacts"),
        };
        let mean = report.sum(of_it()).into_iter().map(|v| v / weight.max(f64::MIN_POSITIVE)).collect();
        plots.push(plot(
            format!("{} ({}): weight {weight:.1}{about}", behaviour.name, behaviour.kind),
            mean,
            (0.0, 100.0),
        ));
    }
    plots
}
