//! `squall trial`: puts one boat in open water through a recorded series of commands or a standard
//! manoeuvre.

use crate::plot::trial as plot;
use crate::screen;
use crate::water_args::{self, WaterArgs, degrees, within};
use anyhow::{Context, Result, bail};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use command_line::explain::UsageError;
use command_line::scenario_files::existing;
use primitives::{SimTime, angle};
use scenario::boat::{Boat, Drive};
use sim::hull::Planar;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use trial::{Engine, Manoeuvre, Orders, Plan, Sample, Sheet, Start, TrialBoat};

#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["orders", "manoeuvre"])))]
pub(crate) struct Args {
    /// Boat: a file, or the name of a boat in scenarios/boats
    boat: String,
    /// Replays the commands in this CSV file. Columns: t_s, and either port and starboard (both
    /// with the suffix _rad_s, _pct or _newton), or thrust_pct and rudder_pct, or speed_m_s and
    /// heading_deg
    #[arg(long, value_name = "FILE", value_parser = existing)]
    orders: Option<PathBuf>,
    /// Standard manoeuvre to perform
    #[arg(long, value_name = "NAME", value_parser = manoeuvre_name())]
    manoeuvre: Option<Manoeuvre>,
    /// Writes the track, sampled every 0.1 s, to this CSV file; required with --orders [default:
    /// BOAT_MANOEUVRE.csv in the current folder]
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Plots the track and time series to this SVG file [default: BOAT_MANOEUVRE.svg in the current
    /// folder, or none with --orders]
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Adds the commands to the track, in columns that `squall identify` and --orders can read
    #[arg(long)]
    with_orders: bool,
    #[command(flatten)]
    water: WaterArgs,
    #[command(flatten)]
    start: StartArgs,
    /// Physics tick, s [default: 0.05, or 0.1 for a kinematic boat]
    #[arg(long, value_name = "S", value_parser = tick)]
    tick_s: Option<f64>,
    /// Duration of the trial, s [default: until the last command, or as long as the manoeuvre
    /// takes]
    #[arg(long, value_name = "S", value_parser = within(0.1, trial::LONGEST_S, "s"))]
    duration_s: Option<f64>,
    #[command(flatten)]
    manoeuvring: ManoeuvreArgs,
}

#[derive(clap::Args)]
pub(crate) struct ManoeuvreArgs {
    /// Speed of the straight approach, m/s [default: the highest speed that the front seat accepts]
    #[arg(long, value_name = "M_S", value_parser = water_args::speed, conflicts_with = "orders")]
    approach_m_s: Option<f64>,
    /// Duration of the approach, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = within(0.0, 3600.0, "s"), conflicts_with = "orders")]
    approach_s: f64,
    /// Turns to port, or begins a zigzag to port, instead of to starboard
    #[arg(long, conflicts_with = "orders")]
    to_port: bool,
    /// For a zigzag: heading change at which the boat reverses its turn, degrees (10 for 10/10, 20
    /// for 20/20)
    #[arg(long, value_name = "DEG", default_value_t = 10.0, value_parser = within(1.0, 90.0, "degrees"), conflicts_with = "orders")]
    angle_deg: f64,
    /// For a zigzag: rudder angle, or each thruster's offset from the mean thrust, per cent of the
    /// maximum [default: the value of --angle-deg]
    #[arg(long, value_name = "PCT", value_parser = within(1.0, 100.0, "per cent"), conflicts_with = "orders")]
    differential_pct: Option<f64>,
}

/// Parses the name of a manoeuvre.
fn manoeuvre_name() -> impl TypedValueParser<Value = Manoeuvre> {
    PossibleValuesParser::new(Manoeuvre::NAMES)
        .map(|name| name.parse().expect("no other name gets here"))
}

#[derive(clap::Args)]
pub(crate) struct StartArgs {
    /// Heading at the start, compass degrees
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = degrees, allow_negative_numbers = true)]
    start_heading_deg: f64,
    /// Speed ahead over the ground at the start, m/s
    #[arg(long, value_name = "M_S", default_value_t = 0.0, value_parser = within(-60.0, 60.0, "m/s"), allow_negative_numbers = true)]
    start_surge_m_s: f64,
    /// Speed to starboard over the ground at the start, m/s
    #[arg(long, value_name = "M_S", default_value_t = 0.0, value_parser = within(-60.0, 60.0, "m/s"), allow_negative_numbers = true)]
    start_sway_m_s: f64,
    /// Yaw rate at the start, clockwise, degrees per second
    #[arg(long, value_name = "DEG_S", default_value_t = 0.0, value_parser = degrees, allow_negative_numbers = true)]
    start_yaw_rate_deg_s: f64,
    /// Thrust of a kinematic boat at the start, per cent [default: the thrust that maintains its
    /// speed]
    #[arg(long, value_name = "PCT", value_parser = within(-100.0, 100.0, "per cent"), allow_negative_numbers = true)]
    start_thrust_pct: Option<f64>,
}

impl StartArgs {
    fn start(&self, boat: &Boat) -> Result<Start> {
        if self.start_thrust_pct.is_some() && !matches!(boat.drive, Drive::Kinematic(_)) {
            bail!(UsageError(format!(
                "--start-thrust-pct is for kinematic boats; {} has thrusters, which start at rest",
                boat.name
            )));
        }
        Ok(Start {
            psi_rad: angle::rad_from_compass_deg(self.start_heading_deg),
            nu: Planar {
                surge: self.start_surge_m_s,
                sway: self.start_sway_m_s,
                yaw: self.start_yaw_rate_deg_s.to_radians(),
            },
            thrust_pct: self.start_thrust_pct,
        })
    }
}

