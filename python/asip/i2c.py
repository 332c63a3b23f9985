# SPDX-License-Identifier: Apache-2.0
"""The I2C bus of a board, in the shapes that drivers for chips expect: `busio.I2C` of CircuitPython, and `smbus2.SMBus`.

    import adafruit_bme280.basic
    sensor = adafruit_bme280.basic.Adafruit_BME280_I2C(board.i2c())
    print(sensor.temperature)

Faults are OSError with the numbers that Linux has for them: EREMOTEIO where no chip acknowledges the address, EIO where one does not
acknowledge a byte, EBUSY where the bus is held low, ETIMEDOUT where a chip holds the clock or the board does not answer.
"""
from __future__ import annotations

import errno

from ._chips import LineService, Transfers

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, BinaryIO, Iterable, Sequence


class I2C:
    """What drivers for CircuitPython take for a `busio.I2C`."""

    def __init__(self, transfers: Transfers):
        self._transfers = transfers

    def try_lock(self) -> bool:
        """For the drivers and threads of this program; each transfer is whole in any case, whoever else uses the bus."""
        return self._transfers.lock.acquire(blocking=False)

    def unlock(self) -> None:
        self._transfers.lock.release()

    def deinit(self) -> None:
        """Nothing is to be given back."""

    def __enter__(self) -> "I2C":
        return self

    def __exit__(self, *_: Any) -> None:
        self.deinit()

    def scan(self) -> list[int]:
        """The addresses at which chips answer."""
        return self._transfers.scan()

    def writeto(self, address: int, buffer: "bytes | bytearray | memoryview | str", *, start: int = 0, end: int | None = None, stop: bool = True) -> None:
        if not stop:
            raise NotImplementedError("a write without a STOP: use writeto_then_readfrom()")
        self._transfers.transfer((address, _part(buffer, start, end)))

    def readfrom_into(self, address: int, buffer: "bytearray | memoryview", *, start: int = 0, end: int | None = None) -> None:
        self._read([], address, buffer, start, end)

    def writeto_then_readfrom(self, address: int, out_buffer: "bytes | bytearray | memoryview | str", in_buffer: "bytearray | memoryview", *,
                              out_start: int = 0, out_end: int | None = None, in_start: int = 0, in_end: int | None = None,
                              stop: bool = False) -> None:
        """A repeated START stands between them; `stop` is what older drivers say of that, and does not count."""
        self._read([(address, _part(out_buffer, out_start, out_end))], address, in_buffer, in_start, in_end)

    def _read(self, before: "list[tuple[int, bytes | int]]", address: int, buffer: "bytearray | memoryview", start: int, end: int | None) -> None:
        view = memoryview(buffer).cast("B")[start:end]
        if len(view) > 0:
            view[:] = self._transfers.transfer(*before, (address, len(view)))[0]
        elif before:
            self._transfers.transfer(*before)


def _part(buffer: "bytes | bytearray | memoryview | str", start: int, end: int | None) -> bytes:
    return bytes(buffer.encode() if isinstance(buffer, str) else buffer)[start:end]


