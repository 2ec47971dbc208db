#!/usr/bin/env python3
"""A bad network between machines that are network namespaces: delay, random loss, a rate limit, and cuts.

Each machine has one TUN device, and this process carries the IP packets between them. The qdisc netem does the same,
but many kernels lack it. Linux, root, Python 3.9, no packages.

    ip netns add left; ip netns add right
    bad_link.py --host left=left:10.77.0.1 --host right=right:10.77.0.2 --delay-ms 50 --loss-pct 5

prints `ready`, then takes one command a line from standard input and answers each with a line. It exits when standard
input closes.

    cut A B          drops everything between two hosts, packets in flight included
    restore          ends all cuts
    delay-ms N       one-way delay of packets that are sent from now on
    loss-pct N       percentage of packets that are lost
    rate-kbit N      rate limit of each direction between two hosts
    stats            counts since the last `stats`, as JSON
    trace FROM_NS    packets since this time of the monotonic clock, one a line, then `end`
"""

import argparse
import fcntl
import heapq
import ipaddress
import json
import os
import random
import select
import struct
import subprocess
import sys
import time
from collections import Counter, deque
from dataclasses import dataclass

from priority import run_at_once

MTU_BYTES = 1500
# From <linux/if_tun.h>.
TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
# Maximum number of packets read from one device before the others get their turn.
BATCH = 64
# Maximum number of packets kept for `trace`.
TRACE_MAX = 50_000


@dataclass
class Quality:
    """The effect of a link on packets."""

    delay_s: float = 0.0
    # Fraction of packets that are lost, 0 to 1.
    loss: float = 0.0
    # Of each direction between two hosts; None is unlimited.
    rate_bytes_s: float = None
    # The queue for the rate limit; a packet that does not fit is dropped.
    queue_bytes: int = 256 * 1024


class Scheduler:
    """Decides which packets arrive, and when. Pure: time is an argument, and a seed gives the same losses again."""

    def __init__(self, quality, seed):
        self.quality = quality
        self.random = random.Random(seed)
        self.cuts = set()
        # When the sender of a direction has sent everything it has accepted so far.
        self.idle_at_s = {}
        self.in_flight = []
        self.number = 0

    def cut(self, one, other):
        self.cuts.add(frozenset((one, other)))

    def restore(self):
        self.cuts.clear()

    def is_cut(self, source, target):
        return frozenset((source, target)) in self.cuts

    def send(self, now_s, source, target, packet):
        """Accepts a packet. Returns its fate: sent, lost, cut or full."""
        # Draw a loss for every packet, so that cuts do not shift the losses that follow.
        lost = self.random.random() < self.quality.loss
        if self.is_cut(source, target):
            return "cut"
        starts_s = now_s
        if self.quality.rate_bytes_s is not None:
            starts_s = max(now_s, self.idle_at_s.get((source, target), now_s))
            if (starts_s - now_s) * self.quality.rate_bytes_s + len(packet) > self.quality.queue_bytes:
                return "full"
            starts_s += len(packet) / self.quality.rate_bytes_s
            self.idle_at_s[source, target] = starts_s
        if lost:
            return "lost"
        self.number += 1
        # Packets that are due at once leave in the order in which they came.
        heapq.heappush(self.in_flight, (starts_s + self.quality.delay_s, self.number, source, target, packet))
        return "sent"

    def due_at_s(self):
        """When the next packet arrives; None if none is in flight."""
        return self.in_flight[0][0] if self.in_flight else None

    def arrivals(self, now_s):
        """The packets that arrive by now: due time, target and bytes of each."""
        arrived = []
        while self.in_flight and self.in_flight[0][0] <= now_s:
            due_s, _, source, target, packet = heapq.heappop(self.in_flight)
            if not self.is_cut(source, target):
                arrived.append((due_s, target, packet))
        return arrived


def summary(packet):
    """Protocol, ports, TCP flags and payload length of an IPv4 packet."""
    header = 4 * (packet[0] & 15)
    protocol, payload = packet[9], len(packet) - header
    if protocol not in (6, 17) or payload < 8:
        return f"protocol {protocol}, {payload} B"
    source, target = struct.unpack_from("!HH", packet, header)
    if protocol == 17:
        return f"udp {source} > {target}, {payload - 8} B"
    sequence, acknowledged, offset, flags = struct.unpack_from("!IIBB", packet, header + 4)
    names = "".join(name for bit, name in ((2, "S"), (1, "F"), (4, "R"), (16, "A")) if flags & bit)
    size = payload - 4 * (offset >> 4)
    return f"tcp {source} > {target} [{names}] seq {sequence} ack {acknowledged}, {size} B"


