# SPDX-License-Identifier: Apache-2.0
"""The calls of a program, each with one end, and the actions by which a session says what is to be done. Pure."""
from __future__ import annotations

import itertools
from concurrent.futures import Future

from . import _envelope, errors
from ._catalogue import Catalogue
from ._clock import Clocks
from ._entry import THERE
from ._topics import Topics

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable
    Sink = Callable[..., None]

ANSWER_GRACE = 0.5  # how long an answer may take behind the deadline that the agent was told
MAX_OPEN_CALLS = 4096


class Action:
    """What the engine does next. Those that say the same are equal."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.__dict__ == other.__dict__

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.__dict__})"


class Publish(Action):
    """`expiry`: seconds, for MQTT 5; `key` is given to denied() where the broker denies it."""

    def __init__(self, topic: str, payload: bytes, qos: int = 1, expiry: int | None = None, key: str | None = None):
        self.topic, self.payload, self.qos, self.expiry, self.key = topic, payload, qos, expiry, key


class Subscribe(Action):
    def __init__(self, topic: str, qos: int):
        self.topic, self.qos = topic, qos


class Unsubscribe(Action):
    def __init__(self, topic: str):
        self.topic = topic


class Resolve(Action):
    """`future` ends with `result`, or with the error."""

    def __init__(self, future: Future[Any], result: Any = None, error: errors.Error | None = None):
        self.future, self.result, self.error = future, result, error


class Tell(Action):
    """`sink` is called with `args`; it only puts something into a queue or sets an event."""

    def __init__(self, sink: Sink, args: tuple[Any, ...]):
        self.sink, self.args = sink, args


class Drop(Action):
    """The connection is of no use: close it, try the next broker. `why` is one sentence."""

    def __init__(self, why: str):
        self.why = why


class Call:
    """One request whose answer is awaited. `asked`: the board, or `registry`."""

    def __init__(self, id: str, topic: str, asked: str, members: dict[str, Any], deadline: float, *, service: str | None = None,
                 command: str | None = None, hold: float | None = None, is_command: bool = True, is_query: bool = False):
        self.id, self.topic, self.asked, self.members, self.deadline = id, topic, asked, members, deadline
        self.service, self.command, self.hold = service, command, hold
        self.is_command, self.is_query = is_command, is_query
        self.future: Future[Any] = Future()
        self.sent_at: float | None = None

    @property
    def names(self) -> dict[str, Any]:
        return {"board": self.asked, "service": self.service, "command": self.command}

    @property
    def what(self) -> str:
        return " ".join(filter(None, ["/".join(filter(None, [self.asked, self.service])), self.command]))

    def fails(self, kind: type[errors.Error], text: str, reason: str | None = None) -> Action:
        return Resolve(self.future, error=kind(f"{self.what}: {text}", reason=reason, **self.names))

    def unproven(self, reason: str) -> Action:
        return Resolve(self.future, error=errors.from_answer({"status": "timeout", "reason": reason}, **self.names))


class Calls:
    """`client` is a name that no other program has: calls are known by ids that begin with it. `by` is sent as the name of the sender,
    for people."""

    def __init__(self, topics: Topics, catalogue: Catalogue, clocks: Clocks, client: str, by: str | None):
        self._topics, self._catalogue, self._clocks, self._client, self._by = topics, catalogue, clocks, client, by
        self._count = itertools.count(1)
        self._waiting: dict[str, Call] = {}
        self._open: dict[str, Call] = {}

    def next_id(self) -> str:
        return f"{self._client}-{next(self._count)}"

    def begin(self, call: Call, now: float, ready: bool) -> list[Action]:
        """Until the bus is ready it waits."""
        if len(self._open) + len(self._waiting) >= MAX_OPEN_CALLS:
            return [call.fails(errors.Refused, f"{MAX_OPEN_CALLS} calls of this program wait already", "queue-full")]
        if ready:
            return self._send(call, now)
        self._waiting[call.id] = call
        return []

    def ready(self, now: float) -> list[Action]:
        waiting, self._waiting = list(self._waiting.values()), {}
        return [action for call in waiting for action in self._send(call, now)]

    def _send(self, call: Call, now: float) -> list[Action]:
        entry = self._catalogue.boards.get(call.asked)
        if entry is not None and not call.is_query and entry.state not in (*THERE, "unknown") and call.command != "stop":
            return [call.fails(errors.NotThere, f"{call.asked} is {entry.words(now)}; nothing was sent", "board-not-there")]
        left = call.deadline - now
        clock = self._clocks.reading(call.asked, now) if call.is_command and call.command != "stop" else None
        try:
            payload = _envelope.request_text(call.members, reply_to=self._topics.reply(call.asked), id=call.id,
                                             timeout=left if call.is_command else None, clock=clock,
                                             by=self._by if call.is_command else None, hold=call.hold)
        except (TypeError, ValueError, RecursionError) as fault:
            return [call.fails(errors.Invalid, f"it cannot be written as JSON: {fault}", "invalid")]
        if len(payload) > _envelope.MAX_REQUEST_BYTES:
            return [call.fails(errors.Invalid, f"{len(payload)} bytes are more than {_envelope.MAX_REQUEST_BYTES}")]
        call.sent_at = now
        self._open[call.id] = call
        return [Publish(call.topic, payload, 1, max(1, -int(-left // 1)), call.id)]

    def denied(self, key: str) -> list[Action]:
        """The broker did not take the request of a call."""
        call = self._open.pop(key, None)
        return [call.fails(errors.Refused, "the broker denies it to this user (see its access rules); nothing was sent", "denied")] if call else []

    def answered(self, topic: str, answer: dict[str, Any], now: float) -> list[Action]:
        id = answer.get("id")
        call = self._open.get(id) if isinstance(id, str) else None
        if call is None or topic != self._topics.reply(call.asked):
            return []
        del self._open[call.id]
        if call.is_query and "refused" in answer:
            kind = errors.Invalid if answer["refused"] == "invalid" else errors.Refused
            return [call.fails(kind, str(answer.get("error") or answer["refused"]), str(answer["refused"]))]
        if call.is_command:
            self._clocks.note(call.asked, answer.get("clock"), now if call.sent_at is None else call.sent_at, now)
        return [Resolve(call.future, answer, None if call.is_query else errors.from_answer(answer, **call.names))]

    def broken(self) -> list[Action]:
        """The connection is. What was sent may have been executed; what waits goes on waiting."""
        broken, self._open = list(self._open.values()), {}
        return [call.unproven("connection") for call in broken]

    def tick(self, now: float, trouble: str) -> tuple[list[Action], float]:
        """Those whose time is over, and when that of the next one is."""
        actions, due = [], now + 1.0
        for call in [*self._waiting.values()]:
            if now >= call.deadline:
                del self._waiting[call.id]
                actions.append(call.fails(errors.Disconnected, f"no broker: {trouble}; nothing was sent", "disconnected"))
            due = min(due, call.deadline)
        for call in [*self._open.values()]:
            if now >= call.deadline + ANSWER_GRACE:
                del self._open[call.id]
                actions.append(call.fails(errors.NotThere, "no registry answered; is asip-registry running on this bus?", "no-registry")
                               if call.is_query else call.unproven("no-answer"))
            due = min(due, call.deadline + ANSWER_GRACE)
        return actions, due

    def close(self, why: str) -> list[Action]:
        actions = [call.fails(errors.Closed, f"{why}; nothing was sent") for call in self._waiting.values()]
        actions += [call.fails(errors.Unproven, f"{why} before the answer came; it may or may not have been executed", "closed")
                    for call in self._open.values()]
        self._waiting, self._open = {}, {}
        return actions
