"""Team sizes drawn for every game."""

import numpy as np
import pytest

import squall

GAME = {"game": "fleet_20v20", "episode_max_s": 2}


def test_each_game_has_its_own_sizes_and_absent_boats_are_zeros() -> None:
    environment = squall.VectorEnv(40, seed=1, team="blue", team_sizes=(1, 3), **GAME)
    assert environment.num_envs == 120
    observations, info = environment.reset()
    sizes = np.zeros(4, dtype=int)
    for _ in range(6):
        present = info["counts"].reshape(40, 3)
        for row in range(2):
            assert not np.any(present[:, row + 1] & ~present[:, row]), "the last boats are absent"
        assert not observations[~info["counts"]].any() and observations[info["counts"]].any(axis=1).all()
        sizes += np.bincount(present.sum(axis=1), minlength=4)
        observations, *_, info = environment.step(np.full(120, 4))
    assert sizes[0] == 0 and (sizes[1:] > 40).all(), sizes


def test_a_team_as_a_row_is_rewarded_for_the_boats_that_play() -> None:
    options = {"team_sizes": ((1, 3), (2, 2)), "team": "blue", "reward": lambda step: 1.0, **GAME}
    environment = squall.VectorEnv(20, row="team", seed=3, **options)
    _, info = environment.reset()
    assert environment.single_observation_space.shape[0] == 3
    assert len({int(boats.sum()) for boats in info["counts"]}) > 1
    for _ in range(5):
        _, rewards, *_ = environment.step(np.full((20, 3), 4))
        assert (rewards == 1).all(), rewards
    team = squall.TeamEnv(seed=3, **options)
    team.reset()
    assert team.step(np.full(3, 4))[1] == 1


def test_both_teams_keep_their_rows_in_self_play() -> None:
    sizes = ((1, 1), (2, 4))
    environment = squall.VectorEnv(10, seed=5, opponents="policy", team_sizes=sizes, **GAME)
    environment.reset()
    names, teams = environment.native.boat_names, environment.native.boat_teams
    for game in range(10):
        first = environment.native.standing(game)["team"]
        rows = environment.native.boats(game)
        assert len(rows) == 8
        for team, boats in ((first, rows[:4]), (1 - first, rows[4:])):
            present = [boat for boat in boats if boat is not None]
            assert sizes[team][0] <= len(present) <= sizes[team][1]
            assert boats[: len(present)] == present and {teams[boat] for boat in present} == {team}
            assert names[present[-1]].endswith(f"_{len(present)}")


def test_the_agents_are_the_boats_of_the_current_game() -> None:
    testing = pytest.importorskip("pettingzoo.test")
    environment = squall.parallel_env(seed=2, team_sizes=((1, 3), (2, 6)), **GAME)
    testing.parallel_api_test(environment, num_cycles=30)
    possible = [*(f"blue_{i}" for i in (1, 2, 3)), *(f"red_{i}" for i in (1, 2, 3, 4, 5, 6))]
    assert environment.possible_agents == possible
    seen = set()
    for seed in range(12):
        observations, infos = environment.reset(seed=seed)
        agents = environment.agents
        assert set(observations) == set(infos) == set(agents) <= set(possible)
        assert all(info["counts"] for info in infos.values())
        seen.add((sum(name.startswith("blue") for name in agents), sum(name.startswith("red") for name in agents)))
        observations, rewards, *_ = environment.step(dict.fromkeys(agents, 4))
        assert set(observations) == set(rewards) == set(agents)
        with pytest.raises(ValueError, match="entries for"):
            environment.step(dict.fromkeys([*agents, "red_20"], 4))
        with pytest.raises(ValueError, match="no entries for"):
            environment.step(dict.fromkeys(agents[1:], 4))
    assert len(seen) > 5 and {blue for blue, _ in seen} <= {1, 2, 3} and {red for _, red in seen} <= {2, 3, 4, 5, 6}


def test_events_and_states_name_the_right_boats() -> None:
    boats: set[str] = set()

    def reward(step: squall.BoatStep) -> float:
        boats.add(step.boat)
        assert step.boat.startswith(step.team)
        return step.after["own_position_ahead"]

    environment = squall.VectorEnv(6, seed=1, opponents="policy", team_sizes=(1, 3), reward=reward, **GAME)
    environment.reset()
    _, rewards, *_, info = environment.step(np.full(36, 4))
    assert boats == {f"{team}_{i}" for team in ("blue", "red") for i in (1, 2, 3)}
    # Every boat starts on its own side.
    assert (rewards[info["counts"]] < 0).all() and (rewards[~info["counts"]] == 0).all()


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ((0, 3), "team_sizes is 0, expected an integer from 1"),
        ((3, 1), r"team_sizes is \[3, 1\], expected two ascending numbers from 1 to 20"),
        ((1, 21), r"team_sizes is \[1, 21\]"),
        ((1, 2, 3), r"team_sizes is \(1, 2, 3\), expected \(minimum, maximum\)"),
        (3, "team_sizes is 3, expected"),
    ],
)
def test_other_sizes_are_refused(sizes: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        squall.VectorEnv(1, team_sizes=sizes, **GAME)  # type: ignore[arg-type]


def test_observations_of_fixed_size_are_refused() -> None:
    with pytest.raises(ValueError, match='expected observation "squall"'):
        squall.VectorEnv(1, team_sizes=(1, 2), observation="pyquaticus", **GAME)
