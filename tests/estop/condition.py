"""The faults during which boats are stopped."""

import random
import signal
import subprocess
import time

from machine import HERE
from rig import BOAT, BOATS, CONSOLE, GAME, SIM

# One in this many cuts lasts until both ends have closed the connection, as zenoh does after 10 s.
LONG_CUT_EVERY, LONG_CUT_S = 10, 12.0
LOSS_PCT = 5.0


class Skipped(Exception):
    """A condition cannot be created here; gives the reason."""


class Condition:
    """A fault: permanent, or around each stop."""

    def __init__(self, rig, name, delay_ms):
        self.name = name
        self.delay_ms = delay_ms
        self.rig = rig
        self.machines = rig.machines
        self.random = random.Random(rig.machines.seed)

    def begin(self):
        """Before the first stop."""

    def before(self, number):
        """Just before a stop."""

    def after(self):
        """Just after a stop."""

    def end(self):
        """After the last stop."""


class Loss(Condition):
    def begin(self):
        self.machines.tell_link("loss-pct", LOSS_PCT)

    def end(self):
        self.machines.tell_link("loss-pct", 0)


class Cut(Condition):
    def before(self, number):
        # Boat and fleet are stopped in turn, each during both cuts.
        self.cut_s = time.monotonic()
        self.machines.tell_link("cut", CONSOLE, (SIM, BOAT)[number // 2 % 2])
        is_long = number % LONG_CUT_EVERY == LONG_CUT_EVERY - 1
        time.sleep(LONG_CUT_S if is_long else self.random.uniform(0.0, 1.0))

    def after(self):
        self.machines.tell_link("restore")
        # TCP resends a stop that was cut off, within the duration of the cut. It must not be mistaken for the next one.
        time.sleep(time.monotonic() - self.cut_s + 0.5)


class StoppedSim(Condition):
    def before(self, number):
        self.rig.sim.send_signal(signal.SIGSTOP)
        # Expired orders also stop the boats, after a second.
        time.sleep(self.random.uniform(0.05, 0.3))

    def after(self):
        self.rig.sim.send_signal(signal.SIGCONT)


class Stranger(Condition):
    """A stranger on the simulation's machine, with a shorter path to it than all other nodes."""

    what, about, stranger = "forge", BOATS, None

    def begin(self):
        words = [self.rig.stranger_python, HERE / "stranger.py", self.what, self.rig.endpoint, GAME, *self.about]
        self.stranger = self.machines.start(f"stranger_{self.what}", SIM, words)
        # The first report comes when it starts, the second after it has been running for a second.
        for mark in (0, 1):
            if self.stranger.find(lambda line: line.startswith("{"), 30.0, mark) is None:
                raise RuntimeError(f"the stranger does not start: see {self.stranger.log.name}")

    def end(self):
        if self.stranger is not None:
            print(f"  the stranger: {self.stranger.lines[-1][1]}")
            self.machines.end(self.stranger)


class Forger(Stranger):
    def begin(self):
        has_zenoh = subprocess.run([self.rig.stranger_python, "-c", "import zenoh"], capture_output=True, check=False)
        if has_zenoh.returncode != 0:
            raise Skipped("the package eclipse-zenoh is not installed: give --stranger-python")
        super().begin()


class Flood(Stranger):
    what = "flood"

    def begin(self):
        self.about = tuple(self.rig.control.values())
        super().begin()


CONDITIONS = {"clean": Condition, "flood": Flood, "cut": Cut, "stranger": Forger, "stopped-sim": StoppedSim, "loss": Loss}
