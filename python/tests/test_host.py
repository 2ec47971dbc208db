"""Competition entries as teams: `squall run --blue host:FOLDER`, and `python -m squall.host`.

The recorded observations are those of Pyquaticus' own environment for the competition of 2026."""

import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squall import convert, host

RECORDED = Path(__file__).parents[2] / "agent" / "tests" / "helm" / "pyquaticus" / "2026_3v3.json"
TOLERANCE = 3e-6
"""Tolerance of numbers from -1 to 1, which are passed with 24 bits."""

HEAD = "class solution:\n    def compute_action(self, agent_id, full_obs_normalized, full_obs, global_state):\n"


def entry_of(folder: Path, text: str, **more: str) -> Path:
    """Writes an entry."""
    folder.mkdir(parents=True)
    (folder / "solution.py").write_text(text)
    for name, content in more.items():
        (folder / f"{name}.py").write_text(content)
    return folder


def asked(folder: Path, boat: int = 0, team: int = 0, **game: Any) -> Any:
    """An entry's answer to one request, in a separate process."""
    first = {**host.GAME, "team": team, **game}
    request = {"number": 1, "boat": boat, "at_m": [50.0, 40.0], "heading_deg": 90.0, "observation": [0.5] * 67}
    lines = "".join(json.dumps(line) + "\n" for line in (first, request))
    command = [sys.executable, "-c", Path(host.__file__).read_text(), "--serve", str(folder)]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd="/")
    assert child.stdin is not None and child.stdout is not None
    child.stdin.write(lines)
    child.stdin.flush()
    answers = [json.loads(child.stdout.readline())]
    if "error" not in answers[0]:
        answers.append(json.loads(child.stdout.readline()))
    child.stdin.close()
    assert child.wait(10) is not None
    return answers[-1].get("action", answers[-1].get("error"))


