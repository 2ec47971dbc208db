//! Interception: assigns boats of the team to intruders.
//!
//! Every boat computes the assignment from the whole team's knowledge, so all get the same result
//! without communication.

use primitives::{Ned, VehicleId};

/// Bonus for the previous assignment, as a reduction of the meeting time, s. Observations are
/// noisy, and two boats that swap intruders at every picture meet neither.
const KEPT_S: f64 = 3.0;

/// Maximum relative rounding error of a bound, with a margin.
const ROUNDING: f64 = 1.001;

/// A boat available to meet an intruder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interceptor {
    pub(super) vehicle: VehicleId,
    pub(super) at: Ned,
    /// The boat's top speed, m/s.
    pub(super) speed_m_s: f64,
    /// Time until the boat can tag, s.
    pub(super) unready_s: f64,
}

/// An enemy to be met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intruder {
    pub(super) vehicle: VehicleId,
    pub(super) at: Ned,
    /// The enemy's velocity over the ground, m/s.
    pub(super) velocity: Ned,
}

/// An interceptor and its intruder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pair {
    pub(super) interceptor: VehicleId,
    pub(super) intruder: VehicleId,
}

/// Assigns to each intruder, in order, the remaining boat that meets it soonest; ties go to the
/// first boat.
pub(super) fn assign(
    interceptors: &[Interceptor],
    intruders: &[Intruder],
    before: &[Pair],
) -> Vec<Pair> {
    // Assign greedily rather than by the best sum over all pairs: the intruder nearest to the flag
    // matters most, and distant boats must not change the result.
    let mut left: Vec<&Interceptor> = interceptors.iter().collect();
    let mut pairs = Vec::with_capacity(intruders.len().min(left.len()));
    for intruder in intruders {
        let kept = before
            .iter()
            .find(|pair| pair.intruder == intruder.vehicle)
            .map(|pair| pair.interceptor);
        let cost_s = |interceptor: &Interceptor| {
            let kept_s = if kept == Some(interceptor.vehicle) {
                KEPT_S
            } else {
                0.0
            };
            interceptor
                .unready_s
                .max(time_to_meet_s(interceptor, intruder))
                - kept_s
        };
        let intruder_m_s = intruder.velocity.length();
        let mut soonest_s = f64::INFINITY;
        let mut soonest = None;
        for (i, interceptor) in left.iter().enumerate() {
            // With many boats, most are too far away to be first, even head-on. Computing the
            // meeting time of every pair took a quarter of the time of a game of 100 against 100.
            let reach_m = (interceptor.speed_m_s + intruder_m_s) * (soonest_s + KEPT_S) * ROUNDING;
            if interceptor.at.distance_squared(intruder.at) > reach_m * reach_m {
                continue;
            }
            let interceptor_s = cost_s(interceptor);
            if soonest.is_none() || interceptor_s.total_cmp(&soonest_s).is_lt() {
                (soonest_s, soonest) = (interceptor_s, Some(i));
            }
        }
        let Some(i) = soonest else { break };
        pairs.push(Pair {
            interceptor: left.remove(i).vehicle,
            intruder: intruder.vehicle,
        });
    }
    pairs
}

/// Time until both can be at the same place, s. If the intruder outruns the boat, twice the time
/// that the boat needs to reach the intruder's current position.
fn time_to_meet_s(interceptor: &Interceptor, intruder: &Intruder) -> f64 {
    let line = intruder.at - interceptor.at;
    meeting_time_s(line, intruder.velocity, interceptor.speed_m_s)
        .unwrap_or_else(|| 2.0 * line.length() / interceptor.speed_m_s)
}

