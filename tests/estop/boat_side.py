#!/usr/bin/env python3
"""On the boats' machine: the wire between each gateway and its boat, and the gateways' control ports.

    boat_side.py BOAT=LISTEN_PORT=BOAT_ADDRESS=CONTROL_ADDRESS ...

Gateways connect to LISTEN_PORT of loopback. Each command of a gateway to its boat is printed when its bytes arrive,
before the boat receives them: `wire NS BOAT MODE SENTENCE`, NS of the monotonic clock. Standard input takes requests,
one JSON object a line with the keys `boat` and `body`; each is answered with `reply JSON`. The game's token is in
SQUALL_TOKEN.
"""

import hashlib
import hmac
import json
import os
import socket
import sys
import threading
import time

from priority import run_at_once

KEY = b"gateway control port"
# How long a control port may take to reply, s.
ANSWER_S = 5.0


def modes_in(text):
    """The complete sentences in the bytes received, with the mode of each command, and the rest.

    >>> modes_in(b"$PSEAC,L,0,0,0,*75\\r\\n$PSE")
    ([('L', '$PSEAC,L,0,0,0,*75')], b'$PSE')
    """
    *lines, rest = text.split(b"\n")
    sentences = [line.decode(errors="replace").strip() for line in lines]
    return [(sentence.split(",")[1], sentence) for sentence in sentences if sentence.startswith("$PSEAC,")], rest


def proof_of(token, challenge, body):
    """The proof that a request's sender knows the token: HMAC-SHA256 of challenge, key and body, each after its length."""
    mac = hmac.new(bytes.fromhex(token), digestmod=hashlib.sha256)
    for part in (challenge.encode(), KEY, body):
        mac.update(len(part).to_bytes(8, "little") + part)
    return mac.hexdigest()


def ask(address, token, body):
    """The reply of a gateway's control port to a request."""
    host, _, port = address.rpartition(":")
    spelled = json.dumps(body, separators=(",", ":"))
    with socket.create_connection((host, int(port)), timeout=ANSWER_S) as connection:
        lines = connection.makefile("rwb")

        def exchange(text):
            lines.write(text.encode() + b"\n")
            lines.flush()
            return json.loads(lines.readline())

        answer = exchange(f'{{"body":{spelled}}}')
        if (challenge := answer.get("challenge")) is not None:
            proof = json.dumps({"challenge": challenge, "mac": proof_of(token, challenge, spelled.encode())})
            answer = exchange(f'{{"body":{spelled},"proof":{proof}}}')
    return answer["answer"]


def copy(source, target, see):
    """Passes bytes on until one side ends."""
    try:
        while data := source.recv(4096):
            see(data)
            target.sendall(data)
    except OSError:
        pass
    for end in (source, target):
        try:
            end.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass


def serve(boat, port, address):
    """The wire of one boat, for each connection of its gateway."""
    run_at_once()
    host, _, boat_port = address.rpartition(":")
    for near in accepted(port):
        far = socket.create_connection((host, int(boat_port)))
        for end in (near, far):
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        rest = b""

        def see(data):
            nonlocal rest
            at_ns = time.monotonic_ns()
            commands, rest = modes_in(rest + data)
            for mode, sentence in commands:
                say(f"wire {at_ns} {boat} {mode} {sentence}")

        threading.Thread(target=copy, args=(far, near, lambda _: None), daemon=True).start()
        copy(near, far, see)


def accepted(port):
    with socket.create_server(("127.0.0.1", port)) as listener:
        say(f"open {port}")
        while True:
            yield listener.accept()[0]


def say(line):
    # One call for the whole line: several threads print.
    os.write(1, line.encode() + b"\n")


def main():
    boats = [text.split("=") for text in sys.argv[1:]]
    control = {boat: address for boat, _, _, address in boats}
    for boat, port, address, _ in boats:
        threading.Thread(target=serve, args=(boat, int(port), address), daemon=True).start()
    for line in sys.stdin:
        request = json.loads(line)
        try:
            reply = ask(control[request["boat"]], os.environ["SQUALL_TOKEN"], request["body"])
        except (OSError, ValueError, KeyError) as error:
            reply = {"refused": f"no answer: {error!r}", "status": None}
        say(f"reply {json.dumps(reply)}")


if __name__ == "__main__":
    main()