/// Parses a physics tick, s.
pub(crate) fn tick(text: &str) -> Result<f64, String> {
    let tick_s = within(0.001, 0.1, "s")(text)?;
    trial::ticks_per_row(SimTime::from_s(tick_s)).map(|_| tick_s)
}

/// The tick (s) for which a boat's reference values are valid.
pub(crate) fn usual_tick_s(boat: &Boat) -> f64 {
    match boat.drive {
        Drive::Thrusters { .. } => 0.05,
        Drive::Kinematic(_) => 0.1,
    }
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let (boat, _, drawn) = water_args::boat(&args.boat, args.water.seed)?;
    water_args::tell_drawn(args.water.seed, &drawn);
    let start = args.start.start(&boat)?;
    let tick = SimTime::from_s(args.tick_s.unwrap_or(usual_tick_s(&boat)));
    let mut trial_boat = TrialBoat::new(&boat, &args.water.sea()?, tick, args.water.seed, &start);
    match (&args.orders, args.manoeuvre) {
        (Some(path), _) => replay(args, path, &boat, &mut trial_boat),
        (None, Some(named)) => manoeuvre(args, named, &boat, &mut trial_boat),
        (None, None) => bail!(UsageError("expected --orders or --manoeuvre".to_owned())),
    }
}

fn manoeuvre(
    args: &Args,
    named: Manoeuvre,
    boat: &Boat,
    trial_boat: &mut TrialBoat,
) -> Result<ExitCode> {
    let how = &args.manoeuvring;
    let plan = Plan {
        manoeuvre: named,
        course_rad: angle::rad_from_compass_deg(args.start.start_heading_deg),
        approach_m_s: how.approach_m_s,
        approach_s: how.approach_s,
        side: if how.to_port { -1.0 } else { 1.0 },
        switch_rad: how.angle_deg.to_radians(),
        differential: how.differential_pct.unwrap_or(how.angle_deg) / 100.0,
        duration_s: args.duration_s,
    };
    let sailed = trial::sail(boat, trial_boat, &plan)?;
    let file = |given: &Option<PathBuf>, ending: &str| {
        given
            .clone()
            .unwrap_or_else(|| PathBuf::from(format!("{}_{}.{ending}", boat.name, named.name())))
    };
    let csv = file(&args.csv, "csv");
    let plot = file(&args.plot, "svg");
    write_track(&csv, &sailed.samples, args.with_orders)?;
    let title = format!("{}: {}", boat.name, named.name().replace('_', " "));
    plot::write(&plot, &title, &sailed.samples)?;
    screen::print(&format!(
        "{title}\n{}",
        table(&trial::measures(&plan, &sailed))
    ));
    screen::print(&format!(
        "track: {}, plot: {}\n",
        csv.display(),
        plot.display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// The results, one per line.
fn table(measures: &[trial::Measure]) -> String {
    let line = |measure: &trial::Measure| {
        let value = if measure.value.is_finite() {
            format!("{:.2}", measure.value)
        } else {
            "not reached".to_owned()
        };
        let unit = if measure.value.is_finite() {
            measure.unit
        } else {
            ""
        };
        format!("  {:<32}{value:>12} {unit}\n", measure.name)
    };
    measures.iter().map(line).collect()
}

fn replay(args: &Args, path: &Path, boat: &Boat, trial_boat: &mut TrialBoat) -> Result<ExitCode> {
    let orders = Orders::of_sheet(&read_sheet(path)?, &Engine::new(boat))?;
    let duration = args.duration_s.map_or(orders.end(), SimTime::from_s);
    if duration < trial::ROW {
        bail!(
            "{}: all commands have the same time; set the duration of the trial with --duration-s",
            path.display()
        );
    }
    let samples = trial::replay(trial_boat, &orders, duration)?;
    let csv = args
        .csv
        .as_deref()
        .ok_or_else(|| UsageError("--orders requires --csv FILE for the track".to_owned()))?;
    write_track(csv, &samples, args.with_orders)?;
    if let Some(plot) = &args.plot {
        plot::write(
            plot,
            &format!("{}: {}", boat.name, path.display()),
            &samples,
        )?;
    }
    let last = &samples[samples.len() - 1];
    screen::print(&format!(
        "{}: {} for {:.1} s, at the end x {:.2} m, y {:.2} m, heading {:.1}°, {:.3} m/s\n",
        csv.display(),
        boat.name,
        last.t_s,
        last.at.east,
        last.at.north,
        angle::compass_deg_from_rad(last.psi_rad),
        last.speed_m_s(),
    ));
    Ok(ExitCode::SUCCESS)
}

/// A CSV file with named columns.
pub(crate) fn read_sheet(path: &Path) -> Result<Sheet> {
    let file = primitives::input_file::open(path)
        .with_context(|| format!("cannot read {}", path.display()))?;
    let sheet = Sheet::read(&path.display().to_string(), file)?;
    for note in sheet.notes() {
        screen::remark(&note.to_string());
    }
    Ok(sheet)
}

fn write_track(path: &Path, samples: &[Sample], with_orders: bool) -> Result<()> {
    let trying = || format!("cannot write the track to {}", path.display());
    let file = primitives::output_file::create(path).with_context(trying)?;
    trial::write_csv(samples, with_orders, BufWriter::new(file)).with_context(trying)
}
