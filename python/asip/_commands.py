# SPDX-License-Identifier: Apache-2.0
"""The commands of a service, and those that are held: undone when the program does not renew them."""
from __future__ import annotations

import threading
import time
from concurrent.futures import Future

from . import _model, _wait, errors
from ._calls import Call
from ._followed import Followed
from ._session import Hold

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Mapping, Sequence


class Commands:
    model: _model.Model | None = None

    def __init__(self, board: Followed, name: str):
        self.name = name
        self.board = board

    def command(self, name: str, *args: Any, timeout: float | None = None, **named: Any) -> Any:
        """Sends the command `name`, as the model calls it (`stop-all`). Returns the board's answer where the model says that
        it gives one, else None. Raises Invalid, BoardError, Refused, NotThere, Unproven or Disconnected."""
        command, call = self._begin(name, args, named, timeout)
        return self._answer(command, _wait.result(call.future))

    def begin(self, name: str, *args: Any, timeout: float | None = None, **named: Any) -> "Future[Any]":
        """As command(), without waiting: a `concurrent.futures.Future`."""
        command, call = self._begin(name, args, named, timeout)
        done: "Future[Any]" = Future()

        def finish(answered: "Future[Any]") -> None:
            if done.done():
                return
            fault = answered.exception()
            if fault is not None:
                done.set_exception(fault)
            else:
                done.set_result(self._answer(command, answered.result()))
        call.future.add_done_callback(finish)
        return done

    def _together(self, commands: "Sequence[dict[str, Any]]", what: str, *, timeout: float | None = None) -> list[Any]:
        """Commands in a row, as one request: `[{"write": [0, 90]}, {"write": [1, 0]}]`, without one of others for this service between
        them. The answers of those that have one. `what` names them in errors."""
        engine, seconds = self.board._engine, self.board._timeout(timeout)
        call = engine.ask(lambda session, now: session.command(now, self.board.name, self.name, what, {"commands": commands}, seconds))
        answers: list[Any] = _wait.result(call.future).get("answer") or []
        return answers

    def _begin(self, name: str, args: tuple[Any, ...], named: dict[str, Any], timeout: float | None,
               hold: float | None = None) -> tuple[_model.Command, Call]:
        model = self._need_model(name)
        try:
            command = model.command(name)
            values = command.values(args, named)
        except _model.ModelError as fault:
            raise errors.Invalid(f"{self.board.name}/{self.name}: {fault}", board=self.board.name, service=self.name, command=name,
                                 reason="invalid") from None
        return command, self._send(command, values, timeout, hold)

    def _send(self, command: _model.Command, values: list[Any], timeout: float | None, hold: float | None = None) -> Call:
        engine = self.board._engine
        seconds = self.board._timeout(timeout)
        return engine.ask(lambda session, now: session.command(now, self.board.name, self.name, command.name,
                                                               {command.name: values}, seconds, hold))

    def _answer(self, command: _model.Command, answer: dict[str, Any]) -> Any:
        value = answer.get("answer")
        event = self.model.answer_of(command) if self.model else None
        if event is not None and isinstance(value, dict) and event.name in value:
            return shown(event, value[event.name])
        return value

    def _need_model(self, what: str) -> _model.Model:
        if self.model is None:
            raise errors.Invalid(f"{self.board.name}/{self.name} has no model that says what {what!r} is; send its lines by board.raw()",
                                 board=self.board.name, service=self.name, command=what)
        return self.model


def shown(event: _model.Event, value: Any, field: str = "") -> Any:
    """A value of an event as people read it: None for the number by which the board says that it has none."""
    if isinstance(value, list):
        return [shown(event, one, field) for one in value]
    if isinstance(value, dict):
        return {name: shown(event, one, name if name in event.nones else field) for name, one in value.items()}
    none = event.nones.get(field or event.fields[0].name) if event.nones and (field or len(event.fields) == 1) else None
    return None if none is not None and value == none and not isinstance(value, bool) else value


class Held:
    """What `hold()` returns, for `with`. `lost` is a sentence when the hold ended before the block did."""

    def __init__(self, service: Commands, seconds: float, feed: float | None, timeout: float | None, commands: Mapping[str, Sequence[Any]]):
        self.lost: str | None = None
        self._service, self._seconds, self._feed, self._timeout, self._commands = service, seconds, feed, timeout, commands
        self._holds: dict[str, tuple[_model.Command, list[Any]]] = {}  # by the id of the hold
        self._mutex = threading.Lock()

    def __enter__(self) -> "Held":
        try:
            self.set(**self._commands)
        except BaseException:
            try:
                self._undo()
            except errors.Error:
                pass  # the first fault counts; the agent undoes it in any case
            raise
        return self

    def set(self, **commands: Sequence[Any]) -> None:
        """Gives these commands in place of those for the same elements, held as before. Returns when they were executed."""
        service, engine = self._service, self._service.board._engine
        model = service._need_model("hold")
        begun = []
        for name, given in commands.items():
            for args in _argument_lists(given):
                command, call = service._begin(name, args, {}, self._timeout, self._seconds)
                safe = model.safe_form(command, call.members[command.name])
                if safe is None:
                    raise errors.Invalid(f"{service.board.name}/{service.name}: nothing undoes {command.name}, so it cannot be held",
                                         board=service.board.name, service=service.name, command=command.name)
                now = time.monotonic()
                with self._mutex:
                    for id, other in [*self._holds.items()]:
                        if other == safe:
                            engine.peek(lambda session: session.end_hold(id))
                            del self._holds[id]
                    self._holds[call.id] = safe
                engine.keep_hold(Hold(service.board.name, call.topic, call.id, self._seconds, now + self._seconds / 3, self._feed, now, self._ended))
                begun.append(call)
        for call in begun:
            _wait.result(call.future)
        self.feed()

    def feed(self) -> None:
        """Says that the program is alive, where the hold has `feed=`."""
        now = time.monotonic()
        for id in list(self._holds):
            self._service.board._engine.peek(lambda session: session.feed(id, now))

    def _ended(self, why: str) -> None:
        self.lost = self.lost or why

    def _undo(self) -> None:
        engine = self._service.board._engine
        with self._mutex:
            holds, self._holds = self._holds, {}
        calls = []
        for id, (command, values) in holds.items():
            engine.peek(lambda session: session.end_hold(id))
            if not engine.closed and not engine.forked:
                calls.append(self._service._send(command, values, min(1.0, self._service.board._timeout(None))))
        for call in calls:
            _wait.result(call.future)

    def __exit__(self, kind: Any, error: Any, _trace: Any) -> None:
        try:
            self._undo()
        except errors.Error:
            if kind is None:
                raise  # else the error of the block counts; the agent undoes it in any case
        if kind is None and self.lost:
            raise errors.Refused(f"{self._service.board.name}/{self._service.name}: the hold ended before the block did: {self.lost}",
                                 board=self._service.board.name, service=self._service.name, reason="not-held")


def _argument_lists(given: Any) -> list[tuple[Any, ...]]:
    if not isinstance(given, (list, tuple)):
        return [(given,)]
    if given and all(isinstance(one, (list, tuple)) for one in given):
        return [tuple(one) for one in given]
    return [tuple(given)]
