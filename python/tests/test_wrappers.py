"""Wrappers and vector environments of gymnasium work on these environments."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.wrappers import vector as wrappers

import squall

SHORT = {"episode_max_s": 2.0, "seed": 1}


@pytest.mark.parametrize(
    "name", ["RecordEpisodeStatistics", "NormalizeObservation", "NormalizeReward", "DictInfoToList"]
)
@pytest.mark.parametrize("row", ["boat", "team"])
def test_vector_wrappers_work_across_ends_of_games(name: str, row: str) -> None:
    # gymnasium refuses wrappers of observations that would miss the last one of a game.
    mode = "NextStep" if name == "NormalizeObservation" else "SameStep"
    environment = getattr(wrappers, name)(squall.VectorEnv(3, row=row, autoreset_mode=mode, **SHORT))
    environment.reset()
    environment.action_space.seed(1)
    for step in range(1, 13):
        *_, truncated, info = environment.step(environment.action_space.sample())
        assert truncated.all() == (step in ([4, 9] if mode == "NextStep" else [4, 8, 12]))
    if name == "RecordEpisodeStatistics":
        assert environment.episode_count == 3 * environment.num_envs
        assert info["episode"]["l"].tolist() == [4] * environment.num_envs
    if name == "DictInfoToList":
        assert len(info) == environment.num_envs and info[0]["final_info"]["steps"] == 4


def test_the_sum_of_rewards_is_that_of_the_episode() -> None:
    plain, counting = squall.VectorEnv(2, **SHORT), wrappers.RecordEpisodeStatistics(squall.VectorEnv(2, **SHORT))
    for environment in (plain, counting):
        environment.reset()
    sums = np.zeros(4)
    for _ in range(4):
        sums += plain.step(np.full(4, 4))[1]
        info = counting.step(np.full(4, 4))[4]
    np.testing.assert_allclose(info["episode"]["r"], sums, rtol=1e-6)
    mode = getattr(gymnasium.vector, "AutoresetMode", None)
    assert plain.metadata["autoreset_mode"] == (mode.SAME_STEP if mode else "SameStep")


def test_a_game_may_restart_in_the_next_step() -> None:
    calls: list[squall.BoatStep] = []
    options = {"state": True, **SHORT}
    same = squall.VectorEnv(2, **options)
    later = squall.VectorEnv(
        2, autoreset_mode="NextStep", reward=lambda step: calls.append(step) or step.reward, **options
    )
    assert later.metadata["autoreset_mode"] == getattr(gymnasium.vector, "AutoresetMode", str)("NextStep")
    assert (same.reset()[0] == later.reset()[0]).all()
    for step in range(1, 9):
        expected, rewards, _, truncated, info = same.step(np.full(4, step))
        observations, *rest, later_info = later.step(np.full(4, step))
        assert (rest[0] == rewards).all() and (rest[2] == truncated).all()
        if truncated.any():
            assert (observations == np.stack(info["final_obs"])).all() and "final_obs" not in later_info
            assert (later_info["final_info"]["score"] == info["final_info"]["score"]).all()
            assert later_info["seed"].tolist() == info["final_info"]["seed"].tolist()
            played = len(calls)
            observations, *rest, later_info = later.step(np.full(4, 16))
            assert not rest[0].any() and not rest[2].any() and len(calls) == played
        assert (observations == expected).all() and (later_info["seed"] == info["seed"]).all()
    with pytest.raises(ValueError, match='autoreset_mode is \'Never\', expected "SameStep" or "NextStep"'):
        squall.VectorEnv(1, autoreset_mode="Never")


@pytest.mark.parametrize("mode", ["NEXT_STEP", "SAME_STEP", "DISABLED"])
def test_gymnasiums_own_vectors_play_several_games(mode: str) -> None:
    modes = pytest.importorskip("gymnasium.vector", reason="gymnasium 1.1").AutoresetMode
    make = lambda: gymnasium.wrappers.RecordEpisodeStatistics(squall.BoatEnv(episode_max_s=2.0))
    vector = gymnasium.vector.SyncVectorEnv([make] * 2, autoreset_mode=modes[mode])
    vector.reset(seed=1)
    ends = 0
    for _ in range(15):
        *_, truncated, _ = vector.step(np.full(2, 3))
        ends += int(truncated.sum())
        if mode == "DISABLED" and truncated.any():
            vector.reset(options={"reset_mask": truncated})
    assert ends == 6


def picture_before_the_end(environment: Any, action: Any) -> tuple[Any, Any]:
    """The scenes before and after the last step of a game."""
    environment.reset()
    for _ in range(3):
        environment.step(action)
    before = environment.native.scene(0)
    environment.step(action)
    return before, environment.native.scene(0)


def test_pictures_show_the_end_of_a_game() -> None:
    pytest.importorskip("pettingzoo")
    options = {"render_mode": "rgb_array", "team": "blue", **SHORT}
    boats = dict.fromkeys(["blue_1", "blue_2"], 4)
    for environment, action in (
        (squall.BoatEnv(**options), 4),
        (squall.TeamEnv(**options), [4, 4]),
        (squall.parallel_env(**options), boats),
        (squall.VectorEnv(1, **options), [4, 4]),
    ):
        before, after = picture_before_the_end(environment, action)
        moved_m = np.abs(after["boats"][:, :2] - before["boats"][:, :2]).max()
        assert 0 < moved_m < 5 and after["time_s"] == 2.0
        picture = environment.render()
        environment.reset()
        next_picture = environment.render()
        assert environment.native.scene(0)["time_s"] == 0.0
        assert not np.array_equal(picture, next_picture)


def test_a_mask_leaves_one_action_to_a_boat_that_obeys_none() -> None:
    # Full ahead until every boat has left the field, and is tagged.
    environment = squall.VectorEnv(4, seed=3)
    _, info = environment.reset()
    assert info["action_mask"].shape == (8, 17) and info["action_mask"].dtype == np.int8 and info["action_mask"].all()
    seen = set()
    for _ in range(200):
        info = environment.step(np.full(8, 4))[4]
        expected = np.where(info["counts"][:, np.newaxis], 1, np.arange(17) == 16)
        assert (info["action_mask"] == expected).all()
        assert (environment.action_masks() == expected).all()
        seen |= set(info["counts"].tolist())
    assert seen == {True, False}


def test_spaces_draw_actions_by_the_masks() -> None:
    pytest.importorskip("pettingzoo")
    boat, team, agents = squall.BoatEnv(), squall.TeamEnv(), squall.parallel_env()
    _, info = boat.reset()
    boat.step(boat.action_space.sample(info["action_mask"]))
    _, info = team.reset()
    team.step(team.action_space.sample(tuple(info["action_mask"])))
    _, infos = agents.reset()
    agents.step({agent: agents.action_space(agent).sample(infos[agent]["action_mask"]) for agent in agents.agents})
    assert boat.action_masks().shape == (17,) and team.action_masks().shape == (34,)
    assert "action_mask" not in squall.BoatEnv(action="continuous").reset()[1]
    with pytest.raises(ValueError, match="continuous actions have no mask"):
        squall.BoatEnv(action="continuous").action_masks()