class Link:
    """The devices of the hosts, and the packets between them."""

    def __init__(self, hosts, scheduler):
        self.scheduler = scheduler
        self.devices = {}
        self.host_of = {}
        for number, (name, (namespace, address)) in enumerate(hosts.items()):
            self.devices[name] = open_device(f"sqbl{os.getpid()}-{number}", namespace, address)
            self.host_of[ipaddress.ip_address(address).packed] = name
        self.counts = Counter()
        # Packets sent by hosts, lost or not.
        self.sent_bytes = Counter()
        self.late_ms = []
        self.trace = deque(maxlen=TRACE_MAX)

    def carry(self, commands):
        """Carries packets and executes commands until the commands end."""
        source_of = {device: name for name, device in self.devices.items()}
        text = b""
        while True:
            due_s = self.scheduler.due_at_s()
            wait_s = None if due_s is None else max(0.0, due_s - time.monotonic())
            readable, _, _ = select.select([*source_of, commands], [], [], wait_s)
            for device in readable:
                if device in source_of:
                    self.receive(source_of[device], device)
            self.deliver()
            if commands in readable:
                read = os.read(commands, 4096)
                if not read:
                    return
                *lines, text = (text + read).split(b"\n")
                for line in lines:
                    print(self.obey(line.decode()), flush=True)

    def receive(self, source, device):
        """Receives a host's packets."""
        for _ in range(BATCH):
            try:
                packet = os.read(device, MTU_BYTES + 100)
            except BlockingIOError:
                return
            target = self.host_of.get(packet[16:20])
            # Multicast, and IPv6 neighbours that no host has.
            if packet[0] >> 4 != 4 or target is None:
                continue
            fate = self.scheduler.send(time.monotonic(), source, target, packet)
            self.counts[fate] += 1
            self.sent_bytes[f"{source} > {target}"] += len(packet)
            self.trace.append((time.monotonic_ns(), fate, source, target, packet[:60], len(packet)))

    def deliver(self):
        """Delivers packets that are due."""
        now_s = time.monotonic()
        for due_s, target, packet in self.scheduler.arrivals(now_s):
            self.late_ms.append(1e3 * (now_s - due_s))
            try:
                os.write(self.devices[target], packet)
            except OSError:
                # The device is down, or its queue is full.
                self.counts["refused"] += 1

    def obey(self, line):
        """Carries out a command; returns the answer."""
        try:
            word, *rest = line.split()
            if word == "cut" and len(rest) == 2 and set(rest) <= set(self.devices):
                self.scheduler.cut(*rest)
            elif word == "restore" and not rest:
                self.scheduler.restore()
            elif word == "delay-ms" and len(rest) == 1:
                self.scheduler.quality.delay_s = number_between(rest[0], 0.0, 10_000.0) / 1e3
            elif word == "loss-pct" and len(rest) == 1:
                self.scheduler.quality.loss = number_between(rest[0], 0.0, 100.0) / 100
            elif word == "rate-kbit" and len(rest) == 1:
                self.scheduler.quality.rate_bytes_s = number_between(rest[0], 1.0, 1e6) * 1e3 / 8
            elif word == "stats" and not rest:
                return self.statistics()
            elif word == "trace" and len(rest) == 1:
                return self.traced(int(rest[0]))
            else:
                return f"refused: {line!r}; hosts are {', '.join(self.devices)}"
        except ValueError as error:
            return f"refused: {line!r}: {error}"
        return "ok"

    def statistics(self):
        late_ms = sorted(self.late_ms) or [0.0]
        answer = {**self.counts, "bytes": dict(self.sent_bytes), "late_ms_p99": late_ms[int(0.99 * (len(late_ms) - 1))], "late_ms_max": late_ms[-1]}
        self.counts.clear()
        self.sent_bytes.clear()
        self.late_ms.clear()
        return json.dumps(answer)

    def traced(self, from_ns):
        lines = [
            f"{at_ns} {fate:4} {source} > {target}: {summary(head + bytes(size - len(head)))}"
            for at_ns, fate, source, target, head, size in self.trace
            if at_ns >= from_ns
        ]
        return "\n".join([*lines, "end"])


def open_device(name, namespace, address):
    """A TUN device of a namespace, up and with its address."""
    device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TUN | IFF_NO_PI))
    for words in (
        f"link set {name} netns {namespace}",
        f"-n {namespace} addr add {address}/24 dev {name}",
        f"-n {namespace} link set {name} mtu {MTU_BYTES} txqueuelen 1000 up",
    ):
        subprocess.run(["ip", *words.split()], check=True)
    return device


def number_between(text, least, most):
    number = float(text)
    if not least <= number <= most:
        raise ValueError(f"{text} is outside {least:g} to {most:g}")
    return number


def hosts_of(texts):
    """Hosts by name, from NAME=NAMESPACE:ADDRESS."""
    hosts = {}
    for text in texts:
        name, _, place = text.partition("=")
        namespace, _, address = place.partition(":")
        hosts[name] = (namespace, str(ipaddress.IPv4Address(address)))
    return hosts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host", action="append", required=True, metavar="NAME=NAMESPACE:ADDRESS",
                        help="a machine; may be repeated; all addresses must be in one /24 network")
    parser.add_argument("--delay-ms", type=float, default=0.0, help="one-way delay [0]")
    parser.add_argument("--loss-pct", type=float, default=0.0, help="percentage of packets that are lost [0]")
    parser.add_argument("--rate-mbit", type=float, help="rate limit of each direction between two hosts [none]")
    parser.add_argument("--queue-kb", type=int, default=256, help="maximum queue for the rate limit [256]")
    parser.add_argument("--seed", type=int, default=1, help="random seed of the losses [1]")
    args = parser.parse_args()
    rate_bytes_s = None if args.rate_mbit is None else args.rate_mbit * 1e6 / 8
    quality = Quality(args.delay_ms / 1e3, args.loss_pct / 100, rate_bytes_s, args.queue_kb * 1024)
    try:
        link = Link(hosts_of(args.host), Scheduler(quality, args.seed))
    except (OSError, ValueError, subprocess.CalledProcessError) as error:
        sys.exit(f"cannot create the link: {error}")
    # Programs that keep every core busy must not delay packets beyond the requested delay.
    run_at_once()
    print("ready", flush=True)
    link.carry(sys.stdin.fileno())


if __name__ == "__main__":
    main()
