# SPDX-License-Identifier: Apache-2.0
"""The one place where a caller's thread waits."""
from __future__ import annotations

import queue
import sys
import threading
import time
from concurrent.futures import Future, TimeoutError as FutureTimeout

from . import errors

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# On Windows a thread that waits without a limit does not see Ctrl-C before Python 3.14, so it wakes up now and then.
_SLICE = 0.1 if sys.platform == "win32" else 3600.0
_forbidden = threading.local()


def seconds(value: Any, what: str = "timeout", least: float = 0.0, most: float = 86_400.0) -> float:
    """`value` as a number of seconds (or of `what` else) within the limits; Invalid names what is wrong."""
    if isinstance(value, (int, float)) and not isinstance(value, bool) and least <= value <= most:
        return float(value)
    raise errors.Invalid(f"{what}: {value!r} is not a number from {least:g} to {most:g}", reason="invalid")


def forbid() -> None:
    """The calling thread carries messages: it must never wait for one."""
    _forbidden.here = True


def check() -> None:
    """Raises in a thread that must not wait."""
    if getattr(_forbidden, "here", False):
        raise RuntimeError("what is called when a future ends runs in the thread that carries messages: it must not wait for one")


def result(future: "Future[Any]") -> Any:
    """Waits until `future` ends; its owner limits how long that takes."""
    check()
    while True:
        try:
            return future.result(_SLICE)
        except FutureTimeout:
            if future.done():
                raise


def for_bell(bell: "queue.SimpleQueue[None]", end: float | None) -> bool:
    """Waits until something is put into `bell`, or until the time `end`; whether it was."""
    while True:
        left = _SLICE if end is None else min(_SLICE, end - time.monotonic())
        if left <= 0:
            return False
        try:
            bell.get(timeout=left)
            return True
        except queue.Empty:
            continue


def until(condition: threading.Condition, true: Any, seconds: float | None) -> bool:
    """Waits, with `condition` held, until `true()` or until the time is over; whether it is true."""
    end = None if seconds is None else time.monotonic() + seconds
    while not true():
        left = _SLICE if end is None else min(_SLICE, end - time.monotonic())
        if left <= 0:
            return False
        condition.wait(left)
    return True
