"""Where scenario files are: games, strategies and rewards come with the package, and are called by their names."""

from __future__ import annotations

import os
from pathlib import Path

SCENARIOS = Path(__file__).parent / "scenarios"
"""The folder of the scenario files that come with the package; its README.md explains them."""


def path_of(kind: str, name: str | os.PathLike[str]) -> str:
    """The path of a scenario file.

    `name` is a path, which ends with `.toml`, or the name of a file that comes with the package. `kind` is its folder: "games",
    "strategies" or "rewards". Raises ValueError where the package has no such file.
    """
    text = os.fspath(name)
    if text.endswith(".toml"):
        return text
    path = SCENARIOS / kind / f"{text}.toml"
    if not path.is_file():
        known = ", ".join(sorted(file.stem for file in (SCENARIOS / kind).glob("*.toml")))
        raise ValueError(f"{kind} has no {text!r}: expected a path that ends with .toml, or one of {known}")
    return str(path)
