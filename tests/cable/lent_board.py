# SPDX-License-Identifier: Apache-2.0
"""A browser that lends a board, without the browser: a WebSocket of the gateway, and the port of a simulated board, which is opened
anew for each rate and each restart, as Web Serial and DTR do it."""

import contextlib
import fcntl
import json
import os
import select
import struct
import termios
import threading

import websocket

TCSETS2, BOTHER = 0x402C542B, 0o010000


class Port:
    """The board's end: opened raw, at any rate."""

    def __init__(self, path):
        self.path = path
        self.fd = None
        self.opened = []  # the rate of each opening

    def open(self, baud):
        self.fd = os.open(self.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        # At once, and nothing is discarded: a board that the opening restarts may have sent its banner already.
        raw = struct.pack("=4Ix19s2I", 0, 0, termios.CS8 | termios.CREAD | termios.CLOCAL | BOTHER, 0, bytes(5) + b"\0\1", baud, baud)
        fcntl.ioctl(self.fd, TCSETS2, raw)
        self.opened.append(baud)

    def close(self):
        if self.fd is not None:
            os.close(self.fd)
        self.fd = None

    def write(self, data):
        while data:
            select.select([], [self.fd], [])
            data = data[os.write(self.fd, data):]


class LentBoard:
    def __init__(self, url, path, token=None, cookie=None, cable=None, vendor="2341", product="0043"):
        headers = [f"Authorization: Bearer {token}"] if token else []
        self.cable = cable or os.urandom(8).hex()
        self.socket = websocket.create_connection(f"{url.replace('http', 'ws')}/api/cable?vendor={vendor}&product={product}&cable={self.cable}",
                                                  header=headers, cookie=cookie, suppress_origin=True, timeout=30)
        self.port = Port(path)
        self.port.open(57600)
        self.baud = 57600
        self.name = None
        self.why = None
        self.closed = None  # the code
        self.restarts = 0
        self.alive = 0  # what the gateway said without a need
        self.left = False  # nothing on this connection counts any more
        self.lock = threading.Lock()  # of the port
        self.stopping = threading.Event()
        self.threads = [threading.Thread(target=each, daemon=True) for each in (self.from_board, self.to_board)]
        for thread in self.threads:
            thread.start()

    def from_board(self):
        while not self.stopping.is_set() and not self.left:
            with self.lock:
                fd = self.port.fd
                ready = fd is not None and select.select([fd], [], [], 0)[0]
                data = b""
                if ready:
                    with contextlib.suppress(OSError):
                        data = os.read(fd, 4096)
                    data = data or None  # the board was pulled there
            if data is None:
                return self.send(b"Eunplugged")
            if data:
                self.send(b"D" + data)
            else:
                select.select([fd] if fd is not None else [], [], [], 0.01)

    def send(self, message):
        with contextlib.suppress(OSError, websocket.WebSocketException):  # why it ended comes on the other way
            self.socket.send_binary(message)

    def to_board(self):
        try:
            while not self.stopping.is_set():
                code, message = self.socket.recv_data()
                if code == websocket.ABNF.OPCODE_CLOSE:
                    self.closed = struct.unpack("!H", message[:2])[0]
                    return
                self.take(message[:1], message[1:])
        except (OSError, websocket.WebSocketException):
            pass

    def leave(self):
        """As a page that connects anew: another connection has the board."""
        self.left = True
        self.threads[0].join(5)
        self.port.close()

    def take(self, kind, payload):
        if self.left:
            return
        if kind == b"D":
            with self.lock:
                self.port.write(payload)
        elif kind in (b"R", b"Z"):
            with self.lock:
                self.port.close()
                self.baud = int(payload) if kind == b"R" else self.baud
                self.restarts += kind == b"Z"
                self.port.open(self.baud)
        elif kind == b"N":
            self.name = payload.decode()
        elif kind == b"A":
            self.alive += 1
        elif kind == b"E":
            self.why = payload.decode()

    def close(self):
        """As a tab that is closed."""
        self.stopping.set()
        self.socket.close(timeout=1)
        for thread in self.threads:
            thread.join(5)
        self.port.close()


def board_file(work, name, image, board="uno", **more):
    file = work / f"{name}.json"
    file.write_text(json.dumps({"name": name, "board": board, "image": str(image), "link": str(work / f"{name}.port"), **more}))
    return str(file)
