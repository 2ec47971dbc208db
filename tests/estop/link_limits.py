#!/usr/bin/env python3
"""Measures the link quality that a game needs: plays in real time over links of several qualities, and counts
failsafes.

    link_limits.py SQUALL OUT --far agents --transport quic --delay-ms 300 --loss-pct 5 --for-s 600

Two machines are joined by a bad link (bad_link.py). One runs the sim. `--far` selects what runs on the other: the
agents, or the gateways with their emulated boats. The two real boats of `mixed_2v2` arm themselves once, so the first
failsafe of each is final unless --rearm-within-s is given. Prints one JSON line: the time under way without a
failsafe, failsafes, and the traffic of each boat. Linux, root, Python 3.9, no packages.
"""

import argparse
import json
import secrets
import sys
import time
from pathlib import Path

from machine import Machines, Unavailable, must_be_possible
from rig import BOATS, PORT, ROOT, START_S

NEAR, FAR = "near", "far"
GAME = "links"


class Play:
    def __init__(self, machines, args):
        self.machines, self.args = machines, args
        self.token = secrets.token_hex(32)
        self.endpoint = f"{args.transport}/{machines.addresses[NEAR]}:{PORT}"
        self.boats_at = FAR if args.far == "gateways" else NEAR
        self.agents_at = FAR if args.far == "agents" else NEAR

    def squall(self, name, machine, *words):
        # With priority over everything else on this computer: the link is measured, not the load.
        return self.machines.start(name, machine, ["nice", "-n", "-15", self.args.squall, *words],
                                   SQUALL_TOKEN=self.token)

    def start(self):
        """Starts everything, until boats are under way; returns the gateways."""
        scenario = self.machines.out / "links.toml"
        keys = f"duration_s = 86400.0\norder_ttl_s = {self.args.order_ttl_s}\n"
        scenario.write_text(f'base = "{ROOT}/scenarios/games/mixed_2v2.toml"\n{keys}', encoding="utf-8")
        config = self.machines.out / "gateway.toml"
        keys = f"order_ttl_s = {self.args.order_ttl_s}\nfailsafe.rearm_within_s = {self.args.rearm_within_s}\n"
        config.write_text(f'base = "{ROOT}/scenarios/gateways/emulated.toml"\n{keys}', encoding="utf-8")
        water = f"tcp/127.0.0.1:{PORT + 1}"
        afloat = [word for boat in BOATS for word in ("--afloat", boat)]
        self.squall("water", self.boats_at, "sim", scenario, *afloat, "--listen", water, "--pace", "realtime",
                    "--game", "water")
        links = {boat: f"tcp://127.0.0.1:{8003 + i}" for i, boat in enumerate(BOATS)}
        for boat, link in links.items():
            boat_program = self.squall(f"boat_{boat}", self.boats_at, "gateway", "emulate", "--connect", water,
                                       "--game", "water", "--vehicle", boat, "--listen", link)
            wait_for(boat_program, link)
        self.squall("sim", NEAR, "sim", scenario, "--listen", self.endpoint, "--insecure", "--pace", "realtime",
                    "--game", GAME, "--join-s", "60")
        place = ["--connect", self.endpoint, "--game", GAME]
        for team in ("blue", "red"):
            boats = (f"{team}_one", f"{team}_two")
            self.squall(f"agents_{team}", self.agents_at, "agent", *place, "--vehicle", *boats)
        gateways = {boat: self.squall(f"gateway_{boat}", self.boats_at, "gateway", "surveyor", *place, "--arm",
                                      "--vehicle", boat, "--link", link, "--no-record", "--config", config)
                    for boat, link in links.items()}
        for gateway in gateways.values():
            wait_for(gateway, "armed")
        return gateways

    def measure(self):
        gateways = self.start()
        # A good link while everything starts: only the game is measured.
        self.machines.tell_link("delay-ms", self.args.delay_ms)
        self.machines.tell_link("loss-pct", self.args.loss_pct)
        if self.args.rate_kbit:
            self.machines.tell_link("rate-kbit", self.args.rate_kbit)
        self.machines.link_statistics()
        marks = {boat: gateway.mark() for boat, gateway in gateways.items()}
        begin_ns = time.monotonic_ns()
        until = time.monotonic() + self.args.for_s
        cut = time.monotonic() + (self.args.cut_every_s or 0.0)
        while time.monotonic() < until:
            ended = [program.name for program in self.machines.programs if program.child.poll() is not None]
            if ended:
                raise RuntimeError(f"{ended} ended; see {self.machines.out}")
            if self.args.cut_every_s and time.monotonic() >= cut:
                self.machines.tell_link("cut", NEAR, FAR)
                time.sleep(2.0)
                self.machines.tell_link("restore")
                cut += self.args.cut_every_s
            time.sleep(1.0)
        causes, first_s, armed = [], None, 0
        for boat, gateway in gateways.items():
            for at_ns, line in gateway.lines[marks[boat]:]:
                armed += line.split()[-1:] == ["armed"] or " armed (was failsafe" in line
                if "failsafe:" in line and "armed (was" not in line:
                    causes.append(line)
                    at_s = (at_ns - begin_ns) / 1e9
                    first_s = at_s if first_s is None else min(first_s, at_s)
        sent = self.machines.link_statistics()
        return {"far": self.args.far, "transport": self.args.transport, "delay_ms": self.args.delay_ms,
                "loss_pct": self.args.loss_pct, "rate_kbit": self.args.rate_kbit,
                "order_ttl_s": self.args.order_ttl_s, "played_s": self.args.for_s,
                "first_failsafe_s": first_s and round(first_s, 1), "failsafes": len(causes), "armed_again": armed, "causes": causes[:4],
                "kbit_s": {way: round(8e-3 * count / self.args.for_s, 1) for way, count in sent["bytes"].items()}}


def wait_for(program, text):
    if program.find(lambda line: text in line, START_S) is None:
        raise RuntimeError(f"{program.name} does not print {text!r} within {START_S:.0f} s: see {program.log.name}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("squall", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--far", choices=("agents", "gateways"), default="agents")
    parser.add_argument("--transport", choices=("tcp", "quic"), default="quic")
    parser.add_argument("--delay-ms", type=float, default=0.0, help="one-way delay [0]")
    parser.add_argument("--loss-pct", type=float, default=0.0, help="percentage of packets that are lost [0]")
    parser.add_argument("--rate-kbit", type=float, help="rate limit of each direction [none]")
    parser.add_argument("--for-s", type=float, default=60.0, help="how long to play [60]")
    parser.add_argument("--order-ttl-s", type=float, default=1.0, help="order_ttl_s of game and gateways [1]")
    parser.add_argument("--rearm-within-s", type=float, default=0.0, help="failsafe.rearm_within_s [0]")
    parser.add_argument("--cut-every-s", type=float, help="cuts the link for 2 s this often [never]")
    parser.add_argument("--seed", type=int, default=1, help="random seed of the losses [1]")
    args = parser.parse_args()
    args.squall, args.out = args.squall.resolve(), args.out.resolve()
    args.out.mkdir(parents=True, exist_ok=True)
    try:
        must_be_possible()
        with Machines((NEAR, FAR), args.out, args.seed) as machines:
            print(json.dumps(Play(machines, args).measure()))
    except (Unavailable, RuntimeError) as error:
        sys.exit(f"link_limits: {error}")


if __name__ == "__main__":
    main()
