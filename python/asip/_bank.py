# SPDX-License-Identifier: Apache-2.0
"""What a program knows of all pins of one board."""
from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from . import errors

if TYPE_CHECKING:
    from .board import Board
    from .pin import Pin
    from .service import Service

INPUT, PULLUP, OUTPUT, ANALOG, PWM = 1, 2, 3, 4, 5


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
                for pin, mode in by_pin(answer).items():
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
            known = {**self.chosen, **dict.fromkeys(self.duties, PWM)}
            if not payload:  # the board restarted, or was away
                self.modes.clear()
                for pin in self.pins.values():
                    pin.level = None
            for number in before - {*known}:
                self.modes.pop(number, None)
            for number, mode in known.items():
                if mode in (OUTPUT, PWM) and number in self.pins:
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
                self.duties[number], self.modes[number] = value, PWM
                self.levels.pop(number, None)


def by_pin(modes: Any) -> dict[int, int]:
    return _numbers(dict(zip(map(str, range(256)), modes))) if isinstance(modes, (str, list)) else {}


def _numbers(told: Any) -> dict[int, int]:
    """Pins and their numbers, of what anybody may have published."""
    if not isinstance(told, dict):
        return {}
    return {int(pin): int(value) for pin, value in told.items() if pin.isascii() and pin.isdigit() and len(pin) < 4
            and (type(value) is int and 0 <= value < 256 or isinstance(value, str) and len(value) == 1 and value in "0123456789")}
