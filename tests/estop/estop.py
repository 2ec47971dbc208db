#!/usr/bin/env python3
"""Measures E-stops over a bad network: from the operator's request until the boats have been sent standby.

Three machines (network namespaces) are joined by an emulated link with delay, loss and cuts: the operators', the
simulation's, and that of the gateways and two emulated boats. The boats are armed and under way before each stop.
One boat and all boats are stopped in turn, by a line to `squall gateway console`, under each of these conditions:

    clean        no fault
    flood        a stranger floods the game's port and the gateways' control ports
    cut          the path to the simulation or to the boats has been cut, in turn
    stranger     a stranger replies in the gateways' place and forges their status
    stopped-sim  the simulation is suspended
    loss         5 % of all packets are lost, on every path

A stop is in time if every boat concerned was sent standby within the one-way delay plus 200 ms. `squall gateway tell`
is measured too, with delays of 50, 150 and 300 ms, with and without loss. Its time beyond that without a delay is given
in round trips. The exit code is 1 if a stop is late, if the console does not show it or shows it before it has
happened, or if `tell` without loss needs more than three round trips.

Linux, root, Python 3.9, no packages; strangers publish with the package eclipse-zenoh. Where namespaces or TUN devices
cannot be created, nothing is measured, and the exit code is 0.
"""

import argparse
import json
import math
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections import Counter
from pathlib import Path

from condition import CONDITIONS, LOSS_PCT, Skipped
from figures import HEADING, WIDTH, Stop, Tally, milliseconds, quantile, round_trips, table
from link_check import problem_of
from machine import HERE, Machines, Unavailable, must_be_possible
from rig import BOATS, CONSOLE, MACHINES, NEVER_S, ROOT, SIM, Rig, stopped_line

