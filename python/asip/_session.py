# SPDX-License-Identifier: Apache-2.0
"""One program's conversation with the bus as a pure machine: calls, messages and time go in, actions come out.

It knows no thread, no socket and no clock. Times are seconds of a monotonic clock that the caller reads. The engine performs
the actions in their order, on one connection at a time; a call that was sent on a connection that breaks ends as `Unproven`.
"""
from __future__ import annotations

import itertools
from concurrent.futures import Future
from typing import Any, Callable, NamedTuple, Union

from . import _envelope, errors
from ._catalogue import Catalogue
from ._clock import Clocks
from ._entry import THERE
from ._topics import Topics

ANSWER_GRACE = 0.5     # how long an answer may take behind the deadline that the agent was told
HELLO_SECONDS = 5.0    # within what time a message to ourselves comes back
DEMAND_LEASE = 15      # seconds
MAX_OPEN_CALLS = 4096
Sink = Callable[..., None]


class Publish(NamedTuple):
    topic: str
    payload: bytes
    qos: int = 1
    expiry: int | None = None  # seconds, for MQTT 5
    key: str | None = None     # given to denied() where the broker denies it


class Subscribe(NamedTuple):
    topic: str
    qos: int


class Unsubscribe(NamedTuple):
    topic: str


class Resolve(NamedTuple):
    """`future` ends with `result`, or with the error."""

    future: "Future[Any]"
    result: Any = None
    error: errors.Error | None = None


class Tell(NamedTuple):
    """`sink` is called with `args`; it only puts something into a queue or sets an event."""

    sink: Sink
    args: tuple[Any, ...]


class Drop(NamedTuple):
    """The connection is of no use: close it, try the next broker. `why` is one sentence."""

    why: str


Action = Union[Publish, Subscribe, Unsubscribe, Resolve, Tell, Drop]


class Call:
    """One request whose answer is awaited. `asked`: the board, or `registry`."""

    def __init__(self, id: str, topic: str, asked: str, members: dict[str, Any], deadline: float, *, service: str | None = None,
                 command: str | None = None, hold: float | None = None, is_command: bool = True, is_query: bool = False):
        self.id, self.topic, self.asked, self.members, self.deadline = id, topic, asked, members, deadline
        self.service, self.command, self.hold = service, command, hold
        self.is_command, self.is_query = is_command, is_query
        self.future: "Future[Any]" = Future()
        self.sent_at: float | None = None

    @property
    def names(self) -> dict[str, Any]:
        return {"board": self.asked, "service": self.service, "command": self.command}

    @property
    def what(self) -> str:
        return " ".join(filter(None, ["/".join(filter(None, [self.asked, self.service])), self.command]))


class Hold:
    """A command that is undone by the agent unless it is renewed."""

    def __init__(self, board: str, topic: str, id: str, seconds: float, next_renewal: float, feed: float | None = None, fed: float = 0.0,
                 lost: Sink | None = None):
        self.board, self.topic, self.id, self.seconds, self.next_renewal = board, topic, id, seconds, next_renewal
        self.feed, self.fed, self.lost = feed, fed, lost


