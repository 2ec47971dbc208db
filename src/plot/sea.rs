//! A sea on one page: its spectrum, the surface, the wind, and the drift of an unsteered boat.

use crate::plot::{self, Line, Mark, Page, Panel};
use anyhow::Result;
use primitives::{Ned, SimTime, math};
use scenario::sea::Sea;
use sim::sea::{Band, SeaModel, band, spectrum};
use std::path::Path;
use trial::Sample;

/// Number of spectrum bands: to show the shape of a JONSWAP peak, their width must be 0.15 of the
/// peak frequency.
const BANDS: usize = 30;
/// Number of points of the nominal spectrum.
const CURVE: usize = 600;
/// Duration of the surface plot in peak periods, and steps per period: ten per period of the
/// shortest waves.
const ELEVATION_PERIODS: u32 = 20;
const ELEVATION_STEPS: u32 = 50;
/// Duration and time step of the wind plot, s.
const WIND_S: u32 = 600;
const WIND_STEPS_PER_S: u32 = 2;
/// Time between marks on the track, s.
const MARK_S: f64 = 60.0;
/// Distance (m) below which a boat counts as not having drifted.
const STAYS_M: f64 = 0.01;

/// Draws a sea to a file: the spectrum specified in its file and, if the sea is estimated, that of
/// the log; the realised sea, and the track of an unsteered boat from the datum.
pub(crate) fn write(
    path: &Path,
    title: String,
    (sea, measured): (&Sea, Vec<(f64, f64)>),
    model: &SeaModel,
    track: &[Sample],
) -> Result<()> {
    let panels = vec![
        spectrum(sea, model, measured),
        elevation(sea, model),
        wind(sea, model),
        drift(track),
    ];
    Page {
        title,
        columns: 2,
        panel: plot::PANEL,
        panels,
    }
    .write(path)
}

/// Bars and curve are both densities: the area of a bar is the variance of the components in its
/// band.
fn spectrum(sea: &Sea, model: &SeaModel, measured: Vec<(f64, f64)>) -> Panel {
    let mut lines = vec![];
    let field = model.at_time(SimTime::ZERO);
    if let (Some(waves), Some(field)) = (&sea.waves, field.waves()) {
        let (low_hz, high_hz) = band::range_hz(waves.tp_s);
        let at = |i: usize| low_hz + (high_hz - low_hz) * i as f64 / CURVE as f64;
        let corners = |band: &Band| {
            [
                (band.range_hz.0, band.density_m2_hz()),
                (band.range_hz.1, band.density_m2_hz()),
            ]
        };
        lines = vec![
            Line {
                name: format!("{} components of this seed", waves.components),
                points: field
                    .bands((low_hz, high_hz), BANDS)
                    .iter()
                    .flat_map(corners)
                    .collect(),
                filled: true,
            },
            Line::of(
                "specified",
                (0..=CURVE)
                    .map(|i| (at(i), spectrum::density_m2_hz(waves, at(i))))
                    .collect(),
            ),
        ];
    }
    if !measured.is_empty() {
        lines.push(Line::of("measured", measured));
    }
    Panel::of(
        "Wave spectrum",
        ["frequency in Hz", "m²/Hz"],
        lines,
        "no waves",
    )
}

fn elevation(sea: &Sea, model: &SeaModel) -> Panel {
    let tp_s = sea.waves.as_ref().map(|waves| waves.tp_s);
    let point = |tp_s: f64, i: u32| {
        let t_s = tp_s * f64::from(i) / f64::from(ELEVATION_STEPS);
        (
            t_s,
            model
                .at_time(SimTime::from_s(t_s))
                .elevation_m(Ned::default()),
        )
    };
    let line = |tp_s: f64| {
        Line::of(
            "",
            (0..=ELEVATION_PERIODS * ELEVATION_STEPS)
                .map(|i| point(tp_s, i))
                .collect(),
        )
    };
    Panel::of(
        "Surface elevation at the datum",
        ["time in s", "m"],
        tp_s.map(line).into_iter().collect(),
        "no waves",
    )
}

fn wind(sea: &Sea, model: &SeaModel) -> Panel {
    let mut lines = vec![];
    if let Some(wind) = &sea.wind {
        let (sin, cos) = math::sin_cos(wind.from_rad);
        let series = |name: &str, unit: Ned| {
            let point = |i: u32| {
                let t_s = f64::from(i) / f64::from(WIND_STEPS_PER_S);
                (
                    t_s,
                    model
                        .at_time(SimTime::from_s(t_s))
                        .wind_at(Ned::default())
                        .dot(unit),
                )
            };
            Line::of(name, (0..=WIND_S * WIND_STEPS_PER_S).map(point).collect())
        };
        lines = vec![
            series(
                "along the mean wind",
                Ned {
                    north: -cos,
                    east: -sin,
                },
            ),
            series(
                "across it, to the right",
                Ned {
                    north: sin,
                    east: -cos,
                },
            ),
        ];
    }
    Panel::of(
        "Wind at the datum, 10 m above the water",
        ["time in s", "m/s"],
        lines,
        "no wind",
    )
}

fn drift(samples: &[Sample]) -> Panel {
    let place = |sample: &Sample| (sample.at.east, sample.at.north);
    let moves = samples.iter().any(|sample| sample.at.length() > STAYS_M);
    let marked = samples
        .iter()
        .filter(|sample| (sample.t_s + 1e-6) % MARK_S < 1e-3);
    let name = |sample: &Sample| {
        if sample.t_s > 0.0 {
            format!("{:.0} s", sample.t_s)
        } else {
            "start".to_owned()
        }
    };
    Panel {
        equal: true,
        marks: marked
            .filter(|_| moves)
            .map(|sample| Mark {
                name: name(sample),
                at: place(sample),
            })
            .collect(),
        ..Panel::of(
            "Track of a drifting boat",
            ["x (east) in m", "y (north) in m"],
            if moves {
                vec![Line::of("", samples.iter().map(place).collect())]
            } else {
                vec![]
            },
            "the boat does not drift",
        )
    }
}
