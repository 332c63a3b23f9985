# SPDX-License-Identifier: Apache-2.0
"""How the classes of asip.aio stand for those of asip in an event loop."""
from __future__ import annotations

import asyncio
import functools
import inspect
import logging
import threading
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, AsyncIterator, Callable, TypeVar

from . import errors
from ._callbacks import takes
from .stream import Reading, Stream

if TYPE_CHECKING:
    from typing import Concatenate, Coroutine, ParamSpec
    P = ParamSpec("P")

R = TypeVar("R")
log = logging.getLogger("asip")


async def run(function: Callable[..., Any], *args: Any, **named: Any) -> Any:
    """In a thread of its own: the loop's threads are few, and calls that wait for a pin would take all of them. It is a daemon, so
    that a program which was interrupted does not wait for it."""
    future: Future[Any] = Future()
    future.set_running_or_notify_cancel()

    def work() -> None:
        try:
            future.set_result(function(*args, **named))
        except BaseException as error:  # noqa: BLE001: the caller gets it
            future.set_exception(error)
    threading.Thread(target=work, name="asip-aio", daemon=True).start()
    return await asyncio.wrap_future(future)


def in_loop(bus: Any, function: Callable[..., Any], given: int) -> Callable[..., None]:
    """What calls `function`, a coroutine function too, in the event loop of `bus`. Its exceptions are logged and given to `on_error`."""
    count, loop = takes(function, given), bus._loop

    def failed(error: BaseException) -> None:
        log.error("asip: %s failed", getattr(function, "__qualname__", function), exc_info=error)
        if bus.on_error is not None:
            bus.on_error(error)

    def ended(task: asyncio.Future[Any]) -> None:
        tasks.discard(task)
        error = None if task.cancelled() else task.exception()
        if error is not None:
            failed(error)

    def run(args: tuple[Any, ...]) -> None:
        try:
            result = function(*args)
        except Exception as error:  # noqa: BLE001: a function of the user's may raise anything
            failed(error)
            return
        if inspect.isawaitable(result):
            task = asyncio.ensure_future(result)
            tasks.add(task)  # the loop itself keeps no task alive
            task.add_done_callback(ended)
    tasks: set[asyncio.Future[Any]] = set()

    def call(*args: Any) -> None:
        if not loop.is_closed():
            loop.call_soon_threadsafe(run, args[:count])
    return call


async def readings(stream: Stream, what: str, timeout: float | None) -> AsyncIterator[Reading]:
    """What a stream gives, until nobody asks for more; Unproven where nothing comes for so long."""
    loop, ready = asyncio.get_running_loop(), asyncio.Event()
    stream.on_news(lambda: None if loop.is_closed() else loop.call_soon_threadsafe(ready.set))
    try:
        while True:
            ready.clear()
            reading = stream.wait(0)
            if reading is not None:
                yield reading
                continue
            try:
                await asyncio.wait_for(ready.wait(), timeout)
            except asyncio.TimeoutError:
                raise errors.Unproven(f"{what}: no value within {timeout:g} s", reason="no-value") from None
    finally:
        stream.close()


def waits(method: Callable[Concatenate[Any, P], R]) -> Callable[Concatenate[Any, P], Coroutine[Any, Any, R]]:
    """This method of a class of `asip`, for `await`: it runs in a thread of its own."""
    @functools.wraps(method)
    async def call(self: Any, /, *args: P.args, **named: P.kwargs) -> R:
        made: R = await run(method, self._one, *args, **named)
        return made
    return call


def same(name: str) -> Any:
    """A property of a class of `asip`."""
    return property(lambda self: getattr(self._one, name))


class Twin:
    """What stands for `one` of `asip`."""

    def __init__(self, one: Any):
        self._one = one

    def __repr__(self) -> str:
        return repr(self._one)

    def __dir__(self) -> list[str]:
        return dir(self._one)
