# SPDX-License-Identifier: Apache-2.0
"""The same bus for asyncio: the same names, `await` in front of what waits.

    async with asip.aio.connect() as bus:
        desk = await bus.board("desk")
        await desk.servo.write(0, 90)
        async for value in desk.distance.stream(hz=10):
            ...

Nothing here knows the protocol. A command is the future of the same call as in `asip`; calls that take several steps run in a
thread. It needs no `add_reader`, so it works with every event loop. Cancelling a command does not undo it.
"""
from __future__ import annotations

import asyncio
import functools
import inspect
import logging
import threading
from concurrent.futures import Future
from typing import Any, AsyncIterator, Awaitable, Callable, Iterable, Iterator, Mapping, Sequence

from . import bus as _bus
from . import errors, settings
from ._callbacks import takes
from .board import Board as _Board
from .pin import Pin as _Pin
from .property import Property as _Property
from .service import Element as _Element
from .service import Held as _Held
from .service import Service as _Service
from .service import Watch
from .stream import Reading, Stream

log = logging.getLogger("asip")


async def _run(function: Callable[..., Any], *args: Any, **named: Any) -> Any:
    """In a thread of its own: the loop's threads are few, and calls that wait for a pin would take all of them. It is a daemon, so
    that a program which was interrupted does not wait for it."""
    future: "Future[Any]" = Future()
    future.set_running_or_notify_cancel()

    def work() -> None:
        try:
            future.set_result(function(*args, **named))
        except BaseException as error:  # noqa: BLE001: the caller gets it
            future.set_exception(error)
    threading.Thread(target=work, name="asip-aio", daemon=True).start()
    return await asyncio.wrap_future(future)


def _in_loop(bus: "Bus", function: Callable[..., Any], given: int) -> Callable[..., None]:
    """What calls `function`, a coroutine function too, in the event loop of `bus`. Its exceptions are logged and given to `on_error`."""
    count, loop = takes(function, given), bus._loop

    def failed(error: BaseException) -> None:
        log.error("asip: %s failed", getattr(function, "__qualname__", function), exc_info=error)
        if bus.on_error is not None:
            bus.on_error(error)

    def ended(task: "asyncio.Future[Any]") -> None:
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
    tasks: "set[asyncio.Future[Any]]" = set()

    def call(*args: Any) -> None:
        if not loop.is_closed():
            loop.call_soon_threadsafe(run, args[:count])
    return call


async def _readings(stream: Stream, what: str, timeout: float | None) -> AsyncIterator[Reading]:
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


class Bus:
    """As `asip.Bus`. It belongs to the event loop in which it was entered."""

    def __init__(self, bus: _bus.Bus):
        self._bus = bus
        self._loop = asyncio.get_running_loop()
        self.on_error: Callable[[BaseException], None] | None = None

    def _check_loop(self) -> None:
        if asyncio.get_running_loop() is not self._loop:
            raise errors.Closed("this bus belongs to another event loop; connect in this one")

    @property
    def timeout(self) -> float:
        return self._bus.timeout

    @property
    def connected(self) -> bool:
        return self._bus.connected

    @property
    def settings(self) -> settings.Settings:
        return self._bus.settings

    async def board(self, name: str, *, timeout: float | None = None) -> "Board":
        self._check_loop()
        return Board(self, await _run(self._bus.board, name, timeout=timeout))

    async def boards(self, pattern: str = "*", *, labels: str | None = None, timeout: float | None = None) -> "list[Board]":
        self._check_loop()
        return [Board(self, one) for one in await _run(self._bus.boards, pattern, labels=labels, timeout=timeout)]

    def watch(self, function: Callable[..., Any]) -> Watch:
        """Calls `function(board, state)` in the event loop."""
        self._check_loop()
        call = _in_loop(self, function, 2)
        return self._bus.watch(lambda board, state: call(Board(self, board), state))

    async def stop(self, boards: Iterable[str] | None = None, *, timeout: float | None = None) -> None:
        self._check_loop()
        await _run(self._bus.stop, boards, timeout=timeout)

    async def query(self, query: dict[str, Any], *, timeout: float | None = None) -> dict[str, Any]:
        self._check_loop()
        answer: dict[str, Any] = await _run(self._bus.query, query, timeout=timeout)
        return answer

    async def close(self) -> None:
        await _run(self._bus.close)

    async def __aenter__(self) -> "Bus":
        return self

    async def __aexit__(self, *_: Any) -> None:
        await self.close()

    def __repr__(self) -> str:
        return repr(self._bus)


