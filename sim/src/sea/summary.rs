//! A summary of a sea's effects on a kind of boat: wave height and length, orbital velocity,
//! forces, drift.

use super::hull_wave::{orbital_speed_m_s, orbital_velocity};
use super::patch::Patch;
use super::windage::wind_force;
use super::{CurrentField, WaveField};
use crate::hull::HullModel;
use crate::motion::cross_flow_newton;
use primitives::frame::{Body, Ned};
use rules::Field;
use scenario::Boat;
use scenario::sea::{Gusts, Sea, Wind};

/// The effects of a sea on a kind of boat.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Effects of the waves, if any.
    pub waves: Option<WaveSummary>,
    /// Effects of the wind, if any.
    pub wind: Option<WindSummary>,
    /// The initial current at the centre of the field, m/s.
    pub current_m_s: Ned,
}

/// The effects of the waves.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveSummary {
    /// Significant wave height, m.
    pub hs_m: f64,
    /// Peak period, s.
    pub tp_s: f64,
    /// Length of a wave with the peak period, m.
    pub wavelength_m: f64,
    /// Standard deviation of the slope, rad.
    pub slope_rms_rad: f64,
    /// Standard deviation of the orbital velocity at the surface, m/s.
    pub orbital_rms_m_s: f64,
    /// Standard deviation of the orbital velocity averaged over the hull, with waves from ahead and
    /// from abeam, m/s.
    pub orbital_on_hull_m_s: [f64; 2],
    /// Stokes drift averaged over the hull's draught, m/s.
    pub stokes_m_s: f64,
    /// Mean drift force on the hull with the waves from ahead and from abeam, N.
    pub drift_newton: [f64; 2],
}

/// The effects of the wind.
#[derive(Clone, Debug, PartialEq)]
pub struct WindSummary {
    /// Mean speed 10 m above the water, and at the height of the boat's windage, m/s.
    pub mean_m_s: [f64; 2],
    /// Standard deviation of the wind speed at the boat, along the mean wind, m/s.
    pub gust_m_s: f64,
    /// Force on the boat at rest, with the wind from ahead and from abeam, N.
    pub force_newton: [f64; 2],
    /// Drift speed without thrust, beam to the wind, m/s.
    pub drift_m_s: f64,
}

impl Summary {
    /// The effects of a sea on a boat on this field.
    pub fn new(sea: &Sea, boat: &Boat, field: &Field, seed: u64) -> Summary {
        let hull = HullModel::new(&boat.hull, sea.water_density_kg_m3);
        Summary {
            waves: sea.waves.as_ref().map(|waves| {
                let waves_seen = WaveField::new(waves, sea.depth_m, seed);
                wave_summary(
                    &waves_seen,
                    (waves.tp_s, waves.from_rad),
                    boat,
                    sea.water_density_kg_m3,
                )
            }),
            wind: sea
                .wind
                .as_ref()
                .map(|wind| wind_summary(wind, boat, &hull)),
            current_m_s: CurrentField::new(&sea.current, field, &seed.into())
                .at_time(primitives::SimTime::ZERO)
                .at(field.middle()),
        }
    }
}

fn wave_summary(
    field: &WaveField,
    (tp_s, from_rad): (f64, f64),
    boat: &Boat,
    density_kg_m3: f64,
) -> WaveSummary {
    // Waves from ahead and from abeam are the extremes for a hull that is longer than wide.
    let headings_rad = [from_rad, from_rad + std::f64::consts::FRAC_PI_2];
    let on_hull = |heading_rad: f64| {
        let velocities = field.waves.iter().map(|wave| {
            orbital_velocity(
                orbital_speed_m_s(wave, boat),
                &Patch::new(wave, boat, heading_rad),
            )
        });
        velocities
            .map(|v| 0.5 * (v.surge * v.surge + v.sway * v.sway))
            .sum::<f64>()
            .sqrt()
    };
    let drift = |heading_rad: f64| {
        let force = field.mean_drift_newton(boat, density_kg_m3, heading_rad);
        (force.surge * force.surge + force.sway * force.sway).sqrt()
    };
    WaveSummary {
        hs_m: field.hs_m(),
        tp_s,
        wavelength_m: field.wavelength_m(tp_s),
        slope_rms_rad: field.slope_rms_rad(),
        orbital_rms_m_s: field.orbital_rms_m_s(),
        orbital_on_hull_m_s: headings_rad.map(on_hull),
        stokes_m_s: field.stokes_drift_m_s(boat.draught_m).length(),
        drift_newton: headings_rad.map(drift),
    }
}

