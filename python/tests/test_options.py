"""Options: a policy chooses what a boat does, and a strategy defines how."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import squall

PLANS = ["attack", "rush", "pursue", "hold", "wait", "chase", "shield", "port", "starboard", "retreat"]
OPTIONS = {"action": "options", "control": "options"}


@pytest.mark.filterwarnings("ignore:.*A Box observation space m.*imum value is.*infinity")
@pytest.mark.parametrize("name", ["Squall/CaptureTheFlag-v0", "Squall/PyquaticusBoat-v0"])
@pytest.mark.usefixtures("page")
def test_gymnasium_accepts(name: str) -> None:
    check_env(gymnasium.make(name, episode_max_s=30, **OPTIONS).unwrapped)


def test_there_is_an_action_for_each_option() -> None:
    assert squall.BoatEnv(**OPTIONS).action_space.n == len(PLANS)
    assert squall.TeamEnv(**OPTIONS).action_space.nvec.tolist() == [len(PLANS)] * 2
    environment = squall.VectorEnv(2, **OPTIONS)
    assert environment.single_action_space.n == len(PLANS) and environment.action_names == PLANS
    environment.reset()
    with pytest.raises(ValueError, match="the action in row 1 is 10, expected 0 to 9"):
        environment.step(np.array([9, 10, 0, 0]))


def test_agents_choose_among_options() -> None:
    testing = pytest.importorskip("pettingzoo.test")
    environment = squall.parallel_env(episode_max_s=20, **OPTIONS)
    testing.parallel_api_test(environment, num_cycles=50)
    assert environment.action_names == PLANS


def along_after(plan: str) -> float:
    """A boat's distance from its own end after half a minute, m."""
    environment = squall.BoatEnv(game="pyquaticus_2v2", seed=4, team="blue", **OPTIONS)
    environment.reset()
    for _ in range(60):
        environment.step(PLANS.index(plan))
    boat = environment.native.boats(0)[0]
    assert boat is not None
    return float(environment.native.scene(0)["boats"][boat, 0])


def test_an_option_is_carried_out() -> None:
    assert along_after("rush") > along_after("retreat") + 20


def test_actions_have_names() -> None:
    names = squall.BoatEnv().action_names
    assert names is not None and len(set(names)) == 17 and (names[4], names[-1]) == ("full speed, straight on", "stop")
    assert squall.BoatEnv(action="continuous").action_names is None
    assert squall.parallel_env().action_names == names


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"action": "options"}, "action is options, expected a different action space, or a helm whose strategy declares options"),
        ({"action": "options", "control": "policy"}, 'no behaviour of kind "policy" with `sets`'),
        ({"control": "options"}, 'no behaviour of kind "policy" for course and speed'),
    ],
)
def test_options_without_a_strategy_that_has_them_are_refused(options: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        squall.VectorEnv(**options)
