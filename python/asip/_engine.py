# SPDX-License-Identifier: Apache-2.0
"""Threads around a session: paho's own (one a connection) and `asip-clock`, which connects, keeps time and sends what is due.

Lock order: `_sending` before `_lock`. paho's thread takes `_lock` alone, for moments; nothing calls paho while it holds `_lock`.
What paho's thread finds to send is sent by `asip-clock`.
"""
from __future__ import annotations

import atexit
import collections
import logging
import os
import random
import threading
import time
import uuid
import weakref

from . import _wait, errors
from ._brokers import Brokers
from ._callbacks import Dispatcher
from ._faults import Faults
from ._paho import Link
from ._calls import Action, Call, Drop, Publish, Resolve, Subscribe, Tell, Unsubscribe
from ._session import Hold, Session
from ._topics import Topics
from .settings import Settings

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

log = logging.getLogger("asip")
ANSWER_SECONDS = 2.0  # a broker that did not answer by then may know no MQTT 5, or hang
READY_SECONDS = 11.0
_all: "weakref.WeakSet[Engine]" = weakref.WeakSet()


class Engine:
    """Owns the connection and the session of one bus. All methods may be called from any thread."""

    def __init__(self, settings: Settings, by: str | None = None, link: Callable[..., Any] = Link):
        self.settings = settings
        self._new_link = link
        self.client = f"python-{uuid.uuid4().hex[:12]}"
        self.session = Session(Topics(settings.root, settings.user, self.client), self.client, by)
        self.dispatcher = Dispatcher()
        self.changed = threading.Condition(threading.RLock())  # told after each change of a board, and at the end
        self.forked = False
        self.closed = False
        self._listeners: weakref.WeakSet[Any] = weakref.WeakSet()
        self._chores: "collections.deque[Callable[[], None]]" = collections.deque()
        self._lock = threading.RLock()
        self._sending = threading.RLock()
        self._link: Link | None = None
        self._late: "collections.deque[Action]" = collections.deque()
        self._late_links: "collections.deque[Link]" = collections.deque()
        self._wake = threading.Event()
        self._due = 0.0  # when `asip-clock` looks again, at the latest
        self._brokers = Brokers(settings.brokers)
        self._v5 = True  # of the present connection
        self._accepted = False
        self._link_began = 0.0
        self._not_before = 0.0
        self._replace: str | None = None
        self._faults = Faults()
        self.session.watch_boards(lambda _name: self._notify())
        _all.add(self)
        self._thread = threading.Thread(target=self._run, name="asip-clock", daemon=True)
        self._thread.start()

    # For callers --------------------------------------------------------------------------------------------------------

    @property
    def faults(self) -> int:
        """How many messages and other events raised here, and were dropped."""
        return self._faults.count

    def check_open(self) -> None:
        if self.forked:
            raise errors.Closed("this bus was opened before the process forked; connect in the child")
        if self.closed:
            raise errors.Closed("this bus is closed")

    def ask(self, begin: Callable[[Session, float], tuple[Call, list[Action]]]) -> Call:
        """Begins a call. Its future ends within its time limit, whatever happens."""
        self.check_open()
        with self._sending:
            with self._lock:
                call, actions = begin(self.session, time.monotonic())
                sooner = call.deadline < self._due
            self._perform(actions)
        if sooner:
            self._wake.set()
        return call

    def do(self, change: Callable[[Session, float], list[Action]]) -> None:
        """Changes the session (subscriptions, watches) and sends what that needs."""
        self.check_open()
        with self._sending:
            with self._lock:
                actions = change(self.session, time.monotonic())
            self._perform(actions)

    def peek(self, look: Callable[[Session], Any]) -> Any:
        """What `look` says of the session at this moment."""
        with self._lock:
            return look(self.session)

    def listen(self, listener: Any) -> None:
        """Its `_told()` is called after each change of a board, and at the end, as long as it lives."""
        with self._lock:
            self._listeners.add(listener)

    def later(self, chore: Callable[[], None]) -> None:
        """`asip-clock` runs it soon. May be called anywhere, also while garbage is collected."""
        self._chores.append(chore)
        self._wake.set()

    def _notify(self) -> None:
        with self._lock:
            listeners = list(self._listeners)
        with self.changed:
            self.changed.notify_all()
        for listener in listeners:
            listener._told()

    def keep_hold(self, hold: Hold) -> None:
        with self._lock:
            self.session.keep_hold(hold)
        self._wake.set()

    def stop(self, board: str, seconds: float, *, hold: bool = False, why: str = "") -> Call:
        return self.ask(lambda session, now: session.stop(now, board, seconds, hold=hold, why=why))

    def wait_connected(self, seconds: float) -> None:
        """Until a broker serves us; Disconnected, with the reason, after `seconds`."""
        with self.changed:
            _wait.until(self.changed, lambda: self.session.ready or self.closed, seconds)
        self.check_open()
        if not self.session.ready:
            raise errors.Disconnected(f"no broker within {seconds:g} s: {self.session.trouble} "
                                      f"({', '.join(f'{one.host}:{one.port}' for one in self.settings.brokers)}, from {self.settings.source})")

    def close(self, why: str = "the bus was closed") -> None:
        """Ends calls and demands, and the connection, within a second or two. May be called twice, and from a callback."""
        if self.forked:
            return
        with self._sending:
            with self._lock:
                if self.closed:
                    return
                actions = self.session.close(why)
                self.closed = True
            self._perform(actions)
            link, self._link = self._link, None
        self.dispatcher.close()
        self._wake.set()
        if link is not None:
            link.close()
        self._notify()
        if threading.current_thread() is not self._thread:
            self._thread.join(1.0)

    # What happens -------------------------------------------------------------------------------------------------------

    def _perform(self, actions: list[Action]) -> None:
        """With `_sending` held, by a caller's thread or `asip-clock`."""
        for action in actions:
            link = self._link
            if isinstance(action, Publish):
                if link is not None:
                    link.publish(action.topic, action.payload, action.qos, action.expiry, action.key)
            elif isinstance(action, Subscribe):
                if link is not None:
                    link.subscribe(action.topic, action.qos)
            elif isinstance(action, Unsubscribe):
                if link is not None:
                    link.unsubscribe(action.topic)
            elif isinstance(action, Drop):
                self._replace = action.why
            else:
                self._faults.tell([action])

    def _message(self, link: Link, topic: str, payload: bytes, retained: bool, expiry: int | None) -> None:
        """In paho's thread. Values, which come by the thousand, need nothing but to be told."""
        if self.session.is_value(topic):
            try:
                with self._lock:
                    if link is not self._link or self.closed:
                        return
                    actions = self.session.message(topic, payload, retained, expiry, time.monotonic())
            except Exception as fault:  # noqa: BLE001: whatever arrives, the thread that carries messages goes on
                self._faults.note(f"a message on {topic!r}", fault)
                return
            self._faults.tell(actions)
        else:
            self._happened(link, lambda now: self.session.message(topic, payload, retained, expiry, now))

    def _happened(self, link: Link, event: Callable[[float], list[Action]]) -> None:
        """In paho's thread: a message, or the beginning of a connection."""
        with self._lock:
            if link is not self._link or self.closed:
                return
            was_ready = self.session.ready
            try:
                actions = event(time.monotonic())
            except Exception as fault:  # noqa: BLE001: as above
                self._faults.note("a message", fault)
                return
            ready = self.session.ready
            sends = [action for action in actions if not isinstance(action, (Tell, Resolve))]
            if sends:
                self._late.extend(sends)
        self._faults.tell(actions)
        if sends:
            self._wake.set()
        if ready and not was_ready:
            self._brokers.served()
            self._notify()

    def _went_down(self, link: Link, why: str, how: str) -> None:
        with self._lock:
            if link is not self._link:
                return
            self._back_off(how)
            actions = self.session.disconnected(time.monotonic(), why)
            self._link = None
            self._late.clear()
        self._faults.tell(actions)
        log.info("asip: %s", why)
        # paho's thread cannot end itself: the clock's does.
        self._late_links.append(link)
        self._wake.set()

    def _back_off(self, how: str) -> None:
        self._accepted = False
        self._not_before = time.monotonic() + self._brokers.ended(how, self._v5, random.random())

    # The clock ----------------------------------------------------------------------------------------------------------

    def _run(self) -> None:
        _wait.forbid()
        while not self.closed:
            try:
                due = self._turn()
            except Exception as fault:  # noqa: BLE001: this thread keeps the connection up
                self._faults.note("a turn of the clock", fault)
                due = time.monotonic() + 0.1
            self._wake.wait(max(0.0, due - time.monotonic()))
            self._wake.clear()
        while self._late_links:
            self._late_links.popleft().close()

    def _turn(self) -> float:
        while self._chores:
            try:
                self._chores.popleft()()
            except Exception as fault:  # noqa: BLE001
                self._faults.note("a chore", fault)
        while self._late_links:
            self._late_links.popleft().close()
        with self._sending:
            with self._lock:
                now = time.monotonic()
                late = [*self._late]
                self._late.clear()
                actions, due = self.session.tick(now)
                self._due = due
            self._perform(late + actions)
        if self._replace is not None:
            why, self._replace = self._replace, None
            self._give_up(why, "other")
        if self._link is None and not self.closed:
            if time.monotonic() >= self._not_before:
                self._connect()
            due = min(due, self._not_before) if self._link is None else due
        elif not self.session.ready:
            limit = self._link_began + (READY_SECONDS if self._accepted else ANSWER_SECONDS)
            if time.monotonic() > limit:
                self._give_up("the broker does not answer", "other" if self._accepted else "silent")
                return self._not_before
            due = min(due, limit + 0.01)
        return due

    def _connect(self) -> None:
        broker = self._brokers.current
        v5 = self._v5 = self._brokers.v5
        # The identifier on the wire is published nowhere: no other client can take the connection over.
        client_id = f"asip-python-{uuid.uuid4().hex}"
        try:
            link: Link = self._new_link(broker, self.settings, client_id, v5, lambda is_v5: self._happened(link, lambda now: self._up(now, is_v5)),
                                        lambda why, how: self._went_down(link, why, how), lambda *message: self._message(link, *message),
                                        lambda key: self._happened(link, lambda now: self.session.calls.denied(key)))
            with self._lock:
                if self.closed:
                    return
                self._link = link
                self._link_began = float("inf")
            link.start()
            self._link_began = time.monotonic()
        except Exception as fault:  # noqa: BLE001: sockets, TLS and paho raise many kinds
            with self._lock:
                self._link = None
                self._back_off("other")
                self.session.trouble = f"{broker.host}:{broker.port}: {fault}"

    def _up(self, now: float, v5: bool) -> list[Action]:
        self._accepted = True
        self._brokers.accepted()
        return self.session.connected(now, v5)

    def _give_up(self, why: str, how: str) -> None:
        with self._lock:
            link, self._link = self._link, None
            self._back_off(how)
            actions = self.session.disconnected(time.monotonic(), why)
        self._faults.tell(actions)
        log.warning("asip: %s", why)
        if link is not None:
            link.close()


def _close_all() -> None:
    for engine in list(_all):
        engine.close("Python ends")


def _forked() -> None:
    for engine in list(_all):
        engine.forked = True


atexit.register(_close_all)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)
