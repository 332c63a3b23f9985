# SPDX-License-Identifier: Apache-2.0
"""One flood: connections that send bytes made beforehand as fast as they are taken, and read what comes without looking at it."""

import contextlib
import json
import select
import socket
import ssl
import struct
import sys
import threading
import time

from rows import NAMED, NAMES, OUTSIDE, PAGES, RESOURCES, TOPICS, USERS, filled, SUBSCRIBE

CHUNK = 1 << 16


def text(data):
    data = data.encode() if isinstance(data, str) else data
    return struct.pack(">H", len(data)) + data


def packet(kind, body):
    """A packet of MQTT."""
    length, size = b"", len(body)
    while size > 127:
        length += bytes([size % 128 | 128])
        size //= 128
    return bytes([kind]) + length + bytes([size]) + body


def connect(user, password):
    return packet(0x10, text("MQTT") + b"\x04\xc2\x00\x3c" + text("") + text(user) + text(password))


def publish(topic, payload, number, retain=False):
    """With QoS 1 and QoS 0 in turn."""
    payload = payload.encode() if isinstance(payload, str) else payload
    qos = number % 2
    identifier = struct.pack(">H", number % 60000 + 1) if qos else b""
    return packet(0x30 | qos << 1 | retain, text(topic) + identifier + payload)


def frame(message):
    """A message of a WebSocket, whose mask is 0."""
    data = message.encode()
    length = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + struct.pack(">H", len(data))
    return b"\x81" + length + b"\0\0\0\0" + data


