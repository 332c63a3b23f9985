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
from typing import Any, AsyncIterator, Awaitable, Callable, Iterable, Iterator, Mapping, Sequence

from . import bus as _bus
from . import errors
from ._twin import Twin, in_loop, readings, run, same, waits
from .board import Board as _Board
from .i2c import I2C, SMBus
from .onewire import OneWire
from .pin import Pin as _Pin
from .property import Property as _Property
from .service import Element as _Element
from .service import Held as _Held
from .service import Service as _Service
from .service import Watch
from .spi import SPI
from .stream import Stream


class Bus(Twin):
    """As `asip.Bus`. It belongs to the event loop in which it was entered."""

    _one: _bus.Bus

    def __init__(self, bus: _bus.Bus):
        super().__init__(bus)
        self._loop = asyncio.get_running_loop()
        self.on_error: Callable[[BaseException], None] | None = None

    timeout, connected, settings = (same(name) for name in ("timeout", "connected", "settings"))
    stop, query, close = waits(_bus.Bus.stop), waits(_bus.Bus.query), waits(_bus.Bus.close)
    link, unlink = waits(_bus.Bus.link), waits(_bus.Bus.unlink)

    def _check_loop(self) -> None:
        if asyncio.get_running_loop() is not self._loop:
            raise errors.Closed("this bus belongs to another event loop; connect in this one")

    async def board(self, name: str, *, timeout: float | None = None) -> Board:
        self._check_loop()
        return Board(self, await run(self._one.board, name, timeout=timeout))

    async def boards(self, pattern: str = "*", *, labels: str | None = None, timeout: float | None = None) -> list[Board]:
        self._check_loop()
        return [Board(self, one) for one in await run(self._one.boards, pattern, labels=labels, timeout=timeout)]

    def watch(self, function: Callable[..., Any]) -> Watch:
        """Calls `function(board, state)` in the event loop."""
        self._check_loop()
        call = in_loop(self, function, 2)
        return self._one.watch(lambda board, state: call(Board(self, board), state))

    async def __aenter__(self) -> Bus:
        return self

    async def __aexit__(self, *_: Any) -> None:
        await self.close()


class Board(Twin):
    """As `asip.Board`."""

    _one: _Board

    def __init__(self, bus: Bus, board: _Board):
        super().__init__(board)
        self.bus = bus

    name, state, reason, status, online, labels, description = (
        same(name) for name in ("name", "state", "reason", "status", "online", "labels", "description"))
    wait_for, raw, name_pins, stop, resume = waits(_Board.wait_for), waits(_Board.raw), waits(_Board.name_pins), waits(_Board.stop), waits(_Board.resume)

    async def label(self, **labels: str | None) -> None:
        await run(self._one.label, **labels)

    async def set_meaning(self, id: str, kind: str | None = "", **members: Any) -> None:
        await run(self._one.set_meaning, id, kind, **members)

    @property
    def services(self) -> Mapping[str, Service]:
        return {name: Service(self, one) for name, one in self._one.services.items()}

    @property
    def properties(self) -> Awaitable[list[Property]]:
        """`await board.properties`"""
        return self._all_properties()

    async def _all_properties(self) -> list[Property]:
        return [Property(self, one) for one in await run(lambda: self._one.properties)]

    def property(self, id: str) -> Property:
        """It is looked for when it is read or written."""
        return Property(self, self._one._property(id))

    def i2c(self, *, timeout: float | None = None) -> I2C:
        """As `asip.Board.i2c()`: drivers wait, so work with it in threads, `await asyncio.to_thread(...)`."""
        return self._one.i2c(timeout=timeout)

    def smbus(self, *, timeout: float | None = None) -> SMBus:
        """As `i2c()`."""
        return self._one.smbus(timeout=timeout)

    def onewire(self, *, timeout: float | None = None) -> OneWire:
        """As `i2c()`."""
        return self._one.onewire(timeout=timeout)

    def spi(self, *, timeout: float | None = None) -> SPI:
        """As `i2c()`."""
        return self._one.spi(timeout=timeout)

    def pin(self, which: int | str) -> Pin:
        return Pin(self, self._one.pin(which))

    def __getitem__(self, name: str) -> Any:
        return self.property(name) if isinstance(name, str) and "/" in name else Service(self, self._one[name])

    def __contains__(self, name: object) -> bool:
        return name in self._one

    def __iter__(self) -> Iterator[Service]:
        return iter([Service(self, one) for one in self._one])

    def __getattr__(self, name: str) -> Service:
        if name.startswith("_"):
            raise AttributeError(name)
        return Service(self, getattr(self._one, name))


