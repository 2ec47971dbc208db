//! Thrust and the speed that it gives: a map of pairs, read either way.

use game::math::interpolate;

/// The thrust, per cent, that gives a speed, m/s.
pub(crate) fn thrust_for(map: &[(f64, f64)], speed_m_s: f64) -> f64 {
    interpolate(map.iter().map(|(thrust, speed)| (*speed, *thrust)), speed_m_s)
}

/// The speed, m/s, that a thrust, per cent, gives.
pub(crate) fn speed_for(map: &[(f64, f64)], thrust_pct: f64) -> f64 {
    interpolate(map.iter().copied(), thrust_pct)
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
