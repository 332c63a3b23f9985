# SPDX-License-Identifier: Apache-2.0
"""One pin of a board: `desk.pin(13).on()`, `desk.pin(2).when_changed = print`."""
from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Callable

from . import _wait, errors
from ._callbacks import takes

if TYPE_CHECKING:
    from .board import Board
    from .service import Service, Watch

_INPUT, _PULLUP, _OUTPUT, _ANALOG, _PWM = 1, 2, 3, 4, 5
_WORDS = {"input": _INPUT, "input-pullup": _PULLUP, "output": _OUTPUT, "analog": _ANALOG, "pwm": _PWM}


class Pin:
    """Its mode is set by its first use, and the mode of an input again each time the board comes back. Levels of outputs are
    not: a board that restarted keeps them off until the program sets them."""

    def __init__(self, board: "Board", number: int):
        self.board = board
        self.number = number
        self._mode: str | None = None
        self._level: bool | None = None
        self._changed = threading.Condition()
        self._watch: "Watch | None" = None
        self._function: Callable[..., Any] | None = None
        self._was_there = True

    @property
    def name(self) -> str:
        """Its friendly name; empty where people gave it none."""
        return str(((self.board.description.get("names") or {}).get("pins") or {}).get(str(self.number), ""))

    def mode(self, word: str, *, timeout: float | None = None) -> None:
        """`input`, `input-pullup`, `output`, `analog` or `pwm`."""
        if word not in _WORDS:
            raise errors.Invalid(f"{self}: mode {word!r} is none of {', '.join(_WORDS)}", board=self.board.name)
        self._io().command("mode", self.number, _WORDS[word], timeout=timeout)
        self._mode = word

    def _need(self, word: str, timeout: float | None) -> None:
        if self._mode != word:
            self.mode(word, timeout=timeout)

    def _io(self) -> "Service":
        for service in self.board:
            if service.model is not None and service.model.name == "io":
                return service
        raise errors.NotThere(f"{self.board.name} offers no pins: it has no service io", board=self.board.name, service="io")

    # Outputs ------------------------------------------------------------------------------------------------------------

    def write(self, level: bool | int, *, timeout: float | None = None) -> None:
        """Sets an output. Returns when the board has executed it."""
        wanted = self._level_of(level)
        self._need("output", timeout)
        self._io().command("write", self.number, 1 if wanted else 0, timeout=timeout)
        self._level = wanted

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
        """The other level than the one that this program set last; on, where it set none."""
        self.write(not self._level, timeout=timeout)

    def pwm(self, duty: int, *, timeout: float | None = None) -> None:
        """Sets the duty of a PWM pin, 0 to 255."""
        if isinstance(duty, bool) or not isinstance(duty, int) or not 0 <= duty <= 255:
            raise errors.Invalid(f"{self}: {duty!r} is no duty: a whole number from 0 to 255", board=self.board.name)
        self._need("pwm", timeout)
        self._io().command("pwm", self.number, duty, timeout=timeout)

    # Inputs -------------------------------------------------------------------------------------------------------------

    def read(self, *, pull_up: bool = True, timeout: float | None = None) -> bool:
        """The level of an input; with a pull-up resistor unless `pull_up=False`. Of an output, the level that was set."""
        if self._mode == "output":
            return bool(self._level)
        self._listen(pull_up, timeout)
        seconds = self.board._timeout(timeout)
        with self._changed:
            if not _wait.until(self._changed, lambda: self._level is not None or self.board._engine.closed, seconds) or self._level is None:
                self.board._engine.check_open()
                raise errors.Unproven(f"{self}: the board told no level within {seconds:g} s", board=self.board.name, reason="no-value")
        return bool(self._level)

    def wait_for(self, level: bool, *, pull_up: bool = True, timeout: float | None = None) -> None:
        """Waits until the input has this level; Unproven after `timeout` seconds (None: no limit)."""
        wanted = self._level_of(level)
        if timeout is not None:
            _wait.seconds(timeout)
        self._listen(pull_up, None)
        with self._changed:
            if not _wait.until(self._changed, lambda: self._level is wanted or self.board._engine.closed, timeout):
                raise errors.Unproven(f"{self}: not {'high' if wanted else 'low'} within {timeout:g} s", board=self.board.name, reason="no-value")
        self.board._engine.check_open()

    def on_change(self, function: Callable[..., Any] | None, *, initial: bool = False, pull_up: bool = True) -> None:
        """Calls `function(level)` after each change, in the thread `asip-callbacks`; with `initial` at once for the present level,
        and again when the board returns. None ends it."""
        self._count = 0 if function is None else takes(function, 1)
        self._function = function
        if function is None:
            return
        self._listen(pull_up, None)
        if initial:
            try:
                level = self.read(pull_up=pull_up)
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

    def _listen(self, pull_up: bool, timeout: float | None) -> None:
        word = "input-pullup" if pull_up else "input"
        if self._watch is None:
            self._watch = self._io()._watched(self._reported, 10)
            self.board._engine.listen(self)
            self.board._engine.peek(lambda session: session.watch_boards(self._board_changed))
        if self._mode != word:
            self._level = None
            self.mode(word, timeout=timeout)

    def _reported(self, payload: dict[str, Any], _now: float) -> None:
        levels = payload.get("digital")
        if not isinstance(levels, dict) or str(self.number) not in levels or self._mode in ("output", "pwm"):
            return
        level = bool(levels[str(self.number)])
        with self._changed:
            if level is self._level:
                return
            first, self._level = self._level is None, level
            self._changed.notify_all()
        if self._function is not None and not first:
            self.board._engine.dispatcher.put(self._function, (level,)[:self._count])

    def _board_changed(self, name: str) -> None:
        """In paho's thread: the mode of an input is set again when the board is back, and its level is told as a change."""
        if name != self.board.name:
            return
        there = not self.board._is_gone()
        came_back, self._was_there = there and not self._was_there, there
        if came_back and self._mode in ("input", "input-pullup"):
            self.board._engine.dispatcher.put(self._set_again, ())

    def _told(self) -> None:
        """The bus ended, or a board changed: `wait_for()` looks again."""
        with self._changed:
            self._changed.notify_all()

    def _set_again(self) -> None:
        word = self._mode
        if word is not None:
            self._io().begin("mode", self.number, _WORDS[word])

    def __repr__(self) -> str:
        return f"<asip pin {self.number} of {self.board.name}>"

    def __str__(self) -> str:
        return f"{self.board.name} pin {self.number}"
