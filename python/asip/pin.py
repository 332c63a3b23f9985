# SPDX-License-Identifier: Apache-2.0
"""One pin of a board: `desk.pin(13).on()`, `desk.pin(2).when_changed = print`, `desk.pin("A0").read()`."""
from __future__ import annotations

import contextlib

from . import _wait, errors
from ._bank import ANALOG, INPUT, OUTPUT, PULLUP, PWM, Bank
from ._callbacks import takes
from ._followed import Followed
from ._properties import UNKNOWN
from .service import Service

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

_WORDS = {"input": INPUT, "input-pullup": PULLUP, "output": OUTPUT, "analog": ANALOG, "pwm": PWM}


class Pin:
    """`mode()` sets its mode, and so do `write()` and the like, and `pwm()`. Reading sets nothing; `wait_for()` and `on_change()` make a
    pin that nothing was decided about an input. An input that this program made is one again when the board comes back. Levels of outputs
    are not set again: a board that restarted keeps them off until the program sets them."""

    def __init__(self, board: Followed, bank: Bank, io: Callable[[], Service], number: int):
        self.board = board
        self.number = number
        self._bank = bank
        self._io = io
        self._changed = bank.changed
        self._again: int | None = None  # the mode of an input that this program set
        self._shown: bool | int | None = None
        self._function: Callable[..., Any] | None = None
        self._heard = False
        self._was_there = True

    @property
    def name(self) -> str:
        """Its friendly name; empty where people gave it none."""
        return self._bank.names().get(self.number, "")

    @property
    def level(self) -> bool | int | None:
        """What is known of it at this moment; None: nothing. `read()` asks."""
        return self._present()

    def mode(self, word: str, *, timeout: float | None = None) -> None:
        """`input`, `input-pullup`, `output`, `analog` or `pwm`."""
        if word not in _WORDS:
            raise errors.Invalid(f"{self}: mode {word!r} is none of {', '.join(_WORDS)}", board=self.board.name)
        self._set_mode(_WORDS[word], timeout)

    def _set_mode(self, mode: int, timeout: float | None) -> None:
        is_input = mode in (INPUT, PULLUP)
        if is_input:
            self._hear()
            self._bank.forget(self.number)  # what floated there before
        self._command("mode", mode, timeout)
        self._again = mode if is_input else None
        if is_input:
            with contextlib.suppress(errors.Unproven):  # an agent that tells nothing
                self._ask(timeout)

    def _command(self, name: str, value: int, timeout: float | None) -> None:
        future = self._io().begin(name, self.number, value, timeout=timeout)
        if name == "mode":
            future.add_done_callback(lambda done: None if done.exception() else self._bank.mode_set(self.number, value))
        _wait.result(future)

    # Outputs ------------------------------------------------------------------------------------------------------------

    def write(self, level: bool | int, *, timeout: float | None = None) -> None:
        """Sets an output. Returns when the board has executed it."""
        wanted = self._level_of(level)
        if self._bank.mode(self.number) != OUTPUT:
            self._set_mode(OUTPUT, timeout)
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
        self._ask(timeout)
        self.write(not (self._is_output() and self._present()), timeout=timeout)

    def pwm(self, duty: int, *, timeout: float | None = None) -> None:
        """Sets the duty of a PWM pin, 0 to 255."""
        if isinstance(duty, bool) or not isinstance(duty, int) or not 0 <= duty <= 255:
            raise errors.Invalid(f"{self}: {duty!r} is no duty: a whole number from 0 to 255", board=self.board.name)
        if self._bank.mode(self.number) != PWM:
            self._set_mode(PWM, timeout)
        self._command("pwm", duty, timeout)

    # What it is ---------------------------------------------------------------------------------------------------------

    def _ask(self, timeout: float | None) -> None:
        """Asks the board's agent how its pins stand."""
        self._bank.ask(self._io().name, self.board._timeout(timeout))

    def _kind(self) -> str:
        """`input`, `output`, `number`, or empty where nothing was decided about it: what people and commands made it, else what the sketch
        did. That it left a pin an input without a resistor decides nothing: so boards start."""
        told = self._bank.told(self.number)
        if told is not None:
            if told.floating:
                return ""
            return "input" if told.kind == "binary" else "output" if told.kind == "switch" or told.choices else "number"
        mode = self._bank.mode(self.number)
        if mode > PWM:
            raise errors.Invalid(f"{self} belongs to the board itself, or to one of its services", board=self.board.name)
        return {PULLUP: "input", OUTPUT: "output", ANALOG: "number", PWM: "number"}.get(mode, "")

    def _is_output(self) -> bool:
        told = self._bank.told(self.number)
        return told is not None and told.kind not in ("binary", "sensor")

    def _present(self) -> bool | int | None:
        """What is known at this moment."""
        told, wire = self._bank.told(self.number), self._bank.wire(self.number)
        is_number = told is not None and not told.choices or told is None and self._bank.mode(self.number) in (ANALOG, PWM)
        return wire if wire is None or is_number else bool(wire)

    def _why(self) -> str:
        value = self._bank.standing.values.get(f"io/{self.number}")
        return UNKNOWN[value.why if value is not None and value.why else "never"]

    # Inputs -------------------------------------------------------------------------------------------------------------

    def read(self, *, timeout: float | None = None) -> bool | int:
        """The level of an input; the value of an analog pin, 0 to 1023; of an output the level or duty that was set, by whichever
        program. It changes nothing: a pin without a mode is Invalid until `mode("input-pullup")`. Unproven where nothing is known."""
        seconds = self.board._timeout(timeout)
        if not (self._bank.busy() and self._bank.hears(self.number)):
            self._ask(seconds)
        self.board._must_be_there()
        kind, told = self._kind(), self._bank.told(self.number)
        if kind == "number" and not self._is_output() and (told is not None or self._bank.mode(self.number) == ANALOG):
            channel = self._bank.channel(self.number)
            if channel is None:
                raise errors.Unproven(f"{self}: the board did not tell which analog channel it is", board=self.board.name, reason="no-value")
            return int(self._io()[channel].read("analog", timeout=seconds))
        if kind == "":
            raise errors.Invalid(f'{self} has no mode: pin({self.number}).mode("input-pullup") makes it an input', board=self.board.name)
        if kind == "input":
            self._hear()  # a program that reads a level again and again is told it
        value = self._present()
        if value is not None:
            return value
        raise errors.Unproven(f"{self}: its {'level' if kind == 'input' else 'value'} is not known: {self._why()}", board=self.board.name, reason="no-value")

    def wait_for(self, level: bool, *, pull_up: bool = True, timeout: float | None = None) -> None:
        """Waits until the pin has this level; Unproven after `timeout` seconds (None: no limit)."""
        wanted = self._level_of(level)
        if timeout is not None:
            _wait.seconds(timeout)
        if self._listen(pull_up) == "number":
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
        if not self._heard:
            self._heard = True
            self._bank.hear()
            self._bank.hear_reports(self._io())
            self._bank.lookers[self] = self._look
            self.board._engine.listen(self)
            self.board._engine.peek(lambda session: session.watch_boards(self._board_changed))

    def _listen(self, pull_up: bool) -> str:
        """What it is. A pin that nothing was decided about becomes an input. No other pin gets a mode."""
        self._hear()
        self._ask(None)
        kind = self._kind()
        if kind == "":
            self._set_mode(PULLUP if pull_up else INPUT, None)
        return kind

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
        """In paho's thread: the board is back."""
        if name != self.board.name:
            return
        there = not self.board._is_gone()
        came_back, self._was_there = there and not self._was_there, there
        if came_back:
            self.board._engine.dispatcher.put(self._come_back, ())

    def _come_back(self) -> None:
        """An input of this program is one again, unless another program made it an output meanwhile: the description says. A level that
        changed meanwhile is told."""
        with contextlib.suppress(errors.Error):
            if self._again is not None and self._bank.mode(self.number) in {0, INPUT, PULLUP} - {self._again}:
                self._set_mode(self._again, None)
            else:
                self._ask(None)

    def _told(self) -> None:
        """The bus ended, or a board changed: `wait_for()` looks again."""
        with self._changed:
            self._changed.notify_all()

    def __repr__(self) -> str:
        return f"<asip pin {self.number} of {self.board.name}>"

    def __str__(self) -> str:
        return f"{self.board.name} pin {self.number}"
