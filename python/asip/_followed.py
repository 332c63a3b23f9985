# SPDX-License-Identifier: Apache-2.0
"""A board as this program follows it: what it is called, its state, and what its agent described. `asip.Board` adds what one does with it."""
from __future__ import annotations

import time

from . import _model, _wait, errors
from ._engine import Engine
from ._entry import STATES, THERE, Entry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol, Sequence

    class Home(Protocol):
        """The bus of a board."""

        timeout: float
        _engine: Engine
        _models: dict[str, _model.Model]

        def query(self, query: dict[str, Any], *, timeout: float | None = None) -> dict[str, Any]: ...
        def _wait_told(self, seconds: float, what: str) -> None: ...


class Followed:
    if TYPE_CHECKING:
        @property
        def properties(self) -> Sequence[Any]: ...

    def __init__(self, bus: Home, name: str):
        self.name = name
        self.bus = bus
        self._engine = bus._engine
        self._followed = False

    def _entry(self) -> Entry | None:
        entry: Entry | None = self._engine.peek(lambda session: session.catalogue.boards.get(self.name))
        return entry

    def _unheard_since(self) -> float | None:
        since: float | None = self._engine.peek(lambda session: session.catalogue.unheard_since)
        return since

    def _follow(self) -> None:
        if not self._followed:
            self._followed = True
            self._engine.do(lambda session, now: session.look_at(self.name))

    @property
    def state(self) -> str:
        """`online`, `sleeping`, `updating`, `offline`, `lost`, or `unknown` while nothing was heard of it, or the broker is not heard."""
        entry = self._entry()
        return entry.state if entry and self._unheard_since() is None else "unknown"

    @property
    def reason(self) -> str:
        """Why it is in its state: `unplugged`, `silent`, `agent-gone`, `expired`, `released`, `stopped`, `conflict`, `latched`, or empty."""
        entry = self._entry()
        return entry.reason if entry and self._unheard_since() is None else ""

    @property
    def status(self) -> str:
        """State, since when and why, for people: `lost 3 min ago: cable unplugged`."""
        entry, unheard, now = self._entry(), self._unheard_since(), time.monotonic()
        if entry is None:
            return "unknown"
        if unheard is None:
            return entry.words(now)
        at = time.strftime("%H:%M:%S", time.localtime(time.time() - (now - unheard)))
        return f"not known since {at}, when the broker was heard last; it was {entry.words(unheard)}"

    @property
    def online(self) -> bool:
        return self.state == "online"

    @property
    def description(self) -> dict[str, Any]:
        """The board's `$description` as its agent published it last; empty where none came."""
        entry = self._entry()
        return dict(entry.description) if entry else {}

    @property
    def labels(self) -> dict[str, str]:
        return dict(self.description.get("labels") or {})

    def _is_gone(self) -> bool:
        return self.state not in (*THERE, "unknown")

    def _must_be_there(self) -> None:
        self._engine.check_open()
        if self._is_gone():
            raise errors.NotThere(f"{self.name} is {self.status}", board=self.name, reason="board-not-there")

    def wait_for(self, state: str = "online", *, timeout: float | None = 60) -> None:
        """Waits until the board is in this state; NotThere after `timeout` seconds (None: no limit)."""
        if state not in STATES:
            raise errors.Invalid(f"there is no state {state!r}" + (_model.near(str(state), STATES) or f"; there are {', '.join(STATES)}"), board=self.name)
        if timeout is not None:
            _wait.seconds(timeout)
        self._follow()
        changed = self._engine.changed
        with changed:
            _wait.until(changed, lambda: self.state == state or self._engine.closed, timeout)
        self._engine.check_open()
        if self.state != state:
            raise errors.NotThere(f"{self.name} was not {state} within {timeout:g} s; it is {self.status}", board=self.name,
                                  reason="board-not-there")

    def _timeout(self, given: float | None) -> float:
        return max(0.05, _wait.seconds(self.bus.timeout if given is None else given, "timeout", 0.001, 60))
