#!/usr/bin/env python3
"""A stranger who can reach the game's port but has neither its token nor its keys.

    stranger.py flood ENDPOINT GAME CONTROL_ADDRESS ...   floods the game's port, and the control ports
    stranger.py forge ENDPOINT GAME BOAT ...              reports, in place of their gateways, that boats are stopped

It continues until it is ended, and reports its activity every second. Publishing needs the package eclipse-zenoh;
without it, `flood` sends only bytes, and `forge` exits.
"""

import json
import os
import socket
import sys
import threading
import time
from collections import Counter

from priority import run_when_idle

try:
    import zenoh
except ImportError:
    zenoh = None

# Control ports are flooded over the emulated link, which carries some ten thousand packets a second.
DATAGRAMS_HZ = 500
CONNECTIONS_HZ = 20
FORGED_HZ = 50


class Stranger:
    """What has been sent so far."""

    def __init__(self, endpoint, game):
        self.endpoint = endpoint
        self.keys = f"squall/{game}/"
        self.counts = Counter()
        # A session is closed when it is dropped.
        self.sessions = []

    def session(self):
        config = zenoh.Config()
        config.insert_json5("mode", '"client"')
        config.insert_json5("connect/endpoints", json.dumps([self.endpoint]))
        config.insert_json5("scouting/multicast/enabled", "false")
        self.sessions.append(zenoh.open(config))
        return self.sessions[-1]

    def publish(self, topic, payload, hz=None):
        """Publishes the same message, as fast as the hub accepts it or `hz` times a second."""
        session = self.session()
        publisher = session.declare_publisher(self.keys + topic, congestion_control=zenoh.CongestionControl.BLOCK)
        while True:
            publisher.put(payload)
            self.counts[topic] += 1
            if hz is not None:
                time.sleep(1 / hz)

    def throw_datagrams(self, address, hz):
        host, port = address
        garbage = os.urandom(512)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            while True:
                try:
                    out.sendto(garbage, (host, port))
                    self.counts["datagrams"] += 1
                except OSError:
                    # Nothing is listening there, as reported for an earlier datagram.
                    self.counts["datagrams refused"] += 1
                time.sleep(1 / hz)

    def throw_connections(self, address, hz):
        garbage = b'{"body":' + b"[" * 400 + b"\n"
        while True:
            try:
                with socket.create_connection(address, timeout=2) as out:
                    out.sendall(garbage)
                self.counts["connections"] += 1
            except OSError:
                self.counts["connections refused"] += 1
            time.sleep(1 / hz)

    def answer(self, boat, reply):
        """Answers operators in place of a boat's gateway, claiming to be the only node that need be queried."""
        key = f"{self.keys}operate/{boat}"

        def answered(query):
            query.reply(key, reply)
            self.counts[f"answered for {boat}"] += 1

        return self.session().declare_queryable(key, answered, complete=True)


def address_of(text):
    host, _, port = text.rpartition(":")
    return host.rpartition("/")[2], int(port)


def begin(target, *args):
    threading.Thread(target=target, args=args, daemon=True).start()


def flood(stranger, controls):
    begin(stranger.throw_datagrams, address_of(stranger.endpoint), 20 * DATAGRAMS_HZ)
    begin(stranger.throw_connections, address_of(stranger.endpoint), CONNECTIONS_HZ)
    for control in controls:
        begin(stranger.throw_datagrams, address_of(control), DATAGRAMS_HZ)
        begin(stranger.throw_connections, address_of(control), CONNECTIONS_HZ)
    if zenoh is not None:
        for topic in ("control", "order/x"):
            begin(stranger.publish, topic, b"garbage")


def forge(stranger, boats):
    if zenoh is None:
        sys.exit("the package eclipse-zenoh is not installed")
    declared = []
    for boat in boats:
        status = status_of(stranger, boat)
        status["state"] = "e-stopped (by an E-stop of this boat)"
        reply = json.dumps({"answer": {"refused": None, "status": status}})
        declared.append(stranger.answer(boat, reply))
        for topic in (f"status/{boat}", f"report/status/{boat}"):
            begin(stranger.publish, topic, json.dumps(status).encode(), FORGED_HZ)
    return declared


def status_of(stranger, boat):
    """The boat's gateway's reply to everyone."""
    session = stranger.session()
    for _ in range(20):
        for reply in session.get(f"{stranger.keys}operate/{boat}", payload=b'{"body":"status"}', timeout=3):
            if reply.ok is not None:
                return json.loads(bytes(reply.ok.payload.to_bytes()))["answer"]["status"]
    sys.exit(f"no gateway of {boat} is responding")


def main():
    what, endpoint, game, *others = sys.argv[1:]
    # A real stranger does not use the processors of the programs under test.
    run_when_idle()
    stranger = Stranger(endpoint, game)
    # A declaration is withdrawn when it is dropped.
    _declared = {"flood": flood, "forge": forge}[what](stranger, others)
    while True:
        print(json.dumps(stranger.counts), flush=True)
        time.sleep(1)


if __name__ == "__main__":
    main()
