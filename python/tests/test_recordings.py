"""Recordings: complete files of the games played, however the environment ends."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import squall

MAGIC = b"\x89MCAP0\r\n"
SHORT = {"game": "surveyor_2v2", "episode_max_s": 5.0, "seed": 1}


def files(folder: Path) -> list[Path]:
    """The recordings in a folder by seed; each is a complete MCAP file, and there are no other files."""
    found = sorted(folder.iterdir(), key=seed_of)
    for file in found:
        content = file.read_bytes()
        assert content.startswith(MAGIC) and content.endswith(MAGIC), file
    return found


def seed_of(file: Path) -> int:
    return int(file.stem.split("_")[-1])


def play(environment: squall.TeamEnv, steps: int) -> None:
    for step in range(steps):
        environment.step(np.array([3 * step % 17, 5 * step % 17]))


def checked(program: str, file: Path) -> str:
    """The output of `squall replay --check`."""
    done = subprocess.run(
        [program, "replay", str(file), "--check"], check=False, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_every_game_is_recorded_under_its_name_and_seed(tmp_path: Path) -> None:
    environment = squall.TeamEnv(record=tmp_path / "runs" / "here", **SHORT)
    environment.reset(seed=70)
    play(environment, 10)
    _, info = environment.reset()
    play(environment, 2)
    environment.reset(seed=90)
    environment.reset(seed=80)
    play(environment, 3)
    environment.close()
    found = files(tmp_path / "runs" / "here")
    seeds = (70, 80, info["seed"])
    assert [file.name.split("_", 1)[1] for file in found] == [f"surveyor_2v2_{seed}.mcap" for seed in seeds]
    results = [b"digest" in file.read_bytes() for file in found]
    assert results == [True, False, False], "an abandoned game has no result"


def test_the_program_plays_recorded_games_again_to_the_last_bit(tmp_path: Path, program: str) -> None:
    environment = squall.TeamEnv(record=tmp_path, **SHORT)
    environment.reset()
    play(environment, 10)
    environment.reset()
    play(environment, 2)
    environment.close()
    whole, cut = files(tmp_path)
    assert "identical: 51 frames to 5.0 s, digest " in checked(program, whole)
    assert "identical: 11 frames to 1.0 s" in checked(program, cut)


@pytest.mark.parametrize(
    "options",
    [
        {"opponents": "policy", "game": "pyquaticus_2v2", "observation": "pyquaticus"},
        {"starts": 2, "control": "teleop"},
        {"action": "options", "control": "options", "game": "strategy_4_vs_3"},
    ],
)
def test_games_side_by_side_are_recorded_on_any_thread(tmp_path: Path, program: str, options: dict) -> None:
    environment = squall.VectorEnv(3, threads=2, record=tmp_path, **{**SHORT, "episode_max_s": 3.0, **options})
    environment.reset()
    for step in range(9):
        environment.step(np.arange(environment.num_envs) % 3 + step % 5)
    environment.close()
    found = files(tmp_path)
    assert len(found) == 6, "for each of three slots, one game that ended and one that had started"
    said = [checked(program, file) for file in found]
    assert sum("identical: 31 frames" in text and "digest" in text for text in said) == 3
    assert sum("identical: 16 frames" in text for text in said) == 3


def test_each_nth_game_is_recorded(tmp_path: Path) -> None:
    environment = squall.VectorEnv(3, record=tmp_path, record_every=3, row="team", **{**SHORT, "episode_max_s": 1.0})
    environment.reset()
    for _ in range(5):
        environment.step(np.zeros((3, 2), dtype=int))
    environment.close()
    assert [seed_of(file) for file in files(tmp_path)] == [1, 4, 7], "the first of three slots"


def test_games_of_agents_are_recorded(tmp_path: Path) -> None:
    pytest.importorskip("pettingzoo")
    environment = squall.parallel_env(record=tmp_path, **SHORT)
    environment.reset()
    while environment.agents:
        environment.step(dict.fromkeys(environment.agents, 3))
    environment.close()
    assert [seed_of(file) for file in files(tmp_path)] == [1]


def test_a_recorded_game_is_the_same_game(tmp_path: Path) -> None:
    environments = [squall.TeamEnv(**SHORT), squall.TeamEnv(record=tmp_path, **SHORT)]
    for environment in environments:
        environment.reset()
        play(environment, 9)
    assert environments[0].native.digest(0) == environments[1].native.digest(0)


HELD = """import threading
threading.Thread(target=lambda _: threading.Event().wait(), args=(environment,), daemon=True).start()"""


@pytest.mark.parametrize("end", ["", "del environment", "raise SystemExit", HELD])
def test_nobody_has_to_close_an_environment(tmp_path: Path, end: str) -> None:
    script = f"""import squall
environment = squall.TeamEnv(record={str(tmp_path)!r}, seed=4)
environment.reset()
environment.step([0, 0])
{end}"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)
    assert [seed_of(file) for file in files(tmp_path)] == [4]


def test_a_folder_that_takes_no_files_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()
    for folder in (file, file / "below"):
        with pytest.raises(ValueError, match=f'record is "{folder}", expected a folder for recordings: .*'):
            squall.BoatEnv(record=folder)
    with pytest.raises(ValueError, match="record_every is 0, expected an integer from 1"):
        squall.BoatEnv(record=tmp_path, record_every=0)


def test_games_go_on_where_they_cannot_be_recorded_any_more(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    environment = squall.TeamEnv(record=folder, **SHORT)
    folder.rmdir()
    environment.reset()
    with pytest.warns(RuntimeWarning, match="cannot record the game with seed 1 in .*runs: .*No such file"):
        play(environment, 1)
    play(environment, 9)
    environment.close()
