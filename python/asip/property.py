# SPDX-License-Identifier: Apache-2.0
"""What can be read or set on a board: `desk["io/13"].value = True`, `desk["servo/0/angle"].write(90)`, `for one in desk.properties: ...`."""
from __future__ import annotations

import time

from . import _history, _wait, errors
from ._bank import Bank
from ._callbacks import takes
from ._followed import Followed
from ._history import History
from ._properties import UNKNOWN, Told
from .service import Service, Watch
from .stream import Stream

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Mapping

_ASK_AGAIN_SECONDS = 0.25


class Property:
    """Its value has the meaning that people gave it: True is on, open, pressed. Ids, values and words are those of every other program.
    Numbers that a board reports many times a second are told by `board.distance.stream()`, each of them."""

    def __init__(self, board: Followed, bank: Bank, services: Callable[[], Mapping[str, Service]], id: str):
        self.id = id
        self.board = board
        self._bank = bank
        self._services = services
        self._service = id.partition("/")[0]
        self._function: Callable[..., Any] | None = None
        self._shown: Any = self  # no value
        self._watch: Watch | None = None

    @property
    def _told(self) -> Told:
        told = self._bank.standing.properties.get(self.id)
        if told is None:
            raise errors.NotThere(f"{self.board.name} has no property {self.id!r}", board=self.board.name, service=self._service)
        return told

    name = property(lambda self: self._told.name, doc="For people; the name that they gave it, where they did.")
    service = property(lambda self: self._told.service)
    kind = property(lambda self: self._told.kind, doc="`sensor`, `binary`, `switch`, `number`, `light`, `button`, `text` or `select`.")
    type = property(lambda self: self._told.type, doc="`boolean`, `integer`, `number`, `text`, `choice`, `light` or `action`.")
    access = property(lambda self: self._told.access, doc="`read`, `write` or `both`.")
    unit = property(lambda self: self._told.unit)
    quantity = property(lambda self: self._told.quantity)
    min = property(lambda self: self._told.min)
    max = property(lambda self: self._told.max)
    step = property(lambda self: self._told.step)
    choices = property(lambda self: list(self._told.choices), doc="Its words, where it has some.")
    meaning = property(lambda self: dict(self._told.meaning), doc="What people said that it is: `class`, `inverted` and so on.")

    # What it is ---------------------------------------------------------------------------------------------------------

    def read(self, *, timeout: float | None = None) -> Any:
        """How it stands, as the board's agent knows it: what a command of any program set, or what the board reported last. Nothing is sent
        to the board; one that reports on demand reports while this waits. None: the board says that it has no value. Unproven where it is
        not known, and why; Invalid of a pin that nothing holds, since no command gave it a mode."""
        seconds = self.board._timeout(timeout)
        end = time.monotonic() + seconds
        self._bank.ask(self._service, seconds)
        told, watch = self._told, None
        if told.floating:
            raise errors.Invalid(f'{self.board.name}/{self.id} has no value, since the pin has no mode: '
                                 f'{self.board.name}.pin({self.id.rpartition("/")[2]}).mode("input-pullup") makes it an input',
                                 board=self.board.name, service=self._service)
        try:
            while not self._known():
                if not told.read or not self._reports() or time.monotonic() > end:
                    raise errors.Unproven(f"{self.board.name}/{self.id} is not known: {self.why}", board=self.board.name, service=self._service, reason="no-value")
                watch = watch or self._demand()
                time.sleep(max(0.0, min(_ASK_AGAIN_SECONDS, end - time.monotonic())))
                self._bank.ask(self._service, max(0.05, end - time.monotonic()))
        finally:
            if watch is not None:
                watch.cancel()
        return self._bank.standing.values[self.id].value

    def _known(self) -> bool:
        value = self._bank.standing.values.get(self.id)
        return value is not None and value.how != ""

    def _reports(self) -> bool:
        """Whether the board reports this service by itself, or as soon as a program demands it."""
        described = self.board.description
        return "on_demand" in described or any(one.get("name") == self._service and one.get("period") for one in described.get("services") or [])

    def _demand(self) -> Watch:
        return self._services()[self._service]._watched(lambda *_: None, 10)

    @property
    def value(self) -> Any:
        """As `read()`; setting it is `write()`."""
        return self.read()

    @value.setter
    def value(self, value: Any) -> None:
        self.write(value)

    @property
    def text(self) -> str:
        """The value that is known at this moment, for people: `open`, `42 cm`."""
        return self._told.words(self._bank.standing.values[self.id].value) if self._known() else f"unknown: {self.why}"

    @property
    def how(self) -> str:
        """How the value is known: `reported`, `answered`, `set`, or empty where it is not."""
        return self._bank.standing.values[self.id].how if self._known() else ""

    @property
    def age(self) -> float | None:
        """Seconds since the value was reported or set last, or since it is not known."""
        value = self._bank.standing.values.get(self.id)
        return None if value is None else time.monotonic() - value.since

    @property
    def why(self) -> str:
        """Why it is not known; empty where it is."""
        value = self._bank.standing.values.get(self.id)
        return "" if self._known() else UNKNOWN[value.why if value is not None else "never"]

    def history(self, *, days: float = 0, hours: float = 0, points: int = 500, timeout: float | None = None) -> History:
        """How it was in the last days and hours (a day where none are given), as the registry kept it that knew it for the longest: at most `points` points, each with `at`,
        `mean`, `min` and `max`. Empty where nothing was kept.
        `.frame()` makes a pandas DataFrame of it. NotThere where no registry keeps values."""
        seconds = self.board._timeout(timeout)
        try:
            return _history.longest(self.board.bus, _history.query(self.board.name, self.id, days, hours, points), seconds)
        except errors.Refused as fault:
            if fault.reason != "no-history":
                raise
            raise errors.NotThere(str(fault), board=self.board.name, service=self._service, reason="no-history") from None

    # What it shall be ---------------------------------------------------------------------------------------------------

    def write(self, value: Any = None, *, timeout: float | None = None) -> None:
        """Sets it. Returns when the board has executed that. An action (`lcd/clear`) takes no value."""
        seconds = self.board._timeout(timeout)
        self._bank.ask(self._service, seconds)
        told = self._told
        requests = told.requests(value)
        if told.refused:
            raise errors.Refused(f"{self.board.name}/{self.id}: {told.refused}", board=self.board.name, service=self._service)
        if not requests:
            raise errors.Invalid(f"{self.board.name}/{self.id}: {_fault(told, value)}", board=self.board.name, service=self._service, reason="invalid")
        service = self._services()[told.service]
        for _, request in requests:
            (command, args), = request.items()
            service.command(command, *args, timeout=timeout)

    def on_change(self, function: Callable[..., Any] | None, *, hz: float = 10) -> None:
        """Calls `function(value)` after each change, in the thread `asip-callbacks`, first with the present value; a number that the board
        reports is told once a second. None ends it."""
        _wait.seconds(hz, "hz", 0.001, 1000)
        self._count = 0 if function is None else takes(function, 1)
        self._function, self._shown = function, self
        if self._watch is not None:
            self._watch.cancel()
            self._watch = None
        if function is None:
            self._bank.lookers.pop(self, None)
            return
        self._bank.lookers[self] = self._look
        self._bank.ask(self._service, self.board._timeout(None))
        if self._told.read and self._reports():
            self._watch = self._services()[self._service]._watched(lambda *_: None, hz)

    def _look(self) -> None:
        with self._bank.changed:
            function, value = self._function, self._bank.standing.values.get(self.id)
            if function is None or value is None or not value.how or type(value.value) is type(self._shown) and value.value == self._shown:
                return
            self._shown = value.value
        self.board._engine.dispatcher.put(function, (value.value,)[:self._count])

    # What is done with a button -----------------------------------------------------------------------------------------

    def events(self, *, keep: int = 100, timeout: float | None = None) -> Stream:
        """What is done with a button, as it is done: `for event in desk["io/2"].events():` gives `press` at once, `release`, `hold` (0.8 s)
        and `double` (within 0.4 s), each once. It goes on when the board was away. `keep` and `timeout` are those of `service.stream()`."""
        return Stream(self.board, self.id, "event", "", self._watched_button, keep=keep, timeout=timeout)

    def on_event(self, function: Callable[..., Any]) -> Watch:
        """Calls `function(event)` for each of the `events()`, in the thread `asip-callbacks`. Returns a Watch; `cancel()` ends it."""
        count, dispatcher = takes(function, 1), self.board._engine.dispatcher
        return self._watched_button(lambda payload: dispatcher.put(function, (payload["event"],)[:count]))

    def _watched_button(self, sink: Callable[..., None]) -> Watch:
        self._bank.ask(self._service, self.board._timeout(None))
        if not self._told.is_button:
            raise errors.Invalid(f"{self.board.name}/{self.id} is no button; {self.board.name}.set_meaning({self.id!r}, \"button\") makes it one",
                                 board=self.board.name, service=self._service)
        sinks = self._bank.button_sinks.setdefault(self.id, [])
        sinks.append(sink)
        demand = self._demand() if self._reports() else None

        def cancel() -> None:
            sinks.remove(sink)
            if demand is not None:
                demand.cancel()
        return Watch(cancel)

    def __repr__(self) -> str:
        return f"<asip property {self.board.name}/{self.id}>"


def _fault(told: Told, value: Any) -> str:
    if told.access == "read":
        return "it cannot be set"
    if told.min is not None and told.max is not None and told.kind == "number":
        return f"{value!r} is no {told.type} from {told.min:g} to {told.max:g}"
    what = {"switch": "True or False", "light": 'an object such as {"on": True}', "text": f"a text of at most {told.max_length} bytes"}
    return f"{value!r} is not {what.get(told.kind) or ' or '.join(map(repr, told.choices)) or 'a value of it'}"


__all__ = ["Property"]
