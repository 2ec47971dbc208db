//! The curves of a training: how good the policy is against each opponent, and how it learns.

use crate::plot::{self, Line, Page, Panel};
use anyhow::Result;
use learn::train::{Evaluated, Played};

/// How the policy learnt in one update.
pub(crate) struct Learnt {
    /// Samples that it had learnt from.
    pub(crate) samples: u64,
    /// The mean reward of a step.
    pub(crate) reward: f64,
    /// Its entropy, nats, if it has one.
    pub(crate) entropy: Option<f64>,
    /// How much what it expects is off: see `learn::train::Learnt`. None before anything is learnt.
    pub(crate) value_loss: Option<f64>,
}

/// Points of a line, at most: more are not seen.
const POINTS: usize = 400;

/// The curves as the text of an SVG.
pub(crate) fn svg(title: &str, learnt: &[Learnt], evaluations: &[Evaluated]) -> Result<String> {
    let of_update = |title: &str, y: &str, value: fn(&Learnt) -> Option<f64>| {
        let seen: Vec<(u64, f64)> = learnt.iter().filter_map(|one| Some((one.samples, value(one)?))).collect();
        // Means over groups of updates.
        let size = seen.len().div_ceil(POINTS).max(1);
        let mean = |group: &[(u64, f64)]| {
            let sum: f64 = group.iter().map(|(_, value)| value).sum();
            (millions(group.last().map_or(0, |(samples, _)| *samples)), sum / group.len() as f64)
        };
        let points = seen.chunks(size).map(mean).collect();
        Panel::of(title, [SAMPLES, y], vec![Line::of("", points)], "nothing of it yet, or not with this algorithm")
    };
    let against = |title: &str, y: &str, value: fn(&Played) -> f64| {
        let names = evaluations.last().map_or(&[][..], |last| &last.played);
        let line = |(i, (name, _)): (usize, &(String, Played))| {
            let seen = evaluations.iter().filter_map(|one| Some((one.samples, &one.played.get(i)?.1)));
            Line::of(name, seen.map(|(samples, played)| (millions(samples), value(played))).collect())
        };
        Panel::of(title, [SAMPLES, y], names.iter().enumerate().map(line).collect(), "nothing played yet")
    };
    let panels = vec![
        against("Games won, draws counting half", "%", |played| 100.0 * played.won()),
        against("Points ahead", "points a game", |played| played.points[0] - played.points[1]),
        against("Points", "points a game", |played| played.points[0]),
        against("Left the field", "times a game", |played| played.left_field),
        of_update("Reward", "a step", |learnt| Some(learnt.reward)),
        of_update("Entropy of the policy", "nats", |learnt| learnt.entropy),
        of_update("Error of what it expects", "loss", |learnt| learnt.value_loss),
    ];
    plot::svg(&Page { title: title.to_owned(), columns: 2, panel: plot::PANEL, panels })
}

/// Name and unit of the horizontal axis.
const SAMPLES: &str = "samples in millions";

fn millions(samples: u64) -> f64 {
    samples as f64 * 1e-6
}