class Board:
    """As `asip.Board`."""

    def __init__(self, bus: Bus, board: _Board):
        self.bus = bus
        self._board = board

    name = property(lambda self: self._board.name)
    state = property(lambda self: self._board.state)
    reason = property(lambda self: self._board.reason)
    status = property(lambda self: self._board.status)
    online = property(lambda self: self._board.online)
    labels = property(lambda self: self._board.labels)
    description = property(lambda self: self._board.description)

    @property
    def services(self) -> "Mapping[str, Service]":
        return {name: Service(self, one) for name, one in self._board.services.items()}

    async def wait_for(self, state: str = "online", *, timeout: float | None = 60) -> None:
        await _run(self._board.wait_for, state, timeout=timeout)

    async def raw(self, line: str, *, timeout: float | None = None) -> Any:
        return await _run(self._board.raw, line, timeout=timeout)

    async def label(self, **labels: str | None) -> None:
        await _run(self._board.label, **labels)

    async def name_pins(self, names: Mapping[int, str | None]) -> None:
        await _run(self._board.name_pins, names)

    async def set_meaning(self, id: str, kind: str | None = "", **members: Any) -> None:
        await _run(self._board.set_meaning, id, kind, **members)

    @property
    def properties(self) -> "Awaitable[list[Property]]":
        """`await board.properties`"""
        return self._all_properties()

    async def _all_properties(self) -> "list[Property]":
        return [Property(self, one) for one in await _run(lambda: self._board.properties)]

    def property(self, id: str) -> "Property":
        """It is looked for when it is read or written."""
        return Property(self, self._board._property(id))

    async def stop(self, *, hold: bool = False, why: str = "", timeout: float | None = None) -> None:
        await _run(self._board.stop, hold=hold, why=why, timeout=timeout)

    async def resume(self, *, timeout: float | None = None) -> None:
        await _run(self._board.resume, timeout=timeout)

    def pin(self, which: int | str) -> "Pin":
        return Pin(self, self._board.pin(which))

    def __getitem__(self, name: str) -> Any:
        return self.property(name) if isinstance(name, str) and "/" in name else Service(self, self._board[name])

    def __contains__(self, name: object) -> bool:
        return name in self._board

    def __iter__(self) -> "Iterator[Service]":
        return iter([Service(self, one) for one in self._board])

    def __getattr__(self, name: str) -> "Service":
        if name.startswith("_"):
            raise AttributeError(name)
        return Service(self, getattr(self._board, name))

    def __repr__(self) -> str:
        return repr(self._board)

    def __dir__(self) -> list[str]:
        return dir(self._board)


class Service:
    """As `asip.Service`."""

    def __init__(self, board: Board, service: _Service):
        self.board = board
        self._service = service

    name = property(lambda self: self._service.name)
    title = property(lambda self: self._service.title)
    unit = property(lambda self: self._service.unit)
    updated = property(lambda self: self._service.updated)
    model = property(lambda self: self._service.model)

    async def command(self, name: str, *args: Any, timeout: float | None = None, **named: Any) -> Any:
        self.board.bus._check_loop()
        return await asyncio.wrap_future(self._service.begin(name, *args, timeout=timeout, **named))

    async def read(self, event: str | None = None, *, timeout: float | None = None) -> Any:
        return await _run(self._service.read, event, timeout=timeout)

    async def stream(self, *, hz: float = 10, event: str | None = None, keep: int = 1, lost: str = "raise", details: bool = False,
                     timeout: float | None = None) -> AsyncIterator[Any]:
        self.board.bus._check_loop()
        stream = self._service.stream(hz=hz, event=event, keep=keep, lost=lost, details=True, timeout=None)
        async for reading in _readings(stream, f"{self.board.name}/{self.name}", timeout):
            yield reading if details else reading.value

    def on_value(self, function: Callable[..., Any], *, hz: float = 10, event: str | None = None) -> Watch:
        """Calls `function(value)` in the event loop."""
        call = _in_loop(self.board.bus, function, 1)
        return self._service.on_value(lambda value: call(value), hz=hz, event=event)

    def hold(self, *, seconds: float = 0.5, feed: float | None = None, timeout: float | None = None, **commands: Sequence[Any]) -> "Held":
        return Held(self._service.hold(seconds=seconds, feed=feed, timeout=timeout, **commands))

    def __getitem__(self, index: int) -> "Element":
        return Element(self._service[index])

    def __iter__(self) -> Iterator[Any]:
        return iter(self._service)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        method = getattr(self._service, name)
        if not hasattr(method, "asip_command"):
            raise AttributeError(f"asip.aio has no {name}; asip has it, without asyncio")
        command: str = method.asip_command

        @functools.wraps(method)
        async def call(*args: Any, timeout: float | None = None, **named: Any) -> Any:
            return await self.command(command, *args, timeout=timeout, **named)
        return call

    def __repr__(self) -> str:
        return repr(self._service)

    def __dir__(self) -> list[str]:
        return dir(self._service)


class Element:
    """As `asip.service.Element`."""

    def __init__(self, element: _Element):
        self._element = element

    async def read(self, event: str | None = None, *, timeout: float | None = None) -> Any:
        return await _run(self._element.read, event, timeout=timeout)


