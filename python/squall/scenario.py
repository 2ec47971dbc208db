"""The scenario files in the package: games, strategies and rewards, selected by name."""

from __future__ import annotations

import os
from pathlib import Path

SCENARIOS = Path(__file__).parent / "scenarios"
"""The folder of the scenario files in the package; its README.md explains them."""


def path_of(kind: str, name: str | os.PathLike[str]) -> str:
    """The path of a scenario file.

    `name` is a path that ends with `.toml`, or the name of a file in the package. `kind` is its folder: "games", "strategies" or
    "rewards". Raises ValueError if the package has no such file.
    """
    text = os.fspath(name)
    if text.endswith(".toml"):
        return text
    path = SCENARIOS / kind / f"{text}.toml"
    if not path.is_file():
        known = ", ".join(sorted(file.stem for file in (SCENARIOS / kind).glob("*.toml")))
        raise ValueError(f"{kind} has no {text!r}: expected a path that ends with .toml, or one of {known}")
    return str(path)
