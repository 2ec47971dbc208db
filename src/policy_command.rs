//! `squall policy`: describes a trained model and explains its choices in a recorded game.

use crate::minds::Minds;
use crate::{helm_text, recording_file, scenario_files, screen, submission};
use anyhow::{Context, Result, bail};
use command_line::number::{seconds, significant, whole};
use onnx::Network;
use primitives::input_file;
use scenario::action::{self, ActionSpace};
use scenario::built_in;
use scenario::observation::ObservationSpace;
use scenario::policy::{self, PartialSpec, PolicyModel, PolicySpec};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Policy: an ONNX model, or the name of one in scenarios/policies
    #[arg(value_name = "POLICY", value_parser = scenario_files::find_policy)]
    file: PathBuf,
    /// Explains a decision in this recording
    #[arg(long, value_name = "RECORDING", value_parser = recording_file::named, requires_all = ["vehicle", "at"])]
    game: Option<PathBuf>,
    /// With --game: name of the boat, which must use a policy
    #[arg(long, value_name = "NAME", requires = "game")]
    vehicle: Option<String>,
    /// With --game: time of the decision, s
    #[arg(long, value_name = "SECONDS", requires = "game", value_parser = seconds)]
    at: Option<f64>,
    /// Number of inputs to list, most influential first
    #[arg(long, value_name = "COUNT", default_value_t = 12, value_parser = whole::<usize>(0, u64::MAX))]
    inputs: usize,
    /// Writes the policy to this folder as an entry for the Maritime Capture the Flag competition
    #[arg(long, value_name = "FOLDER", conflicts_with = "game")]
    submission: Option<PathBuf>,
    /// With --submission: samples actions from their probabilities instead of taking the most
    /// likely one
    #[arg(long, requires = "submission")]
    sampled: bool,
}

/// Number of listed actions.
const LIKELIEST: usize = 5;
/// Number of evaluations for the timing.
const EVALUATIONS: u32 = 1000;
/// Prefix of our own metadata entries.
const OWN: &str = "squall.";

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let bytes = match built_in(&args.file).filter(|_| !args.file.exists()) {
        Some(bytes) => bytes.to_vec(),
        None => input_file::read(&args.file, policy::BYTES_MAX)
            .with_context(|| format!("cannot read {}", args.file.display()))?,
    };
    let name = args.file.display().to_string();
    let network = Network::read(&bytes).with_context(|| format!("{name} is not a usable model"))?;
    let model = PolicyModel::read(&name, &bytes, PartialSpec::default());
    let spec = model.as_ref().map(|model| model.spec).map_err(Clone::clone);
    screen::print(&about(&name, bytes.len(), &network, spec));
    if let Some(folder) = &args.submission {
        let no_entry = || format!("{name} cannot be an entry");
        let model = model.map_err(anyhow::Error::msg).with_context(no_entry)?;
        screen::print(&submission::write(&model, args.sampled, folder).with_context(no_entry)?);
        return Ok(ExitCode::SUCCESS);
    }
    if let (Some(game), Some(vehicle), Some(at_s)) = (&args.game, &args.vehicle, args.at) {
        let model = model.map_err(anyhow::Error::msg);
        let model =
            model.with_context(|| format!("{name} does not declare its inputs and actions"))?;
        screen::print(&explained(&model, game, vehicle, at_s, args.inputs)?);
    }
    Ok(ExitCode::SUCCESS)
}

/// The description of a model.
fn about(name: &str, bytes: usize, network: &Network, spec: Result<PolicySpec, String>) -> String {
    let ports = |ports: &[onnx::Port]| {
        let ports: Vec<String> = ports
            .iter()
            .map(|port| format!("{} ({})", port.name, port.size))
            .collect();
        ports.join(", ")
    };
    let mut text = format!(
        "{name}: {:.0} kB, digest {:032x}\n",
        bytes as f64 / 1000.0,
        network.digest()
    );
    let mut line = |what: &str, value: String| {
        let _ = writeln!(text, "  {what:<12} {value}");
    };
    line(
        "network",
        format!(
            "{} -> {}",
            ports(network.inputs()),
            ports(network.outputs())
        ),
    );
    line(
        "evaluation",
        format!("{} us", significant(evaluation_us(network.clone()))),
    );
    let mut said = vec![];
    match spec {
        Ok(spec) => {
            line("inputs", observation_text(spec.observation));
            line("actions", action_text(spec.action));
            line("decision", format!("every {} s", spec.period_s));
            said.extend(spec.metadata().map(|(key, _)| key));
        }
        Err(why) => line(
            "policy",
            format!("not declared in the file, so the strategy must declare it ({why})"),
        ),
    }
    for warning in network.warnings() {
        line("warning", warning.clone());
    }
    for (key, value) in network
        .metadata()
        .iter()
        .filter(|(key, _)| !said.contains(key))
    {
        line(key.strip_prefix(OWN).unwrap_or(key), value.clone());
    }
    text
}

