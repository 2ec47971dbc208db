"""Invalid input raises a ValueError with all faults, and nothing is played."""

from pathlib import Path

import gymnasium
import numpy as np
import pytest

import squall


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"game": "nowhere"}, "games has no 'nowhere': expected a path that ends with .toml, or one of .*surveyor_2v2"),
        ({"game": "/nowhere/game.toml"}, "game.toml"),
        ({"game": "uneven_3v2"}, "the teams have 3 and 2 boats"),
        ({"decision_s": 0.25}, "decision_s is 0.25, expected a multiple of the game's decision_s"),
        ({"decision_s": 0}, "decision_s is 0, expected a multiple"),
        ({"decision_s": float("nan")}, "decision_s is NaN"),
        ({"episode_max_s": -1}, "episode_max_s is -1, expected more than 0"),
        ({"starts": 0}, "starts is 0, expected 1 or more"),
        ({"starts": 3.7}, "starts is 3.7, expected an integer"),
        ({"frames": 3.7}, "frames is 3.7, expected an integer from 0 to 255"),
        ({"games": 3.7}, "games is 3.7, expected an integer"),
        ({"seed": 3.7}, "seed is 3.7, expected an integer"),
        ({"seed": "7"}, "seed is '7', expected an integer"),
        ({"frames": 0}, "frames is 0, expected 1 to 255"),
        ({"frames": 300}, "frames is 300, expected an integer from 0 to 255"),
        ({"observation": "truth"}, 'observation is "truth", expected "squall", "pyquaticus", "pyquaticus_2023" or "pyquaticus_2026"'),
        ({"action": "jump"}, 'action is "jump", expected "pyquaticus", "continuous" or "options"'),
        ({"control": "pav01"}, 'has no behaviour of kind "policy"'),
        ({"opponents": []}, "no opponent can be drawn"),
        ({"opponents": [(-1.0, "pav01")]}, "an opponent's weight is -1, expected 0 or more"),
        ({"rewards": "gold"}, "rewards has no 'gold'"),
        ({"discount": 2}, "discount is 2, expected 0 to 1"),
        ({"team": "green"}, 'team is "green", expected "blue" or "red"'),
        ({"games": 0}, "games is 0, expected 1 to"),
        ({"threads": 5000}, "threads is 5000"),
        ({"seed": -1}, "seed is -1"),
        ({"row": "fleet"}, "row is 'fleet'"),
        ({"render_mode": "human"}, "render_mode is 'human'"),
        ({"colour": "red"}, r"unknown option \['colour'\]"),
    ],
)
def test_options_are_refused(options: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        squall.VectorEnv(**{"games": 1, **options})


def test_everything_that_is_wrong_with_a_file_is_told(tmp_path: Path) -> None:
    rewards = tmp_path / "rewards.toml"
    rewards.write_text("[boat]\ngrab = 'much'\nfame = 1\n")
    with pytest.raises(ValueError) as error:
        squall.VectorEnv(rewards=rewards)
    assert f"{rewards}:2" in str(error.value) and f"{rewards}:3" in str(error.value)


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        (np.zeros(3, dtype=int), r"shape \(3,\), expected one for each of 4 boats"),
        (np.full(4, 17), "the action in row 0 is 17, expected 0 to 16"),
        (np.array([0, 0, -1, 0]), "the action in row 2 is -1, expected 0 to 16"),
        (np.zeros(4), "have the type float64, expected integers"),
        (np.full(4, 3.7), "have the type float64, expected integers"),
        (np.zeros((2, 2), dtype=int), r"have the shape \(2, 2\), expected one for each of 4 boats in the shape \(4,\)"),
        ([[0, 0], [0]], r"actions are \[\[0, 0\], \[0\]\], expected an array with the shape \(4,\)"),
        ([True] * 4, "have the type bool, expected integers"),
        (["port"] * 4, "have the type <U4, expected integers"),
        (None, "have the type object, expected integers"),
    ],
)
def test_actions_are_refused_and_nothing_is_played(actions: np.ndarray, message: str) -> None:
    environment = squall.VectorEnv(2, seed=1)
    environment.reset()
    before = environment.native.digest(0)
    with pytest.raises(ValueError, match=message):
        environment.step(actions)
    assert environment.native.digest(0) == before
    environment.step(np.zeros(4, dtype=int))
    assert environment.native.digest(0) != before


