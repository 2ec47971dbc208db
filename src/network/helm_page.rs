//! A helm report in text form: in full or on one line.

use crate::helm_text::decision;
use messages::helm::{FunctionReport, HelmReport, PolicyReport, RunState};
use scenario::Scenario;

/// Number of actions listed per policy, most likely first.
const ACTIONS: usize = 4;

/// The full report: mode, decision, and the utilities of every behaviour.
pub(super) fn page(scenario: &Scenario, report: &HelmReport) -> String {
    let name = &scenario.vehicles[report.vehicle.index()].name;
    let mut text = format!(
        "{name}  follows {}  {:.1} s\n",
        report.program,
        report.at.as_s()
    );
    text += &format!("mode    {}\n", report.mode);
    text += &format!("helm    {}\n\n", decision(report));
    let rows = rows(scenario, report);
    let widths = [0, 1].map(|i| {
        rows.iter()
            .map(|row| row[i].chars().count())
            .max()
            .unwrap_or(0)
    });
    for [what, kind, state, weight, utility] in &rows {
        let line = format!(
            "{what:<w$}  {kind:<k$}  {state:<8}  {weight:>7}  {utility:>7}",
            w = widths[0],
            k = widths[1]
        );
        text += &format!("{}\n", line.trim_end());
    }
    for policy in &report.policies {
        text += &format!(
            "\n{} uses {}: {}\n",
            policy.behaviour,
            policy.model,
            proposal(policy)
        );
        for (asked, share) in policy
            .words(scenario, report.vehicle)
            .actions
            .iter()
            .take(ACTIONS)
        {
            text += &format!("{:>6.1} %  {asked}\n", 100.0 * share);
        }
    }
    if !report.variables.is_empty() {
        let width = report
            .variables
            .iter()
            .map(|variable| variable.name.len())
            .max()
            .unwrap_or(0);
        text.push('\n');
        for variable in &report.variables {
            text += &format!("{:<width$}  {}\n", variable.name, variable.value);
        }
    }
    text
}

/// The proposal of a policy, or the reason why it has none.
fn proposal(policy: &PolicyReport) -> String {
    match (policy.course_deg, policy.speed_m_s, &policy.fault) {
        (Some(course_deg), Some(speed_m_s), _) => {
            format!("course {course_deg:.0}°, {speed_m_s:.2} m/s")
        }
        (_, _, Some(why)) => why.clone(),
        _ => policy
            .option
            .clone()
            .unwrap_or_else(|| "nothing".to_owned()),
    }
}

/// One line: mode, decision, and its utility for each objective function.
pub(super) fn line(scenario: &Scenario, report: &HelmReport) -> String {
    let name = &scenario.vehicles[report.vehicle.index()].name;
    let utility = |function: &FunctionReport| {
        let of = function
            .contact
            .map(|contact| format!("({})", scenario.vehicles[contact.index()].name));
        format!(
            "{}{} {}",
            function.behaviour,
            of.unwrap_or_default(),
            number(function.utility.map(f64::from), 0)
        )
    };
    let functions: Vec<String> = report.functions.iter().map(utility).collect();
    let variables: Vec<String> = report
        .variables
        .iter()
        .map(|variable| format!("{}={}", variable.name, variable.value))
        .collect();
    let line = format!(
        "{:>7.1} s  {name}  {}  {}  {}  {}",
        report.at.as_s(),
        report.mode,
        decision(report),
        functions.join(", "),
        variables.join(" ")
    );
    format!("{}\n", line.trim_end())
}

/// The table of behaviours: name, kind, run state, weight and utility; functions for contacts are
/// listed below their behaviour.
fn rows(scenario: &Scenario, report: &HelmReport) -> Vec<[String; 5]> {
    let mut rows = vec![["behaviour", "kind", "state", "weight", "utility"].map(str::to_owned)];
    for behaviour in &report.behaviours {
        let functions = || {
            report
                .functions
                .iter()
                .filter(|function| function.behaviour == behaviour.name)
        };
        let state = match behaviour.run_state {
            RunState::Idle => "-",
            RunState::Running => "running",
            RunState::Active => "active",
            RunState::Complete => "complete",
        };
        let own = functions().find(|function| function.contact.is_none());
        let runs = matches!(behaviour.run_state, RunState::Running | RunState::Active);
        rows.push([
            behaviour.name.clone(),
            behaviour.kind.clone(),
            state.to_owned(),
            number(runs.then_some(behaviour.weight), 1),
            number(own.and_then(|function| function.utility).map(f64::from), 1),
        ]);
        for function in functions() {
            let Some(contact) = function.contact else {
                continue;
            };
            rows.push([
                format!("  {}", scenario.vehicles[contact.index()].name),
                String::new(),
                String::new(),
                number(Some(function.weight), 1),
                number(function.utility.map(f64::from), 1),
            ]);
        }
    }
    rows
}

fn number(value: Option<f64>, places: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.places$}"))
}
