"""Tests the emulated ArduPilot boat with dronekit and MAVProxy, unmodified and used as they drive a Rover.

    ground_station_check.py PATH/OF/squall

Exits with an error at the first failed check.
"""

import collections
import collections.abc
import math
import os
import socket
import subprocess
import sys
import tempfile
import time

from pymavlink_check import ARMED, AUTO, GUIDED, HOLD, LIMIT_S, M_PER_DEG, RTL, Processes, check, heartbeat_of, wait_for

from pymavlink import mavutil  # noqa: E402

# dronekit 2.9.2 uses a name that Python 3.10 has removed.
collections.MutableMapping = collections.abc.MutableMapping
import dronekit  # noqa: E402


def wait_until(what, is_so, limit_s=LIMIT_S):
    end = time.monotonic() + limit_s
    while not is_so():
        if time.monotonic() > end:
            raise SystemExit(f"FAILED: {what}: not within {limit_s} s")
        time.sleep(0.1)
    check(True, what)


def distance_m(here, there):
    north = (there.lat - here.lat) * M_PER_DEG
    return math.hypot(north, (there.lon - here.lon) * M_PER_DEG * math.cos(math.radians(here.lat)))


def north_of(place, metres):
    return dronekit.LocationGlobalRelative(place.lat + metres / M_PER_DEG, place.lon, 0)


def drive_with_dronekit(port):
    boat = dronekit.connect(f"tcp:127.0.0.1:{port}", wait_ready=True, timeout=LIMIT_S)
    here = lambda: boat.location.global_relative_frame
    wait_until("dronekit finds it armable", lambda: boat.is_armable)
    wait_until("it reports its version", lambda: (boat.version.major, boat.version.minor) == (4, 6))
    boat.parameters["WP_SPEED"] = 1.5
    check(boat.parameters["WP_SPEED"] == 1.5, "a parameter is set")
    boat.mode = dronekit.VehicleMode("GUIDED")
    wait_until("GUIDED", lambda: boat.mode.name == "GUIDED")
    boat.armed = True
    wait_until("armed", lambda: boat.armed)
    boat.commands.download()
    boat.commands.wait_ready()
    check(distance_m(here(), boat.home_location) < 5, "its home is the position where it was armed")
    goal = north_of(here(), 15)
    boat.simple_goto(goal, groundspeed=1.0)
    wait_until("simple_goto arrives", lambda: distance_m(here(), goal) < 4, 60)
    check(boat.groundspeed < 1.3, f"not faster than requested: {boat.groundspeed} m/s")
    commands = boat.commands
    commands.clear()
    for metres in (-10, -20):
        place = north_of(here(), metres)
        commands.add(dronekit.Command(0, 0, 0, 3, 16, 0, 1, 0, 0, 0, 0, place.lat, place.lon, 0))
    commands.upload()
    wait_until("the boat has the mission", lambda: reload(commands) == 2)
    boat.mode = dronekit.VehicleMode("AUTO")
    wait_until("AUTO", lambda: boat.mode.name == "AUTO" and commands.next == 1)
    wait_until("the second waypoint is next", lambda: commands.next == 2, 60)
    boat.mode = dronekit.VehicleMode("RTL")
    wait_until("RTL", lambda: boat.mode.name == "RTL")
    boat.armed = False
    wait_until("disarmed", lambda: not boat.armed)
    boat.mode = dronekit.VehicleMode("HOLD")
    wait_until("HOLD", lambda: boat.mode.name == "HOLD")
    boat.close()


def reload(commands):
    """Downloads the boat's mission; returns the number of its waypoints."""
    commands.download()
    commands.wait_ready()
    return commands.count


class MavProxy:
    """MAVProxy and its output."""

    def __init__(self, port, folder):
        self.output = open(os.path.join(folder, "output"), "w+", encoding="utf-8")
        program = os.path.join(os.path.dirname(sys.executable), "mavproxy.py")
        self.process = subprocess.Popen([sys.executable, program, "--master", f"tcp:127.0.0.1:{port}", "--retries", "20"], cwd=folder,
                                        stdin=subprocess.PIPE, stdout=self.output, stderr=subprocess.STDOUT, text=True,
                                        env={**os.environ, "HOME": folder})

    def printed(self):
        with open(self.output.name, encoding="utf-8") as file:
            return file.read()

    def type(self, line, words=None):
        """Types a command; if words are given, waits until MAVProxy prints them."""
        before = len(self.printed())
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        if words is not None:
            try:
                wait_until(f"{line}: {words}", lambda: words in self.printed()[before:])
            except SystemExit:
                print(self.printed())
                raise

    def end(self):
        self.process.kill()
        self.process.wait()
        self.output.close()


