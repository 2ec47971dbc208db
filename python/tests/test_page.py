"""Rendering for people: the program `squall` shows the games one by one on its page."""

import urllib.request
from pathlib import Path

import gymnasium
import pytest
from conftest import Shown
from gymnasium.utils.env_checker import check_env

import squall
from squall.page import PAGE

SHORT = {"render_mode": "human", "episode_max_s": 1.0, "seed": 1}


def test_a_game_is_shown_when_it_ends_and_the_next_on_the_same_page(page: Shown, tmp_path: Path) -> None:
    environment = squall.BoatEnv(record=tmp_path / "runs", **SHORT)
    environment.reset()
    environment.step(0)
    assert environment.render() is None and page.commands() == []
    environment.step(0)
    _, info = environment.reset()
    environment.step(0)
    assert page.browser == ["http://127.0.0.1:8088/"] and len(page.commands()) == 1
    environment.reset()
    first, second = page.commands()
    assert first.startswith("replay ") and first.endswith("_surveyor_2v2_1.mcap --listen 127.0.0.1:0")
    assert second.endswith(f"_surveyor_2v2_{info['seed']}.mcap --listen 127.0.0.1:8088"), "an abandoned game is shown too"
    assert page.browser == ["http://127.0.0.1:8088/"], "the page moves to the next game by itself"
    environment.step(0)
    environment.close()
    assert len(page.commands()) == 3
    environment.close()
    assert len(page.commands()) == 3


def test_games_of_agents_are_shown(page: Shown) -> None:
    pytest.importorskip("pettingzoo")
    environment = squall.parallel_env(**SHORT)
    environment.reset()
    while environment.agents:
        environment.step(dict.fromkeys(environment.agents, 0))
    assert len(page.commands()) == 1
    file = Path(page.commands()[0].split()[1])
    assert file.is_relative_to(PAGE.folder()) and file.is_file()


def test_a_game_that_nobody_played_is_not_shown(page: Shown) -> None:
    environment = squall.TeamEnv(**SHORT)
    environment.reset(seed=5)
    environment.close()
    assert page.commands() == [] and page.browser == []


@pytest.mark.parametrize("named", [None, "/nowhere/squall"])
def test_it_is_said_what_is_missing(monkeypatch: pytest.MonkeyPatch, named: str | None) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("SQUALL", raising=False)
    if named is not None:
        monkeypatch.setenv("SQUALL", named)
    where = "on PATH" if named is None else "at '/nowhere/squall', the path in the environment variable SQUALL"
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match=f"the program squall, which is not {where}"):
        squall.TeamEnv(render_mode="human")


@pytest.mark.filterwarnings("ignore:.*A Box observation space m.*imum value is.*infinity")
@pytest.mark.parametrize("name", [name for name in gymnasium.registry if name.startswith("Squall/")])
def test_gymnasium_accepts_environments_without_the_program(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv("SQUALL", "/nowhere/squall")
    environment = gymnasium.make(name, render_mode="rgb_array")
    check_env(environment.unwrapped)
    assert environment.metadata["render_modes"] == ["rgb_array"]


def test_it_is_said_why_the_program_shows_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, browser: list[str]
) -> None:
    broken = tmp_path / "broken"
    broken.write_text("#!/bin/sh\necho the file is damaged\n")
    broken.chmod(0o755)
    monkeypatch.setenv("SQUALL", str(broken))
    environment = squall.TeamEnv(**SHORT)
    environment.reset()
    environment.step([0, 0])
    with pytest.raises(RuntimeError, match=r"broken replay .*\.mcap --listen 127.0.0.1:0: the file is damaged"):
        environment.close()
    assert browser == []


def test_the_program_serves_the_page(program: str, browser: list[str]) -> None:
    environment = squall.TeamEnv(**SHORT)
    for _ in range(2):
        environment.reset()
        environment.step([0, 0])
        environment.step([0, 0])
        with urllib.request.urlopen(browser[0], timeout=10) as answer:
            assert answer.status == 200 and b"<html" in answer.read().lower()
    assert len(browser) == 1
