# SPDX-License-Identifier: Apache-2.0
"""`service.plot()`: values of a service as they come, by matplotlib where it is installed."""
from __future__ import annotations

import importlib
import sys
import time
from typing import Any

from . import errors
from .stream import Reading


_REDRAW_SECONDS = 0.5
_MAX_POINTS = 100_000  # of one line


def plot(service: Any, seconds: float, hz: float, event: str | None) -> Any:
    """See Service.plot()."""
    try:
        pyplot = importlib.import_module("matplotlib.pyplot")
    except ImportError as fault:
        raise ModuleNotFoundError(f"plot() needs matplotlib ({fault}): pip install matplotlib, or apt install python3-matplotlib",
                                  name="matplotlib") from None
    if not 0 < seconds <= 86_400:
        raise errors.Invalid(f"plot: {seconds} s is not within 0 to 86400", board=service.board.name, service=service.name)
    lines = Lines()
    figure, axes = pyplot.subplots()
    shown = _Shown(figure)
    began = time.time()
    try:
        for reading in _readings(service, seconds, hz, event):
            if reading is not None:
                lines.add(reading.at - began, reading.value)
            if shown.due():
                lines.draw(axes, service, event)
                shown.update()
    except KeyboardInterrupt:
        pass  # what came until then
    lines.draw(axes, service, event)
    shown.end(pyplot)
    if not lines.points:
        raise errors.Unproven(f"{service.board.name}/{service.name}: no number within {seconds:g} s to plot", board=service.board.name,
                              service=service.name, reason="no-value")
    return axes


def _readings(service: Any, seconds: float, hz: float, event: str | None) -> "Any":
    """Reports until the time is over, None now and then; where the service reports nothing, the board is asked."""
    found = service._event(event)
    asker = service._asker(found)
    end, reported = time.monotonic() + seconds, False
    pace = max(1.0 / hz, 0.02)
    with service.stream(hz=hz, event=event, keep=1000, details=True) as values:
        while (left := end - time.monotonic()) > 0:
            reading: Reading | None = values.wait(min(left, _REDRAW_SECONDS if reported or asker is None else max(pace, 0.1)))
            reported = reported or reading is not None
            if reading is None and not reported and asker is not None:
                try:
                    reading = Reading(service.command(asker.name, timeout=max(0.05, min(5.0, left))), found.unit, time.time())
                except (errors.Unproven, errors.Refused):
                    service.board._must_be_there()
            yield reading


class Lines:
    """Points by the place of a number in its value: `0` and `1` of `[42, 0]`, `x` of `{"x": 1}`, empty for a plain number."""

    def __init__(self) -> None:
        self.points: dict[str, tuple[list[float], list[float]]] = {}

    def add(self, at: float, value: Any) -> None:
        for place, number in _numbers(value):
            times, numbers = self.points.setdefault(place, ([], []))
            if len(times) < _MAX_POINTS:
                times.append(at)
                numbers.append(number)

    def draw(self, axes: Any, service: Any, event: str | None) -> None:
        axes.clear()
        for place, (times, numbers) in self.points.items():
            axes.plot(times, numbers, label=place or service.name, marker="." if len(times) < 50 else "")
        axes.set_xlabel("s")
        axes.set_ylabel(service._event(event).unit or service.name)
        axes.set_title(f"{service.board.name}/{service.name}")
        if len(self.points) > 1:
            axes.legend(loc="upper right")


def _numbers(value: Any, place: str = "") -> "list[tuple[str, float]]":
    if isinstance(value, (int, float)):
        return [(place, float(value))]
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [one for name, part in parts for one in _numbers(part, f"{place}.{name}" if place else str(name))]


class _Shown:
    """In a notebook the figure is drawn again while values come; elsewhere nothing is shown until it is there."""

    def __init__(self, figure: Any):
        self._figure, self._handle, self._next = figure, None, time.monotonic() + _REDRAW_SECONDS
        interactive = "IPython" in sys.modules and sys.modules["IPython"].get_ipython() is not None
        if interactive and hasattr(sys.modules["IPython"].get_ipython(), "kernel"):
            self._handle = importlib.import_module("IPython.display").display(figure, display_id=True)

    def due(self) -> bool:
        return self._handle is not None and time.monotonic() >= self._next

    def update(self) -> None:
        self._next = time.monotonic() + _REDRAW_SECONDS
        if self._handle is not None:
            self._handle.update(self._figure)

    def end(self, pyplot: Any) -> None:
        self.update()
        if self._handle is not None:
            pyplot.close(self._figure)  # else the notebook shows it once more
