# SPDX-License-Identifier: Apache-2.0
"""One pin of a board: `desk.pin(13).on()`, `desk.pin(2).when_changed = print`, `desk.pin("A0").read()`."""
from __future__ import annotations

import contextlib
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, Callable

from . import _wait, errors
from ._bank import ANALOG, INPUT, OUTPUT, PULLUP, PWM, Bank, by_pin
from ._callbacks import takes

if TYPE_CHECKING:
    from .service import Watch

_WORDS = {"input": INPUT, "input-pullup": PULLUP, "output": OUTPUT, "analog": ANALOG, "pwm": PWM}
_SET_SECONDS = 1.0  # agents tell at most twice a second what was set


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
        if mode in (INPUT, PULLUP):
            self._hear()
            if self._bank.modes.get(self.number) not in (INPUT, PULLUP):
                self.level = None
        self._command("mode", mode, timeout)
        self._again = mode if mode in (INPUT, PULLUP) else None

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
        if self._bank.modes.get(self.number) != OUTPUT:
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
        mode = self._bank.mode(self.number, timeout)
        self.write(not (mode in (OUTPUT, PWM) and self._within(_SET_SECONDS)), timeout=timeout)

    def pwm(self, duty: int, *, timeout: float | None = None) -> None:
        """Sets the duty of a PWM pin, 0 to 255."""
        if isinstance(duty, bool) or not isinstance(duty, int) or not 0 <= duty <= 255:
            raise errors.Invalid(f"{self}: {duty!r} is no duty: a whole number from 0 to 255", board=self.board.name)
        if self._bank.modes.get(self.number) != PWM:
            self._set_mode(PWM, timeout)
        self._command("pwm", duty, timeout)

    # Inputs -------------------------------------------------------------------------------------------------------------

    def read(self, *, timeout: float | None = None) -> bool | int:
        """The level of an input; the value of an analog pin, 0 to 1023; of an output the level or duty that was set, by whichever
        program. It changes nothing: a pin without a mode is Invalid until `mode("input-pullup")`. Unproven where nothing is known."""
        seconds = self.board._timeout(timeout)
        self.board._must_be_there()
        mode = self._bank.mode(self.number, seconds)
        if mode == ANALOG:
            channel = self._bank.channel(self.number)
            if channel is None:
                raise errors.Unproven(f"{self}: the board did not tell which analog channel it is", board=self.board.name, reason="no-value")
            return int(self._bank.io()[channel].read("analog", timeout=seconds))
        decided = mode == PULLUP or self.number in self._bank.chosen
        if mode not in (OUTPUT, PWM):
            if not decided and self.level is None:
                raise errors.Invalid(f'{self} has no mode: pin({self.number}).mode("input-pullup") makes it an input', board=self.board.name)
            self._hear()
        value = self._within(min(seconds, _SET_SECONDS) if mode in (OUTPUT, PWM) else seconds)
        if value is None:
            self.board._engine.check_open()
            why = "it is not known what was set on it" if mode in (OUTPUT, PWM) else (
                f"the board told no level within {seconds:g} s; it tells one when it changes, and behind mode()")
            raise errors.Unproven(f"{self}: {why}", board=self.board.name, reason="no-value")
        return value

    def _present(self) -> bool | int | None:
        """What is known at this moment."""
        mode = self._bank.modes.get(self.number)
        if mode == OUTPUT:
            level = self._bank.levels.get(self.number)
            return None if level is None else bool(level)
        return self._bank.duties.get(self.number) if mode == PWM else self.level

    def _within(self, seconds: float) -> bool | int | None:
        with self._changed:
            _wait.until(self._changed, lambda: self._present() is not None or self.board._engine.closed, seconds)
            return self._present()

    def wait_for(self, level: bool, *, pull_up: bool = True, timeout: float | None = None) -> None:
        """Waits until the pin has this level; Unproven after `timeout` seconds (None: no limit)."""
        wanted = self._level_of(level)
        if timeout is not None:
            _wait.seconds(timeout)
        if self._listen(pull_up) in (ANALOG, PWM):
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
        if mode > PWM:
            raise errors.Invalid(f"{self} belongs to the board itself, or to one of its services", board=self.board.name)
        if mode not in (OUTPUT, ANALOG, PWM) and self.level is None:
            decided = mode == PULLUP or self.number in self._bank.chosen
            self._set_mode(mode if decided and mode != 0 else PULLUP if pull_up else INPUT, None)
        return mode

    def _reported(self, payload: dict[str, Any], _now: float) -> None:
        analog = self._bank.modes.get(self.number) == ANALOG
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
        modes = by_pin(answer.result()) if answer.exception() is None else {}
        if self._again is not None and modes.get(self.number, OUTPUT) <= PULLUP:
            with contextlib.suppress(errors.Error):
                self._bank.io().begin("mode", self.number, self._again)

    def __repr__(self) -> str:
        return f"<asip pin {self.number} of {self.board.name}>"

    def __str__(self) -> str:
        return f"{self.board.name} pin {self.number}"