/// The median time of an evaluation, µs.
#[expect(clippy::disallowed_methods, reason = "it measures this machine")]
fn evaluation_us(mut network: Network) -> f64 {
    let input = vec![0.1; network.input_size()];
    let mut times_us: Vec<f64> = (0..EVALUATIONS)
        .map(|_| {
            let begun = Instant::now();
            network.evaluate(&input);
            begun.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    times_us.sort_by(f64::total_cmp);
    times_us[times_us.len() / 2]
}

fn observation_text(space: ObservationSpace) -> String {
    match space {
        ObservationSpace::Pyquaticus => format!("pyquaticus, version {}", space.version()),
        ObservationSpace::Pyquaticus2023 => format!("pyquaticus_2023, version {}", space.version()),
        ObservationSpace::Pyquaticus2026 => format!("pyquaticus_2026, version {}", space.version()),
        ObservationSpace::Squall {
            mates,
            enemies,
            frames,
        } => format!(
            "squall, version {}: {} numbers (mates {mates}, enemies {enemies}, frames {frames})",
            space.version(),
            space.size(0, 0)
        ),
    }
}

fn action_text(space: ActionSpace) -> String {
    match (space, space.count()) {
        (ActionSpace::Pyquaticus, Some(count)) => {
            format!("pyquaticus: one of {count} turns and speeds")
        }
        (ActionSpace::Table(_), Some(count)) => format!("a table of {count} turns and speeds"),
        (ActionSpace::Options, _) => "options: a value of a strategy's variable".to_owned(),
        _ => "continuous: a turn and a speed".to_owned(),
    }
}

/// The model's choice at a moment of a recorded game, and the inputs that it depends on.
fn explained(
    model: &PolicyModel,
    game: &Path,
    vehicle: &str,
    at_s: f64,
    inputs: usize,
) -> Result<String> {
    let recording = Arc::new(recording_file::open(game, "read")?);
    let scenario = recording.scenario();
    let of = scenario.vehicle_named(vehicle)?;
    // The cast saturates, so that a time out of range becomes a nonexistent decision.
    let decision = (at_s / scenario.decision().as_s() + 1e-9).floor() as u64;
    let found = Minds::new(Arc::clone(&recording))
        .report_of(of, decision)
        .filter(|_| at_s >= 0.0);
    let Some((report, _)) = found else {
        bail!(
            "{} contains no decision by {vehicle} at {at_s} s",
            game.display()
        );
    };
    let Some(policy) = report
        .policies
        .iter()
        .find(|policy| !policy.observed.is_empty())
    else {
        bail!(
            "{vehicle} uses no policy in {}: its strategy is {}",
            game.display(),
            report.program
        );
    };
    if policy.observed.len() != model.input_size() {
        let found = policy.observed.len();
        let expected = model.input_size();
        bail!(
            "the policy of {vehicle} has {found} inputs, expected {expected}, as {} has",
            model.name
        );
    }
    let (mates, enemies) = scenario.sides_of(of);
    let names = model.spec.observation.names(mates, enemies);
    let mut text = format!(
        "\n{vehicle} at {:.1} s, mode {}",
        report.at.as_s(),
        report.mode
    );
    let _ = writeln!(text, "; its helm: {}", helm_text::decision(&report));
    text += &choices(model, &policy.observed, &names, inputs);
    Ok(text)
}

/// The most likely actions, and how the choice would change without each input.
fn choices(model: &PolicyModel, observed: &[f32], names: &[String], inputs: usize) -> String {
    let chosen = choice(model, observed);
    let mut text = String::new();
    let best = chosen.likeliest().first().copied();
    for action in chosen.likeliest().into_iter().take(LIKELIEST) {
        let asks = model.words(action);
        let _ = writeln!(text, "  {:>5.1} %  {asks}", 100.0 * chosen.numbers[action]);
    }
    // An input of 0 adds nothing to any sum in the network.
    let mut rows: Vec<(usize, f32, Choice)> = (0..observed.len())
        .map(|i| {
            let mut observed = observed.to_vec();
            observed[i] = 0.0;
            let without = choice(model, &observed);
            (i, chosen.distance(&without), without)
        })
        .collect();
    rows.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    rows.truncate(inputs);
    let what = if best.is_some() {
        "the probability of the first action"
    } else {
        "turn and speed"
    };
    let _ = writeln!(
        text,
        "\n  {what} is {}; with one input set to 0:\n",
        chosen.text(best)
    );
    let width = rows
        .iter()
        .map(|row| names[row.0].len())
        .max()
        .unwrap_or(0)
        .max("input".len());
    let _ = writeln!(text, "  {:width$}  {:>7}  {:>14}", "input", "value", "then");
    for (i, _, without) in &rows {
        let _ = writeln!(
            text,
            "  {:width$}  {:>7.3}  {:>14}",
            names[*i],
            observed[*i],
            without.text(best)
        );
    }
    text
}

/// The output of a model for an observation.
struct Choice {
    /// The probabilities of discrete actions, or the values of continuous ones.
    numbers: Vec<f32>,
    is_discrete: bool,
}

fn choice(model: &PolicyModel, observed: &[f32]) -> Choice {
    let mut network = model.network();
    network.evaluate(observed);
    let output = network.output(model.output());
    let is_discrete = model.actions() == Some(output.len());
    Choice {
        numbers: if is_discrete {
            action::probabilities(output)
        } else {
            output.to_vec()
        },
        is_discrete,
    }
}

impl Choice {
    /// The discrete actions in order of decreasing probability.
    fn likeliest(&self) -> Vec<usize> {
        let mut actions: Vec<usize> = (0..self.numbers.len())
            .filter(|_| self.is_discrete)
            .collect();
        actions.sort_by(|a, b| self.numbers[*b].total_cmp(&self.numbers[*a]));
        actions
    }

    /// The difference from another choice.
    fn distance(&self, other: &Choice) -> f32 {
        self.numbers
            .iter()
            .zip(&other.numbers)
            .map(|(a, b)| (a - b).abs())
            .sum()
    }

    /// The probability of one action, or all values.
    fn text(&self, action: Option<usize>) -> String {
        match action {
            Some(action) => format!("{:.1} %", 100.0 * self.numbers[action]),
            None => self
                .numbers
                .iter()
                .map(|number| format!("{number:.2}"))
                .collect::<Vec<_>>()
                .join(", "),
        }
    }
}