class Session:
    """`client` is a name that no other program has: calls are known by ids that begin with it. `by` is sent as the name of
    the sender, for people."""

    def __init__(self, topics: Topics, client: str, by: str | None = None):
        self.topics = topics
        self.catalogue = Catalogue()
        self.ready = False
        self.not_ready_since = 0.0
        self.trouble = "not connected yet"
        self._client = client
        self._by = by
        self._count = itertools.count(1)
        self._connected = False
        self._v5 = True
        self._hello_due: float | None = None
        self._waiting: dict[str, Call] = {}
        self._open: dict[str, Call] = {}
        self._filters: dict[str, tuple[int, int]] = {}  # count of users, QoS
        self._values: dict[str, list[Sink]] = {}
        self._board_sinks: list[Sink] = []
        self._demands: dict[str, dict[int, tuple[str, float]]] = {}
        self._demanded_until: dict[str, float] = {}
        self._holds: dict[str, Hold] = {}
        self._clocks = Clocks()

    # The connection ----------------------------------------------------------------------------------------------------

    def connected(self, now: float, v5: bool) -> list[Action]:
        """The broker let us in. Nothing is sent for calls until a message to ourselves has come back: access rules may
        keep answers from us without a word."""
        self._connected, self._v5, self.ready = True, v5, False
        self.catalogue.connected(now)
        self._hello_due = now + HELLO_SECONDS
        actions: list[Action] = [Subscribe(self.topics.replies(), 1)]
        actions += [Subscribe(topic, qos) for topic, (_, qos) in self._filters.items()]
        return actions + [Publish(self.topics.own(), b"hello", 1)]

    def disconnected(self, now: float, why: str) -> list[Action]:
        self._connected = self.ready = False
        self.catalogue.disconnected(now)
        self._hello_due = None
        self.not_ready_since = now
        self.trouble = why
        self._demanded_until.clear()
        lost, self._holds = list(self._holds.values()), {}
        broken, self._open = list(self._open.values()), {}
        actions: list[Action] = [Tell(hold.lost, ("the connection to the broker broke",)) for hold in lost if hold.lost]
        return actions + [self._unproven(call, "connection") for call in broken]

    # Calls --------------------------------------------------------------------------------------------------------------

    def command(self, now: float, board: str, service: str | None, command: str | None, members: dict[str, Any], timeout: float,
                hold: float | None = None) -> tuple[Call, list[Action]]:
        """`service` None: a request to the board itself (`raw`, labels)."""
        topic = self.topics.command(board, service) if service else self.topics.lines_in(board)
        return self._begin(Call(self._next_id(), topic, board, members, now + timeout, service=service, command=command, hold=hold), now)

    def stop(self, now: float, board: str, timeout: float, *, hold: bool = False, why: str = "") -> tuple[Call, list[Action]]:
        members: dict[str, Any] = ({"latch": True} if hold else {}) | ({"why": why} if why else {})
        return self._begin(Call(self._next_id(), self.topics.stop(board), board, members, now + timeout, command="stop"), now)

    def query(self, now: float, members: dict[str, Any], timeout: float) -> tuple[Call, list[Action]]:
        return self._begin(Call(self._next_id(), self.topics.query(), "registry", members, now + timeout, is_command=False, is_query=True), now)

    def question(self, now: float, board: str, service: str, timeout: float) -> tuple[Call, list[Action]]:
        """Asks a board's agent how the properties of a service stand; it ends within `timeout`."""
        members = {"services": {service: 0}, "list": True}
        return self._begin(Call(self._next_id(), self.topics.question(board), board, members, now + timeout - ANSWER_GRACE, is_command=False), now)

    def _next_id(self) -> str:
        return f"{self._client}-{next(self._count)}"

    def _begin(self, call: Call, now: float) -> tuple[Call, list[Action]]:
        if len(self._open) + len(self._waiting) >= MAX_OPEN_CALLS:
            error = errors.Refused(f"{call.what}: {MAX_OPEN_CALLS} calls of this program wait already", reason="queue-full", **call.names)
            return call, [self._fail(call, error)]
        if not self.ready:
            self._waiting[call.id] = call
            return call, []
        return call, self._send(call, now)

    def _send(self, call: Call, now: float) -> list[Action]:
        entry = self.catalogue.boards.get(call.asked)
        if entry is not None and not call.is_query and entry.state not in (*THERE, "unknown") and call.command != "stop":
            return [self._fail(call, errors.NotThere(f"{call.what}: {call.asked} is {entry.words(now)}; nothing was sent",
                                                     reason="board-not-there", **call.names))]
        left = call.deadline - now
        clock = self._clocks.reading(call.asked, now) if call.is_command and call.command != "stop" else None
        try:
            payload = _envelope.request_text(call.members, reply_to=self.topics.reply(call.asked), id=call.id,
                                             timeout=left if call.is_command else None, clock=clock,
                                             by=self._by if call.is_command else None, hold=call.hold)
        except (TypeError, ValueError, RecursionError) as fault:
            return [self._fail(call, errors.Invalid(f"{call.what}: it cannot be written as JSON: {fault}", reason="invalid", **call.names))]
        if len(payload) > _envelope.MAX_REQUEST_BYTES:
            return [self._fail(call, errors.Invalid(f"{call.what}: {len(payload)} bytes are more than {_envelope.MAX_REQUEST_BYTES}", **call.names))]
        call.sent_at = now
        self._open[call.id] = call
        return [Publish(call.topic, payload, 1, max(1, -int(-left // 1)), call.id)]

    @staticmethod
    def _fail(call: Call, error: errors.Error) -> Action:
        return Resolve(call.future, error=error)

    def denied(self, key: str) -> list[Action]:
        """The broker did not take the request of a call."""
        call = self._open.pop(key, None)
        if call is None:
            return []
        return [self._fail(call, errors.Refused(f"{call.what}: the broker denies it to this user (see its access rules); nothing was sent",
                                                reason="denied", **call.names))]

    # Subscriptions ------------------------------------------------------------------------------------------------------

    def _want(self, topic: str, qos: int) -> list[Action]:
        count, old = self._filters.get(topic, (0, qos))
        self._filters[topic] = (count + 1, old)
        return [Subscribe(topic, qos)] if self._connected and count == 0 else []

    def _leave(self, topic: str) -> list[Action]:
        count, qos = self._filters.get(topic, (0, 0))
        if count > 1:
            self._filters[topic] = (count - 1, qos)
            return []
        self._filters.pop(topic, None)
        return [Unsubscribe(topic)] if self._connected and count == 1 else []

    def look_at(self, board: str) -> list[Action]:
        """From now on the catalogue follows this board; `+` is all of them."""
        return self._want(self.topics.description(board), 1) + self._want(self.topics.state(board), 1)

    def look_away(self, board: str) -> list[Action]:
        actions = self._leave(self.topics.state(board)) + self._leave(self.topics.description(board))
        if self.topics.state("+") not in self._filters:
            self.catalogue.look_away(lambda name: self.topics.state(name) in self._filters)
        return actions

    def watch_boards(self, sink: Sink) -> None:
        """`sink(name)` after each change of a board that is looked at."""
        self._board_sinks.append(sink)

    def unwatch_boards(self, sink: Sink) -> None:
        if sink in self._board_sinks:
            self._board_sinks.remove(sink)

    def watch(self, now: float, board: str, service: str, sink: Sink, hz: float) -> list[Action]:
        """`sink(payload, now, stored)` for each report of the service; of a board that reports on demand `hz` values a second are
        demanded."""
        topic = self.topics.event(board, service)
        self._values.setdefault(topic, []).append(sink)
        self._demands.setdefault(board, {})[id(sink)] = (service, hz)
        return self._want(topic, 0) + self._demand(board, now)

    def watch_topic(self, topic: str, sink: Sink) -> list[Action]:
        """`sink(payload, now, stored)` for each document there, the stored one first; without members where it was cleared."""
        self._values.setdefault(topic, []).append(sink)
        return self._want(topic, 1)

    def unwatch(self, now: float, board: str, service: str, sink: Sink) -> list[Action]:
        topic = self.topics.event(board, service)
        sinks = self._values.get(topic, [])
        if sink not in sinks:
            return []
        sinks.remove(sink)
        if not sinks:
            del self._values[topic]
        self._demands.get(board, {}).pop(id(sink), None)
        return self._leave(topic) + self._demand(board, now)

    def _demand(self, board: str, now: float) -> list[Action]:
        """Says what is wanted of this board, where it reports on demand."""
        entry = self.catalogue.boards.get(board)
        if not self.ready or entry is None or not isinstance(entry.description.get("on_demand"), dict):
            return []
        services: dict[str, float] = {}
        for service, hz in self._demands.get(board, {}).values():
            services[service] = max(hz, services.get(service, 0))
        if not services and board not in self._demanded_until:
            return []
        if services:
            self._demanded_until[board] = now + DEMAND_LEASE
        else:
            del self._demanded_until[board]
            self._demands.pop(board, None)
        return [Publish(self.topics.demand(board), _envelope.demand_text(services, DEMAND_LEASE), 1, DEMAND_LEASE)]

    # Holds --------------------------------------------------------------------------------------------------------------

    def keep_hold(self, hold: Hold) -> None:
        self._holds[hold.id] = hold

    def end_hold(self, id: str) -> None:
        self._holds.pop(id, None)

    def feed(self, id: str, now: float) -> None:
        if id in self._holds:
            self._holds[id].fed = now

    def _renew(self, hold: Hold, now: float) -> list[Action]:
        hold.next_renewal = now + hold.seconds / 3
        if hold.feed is not None and now - hold.fed > hold.feed:
            return []
        answer_id = f"{hold.id}/renewal"
        payload = _envelope.request_text({"renew": hold.id}, reply_to=self.topics.reply(hold.board), id=answer_id, hold=hold.seconds,
                                         clock=self._clocks.reading(hold.board, now))
        return [Publish(hold.topic, payload, 0, 1)]

    # Messages and time --------------------------------------------------------------------------------------------------

    def is_value(self, topic: str) -> bool:
        """Whether reports of a service that is watched, or how a board stands, come on this topic."""
        return topic in self._values

    def message(self, topic: str, payload: bytes, retained: bool, expiry: int | None, now: float) -> list[Action]:
        sinks = self._values.get(topic)
        if sinks is not None:
            value = _envelope.read_object(payload) if payload else {}
            return [] if value is None else [Tell(sink, (value, now, retained)) for sink in sinks]
        levels = self.topics.split(topic)
        if levels is None:
            return []
        if levels[0] == "reply":
            return self._on_own(now) if topic == self.topics.own() else self._on_reply(topic, payload, now)
        if levels[0] == "servicebus" and len(levels) == 3:
            return self._on_board(levels[1], levels[2], payload, retained, expiry, now)
        return []

    def _on_own(self, now: float) -> list[Action]:
        if self.ready or not self._connected:
            return []
        self.ready, self._hello_due, self.trouble = True, None, ""
        actions: list[Action] = []
        waiting, self._waiting = list(self._waiting.values()), {}
        for call in waiting:
            actions += self._send(call, now)
        for board in list(self._demands):
            actions += self._demand(board, now)
        return actions

    def _on_reply(self, topic: str, payload: bytes, now: float) -> list[Action]:
        answer = _envelope.read_object(payload)
        if answer is None:
            return []
        id = answer.get("id")
        if isinstance(id, str) and id.endswith("/renewal"):
            return self._on_renewal(id[:-len("/renewal")], answer, topic)
        call = self._open.get(id) if isinstance(id, str) else None
        if call is None or topic != self.topics.reply(call.asked):
            return []
        del self._open[call.id]
        if call.is_query:
            if "refused" in answer:
                kind = errors.Invalid if answer["refused"] == "invalid" else errors.Refused
                return [self._fail(call, kind(f"registry: {answer.get('error') or answer['refused']}", reason=str(answer["refused"]), **call.names))]
            return [Resolve(call.future, answer)]
        if call.is_command:
            self._clocks.note(call.asked, answer.get("clock"), now if call.sent_at is None else call.sent_at, now)
        error = errors.from_answer(answer, **call.names)
        return [Resolve(call.future, answer, error)]

    def _on_renewal(self, id: str, answer: dict[str, Any], topic: str) -> list[Action]:
        hold = self._holds.get(id)
        if hold is None or topic != self.topics.reply(hold.board) or answer.get("status") == "ok":
            return []
        if answer.get("reason") != "not-held":
            return []  # the next renewal may pass
        del self._holds[id]
        return [Tell(hold.lost, (str(answer.get("error") or "it is not held any more"),))] if hold.lost else []

    def _on_board(self, board: str, kind: str, payload: bytes, retained: bool, expiry: int | None, now: float) -> list[Action]:
        if kind == "$state":
            changed = self.catalogue.on_state(board, payload, retained, expiry, now)
        elif kind == "$description":
            changed = self.catalogue.on_description(board, _envelope.read_object(payload, 1 << 16), retained, expiry, now)
        else:
            return []
        if not changed:
            return []
        actions = self._demand(board, now) if self._demands.get(board) else []
        return actions + [Tell(sink, (board,)) for sink in list(self._board_sinks)]

    def tick(self, now: float) -> tuple[list[Action], float]:
        """What is due at `now`, and when the next thing is due, at the latest."""
        actions: list[Action] = []
        due = now + 1.0
        if self._hello_due is not None:
            if now >= self._hello_due:
                self._hello_due = None
                actions.append(Drop(f"the broker does not deliver {self.topics.own()} to us: its access rules keep answers from this user"))
            else:
                due = min(due, self._hello_due)
        for call in [*self._waiting.values()]:
            if now >= call.deadline:
                del self._waiting[call.id]
                actions.append(self._fail(call, errors.Disconnected(f"{call.what}: no broker: {self.trouble}; nothing was sent", reason="disconnected", **call.names)))
            due = min(due, call.deadline)
        for call in [*self._open.values()]:
            if now >= call.deadline + ANSWER_GRACE:
                del self._open[call.id]
                actions.append(self._unanswered(call))
            due = min(due, call.deadline + ANSWER_GRACE)
        if self.ready:
            for hold in [*self._holds.values()]:
                if now >= hold.next_renewal:
                    actions += self._renew(hold, now)
                due = min(due, hold.next_renewal)
            for board, until in [*self._demanded_until.items()]:
                if now >= until - DEMAND_LEASE * 2 / 3:
                    actions += self._demand(board, now)
                due = min(due, until - DEMAND_LEASE * 2 / 3)
        for board in self.catalogue.expire(now):
            actions += [Tell(sink, (board,)) for sink in list(self._board_sinks)]
        expiry = self.catalogue.next_expiry() if self._connected else None
        return actions, max(now + 0.001, min(due, expiry if expiry is not None else due))

    def _unanswered(self, call: Call) -> Action:
        if call.is_query:
            return self._fail(call, errors.NotThere("no registry answered; is asip-registry running on this bus?", reason="no-registry", **call.names))
        return self._unproven(call, "no-answer")

    @staticmethod
    def _unproven(call: Call, reason: str) -> Action:
        return Resolve(call.future, error=errors.from_answer({"status": "timeout", "reason": reason}, **call.names))

    def close(self, why: str = "the bus was closed") -> list[Action]:
        """Ends every call and every demand. What was sent may have been executed."""
        actions: list[Action] = []
        for call in [*self._waiting.values()]:
            actions.append(self._fail(call, errors.Closed(f"{call.what}: {why}; nothing was sent", **call.names)))
        for call in [*self._open.values()]:
            actions.append(self._fail(call, errors.Unproven(f"{call.what}: {why} before the answer came; it may or may not have been executed",
                                                            reason="closed", **call.names)))
        self._waiting, self._open = {}, {}
        if self.ready:
            for board in list(self._demanded_until):
                actions.append(Publish(self.topics.demand(board), _envelope.demand_text({}, DEMAND_LEASE), 0))
        self._demanded_until.clear()
        self._holds.clear()
        return actions
