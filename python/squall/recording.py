"""The recordings of an environment: whole files whenever it ends, on the page where it is rendered for people."""

from __future__ import annotations

import weakref
from pathlib import Path

from squall import _native
from squall.page import PAGE, program


def folder_to_show(render_mode: str | None) -> Path | None:
    """Where games that people are to see are recorded, if the options say nothing; None where nobody is to see any.

    Raises `gymnasium.error.DependencyNotInstalled` where they cannot be shown.
    """
    if render_mode != "human":
        return None
    program()
    return PAGE.folder()


class Recordings:
    """The recordings of an environment."""

    def __init__(self, owner: object, native: _native.VectorEnvironment, render_mode: str | None = None) -> None:
        """Of the games of an environment, which may forget to close itself."""
        self._is_shown = render_mode == "human"
        self._native = native
        # Neither an environment that is collected nor an interpreter that ends leaves half a file.
        weakref.finalize(owner, native.end_recordings)

    def show(self) -> None:
        """Shows the newest, where somebody is to see it and it has not been shown."""
        if self._is_shown and (newest := self._native.take_recording()) is not None:
            PAGE.show(newest)

    def end(self) -> None:
        """Completes all of them; nothing is recorded from now on."""
        self._native.end_recordings()
        self.show()