def worlds() -> list[tuple[host.World, list[Any], int]]:
    """The recorded games as each boat knows them, with all boats."""
    found = []
    for state in json.loads(RECORDED.read_text())["states"]:
        for i, boat in enumerate(state["boats"]):
            request = {"boat": i % 3, "at_m": [boat["x"], boat["y"]], "heading_deg": boat["heading_deg"]}
            request["observation"] = boat["observation"]
            found.append((host.World({**host.GAME, "team": i // 3}, request), state["boats"], i))
    return found


def test_each_boat_s_observation_is_that_of_pyquaticus_for_every_other_boat() -> None:
    for world, boats, me in worlds():
        for i, boat in enumerate(boats):
            want = np.array(boat["observation"])
            got = world.normalised(i)
            if i == me:
                assert (got == want.astype(np.float32)).all()
                world.me = -1
                got = world.normalised(i)
                world.me = me
            off = np.abs(got - want)
            assert np.minimum(off, 2.0 - off).max() < TOLERANCE, (me, i)


def test_the_global_state_places_every_boat() -> None:
    for world, boats, _ in worlds():
        state = world.state()
        for i, boat in enumerate(boats):
            name = f"agent_{i}"
            assert np.hypot(*(state[name, "pos"] - [boat["x"], boat["y"]])) < 1e-3
            assert abs((state[name, "heading"] - boat["heading_deg"] + 180.0) % 360.0 - 180.0) < 1e-2
            for key, of in [("has_flag", "has_flag"), ("is_tagged", "tagged"), ("is_disabled", "disabled")]:
                assert state[name, key] == bool(boat[of])
            assert abs(state[name, "tagging_cooldown"] - boat["since_tag_s"]) < 1e-4
        carries = [any(boat["has_flag"] for boat in boats[3 * team : 3 * team + 3]) for team in (0, 1)]
        assert [state["red_flag_pickup"], state["blue_flag_pickup"]] == carries


@pytest.mark.parametrize(
    ("answer", "want"),
    [
        ("7", 7),
        ("-1", 16),
        ("np.int64(3)", 3),
        ("np.array([4])", 4),
        ("[1.5, -30]", [1.5, -30.0]),
        ("np.array([3.0, 180.0], np.float32)", [3.0, 180.0]),
        ("(2, 270)", [2.0, -90.0]),
        ("'CHX'", [3.0, 0.0]),
        ("17", "ValueError: the action is 17, expected one of 17"),
        ("None", "ValueError: the action is None"),
        ("[float('nan'), 1]", "which is not finite"),
        ("'XYZ'", "not a point of the field"),
        ("{}['x']", "solution.py:4: KeyError"),
    ],
)
def test_answers_become_orders(tmp_path: Path, answer: str, want: Any) -> None:
    folder = entry_of(tmp_path / "entry", f"import numpy as np\n{HEAD}        return {answer}\n")
    got = asked(folder)
    assert want in got if isinstance(want, str) else got == want, got


def test_each_year_s_arguments_are_given(tmp_path: Path) -> None:
    checks = {
        2024: "def compute_action(self, agent_id: int, observation_normalized: list, observation: dict):\n"
        "        assert agent_id == 4 and observation_normalized.shape == (61,), observation_normalized.shape\n"
        "        return int(observation[('teammate_0', 'distance')] > 100 and 'wall_0_bearing' in observation)\n",
        2025: "def compute_action(self, agent_id, normalized, obs, state):\n"
        "        assert agent_id == 'agent_4' and normalized[agent_id].shape == (61,) and len(obs) == 6\n"
        "        return int(('agent_0', 'pos') in state and ('agent_0', 'is_disabled') not in state)\n",
        2026: "def compute_action(self, agent_id, normalized, obs, state, info):\n"
        "        assert normalized[agent_id].dtype == 'float32' and len(normalized[agent_id]) == 67\n"
        "        return int(info['agent_1']['global_state'] is state and obs[agent_id]['is_disabled'])\n",
    }
    for year, text in checks.items():
        folder = entry_of(tmp_path / str(year), f"class solution:\n    {text}")
        assert asked(folder, boat=1, team=1, has_disabled=year == 2026) == 1, year


def test_an_entry_sees_its_own_folder_its_history_and_a_seeded_numpy(tmp_path: Path) -> None:
    text = "import os, random, numpy as np, helper\nopen('weights.txt').read()\nclass solution:\n"
    text += "    def compute_action(self, agent_id, normalized, obs, state):\n"
    text += "        print('x' * 100000, flush=True); os.system('echo noise')\n"
    text += "        assert normalized[agent_id].shape == (3, 67) and obs[agent_id][2]['speed'] == 2.25\n"
    text += "        return [random.random(), np.random.random()]\n"
    config = (
        "config_dict_competition = {'short_obs_hist_length': 2, 'long_obs_hist_length': 2, 'long_obs_hist_interval': 4}"
    )
    folder = entry_of(tmp_path / "entry", text, helper="", gen_config=config)
    (folder / "weights.txt").write_text("1")
    first, again, other = asked(folder), asked(folder / "solution.py"), asked(folder, seed=2)
    assert first == again != other and 0.0 < first[0] < 1.0
    assert not (folder / "__pycache__").exists() or sys.dont_write_bytecode is False


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("import nothing_of_this_name", "solution.py:1: ModuleNotFoundError"),
        ("class other: pass", "has no attribute 'solution'"),
        ("class solution:\n    def compute_action(self, obs): pass", "compute_action takes 1 arguments"),
        ("class solution:\n    def __init__(self): raise SystemExit(3)", "solution.py:2: SystemExit"),
    ],
)
def test_an_entry_that_cannot_be_loaded_says_why(
    tmp_path: Path, text: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = entry_of(tmp_path / "entry", text)
    assert told in asked(folder)
    assert told in check(folder, 1)


def check(folder: Path, code: int) -> str:
    """The output of `python -m squall.host`."""
    shown = subprocess.run(
        [sys.executable, "-m", "squall.host", str(folder)], capture_output=True, text=True, check=False
    )
    assert shown.returncode == code, shown.stderr
    return shown.stdout + shown.stderr


def test_a_check_shows_the_actions_and_how_to_play(tmp_path: Path) -> None:
    folder = entry_of(tmp_path / "entry", HEAD + "        return int(agent_id[-1])\n")
    told = check(folder, 0)
    assert "compute_action takes 4 arguments" in told and "boat 2: 2 after" in told
    assert f"squall run mctf_2026 --blue host:{folder}" in told
    assert "there is no" in check(tmp_path / "nowhere", 1)
    old = entry_of(tmp_path / "old", HEAD + "        return int(len(full_obs_normalized[agent_id]) == 61) or None\n")
    assert f"squall run mctf_2025 --blue host:{old}" in check(old, 0)


def test_an_entry_ends_with_its_host_even_if_it_is_busy_and_has_children(tmp_path: Path) -> None:
    marks = tmp_path / "marks"
    text = "import os, subprocess, sys\nclass solution:\n    def __init__(self):\n"
    text += "        child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
    text += f"        open({str(marks)!r}, 'w').write(str(child.pid))\n        while True: pass\n"
    folder = entry_of(tmp_path / "entry", text)
    command = [sys.executable, "-m", "squall.host", str(folder), "--serve"]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert child.stdin is not None
    child.stdin.write(json.dumps(host.GAME) + "\n")
    child.stdin.flush()
    until(lambda: marks.exists() and marks.read_text().isdigit())
    child.stdin.close()
    assert child.wait(20) is not None
    until(lambda: not is_running(int(marks.read_text())))


def is_running(pid: int) -> bool:
    """Whether a process is running; a zombie is not."""
    state = subprocess.run(["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True, check=False).stdout
    return state.strip()[:1] not in ("", "Z")


def until(condition: Any, limit_s: float = 20.0) -> None:
    """Waits for a condition."""
    end = time.monotonic() + limit_s
    while not condition():
        assert time.monotonic() < end, "too late"
        time.sleep(0.01)


# Games of the program.


def played(program: str, folder: Path, *words: str) -> dict[str, Any]:
    """The result of a game of 2026 in this folder."""
    result = folder / "result.json"
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    command = [program, "run", "mctf_2026", "--seed", "5", "--no-record", "--json", str(result), *words]
    shown = subprocess.run(
        command, capture_output=True, text=True, cwd=folder, env={**os.environ, "PATH": path}, check=False
    )
    assert shown.returncode == 0, shown.stderr
    return {**json.loads(result.read_text()), "shown": shown.stdout + shown.stderr}


TABLE = [[1.0, 2.5 * i - 19.5] for i in range(16)] + [[0.3, 180.0]]


@pytest.mark.parametrize(
    ("way", "actions"),
    [(["--in-process"], "pyquaticus"), ([], "pyquaticus"), (["--in-process"], TABLE)],
    ids=["in_process", "processes", "table"],
)
def test_an_exported_policy_plays_the_same_game_as_its_strategy(
    program: str, tmp_path: Path, way: list[str], actions: Any
) -> None:
    pytest.importorskip("onnx")
    random = np.random.default_rng(3)
    layers = []
    for inputs, outputs, scale in [(67, 32, 0.6), (32, 17, 1.5)]:
        weight = (random.normal(size=(outputs, inputs)) * scale).astype(np.float32)
        layers.append(convert.Layer("", weight, random.normal(size=outputs).astype(np.float32)))
    metadata = {
        "squall.observation": '{"kind":"pyquaticus_2026"}',
        "squall.action": actions if isinstance(actions, str) else json.dumps(actions),
        "squall.period_s": "1",
    }
    policy = convert.Policy("", layers, [], "tanh", None)
    (tmp_path / "policy.onnx").write_bytes(convert.onnx_of(policy, metadata))
    text = 'base = "scenarios/strategies/policy.toml"\n[behaviour.learned]\nmodel = "policy.onnx"\ndirect = true\n'
    text += f"action = {json.dumps(actions)}\n"
    (tmp_path / "mine.toml").write_text(text)
    subprocess.run([program, "policy", "policy.onnx", "--submission", "entry"], cwd=tmp_path, check=True)
    games = []
    for team in ("./mine.toml", "host:entry"):
        games.append(played(program, tmp_path, "--blue", team, "--red", team, *way))
    assert games[0]["digest"] == games[1]["digest"], "the same game, byte for byte"
    assert "entry_faults" not in games[1]["run"]
    other = played(program, tmp_path, "--blue", "idle", "--red", "idle", *way)
    assert other["digest"] != games[0]["digest"], "it moves"


@pytest.mark.parametrize("way", [["--in-process"], []], ids=["in_process", "processes"])
@pytest.mark.parametrize(
    ("text", "told", "count"),
    [
        (HEAD + "        import time; time.sleep(1000)\n", "no answer within 100ms", 600),
        (HEAD + "        while True: print('more')\n", "no answer within 100ms", 600),
        (HEAD + "        import os; os._exit(1)\n", "its process has ended", 600),
        (HEAD + "        return 'nonsense'\n", "the action 'nonsense' is not a point of the field", 600),
        (HEAD + "        return 17 if agent_id == 'agent_1' else 0\n", "expected one of 17", 600),
        (HEAD + "        import os; os.write(4, b'{' * 70000); os.write(4, b'\\n'); return 0\n", "", 0),
        ("import nothing_of_this_name", "cannot be loaded: solution.py:1: ModuleNotFoundError", 600),
    ],
    ids=["sleeps", "prints", "crashes", "nonsense", "one_boat", "pipe", "import"],
)
def test_a_bad_entry_costs_only_its_own_team(
    program: str, tmp_path: Path, way: list[str], text: str, told: str, count: int
) -> None:
    entry_of(tmp_path / "entry", text)
    strategy = (
        'base = "scenarios/strategies/policy.toml"\n[behaviour.learned]\nhost = "entry"\nlimit_s = 0.1\ndirect = true\n'
    )
    (tmp_path / "bad.toml").write_text(strategy)
    game = played(program, tmp_path, "--blue", "./bad.toml", "--red", "easy_attackers", *way)
    assert game["duration_s"] == 600
    assert game["counts"]["teams"]["red"]["captures"] > 0, "the other team plays"
    faults = game["run"].get("entry_faults", [])
    if told == "":
        return
    boats = ["blue_2"] if "agent_1" in text else ["blue_1", "blue_2", "blue_3"]
    assert [fault["boat"] for fault in faults] == boats
    for fault in faults:
        # The decision at the end of the game has no orders.
        assert told in fault["first"] or "in a row" in fault["first"] or "has ended" in fault["first"]
        assert count - 2 <= fault["count"] <= count + 1, fault
    assert told in faults[0]["first"] and game["shown"].count(faults[0]["first"]) <= 2 * len(boats)


@pytest.mark.parametrize("is_named", [False, True])
def test_an_agent_runs_no_entry_that_only_a_sim_names(program: str, tmp_path: Path, is_named: bool) -> None:
    made = tmp_path / "made"
    entry = entry_of(tmp_path / "entry", f"open({str(made)!r}, 'w')\n{HEAD}        return 0\n")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        place = f"tcp/127.0.0.1:{free.getsockname()[1]}"
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    options: dict[str, Any] = {"cwd": tmp_path, "env": {**os.environ, "PATH": path, "SQUALL_TOKEN": "0" * 64}}
    begin = [program, "sim", "attack_1v1", "--blue", "host:entry", "--listen", place, "--set", "game.duration_s=5"]
    with subprocess.Popen(begin, stdout=subprocess.DEVNULL, **options):
        agent = [program, "agent", "--connect", place, "--vehicle", "blue_one", "red_one"]
        agent += ["--host", "python3", str(entry)] if is_named else ["--host", "python3", str(tmp_path / "other")]
        shown = subprocess.run(agent, capture_output=True, text=True, timeout=120, check=False, **options)
    assert ("this process may not run it" in shown.stderr) != is_named, shown.stderr
    assert made.exists() == is_named


def test_a_missing_entry_is_refused(program: str, tmp_path: Path) -> None:
    told = subprocess.run(
        [program, "run", "mctf_2026", "--blue", "host:nowhere"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert told.returncode == 2 and "no solution.py in nowhere" in told.stderr
