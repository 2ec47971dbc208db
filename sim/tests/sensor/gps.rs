//! Receivers: latency, bias, noise, drop-outs, frozen and jumping fixes.

use super::*;

#[test]
fn a_fix_says_where_the_boat_was_and_comes_out_after_its_latency_whatever_the_periods() {
    // The limits in `scenario`: latency_s up to 2 and up to 12 periods, period_s from 0.02.
    for decision_ms in [10, 20, 50, 100, 250, 1_000] {
        let decision = SimTime(decision_ms * 1_000_000);
        for period_s in [
            0.02, 0.029, 0.05, 0.074, 0.1, 0.13, 0.149, 0.149_999, 0.15, 0.2, 1.0, 1.49, 10.0,
        ] {
            for latency_s in
                [0.0, 0.3 * period_s, 1.3 * period_s, 12.0 * period_s].map(|s: f64| s.min(2.0))
            {
                let latency = SimTime::from_s(latency_s);
                let sensors = with_gps(Gps {
                    period_s,
                    latency_s,
                    ..exact_gps()
                });
                let model = SensorModel::new(&sensors, decision, &1.into(), "blue_one", &[]);
                let period = decision * ((period_s / decision.as_s()).round() as i64).max(1);
                let mut state = SensorState::default();
                for now in (0..1_000).map(|i| decision * i) {
                    let reading = model.read(&mut state, &sailing(now), now);
                    let want_at = period * ((now - latency).0.max(0) / period.0);
                    let what = format!(
                        "decision {decision}, period {period_s}, latency {latency_s}, at {now}"
                    );
                    assert_eq!(reading.fix_at, want_at, "{what}");
                    assert_eq!(reading.nav.at(), sailing(want_at).pose.at, "{what}");
                    let surge_m_s = reading.nav.surge_m_s;
                    let sway_m_s = reading.nav.sway_m_s;
                    assert!(
                        (surge_m_s - 2.0).abs() < 1e-12 && (sway_m_s - 0.5).abs() < 1e-12,
                        "{what}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_game_with_an_awkward_period_and_a_long_latency_is_played() {
    let mut scenario = common::alone("surveyor_m1_8", "calm");
    for boat in &mut scenario.boats {
        boat.sensors.gps = Some(Gps {
            period_s: 0.13,
            latency_s: 1.55,
            ..exact_gps()
        });
    }
    let mut contest = sim::Contest::new(&scenario, 1).unwrap();
    for k in 0..200_i64 {
        let late = SimTime(1_600_000_000);
        let want_at = SimTime((contest.now() - late).0.max(0));
        assert_eq!(
            contest.pictures()[0].own[0].fix_ns,
            want_at,
            "at decision {k}"
        );
        contest.advance();
    }
}

#[test]
fn the_bias_of_a_receiver_wanders_as_stated_and_noise_comes_on_top() {
    const FIXES: usize = 1_200_000;
    const STEP_S: f64 = 0.2;
    let gps = Gps {
        bias_m: 1.5,
        bias_time_s: 8.0,
        noise_m: 0.0,
        ..exact_gps()
    };
    let fixes = |gps: Gps, seed| -> Vec<Ned> {
        gps_record(gps, seed, FIXES as i64, at_rest)
            .iter()
            .map(|(_, reading)| reading.nav.at())
            .collect()
    };
    let biased = fixes(gps.clone(), 2);
    let within = five_errors(FIXES, STEP_S / 8.0);
    assert!(within < 0.05);
    let (north, east): (Vec<f64>, Vec<f64>) = biased
        .iter()
        .map(|at| (at.north / 1.5, at.east / 1.5))
        .unzip();
    for (what, x) in [("north", north), ("east", east)] {
        assert_memory(what, &x, &[0, 10, 40, 80], STEP_S / 8.0, within);
    }
    assert!(mean_of(FIXES, |i| biased[i].north * biased[i].east).abs() / 2.25 < within);
    // Noise does not affect the bias: the difference of the two records is the noise.
    let noisy = fixes(
        Gps {
            noise_m: 0.2,
            ..gps
        },
        2,
    );
    let noise: Vec<f64> = noisy
        .iter()
        .zip(&biased)
        .map(|(noisy, biased)| noisy.north - biased.north)
        .collect();
    let variance = mean_of(FIXES, |i| noise[i] * noise[i]) / 0.04;
    let neighbours = mean_of(FIXES - 1, |i| noise[i] * noise[i + 1]) / 0.04;
    assert!((variance - 1.0).abs() < 0.01, "variance {variance}");
    assert!(neighbours.abs() < 0.01, "white: {neighbours}");
}

#[test]
fn a_boat_s_first_bias_is_as_large_as_any() {
    let first = |seed| {
        record(
            &with_gps(Gps {
                bias_m: 2.0,
                ..exact_gps()
            }),
            seed,
            1,
            at_rest,
        )[0]
        .1
        .nav
        .at()
    };
    let variance = mean_of(20_000, |seed| {
        first(seed as u64).east * first(seed as u64).east
    }) / 4.0;
    assert!((variance - 1.0).abs() < 0.05, "{variance}");
}

#[test]
fn velocity_is_noisy_over_the_ground_and_turned_with_the_heading_that_is_read() {
    const TURN_RAD: f64 = 0.3;
    let sensors = Sensors {
        gps: Some(exact_gps()),
        compass: Some(Compass {
            declination_error_rad: TURN_RAD,
            ..EXACT_COMPASS
        }),
        imu: None,
    };
    let (_, reading) = record(&sensors, 1, 9, sailing)[8];
    let truth = sailing(SimTime::ZERO);
    let want = body_from_ned(
        Rotation::from_heading(truth.pose.psi_rad - TURN_RAD),
        truth.velocity_m_s(),
    );
    assert!((reading.nav.surge_m_s - want.ahead).abs() < 1e-12);
    assert!((reading.nav.sway_m_s - want.starboard).abs() < 1e-12);
    assert!(
        (reading.nav.sway_m_s - 0.5).abs() > 0.5,
        "a wrong heading must show way ahead as leeway"
    );

    let noisy = gps_record(
        Gps {
            velocity_noise_m_s: 0.08,
            ..exact_gps()
        },
        1,
        100_000,
        sailing,
    );
    let error: Vec<f64> = noisy
        .iter()
        .map(|(_, reading)| reading.nav.surge_m_s - 2.0)
        .collect();
    let sigma = mean_of(error.len(), |i| error[i] * error[i]).sqrt();
    assert!((sigma / 0.08 - 1.0).abs() < 0.02, "{sigma}");
}

#[test]
fn drop_outs_take_their_share_and_last_as_stated_and_the_last_fix_is_kept() {
    const RATE_PER_S: f64 = 0.1;
    const MEAN_S: f64 = 3.0;
    let dropout = Outage {
        rate_per_s: RATE_PER_S,
        mean_s: MEAN_S,
    };
    let read = record(
        &with_gps(Gps {
            dropout,
            ..exact_gps()
        }),
        3,
        4_000_000,
        sailing,
    );
    let fixes: Vec<&(SimTime, Reading)> = read.iter().step_by(4).collect();
    let dropped: Vec<bool> = fixes
        .iter()
        .map(|(now, reading)| reading.fix_at != *now)
        .collect();
    let share = mean_of(dropped.len(), |i| f64::from(u8::from(dropped[i])));
    let want = RATE_PER_S * MEAN_S / (1.0 + RATE_PER_S * MEAN_S);
    // 15 000 drop-outs: a standard error of about 1 % of the fraction.
    assert!(
        (share / want - 1.0).abs() < 0.05,
        "share {share}, not {want}"
    );
    // Sampled every 0.2 s, an exponential duration is geometric. A drop-out ends with the next fix
    // with the probability `want_end`.
    let ended = dropped
        .windows(2)
        .filter(|pair| pair[0] && !pair[1])
        .count();
    let on = dropped.iter().filter(|on| **on).count();
    let both = 1.0 / MEAN_S + RATE_PER_S;
    let want_end = 1.0 / MEAN_S / both * (1.0 - math::exp(-both * 0.2));
    let end = ended as f64 / on as f64;
    assert!(
        (end / want_end - 1.0).abs() < 0.05,
        "ends with {end} a fix, not {want_end}"
    );
    for (now, reading) in &read {
        assert_eq!(
            reading.nav.at(),
            sailing(reading.fix_at).pose.at,
            "at {now} the last fix is kept"
        );
    }
}

#[test]
fn a_frozen_receiver_repeats_itself_with_new_times() {
    let freeze = Outage {
        rate_per_s: 0.1,
        mean_s: 3.0,
    };
    let fixes = gps_record(
        Gps {
            freeze,
            ..exact_gps()
        },
        4,
        100_000,
        sailing,
    );
    let mut frozen = 0;
    for pair in fixes.windows(2) {
        let [before, (now, reading)] = pair else {
            unreachable!("windows of two")
        };
        assert_eq!(reading.fix_at, *now, "fixes continue");
        if reading.nav.at() == before.1.nav.at() {
            frozen += 1;
        } else {
            assert_eq!(
                reading.nav.at(),
                sailing(*now).pose.at,
                "the first fix of a freeze and all others are true"
            );
        }
    }
    // The first fix of each of the 10 000 s / (10 + 3) s freezes is true and does not count.
    let share = f64::from(frozen) / fixes.len() as f64;
    let want = 3.0 / 13.0 - 0.2 / 13.0;
    assert!(
        (share / want - 1.0).abs() < 0.12,
        "share {share}, not {want}"
    );
}

#[test]
fn a_jump_lasts_until_the_next() {
    let jump = Jump {
        rate_per_s: 0.05,
        sigma_m: 4.0,
    };
    let read = gps_record(
        Gps {
            jump,
            ..exact_gps()
        },
        5,
        250_000,
        at_rest,
    );
    let fixes: Vec<Ned> = read.iter().map(|(_, reading)| reading.nav.at()).collect();
    assert_eq!(fixes[0], Ned::default());
    let offsets: Vec<Ned> = fixes
        .windows(2)
        .filter(|pair| pair[0] != pair[1])
        .map(|pair| pair[1])
        .collect();
    let rate_per_s = offsets.len() as f64 / (fixes.len() as f64 * 0.2);
    assert!(
        (rate_per_s / 0.05 - 1.0).abs() < 0.1,
        "{rate_per_s} jumps a second"
    );
    let sigma_m = mean_of(offsets.len(), |i| offsets[i].dot(offsets[i]) / 2.0).sqrt();
    assert!((sigma_m / 4.0 - 1.0).abs() < 0.07, "{sigma_m} m");
}
