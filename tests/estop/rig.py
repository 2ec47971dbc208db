"""A game with two real boats on three machines: operators, the simulation, and the boats with their gateways."""

import json
import re
import secrets
import subprocess
import sys
import time

from machine import HERE
from priority import stall_in

ROOT = HERE.parents[1]
BOATS = ("blue_one", "red_one")
CONSOLE, SIM, BOAT = MACHINES = ("console", "sim", "boat")
GAME, PORT = "estop", 7447
STANDBY = "L"
# How long programs may take to start, and boats to be armed, s.
START_S, ARM_S = 60.0, 15.0
# How long the release of the fleet may take, s.
RELEASE_S = 1.0
# Time after which a boat that has not been sent standby counts as never stopped, s.
NEVER_S = 5.0


class Rig:
    """Everything that a stop needs except the operator."""

    def __init__(self, machines, squall, stranger_python):
        self.machines = machines
        self.squall = squall
        self.stranger_python = stranger_python
        self.token = secrets.token_hex(32)
        self.endpoint = f"tcp/{machines.addresses[SIM]}:{PORT}"
        self.control = {boat: f"{machines.addresses[BOAT]}:{8101 + i}" for i, boat in enumerate(BOATS)}
        # Lines of the boats' machine processed so far, the newest command to each boat, and its standbys.
        self.seen = 0
        self.last_mode = dict.fromkeys(BOATS, STANDBY)
        self.standbys = {boat: [] for boat in BOATS}
        # How often the fleet had to be released again.
        self.stops_after_release = 0

    def start(self):
        self.stall_watch = self.machines.start("stalls", SIM, [sys.executable, HERE / "priority.py"])
        scenario = self.machines.out / "estop.toml"
        scenario.write_text(f'base = "{ROOT}/scenarios/games/mixed_2v2.toml"\nduration_s = 86400.0\n', encoding="utf-8")
        self.start_boats(scenario)
        self.sim = self.start_squall("sim", SIM, "sim", scenario, "--listen", self.endpoint, "--insecure",
                                     "--pace", "realtime", "--game", GAME, "--join-s", "600")
        self.start_squall("agents", SIM, "agent", *self.place(), "--vehicle", "blue_one", "blue_two", "red_one",
                          "red_two")
        wires = [f"{boat}={8201 + i}=127.0.0.1:{8003 + i}={self.control[boat]}" for i, boat in enumerate(BOATS)]
        self.boat_side = self.machines.start("boat_side", BOAT, [sys.executable, HERE / "boat_side.py", *wires],
                                             SQUALL_TOKEN=self.token)
        for i, boat in enumerate(BOATS):
            self.wait_for(self.boat_side, f"open {8201 + i}")
            self.start_squall(f"gateway_{boat}", BOAT, "gateway", "surveyor", *self.place(), "--vehicle", boat,
                              "--link", f"tcp://127.0.0.1:{8201 + i}", "--control-listen", self.control[boat],
                              "--config", ROOT / "scenarios/gateways/emulated.toml", "--no-record")
        for boat in BOATS:
            self.wait_until(f"{boat} is under way", lambda boat=boat: self.get_under_way(boat), START_S)

    def start_boats(self, scenario):
        """The water and the emulated boats, on the boats' machine."""
        afloat = [word for boat in BOATS for word in ("--afloat", boat)]
        water = f"tcp/127.0.0.1:{PORT}"
        self.start_squall("water", BOAT, "sim", scenario, *afloat, "--listen", water, "--pace", "realtime",
                          "--game", "water")
        for i, boat in enumerate(BOATS):
            address = f"tcp://127.0.0.1:{8003 + i}"
            emulator = self.start_squall(f"boat_{boat}", BOAT, "gateway", "emulate", "--connect", water,
                                         "--game", "water", "--vehicle", boat, "--listen", address)
            self.wait_for(emulator, address)

    def start_squall(self, name, machine, *words):
        return self.machines.start(name, machine, [self.squall, *words], SQUALL_TOKEN=self.token)

    def place(self):
        """How programs find the game."""
        return ["--connect", self.endpoint, "--game", GAME]

    def console(self, name):
        """An operator's console that is connected to every boat."""
        gateways = [word for boat in BOATS for word in ("--gateway", self.control[boat])]
        console = self.start_squall(name, CONSOLE, "gateway", "console", *gateways, *self.place())
        for boat in BOATS:
            def shows(boat=boat):
                mark = console.mark()
                console.write("status")
                return console.find(lambda line: boat in line, 1.0, mark) is not None

            self.wait_until(f"the console shows {boat}", shows, START_S)
        return console

    def wait_for(self, program, text):
        if program.find(lambda line: text in line, START_S) is None:
            raise RuntimeError(f"{program.name} does not print {text!r} within {START_S:.0f} s: see {program.log.name}")

    def wait_until(self, what, holds, limit_s):
        until = time.monotonic() + limit_s
        while time.monotonic() < until:
            for program in self.machines.programs:
                if program.child.poll() is not None:
                    raise RuntimeError(f"{program.name} has ended with {program.child.returncode}: see {program.log.name}")
            if holds():
                return
            time.sleep(0.05)
        raise RuntimeError(f"{what}: not within {limit_s:.0f} s; see {self.machines.out}")

    def ask(self, boat, command):
        """The reply of a boat's gateway to a query on its own machine."""
        return self.request(boat, {"boat": {"name": boat, "command": command}})

    def request(self, boat, body):
        mark = self.boat_side.mark()
        self.boat_side.write(json.dumps({"boat": boat, "body": body}))
        found = self.boat_side.find(lambda line: line.startswith("reply "), START_S, mark)
        if found is None:
            raise RuntimeError("the boats' machine does not respond")
        return json.loads(found[1].removeprefix("reply "))

    def state(self, boat):
        status = self.ask(boat, "status")["status"]
        return status["state"] if status else "unknown"

    def read_wire(self):
        """Processes the commands sent to the boats."""
        with self.boat_side.news:
            lines, self.seen = self.boat_side.lines[self.seen:], len(self.boat_side.lines)
        for _, line in lines:
            if line.startswith("wire "):
                _, at_ns, boat, mode, _ = line.split(" ", 4)
                self.last_mode[boat] = mode
                if mode == STANDBY:
                    self.standbys[boat].append(int(at_ns))
                else:
                    # Stops are searched for among the standbys since the boat was last under way.
                    self.standbys[boat].clear()

    def is_standing(self, boat):
        """Whether the newest command to a boat is standby."""
        self.read_wire()
        return self.last_mode[boat] == STANDBY

    def standby_after(self, boat, from_ns, limit_s):
        """When a boat is next sent standby, ns; None if not within this time from now."""
        until = time.monotonic() + limit_s
        while True:
            self.read_wire()
            for at_ns in self.standbys[boat]:
                if at_ns >= from_ns:
                    return at_ns
            if time.monotonic() >= until:
                return None
            time.sleep(0.005)

    def stalls_ms(self, from_ns, to_ns):
        """The durations of this machine's stalls between two times, ms."""
        with self.stall_watch.news:
            stalls = [stall_in(line) for _, line in self.stall_watch.lines]
        return [late_ms for at_ns, late_ms in stalls if at_ns >= from_ns and at_ns - 1e6 * late_ms <= to_ns]

    def get_under_way(self, boat):
        """Arms a boat, or has it keep its station where it cannot be armed; False if neither is possible now."""
        for command in ("arm", "station_keep"):
            until = time.monotonic() + (ARM_S if command == "arm" else 1.0)
            while time.monotonic() < until:
                state = self.state(boat)
                if state.startswith(("armed", "delegated")):
                    if not self.is_standing(boat):
                        return True
                elif "fleet" in state:
                    # A copy of a fleet-wide stop arrived after the release.
                    self.stops_after_release += 1
                    self.tell(SIM, "all", "release")
                    time.sleep(RELEASE_S)
                else:
                    self.ask(boat, "release" if state.startswith("e-stopped") else command)
                time.sleep(0.05)
        return False

    def release(self, boats, release_fleet):
        """Ends the E-stops of boats, on their own machine; `release_fleet` ends that of the game."""
        def states():
            for boat in boats:
                self.ask(boat, "release")
            return [self.state(boat) for boat in boats]

        until, releases, release_at_s = time.monotonic() + START_S, 0, 0.0
        while left := [state for state in states() if state.startswith("e-stopped")]:
            if time.monotonic() >= until:
                raise RuntimeError(f"not released within {START_S:.0f} s: {', '.join(boats)}; see {self.machines.out}")
            # A release may take some time to reach the gateways.
            if any("fleet" in state for state in left) and time.monotonic() >= release_at_s:
                release_fleet()
                releases += 1
                release_at_s = time.monotonic() + RELEASE_S
        # A copy of a fleet-wide stop that arrives after the release takes effect again.
        self.stops_after_release += releases > (len(boats) > 1)

    def tell(self, machine, *words):
        """Runs `squall gateway tell` to its end: the time before, ns, and its result."""
        words = self.machines.words(machine, [self.squall, "gateway", "tell", *words, *self.place()])
        env = self.machines.env(machine, SQUALL_TOKEN=self.token)
        began_ns = time.monotonic_ns()
        done = subprocess.run(words, env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              timeout=START_S, check=False)
        return began_ns, done


def stopped_line(boat):
    """Whether a line of the console shows a boat as stopped."""
    pattern = re.compile(rf"\b{boat}\b.*\be-stopped\b.*\bafter\b")
    return lambda line: pattern.search(line) is not None
