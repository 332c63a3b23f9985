# SPDX-License-Identifier: Apache-2.0
"""Brokers that are announced on the local network by multicast DNS (RFC 6762) as `_mqtt._tcp` (RFC 6763).

The packets are made and read by pure functions; `search()` asks on each network of this machine (IPv4).
"""
from __future__ import annotations

import contextlib
import errno
import os
import socket
import struct
import sys
import time
from typing import NamedTuple

_SERVICE = ("_mqtt", "_tcp", "local")
_GROUP, _PORT = "224.0.0.251", 5353
_A, _PTR, _SRV, _IN = 1, 12, 33, 1
_RESPONSE = 0x8000
_MAX_BROKERS = 32
_MAX_LABELS = 128           # of a name: also ends names that refer to themselves
_AFTER_FIRST_SECONDS = 0.3  # responders spread their answers over 120 ms


class Announced(NamedTuple):
    """`name` as its owner calls it; any text."""

    name: str
    host: str
    port: int


def question(id: int) -> bytes:
    """The question for brokers, as a packet."""
    labels = b"".join(bytes([len(label)]) + label.encode() for label in _SERVICE)
    return struct.pack("!6H", id, 0, 1, 0, 0, 0) + labels + b"\0" + struct.pack("!2H", _PTR, _IN)


def announced(packet: bytes, id: int, sender: str) -> "list[Announced]":
    """What an answer to the question with this id announces; none where the packet is no such answer. `sender`: address that it
    came from, for brokers whose own it leaves out."""
    try:
        return _read(packet, id, sender)
    except (struct.error, IndexError, UnicodeDecodeError):
        return []


def _read(packet: bytes, id: int, sender: str) -> "list[Announced]":
    its_id, flags, questions, answers, authorities, additional = struct.unpack_from("!6H", packet)
    if its_id != id or not flags & _RESPONSE:
        return []
    at = 12
    for _ in range(questions):
        at = _name(packet, at)[1] + 4
    instances: "list[tuple[str, ...]]" = []
    servers: "dict[tuple[str, ...], tuple[tuple[str, ...], int]]" = {}
    addresses: "dict[tuple[str, ...], str]" = {}
    for _ in range(answers + authorities + additional):
        owner, at = _name(packet, at)
        kind, _, _, size = struct.unpack_from("!2HIH", packet, at)
        at += 10
        data = packet[at:at + size]
        if kind == _PTR and _lower(owner) == _SERVICE:
            instances.append(_name(packet, at)[0])
        elif kind == _SRV and size > 6:
            servers[_lower(owner)] = _lower(_name(packet, at + 6)[0]), struct.unpack_from("!H", data, 4)[0]
        elif kind == _A and len(data) == 4:
            addresses[_lower(owner)] = socket.inet_ntoa(data)
        at += size
    found: "dict[tuple[str, int], Announced]" = {}
    for instance in instances:
        host, port = servers.get(_lower(instance), ((), 0))
        if port and instance:
            broker = Announced(instance[0], addresses.get(host, sender), port)
            found.setdefault((broker.host, broker.port), broker)
    return list(found.values())[:_MAX_BROKERS]


def _lower(name: "tuple[str, ...]") -> "tuple[str, ...]":
    return tuple(label.lower() for label in name)


def _name(packet: bytes, at: int) -> "tuple[tuple[str, ...], int]":
    """The labels of the name at `at`, which may refer to earlier parts of the packet, and where it ends."""
    labels: "list[str]" = []
    end = None
    for _ in range(_MAX_LABELS):
        size = packet[at]
        if size == 0:
            return tuple(labels), at + 1 if end is None else end
        if size >= 0xC0:
            end = at + 2 if end is None else end
            at = struct.unpack_from("!H", packet, at)[0] & 0x3FFF
            continue
        labels.append(packet[at + 1:at + 1 + size].decode("utf-8", "replace"))
        at += 1 + size
    raise IndexError("a name without end")


def search(seconds: float = 1.0) -> "list[Announced]":
    """Asks on each network, and collects answers for so long at most; a short time after the first one it ends."""
    id = struct.unpack("!H", os.urandom(2))[0]
    found: "dict[tuple[str, int], Announced]" = {}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asker:
        _ask_everywhere(asker, question(id))
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            asker.settimeout(left)
            try:
                packet, (host, port) = asker.recvfrom(9000)
            except OSError:
                break
            if port != _PORT:
                continue
            first = not found
            for broker in announced(packet, id, host):
                if len(found) < _MAX_BROKERS:
                    found.setdefault((broker.host, broker.port), broker)
            if first and found:
                end = min(end, time.monotonic() + _AFTER_FIRST_SECONDS)
    return sorted(found.values(), key=lambda one: (one.host, one.port))


def _ask_everywhere(asker: socket.socket, packet: bytes) -> None:
    with contextlib.suppress(OSError):
        asker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 255)
    for choice in _interfaces():
        with contextlib.suppress(OSError):  # a network that is down answers nothing
            if choice:
                asker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, choice)
            asker.sendto(packet, (_GROUP, _PORT))


def _interfaces() -> "list[bytes]":
    """Values of IP_MULTICAST_IF: each network of this machine; empty is the system's choice."""
    if sys.platform.startswith("linux"):  # ip_mreqn: group, address, index
        return [struct.pack("@4s4si", b"", b"", index) for index, _ in socket.if_nameindex()]
    with contextlib.suppress(OSError):
        return [b"", *(socket.inet_aton(address) for address in socket.gethostbyname_ex(socket.gethostname())[2])]
    return [b""]


def listens_here(port: int) -> bool:
    """Whether a program listens on this port of 127.0.0.1."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as binder:
        try:  # binding tells, without a connection that the broker would log
            binder.bind(("127.0.0.1", port))
        except OSError as fault:
            if fault.errno == errno.EADDRINUSE:
                return True
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as caller:
        caller.settimeout(0.1)
        return caller.connect_ex(("127.0.0.1", port)) == 0
