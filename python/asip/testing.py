# SPDX-License-Identifier: Apache-2.0
"""A bus in memory and boards made of service models, so that programs are tested without a broker and without hardware.

    from asip import testing

    def test_lamp():
        with testing.MemoryBus(desk=["io", "distance"]) as memory:
            my_program(memory.connect())             # an asip.Bus like any other
            memory.desk.report("distance", [42, 0])
            assert memory.desk.commands[-1] == ("io", "write", [13, 1])
"""
from __future__ import annotations

import fnmatch
import json
import queue
import threading
import time
from typing import Any, Callable, Sequence

from . import _wait
from ._fake_board import FakeBoard
from .bus import Bus
from .settings import Settings


class MemoryBus:
    """A bus without a broker. Each keyword is a board: its name, and its services (names of standard ones, or models)."""

    def __init__(self, **boards: Sequence["str | dict[str, Any]"]):
        self._lock = threading.RLock()
        self._retained: dict[str, bytes] = {}
        self._links: list[_MemoryLink] = []
        self._buses: list[Bus] = []
        self.registry_models: list[dict[str, Any]] = []
        """Service models that its registry tells, beside those that boards carry."""
        self.kept: dict[str, list[Any]] = {}
        """Points that its registry kept, by BOARD/PROPERTY: `[["2026-01-31T12:00:00.000Z", 42]]`."""
        self.boards = {name: FakeBoard(self._publish, name, services) for name, services in boards.items()}
        for board in self.boards.values():
            board._announce()
            board._tell()

    def connect(self, *, timeout: float = 1.0, by: str | None = None) -> Bus:
        """A bus of this memory; the MemoryBus closes it."""
        bus = Bus(Settings(source="asip.testing"), timeout=timeout, by=by, link=lambda *args: _MemoryLink(self, *args))
        self._buses.append(bus)
        bus._engine.wait_connected(timeout)
        return bus

    def cut(self) -> None:
        """Breaks every connection, as a broker that is restarted does. Programs come back by themselves."""
        with self._lock:
            links = list(self._links)
        for link in links:
            link.end("the connection was cut")

    def close(self) -> None:
        for bus in self._buses:
            bus.close()

    def __enter__(self) -> "MemoryBus":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __getattr__(self, name: str) -> FakeBoard:
        try:
            board: FakeBoard = self.__dict__["boards"][name]
            return board
        except KeyError:
            raise AttributeError(name) from None

    def _publish(self, topic: str, content: Any, retained: bool = False) -> None:
        payload = content.encode() if isinstance(content, str) else json.dumps(content).encode()
        topic = "asip/" + topic
        with self._lock:
            if retained:
                self._retained[topic] = payload
            links = list(self._links)
        for link in links:
            link.offer(topic, payload, False)

    def _received(self, topic: str, payload: bytes) -> None:
        levels = topic.split("/")[1:]
        if levels[0] == "reply":
            self._publish("/".join(levels), payload.decode())
            return
        if levels == ["registry", "query"]:
            self._asked(json.loads(payload))
            return
        if levels[0] == "servicebus" and levels[1] in self.boards and levels[2] == "$demand" and payload:
            demand = json.loads(payload)
            with self._lock:
                told = self.boards[levels[1]]._questioned([name for name, hz in demand["services"].items() if hz == 0]) if "reply_to" in demand else None
            if told is not None:
                self._publish(demand["reply_to"].split("/", 1)[1], {**told, "id": demand["id"]})
            return
        board = self.boards.get(levels[0])
        if board is None or levels[-1] not in ("in", "$stop"):
            return
        request = json.loads(payload)
        with self._lock:
            answer = {"status": "ok", "proof": "fence"} if levels[-1] == "$stop" else board._asked(levels[1] if len(levels) == 3 else None, request)
        if levels[-1] == "$stop":
            board.commands.append(("", "stop", []))
            board.stopped = board.stopped or request.get("latch") is True
        if answer is not None and "reply_to" in request:
            self._publish(request["reply_to"].split("/", 1)[1], {**answer, "id": request["id"]})

    def _asked(self, query: dict[str, Any]) -> None:
        """Answers as a registry does: boards and models. Labels and other filters are not there."""
        answer: dict[str, Any] = {"id": query.get("id"), "registry": "memory", "find": query.get("find"), "items": []}
        if query.get("find") == "values":
            items = self.kept.get(f"{query['board']}/{query['property']}", [])
            answer.update(items=items, **({"level": "changes"} if items else {}))
        elif set(query) - {"find", "id", "reply_to", "board", "kind", "full", "limit"} or query.get("find") not in ("boards", "models"):
            answer.update(refused="invalid", error="the registry of asip.testing knows boards by name, and models by kind")
        elif query["find"] == "boards":
            for topic, payload in sorted(self._retained.items()):
                name = topic.split("/")[-2]
                if topic.endswith("/$description") and fnmatch.fnmatchcase(name, query.get("board", "*")):
                    state = self._retained[f"asip/servicebus/{name}/$state"].decode()
                    answer["items"].append({"board": name, "state": state, "description": json.loads(payload)})
        else:
            answer["items"] = [model for model in self.registry_models if model["name"] in query.get("kind", [model["name"]])]
        self._publish(query["reply_to"].split("/", 1)[1], answer)


