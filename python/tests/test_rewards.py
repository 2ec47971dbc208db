"""Rewards as a Python function."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import squall

README = Path(__file__).parents[1] / "README.md"


def test_the_example_of_the_readme_runs() -> None:
    (example,) = (
        text for text in re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL) if "reward=" in text
    )
    names: dict[str, Any] = {}
    exec(example, names)  # noqa: S102
    environment = names["environment"]
    environment.reset(seed=1)
    rewards = [environment.step(environment.action_space.sample())[1] for _ in range(100)]
    assert len(set(rewards)) > 10


def test_every_environment_accepts_a_function() -> None:
    pytest.importorskip("pettingzoo")
    options = {"reward": lambda step: 2.5, "seed": 1}
    boat, team = squall.BoatEnv(**options), squall.TeamEnv(**options)
    agents, vector = squall.parallel_env(**options), squall.VectorEnv(3, **options)
    for environment in (boat, team, agents, vector):
        environment.reset()
    assert boat.step(3)[1] == team.step([3, 3])[1] == 2.5
    assert set(agents.step(dict.fromkeys(agents.agents, 3))[1].values()) == {2.5}
    assert vector.step(np.full(6, 3))[1].tolist() == [2.5] * 6


def test_a_function_receives_states_actions_and_the_rewards_of_the_file() -> None:
    steps: list[squall.BoatStep] = []

    def reward(step: squall.BoatStep) -> float:
        steps.append(step)
        return step.reward

    ours = squall.VectorEnv(2, seed=1, reward=reward, state=True, episode_max_s=5.0)
    other = squall.VectorEnv(2, seed=1, state=True, episode_max_s=5.0)
    ours.reset()
    other.reset()
    for turn in range(25):
        before = other.states
        boats = [other.native.boats(game) for game in range(2)]
        results = [environment.step(np.full(4, turn % 17)) for environment in (ours, other)]
        assert (results[0][1] == results[1][1]).all()
        after = other.final_states if results[1][3].any() else other.states
        for row, step in enumerate(steps[-4:]):
            assert step.boat == other.native.boat_names[boats[row // 2][row % 2] or 0] and step.boat.startswith(
                step.team
            )
            assert step.action == turn % 17 and step.truncated == (turn % 10 == 9) and not step.terminated
            assert list(step.before.values()) == before[row].tolist()
            assert list(step.after.values()) == after[row].tolist()
            assert step.after["own_position_ahead"] == after[row, other.state_names.index("own_position_ahead")]
    assert len(steps) == 100


def test_events_are_those_of_the_game() -> None:
    counted = {"grabbed": 0, "captured": 0, "tagged": 0, "ended": 0}

    def reward(step: squall.BoatStep) -> float:
        if step.boat == "blue_1":
            for event in step.events:
                counted[event.name] = counted.get(event.name, 0) + 1
                assert event.name == "ended" or (event.boat or "").startswith(event.team or "-")
        return 0.0

    environment = squall.VectorEnv(1, game="surveyor_2v2", team="blue", control="teleop", seed=1, reward=reward)
    environment.reset()
    is_over = False
    while not is_over:
        _, _, terminated, _, info = environment.step(np.array([4, 4]))
        is_over = bool(terminated[0])
    final = {name: int(values[0]) for name, values in info["final_info"].items()}
    assert counted["grabbed"] == final["grabs"] + final["enemy_grabs"] > 0
    assert counted["captured"] == final["captures"] + final["enemy_captures"]
    assert counted["tagged"] == final["tagged"] + final["enemy_tagged"] + final["out_of_bounds"] > 0
    assert counted["ended"] == 1


def test_rows_without_actions_have_no_reward() -> None:
    environment = squall.VectorEnv(8, seed=1, opponents=[(1, "policy"), (1, "pav01")], reward=lambda step: 1.0)
    environment.reset()
    rewards = environment.step(np.zeros(32, dtype=int))[1].reshape(8, 4)
    for game in range(8):
        assert rewards[game].tolist() == [float(boat is not None) for boat in environment.native.boats(game)]
    assert {rewards[game].sum() for game in range(8)} == {2.0, 4.0}


def test_a_file_is_no_function() -> None:
    with pytest.raises(ValueError, match="reward is 'bold', expected a function; rewards names a file"):
        squall.BoatEnv(reward="bold")


def test_a_team_receives_the_mean_over_its_boats() -> None:
    environment = squall.TeamEnv(seed=1, reward=lambda step: float(step.boat.endswith("_1")))
    environment.reset()
    assert environment.step([3, 3])[1] == 0.5
