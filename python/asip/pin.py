# SPDX-License-Identifier: Apache-2.0
"""One pin of a board: `desk.pin(13).on()`, `desk.pin(2).when_changed = print`, `desk.pin("A0").read()`."""
from __future__ import annotations

import contextlib
import threading
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, Callable

from . import _wait, errors
from ._callbacks import takes

if TYPE_CHECKING:
    from .board import Board
    from .service import Service, Watch

_INPUT, _PULLUP, _OUTPUT, _ANALOG, _PWM = 1, 2, 3, 4, 5
_WORDS = {"input": _INPUT, "input-pullup": _PULLUP, "output": _OUTPUT, "analog": _ANALOG, "pwm": _PWM}
_SET_SECONDS = 1.0  # agents tell at most twice a second what was set


class Bank:
    """What is known of all pins of one board: their modes, and what was set on them by whichever program. `set` of the bus tells
    it; a mode that it does not tell is asked of the board, which changes nothing there."""

    def __init__(self, board: "Board"):
        self.board = board
        self.changed = threading.Condition(threading.RLock())
        self.pins: dict[int, Pin] = {}
        self.modes: dict[int, int] = {}   # of each pin whose mode is known
        self.chosen: dict[int, int] = {}  # modes that a command set; others are the sketch's
        self.levels: dict[int, int] = {}
        self.duties: dict[int, int] = {}
        self.told = 0
        self._heard = False

    def io(self) -> "Service":
        for service in self.board:
            if service.model is not None and service.model.name == "io":
                return service
        raise errors.NotThere(f"{self.board.name} offers no pins: it has no service io", board=self.board.name, service="io")

    def hear(self) -> "Service":
        io = self.io()
        if not self._heard:
            self._heard = True
            self.board._follow()
            self.board._engine.do(lambda session, now: session.watch_set(self.board.name, io.name, self._on_set))
        return io

    def mode(self, number: int, timeout: float | None) -> int:
        """The mode of a pin; the board is asked where the bus does not tell it."""
        io = self.hear()
        if number not in self.modes:
            answer = io.command("modes", timeout=timeout) if io.model and "modes" in io.model.commands else None
            if not isinstance(answer, list):
                answer = self._described().get("modes")
            with self.changed:
                for pin, mode in _by_pin(answer).items():
                    self.modes.setdefault(pin, mode)
        return self.modes.get(number, 0)

    def channel(self, number: int) -> int | None:
        return _numbers(self._described().get("analog")).get(number)

    def _described(self) -> dict[str, Any]:
        pins = self.board.description.get("pins")
        return pins if isinstance(pins, dict) else {}

    def number_of(self, name: str) -> int | None:
        """The pin that people named so; `A0` is that of analog channel 0."""
        names = self.names()
        analog = {f"A{channel}": pin for pin, channel in _numbers(self._described().get("analog")).items()}
        return next((pin for pin, own in names.items() if own == name), analog.get(name))

    def names(self) -> dict[int, str]:
        return {int(pin): str(name) for pin, name in self.board._pin_names().items() if pin.isascii() and pin.isdigit() and len(pin) < 4}

    def _on_set(self, payload: dict[str, Any], _now: float) -> None:
        with self.changed:
            self.told += 1
            before = {*self.chosen, *self.duties}
            self.chosen, self.levels, self.duties = (_numbers(payload.get(name)) for name in ("mode", "write", "pwm"))
            known = {**self.chosen, **dict.fromkeys(self.duties, _PWM)}
            if not payload:  # the board restarted, or was away
                self.modes.clear()
                for pin in self.pins.values():
                    pin.level = None
            for number in before - {*known}:
                self.modes.pop(number, None)
            for number, mode in known.items():
                if mode in (_OUTPUT, _PWM) and number in self.pins:
                    self.pins[number].level = None
                if self.chosen.get(number, mode) == mode:
                    self.modes[number] = mode
                else:
                    self.modes.pop(number, None)  # a mode and a duty: which one is newer is asked
        for pin in [*self.pins.values()]:
            pin._look()

    def executed(self, number: int, command: str, value: int, told: list[int]) -> None:
        """This program's command. What the bus told behind the answer, `told[0]`, is as new."""
        with self.changed:
            if told and told[0] != self.told:
                return
            if command == "mode":
                self.modes[number] = self.chosen[number] = value
            elif command == "write":
                self.levels[number] = value
                self.duties.pop(number, None)
            else:
                self.duties[number], self.modes[number] = value, _PWM
                self.levels.pop(number, None)


