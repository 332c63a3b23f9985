# SPDX-License-Identifier: Apache-2.0
"""Runs users' functions in a thread of its own, one at a time, in the order of what happened.

A function that blocks or raises delays neither answers nor holds. Values that come faster than a function takes them are
replaced by newer ones; changes of boards and pins never are, up to MAX_WAITING of them.
"""
from __future__ import annotations

import collections
import logging
import threading
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

log = logging.getLogger("asip")
MAX_WAITING = 10_000
SLOW_SECONDS = 1.0


def takes(function: Callable[..., Any], given: int) -> int:
    """How many of `given` arguments the function takes: one may write `led.on` where a value is offered. Raises TypeError at
    once for what cannot be called so."""
    import inspect
    if not callable(function):
        raise TypeError(f"{function!r} is no function")
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return given
    for count in range(given, -1, -1):
        try:
            signature.bind(*[None] * count)
            return count
        except TypeError:
            continue
    raise TypeError(f"{getattr(function, '__name__', function)!r} cannot be called with {given} or fewer arguments")


class Dispatcher:
    def __init__(self, on_error: Callable[[BaseException], None] | None = None):
        self.on_error = on_error
        self.failures = 0
        self.dropped = 0
        self._queue: "collections.OrderedDict[object, tuple[Callable[..., Any], tuple[Any, ...]]]" = collections.OrderedDict()
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None
        self._closed = self._full = False

    def put(self, function: Callable[..., Any], args: tuple[Any, ...], key: object = None) -> None:
        """`key`: what waits under the same key is replaced. Never blocks."""
        with self._changed:
            if self._closed:
                return
            if key is None:
                key = object()
            elif key in self._queue:
                self.dropped += 1
            if len(self._queue) >= MAX_WAITING and key not in self._queue:
                self._queue.popitem(last=False)
                self.dropped += 1
                if not self._full:
                    self._full = True
                    log.error("asip: %d calls of functions wait; from now on the oldest give way", MAX_WAITING)
            self._queue[key] = (function, args)
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="asip-callbacks", daemon=True)
                self._thread.start()
            self._changed.notify()

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._queue and not self._closed:
                    self._changed.wait()
                if self._closed:
                    return
                _, (function, args) = self._queue.popitem(last=False)
            began = time.monotonic()
            try:
                function(*args)
            except BaseException as error:  # noqa: BLE001: a function of the user's may raise anything, and others wait for this thread
                if self._closed:
                    return  # the bus was closed while the function used it
                self.failures += 1
                log.exception("asip: %s failed", getattr(function, "__qualname__", function))
                if self.on_error is not None:
                    try:
                        self.on_error(error)
                    except BaseException:  # noqa: BLE001
                        log.exception("asip: on_error failed")
            took = time.monotonic() - began
            if took > SLOW_SECONDS:
                log.warning("asip: %s took %.1f s; other functions waited", getattr(function, "__qualname__", function), took)

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._queue.clear()
            self._changed.notify_all()
