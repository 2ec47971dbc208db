#!/usr/bin/env python3
"""Plays one long game with everything enabled, and reports growth: memory, file descriptors, threads, latency.

It runs `squall run` with emulated boats behind gateways, an open page and a recording, and `squall watch` beside it.
Every minute it prints a line with the resident memory of every process, descriptors, threads, and the duration of
requests; it also acts as the operator: each boat is disarmed and armed again. At the end, each figure's slope over the
run is compared with a limit. The exit code is 1 if a slope exceeds its limit, a process has died, or the recording is
incomplete.

Linux, Python 3.9, no packages. CONTRIBUTING.md explains how to run it overnight.
"""

import argparse
import csv
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from growth import growth_of
from page_client import PageClient
from process import children_of, usage_of

ROOT = Path(__file__).resolve().parents[2]
# In a short run, a process may grow by this, MB: anything done for the first time needs memory.
GROW_MB = 4.0
# Time for processes to start or end, s.
START_S, END_S = 90.0, 120.0
# How long a request may take before it counts as failed, s.
ANSWER_S = 20.0
# Latencies, and what each of them measures.
LATENCIES = {
    "ask sim": "squall list from its start to its end: its own session, a query to the hub and one to the sim",
    "page": "a WebSocket of the page from its opening to its first message",
    "status": "the status of a boat at its gateway's control port",
    "disarm": "a boat disarmed at its gateway's control port",
    "order": "an order of the game through a gateway to its boat, 99th percentile as the gateway measures it",
}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=24.0, help="length of the game, simulated hours [24]")
    parser.add_argument("--pace", type=float, default=3.0, help="simulated seconds per second [3: a night]")
    parser.add_argument("--every-s", type=float, default=60.0, help="time between two lines, s [60]")
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "soak",
                        help="a subfolder is created for each run: recordings (0.2 GB a simulated hour), result, samples.csv "
                             "[runs/soak]")
    parser.add_argument("--squall", type=Path, help="the program [target/release/squall]")
    parser.add_argument("--grow-mb-h", type=float, default=4.0,
                        help=f"a process may grow by this an hour, MB, and by {GROW_MB:g} MB in a shorter run [4]; the index of "
                             "a recording needs 2")
    parser.add_argument("--grow-count", type=float, default=4.0,
                        help="a process's file descriptors, and its threads, may grow by this over the run [4]")
    parser.add_argument("--slower-ms", type=float, default=100.0,
                        help="a latency may grow by this over the run, ms [100]; other load on the machine counts too")
    args = parser.parse_args()
    for name, least, most in (("hours", 0.001, 24.0), ("pace", 0.1, 100.0), ("every_s", 1.0, 3600.0)):
        if not least <= getattr(args, name) <= most:
            parser.error(f"--{name.replace('_', '-')} is {getattr(args, name)}, expected {least} to {most}")
    args.squall = (args.squall or Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/squall").resolve()
    if not args.squall.exists():
        parser.error(f"{args.squall} does not exist: build it with `cargo build --release`, or give --squall")
    return args


class Soak:
    """A running game and its measurements."""

    def __init__(self, args):
        self.args = args
        self.out = args.out.resolve() / time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
        self.out.mkdir(parents=True)
        # Its own registry of games: others on this machine are neither found nor disturbed.
        self.registry = tempfile.TemporaryDirectory(prefix="squall-soak-")
        self.env = {**os.environ, "XDG_RUNTIME_DIR": self.registry.name}
        self.started = []
        self.page = None
        self.processes = {}
        self.samples = {}
        self.problems = []
        # Boat, time and cause of each: a gateway's status reports only the newest.
        self.failsafes = set()
        self.begun = time.monotonic()
        # All figures, one per line, as they arrive: they are kept even if this is killed.
        self.file = open(self.out / "samples.csv", "w", newline="", encoding="utf-8", buffering=1)
        self.table = csv.writer(self.file)
        self.table.writerow(["at_s", "kind", "of", "value"])

    def start(self):
        """Starts everything, and waits until the game has begun."""
        scenarios = ROOT / "scenarios"
        game = Path(self.registry.name) / "soak.toml"
        game.write_text(
            f'base = "{scenarios}/games/mixed_2v2.toml"\nduration_s = {self.args.hours * 3600:.1f}\n', encoding="utf-8"
        )
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.page_port = free.getsockname()[1]
        self.run = self.begin("run", "run", game, "--emulate", "--pace", f"{self.args.pace}x", "--gateway",
                              scenarios / "gateways/emulated.toml", "--view", "--listen", f"127.0.0.1:{self.page_port}",
                              "--record", self.out, "--record-gateways", self.out, "--json", self.out / "result.json")
        entry = self.wait_for("the sim's registration", lambda: self.registered("soak-*.json"))[0]
        self.place = ["--connect", entry["endpoint"], "--game", entry["game"]]
        self.endpoint = entry["endpoint"]
        self.gateways = self.wait_for("two gateways", lambda: self.registered("*.gateway", 2))
        self.page = self.wait_for("the page", self.open_page)
        self.follower = self.page.follow()
        self.begin("watch", "watch", "--rate", "1", *self.place)
        self.begin("watch helm", "watch", "--helm", "blue_two", "--rate", "1", *self.place)
        self.wait_for("the game's beginning", lambda: self.page.state.get("phase") == "playing")
        self.processes = {child.pid: name for name, child in self.started}
        children = children_of(self.run.pid)
        if not all(children.values()):
            raise SystemExit(f"a process of squall run has ended:\n{self.last_words()}")
        self.processes.update({pid: label(words) for pid, words in children.items()})
        self.begun = time.monotonic()

    def begin(self, name, *words):
        """Starts a command; its output goes to its own file."""
        with open(self.out / f"{name.replace(' ', '_')}.log", "wb") as log:
            child = subprocess.Popen([self.args.squall, *map(str, words)], env=self.env, stdin=subprocess.DEVNULL,
                                     stdout=log, stderr=subprocess.STDOUT)
        self.started.append((name, child))
        return child

    def registered(self, pattern, count=1):
        """The entries of this kind in the registry, if there are this many."""
        files = sorted((Path(self.registry.name) / "squall").glob(pattern))
        try:
            entries = [json.loads(file.read_text(encoding="utf-8")) for file in files]
        except ValueError:
            # The file is still being written.
            return None
        return entries if len(entries) >= count else None

    def open_page(self):
        try:
            return PageClient("127.0.0.1", self.page_port)
        except OSError:
            return None

    def wait_for(self, what, find):
        """Waits for a value; an error if there is none in time."""
        until = time.monotonic() + START_S
        while time.monotonic() < until:
            if self.run.poll() is not None:
                raise SystemExit(f"squall run ended with {self.run.returncode} before {what}:\n{self.last_words()}")
            if found := find():
                return found
            time.sleep(0.1)
        raise SystemExit(f"{what}: not within {START_S:.0f} s; see {self.out}/run.log")

    def last_words(self):
        return "\n".join((self.out / "run.log").read_text(encoding="utf-8", errors="replace").splitlines()[-10:])

    def is_over(self):
        if self.run.poll() is not None or self.page.state.get("phase") in ("over", "gone"):
            return True
        return not self.follower.is_alive()

    def sample(self):
        """Measures everything once."""
        at = time.monotonic() - self.begun
        for pid, name in list(self.processes.items()):
            usage = usage_of(pid)
            if usage is None:
                if not self.is_over():
                    self.problem(f"{name} has ended")
                del self.processes[pid]
                continue
            for kind, value in vars(usage).items():
                self.note((kind, name), at, value)
        for name, measure in (("ask sim", self.ask_sim), ("page", self.visit)):
            self.measured(name, at, measure)
        for gateway in self.gateways:
            self.operate(at, gateway)

    def note(self, key, at, value):
        self.samples.setdefault(key, []).append((at, value))
        self.table.writerow([f"{at:.1f}", *key, f"{value:.3f}"])

    def problem(self, text):
        if not self.is_over():
            print(f"PROBLEM: {text}", flush=True)
            self.problems.append(text)

    def measured(self, name, at, act):
        """The result of `act`; records how long it took."""
        start = time.monotonic()
        try:
            result = act()
        except (OSError, ValueError, subprocess.SubprocessError) as error:
            return self.problem(f"{name}: {error}")
        self.note(("ms", name), at, (time.monotonic() - start) * 1e3)
        return result

    def command(self, *words):
        """Runs a command to its end."""
        done = subprocess.run([self.args.squall, *words], env=self.env, stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, timeout=ANSWER_S, check=False)
        if done.returncode != 0:
            raise ValueError(f"squall {' '.join(words)} ended with {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def ask_sim(self):
        games = self.command("list", "--elsewhere", "--connect", self.endpoint)
        if self.place[-1] not in games:
            raise ValueError(f"squall list does not find the game: {games!r}")

    def visit(self):
        PageClient("127.0.0.1", self.page_port).close()

    def operate(self, at, gateway):
        """Disarms a boat and arms it again; a failsafe is counted."""
        name, place = gateway["vehicle"], gateway["control"]
        reply = self.measured("status", at, lambda: ask_gateway(place, name, "status"))
        if reply is None:
            return
        self.failsafes.update((name, failsafe["at_s"], failsafe["cause"]) for failsafe in reply["status"]["failsafes"])
        order_us = reply["status"]["latency_us"][1]
        if order_us is not None:
            self.note(("ms", "order"), at, order_us[1] / 1e3)
        reply = self.measured("disarm", at, lambda: ask_gateway(place, name, "disarm"))
        if reply is not None and reply["status"]["state"] != "disarmed":
            self.problem(f"{name} is {reply['status']['state']!r} after it was disarmed")
        try:
            self.command("gateway", "tell", name, "arm", "--gateway", place)
        except (ValueError, subprocess.SubprocessError) as error:
            # Not ready just now, for example after a failsafe: it stays disarmed until the next time.
            print(f"         {error}", flush=True)

    def end(self):
        """Ends everything in order, and kills what does not end."""
        over = self.page is not None and self.page.state.get("phase") == "over"
        for name, child in reversed(self.started):
            # The observers end with the game; `run` keeps the page open until Ctrl-C.
            if child.poll() is None and (name == "run" or not over):
                child.send_signal(signal.SIGINT)
            try:
                child.wait(END_S)
            except subprocess.TimeoutExpired:
                child.kill()
                self.problems.append(f"{name} does not end within {END_S:.0f} s of being asked to")
        if self.page is not None:
            self.page.close()
        if self.page is not None and not over and not self.follower.is_alive():
            self.problems.append("the page has lost its connection")
        if over and self.run.returncode != 0:
            self.problems.append(f"squall run ended with {self.run.returncode}:\n{self.last_words()}")
        if not over:
            self.problems.append("the game was not played to its end")

    def read_recording(self):
        """Checks that the recording can be read to its end, and how much memory that takes."""
        files = sorted(self.out.glob("*_soak_*.mcap"), key=lambda file: file.stat().st_mtime)
        if not files:
            return self.problems.append("no recording")
        start = time.monotonic()
        child = self.begin("log", "log", files[-1])
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            self.problems.append(f"squall log {files[-1]} ended with {child.returncode}; see {self.out}/log.log")
        megabytes = files[-1].stat().st_size / 1e6
        print(f"squall log reads the recording of {megabytes:.0f} MB in {time.monotonic() - start:.1f} s and "
              f"{usage.ru_maxrss / 1024:.0f} MB of memory")


def label(words):
    """A short name of a process that `squall run` has started, from its command line."""
    after = dict(zip(words, words[1:]))
    boat = after.get("--vehicle", "")
    if words[1] == "gateway":
        return f"{words[2].replace('surveyor', 'gateway').replace('emulate', 'boat')} {boat}"
    return "water" if "--afloat" in words else f"{words[1]} {boat}".strip()


def ask_gateway(place, boat, command):
    """Sends a request to the control port of a gateway: a line of JSON each way."""
    host, _, port = place.rpartition(":")
    with socket.create_connection((host, int(port)), timeout=ANSWER_S) as connection:
        lines = connection.makefile("rwb")
        lines.write(json.dumps({"body": {"boat": {"name": boat, "command": command}}}).encode() + b"\n")
        lines.flush()
        answer = json.loads(lines.readline())["answer"]
    if answer["refused"] is not None:
        raise ValueError(f"{boat} refused {command}: {answer['refused']}")
    return answer


def show(soak, number):
    """A line about the newest sample, with an occasional heading."""
    names = [name for kind, name in soak.samples if kind == "rss_mb"]
    newest = {key: series[-1][1] for key, series in soak.samples.items()}
    if number % 20 == 0:
        print("\nmemory in MB of: " + ", ".join(names))
        print("latencies in ms: " + ", ".join(LATENCIES))
        print(f"{'minute':>8}{'game s':>8}{'frames/s':>9}  memory")
    memory = " ".join(f"{newest['rss_mb', name]:.0f}" for name in names)
    total = {kind: sum(newest[kind, name] for name in names) for kind in ("descriptors", "threads")}
    latencies = " ".join(f"{newest['ms', name]:.2f}" if ("ms", name) in newest else "-" for name in LATENCIES)
    state = soak.page.state
    at_min = newest_time(soak) / 60
    print(f"{at_min:8.1f}{state.get('now_s', 0.0):8.0f}{state.get('frames_hz', 0.0):9.0f}  {memory}  "
          f"descriptors {total['descriptors']}  threads {total['threads']}  ms {latencies}", flush=True)


def newest_time(soak):
    return max(series[-1][0] for series in soak.samples.values())


def judge(soak):
    """A table of what grew, and the figures that grew by more than their limit."""
    grow_mb = max(GROW_MB, soak.args.grow_mb_h * newest_time(soak) / 3600)
    limits = {"own_mb": grow_mb, "descriptors": soak.args.grow_count, "threads": soak.args.grow_count,
              "ms": soak.args.slower_ms}
    units = {"own_mb": "own memory, MB", "descriptors": "file descriptors", "threads": "threads", "ms": "latency, ms"}
    for kind, limit in limits.items():
        print(f"\n{units[kind] + f' (limit {limit:g})':32}{'first':>10}{'last':>10}{'grew':>10}")
        for (_, of), series in ((key, series) for key, series in soak.samples.items() if key[0] == kind):
            growth = growth_of(series)
            if growth is None:
                soak.problems.append(f"only {len(series)} samples of {of} ({units[kind]}): too few for a slope")
                continue
            beyond = growth.grew > limit
            print(f"  {of:30}{growth.first:10.2f}{growth.last:10.2f}{growth.grew:10.2f}{'  TOO MUCH' if beyond else ''}")
            if beyond:
                soak.problems.append(f"{of}: {units[kind]} grew by {growth.grew:.2f}, allowed {limit:g}")


def play(soak):
    """Samples until the game is over, or Ctrl-C."""
    number = 0
    print(f"look on: http://127.0.0.1:{soak.page_port}/  or  XDG_RUNTIME_DIR={soak.registry.name} squall watch "
          f"{' '.join(soak.place)}")
    while not soak.is_over():
        soak.sample()
        if not soak.is_over():
            show(soak, number)
        number += 1
        due = soak.begun + number * soak.args.every_s
        while time.monotonic() < due and not soak.is_over():
            time.sleep(0.1)


def main():
    args = arguments()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    soak = Soak(args)
    try:
        soak.start()
        play(soak)
    except KeyboardInterrupt:
        print("interrupted: the following results are partial")
    finally:
        soak.end()
    judge(soak)
    soak.read_recording()
    for (boat, cause), count in sorted(Counter((boat, cause) for boat, _, cause in soak.failsafes).items()):
        print(f"{count} failsafes of {boat}: {cause}")
    for problem, count in Counter(soak.problems).items():
        print(f"PROBLEM: {problem}{f' ({count} times)' if count > 1 else ''}")
    print("nothing grew beyond its limit" if not soak.problems else f"{len(soak.problems)} problems; see {soak.out}")
    return 1 if soak.problems else 0


if __name__ == "__main__":
    sys.exit(main())
