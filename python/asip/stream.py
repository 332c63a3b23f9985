# SPDX-License-Identifier: Apache-2.0
"""Values of a service as an iterator."""
from __future__ import annotations

import collections
import contextlib
import logging
import queue
import time
import weakref

from . import _wait, errors
from ._followed import Followed

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, NamedTuple

    class Reading(NamedTuple):
        """One value: plain Python, its unit, and when it came, in seconds as `time.time()`."""

        value: Any
        unit: str
        at: float

# A loop that is woken for each of many values does little else. So where values that are kept come faster than one in
# _FAST_SECONDS, it takes those of _GATHER_SECONDS together.
_FAST_SECONDS = 0.001
_GATHER_SECONDS = 0.004
_SILENCE_SECONDS = 3.0
log = logging.getLogger("asip")


class Watch:
    """What `on_value` returns: `cancel()` ends it. The bus keeps it alive until then."""

    def __init__(self, cancel: Callable[[], None]):
        self._cancel: Callable[[], None] | None = cancel

    def cancel(self) -> None:
        cancel, self._cancel = self._cancel, None
        if cancel is not None:
            cancel()


if not TYPE_CHECKING:
    Reading = collections.namedtuple("Reading", "value unit at")


class Stream:
    """The iterator that `service.stream()` returns. It begins to listen at once, and ends with `close()`, with the end of a
    `with` block, or when nothing refers to it any more. `dropped` counts values that newer ones replaced."""

    def __init__(self, board: Followed, what: str, event: str, unit: str, watched: Callable[[Callable[..., None]], Watch], *, keep: int,
                 wait_for_board: bool = True, details: bool = False, timeout: float | None = None, hint: Callable[[], str] = str):
        self.dropped = 0
        self._board, self._what, self._details, self._timeout, self._hint = board, what, details, timeout, hint
        self._wait_for_board = wait_for_board
        self._waiting: "collections.deque[Reading]" = collections.deque()
        self._keep, self._unit = max(1, keep), unit
        self._busy = False
        self._silent = True  # no value came yet
        self._bell: "queue.SimpleQueue[None]" = queue.SimpleQueue()
        self._closed = False
        self._news: Callable[[], object] | None = None
        engine, this = board._engine, weakref.ref(self)

        def sink(payload: dict[str, Any], *_: Any) -> None:
            stream = this()
            if stream is not None and event in payload:
                stream._take(payload[event])
        self._watch = watched(sink)
        engine.listen(self)
        # Garbage may be collected in any thread: the clock's ends what nothing refers to any more.
        self._end = weakref.finalize(self, engine.later, self._watch.cancel)
        self._end.atexit = False

    def _take(self, value: Any) -> None:
        if len(self._waiting) >= self._keep:
            with contextlib.suppress(IndexError):  # the loop took it meanwhile
                self._waiting.popleft()
                self.dropped += 1
        self._waiting.append(Reading(value, self._unit, time.time()))
        self._told()

    def _told(self) -> None:
        """Something happened: a value, a change of a board, the end. Wakes the loop."""
        if self._bell.empty():
            self._bell.put(None)
        if self._news is not None:
            self._news()

    def on_news(self, function: Callable[[], object]) -> None:
        """`function`, which must not block, is called for each value that comes."""
        self._news = function

    def wait(self, seconds: float | None) -> Reading | None:
        """The next value; None where none came within `seconds`. Raises NotThere, Closed."""
        engine, end = self._board._engine, None if seconds is None else time.monotonic() + seconds
        while True:
            try:
                return self._waiting.popleft()
            except IndexError:
                pass
            if self._busy:
                time.sleep(_GATHER_SECONDS)
                self._busy = bool(self._waiting)
                continue
            if self._closed or engine.closed or self._gone():
                self._bell.put(None)  # for others that wait here
                break
            began = time.monotonic()
            if not _wait.for_bell(self._bell, end):
                return None
            self._busy = self._keep > 1 and time.monotonic() - began < _FAST_SECONDS
        engine.check_open()
        if self._gone():
            self._board._must_be_there()
        return None

    def _gone(self) -> bool:
        return not self._wait_for_board and self._board._is_gone()

    def __next__(self) -> Any:
        if self._closed:
            raise StopIteration
        try:
            reading = self._waiting.popleft() if self._waiting else self._next()
        except IndexError:  # another thread took it
            return next(self)
        except BaseException:
            self.close()
            raise
        if reading is None:
            if self._closed:
                raise StopIteration
            self.close()
            raise errors.Unproven(f"{self._board.name}/{self._what}: no value within {self._timeout:g} s{self._hint()}", board=self._board.name,
                                  service=self._what.partition("/")[0], reason="no-value")
        return reading if self._details else reading.value

    def _next(self) -> Reading | None:
        """As wait(); a loop that hears nothing is told why, once."""
        if not self._silent:
            return self.wait(self._timeout)
        self._silent = False
        patience = _SILENCE_SECONDS if self._timeout is None else min(_SILENCE_SECONDS, self._timeout)
        reading = self.wait(patience)
        hint = self._hint()
        if reading is not None or self._closed or not hint or self._timeout == patience:
            return reading
        log.warning("asip: %s/%s has told nothing for %g s%s", self._board.name, self._what, patience, hint)
        return self.wait(None if self._timeout is None else self._timeout - patience)

    def close(self) -> None:
        if not self._closed:
            self._closed = True
            self._end.detach()
            self._watch.cancel()
            self._bell.put(None)

    def __iter__(self) -> Stream:
        return self

    def __enter__(self) -> Stream:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


__all__ = ["Reading", "Stream", "Watch"]