fn wind_summary(wind: &Wind, boat: &Boat, hull: &HullModel) -> WindSummary {
    let mean_at =
        |height_m: f64| wind.speed_10m_m_s * libm::pow(height_m / 10.0, wind.profile_exponent);
    let mean_m_s = mean_at(boat.windage.height_m);
    let intensity = match wind.gusts {
        Gusts::None => 0.0,
        Gusts::OrnsteinUhlenbeck { intensity, .. } => intensity,
    };
    let force = |past: Body| wind_force(&boat.windage, boat.length_m, past);
    let abeam = |past_m_s: f64| {
        force(Body {
            ahead: 0.0,
            starboard: past_m_s,
        })
        .sway
    };
    WindSummary {
        mean_m_s: [wind.speed_10m_m_s, mean_m_s],
        gust_m_s: intensity * mean_m_s,
        force_newton: [
            -force(Body {
                ahead: -mean_m_s,
                starboard: 0.0,
            })
            .surge,
            abeam(mean_m_s),
        ],
        drift_m_s: equilibrium(mean_m_s, |v| {
            abeam(mean_m_s - v) - cross_flow_newton(hull, v)
        }),
    }
}

/// The root of `excess`, a decreasing function, between 0 and `most`, by bisection.
fn equilibrium(most: f64, excess: impl Fn(f64) -> f64) -> f64 {
    let mut low = 0.0;
    let mut high = most;
    // Sixty halvings go beyond the last bit; drag is not smooth enough for Newton's method.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::super::waves_from;
    use super::*;

    #[test]
    fn the_surveyor_drifts_as_its_published_balance_says() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
        let boat = scenario::load_file::<scenario::Boat>(&root.join("boats/surveyor_m1_8.toml"))
            .unwrap_or_else(|e| panic!("{e}"));
        let game =
            scenario::load(&root.join("games/attack_1v1.toml")).unwrap_or_else(|e| panic!("{e}"));
        let mut sea = Sea::at_rest();
        // Estimated drift: 0.128 m/s in 5 m/s and 0.340 m/s in 10 m/s of wind at the boat; the
        // estimate assumed slightly more windage.
        for (wind_m_s, want_m_s) in [(5.0, 0.128), (10.0, 0.340)] {
            sea.wind = Some(Wind {
                speed_10m_m_s: wind_m_s,
                from_rad: 0.3,
                profile_exponent: 0.0,
                gusts: Gusts::None,
            });
            let summary = Summary::new(&sea, &boat, &game.field, 1);
            let got_m_s = summary.wind.map_or(0.0, |wind| wind.drift_m_s);
            assert!(
                (got_m_s / want_m_s - 1.0).abs() < 0.08,
                "{wind_m_s}: {got_m_s}"
            );
        }
        // Known values for a sea of 0.5 m and 3 s, over a slightly narrower frequency band:
        // wavelength 14 m; orbital velocity 0.32 m/s at the surface, 0.27 m/s on the hull; Stokes
        // drift 0.066 m/s at the surface; drift force 10.7 N from abeam, 5.3 N from ahead.
        sea.waves = Some(waves_from(1.0, 0.5, 3.0, 512));
        let waves = Summary::new(&sea, &boat, &game.field, 1)
            .waves
            .unwrap_or_else(|| panic!("the sea has waves"));
        assert!(
            (waves.hs_m - 0.5).abs() < 1e-9 && (waves.wavelength_m - 14.05).abs() < 0.1,
            "{waves:?}"
        );
        assert!((waves.orbital_rms_m_s - 0.32).abs() < 0.03, "{waves:?}");
        assert!(
            (waves.orbital_on_hull_m_s[0] - 0.27).abs() < 0.03,
            "{waves:?}"
        );
        assert!(
            (waves.drift_newton[1] / 10.7 - 1.0).abs() < 0.25,
            "{waves:?}"
        );
    }
}
