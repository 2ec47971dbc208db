"""The recordings of an environment: always complete files, shown on the page if rendered for people."""

from __future__ import annotations

import weakref
from pathlib import Path

from squall import _native
from squall.page import PAGE, is_installed, program


def folder_to_show(render_mode: str | None) -> Path | None:
    """The folder for recordings to show to people, if the options name none; None if nothing is shown.

    Raises `gymnasium.error.DependencyNotInstalled` if they cannot be shown.
    """
    if render_mode != "human":
        return None
    program()
    return PAGE.folder()


def available_modes(modes: list[str]) -> list[str]:
    """The render modes without "human" if the program that it needs is not installed."""
    return [mode for mode in modes if mode != "human" or is_installed()]


class Recordings:
    """The recordings of an environment."""

    def __init__(self, owner: object, native: _native.VectorEnvironment, render_mode: str | None = None) -> None:
        """Manages the recordings of `owner`, an environment that may never be closed."""
        self._is_shown = render_mode == "human"
        self._native = native
        # An environment that is garbage-collected, or an interpreter that ends, must not leave an incomplete file.
        weakref.finalize(owner, native.end_recordings)

    def show(self) -> None:
        """Shows the newest recording, unless it has been shown or nothing is shown."""
        if self._is_shown and (newest := self._native.take_recording()) is not None:
            PAGE.show(newest)

    def end(self) -> None:
        """Completes all recordings and stops recording."""
        self._native.end_recordings()
        self.show()