def test_continuous_actions_are_finite() -> None:
    environment = squall.VectorEnv(1, action="continuous")
    environment.reset()
    with pytest.raises(ValueError, match=r"the action in row 1 is \[NaN, 1.0\], expected two finite numbers"):
        environment.step(np.array([[0, 0], [np.nan, 1]]))
    with pytest.raises(ValueError, match="two numbers for each of 2 boats"):
        environment.step(np.zeros(2))


def test_a_single_environment_refuses_actions_of_another_shape() -> None:
    for environment, action, message in (
        (squall.BoatEnv(), 3.7, "have the type float64, expected integers"),
        (squall.BoatEnv(), [3, 3], r"have the shape \(2,\), expected one for each of 1 boats in the shape \(\)"),
        (squall.TeamEnv(), 3, r"have the shape \(\), expected one for each of 2 boats in the shape \(2,\)"),
        (squall.TeamEnv(), [[3], [3]], r"have the shape \(2, 1\), expected one"),
        (
            squall.BoatEnv(action="continuous"),
            [0, 0, 0],
            r"have the shape \(3,\), expected two numbers for each of 1 boats",
        ),
        (squall.BoatEnv(action="continuous"), "ahead", "have the type <U5, expected numbers"),
        (squall.TeamEnv(action="continuous"), np.zeros(4), r"have the shape \(4,\), expected two .* shape \(2, 2\)"),
    ):
        environment.reset()
        before = environment.native.digest(0)
        with pytest.raises(ValueError, match=message):
            environment.step(action)
        assert environment.native.digest(0) == before


def test_agents_have_one_action_each() -> None:
    pytest.importorskip("pettingzoo")
    environment = squall.parallel_env()
    environment.reset()
    before = environment.native.digest(0)
    good = dict.fromkeys(environment.agents, 3)
    for actions, message in (
        ({**good, "red_2": 3.7}, "red_2: actions have the type float64, expected integers"),
        ({**good, "red_2": [3]}, r"red_2: actions have the shape \(1,\), expected one for each of 1 boats"),
        ({**good, "red_2": None}, "red_2: actions have the type object"),
        (
            {**good, "green_1": 3},
            r"actions has entries for \['green_1'\], expected \['blue_1', 'blue_2', 'red_1', 'red_2'\]",
        ),
        ({**good, "red_2": 17}, "the action in row 3 is 17, expected 0 to 16"),
        ({}, r"actions has no entries for \['blue_1', 'blue_2', 'red_1', 'red_2'\]"),
        ([3, 3, 3, 3], "expected a dictionary with an entry for each agent"),
        (None, "actions are None, expected a dictionary"),
    ):
        with pytest.raises(ValueError, match=message):
            environment.step(actions)
        assert environment.native.digest(0) == before


def test_seeds_and_masks_fit_the_games() -> None:
    environment = squall.VectorEnv(2)
    with pytest.raises(ValueError, match="seed has 3 numbers, expected one for each of 2 games"):
        environment.reset(seed=[1, 2, 3])
    with pytest.raises(ValueError, match=r"reset_mask has the shape \(2,\), expected \(4,\)"):
        environment.reset(options={"reset_mask": [True, False]})


def test_nobody_acts_for_enemies_where_there_is_no_row_for_them() -> None:
    for make in (squall.TeamEnv, squall.BoatEnv, lambda **options: squall.parallel_env(team="blue", **options)):
        with pytest.raises(ValueError, match='opponents has "policy"'):
            make(opponents="policy")
    with pytest.raises(ValueError, match="all boats are agents"):
        squall.parallel_env(opponents="pav01")


def test_a_game_that_is_over_has_to_be_reset() -> None:
    environment = squall.TeamEnv(episode_max_s=0.5)
    environment.reset()
    assert environment.step([0, 0])[3]
    with pytest.raises(gymnasium.error.ResetNeeded):
        environment.step([0, 0])
    agents = squall.parallel_env(episode_max_s=0.5)
    agents.reset()
    with pytest.raises(ValueError, match=r"actions has no entries for \['blue_2', 'red_1', 'red_2'\]"):
        agents.step({"blue_1": 0})
    agents.step(dict.fromkeys(agents.agents, 0))
    assert agents.agents == []
