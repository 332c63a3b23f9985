# SPDX-License-Identifier: Apache-2.0
"""How one board stands, as its agent tells it: the properties, their values, and the levels of its pins. Nothing here makes the agent
send anything to the board."""
from __future__ import annotations

import collections
import fnmatch
import threading
import time
from concurrent.futures import Future, TimeoutError as FutureTimeout

from . import _wait, errors
from ._followed import Followed
from ._properties import Standing, Told
from .service import Service

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Mapping

INPUT, PULLUP, OUTPUT, ANALOG, PWM = 1, 2, 3, 4, 5
_AGENT_SECONDS = 0.7      # within what time an agent answers a question; then it is asked again
_QUESTIONS = 18           # a second: agents answer 20
_REPAIR_SECONDS = 1.0     # a level that was reported later than this before a document of values counts more than that


class Bank:
    def __init__(self, board: Followed):
        self.board = board
        self.changed = threading.Condition(threading.RLock())
        self.standing = Standing()
        self.lookers: dict[object, Callable[[], None]] = {}  # called after each change
        self.button_sinks: dict[str, list[Callable[..., None]]] = {}  # by id: told {"event": word}
        self._levels: dict[int, tuple[int, float]] = {}  # of inputs, electrical, and when they were told
        self._analog: dict[int, int] = {}                # by channel
        self._modes: dict[int, tuple[int, tuple[str, int]]] = {}  # that this program set behind a description
        self._heard = False
        self._reports: Any = None
        self._asked: collections.deque[float] = collections.deque([0.0] * _QUESTIONS, _QUESTIONS)
        self._waiting: dict[str, Future[Any]] = {}  # questions that are not sent yet

    def io(self, services: Mapping[str, Service]) -> Service:
        for service in services.values():
            if service.model is not None and service.model.name == "io":
                return service
        raise errors.NotThere(f"{self.board.name} offers no pins: it has no service io", board=self.board.name, service="io")

    def hear(self) -> None:
        """From now on what the agent publishes is heard."""
        if self._heard:
            return
        self._heard = True
        board, engine = self.board, self.board._engine
        board._follow()
        engine.do(lambda session, now: session.watch_topic(session.topics.properties(board.name), self._on_list)
                  + session.watch_topic(session.topics.values(board.name), self._on_values))

    def hear_reports(self, io: Service) -> None:
        """Levels of inputs come with the reports of io before they are in the document of values."""
        if self._reports is None:
            self._reports = io._watched(self._on_report, 10)
            self.board._engine.peek(lambda session: session.watch_boards(self._board_changed))

    def _board_changed(self, name: str) -> None:
        if name == self.board.name and self.board._is_gone():
            self.forget()

    # What the agent is asked ---------------------------------------------------------------------------------------------

    def ask(self, service: str, seconds: float) -> None:
        """Asks the agent how the properties of a service stand (`*`: of all); it answers from memory. What was answered before, to
        whomever, is known then. Unproven where no agent answers within the time."""
        self.hear()
        end = time.monotonic() + seconds
        while True:
            self.board._must_be_there()
            left = end - time.monotonic()
            try:
                self._question(service, left).result(left)
                return
            except (errors.Unproven, errors.Disconnected, FutureTimeout) as fault:
                if time.monotonic() < end:
                    continue
                if isinstance(fault, errors.Disconnected):
                    raise
                agent = self.board.description.get("agent") or {}
                version = f" (asip-agent {agent['version']})" if isinstance(agent.get("version"), str) else ""
                raise errors.Unproven(f"{self.board.name}: its agent{version} did not tell how the board stands within {seconds:g} s; one of an "
                                      "older version never does: update asip-agent there", board=self.board.name, reason="no-value") from None

    def busy(self) -> bool:
        """Whether the next question would have to wait."""
        return self._asked[0] + 1.0 > time.monotonic()

    def hears(self, number: int) -> bool:
        """Whether the level of an input is known by reports, which come at once."""
        told = self.told(number)
        return self._reports is not None and number in self._levels and (told is None or told.kind == "binary")

    def _question(self, service: str, left: float) -> Future[Any]:
        """One that is on its way already may have been answered before something that the caller knows of: only one that still waits for
        its turn is shared."""
        _wait.check()
        with self.changed:
            waiting = self._waiting.get(service)
            if waiting is not None:
                return waiting
            pause = self._asked[0] + 1.0 - time.monotonic()
            self._asked.append(time.monotonic() + max(0.0, pause))
            done: Future[Any] = Future()
            if pause > 0:
                self._waiting[service] = done
        if pause > 0:
            time.sleep(pause)
            with self.changed:
                self._waiting.pop(service, None)

        def answered(answer: Future[Any]) -> None:  # in paho's thread: before what comes behind the answer
            fault = answer.exception()
            try:
                if fault is None:
                    self._on_answer(service, answer.result().get("answer"))
            except ValueError as damaged:
                fault = errors.Unproven(str(damaged), board=self.board.name, reason="no-value")
            if fault is not None:
                done.set_exception(fault)
            else:
                done.set_result(None)
        try:
            call = self.board._engine.ask(lambda session, now: session.question(now, self.board.name, service, min(left, _AGENT_SECONDS)))
        except errors.Error as fault:
            done.set_exception(fault)
        else:
            call.future.add_done_callback(answered)
        return done

    # What comes, in paho's thread ------------------------------------------------------------------------------------------

    def _holder(self) -> str:
        entry = self.board._entry()
        return entry.session if entry is not None and entry.described else ""

    def _on_list(self, document: dict[str, Any], *_: Any) -> None:
        with self.changed:
            self.standing.take_list(document, self.board.name, self._holder())
        self._look()

    def _on_values(self, document: dict[str, Any], now: float, stored: bool) -> None:
        with self.changed:
            if self.standing.take_values(document, self.board.name, self._holder(), now, stored):
                self._compare(now)
            acts = self.standing.acts
        self._look()
        for id, word in acts:
            for sink in [*self.button_sinks.get(id, ())]:
                sink({"event": word})

    def _on_answer(self, service: str, document: Any) -> None:
        now = time.monotonic()
        with self.changed:
            pins = self.standing.take_answer(document, self.board.name, self._holder(), now, lambda name: fnmatch.fnmatchcase(name, service))
            if pins is not None:
                self._compare(now)
                self._keep(pins, now)
        self._look()

    def _on_report(self, payload: dict[str, Any], now: float, _stored: bool) -> None:
        """What the service io reports."""
        with self.changed:
            self._keep(payload, now)
        self._look()

    def _keep(self, told: dict[str, Any], now: float) -> None:
        self._levels.update({pin: (level, now) for pin, level in numbers(told.get("digital")).items()})
        self._analog.update(numbers(told.get("analog"), 1 << 16))

    def _compare(self, now: float) -> None:
        """After a restart no level of before counts. A report that was lost is made good."""
        if self.standing.anew:
            self.forget()
        for id, one in self.standing.values.items():
            told = self.standing.properties.get(id)
            if told is not None and told.kind == "binary" and (pin := _pin_of(id)) in self._levels:
                wire = told.wire(one.value)
                level, when = self._levels[pin]
                if one.how and wire != level and now - when > _REPAIR_SECONDS:
                    del self._levels[pin]

    def forget(self, number: int | None = None) -> None:
        """Levels of a pin, or of all: the board is away, or was."""
        with self.changed:
            if number is not None:
                self._levels.pop(number, None)
                return
            self._levels.clear()
            self._analog.clear()

    def _look(self) -> None:
        for looker in [*self.lookers.values()]:
            looker()

    # What is known of pins ---------------------------------------------------------------------------------------------------

    def told(self, number: int) -> Told | None:
        return self.standing.properties.get(f"io/{number}")

    def wire(self, number: int) -> int | None:
        """The level, duty or analog value of a pin; None: not known."""
        told = self.told(number)
        if told.kind == "sensor" if told is not None else self.mode(number) == ANALOG:
            channel = self.channel(number)
            return None if channel is None else self._analog.get(channel)
        if number in self._levels and (told is None or told.kind == "binary"):
            return self._levels[number][0]
        if told is None:
            return None
        value = self.standing.values.get(told.id)
        wire = told.wire(value.value) if value is not None and value.how else None
        return int(wire) if isinstance(wire, (int, float)) else None

    def mode(self, number: int) -> int:
        """The mode that a pin has now; 0: none, or not known."""
        entry = self.board._entry()
        own = self._modes.get(number)
        if own is not None and entry is not None and own[1] == (entry.session, entry.seq):
            return own[0]
        modes = self._described().get("modes")
        digit = modes[number:number + 1] if isinstance(modes, str) else ""
        return int(digit) if digit in "012345678" and digit else 0

    def mode_set(self, number: int, mode: int) -> None:
        """By this program, which knows it before the next description says it."""
        entry = self.board._entry()
        if entry is not None:
            self._modes[number] = mode, (entry.session, entry.seq)

    def channel(self, number: int) -> int | None:
        return numbers(self._described().get("analog")).get(number)

    def _described(self) -> dict[str, Any]:
        pins = self.board.description.get("pins")
        return pins if isinstance(pins, dict) else {}

    def number_of(self, name: str) -> int | None:
        """The pin that people named so; `A0` is that of analog channel 0."""
        analog = {f"A{channel}": pin for pin, channel in numbers(self._described().get("analog")).items()}
        return next((pin for pin, own in self.names().items() if own == name), analog.get(name))

    def names(self) -> dict[int, str]:
        told = (self.board.description.get("names") or {}).get("pins") or {}
        return {int(pin): str(name) for pin, name in told.items()}


def numbers(told: Any, most: int = 256) -> dict[int, int]:
    """Pins and their numbers, of what anybody may have published."""
    if not isinstance(told, dict):
        return {}
    return {int(pin): value for pin, value in told.items() if pin.isascii() and pin.isdigit() and len(pin) < 4 and type(value) is int and 0 <= value < most}


def _pin_of(id: str) -> int:
    digits = id.rpartition("/")[2]
    return int(digits) if digits.isascii() and digits.isdigit() and len(digits) < 4 else -1