def _by_pin(modes: Any) -> dict[int, int]:
    return _numbers(dict(zip(map(str, range(256)), modes))) if isinstance(modes, (str, list)) else {}


def _numbers(told: Any) -> dict[int, int]:
    """Pins and their numbers, of what anybody may have published."""
    if not isinstance(told, dict):
        return {}
    return {int(pin): int(value) for pin, value in told.items() if pin.isascii() and pin.isdigit() and len(pin) < 4
            and (type(value) is int and 0 <= value < 256 or isinstance(value, str) and len(value) == 1 and value in "0123456789")}


class Pin:
    """`mode()` sets its mode, and so do `write()` and the like, and `pwm()`. Reading sets nothing; `wait_for()` and `on_change()` make a
    pin that nothing was decided about an input. A mode of an input is set again each time the board comes back. Levels of outputs
    are not: a board that restarted keeps them off until the program sets them."""

    def __init__(self, bank: Bank, number: int):
        self.board = bank.board
        self.number = number
        self.level: bool | int | None = None  # as the board reported it
        self._bank = bank
        self._changed = bank.changed
        self._again: int | None = None  # the mode of an input that this program set
        self._shown: bool | int | None = None
        self._watch: "Watch | None" = None
        self._function: Callable[..., Any] | None = None
        self._was_there = True

    @property
    def name(self) -> str:
        """Its friendly name; empty where people gave it none."""
        return self._bank.names().get(self.number, "")

    def mode(self, word: str, *, timeout: float | None = None) -> None:
        """`input`, `input-pullup`, `output`, `analog` or `pwm`."""
        if word not in _WORDS:
            raise errors.Invalid(f"{self}: mode {word!r} is none of {', '.join(_WORDS)}", board=self.board.name)
        self._set_mode(_WORDS[word], timeout)

    def _set_mode(self, mode: int, timeout: float | None) -> None:
        if mode in (_INPUT, _PULLUP):
            self._hear()
            if self._bank.modes.get(self.number) not in (_INPUT, _PULLUP):
                self.level = None
        self._command("mode", mode, timeout)
        self._again = mode if mode in (_INPUT, _PULLUP) else None

    def _command(self, name: str, value: int, timeout: float | None) -> None:
        bank, told = self._bank, list[int]()
        future = bank.hear().begin(name, self.number, value, timeout=timeout)
        future.add_done_callback(lambda _: told.append(bank.told))
        _wait.result(future)
        bank.executed(self.number, name, value, told)
        self._look()

    # Outputs ------------------------------------------------------------------------------------------------------------

    def write(self, level: bool | int, *, timeout: float | None = None) -> None:
        """Sets an output. Returns when the board has executed it."""
        wanted = self._level_of(level)
        if self._bank.modes.get(self.number) != _OUTPUT:
            self._set_mode(_OUTPUT, timeout)
        self._command("write", 1 if wanted else 0, timeout)

    def _level_of(self, level: Any) -> bool:
        """True, False, 1 and 0, of NumPy too, or the words of the model; `"off"` is not true as other texts are."""
        words = {"high": True, "on": True, "low": False, "off": False}
        if isinstance(level, str) and level in words:
            return words[level]
        if isinstance(level, (str, bytes)) or level is None or level not in (0, 1):
            raise errors.Invalid(f"{self}: {level!r} is no level: True or False, 1 or 0, {', '.join(map(repr, words))}", board=self.board.name)
        return bool(level)

    def on(self, *, timeout: float | None = None) -> None:
        self.write(True, timeout=timeout)

    def off(self, *, timeout: float | None = None) -> None:
        self.write(False, timeout=timeout)

    def toggle(self, *, timeout: float | None = None) -> None:
        """The other level than the one that was set last, by whichever program; on, where none is known."""
        mode = self._bank.mode(self.number, timeout)
        self.write(not (mode in (_OUTPUT, _PWM) and self._within(_SET_SECONDS)), timeout=timeout)

    def pwm(self, duty: int, *, timeout: float | None = None) -> None:
        """Sets the duty of a PWM pin, 0 to 255."""
        if isinstance(duty, bool) or not isinstance(duty, int) or not 0 <= duty <= 255:
            raise errors.Invalid(f"{self}: {duty!r} is no duty: a whole number from 0 to 255", board=self.board.name)
        if self._bank.modes.get(self.number) != _PWM:
            self._set_mode(_PWM, timeout)
        self._command("pwm", duty, timeout)

    # Inputs -------------------------------------------------------------------------------------------------------------

    def read(self, *, timeout: float | None = None) -> bool | int:
        """The level of an input; the value of an analog pin, 0 to 1023; of an output the level or duty that was set, by whichever
        program. It changes nothing: a pin without a mode is Invalid until `mode("input-pullup")`. Unproven where nothing is known."""
        seconds = self.board._timeout(timeout)
        self.board._must_be_there()
        mode = self._bank.mode(self.number, seconds)
        if mode == _ANALOG:
            channel = self._bank.channel(self.number)
            if channel is None:
                raise errors.Unproven(f"{self}: the board did not tell which analog channel it is", board=self.board.name, reason="no-value")
            return int(self._bank.io()[channel].read("analog", timeout=seconds))
        decided = mode == _PULLUP or self.number in self._bank.chosen
        if mode not in (_OUTPUT, _PWM):
            if not decided and self.level is None:
                raise errors.Invalid(f'{self} has no mode: pin({self.number}).mode("input-pullup") makes it an input', board=self.board.name)
            self._hear()
        value = self._within(min(seconds, _SET_SECONDS) if mode in (_OUTPUT, _PWM) else seconds)
        if value is None:
            self.board._engine.check_open()
            why = "it is not known what was set on it" if mode in (_OUTPUT, _PWM) else (
                f"the board told no level within {seconds:g} s; it tells one when it changes, and behind mode()")
            raise errors.Unproven(f"{self}: {why}", board=self.board.name, reason="no-value")
        return value

    def _present(self) -> bool | int | None:
        """What is known at this moment."""
        mode = self._bank.modes.get(self.number)
        if mode == _OUTPUT:
            level = self._bank.levels.get(self.number)
            return None if level is None else bool(level)
        return self._bank.duties.get(self.number) if mode == _PWM else self.level

    def _within(self, seconds: float) -> bool | int | None:
        with self._changed:
            _wait.until(self._changed, lambda: self._present() is not None or self.board._engine.closed, seconds)
            return self._present()

    def wait_for(self, level: bool, *, pull_up: bool = True, timeout: float | None = None) -> None:
        """Waits until the pin has this level; Unproven after `timeout` seconds (None: no limit)."""
        wanted = self._level_of(level)
        if timeout is not None:
            _wait.seconds(timeout)
        if self._listen(pull_up) in (_ANALOG, _PWM):
            raise errors.Invalid(f'{self} has numbers, not levels; pin({self.number}).mode("input-pullup") makes it an input', board=self.board.name)
        with self._changed:
            if not _wait.until(self._changed, lambda: self._present() is wanted or self.board._engine.closed, timeout):
                raise errors.Unproven(f"{self}: not {'high' if wanted else 'low'} within {timeout:g} s", board=self.board.name, reason="no-value")
        self.board._engine.check_open()

    def on_change(self, function: Callable[..., Any] | None, *, initial: bool = False, pull_up: bool = True) -> None:
        """Calls `function(level)` after each change, in the thread `asip-callbacks`; with `initial` at once for the present level,
        and again when the board returns. Of an output it is told what any program sets. None ends it."""
        self._count = 0 if function is None else takes(function, 1)
        self._function = function
        if function is None:
            return
        self._listen(pull_up)
        if initial:
            try:
                level = self.read()
            except errors.Unproven:
                return
            self.board._engine.dispatcher.put(function, (level,)[:self._count])

    @property
    def when_changed(self) -> Callable[..., Any] | None:
        """The function that is called with the level after each change; set it to one, or to None."""
        return self._function

    @when_changed.setter
    def when_changed(self, function: Callable[..., Any] | None) -> None:
        self.on_change(function)

    def _hear(self) -> None:
        if self._watch is None:
            self._watch = self._bank.hear()._watched(self._reported, 10)
            self.board._engine.listen(self)
            self.board._engine.peek(lambda session: session.watch_boards(self._board_changed))

    def _listen(self, pull_up: bool) -> int:
        """Its mode. A pin that nothing was decided about becomes an input; an input gets the mode that it has once more, because a
        board tells the level then. No other pin gets one."""
        self._hear()
        mode = self._bank.mode(self.number, None)
        if mode > _PWM:
            raise errors.Invalid(f"{self} belongs to the board itself, or to one of its services", board=self.board.name)
        if mode not in (_OUTPUT, _ANALOG, _PWM) and self.level is None:
            decided = mode == _PULLUP or self.number in self._bank.chosen
            self._set_mode(mode if decided and mode != 0 else _PULLUP if pull_up else _INPUT, None)
        return mode

    def _reported(self, payload: dict[str, Any], _now: float) -> None:
        analog = self._bank.modes.get(self.number) == _ANALOG
        told = payload.get("analog" if analog else "digital")
        value = told.get(str(self._bank.channel(self.number) if analog else self.number)) if isinstance(told, dict) else None
        if type(value) is int:  # boards report levels of inputs only
            self.level = value if analog else bool(value)
            self._look()

    def _look(self) -> None:
        """Something was told: whoever waits looks again, and the function is told a change."""
        with self._changed:
            self._changed.notify_all()
            value = self._present()
            if value is None or value is self._shown or value == self._shown and type(value) is type(self._shown):
                return
            first, self._shown = self._shown is None, value
        if self._function is not None and not first:
            self.board._engine.dispatcher.put(self._function, (value,)[:self._count])

    def _board_changed(self, name: str) -> None:
        """In paho's thread: the mode of an input is set again when the board is back, and its level is told as a change."""
        if name != self.board.name:
            return
        there = not self.board._is_gone()
        came_back, self._was_there = there and not self._was_there, there
        if came_back and self._again is not None:
            self.board._engine.dispatcher.put(self._ask_again, ())

    def _told(self) -> None:
        """The bus ended, or a board changed: `wait_for()` looks again."""
        with self._changed:
            self._changed.notify_all()

    def _ask_again(self) -> None:
        """Another program may have made it an output meanwhile: the board says."""
        put = self.board._engine.dispatcher.put
        with contextlib.suppress(errors.Error):
            self._bank.io().begin("modes").add_done_callback(lambda answer: put(self._set_again, (answer,)))

    def _set_again(self, answer: "Future[Any]") -> None:
        modes = _by_pin(answer.result()) if answer.exception() is None else {}
        if self._again is not None and modes.get(self.number, _OUTPUT) <= _PULLUP:
            with contextlib.suppress(errors.Error):
                self._bank.io().begin("mode", self.number, self._again)

    def __repr__(self) -> str:
        return f"<asip pin {self.number} of {self.board.name}>"

    def __str__(self) -> str:
        return f"{self.board.name} pin {self.number}"
