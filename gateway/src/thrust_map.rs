//! Thrust and the speed that it gives: a map of pairs, read either way.

/// The value at `x` of a curve through points of rising x: straight between them, its ends beyond them.
fn value_at(points: impl Iterator<Item = (f64, f64)>, x: f64) -> f64 {
    let mut before: Option<(f64, f64)> = None;
    for (at, value) in points {
        if at >= x {
            return match before {
                Some((at_before, value_before)) if at > at_before => {
                    value_before + (value - value_before) * (x - at_before) / (at - at_before)
                }
                _ => value,
            };
        }
        before = Some((at, value));
    }
    before.map_or(0.0, |(_, value)| value)
}

/// The thrust, per cent, that gives a speed, m/s.
pub(crate) fn thrust_for(map: &[(f64, f64)], speed_m_s: f64) -> f64 {
    value_at(map.iter().map(|(thrust, speed)| (*speed, *thrust)), speed_m_s)
}

/// The speed, m/s, that a thrust, per cent, gives.
pub(crate) fn speed_for(map: &[(f64, f64)], thrust_pct: f64) -> f64 {
    value_at(map.iter().copied(), thrust_pct)
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::gateway::SURVEYOR_THRUST_MAP;

    #[test]
    fn a_speed_between_two_of_the_map_takes_thrust_between() {
        for (speed, want) in
            [(0.0, 0.0), (0.5, 10.0), (1.25, 30.0), (3.0, 100.0), (4.0, 100.0), (-2.0, -100.0), (-3.0, -100.0)]
        {
            assert!((thrust_for(&SURVEYOR_THRUST_MAP, speed) - want).abs() < 1e-9, "{speed}");
        }
        for thrust in [-100.0, -50.0, 0.0, 10.0, 65.0, 100.0] {
            let there_and_back = thrust_for(&SURVEYOR_THRUST_MAP, speed_for(&SURVEYOR_THRUST_MAP, thrust));
            assert!((there_and_back - thrust).abs() < 1e-9, "{thrust}");
        }
    }
}