class Service(Twin):
    """As `asip.Service`."""

    _one: _Service

    def __init__(self, board: Board, service: _Service):
        super().__init__(service)
        self.board = board

    name, title, unit, updated, model = (same(name) for name in ("name", "title", "unit", "updated", "model"))
    read, history = waits(_Service.read), waits(_Service.history)

    async def command(self, name: str, *args: Any, timeout: float | None = None, **named: Any) -> Any:
        self.board.bus._check_loop()
        return await asyncio.wrap_future(self._one.begin(name, *args, timeout=timeout, **named))

    async def stream(self, *, hz: float = 10, event: str | None = None, keep: int = 1, lost: str = "raise", details: bool = False,
                     timeout: float | None = None) -> AsyncIterator[Any]:
        self.board.bus._check_loop()
        stream = self._one.stream(hz=hz, event=event, keep=keep, lost=lost, details=True, timeout=None)
        async for reading in readings(stream, f"{self.board.name}/{self.name}", timeout):
            yield reading if details else reading.value

    def on_value(self, function: Callable[..., Any], *, hz: float = 10, event: str | None = None) -> Watch:
        """Calls `function(value)` in the event loop."""
        call = in_loop(self.board.bus, function, 1)
        return self._one.on_value(lambda value: call(value), hz=hz, event=event)

    def hold(self, *, seconds: float = 0.5, feed: float | None = None, timeout: float | None = None, **commands: Sequence[Any]) -> Held:
        return Held(self._one.hold(seconds=seconds, feed=feed, timeout=timeout, **commands))

    def __getitem__(self, index: int) -> Element:
        return Element(self._one[index])

    def __iter__(self) -> Iterator[Any]:
        return iter(self._one)

    def __getattr__(self, name: str) -> Callable[..., Any]:
        method = getattr(self._one, name)
        if not hasattr(method, "asip_command"):
            raise AttributeError(f"asip.aio has no {name}; asip has it, without asyncio")
        command: str = method.asip_command

        @functools.wraps(method)
        async def call(*args: Any, timeout: float | None = None, **named: Any) -> Any:
            return await self.command(command, *args, timeout=timeout, **named)
        return call


class Element(Twin):
    """As `asip.service.Element`."""

    _one: _Element
    read = waits(_Element.read)


class Held(Twin):
    """As `asip.service.Held`, for `async with`."""

    _one: _Held
    lost = same("lost")

    async def set(self, **commands: Sequence[Any]) -> None:
        await run(self._one.set, **commands)

    def feed(self) -> None:
        self._one.feed()

    async def __aenter__(self) -> Held:
        await run(self._one.__enter__)
        return self

    async def __aexit__(self, *error: Any) -> None:
        await run(self._one.__exit__, *error)


class Pin(Twin):
    """As `asip.Pin`."""

    _one: _Pin

    def __init__(self, board: Board, pin: _Pin):
        super().__init__(pin)
        self.board = board

    number, level, name = (same(name) for name in ("number", "level", "name"))
    mode, write, on, off = waits(_Pin.mode), waits(_Pin.write), waits(_Pin.on), waits(_Pin.off)
    toggle, pwm, read, wait_for = waits(_Pin.toggle), waits(_Pin.pwm), waits(_Pin.read), waits(_Pin.wait_for)

    async def on_change(self, function: Callable[..., Any] | None, *, initial: bool = False, pull_up: bool = True) -> None:
        """Calls `function(level)` in the event loop."""
        call = None if function is None else in_loop(self.board.bus, function, 1)
        await run(self._one.on_change, None if call is None else lambda level: call(level), initial=initial, pull_up=pull_up)


class Property(Twin):
    """As `asip.Property`; its value is `await one.read()`."""

    _one: _Property

    def __init__(self, board: Board, one: _Property):
        super().__init__(one)
        self.board = board
        self.id = one.id

    read, write, history = waits(_Property.read), waits(_Property.write), waits(_Property.history)

    async def on_change(self, function: Callable[..., Any] | None, *, hz: float = 10) -> None:
        """Calls `function(value)` in the event loop."""
        call = None if function is None else in_loop(self.board.bus, function, 1)
        await run(self._one.on_change, None if call is None else lambda value: call(value), hz=hz)

    async def on_event(self, function: Callable[..., Any]) -> Watch:
        """Calls `function(event)` in the event loop."""
        call = in_loop(self.board.bus, function, 1)
        watch: Watch = await run(self._one.on_event, lambda event: call(event))
        return watch

    async def events(self, *, keep: int = 100, timeout: float | None = None) -> AsyncIterator[str]:
        stream: Stream = await run(self._one.events, keep=keep)
        async for reading in readings(stream, f"{self.board.name}/{self.id}", timeout):
            yield reading.value

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "value":
            raise AttributeError(name)
        return getattr(self._one, name)


class _Connecting:
    """For `async with connect() as bus` and `bus = await connect()`."""

    def __init__(self, begin: Callable[[], _bus.Bus]):
        self._begin = begin
        self._bus: Bus | None = None

    async def _connect(self) -> Bus:
        return Bus(await run(self._begin))

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
