# SPDX-License-Identifier: Apache-2.0
"""The SPI bus of a board, as drivers for CircuitPython expect it (`busio.SPI`), and the pins that choose its chips.

    from adafruit_mcp3xxx.mcp3008 import MCP3008
    spi = board.spi()
    volts = MCP3008(spi, spi.chip_select(10), ref_voltage=5)

Faults are OSError, as in `asip.i2c`; EBUSY is a chip while another one is chosen.
"""
from __future__ import annotations

import threading

from . import errors
from ._chips import LineService, error_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, BinaryIO

    from ._chips import Commanded

_ROOM = 16  # bytes of a request
_TOGETHER = 64  # requests of a command
_NO_PIN = 255


class ChipSelect:
    """A pin that chooses a chip while it is low: what drivers take for a `digitalio.DigitalInOut`."""

    def __init__(self, spi: "SPI", pin: int):
        self._spi, self._pin, self._value = spi, pin, True

    def switch_to_output(self, value: bool = True, drive_mode: Any = None) -> None:
        self.value = value

    def deinit(self) -> None:
        """Nothing is to be given back."""

    @property
    def value(self) -> bool:
        return self._value

    @value.setter
    def value(self, high: bool) -> None:
        if bool(high) != self._value:
            self._spi._choose(_NO_PIN if high else self._pin)
            self._value = bool(high)


class SPI:
    """What drivers for CircuitPython take for a `busio.SPI`."""

    def __init__(self, service: Commanded, timeout: float | None, lock: threading.Lock):
        self._service, self._timeout, self._lock = service, timeout, lock
        self._kilohertz, self._mode = 100, 0
        self._pin, self._keeps = _NO_PIN, False

    def chip_select(self, pin: int) -> ChipSelect:
        """One of the pins that the sketch names; drivers have it for a time of 250 ms between two transfers at most."""
        return ChipSelect(self, pin)

    def try_lock(self) -> bool:
        """For the drivers and threads of this program."""
        return self._lock.acquire(blocking=False)

    def unlock(self) -> None:
        self._lock.release()

    def deinit(self) -> None:
        """Nothing is to be given back."""

    def configure(self, *, baudrate: int = 100000, polarity: int = 0, phase: int = 0, bits: int = 8) -> None:
        if bits != 8 or polarity not in (0, 1) or phase not in (0, 1) or baudrate < 1000:
            raise ValueError("bits is 8, polarity and phase are 0 or 1, and baudrate is 1000 or more")
        self._kilohertz, self._mode = min(baudrate // 1000, 65535), polarity << 1 | phase

    @property
    def frequency(self) -> int:
        """What was asked for: the board takes the next lower one that it has. Its slowest is a 128th of its clock, 125 kHz at 16 MHz."""
        return self._kilohertz * 1000

    def write(self, buffer: "bytes | bytearray | memoryview", *, start: int = 0, end: int | None = None) -> None:
        self._transfer(bytes(buffer)[start:end])

    def readinto(self, buffer: "bytearray | memoryview", *, start: int = 0, end: int | None = None, write_value: int = 0) -> None:
        view = memoryview(buffer).cast("B")[start:end]
        view[:] = self._transfer(bytes([write_value]) * len(view))

    def write_readinto(self, out_buffer: "bytes | bytearray | memoryview", in_buffer: "bytearray | memoryview", *, out_start: int = 0,
                       out_end: int | None = None, in_start: int = 0, in_end: int | None = None) -> None:
        out, view = bytes(out_buffer)[out_start:out_end], memoryview(in_buffer).cast("B")[in_start:in_end]
        if len(out) != len(view):
            raise ValueError(f"{len(out)} bytes are written and {len(view)} read: both are as many")
        view[:] = self._transfer(out)

    def _choose(self, pin: int) -> None:
        before, self._pin = self._pin, pin
        if self._keeps:
            self._keeps = False
            try:  # a driver that ends its transfer has a lock to give back: the board lets go by itself, later
                self._ask([b""], False, before)
            except OSError:
                pass

    def _transfer(self, data: bytes) -> bytes:
        pieces = [data[at:at + _ROOM] for at in range(0, len(data), _ROOM)]
        read = b""
        for at in range(0, len(pieces), _TOGETHER):
            keeps, self._keeps = self._pin != _NO_PIN, False  # a fault leaves nothing to be given up
            read += self._ask(pieces[at:at + _TOGETHER], keeps, self._pin)
            self._keeps = keeps
        return read

    def _ask(self, pieces: list[bytes], keeps: bool, pin: int) -> bytes:
        commands = [{"transfer": [pin, self._kilohertz, self._mode, int(keeps), one.hex().upper()]} for one in pieces]
        try:
            if len(commands) == 1:
                return bytes.fromhex(self._service.command("transfer", *commands[0]["transfer"], timeout=self._timeout))
            answers = self._service._together(commands, "transfer", timeout=self._timeout)
        except errors.Error as fault:
            raise error_of(fault) from fault
        return bytes.fromhex("".join(text for one in answers for text in one.values()))


def over(stream: BinaryIO) -> SPI:
    """The bus of a board that no agent has, or of the TCP port of an agent: see `asip.i2c.over`."""
    return SPI(LineService(stream, "V", {"transfer": "t"}), None, threading.Lock())
