#!/usr/bin/env python3
"""Checks output as seen in a terminal: `tests/terminal.py PATH/OF/squall`.

Help and lists fit 80 and 120 columns, progress lines fit 40 columns and are cleared, and the shells that are installed
complete commands and names. Exits with 1 if a check fails.
"""

import fcntl
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
from pathlib import Path


def shown(command, columns, folder, keys=b"", wait_s=60, until=None):
    """The bytes that a command writes to a terminal of this width until it ends or prints a given string."""
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(folder)
        os.execvp(command[0], command)
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
    output, end = b"", time.monotonic() + wait_s
    if keys:
        time.sleep(1.5)
        os.write(terminal, keys)
    os.set_blocking(terminal, False)
    while time.monotonic() < end and (until is None or until not in output):
        try:
            output += os.read(terminal, 65536)
        except BlockingIOError:
            time.sleep(0.05)
        except OSError:
            break
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    os.close(terminal)
    return output.decode(errors="replace")


def lines(text):
    """The final lines on the screen, and all states of each line."""
    text = re.sub(r"\x1b\[[\d;]*m", "", text).replace("\r\n", "\n")
    states = [re.split(r"\r\x1b\[K|\r", line) for line in text.split("\n")]
    return [state[-1] for state in states], [one for state in states for one in state]


def check_widths(folder, errors):
    names = re.findall(r"^  ([a-z]+)  ", subprocess.run(["squall", "help"], capture_output=True, text=True).stdout, re.M)
    commands = [["squall"], ["squall", "help"], ["squall", "files"], ["squall", "files", "game"], ["squall", "runs"]]
    commands += [["squall", name, "--help"] for name in names]
    for columns in (80, 120):
        for command in commands:
            for line in lines(shown(command, columns, folder))[0]:
                # An example stays on one line, so that it can be copied.
                if len(line) > min(columns, 100 if "--help" in command else columns) and "  squall " not in line:
                    errors.append(f"{' '.join(command)} at {columns} columns: {line}")


def check_progress(folder, errors):
    final, states = lines(shown(["squall", "run", "strategy_4_vs_3", "--in-process", "--no-record"], 40, folder))
    progress = [state for state in states if "[=" in state]
    if not progress:
        errors.append("a game in the terminal shows no progress line")
    errors += [f"a progress line of {len(line)} columns of 40: {line}" for line in progress if len(line) >= 40]
    errors += [f"a progress line stays on the screen: {line}" for line in final if "[=" in line]


# How each shell reads its completion script, and the key that shows candidates.
SHELLS = {
    "bash": (["bash", "--norc", "-i"], "source <(squall completions bash)"),
    "zsh": (["zsh", "-f", "-i"], "autoload -U compinit && compinit -D && source <(squall completions zsh)"),
    "fish": (["fish", "--no-config", "-i"], "squall completions fish | source"),
}
# The typed text, and a candidate that only the right kind of name has.
COMPLETED = {
    "squall tourn": "tournament",
    "squall run strategy_4_v": "strategy_4_vs_3",
    "squall run surveyor_2v2 --sea bay_f": "bay_fresh_breeze",
    "squall run surveyor_2v2 --blue min": "mine",
    "squall strategy strategy_4_a": "strategy_4_assigned",
}


def check_completions(folder, errors):
    os.environ.update(HOME=folder, PS1="$ ", TERM="xterm")
    for shell, (command, script) in SHELLS.items():
        if not shutil.which(shell):
            print(f"SKIPPED: {shell} is not installed")
            continue
        for typed, want in COMPLETED.items():
            keys = f"{script}\n{typed}\t\t".encode()
            if want.encode() not in (said := shown(command, 120, folder, keys, 15, want.encode()).encode()):
                errors.append(f"{shell} does not complete {typed} to {want}: {said[-400:]!r}")


def main():
    program, errors = Path(sys.argv[1]).resolve(), []
    with tempfile.TemporaryDirectory() as folder:
        os.mkdir(f"{folder}/bin")
        os.symlink(program, f"{folder}/bin/squall")
        os.environ["PATH"] = f"{folder}/bin:{os.environ['PATH']}"
        for command in ("new strategy mine", "new sea gale", "run attack_1v1 --in-process"):
            subprocess.run(["squall", *command.split()], cwd=folder, capture_output=True, check=True)
        check_widths(folder, errors)
        check_progress(folder, errors)
        check_completions(folder, errors)
    print("\n".join(errors) or "the terminal: ok")
    sys.exit(bool(errors))


if __name__ == "__main__":
    main()