ALLOWANCE_MS = 200.0
# With loss, a report of the previous stop may arrive after the next one was requested: boats are stopped every second
# here.
FALSE_SHARE = 0.01
# Maximum delay of the operator's view, s.
SHOWN_S = 3.0
TARGETS = ("blue_one", "all", "red_one", "all")
# Lateness of the emulated link up to which it is not reported, ms.
LINK_LATE_MS = 5.0
# Extra time that copies of a stop may take, beyond the network's delay, s.
SETTLE_S = 0.1
# Maximum number of failed attempts per valid one: an attempt fails if the boats are not under way.
VAIN_MAX = 5
PINGS = 400
TELL_DELAYS_MS = (0.0, 50.0, 150.0, 300.0)
TELL_TRIPS_MAX = 3.0
TELL_HEADING = ["tell", "delay", "loss", "stopped", "median", "trips", "max", "exit codes"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--times", type=int, default=20, help="stops under each condition [20]; 1000 for the record")
    parser.add_argument("--under", nargs="*", choices=CONDITIONS, default=list(CONDITIONS), metavar="CONDITION",
                        help=f"conditions for the console: {', '.join(CONDITIONS)} [all]")
    parser.add_argument("--tell-times", type=int, default=0, metavar="N",
                        help="runs of `tell` for each delay and loss [0: `tell` is not measured]")
    parser.add_argument("--delay-ms", type=float, default=50.0, help="one-way delay of all paths, for the console [50]")
    parser.add_argument("--seed", type=int, default=1, help="random seed of losses and pauses [1]")
    parser.add_argument("--squall", type=Path, help="the program [target/release/squall]")
    parser.add_argument("--stranger-python", default=sys.executable, metavar="PYTHON",
                        help="a Python with eclipse-zenoh, for strangers [the one that runs this]")
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "estop",
                        help="a subfolder is created for each run: the programs' output, and packets of late stops "
                             "[runs/estop]")
    args = parser.parse_args()
    # With longer delays, the detour through the simulation that remains after a cut would always be late.
    for name, least, most in (("times", 1, 100_000), ("tell_times", 0, 1000), ("delay_ms", 0.0, 190.0)):
        if not least <= getattr(args, name) <= most:
            parser.error(f"--{name.replace('_', '-')} is {getattr(args, name)}, expected {least} to {most}")
    args.squall = (args.squall or Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/squall").resolve()
    if not args.squall.exists():
        parser.error(f"{args.squall} does not exist: build it with `cargo build --release`, or give --squall")
    return args


def check_link(machines, delay_ms):
    """Compares the emulated link with its settings."""
    for loss_pct in (0.0, LOSS_PCT):
        machines.tell_link("loss-pct", loss_pct)
        for far in MACHINES[1:]:
            words = [sys.executable, HERE / "link_check.py", machines.addresses[far], PINGS]
            done = subprocess.run(machines.words(CONSOLE, words), capture_output=True, text=True, check=True)
            measured = json.loads(done.stdout)
            print(f"link {CONSOLE} - {far}: {measured['median_ms']:.1f} ms there and back, "
                  f"{measured['received']} of {measured['sent']} with {loss_pct:g} % loss")
            if problem := problem_of(measured, delay_ms, loss_pct):
                raise RuntimeError(f"the emulated link {CONSOLE} - {far}: {problem}")
    machines.tell_link("loss-pct", 0)


def milliseconds_between(from_ns, to_ns):
    return math.inf if to_ns is None else (to_ns - from_ns) / 1e6


def wire_ms_each(rig, boats, from_ns):
    """Time until each boat was sent standby, by an E-stop and nothing else."""
    until = time.monotonic() + NEVER_S
    took_ms = [milliseconds_between(from_ns, rig.standby_after(boat, from_ns, until - time.monotonic()))
               for boat in boats]
    # A failsafe that happened just then is not an E-stop.
    return [took if rig.state(boat).startswith("e-stopped") else math.inf for boat, took in zip(boats, took_ms)]


def stop_once(rig, console, condition, number, tally):
    """One E-stop; None if the boats were not under way when it was due."""
    target = TARGETS[number % len(TARGETS)]
    boats = BOATS if target == "all" else (target,)
    for boat in boats:
        if not rig.get_under_way(boat):
            return None
    condition.before(number)
    try:
        if any(map(rig.is_standing, boats)):
            return None
        mark = console.mark()
        began_ns = console.write(f"{target} estop")
        wire = wire_ms_each(rig, boats, began_ns)
        until = time.monotonic() + SHOWN_S
        shown = [console.find(stopped_line(boat), until - time.monotonic(), mark) for boat in boats]
        stop = Stop(wire, [milliseconds_between(began_ns, line and line[0]) for line in shown])
        if min(wire) < condition.delay_ms:
            # Nothing is faster than the network: this is a late copy of the previous stop.
            return None
        stalls_ms = rig.stalls_ms(began_ns, time.monotonic_ns())
        tally.stall_ms = max([tally.stall_ms, *stalls_ms])
        keep_evidence(rig, console, condition, number, stop, began_ns, mark, stalls_ms)
    finally:
        condition.after()
        # Copies of the stop that went by other paths arrive before the release.
        time.sleep(SETTLE_S + 4 * condition.delay_ms / 1e3)
        rig.release(boats, lambda: rig.tell(SIM, "all", "release"))
    return stop


def keep_evidence(rig, console, condition, number, stop, began_ns, mark, stalls_ms):
    """Writes the records of the link and the console for a stop that was late, not shown, or shown too early."""
    if stop.is_good(condition.delay_ms + ALLOWANCE_MS):
        return
    name = f"{condition.name}-{number}.txt"
    packets = rig.machines.trace(began_ns - 200_000_000)
    said = [f"{at_ns} console: {line}" for at_ns, line in console.lines[mark:]]
    wire, shown = (", ".join(map(milliseconds, each)) for each in (stop.wire_ms_each, stop.shown_ms_each))
    heading = f"requested at {began_ns} ns; on the wire after {wire} ms, shown after {shown} ms"
    if stalls_ms:
        heading += f"; the machine stalled for {', '.join(map(milliseconds, stalls_ms))} ms"
    (rig.machines.out / name).write_text("\n".join([heading, *said, *packets]) + "\n", encoding="utf-8")
    print(f"  {condition.name}, stop {number}: {heading.partition('; ')[2]}; see {name}")


def measure_console(rig, condition, times, tally):
    """Stops boats from a console, many times, under one condition."""
    console = rig.console(f"console_{condition.name}")
    vain, rig.stops_after_release = 0, 0
    try:
        condition.begin()
        rig.machines.link_statistics()
        while len(tally.stops) < times and vain < VAIN_MAX * times:
            stop = stop_once(rig, console, condition, len(tally.stops), tally)
            if stop is None:
                vain += 1
            else:
                tally.stops.append(stop)
        late_ms = rig.machines.link_statistics()["late_ms_max"]
        if late_ms > LINK_LATE_MS:
            print(f"  {condition.name}: the emulated link itself was late by up to {late_ms:.1f} ms")
    finally:
        condition.end()
        console.write("quit")
        code = rig.machines.end(console, None)
    for count, what in ((vain, "failed attempts: the boats were not under way"), (code, "is the console's exit code"),
                        (rig.stops_after_release, "releases of the fleet that a late copy of its stop undid")):
        if count:
            print(f"  {condition.name}: {count} {what}")


def measure_consoles(rig, args):
    """The table of all conditions; whether all of them passed."""
    rig.machines.tell_link("delay-ms", args.delay_ms)
    rows, passed = [], True
    for name in args.under:
        began_s = time.monotonic()
        false_share = FALSE_SHARE if name == "loss" else 0.0
        tally = Tally(args.delay_ms + ALLOWANCE_MS, false_share=false_share)
        try:
            measure_console(rig, CONDITIONS[name](rig, name, args.delay_ms), args.times, tally)
        except Skipped as why:
            print(f"SKIPPED: {name}: {why}")
            continue
        except (RuntimeError, OSError) as error:
            print(f"FAILED: {name}: {error}")
        print(f"{name}: {len(tally.stops)} stops in {time.monotonic() - began_s:.0f} s", flush=True)
        rows.append(tally.row(name))
        passed = passed and tally.passed() and len(tally.stops) == args.times
    print(f"\nFrom a line to the console until the boats are sent standby, ms; one-way delay {args.delay_ms:g} ms,\n"
          f"limit {args.delay_ms + ALLOWANCE_MS:g} ms\n\n{table(HEADING, rows)}\n")
    return passed


def tell_once(rig, words, boats, delay_ms):
    """One E-stop by `tell`: the time until it is on the wire, its exit code, and its output."""
    for boat in boats:
        rig.wait_until(f"{boat} is under way", lambda boat=boat: rig.get_under_way(boat), 60.0)
    began_ns, done = rig.tell(CONSOLE, *words)
    took_ms = max(wire_ms_each(rig, boats, began_ns))
    time.sleep(SETTLE_S + 4 * delay_ms / 1e3)
    rig.release(boats, lambda: rig.tell(SIM, "all", "release"))
    said = (done.stdout if done.returncode == 0 else done.stderr).strip().partition("\n")[0]
    return took_ms, done.returncode, said


def measure_tells(rig, times):
    """The table of `tell`; whether it stays within the allowed round trips."""
    first, start_ms, rows, words_said, passed = BOATS[0], {}, [], Counter(), True
    commands = {f"{first} estop": (first, "estop"), "the same, --gateway": (first, "estop", "--gateway", rig.control[first]),
                "all estop": ("all", "estop")}
    for loss_pct in (0.0, LOSS_PCT):
        rig.machines.tell_link("loss-pct", loss_pct)
        for delay_ms in TELL_DELAYS_MS:
            rig.machines.tell_link("delay-ms", delay_ms)
            for name, words in commands.items():
                boats = BOATS if words[0] == "all" else (first,)
                told = [tell_once(rig, words, boats, delay_ms) for _ in range(times)]
                took_ms = [took for took, _, _ in told]
                median_ms = quantile(took_ms, 0.5)
                trips = round_trips(median_ms, start_ms.setdefault(name, median_ms), delay_ms)
                codes = ", ".join(f"{n} x {code}" for code, n in Counter(code for _, code, _ in told).items())
                rows.append([name, f"{delay_ms:g}", f"{loss_pct:g}", f"{sum(map(math.isfinite, took_ms))}/{times}",
                             milliseconds(median_ms), "-" if trips is None else f"{trips:.2f}",
                             milliseconds(max(took_ms)), codes])
                words_said.update((code, said) for _, code, said in told)
                passed = passed and (loss_pct > 0 or trips is None or trips <= TELL_TRIPS_MAX)
            print(f"tell: {delay_ms:g} ms, {loss_pct:g} % loss: measured", flush=True)
    print(f"\nFrom the start of `squall gateway tell` until the boats are sent standby, ms; one-way delay,\nms; "
          f"loss, %\n\n"
          f"{table(TELL_HEADING, rows)}\n\nIts output, by exit code:")
    for (code, said), count in words_said.most_common(12):
        print(textwrap.fill(f"{count} x {code}: {said}", WIDTH, subsequent_indent="    "))
    rig.machines.tell_link("loss-pct", 0)
    return passed


def measure(args, out):
    """Takes the requested measurements; returns whether all passed."""
    passed = True
    with Machines(MACHINES, out, args.seed) as machines:
        machines.tell_link("delay-ms", args.delay_ms)
        check_link(machines, args.delay_ms)
        machines.tell_link("delay-ms", 1)
        rig = Rig(machines, args.squall, args.stranger_python)
        rig.start()
        if args.tell_times:
            passed = measure_tells(rig, args.tell_times)
        if args.under:
            passed = measure_consoles(rig, args) and passed
    return passed


def main():
    args = arguments()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    out = args.out.resolve() / f"{time.strftime('%Y%m%dT%H%M%SZ', time.gmtime())}-{os.getpid()}"
    try:
        must_be_possible()
        out.mkdir(parents=True)
        passed = measure(args, out)
    except Unavailable as why:
        print(f"SKIPPED: {why}")
        return 0
    except RuntimeError as error:
        print(f"FAILED: {error}")
        return 1
    except KeyboardInterrupt:
        print("interrupted: no result")
        return 130
    print("every stop was in time" if passed else f"stops were late or shown incorrectly: see {out}")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