class Flood:
    """`hello` begins a connection, `chunks` follow it again and again; `anew`: each connection ends with the first answer."""

    def __init__(self, kind, name, role, shape, place):
        self.kind, self.name, self.role, self.shape, self.place = kind, name, role, shape, place
        self.connections, self.hello, self.anew, self.goodbye = 4, b"", False, b""
        if shape == "many" or kind != "topic" and shape == "costly":
            self.connections = 32
        self.sent = self.opened = self.answers = 0
        self.heard = ""
        self.chunks = [b""]
        for message in getattr(self, kind)():
            if len(self.chunks[-1]) > (0 if self.anew else CHUNK):
                self.chunks.append(b"")
            self.chunks[-1] += message

    def topic(self):
        _, costly, retain = TOPICS[self.name]
        user = USERS[self.role]
        self.hello = connect(*self.place["users"][user])
        own = {"BOARD": user} if self.role == "board" else {"USER": user}
        own.update(*(names for start, names in NAMED.items() if self.name.startswith(start)))
        root = "" if self.name.startswith(OUTSIDE) else "asip/"
        numbers = range({"large": 2, "many": NAMES}.get(self.shape, NAMES // 10))
        topics = [root + filled(self.name, own, n, self.shape == "many") for n in numbers]
        if self.name == "reply/USER/BOARD/CLIENT/PART" and self.shape != "many":
            topics = [self.place["answers"]] * len(numbers)
        if self.shape in ("small", "large"):
            length = 16 if self.shape == "small" else self.place["largest"] - 200
            return [publish(topic, b"x" * length, n) for n, topic in zip(numbers, topics)]
        if retain:
            self.goodbye = self.hello + b"".join(publish(topic, b"", 0, True) for topic in dict.fromkeys(topics))
        return [publish(topic, costly(n), n, retain) for n, topic in zip(numbers, topics)]

    def http(self):
        _, behind, body = {**RESOURCES, **PAGES}[self.name]
        method, path = self.name.split(" ")
        if path == "/api/stream":
            return self.websocket()
        self.anew = path.endswith(("stream", "events")) or path.startswith("/events")
        many = self.shape == "many"
        numbers = range(NAMES if many else 2)
        if self.shape != "costly":
            behind = "?once=true" if path.endswith("/stop") else "?x=" + "x" * 15000 if self.shape == "large" and not body else ""
        if self.shape == "large" and body:
            body = "[" * 64000
        own = {"dashboard": "lab"} if self.role == "kiosk" else {}
        more = "If-Match: *\r\n" if method == "PUT" and self.shape == "costly" else ""
        return [self.request(method, filled(path, own, n, many) + behind, body, more) for n in numbers]

    def request(self, method, path, body="", more=""):
        token = self.place["tokens"].get(self.role, "")
        if self.role == "kiosk":
            path = f"/kiosk/{token}{path}"
        elif token:
            more += f"Authorization: Bearer {token}\r\n"
        host, port = self.place["http"]
        head = f"{method} {path} HTTP/1.1\r\nHost: {host}:{port}\r\n{more}"
        if method not in ("GET", "OPTIONS"):
            head += f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n"
        return (head + "\r\n" + (body if method not in ("GET", "OPTIONS") else "")).encode()

    def websocket(self):
        self.hello = self.request("GET", "/api/stream", more="Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                                  "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n")
        if self.shape == "small":
            return [frame('{"unsubscribe":1}')]
        if self.shape == "large":
            return [frame("[" * 65000)]
        what = (lambda n: f"load-{n}/distance") if self.shape == "many" else (lambda n: ("$catalogue", "*/*")[n % 2])
        return [frame(SUBSCRIBE % (what(n), n)) + frame('{"unsubscribe":%d}' % n) for n in range(NAMES)]

    def broker(self):
        if self.name == "connect":
            self.anew = True
            user = {"small": "eve", "large": "x" * 60000, "many": "eve", "costly": ""}[self.shape]
            return [connect(user, "wrong") if user else b"\0\0"]
        self.hello = connect(*self.place["users"]["eve"])
        wanted = {"small": "asip/servicebus/nobody/$state", "large": "asip/" + "x/" * 150 + "#", "many": "asip/load-%d/#", "costly": "asip/#"}
        filters = [wanted[self.shape] % n if self.shape == "many" else wanted[self.shape] for n in range(NAMES)]
        return [packet(0x82, b"\0\1" + text(each) + b"\1") + packet(0xA2, b"\0\2" + text(each)) for each in filters]

    def run(self, seconds):
        """Returns what was done."""
        begun = time.monotonic()
        self.end = begun + seconds
        threads = [threading.Thread(target=self.pour, daemon=True) for _ in range(self.connections)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        ended = time.monotonic()
        if self.goodbye:
            with contextlib.suppress(OSError), self.open() as connection:
                connection.settimeout(20)
                connection.sendall(self.goodbye + b"\xe0\0")
                while connection.recv(CHUNK):
                    pass
        return {"begun": begun, "ended": ended, "sent": self.sent, "opened": self.opened, "answers": self.answers, "heard": self.heard}

    def open(self):
        address = self.place["http" if self.kind == "http" else "broker"]
        connection = socket.create_connection(address, timeout=5, source_address=("127.0.0.9", 0))
        if self.kind == "http":
            return connection
        return ssl.create_default_context(cafile=self.place["ca"]).wrap_socket(connection, server_hostname=address[0])

    def going(self):
        """On a machine without time for it, until something was sent."""
        return time.monotonic() < self.end + (0 if self.sent else 20)

    def pour(self):
        while self.going():
            try:
                with self.open() as connection:
                    connection.setblocking(False)
                    self.pour_into(connection)
            except OSError:
                time.sleep(0.01)

    def pour_into(self, connection):
        number = self.opened = self.opened + 1
        waiting, answered = memoryview(self.hello + (self.chunks[number % len(self.chunks)] if self.anew else b"")), False
        while self.going() and not (self.anew and answered):
            blocked = 0
            try:
                data = connection.recv(CHUNK)
                if not data:
                    return
                self.heard = self.heard or repr(data[:400].split(b"\r\n")[0])
                self.answers += data.count(b"HTTP/1.1 " if self.kind == "http" else b"\x40\2")
                answered = True
            except (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError):
                blocked += 1
            if not waiting and not self.anew:
                waiting, number = memoryview(self.chunks[number % len(self.chunks)]), number + 1
            try:
                taken = connection.send(waiting[:CHUNK]) if waiting else 0
                waiting = waiting[taken:]
                self.sent += taken
                blocked += not taken
            except (BlockingIOError, ssl.SSLWantReadError, ssl.SSLWantWriteError):
                blocked += 1
            if blocked == 2:
                select.select([connection], [connection] if waiting else [], [], 0.05)


if __name__ == "__main__":
    what, place, seconds = json.load(sys.stdin)
    print(json.dumps(Flood(*what, place).run(seconds)))
