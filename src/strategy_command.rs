//! `squall strategy`: explains a strategy file, as tables or as a graph.

use crate::screen;
use anyhow::{Result, anyhow, bail};
use scenario::strategy::{Behaviour, Program, Strategy};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Strategy to explain: a file or a name
    #[arg(value_name = "STRATEGY", required_unless_present = "reference", value_parser = crate::scenario_files::file_of(scenario::Kind::STRATEGY))]
    file: Option<PathBuf>,
    /// Prints the modes and their possible behaviours as a Graphviz graph
    #[arg(long)]
    dot: bool,
    /// Prints a reference for all keys and names in strategy files, as Markdown
    #[arg(long, conflicts_with_all = ["file", "dot"])]
    reference: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if args.reference {
        screen::print(&scenario::reference());
        return Ok(ExitCode::SUCCESS);
    }
    let file = args
        .file
        .as_ref()
        .ok_or_else(|| anyhow!("expected a strategy"))?;
    match scenario::load_file::<scenario::strategy::Strategy>(file) {
        Ok(strategy) if args.dot => screen::print(&graph(&strategy)),
        Ok(strategy) => screen::print(&tables(&strategy)),
        Err(problems) => {
            let errors = problems.0.len();
            screen::print(&format!("{problems}\n"));
            bail!("{errors} {}", if errors == 1 { "error" } else { "errors" });
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Tables of all roles; a program shared by several roles is printed once.
fn tables(strategy: &Strategy) -> String {
    let mut text = format!("strategy {}{}\n", strategy.name, dash(&strategy.about));
    for (i, role) in strategy.roles.iter().enumerate() {
        let first = strategy
            .roles
            .iter()
            .position(|other| other == role)
            .unwrap_or(i);
        let _ = write!(
            text,
            "\nrole {}: {}{}\n",
            i + 1,
            role.name,
            dash(&role.about)
        );
        if first < i {
            let _ = writeln!(text, "  as role {}", first + 1);
        } else {
            program(&mut text, role);
        }
    }
    text
}

fn dash(about: &str) -> String {
    if about.is_empty() {
        String::new()
    } else {
        format!(" - {about}")
    }
}

fn program(text: &mut String, program: &Program) {
    if let Some(because) = &program.unsafe_because {
        let _ = write!(text, "\n  !!! UNSAFE: {because}\n");
    }
    text.push_str("\n  modes\n");
    for mode in 0..program.modes.len() {
        let depth = depth(program, mode);
        let _ = writeln!(
            text,
            "  {}{} {}",
            "  ".repeat(depth + 1),
            program.modes[mode].name,
            condition(program, mode)
        );
    }
    let leaves: Vec<usize> = program.leaves().collect();
    for leaf in leaves {
        let _ = write!(text, "\n  in {}\n", program.path(leaf));
        let rows: Vec<[String; 4]> = program
            .behaviours
            .iter()
            .filter(|behaviour| behaviour.modes[leaf])
            .map(|b| row(program, b))
            .collect();
        if rows.is_empty() {
            text.push_str("    nothing runs\n");
        }
        let width = |column: usize| {
            rows.iter()
                .map(|row| row[column].chars().count())
                .max()
                .unwrap_or(0)
        };
        let name = width(0);
        let kind = width(1);
        let weight = width(2);
        for row in &rows {
            let line = format!(
                "    {:name$}  {:kind$}  {:weight$}  {}",
                row[0], row[1], row[2], row[3]
            );
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
}

fn depth(program: &Program, mode: usize) -> usize {
    std::iter::successors(program.modes[mode].parent, |parent| {
        program.modes[*parent].parent
    })
    .count()
}

/// The condition that selects a mode among its siblings.
fn condition(program: &Program, mode: usize) -> String {
    match &program.modes[mode].when {
        Some(when) => format!("when {}", program.condition_text(when)),
        None => "otherwise".to_owned(),
    }
}

/// Name, kind, weight, and details.
fn row(program: &Program, behaviour: &Behaviour) -> [String; 4] {
    let mut notes = vec![];
    if behaviour.is_guard() {
        notes.push("safety".to_owned());
    }
    if let Some(when) = &behaviour.when {
        notes.push(format!("when {}", program.condition_text(when)));
    }
    if let Some(duration_s) = &behaviour.duration_s {
        notes.push(format!(
            "for {} s",
            program.number_text(&duration_s.expression)
        ));
    }
    let weight = program.number_text(&behaviour.weight.expression);
    [
        behaviour.name.clone(),
        behaviour.task.kind().to_owned(),
        weight,
        notes.join(", "),
    ]
}

/// A Graphviz graph: a box for each mode, its condition on the edge to it, and the behaviours of
/// each leaf.
fn graph(strategy: &Strategy) -> String {
    let mut text = format!("digraph {:?} {{\n  node [shape=box];\n", strategy.name);
    for (i, role) in strategy.roles.iter().enumerate() {
        if strategy.roles[..i].contains(role) {
            continue;
        }
        let _ = writeln!(
            text,
            "  subgraph cluster_{i} {{\n    label={};",
            quoted(&role.name)
        );
        let _ = writeln!(
            text,
            "    r{i} [label={}, shape=ellipse];",
            quoted(&role.name)
        );
        for (mode, about) in role.modes.iter().enumerate() {
            let label = if role.is_leaf(mode) {
                leaf_label(role, mode)
            } else {
                about.name.clone()
            };
            let _ = writeln!(text, "    r{i}m{mode} [label={}];", quoted(&label));
            let from = about
                .parent
                .map_or_else(|| format!("r{i}"), |parent| format!("r{i}m{parent}"));
            let _ = writeln!(
                text,
                "    {from} -> r{i}m{mode} [label={}];",
                quoted(&condition(role, mode))
            );
        }
        text.push_str("  }\n");
    }
    text.push_str("}\n");
    text
}

/// A leaf's name, with its possible behaviours below.
fn leaf_label(program: &Program, leaf: usize) -> String {
    let mut label = program.modes[leaf].name.clone();
    for behaviour in program
        .behaviours
        .iter()
        .filter(|behaviour| behaviour.modes[leaf])
    {
        let [name, kind, weight, notes] = row(program, behaviour);
        let notes = if notes.is_empty() {
            notes
        } else {
            format!(", {notes}")
        };
        let _ = write!(label, "\n{name}: {kind} {weight}{notes}");
    }
    label
}

/// A string, quoted for Graphviz.
fn quoted(text: &str) -> String {
    format!(
        "\"{}\"",
        text.replace('\\', "\\\\")
            .replace('"', "\\\"")
            .replace('\n', "\\n")
    )
}
