# SPDX-License-Identifier: Apache-2.0
"""One program's conversation with the bus as a pure machine: calls, messages and time go in, actions come out.

It knows no thread, no socket and no clock. Times are seconds of a monotonic clock that the caller reads. The engine performs
the actions in their order, on one connection at a time; a call that was sent on a connection that breaks ends as `Unproven`.
"""
from __future__ import annotations

from . import _envelope
from ._calls import ANSWER_GRACE, Action, Call, Calls, Drop, Publish, Subscribe, Tell, Unsubscribe
from ._catalogue import Catalogue
from ._clock import Clocks
from ._topics import Topics

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any
    from ._calls import Sink

HELLO_SECONDS = 5.0    # within what time a message to ourselves comes back
DEMAND_LEASE = 15      # seconds
MAX_REGISTRIES = 64


class Hold:
    """A command that is undone by the agent unless it is renewed."""

    def __init__(self, board: str, topic: str, id: str, seconds: float, next_renewal: float, feed: float | None = None, fed: float = 0.0,
                 lost: Sink | None = None):
        self.board, self.topic, self.id, self.seconds, self.next_renewal = board, topic, id, seconds, next_renewal
        self.feed, self.fed, self.lost = feed, fed, lost


class Session:
    """`client` and `by`: see Calls."""

    def __init__(self, topics: Topics, client: str, by: str | None = None):
        self.topics = topics
        self.catalogue = Catalogue()
        self.ready = False
        self.not_ready_since = 0.0
        self.registries: set[str] | None = None  # those that are online; None: it was not looked which
        self.kept_at = 0.0  # when something that the broker keeps of boards came last
        self.trouble = "not connected yet"
        self._connected = False
        self._v5 = True
        self._hello_due: float | None = None
        self._filters: dict[str, tuple[int, int]] = {}  # count of users, QoS
        self._values: dict[str, list[Sink]] = {}
        self._board_sinks: list[Sink] = []
        self._demands: dict[str, dict[int, tuple[str, float]]] = {}
        self._demanded_until: dict[str, float] = {}
        self._holds: dict[str, Hold] = {}
        self._clocks = Clocks()
        self.calls = Calls(topics, self.catalogue, self._clocks, client, by)

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
        return [Tell(hold.lost, ("the connection to the broker broke",)) for hold in lost if hold.lost] + self.calls.broken()

    # Calls --------------------------------------------------------------------------------------------------------------

    def command(self, now: float, board: str, service: str | None, command: str | None, members: dict[str, Any], timeout: float,
                hold: float | None = None) -> tuple[Call, list[Action]]:
        """`service` None: a request to the board itself (`raw`, labels)."""
        topic = self.topics.command(board, service) if service else self.topics.lines_in(board)
        return self._begin(now, topic, board, members, timeout, service=service, command=command, hold=hold)

    def stop(self, now: float, board: str, timeout: float, *, hold: bool = False, why: str = "") -> tuple[Call, list[Action]]:
        members: dict[str, Any] = ({"latch": True} if hold else {}) | ({"why": why} if why else {})
        return self._begin(now, self.topics.stop(board), board, members, timeout, command="stop")

    def link(self, now: float, board: str, members: dict[str, Any], timeout: float) -> tuple[Call, list[Action]]:
        return self._begin(now, self.topics.link(board), board, members, timeout, command="link")

    def query(self, now: float, members: dict[str, Any], timeout: float, registry: str = "") -> tuple[Call, list[Action]]:
        return self._begin(now, self.topics.query(registry), "registry", members, timeout, is_command=False, is_query=True)

    def question(self, now: float, board: str, service: str, timeout: float) -> tuple[Call, list[Action]]:
        """Asks a board's agent how the properties of a service stand; it ends within `timeout`."""
        return self._begin(now, self.topics.question(board), board, {"services": {service: 0}, "list": True}, timeout - ANSWER_GRACE, is_command=False)

    def mark(self, now: float, timeout: float) -> tuple[Call, list[Action]]:
        """Ends once what the broker had kept for the subscriptions before it has come, where it answers in order."""
        return self._begin(now, self.topics.own(), "$self", {}, timeout, is_command=False, is_query=True)

    def _begin(self, now: float, topic: str, asked: str, members: dict[str, Any], timeout: float, **more: Any) -> tuple[Call, list[Action]]:
        call = Call(self.calls.next_id(), topic, asked, members, now + timeout, **more)
        return call, self.calls.begin(call, now, self.ready)

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

    def look_at_registries(self) -> list[Action]:
        """From now on `registries` says which there are."""
        if self.registries is not None:
            return []
        self.registries = set()
        return self._want(self.topics.registries(), 1)

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
            return self._on_own(now) if topic == self.topics.own() and not self.ready else self._on_reply(topic, payload, now)
        if levels[0] == "servicebus" and len(levels) == 3:
            return self._on_board(levels[1], levels[2], payload, retained, expiry, now)
        if levels[0] == "registry" and levels[2:] == ["$state"]:
            self.kept_at = now
            if self.registries is not None:
                self.registries.discard(levels[1])
                self.registries.update([levels[1]] if payload == b"online" and len(self.registries) < MAX_REGISTRIES else [])
        return []

    def _on_own(self, now: float) -> list[Action]:
        if not self._connected:
            return []
        self.ready, self._hello_due, self.trouble = True, None, ""
        actions = self.calls.ready(now)
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
        return self.calls.answered(topic, answer, now)

    def _on_renewal(self, id: str, answer: dict[str, Any], topic: str) -> list[Action]:
        hold = self._holds.get(id)
        if hold is None or topic != self.topics.reply(hold.board) or answer.get("status") == "ok":
            return []
        if answer.get("reason") != "not-held":
            return []  # the next renewal may pass
        del self._holds[id]
        return [Tell(hold.lost, (str(answer.get("error") or "it is not held any more"),))] if hold.lost else []

    def _on_board(self, board: str, kind: str, payload: bytes, retained: bool, expiry: int | None, now: float) -> list[Action]:
        if retained:
            self.kept_at = now
        if self.topics.state(board) not in self._filters and self.topics.state("+") not in self._filters:
            return []  # it comes behind the end of its subscription
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
        actions, due = self.calls.tick(now, self.trouble)
        if self._hello_due is not None:
            if now >= self._hello_due:
                self._hello_due = None
                actions.append(Drop(f"the broker does not deliver {self.topics.own()} to us: its access rules keep answers from this user"))
            else:
                due = min(due, self._hello_due)
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

    def close(self, why: str = "the bus was closed") -> list[Action]:
        """Ends every call and every demand. What was sent may have been executed."""
        actions = self.calls.close(why)
        if self.ready:
            for board in list(self._demanded_until):
                actions.append(Publish(self.topics.demand(board), _envelope.demand_text({}, DEMAND_LEASE), 0))
        self._demanded_until.clear()
        self._holds.clear()
        return actions