class SMBus:
    """What programs take for a `smbus2.SMBus` (or `smbus.SMBus`). `force` does not count: no driver of a kernel has a chip here."""

    def __init__(self, transfers: Transfers):
        self._transfers = transfers
        self.fd = None

    def open(self, bus: Any) -> None:
        """It is open."""

    def close(self) -> None:
        """Nothing is to be given back."""

    def __enter__(self) -> "SMBus":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    @property
    def pec(self) -> int:
        return 0

    @pec.setter
    def pec(self, enable: int) -> None:
        self.enable_pec(bool(enable))

    def enable_pec(self, enable: bool = True) -> None:
        if enable:
            raise OSError(errno.EOPNOTSUPP, "no checksums of SMBus packets here")

    def write_quick(self, i2c_addr: int, force: Any = None) -> None:
        self._transfers.transfer((i2c_addr, b""))

    def read_byte(self, i2c_addr: int, force: Any = None) -> int:
        return self._transfers.transfer((i2c_addr, 1))[0][0]

    def write_byte(self, i2c_addr: int, value: int, force: Any = None) -> None:
        self._transfers.transfer((i2c_addr, bytes([value])))

    def read_byte_data(self, i2c_addr: int, register: int, force: Any = None) -> int:
        return self._read(i2c_addr, [register], 1)[0]

    def write_byte_data(self, i2c_addr: int, register: int, value: int, force: Any = None) -> None:
        self._transfers.transfer((i2c_addr, bytes([register, value])))

    def read_word_data(self, i2c_addr: int, register: int, force: Any = None) -> int:
        return int.from_bytes(self._read(i2c_addr, [register], 2), "little")

    def write_word_data(self, i2c_addr: int, register: int, value: int, force: Any = None) -> None:
        self._transfers.transfer((i2c_addr, bytes([register]) + value.to_bytes(2, "little")))

    def process_call(self, i2c_addr: int, register: int, value: int, force: Any = None) -> int:
        return int.from_bytes(self._read(i2c_addr, [register, *value.to_bytes(2, "little")], 2), "little")

    def read_i2c_block_data(self, i2c_addr: int, register: int, length: int = 32, force: Any = None) -> list[int]:
        return list(self._read(i2c_addr, [register], length))

    def write_i2c_block_data(self, i2c_addr: int, register: int, data: Sequence[int], force: Any = None) -> None:
        self._transfers.transfer((i2c_addr, bytes([register, *data])))

    def read_block_data(self, i2c_addr: int, register: int, force: Any = None) -> list[int]:
        return _counted(self._read(i2c_addr, [register], 33))

    def write_block_data(self, i2c_addr: int, register: int, data: Sequence[int], force: Any = None) -> None:
        self._transfers.transfer((i2c_addr, bytes([register, len(data), *data])))

    def block_process_call(self, i2c_addr: int, register: int, data: Sequence[int], force: Any = None) -> list[int]:
        return _counted(self._read(i2c_addr, [register, len(data), *data], 33))

    def i2c_rdwr(self, *i2c_msgs: Any) -> None:
        """Messages as `smbus2.i2c_msg` makes them: one transfer, without a STOP between them."""
        messages = [(message.addr, message.len if message.flags & 1 else bytes(iter(message))) for message in i2c_msgs]
        if not messages:
            return
        read = iter(self._transfers.transfer(*messages))
        for message in i2c_msgs:
            if message.flags & 1:
                for at, byte in enumerate(next(read)):
                    message.buf[at] = bytes([byte])

    def _read(self, address: int, written: Iterable[int], count: int) -> bytes:
        return self._transfers.transfer((address, bytes(written)), (address, count))[0]


def _counted(data: bytes) -> list[int]:
    """A block of SMBus: how many bytes, and these."""
    return list(data[1:1 + min(data[0], 32)])


def _transfers_over(stream: BinaryIO) -> Transfers:
    tags = {"scan": "s", "transfer": "t", "open": "o", "send": "w", "receive": "r", "end": "e"}
    return Transfers(LineService(stream, "J", tags, "ow", _read_line))


def _read_line(tag: str, body: str) -> Any:
    return [int(one) for one in body[body.index("{") + 1:-1].split(",") if one] if tag == "s" else body


def over(stream: BinaryIO) -> I2C:
    """The bus of a board that no agent has, or of the TCP port of an agent: `over(serial.Serial("/dev/ttyACM0", 57600, timeout=1))`,
    `over(socket.create_connection(("localhost", 6789), 2).makefile("rwb"))`. Nothing else may read or write that stream meanwhile."""
    return I2C(_transfers_over(stream))


def smbus_over(stream: BinaryIO) -> SMBus:
    """The same for programs of smbus2."""
    return SMBus(_transfers_over(stream))
