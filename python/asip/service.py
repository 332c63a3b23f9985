# SPDX-License-Identifier: Apache-2.0
"""One service of a board: its commands as methods, and its values."""
from __future__ import annotations

import time

from . import _model, _wait, errors
from ._callbacks import takes
from ._commands import Commands, Held, shown
from ._followed import Followed
from .stream import Reading, Stream, Watch

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Iterator, Sequence

    from ._history import History

# Names that stay ours where a model has a command of the same name: service.command("read") reaches that one.
_OWN = ("name", "title", "board", "model", "unit", "updated", "command", "read", "stream", "history", "on_value", "hold", "begin", "plot")
_MEASURE_AFTER_SECONDS = 0.3  # where the service reported nothing by then, and can be asked


class Service(Commands):
    """A service of a board. Commands are methods: they return when the board has executed the command, or raise.

    Every command takes `timeout=` in seconds (0.05 to 60; without it that of the bus, 5).
    """

    def __init__(self, board: Followed, name: str, title: str = ""):
        super().__init__(board, name)
        self.title = title
        self.updated: float | None = None
        """When the newest value came, in seconds as `time.time()`; None: none has come yet."""

    # Values -------------------------------------------------------------------------------------------------------------

    @property
    def unit(self) -> str:
        """The unit of the service's first event, `cm`; empty where there is none."""
        events = list(self.model.events.values()) if self.model else []
        return events[0].unit if events else ""

    def read(self, event: str | None = None, *, timeout: float | None = None) -> Any:
        """The newest value as plain Python, `[42, None]` where the second sensor got no echo: waits for a report, and asks the board where it reports nothing.

        `event` names one of several kinds of value (`digital`, `analog` of the pins). Raises Unproven where no value came in
        time, NotThere where the board is away.
        """
        found, seconds = self._event(event), self.board._timeout(timeout)
        end = time.monotonic() + seconds
        self.board._must_be_there()
        with self.stream(event=event, hz=10, timeout=seconds) as values:
            asker = self._asker(found)
            if asker is not None:
                first = values.wait(min(seconds, _MEASURE_AFTER_SECONDS))
                if first is not None:
                    return first.value
                return self.command(asker.name, timeout=max(0.05, end - time.monotonic()))
            reading = values.wait(seconds)
        if reading is None:
            hint = '; pins report when they change: board.pin(2).mode("input-pullup") makes one an input, which tells its level' if found.name == "digital" else None
            raise errors.Unproven(f"{self.board.name}/{self.name}: no value within {seconds:g} s{hint or self._how_to_report()}", board=self.board.name,
                                  service=self.name, reason="no-value")
        return reading.value

    def _how_to_report(self) -> str:
        """What to do about a service that tells nothing; empty where nothing is known."""
        if self.board.description.get("on_demand") or not self.model or "report" not in self.model.commands:
            return ""
        return f": it reports when its period is set, each 100 ms by {self.board.name}.{_model.identifier(self.name)}.report(100)"

    def _event(self, name: str | None) -> _model.Event:
        try:
            return self._need_model(name or "read").event(name)
        except _model.ModelError as fault:
            raise errors.Invalid(f"{self.board.name}/{self.name}: {fault}", board=self.board.name, service=self.name) from None

    def _asker(self, event: _model.Event) -> _model.Command | None:
        """The command without arguments by which the board is asked for this event."""
        for command in self.model.commands.values() if self.model else ():
            if command.answer == event.tag and not command.args:
                return command
        return None

    def stream(self, *, hz: float = 10, event: str | None = None, keep: int = 1, lost: str = "raise", details: bool = False,
               timeout: float | None = None) -> Stream:
        """Values as they come: `for value in desk.distance.stream(hz=10):`.

        hz: values a second that are enough, of a board that reports on demand.
        keep: how many values wait for the loop; a slow loop gets the newest ones, `stream.dropped` counts the others.
        lost: "raise" ends the loop by NotThere when the board is lost, "wait" goes on when it is back.
        details: gives Reading(value, unit, at) in place of plain values.
        timeout: the longest time between two values in seconds; then Unproven. None: no limit.
        """
        _wait.seconds(hz, "hz", 0.001, 1000)
        if not isinstance(keep, int) or keep < 1:
            raise errors.Invalid(f"keep: {keep!r} is not a whole number above 0")
        if timeout is not None:
            _wait.seconds(timeout)
        if lost not in ("raise", "wait"):
            raise errors.Invalid(f'lost={lost!r}: "raise" or "wait"')
        found = self._event(event)
        return Stream(self.board, self.name, found.name, found.unit, lambda sink: self._watched(sink, hz), keep=keep, wait_for_board=lost == "wait",
                      details=details, timeout=timeout, hint=self._how_to_report)

    def plot(self, *, seconds: float = 30, hz: float = 10, event: str | None = None) -> Any:
        """Draws the values that come within `seconds`, a line for each number in them; in a notebook while they come. Ctrl-C ends
        it earlier. Returns matplotlib's axes (`.figure.savefig("distance.png")`); without matplotlib ModuleNotFoundError says how to
        get it. A board that reports nothing by itself is asked."""
        from . import _plot
        return _plot.plot(self, seconds, hz, event)

    def on_value(self, function: Callable[..., Any], *, hz: float = 10, event: str | None = None) -> Watch:
        """Calls `function(value)` for each report, in the thread `asip-callbacks`, one at a time; it may send commands. While
        it takes long the newest value waits. Returns a Watch; `cancel()` ends it."""
        _wait.seconds(hz, "hz", 0.001, 1000)
        found, count, engine = self._event(event), takes(function, 1), self.board._engine
        key = object()

        def sink(payload: dict[str, Any], *_: Any) -> None:
            if found.name in payload:
                engine.dispatcher.put(function, (payload[found.name],)[:count], key)
        return self._watched(sink, hz)

    def _watched(self, sink: Callable[..., None], hz: float) -> Watch:
        engine, board, name = self.board._engine, self.board.name, self.name
        self.board._follow()
        events = {event.name: event for event in self.model.events.values() if event.nones} if self.model else {}

        def told(payload: dict[str, Any], *more: Any) -> None:
            self.updated = time.time()
            sink({name: shown(events[name], value) if name in events else value for name, value in payload.items()} if events else payload, *more)
        engine.do(lambda session, now: session.watch(now, board, name, told, hz))

        def cancel() -> None:
            if not engine.closed and not engine.forked:
                engine.do(lambda session, now: session.unwatch(now, board, name, told))
        return Watch(cancel)

    # Hold ---------------------------------------------------------------------------------------------------------------

    def hold(self, *, seconds: float = 0.5, feed: float | None = None, timeout: float | None = None,
             **commands: Sequence[Any]) -> Held:
        """A dead man's switch: `with desk.motors.hold(power=[[0, 60], [1, 60]]):`

        Each command is in force while the block runs, and undone by its model's safe form when it ends; by the board's agent,
        within `seconds`, when this program or its connection dies. A command's value is one list of arguments or a list of
        those. With `feed=1.0` it is renewed only while the block calls `feed()` or `set()` of what it got at least once a
        second: then a loop that hangs stops the motor, too.
        """
        _wait.seconds(seconds, "seconds", 0.05, 60)
        if feed is not None:
            _wait.seconds(feed, "feed", 0.05)
        if not commands:
            raise errors.Invalid("hold: no command is given: hold(power=[[0, 60], [1, 60]])", board=self.board.name, service=self.name)
        return Held(self, seconds, feed, timeout, commands)

    def history(self, *, days: float = 0, hours: float = 0, points: int = 500, timeout: float | None = None) -> History:
        """How its only property was, as `Property.history` tells it; Invalid names them where there are several."""
        own = [one for one in self.board.properties if one.id.partition("/")[0] == self.name]
        if len(own) != 1:
            ids = ", ".join(f'board["{one.id}"].history()' for one in own)
            raise errors.Invalid(f"{self.board.name}/{self.name} has {f'several properties: {ids}' if own else 'no property'}",
                                 board=self.board.name, service=self.name)
        history: History = own[0].history(days=days, hours=hours, points=points, timeout=timeout)
        return history

    def __getitem__(self, index: int) -> "Element":
        return Element(self, index)

    def __iter__(self) -> Iterator[Any]:
        raise TypeError(f"{self.board.name}/{self.name} is no list; its values are service.read() and service.stream()")

    def __repr__(self) -> str:
        return f"<asip service {self.board.name}/{self.name}>"

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(self.model.attributes if self.model else ())})

    if not TYPE_CHECKING:
        def __getattr__(self, name: str) -> Any:
            if name.startswith("_") or self.model is None:
                raise AttributeError(name)
            try:
                self.model.command(name)
            except _model.ModelError as fault:
                raise AttributeError(f"{self.board.name}/{self.name}: {fault}") from None
            raise AttributeError(name)


