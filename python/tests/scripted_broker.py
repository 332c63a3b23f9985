# SPDX-License-Identifier: Apache-2.0
"""A broker on a TCP port that does what a test says: one function for each connection, in the order in which they come."""
import contextlib
import socket
import struct
import threading

CONNECT, CONNACK, PUBLISH, PUBACK, SUBSCRIBE, SUBACK, PINGREQ, PINGRESP, DISCONNECT = 1, 2, 3, 4, 8, 9, 12, 13, 14


class Connection:
    def __init__(self, sock):
        self.sock = sock
        self.file = sock.makefile("rb")
        self.version = 0

    def packet(self):
        """(kind, flags, body); EOFError where the client has gone."""
        first = self._read(1)[0]
        size, shift = 0, 0
        while True:
            byte = self._read(1)[0]
            size |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return first >> 4, first & 15, self._read(size)

    def _read(self, size):
        data = self.file.read(size)
        if len(data) < size:
            raise EOFError
        return data

    def send(self, kind, body, flags=0):
        size, left = b"", len(body)
        while True:
            left, digit = divmod(left, 128)
            size += bytes([digit | (128 if left else 0)])
            if not left:
                break
        self.sock.sendall(bytes([kind << 4 | flags]) + size + body)

    def connect(self):
        """Reads the client's first packet; `version` is 4 or 5 then."""
        kind, _, body = self.packet()
        assert kind == CONNECT, kind
        self.version = body[6]

    def accept(self):
        self.send(CONNACK, b"\0\0\0" if self.version == 5 else b"\0\0")

    def publish(self, topic, payload):
        name = topic.encode()
        self.send(PUBLISH, struct.pack("!H", len(name)) + name + (b"\0" if self.version == 5 else b"") + payload)

    def serve(self):
        """Accepts what comes, and sends back what the client publishes, until it has gone."""
        while True:
            kind, flags, body = self.packet()
            if kind == SUBSCRIBE:
                self.send(SUBACK, body[:2] + (b"\0" if self.version == 5 else b"") + b"\1" * self._filters(body))
            elif kind == PUBLISH:
                size = struct.unpack("!H", body[:2])[0]
                topic, rest = body[2:2 + size].decode(), body[2 + size:]
                if flags & 6:
                    self.send(PUBACK, rest[:2])
                    rest = rest[2:]
                if self.version == 5:
                    rest = rest[1 + rest[0]:]
                if "/$self/" in topic:
                    self.publish(topic, rest)
            elif kind == PINGREQ:
                self.send(PINGRESP, b"")
            elif kind == DISCONNECT:
                return

    def _filters(self, body):
        at, count = 2 + (1 if self.version == 5 else 0), 0
        while at < len(body):
            at += 2 + struct.unpack("!H", body[at:at + 2])[0] + 1
            count += 1
        return count


class ScriptedBroker:
    """`scripts`: what is done with each connection, the last one with all that follow."""

    def __init__(self, *scripts):
        self.scripts, self.versions, self.faults = scripts, [], []
        self._sockets = []
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        with contextlib.suppress(OSError):
            while True:
                sock, _ = self._listener.accept()
                self._sockets.append(sock)
                script = self.scripts[min(len(self._sockets), len(self.scripts)) - 1]
                threading.Thread(target=self._one, args=(sock, script), daemon=True).start()

    def _one(self, sock, script):
        connection = Connection(sock)
        try:
            connection.connect()
            self.versions.append(connection.version)
            script(connection)
        except (EOFError, OSError):
            pass
        except BaseException as fault:  # noqa: BLE001: told by the test
            self.faults.append(fault)
        finally:
            connection.file.close()
            sock.close()

    def close(self):
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        for sock in self._sockets:
            with contextlib.suppress(OSError):
                sock.shutdown(socket.SHUT_RDWR)
        self._thread.join(5)


def good(connection):
    connection.accept()
    connection.serve()