def drive_with_mavproxy(port, observer, folder):
    def at():
        while observer.recv_match(blocking=False):
            pass
        return wait_for(observer, "where it is", "GLOBAL_POSITION_INT")

    def moves(line, north_m, east_m, seconds, times=1):
        """Repeats a command for this many seconds, then checks how far the boat has moved."""
        before = at()
        for _ in range(times):
            proxy.type(line)
            time.sleep(seconds / times)
        after = at()
        north = (after.lat - before.lat) * 1e-7 * M_PER_DEG
        east = (after.lon - before.lon) * 1e-7 * M_PER_DEG * math.cos(math.radians(1e-7 * before.lat))
        check(math.hypot(north - north_m, east - east_m) < 5, f"{line}: {north:.0f} m north, {east:.0f} m east")

    proxy = MavProxy(port, folder)
    try:
        wait_until("MAVProxy has its parameters", lambda: "parameters" in proxy.printed())
        proxy.type("mode GUIDED", "Mode GUIDED")
        proxy.type("arm throttle", "ARMED")
        wait_for(observer, "GUIDED, armed", "HEARTBEAT", heartbeat_of(GUIDED, True))
        proxy.type("setyaw 90 1 0")
        start = at()
        moves(f"guided {start.lat * 1e-7 + 15 / M_PER_DEG} {start.lon * 1e-7} 0", 15, 0, 30)
        # It points north now.
        moves("velocity 1 0 0", 12, 0, 14, times=14)
        moves("position -15 0 0", -15, 0, 40)
        proxy.type("velocity 1 0 0")
        wait_until("expired set-points are reported", lambda: "target not received" in proxy.printed())
        with open(os.path.join(folder, "mission.txt"), "w", encoding="utf-8") as file:
            file.write("QGC WPL 110\n")
            for seq in range(3):
                file.write(f"{seq}\t0\t3\t16\t0\t0\t0\t0\t{start.lat * 1e-7 + seq * 1e-4:.7f}\t{start.lon * 1e-7:.7f}\t0\t1\n")
        proxy.type("wp load mission.txt", "Loaded 3 waypoints")
        wait_until("the mission is accepted", lambda: "Flight plan received" in proxy.printed() or "Sent all" in proxy.printed())
        proxy.type("wp list", "Saved")
        proxy.type("wp set 2")
        wait_for(observer, "waypoint 2 is next", "MISSION_CURRENT", lambda current: current.seq == 2)
        proxy.type("mode AUTO")
        wait_for(observer, "AUTO", "HEARTBEAT", heartbeat_of(AUTO, True))
        proxy.type("rtl")
        wait_for(observer, "RTL", "HEARTBEAT", heartbeat_of(RTL, True))
        proxy.type("long DO_FENCE_ENABLE 1", "UNSUPPORTED")
        proxy.type("mode HOLD")
        proxy.type("disarm", "DISARMED")
        wait_for(observer, "HOLD, disarmed", "HEARTBEAT", heartbeat_of(HOLD, False))
    finally:
        proxy.end()


def main(squall):
    processes = Processes(squall)
    observer = mavutil.mavlink_connection("udpin:127.0.0.1:0", source_system=254, source_component=190)
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    try:
        game = f"stations{os.getpid()}"
        processes.start("sim", "mixed_2v2", "--afloat", "blue_one", "--pace", "realtime", "--game", game)
        processes.start("gateway", "emulate", "--protocol", "mavlink", "--game", game, "--vehicle", "blue_one",
                        "--listen", f"tcp://127.0.0.1:{port}",
                        "--ground-station", f"udp://127.0.0.1:{observer.port.getsockname()[1]}")
        wait_for(observer, "the boat's heartbeat", "HEARTBEAT", heartbeat_of(HOLD, False))
        print("dronekit drives the emulated boat")
        drive_with_dronekit(port)
        print("MAVProxy drives it")
        with tempfile.TemporaryDirectory() as folder:
            drive_with_mavproxy(port, observer, folder)
    finally:
        processes.end()
    print("dronekit and MAVProxy: all ok")


if __name__ == "__main__":
    main(*sys.argv[1:])
