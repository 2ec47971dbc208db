"""The truth about a game for critics: known values at the start, exact positions later, and PettingZoo's `state`."""

import numpy as np
import pytest

import squall

pytest.importorskip("pettingzoo")

CALM = {"game": "pav01_vs_pav01", "seed": 1}
BOATS = ["own", "mate_1", "enemy_1", "enemy_2"]


def told(environment: squall.VectorEnv, state: np.ndarray) -> dict[str, float]:
    names = environment.state_names
    assert len(set(names)) == len(names) == len(state)
    return dict(zip(names, state.tolist(), strict=True))


def test_a_game_begins_with_the_places_that_its_file_says() -> None:
    environment = squall.parallel_env(state=True, **CALM)
    environment.reset()
    state = told(environment, environment.state())
    # Boats start midway between flag and scrimmage line, 50 m from the ends of 160 m, a third of the field from the edges; the enemies
    # begin at their port, which is this team's starboard.
    want = {"own": (-0.375, 1 / 3), "mate_1": (-0.375, -1 / 3), "enemy_1": (0.375, -1 / 3), "enemy_2": (0.375, 1 / 3)}
    for boat, (ahead, port) in want.items():
        assert state[f"{boat}_position_ahead"] == pytest.approx(ahead, abs=1e-6), boat
        assert state[f"{boat}_position_port"] == pytest.approx(port, abs=1e-6), boat
        assert state[f"{boat}_heading_ahead"] == pytest.approx(1.0 if ahead < 0 else -1.0)
    still = [f"{boat}_{name}" for boat in BOATS for name in ("velocity_ahead", "velocity_port", "yaw_rate", "tagged")]
    still += ["own_flag_taken", "enemy_flag_taken", "score_lead", "wind_ahead", "wind_port", "current_ahead"]
    assert all(state[name] == 0.0 for name in still), state
    assert state["time_left"] == 1.0


def test_every_boat_tells_it_from_its_own_end() -> None:
    environment = squall.VectorEnv(2, state=True, opponents="policy", **CALM)
    environment.reset()
    states = environment.states
    assert states.shape == (8, len(environment.state_names))
    np.testing.assert_allclose(
        states[0], states[2], atol=1e-6, err_msg="the first boats of both teams, with mirrored starts"
    )
    np.testing.assert_allclose(states[1], states[3], atol=1e-6)
    assert not np.allclose(states[0], states[1], atol=0.1)


def test_the_places_are_those_of_the_boats_and_not_of_their_sensors() -> None:
    environment = squall.parallel_env(state=True, game="surveyor_2v2", seed=3)
    shown, _ = environment.reset()
    off_m = 0.0
    for step in range(40):
        shown, *_ = environment.step({agent: (step + i) % 17 for i, agent in enumerate(environment.agents)})
        state = told(environment, environment.state())
        scene = environment.native.scene(0)
        ahead = scene["boats"][:, 0] / (0.5 * scene["width_m"]) - 1.0
        port = scene["boats"][:, 1] / (0.5 * scene["depth_m"]) - 1.0
        for boat, name in enumerate(BOATS):
            assert state[f"{name}_position_ahead"] == pytest.approx(ahead[boat], abs=1e-5)
            assert state[f"{name}_position_port"] == pytest.approx(port[boat], abs=1e-5)
        place = environment.observation_names.index("position_ahead")
        off_m = max(off_m, abs(float(shown["blue_1"][place]) - ahead[0]) * 0.5 * scene["width_m"])
    assert off_m > 0.05, "satellite fixes must have errors"


def test_a_game_that_has_ended_is_told_as_it_ended() -> None:
    environment = squall.parallel_env(state=True, episode_max_s=5.0, **CALM)
    environment.reset()
    left = []
    while environment.agents:
        environment.step(dict.fromkeys(environment.agents, 4))
        left.append(told(environment, environment.state())["time_left"])
    assert left == pytest.approx([1 - 0.5 * (step + 1) / 600 for step in range(10)], abs=1e-6)
    environment.reset()
    assert told(environment, environment.state())["time_left"] == 1.0
    vector = squall.VectorEnv(1, state=True, episode_max_s=5.0, **CALM)
    vector.reset()
    for _ in range(10):
        vector.step(np.full(vector.num_envs, 4))
    assert told(vector, vector.final_states[0])["time_left"] == pytest.approx(1 - 5 / 600, abs=1e-6)
    assert told(vector, vector.states[0])["time_left"] == 1.0


def test_a_boat_that_nobody_is_asked_for_is_told_nothing() -> None:
    environment = squall.VectorEnv(8, state=True, seed=1, opponents=[(1.0, "policy"), (1.0, "pav01")])
    environment.reset()
    asked = [boat is not None for game in range(8) for boat in environment.native.boats(game)]
    assert any(asked) and not all(asked)
    assert environment.states.any(axis=1).tolist() == asked


def test_arrays_are_the_callers_unless_copying_is_off() -> None:
    for copy in (True, False):
        environment = squall.VectorEnv(2, seed=1, state=True, copy=copy)
        environment.reset()
        first = environment.states
        kept = first.copy()
        environment.step(np.full(environment.num_envs, 4))
        assert np.array_equal(first, kept) == copy


@pytest.mark.parametrize("options", [{}, {"team": "red"}])
def test_pettingzoo_accepts(options: dict) -> None:
    testing = pytest.importorskip("pettingzoo.test")
    environment = squall.parallel_env(state=True, episode_max_s=20, **options)
    testing.parallel_api_test(environment, num_cycles=100)
    environment.reset()
    assert environment.state() in environment.state_space
    from pettingzoo.test.state_test import test_parallel_env

    test_parallel_env(environment)


def test_who_does_not_ask_is_told_nothing() -> None:
    environment = squall.parallel_env(**CALM)
    environment.reset()
    with pytest.raises(NotImplementedError, match="state=True"):
        environment.state()
    assert squall.VectorEnv(2, seed=1).states.shape == (4, 0)
