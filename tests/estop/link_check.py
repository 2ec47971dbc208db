#!/usr/bin/env python3
"""Checks the emulated link by ICMP echo, from inside a machine: `link_check.py ADDRESS COUNT` prints JSON."""

import json
import math
import os
import select
import socket
import statistics
import struct
import sys
import time

EVERY_S = 0.005
# Maximum deviation of a round trip from twice the delay, ms: that of a busy machine.
ROUND_TRIP_MS = 5.0
# Maximum deviation of the lost fraction from the requested one, in standard deviations.
DEVIATIONS = 4.0


def checksum(data):
    """The Internet checksum (RFC 1071) of an even number of bytes."""
    total = sum(struct.unpack(f"!{len(data) // 2}H", data))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return ~total & 0xFFFF


def echo_request(identifier, number):
    body = struct.pack("!d", time.monotonic())
    header = struct.pack("!BBHHH", 8, 0, 0, identifier, number)
    return struct.pack("!BBHHH", 8, 0, checksum(header + body), identifier, number) + body


def ping(address, count):
    """Round trips, ms, of the answered ones among `count` echo requests."""
    identifier, round_trips_ms = os.getpid() & 0xFFFF, []
    with socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_ICMP) as icmp:
        icmp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        for number in range(count + 1):
            if number < count:
                icmp.sendto(echo_request(identifier, number), (address, 0))
            until = time.monotonic() + (EVERY_S if number < count else 1.0)
            while select.select([icmp], [], [], max(0.0, until - time.monotonic()))[0]:
                packet = icmp.recv(2048)
                now_s = time.monotonic()
                reply = packet[4 * (packet[0] & 15):]
                kind, _, _, whose, _ = struct.unpack_from("!BBHHH", reply)
                if kind == 0 and whose == identifier:
                    round_trips_ms.append(1e3 * (now_s - struct.unpack_from("!d", reply, 8)[0]))
    return round_trips_ms


def problem_of(measured, delay_ms, loss_pct):
    """The fault of the link, according to the measurements; None if there is none."""
    if not measured["received"]:
        return "nothing is returned"
    if not -0.1 <= measured["median_ms"] - 2 * delay_ms <= ROUND_TRIP_MS:
        return f"a round trip takes {measured['median_ms']:.1f} ms, expected {2 * delay_ms:.1f}"
    # In either direction.
    want = 1 - (1 - loss_pct / 100) ** 2
    lost = 1 - measured["received"] / measured["sent"]
    if abs(lost - want) > DEVIATIONS * (want * (1 - want) / measured["sent"]) ** 0.5:
        return f"{100 * lost:.1f} % of round trips are lost, expected {100 * want:.1f}"
    return None


def main():
    address, count = sys.argv[1], int(sys.argv[2])
    round_trips_ms = ping(address, count)
    median_ms = statistics.median(round_trips_ms) if round_trips_ms else None
    print(json.dumps({"sent": count, "received": len(round_trips_ms), "median_ms": median_ms}))


if __name__ == "__main__":
    main()
