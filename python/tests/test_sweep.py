"""Sweeps: the same bytes as the program's, in any order, on any machine, and after any interruption."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from squall._native import SweepPlan
from squall.scenario import SCENARIOS
from squall.cluster import InOrder, batch_of, play_all
from squall.cluster_task import play_sweep
from squall.sweep import Kept, main

SWEEP = """
about = "a tiny one"
game = "{scenarios}/games/surveyor_2v2.toml"
opponent = "{scenarios}/strategies/idle.toml"
games = 4

[[entry]]
name = "policy"
strategy = "{scenarios}/strategies/policy.toml"

[[entry]]
name = "strategy_4"
strategy = "{scenarios}/strategies/strategy_4.toml"

[[axis]]
key = "game.duration_s"
values = [10, 20]

[[axis]]
key = "sea"
values = ["{scenarios}/seas/calm.toml", "{scenarios}/seas/fresh_breeze.toml"]
"""
TABLES = ("games.csv", "boats.csv")
FILES = (*TABLES, "plan.txt", "plan.json", "report.json", "games.parquet", "sums.txt")


def write_sweep(folder: Path, scenarios: str = str(SCENARIOS)) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "tiny.toml"
    path.write_text(SWEEP.format(scenarios=scenarios))
    return path


@pytest.fixture
def sweep(tmp_path: Path) -> Path:
    """The file of a sweep of 32 short games."""
    return write_sweep(tmp_path)


@pytest.fixture
def here(sweep: Path, tmp_path: Path) -> Path:
    """A folder with the results of the sweep in this process alone."""
    plan = SweepPlan.open(sweep)
    study = plan.begin(tmp_path / "here")
    for index, (game, boats) in enumerate(plan.lines(0, plan.games)):
        study.add(index, game, boats)
    study.report()
    return tmp_path / "here"


def same(one: Path, other: Path) -> None:
    """Every file has the same bytes in both folders."""
    assert sorted(path.name for path in one.iterdir()) == sorted(FILES)
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


def run(program: str, *words: str | Path, timeout: float = 120) -> str:
    done = subprocess.run([program, "sweep", *words], check=False, capture_output=True, text=True, timeout=timeout)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_program_writes_the_same_bytes(sweep: Path, here: Path, tmp_path: Path, program: str) -> None:
    run(program, sweep, "--out", tmp_path / "there")
    same(here, tmp_path / "there")


def test_the_program_goes_on_with_what_python_began(sweep: Path, here: Path, tmp_path: Path, program: str) -> None:
    plan = SweepPlan.open(sweep)
    study = plan.begin(tmp_path / "begun")
    for index, (game, boats) in enumerate(plan.lines(0, 7)):
        study.add(index, game, boats)
    run(program, sweep, "--out", tmp_path / "begun", "--resume")
    same(here, tmp_path / "begun")


@pytest.mark.parametrize(("cut", "done"), [(0, 9), (1, 8), (100, 8)])
def test_a_study_that_was_cut_off_goes_on(sweep: Path, here: Path, tmp_path: Path, cut: int, done: int) -> None:
    plan = SweepPlan.open(sweep)
    study = plan.begin(tmp_path / "cut")
    for index, (game, boats) in enumerate(plan.lines(0, 9)):
        study.add(index, game, boats)
    table = tmp_path / "cut" / "games.csv"
    table.write_bytes(table.read_bytes()[: len(table.read_bytes()) - cut])
    again = plan.resume(tmp_path / "cut")
    assert again.done == done
    for index, (game, boats) in enumerate(plan.lines(again.done, plan.games, threads=2), again.done):
        again.add(index, game, boats)
    again.report()
    same(here, tmp_path / "cut")


def test_a_packed_plan_needs_no_files(tmp_path: Path) -> None:
    copy = tmp_path / "elsewhere"
    copy.mkdir()
    subprocess.run(["cp", "-rL", str(SCENARIOS), str(copy / "scenarios")], check=True)
    path = write_sweep(copy / "sweeps", "../scenarios")
    plan = SweepPlan.open(path)
    packed = plan.pack()
    want = plan.lines(0, 3)
    subprocess.run(["rm", "-r", str(copy)], check=True)
    there = SweepPlan.unpack(packed)
    assert there.digest == plan.digest
    assert there.lines(0, 3) == want


def test_the_digest_follows_what_files_say_and_not_where_they_lie(tmp_path: Path) -> None:
    digests = []
    for name in ("one", "other"):
        folder = tmp_path / name
        folder.mkdir()
        subprocess.run(["cp", "-rL", str(SCENARIOS), str(folder / "scenarios")], check=True)
        digests.append(SweepPlan.open(write_sweep(folder / "sweeps", "../scenarios")).digest)
    assert digests[0] == digests[1]
    # Only the last point has this sea.
    sea = tmp_path / "other" / "scenarios" / "seas" / "fresh_breeze.toml"
    sea.write_text(sea.read_text() + "\n# changed\n")
    assert SweepPlan.open(tmp_path / "other" / "sweeps" / "tiny.toml").digest != digests[0]


def test_a_plan_of_another_version_is_refused(sweep: Path) -> None:
    text, files, _ = SweepPlan.open(sweep).pack()
    with pytest.raises(ValueError, match="same version of Squall"):
        SweepPlan.unpack((text, files, "0" * 32))
    with pytest.raises(ValueError, match="not among the stored files"):
        SweepPlan.unpack((text, files[:2], "0" * 32))
    with pytest.raises(ValueError, match="cannot read the packed plan"):
        SweepPlan.unpack((text[:-1], files, "0" * 32))


def test_what_is_wrong_is_told(sweep: Path, tmp_path: Path) -> None:
    plan = SweepPlan.open(sweep, games=3, seed=7)
    assert (plan.name, plan.points, plan.games_per_point, plan.games) == ("tiny", 4, 8, 32)
    with pytest.raises(ValueError, match=r"none\.toml"):
        SweepPlan.open(tmp_path / "none.toml")
    with pytest.raises(ValueError, match="games is 1, expected 2"):
        SweepPlan.open(sweep, games=1)
    for begin, end in ((0, 33), (2, 1)):
        with pytest.raises(IndexError, match="expected from 0 to 32"):
            plan.lines(begin, end)
    with pytest.raises(ValueError, match="contains no sweep"):
        plan.resume(tmp_path)
    study = plan.begin(tmp_path / "out")
    with pytest.raises(IndexError, match="expected the next one, 0"):
        study.add(1, "1\n", "")
    with pytest.raises(ValueError, match="contains a different sweep"):
        SweepPlan.open(sweep, seed=8).resume(tmp_path / "out")


def test_ctrl_c_ends_a_long_stretch(sweep: Path) -> None:
    code = (
        # Programs started in the background ignore the signal, and so do their child processes.
        "import _thread, signal, threading; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from squall._native import SweepPlan\n"
        f"plan = SweepPlan.open({str(sweep)!r}, games=100000)\n"
        "threading.Timer(0.5, _thread.interrupt_main).start()\n"
        "try:\n    plan.lines(0, plan.games)\nexcept KeyboardInterrupt:\n    print('stopped')"
    )
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True, timeout=60)
    assert done.stdout == "stopped\n", done.stderr


def test_results_go_on_in_order() -> None:
    order: InOrder[str] = InOrder(2)
    batches = {2: ["two", "three"], 4: ["four"], 5: ["five", "six"]}
    got = [list(order.put(begin, batches[begin])) for begin in (5, 4, 2)]
    assert got == [[], [], list(enumerate(["two", "three", "four", "five", "six"], 2))]
    assert not order.waiting


@pytest.mark.parametrize(
    ("left", "cpus", "want"), [(0, 1, 1), (24, 2, 3), (1_000_000, 2, 50), (100_000_000, 32_000, 781), (100, 1000, 1)]
)
def test_batches_feed_every_cpu_and_are_no_more_than_one_driver_hands_out(left: int, cpus: int, want: int) -> None:
    assert batch_of(left, cpus) == want


@pytest.fixture
def cluster() -> Iterator[Any]:
    """A Ray cluster of three nodes with one CPU each, all on this machine."""
    ray = pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "object_store_memory": 100 << 20})
    try:
        for _ in range(2):
            cluster.add_node(num_cpus=1, object_store_memory=100 << 20)
        ray.init(address=cluster.address, log_to_driver=False)
        yield cluster
    finally:
        ray.shutdown()
        cluster.shutdown()


@pytest.mark.cluster
def test_a_cluster_that_loses_a_machine_writes_the_same_bytes(
    cluster: Any, sweep: Path, here: Path, tmp_path: Path
) -> None:
    nodes = list(cluster.worker_nodes)
    plan = SweepPlan.open(sweep)
    study = plan.begin(tmp_path / "ray")
    lost: list[int] = []

    def show(done: int, cpus: int) -> None:
        if done >= 4 and not lost:
            lost.append(done)
            cluster.remove_node(nodes[0], allow_graceful=False)

    play_all(plan, Kept(study), play_sweep, batch=2, show=show)
    study.report()
    assert lost and lost[0] < plan.games, "the machine was lost during the games"
    same(here, tmp_path / "ray")


@pytest.mark.cluster
def test_ctrl_c_leaves_a_folder_that_is_gone_on_with(
    cluster: Any, sweep: Path, here: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    words = [str(sweep), "--out", str(tmp_path / "ray"), "--batch", "1"]

    def stopped(self: object, done: int, cpus: int) -> None:
        if done >= 3:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("squall.cluster.Progress.show", stopped)
        assert main(words) == 130
    assert "use --resume to continue" in capsys.readouterr().err
    assert main(words) == 1, "the folder already has a sweep"
    assert main([*words, "--resume"]) == 0
    same(here, tmp_path / "ray")


@pytest.mark.cluster
def test_a_worker_of_another_version_ends_the_sweep_and_keeps_it(cluster: Any, sweep: Path, tmp_path: Path) -> None:
    class Other:
        """A plan as packed by a different version."""

        def __init__(self, plan: SweepPlan) -> None:
            self.games = plan.games
            self.pack: Callable[[], Any] = lambda: (*plan.pack()[:2], "0" * 32)

    plan = SweepPlan.open(sweep)
    with pytest.raises(ValueError, match="same version of Squall"):
        play_all(Other(plan), Kept(plan.begin(tmp_path / "ray")), play_sweep)
    assert plan.resume(tmp_path / "ray").done == 0