class _MemoryLink:
    """What asip._paho.Link is for a broker."""

    def __init__(self, memory: MemoryBus, _broker: Any, _settings: Any, _client_id: str, _v5: bool, on_up: Callable[[bool], None],
                 on_down: Callable[[str, str], None], on_message: Callable[[str, bytes, bool, "int | None"], None],
                 _on_denied: Callable[[str], None]):
        self._memory, self._on_up, self._on_down, self._on_message = memory, on_up, on_down, on_message
        self._filters: set[str] = set()
        self._work: "queue.Queue[Callable[[], None] | None]" = queue.Queue()
        self._thread = threading.Thread(target=self._run, name="asip-link", daemon=True)

    def start(self) -> None:
        with self._memory._lock:
            self._memory._links.append(self)
        self._work.put(lambda: self._on_up(True))
        self._thread.start()

    def publish(self, topic: str, payload: bytes, _qos: int, _expiry: int | None, _key: str | None = None) -> None:
        self._work.put(lambda: self._memory._received(topic, payload))

    def subscribe(self, topic: str, _qos: int) -> None:
        self._filters.add(topic)
        with self._memory._lock:
            kept = [(name, payload) for name, payload in self._memory._retained.items() if _matches(topic, name)]
        for name, payload in kept:
            self._work.put(lambda name=name, payload=payload: self._on_message(name, payload, True, None))  # type: ignore[misc]

    def unsubscribe(self, topic: str) -> None:
        self._filters.discard(topic)

    def offer(self, topic: str, payload: bytes, retained: bool) -> None:
        if any(_matches(one, topic) for one in list(self._filters)):
            self._work.put(lambda: self._on_message(topic, payload, retained, None))

    def end(self, why: str) -> None:
        self._leave()
        self._on_down(why, "other")

    def close(self) -> None:
        self._leave()
        self._work.put(None)
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(1.0)

    def _leave(self) -> None:
        with self._memory._lock:
            if self in self._memory._links:
                self._memory._links.remove(self)

    def _run(self) -> None:
        _wait.forbid()
        while True:
            work = self._work.get()
            if work is None:
                return
            work()


def _matches(pattern: str, topic: str) -> bool:
    wanted, given = pattern.split("/"), topic.split("/")
    return len(wanted) == len(given) and all(one in ("+", other) for one, other in zip(wanted, given))


def eventually(condition: Callable[[], Any], seconds: float = 5.0) -> Any:
    """The first true value of `condition`; AssertionError where there is none within `seconds`."""
    end = time.monotonic() + seconds
    while True:
        value = condition()
        if value or time.monotonic() > end:
            assert value, f"not true within {seconds:g} s"
            return value
        time.sleep(0.01)


__all__ = ["FakeBoard", "MemoryBus", "eventually"]
