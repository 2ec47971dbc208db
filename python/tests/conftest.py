"""Shared by several tests: the program `squall`, and a stand-in for it."""

import os
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from squall.page import PAGE

FAKE = f"""#!{sys.executable}
import sys, time
with open({{log!r}}, "a") as log:
    print(*sys.argv[1:], file=log)
listen = sys.argv[-1].replace(":0", ":8088")
print("opens a recording", flush=True)
print(f"{{{{sys.argv[2]}}}} at http://{{{{listen}}}}/ (Ctrl-C to stop)", flush=True)
time.sleep(60)
"""


@pytest.fixture
def program() -> str:
    """The program `squall`, from the environment variable SQUALL or from PATH."""
    found = shutil.which(os.environ.get("SQUALL", "squall"))
    if found is None:
        pytest.skip("the program squall is not on PATH, and SQUALL does not name it")
    return found


@dataclass
class Shown:
    """The calls of a stand-in for `squall`, and of the browser."""

    log: Path
    browser: list[str] = field(default_factory=list)

    def commands(self) -> list[str]:
        """The arguments of each call."""
        return self.log.read_text().splitlines() if self.log.exists() else []


@pytest.fixture
def browser(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """The addresses that a browser should open; none is opened. The page shows nothing before or after."""
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr(PAGE, "url", None)
    yield opened
    PAGE.end()


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, browser: list[str]) -> Shown:
    """A stand-in for `squall` that serves no page."""
    shown = Shown(tmp_path / "calls.txt", browser)
    fake = tmp_path / "squall"
    fake.write_text(FAKE.format(log=str(shown.log)))
    fake.chmod(0o755)
    monkeypatch.setenv("SQUALL", str(fake))
    return shown
