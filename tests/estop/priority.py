#!/usr/bin/env python3
"""The effect of a busy machine on measurements: real-time priority for the clock, and a watch for stalls.

As a program it prints `stall END_NS LATE_MS` whenever an ordinary process that sleeps is woken late: the programs under
test have not run for that long either.
"""

import os
import sys
import time

EVERY_S = 0.002
# Minimum duration of a reported stall, ms. Shorter ones occur on every machine.
STALL_MS = 5.0


def run_at_once():
    """Runs this thread with priority over all ordinary ones. Its children and later threads are ordinary again."""
    try:
        os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(1))
    except OSError as error:
        print(f"no real-time priority, times may be too long: {error}", file=sys.stderr)


def run_when_idle():
    """Runs this process, with all its later threads, only where a processor has nothing else to do."""
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))


def stall_in(line):
    """Parses a line that this program prints: when a stall ended, ns, and how long it lasted, ms."""
    _, at_ns, late_ms = line.split()
    return int(at_ns), float(late_ms)


def main():
    while True:
        due_s = time.monotonic() + EVERY_S
        time.sleep(EVERY_S)
        late_ms = 1e3 * (time.monotonic() - due_s)
        if late_ms > STALL_MS:
            print(f"stall {time.monotonic_ns()} {late_ms:.1f}", flush=True)


if __name__ == "__main__":
    main()