class Element:
    """One element of a service: `desk.distance[0].read()`."""

    def __init__(self, service: Service, index: int):
        self._service, self._index = service, index

    def read(self, event: str | None = None, *, timeout: float | None = None) -> Any:
        """The newest value of this element. Raises Invalid where the service has fewer."""
        value = self._service.read(event, timeout=timeout)
        try:
            return value[self._index] if not isinstance(value, dict) else value[str(self._index)]
        except (IndexError, KeyError, TypeError):
            raise errors.Invalid(f"{self._service.board.name}/{self._service.name} has no element {self._index} in {value!r}",
                                 board=self._service.board.name, service=self._service.name) from None


_classes: dict[str, type[Service]] = {}


def class_of(model: _model.Model | None) -> type[Service]:
    """The class of services of this model: Service with a method for each command."""
    if model is None:
        return Service
    key = repr(model.document)
    if key not in _classes:
        members: dict[str, Any] = {"model": model, "__doc__": f"{model.title} ({model.name}@{model.version}).", "__module__": __name__}
        for attribute, command in model.attributes.items():
            if attribute not in _OWN:
                members[attribute] = _method(attribute, command)
        if len(_classes) >= 4096:
            _classes.clear()
        try:
            _classes[key] = type(identifier_of_class(model.name), (Service,), members)
        except ValueError:  # a name that no class can have
            _classes[key] = type("Service", (Service,), members)
    return _classes[key]


def identifier_of_class(name: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in _model.identifier(name).split("_"))


def _method(attribute: str, command: _model.Command) -> Callable[..., Any]:
    def method(self: Service, *args: Any, timeout: float | None = None, **named: Any) -> Any:
        return self.command(command.name, *args, timeout=timeout, **named)
    method.__name__ = attribute
    method.__qualname__ = f"Service.{attribute}"
    method.__doc__ = command.doc
    method.__signature__ = command.signature  # type: ignore[attr-defined]
    method.asip_command = command.name  # type: ignore[attr-defined]
    return method


__all__ = ["Service", "Held", "Watch", "Element", "Reading"]
