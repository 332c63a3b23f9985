# SPDX-License-Identifier: Apache-2.0
"""The 1-Wire bus of a board, as drivers for CircuitPython expect it (`OneWireBus` of `adafruit_onewire.bus`).

    from adafruit_ds18x20 import DS18X20
    wire = board.onewire()
    print([DS18X20(wire, address).temperature for address in wire.scan()])

Faults are OSError: ENODEV where no device answers or the line is low, the others as in `asip.i2c`.
"""
from __future__ import annotations

import errno

from . import errors
from ._chips import LineService, error_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, BinaryIO

    from ._chips import Commanded

_ROOM = 16  # bytes of a request, each way
_SELECTIONS = {0x55: 9, 0xCC: 1}  # bytes that choose a device, or all: nothing happens before another follows


class Address:
    """The id of a device."""

    def __init__(self, rom: bytes):
        self.rom = bytearray(rom)

    @property
    def family_code(self) -> int:
        return self.rom[0]

    @property
    def serial_number(self) -> bytearray:
        return self.rom[1:7]

    @property
    def crc(self) -> int:
        return self.rom[7]

    def __repr__(self) -> str:
        return f"<asip.onewire.Address {self.rom.hex().upper()}>"


class OneWire:
    """What drivers take for an `adafruit_onewire.bus.OneWireBus`. What chooses a device goes with the byte behind it as one request, so
    that nobody comes between; what is read follows as another one."""

    def __init__(self, service: Commanded, timeout: float | None):
        self._service, self._timeout = service, timeout
        self._chosen: bytes | None = None  # written since the reset and not sent yet
        self.maximum_devices = 64

    def reset(self, required: bool = False) -> bool:
        """Whether a device is there."""
        self._chosen = b""
        present = bool(self._ask("reset"))
        if required and not present:
            raise OSError(errno.ENODEV, "no device answers")
        return present

    def write(self, buf: "bytes | bytearray | memoryview", *, start: int = 0, end: int | None = None) -> None:
        data = bytes(buf)[start:end]
        if self._chosen is not None:
            self._chosen += data
            if len(self._chosen) <= _SELECTIONS.get((self._chosen or b"\0")[0], 0):
                return
            data = self._chosen
        self._send(data, 0)

    def readinto(self, buf: "bytearray | memoryview", *, start: int = 0, end: int | None = None) -> None:
        view = memoryview(buf).cast("B")[start:end]
        read = b"" if len(view) == 0 else self._send(self._chosen or b"", len(view))
        view[:] = read

    def scan(self) -> list[Address]:
        """The devices, by their ids."""
        found: list[Address] = []
        while rom := self._ask("find", len(found)):
            if len(found) == self.maximum_devices:
                raise RuntimeError(f"more than {self.maximum_devices} devices")
            found.append(Address(bytes.fromhex(rom)))
        return found

    @staticmethod
    def crc8(data: "bytes | bytearray") -> int:
        """The checksum of an id or of a scratchpad: 0 behind the last of its bytes."""
        crc = 0
        for byte in data:
            crc ^= byte
            for _ in range(8):
                crc = crc >> 1 ^ (0x8C if crc & 1 else 0)
        return crc

    def _send(self, data: bytes, count: int) -> bytes:
        """Writes, then reads so many bytes; resets the bus before, where that is due."""
        name = "continue" if self._chosen is None else "transfer"
        self._chosen = None
        while len(data) > _ROOM:
            self._ask(name, 0, data[:_ROOM].hex().upper())
            name, data = "continue", data[_ROOM:]
        read = b""
        while True:
            part = min(count - len(read), _ROOM)
            read += bytes.fromhex(self._ask(name, part, data.hex().upper()))
            name, data = "continue", b""
            if len(read) >= count:
                return read

    def _ask(self, name: str, *args: Any) -> Any:
        try:
            return self._service.command(name, *args, timeout=self._timeout)
        except errors.BoardError as fault:
            if fault.code != 8:
                raise error_of(fault) from fault
            raise OSError(errno.ENODEV, str(fault)) from fault
        except errors.Error as fault:
            raise error_of(fault) from fault


def over(stream: BinaryIO) -> OneWire:
    """The bus of a board that no agent has, or of the TCP port of an agent: see `asip.i2c.over`."""
    tags = {"reset": "R", "find": "S", "transfer": "T", "continue": "t"}
    return OneWire(LineService(stream, "O", tags, read=lambda tag, body: int(body) if tag == "R" else body), None)
