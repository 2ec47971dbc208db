"""A browser's part of crates/shore/PROTOCOL.md: opens the WebSocket of a page, acknowledges its frames, and counts them."""

import base64
import json
import os
import socket
import struct
import threading

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
# A page that receives nothing for this time has lost its server, s.
SILENCE_S = 30.0


class PageClient:
    """An open page. `hello` has arrived when this is created."""

    def __init__(self, host, port):
        self.socket = socket.create_connection((host, port), timeout=SILENCE_S)
        self.reader = self.socket.makefile("rb")
        self.frames = 0
        self.state = {}
        self.refused = []
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /ws HTTP/1.1\r\nHost: {host}:{port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode()
        )
        status = self.reader.readline().decode().strip()
        while self.reader.readline().strip():
            pass
        if " 101 " not in f"{status} ":
            raise ConnectionError(f"the page replies {status!r} to a WebSocket request")
        self.hello = None
        while self.hello is None:
            self._take()

    def follow(self):
        """Continues reading in its own thread until the page closes."""
        thread = threading.Thread(target=self._follow, daemon=True)
        thread.start()
        return thread

    def close(self):
        """Closes the WebSocket and the connection."""
        try:
            self._send(CLOSE, struct.pack("!H", 1000))
        except OSError:
            pass
        self.socket.close()

    def _follow(self):
        try:
            while True:
                self._take()
        except (OSError, ValueError):
            # The server is gone, or `close` was called.
            pass

    def _take(self):
        """One message."""
        kind, payload = self._read()
        if kind == PING:
            self._send(PONG, payload)
        elif kind == CLOSE:
            raise ConnectionError("the page is closed")
        elif kind == BINARY and payload[:1] == b"\x01":
            self.frames += 1
            self._send(TEXT, b'{"do":"ack"}')
        elif kind == TEXT:
            message = json.loads(payload)
            if message["kind"] == "hello":
                self.hello = message
            elif message["kind"] == "state":
                self.state = message
            elif message["kind"] == "refused":
                self.refused.append(message["reason"])

    def _read(self):
        kind, length = self._exactly(2)
        if length == 126:
            (length,) = struct.unpack("!H", self._exactly(2))
        elif length == 127:
            (length,) = struct.unpack("!Q", self._exactly(8))
        return kind & 15, self._exactly(length)

    def _exactly(self, count):
        read = self.reader.read(count)
        if len(read) < count:
            raise ConnectionError("the page hung up")
        return read

    def _send(self, kind, payload):
        mask = os.urandom(4)
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload))
        self.socket.sendall(bytes([0x80 | kind, 0x80 | len(payload)]) + mask + masked)