class Held:
    """As `asip.service.Held`, for `async with`."""

    def __init__(self, held: _Held):
        self._held = held

    lost = property(lambda self: self._held.lost)

    async def set(self, **commands: Sequence[Any]) -> None:
        await _run(self._held.set, **commands)

    def feed(self) -> None:
        self._held.feed()

    async def __aenter__(self) -> "Held":
        await _run(self._held.__enter__)
        return self

    async def __aexit__(self, *error: Any) -> None:
        await _run(self._held.__exit__, *error)


class Pin:
    """As `asip.Pin`."""

    def __init__(self, board: Board, pin: _Pin):
        self.board = board
        self._pin = pin

    number = property(lambda self: self._pin.number)
    level = property(lambda self: self._pin.level)
    name = property(lambda self: self._pin.name)

    async def mode(self, word: str, *, timeout: float | None = None) -> None:
        await _run(self._pin.mode, word, timeout=timeout)

    async def write(self, level: bool | int, *, timeout: float | None = None) -> None:
        await _run(self._pin.write, level, timeout=timeout)

    async def on(self, *, timeout: float | None = None) -> None:
        await _run(self._pin.on, timeout=timeout)

    async def off(self, *, timeout: float | None = None) -> None:
        await _run(self._pin.off, timeout=timeout)

    async def toggle(self, *, timeout: float | None = None) -> None:
        await _run(self._pin.toggle, timeout=timeout)

    async def pwm(self, duty: int, *, timeout: float | None = None) -> None:
        await _run(self._pin.pwm, duty, timeout=timeout)

    async def read(self, *, timeout: float | None = None) -> bool | int:
        value: bool | int = await _run(self._pin.read, timeout=timeout)
        return value

    async def wait_for(self, level: bool, *, pull_up: bool = True, timeout: float | None = None) -> None:
        await _run(self._pin.wait_for, level, pull_up=pull_up, timeout=timeout)

    async def on_change(self, function: Callable[..., Any] | None, *, initial: bool = False, pull_up: bool = True) -> None:
        """Calls `function(level)` in the event loop."""
        if function is None:
            await _run(self._pin.on_change, None)
            return
        call = _in_loop(self.board.bus, function, 1)
        await _run(self._pin.on_change, lambda level: call(level), initial=initial, pull_up=pull_up)


class Property:
    """As `asip.Property`; its value is `await one.read()`."""

    def __init__(self, board: Board, one: _Property):
        self.board = board
        self.id = one.id
        self._one = one

    async def read(self, *, timeout: float | None = None) -> Any:
        return await _run(self._one.read, timeout=timeout)

    async def write(self, value: Any = None, *, timeout: float | None = None) -> None:
        await _run(self._one.write, value, timeout=timeout)

    async def on_change(self, function: Callable[..., Any] | None, *, hz: float = 10) -> None:
        """Calls `function(value)` in the event loop."""
        call = None if function is None else _in_loop(self.board.bus, function, 1)
        await _run(self._one.on_change, None if call is None else lambda value: call(value), hz=hz)

    async def on_event(self, function: Callable[..., Any]) -> Watch:
        """Calls `function(event)` in the event loop."""
        call = _in_loop(self.board.bus, function, 1)
        watch: Watch = await _run(self._one.on_event, lambda event: call(event))
        return watch

    async def events(self, *, keep: int = 100, timeout: float | None = None) -> AsyncIterator[str]:
        stream: Stream = await _run(self._one.events, keep=keep)
        async for reading in _readings(stream, f"{self.board.name}/{self.id}", timeout):
            yield reading.value

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "value":
            raise AttributeError(name)
        return getattr(self._one, name)

    def __repr__(self) -> str:
        return repr(self._one)


class _Connecting:
    """For `async with connect() as bus` and `bus = await connect()`."""

    def __init__(self, begin: Callable[[], _bus.Bus]):
        self._begin = begin
        self._bus: Bus | None = None

    async def _connect(self) -> Bus:
        return Bus(await _run(self._begin))

    def __await__(self) -> Any:
        return self._connect().__await__()

    async def __aenter__(self) -> Bus:
        self._bus = await self._connect()
        return self._bus

    async def __aexit__(self, *_: Any) -> None:
        if self._bus is not None:
            await self._bus.close()


def connect(broker: str | None = None, *, credentials: str | None = None, user: str | None = None, password: str | None = None,
            ca: str | None = None, root: str | None = None, timeout: float = 5.0, by: str | None = None) -> _Connecting:
    """As `asip.connect()`: `async with connect() as bus`, or `bus = await connect()`."""
    return _Connecting(functools.partial(_bus.connect, broker, credentials=credentials, user=user, password=password, ca=ca, root=root,
                                         timeout=timeout, by=by))


__all__ = ["Board", "Bus", "Held", "Pin", "Property", "Service", "connect"]
