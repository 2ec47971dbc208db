"""The page that shows recorded games in a browser, served by the program `squall`."""

from __future__ import annotations

import atexit
import os
import queue
import select
import shutil
import subprocess
import sys
import tempfile
import threading
import webbrowser
from pathlib import Path

import gymnasium

_START_MAX_S = 30.0
"""Timeout for opening a recording, s."""


def program() -> str:
    """The program `squall`: the one named by the environment variable SQUALL, or the one on PATH.

    Raises `gymnasium.error.DependencyNotInstalled` if there is none.
    """
    named = os.environ.get("SQUALL")
    found = _found()
    if found is None:
        where = "on PATH" if named is None else f"at {named!r}, the path in the environment variable SQUALL"
        raise gymnasium.error.DependencyNotInstalled(
            f'render_mode "human" needs the program squall, which is not {where}: build it in a clone of the repository with'
            " `cargo build --release`, and put target/release on PATH or the program's path into SQUALL"
        )
    return found


def is_installed() -> bool:
    """Whether the program `squall` can be found."""
    return _found() is not None


def _found() -> str | None:
    return shutil.which(os.environ.get("SQUALL") or "squall")


class Page:
    """A page that shows the newest recording until the interpreter ends.

    In a terminal, it waits at the end until the user presses Enter.
    """

    def __init__(self) -> None:
        self._server: subprocess.Popen[str] | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self.url: str | None = None

    def folder(self) -> Path:
        """A temporary folder for recordings that are shown but not kept; removed when the interpreter ends."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="squall-")
            atexit.register(self._end_at_exit)
        return Path(self._folder.name)

    def show(self, recording: Path) -> None:
        """Shows a recording. A browser that shows the previous one moves to it automatically.

        Raises RuntimeError if the program cannot show it.
        """
        self.end()
        self.folder()
        listen = "127.0.0.1:0" if self.url is None else self.url.removeprefix("http://").rstrip("/")
        url = self._serve(recording, listen)
        print(f"{recording.name} at {url}", file=sys.stderr)
        if url != self.url:
            self.url = url
            webbrowser.open(url)

    def end(self) -> None:
        """Stops showing recordings."""
        if self._server is not None:
            self._server.terminate()
            self._server.wait()
            self._server = None

    def _serve(self, recording: Path, listen: str) -> str:
        command = [program(), "replay", str(recording), "--listen", listen]
        server = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self._server, self._lines = server, queue.SimpleQueue()
        threading.Thread(target=_read, args=(server, self._lines), daemon=True).start()
        said = []
        try:
            while (line := self._lines.get(timeout=_START_MAX_S)) is not None:
                said.append(line.strip())
                # "FILE at http://127.0.0.1:8088/ (Ctrl-C to stop)"
                _, is_told, address = line.rpartition(" at http://")
                if is_told:
                    return f"http://{address.split()[0]}"
        except queue.Empty:
            said.append(f"no answer in {_START_MAX_S:.0f} s")
        self.end()
        raise RuntimeError(f"{' '.join(command)}: {' '.join(said) or 'no answer'}")

    def _end_at_exit(self) -> None:
        if sys.stdin is not None and sys.stdin.isatty():
            self._wait_for_enter()
        self.end()
        if self._folder is not None:
            self._folder.cleanup()

    def _wait_for_enter(self) -> None:
        server = self._server
        if server is None or server.poll() is not None:
            return
        print(f"{self.url} shows the last game until Enter is pressed", file=sys.stderr)
        try:
            # Ctrl-C also ends the program that serves the page, so this never waits longer than that program runs.
            while server.poll() is None and not select.select([sys.stdin], [], [], 0.2)[0]:
                pass
        except KeyboardInterrupt:
            pass
        except OSError:
            # Windows cannot select a terminal.
            input()


def _read(server: subprocess.Popen[str], lines: queue.SimpleQueue[str | None]) -> None:
    """Reads all output of a program, so that the program never blocks; None marks its end."""
    if server.stdout is not None:
        with server.stdout as said:
            for line in said:
                lines.put(line)
    lines.put(None)


PAGE = Page()
"""The page of this interpreter."""
