"""Machines of a test: network namespaces, the bad link between them, and the programs on them."""

import ctypes
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

from priority import run_at_once

HERE = Path(__file__).resolve().parent
# How long a program may take to end when asked to, s.
END_S = 10.0
PR_SET_PDEATHSIG = 1
LIBC = ctypes.CDLL(None)


class Unavailable(Exception):
    """Namespaces or TUN devices cannot be created here; gives the reason."""


class Program:
    """A program on a machine. Its output is kept line by line, with times of arrival."""

    def __init__(self, name, words, env, log):
        self.name = name
        self.lines = []
        self.news = threading.Condition()
        self.log = open(log, "wb", buffering=0)
        self.child = subprocess.Popen(words, env=env, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      stderr=self.log, preexec_fn=end_with_parent)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        run_at_once()
        for line in self.child.stdout:
            at_ns = time.monotonic_ns()
            self.log.write(line)
            with self.news:
                self.lines.append((at_ns, line.decode(errors="replace").rstrip("\n")))
                self.news.notify_all()

    def write(self, line):
        """Sends the program a line; returns the monotonic time just before, ns."""
        at_ns = time.monotonic_ns()
        self.child.stdin.write(line.encode() + b"\n")
        self.child.stdin.flush()
        return at_ns

    def mark(self):
        """A place in its output, after which `find` looks."""
        with self.news:
            return len(self.lines)

    def find(self, wanted, limit_s, mark=0):
        """The time and the text of the first line after `mark` for which `wanted` holds; None if none arrives in time."""
        until = time.monotonic() + limit_s
        with self.news:
            while True:
                for at_ns, line in self.lines[mark:]:
                    mark += 1
                    if wanted(line):
                        return at_ns, line
                left_s = until - time.monotonic()
                if left_s <= 0 or not self.news.wait(left_s):
                    return None

    def request(self, line, limit_s=30.0, ends=lambda _: True):
        """Sends the program a line, and returns the lines of its reply."""
        mark = self.mark()
        self.write(line)
        if self.find(ends, limit_s, mark) is None:
            raise RuntimeError(f"{self.name} does not reply to {line!r} within {limit_s:.0f} s")
        with self.news:
            return [line for _, line in self.lines[mark:]]

    def send_signal(self, number):
        if self.child.poll() is None:
            self.child.send_signal(number)

    def end(self, number=signal.SIGINT):
        """Asks it to end, and kills it if it does not; returns its exit code. Without a signal, it has already been asked."""
        if number is not None:
            # A suspended program receives nothing.
            self.send_signal(signal.SIGCONT)
            self.send_signal(number)
        try:
            self.child.stdin.close()
        except OSError:
            pass
        try:
            self.child.wait(END_S)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
        self.reader.join(END_S)
        self.log.close()
        return self.child.returncode


def end_with_parent():
    """Called in a child process, which is then killed when the test dies for any reason."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


class Machines:
    """Some machines, joined by a bad link. All of it is removed on exit."""

    def __init__(self, names, out, seed):
        self.out = out
        # Names are unique on this machine, so that concurrent tests do not interfere.
        self.namespaces = {name: f"squall-estop-{os.getpid()}-{name}" for name in names}
        self.addresses = {name: f"10.77.0.{number}" for number, name in enumerate(names, 1)}
        self.seed = seed
        self.programs = []
        self.made = []
        self.link = None

    def __enter__(self):
        try:
            for namespace in self.namespaces.values():
                run_ip("netns", "add", namespace)
                self.made.append(namespace)
                run_ip("-n", namespace, "link", "set", "lo", "up")
            hosts = [f"--host={name}={self.namespaces[name]}:{self.addresses[name]}" for name in self.namespaces]
            words = [sys.executable, str(HERE / "bad_link.py"), f"--seed={self.seed}", *hosts]
            self.link = Program("link", words, os.environ, self.out / "link.log")
            if self.link.find(lambda line: line == "ready", 10.0) is None:
                raise Unavailable((self.out / "link.log").read_text(errors="replace").strip())
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for program in reversed(self.programs):
            program.end()
        if self.link is not None:
            self.link.end(signal.SIGTERM)
        for namespace in self.made:
            subprocess.run(["ip", "netns", "del", namespace], check=False)

    def words(self, machine, words):
        """The command line that runs a program on a machine."""
        return ["ip", "netns", "exec", self.namespaces[machine], *map(str, words)]

    def env(self, machine, **more):
        """The environment of programs on a machine: games and gateways are registered only there."""
        folder = self.out / machine
        folder.mkdir(mode=0o700, exist_ok=True)
        return {**os.environ, "XDG_RUNTIME_DIR": str(folder), **more}

    def start(self, name, machine, words, **more):
        """Starts a long-running program."""
        program = Program(name, self.words(machine, words), self.env(machine, **more), self.out / f"{name}.log")
        self.programs.append(program)
        return program

    def end(self, program, number=signal.SIGINT):
        """Ends a program; returns its exit code."""
        self.programs.remove(program)
        return program.end(number)

    def tell_link(self, *words):
        """Sends the link a command, which must succeed."""
        answer = self.link.request(" ".join(map(str, words)))
        if answer != ["ok"]:
            raise RuntimeError(f"the link: {answer}")

    def link_statistics(self):
        """Counts and lateness of the link since the last time."""
        return json.loads(self.link.request("stats")[0])

    def trace(self, from_ns):
        """The packets since a time, as text."""
        return self.link.request(f"trace {from_ns}", ends=lambda line: line == "end")[:-1]


def run_ip(*words):
    try:
        done = subprocess.run(["ip", *words], capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise Unavailable("`ip` is not installed (package iproute2)") from error
    if done.returncode != 0:
        raise Unavailable(f"ip {' '.join(words)}: {done.stderr.strip()}")


def must_be_possible():
    """Raises `Unavailable` where machines cannot be created."""
    if os.geteuid() != 0:
        raise Unavailable("network namespaces and TUN devices need root")
    if not os.path.exists("/dev/net/tun"):
        raise Unavailable("/dev/net/tun does not exist")
