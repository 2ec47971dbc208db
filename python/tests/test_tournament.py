"""Tournaments: the same tables as the program's, wherever the games are played."""

import json
import subprocess
from pathlib import Path

import pytest

from squall._native import TournamentPlan
from squall.scenario import SCENARIOS
from squall.tournament import main

TOURNAMENT = """
game = "{folder}/short.toml"
games = 4
entry = [
    {{ name = "four", strategy = "{scenarios}/strategies/strategy_4.toml" }},
    {{ name = "two", strategy = "{scenarios}/strategies/strategy_2.toml" }},
    {{ name = "idle", strategy = "{scenarios}/strategies/idle.toml" }},
]
"""
SHORT = """
base = "{scenarios}/games/surveyor_2v2.toml"
duration_s = 20
"""


@pytest.fixture
def tournament(tmp_path: Path) -> Path:
    """The file of a tournament of 12 short games."""
    for name, text in (("tiny.toml", TOURNAMENT), ("short.toml", SHORT)):
        (tmp_path / name).write_text(text.format(folder=tmp_path, scenarios=SCENARIOS))
    return tmp_path / "tiny.toml"


def by_program(program: str, tournament: Path, folder: Path) -> tuple[str, dict[str, object], str]:
    """The program's output, its JSON file and its CSV file."""
    words = ["tournament", tournament, "--json", folder / "there.json", "--csv", folder / "there.csv"]
    done = subprocess.run([program, *words], check=True, capture_output=True, text=True, timeout=120)
    return done.stdout, json.loads((folder / "there.json").read_text()), (folder / "there.csv").read_text()


def same(one: dict[str, object], other: dict[str, object]) -> None:
    """Compares the games of both reports, regardless of what played them and how fast."""
    for report in (one, other):
        del report["rate"], report["commit"]
    assert one == other
    assert len(one["matches"]) == 12  # type: ignore[arg-type]


def test_the_program_has_the_same_tables(tournament: Path, tmp_path: Path, program: str) -> None:
    plan = TournamentPlan.open(tournament)
    there = TournamentPlan.unpack(plan.pack())
    assert (plan.games, there.games, there.digest) == (12, 12, plan.digest)
    records = [*plan.records(0, 5), *there.records(5, 12, threads=2)]
    text, written, csv, failures = plan.report(records)
    wanted = by_program(program, tournament, tmp_path)
    assert (text, csv, failures) == (wanted[0], wanted[2], 0)
    same(json.loads(written), wanted[1])


def test_what_is_wrong_is_told(tournament: Path) -> None:
    plan = TournamentPlan.open(tournament, games=3, seed=7)
    assert (plan.name, plan.games) == ("tiny", 12)
    records = plan.records(0, 2)
    for wrong in (records[1:], [*records, *records]):
        with pytest.raises(IndexError, match="in order"):
            plan.report(wrong)
    with pytest.raises(ValueError, match="a record cannot be read"):
        plan.report(["{}"])
    with pytest.raises(IndexError, match="expected from 0 to 12"):
        plan.records(0, 13)
    text, files, _ = plan.pack()
    with pytest.raises(ValueError, match="same version of Squall"):
        TournamentPlan.unpack((text, files, "0" * 32))


@pytest.mark.cluster
def test_a_cluster_has_the_same_tables(tournament: Path, tmp_path: Path, program: str, capsys: pytest.CaptureFixture[str]) -> None:
    ray = pytest.importorskip("ray")
    here = tmp_path / "here.json"
    try:
        assert main([str(tournament), "--address", "local", "--batch", "2", "--json", str(here)]) == 0
    finally:
        ray.shutdown()
    wanted = by_program(program, tournament, tmp_path)
    assert capsys.readouterr().out == wanted[0]
    same(json.loads(here.read_text()), wanted[1])