/// The earliest time at which a boat driving straight at this speed meets a contact at `line` with
/// this constant velocity, s; `None` if they never meet.
///
/// The time is the smallest positive root of |line + velocity t| = speed t.
pub(crate) fn meeting_time_s(line: Ned, velocity: Ned, speed_m_s: f64) -> Option<f64> {
    let a = velocity.dot(velocity) - speed_m_s * speed_m_s;
    let half_b = line.dot(velocity);
    let c = line.dot(line);
    if a.abs() < 1e-9 {
        return (half_b < 0.0).then(|| -0.5 * c / half_b);
    }
    let under_root = half_b * half_b - a * c;
    let root = under_root.max(0.0).sqrt();
    let both = [(-half_b - root) / a, (-half_b + root) / a];
    both.into_iter()
        .filter(|t| under_root >= 0.0 && *t > 0.0)
        .reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interceptor(vehicle: u16, east: f64) -> Interceptor {
        Interceptor {
            vehicle: VehicleId(vehicle),
            at: Ned { north: 0.0, east },
            speed_m_s: 2.0,
            unready_s: 0.0,
        }
    }

    fn intruder(vehicle: u16, east: f64) -> Intruder {
        Intruder {
            vehicle: VehicleId(vehicle),
            at: Ned { north: 0.0, east },
            velocity: Ned::default(),
        }
    }

    fn numbers(pairs: &[Pair]) -> Vec<(u16, u16)> {
        pairs
            .iter()
            .map(|pair| (pair.interceptor.0, pair.intruder.0))
            .collect()
    }

    #[test]
    fn each_intruder_has_the_boat_that_meets_it_soonest_and_no_boat_has_two() {
        let boats = [
            interceptor(0, 0.0),
            interceptor(1, 10.0),
            interceptor(2, 40.0),
        ];
        for (intruders, want) in [
            (vec![], vec![]),
            (vec![intruder(7, 9.0)], vec![(1, 7)]),
            (
                vec![intruder(7, 9.0), intruder(8, 11.0)],
                vec![(1, 7), (0, 8)],
            ),
            (
                vec![intruder(8, 11.0), intruder(7, 9.0)],
                vec![(1, 8), (0, 7)],
            ),
            (
                (5..9).map(|i| intruder(i, 30.0)).collect(),
                vec![(2, 5), (1, 6), (0, 7)],
            ),
        ] {
            assert_eq!(
                numbers(&assign(&boats, &intruders, &[])),
                want,
                "{intruders:?}"
            );
        }
        assert!(assign(&[], &[intruder(7, 9.0)], &[]).is_empty());
    }

    #[test]
    fn a_boat_that_has_just_tagged_leaves_the_next_one_to_another() {
        let quick = interceptor(1, 30.0);
        let mut near = interceptor(0, 10.0);
        let meets = |near| numbers(&assign(&[near, quick], &[intruder(7, 0.0)], &[]));
        assert_eq!(meets(near), [(0, 7)]);
        near.unready_s = 20.0;
        assert_eq!(
            meets(near),
            [(1, 7)],
            "15 s to get there, but 20 s until it can tag"
        );
    }

    #[test]
    fn noise_does_not_change_who_meets_whom_and_what_is_better_does() {
        let before = [Pair {
            interceptor: VehicleId(0),
            intruder: VehicleId(7),
        }];
        for (east, want) in [(10.0, 0), (12.0, 0), (15.9, 0), (16.1, 1)] {
            // The other boat is 10 m away on the other side; each further metre takes half a
            // second.
            let boats = [interceptor(0, east), interceptor(1, -10.0)];
            let got = numbers(&assign(&boats, &[intruder(7, 0.0)], &before));
            assert_eq!(got, [(want, 7)], "{east} m");
        }
    }

    fn plain_cost_s(boat: &Interceptor, intruder: &Intruder, kept: Pair) -> f64 {
        let is_kept = kept
            == Pair {
                interceptor: boat.vehicle,
                intruder: intruder.vehicle,
            };
        boat.unready_s.max(time_to_meet_s(boat, intruder)) - if is_kept { KEPT_S } else { 0.0 }
    }

    #[test]
    fn boats_that_are_too_far_off_to_be_sooner_change_nothing() {
        for seed in 0..500 {
            let mut stream = primitives::stream::Stream::new(seed, "interception");
            let mut place = |most_m: f64| Ned {
                north: stream.between(0.0, most_m),
                east: stream.between(0.0, most_m),
            };
            let boats: Vec<Interceptor> = (0..20)
                .map(|i| Interceptor {
                    at: place(300.0),
                    unready_s: place(9.0).north,
                    ..interceptor(i, 0.0)
                })
                .collect();
            let intruders: Vec<Intruder> = (20..30)
                .map(|i| Intruder {
                    at: place(300.0),
                    velocity: place(3.0),
                    ..intruder(i, 0.0)
                })
                .collect();
            let before = [Pair {
                interceptor: VehicleId(3),
                intruder: VehicleId(20),
            }];
            let mut left = boats.clone();
            let mut want = Vec::new();
            for intruder in &intruders {
                let cost_s = |boat: &Interceptor| plain_cost_s(boat, intruder, before[0]);
                let soonest =
                    (0..left.len()).min_by(|a, b| cost_s(&left[*a]).total_cmp(&cost_s(&left[*b])));
                want.push((
                    left.remove(soonest.expect("20 boats for 10")).vehicle.0,
                    intruder.vehicle.0,
                ));
            }
            assert_eq!(
                numbers(&assign(&boats, &intruders, &before)),
                want,
                "seed {seed}"
            );
        }
    }

    #[test]
    fn one_that_comes_on_is_met_sooner_than_one_that_flees() {
        let boat = interceptor(0, 0.0);
        let time_s = |velocity| {
            time_to_meet_s(
                &boat,
                &Intruder {
                    velocity,
                    ..intruder(7, 30.0)
                },
            )
        };
        let going = |east| Ned { north: 0.0, east };
        assert!(
            (time_s(going(-1.0)) - 10.0).abs() < 1e-9 && (time_s(going(1.0)) - 30.0).abs() < 1e-9
        );
        assert!(
            (time_s(going(-2.0)) - 7.5).abs() < 1e-9,
            "as fast as the boat"
        );
        assert!(
            (time_s(going(3.0)) - 30.0).abs() < 1e-9,
            "never: twice the time to its present position"
        );
    }
}
