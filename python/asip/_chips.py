# SPDX-License-Identifier: Apache-2.0
"""Transfers on a board's I2C bus, as commands of its service `i2c` (docs/protocol.md). What is made of messages is pure."""
from __future__ import annotations

import errno
import itertools
import random
import threading

from . import errors

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, BinaryIO, Protocol, Sequence, Union

    from ._commands import Commands

    Message = tuple[int, Union[bytes, int]]  # the address of a chip, and what is written to it or how many bytes are read
    Command = tuple[str, list[Any]]

    class Carrier(Protocol):
        """What brings commands to a board."""

        def scan(self) -> list[int]: ...

        def commands(self, commands: Sequence[Command]) -> list[str]: ...

WRITTEN = 18  # bytes that a request has room for beside the fence behind it
READ = 16
MAX_COMMANDS = 64

# The errors of the board, as Linux tells them of a bus of its own.
_NUMBERS = {6: errno.ETIMEDOUT, 8: errno.EBUSY, 9: errno.ENODEV, 12: errno.EREMOTEIO, 13: errno.EIO, 14: errno.EBUSY,
            15: errno.ETIMEDOUT, 16: errno.EMSGSIZE}


def error_of(fault: errors.Error) -> OSError:
    """The same as an OSError, since that is what drivers expect."""
    if isinstance(fault, errors.BoardError):
        number = _NUMBERS.get(fault.code, errno.EIO)
    elif isinstance(fault, errors.Unproven):
        number = errno.ETIMEDOUT
    elif isinstance(fault, errors.Invalid):
        number = errno.EINVAL
    elif fault.reason == "queue-full":
        number = errno.EAGAIN
    else:
        number = errno.ENODEV
    return OSError(number, str(fault))


def _pieces(data: bytes, size: int) -> list[bytes]:
    return [data[at:at + size] for at in range(0, len(data), size)] or [b""]


def commands_of(messages: Sequence[Message], number: int) -> list[Command]:
    """The commands that are this transfer, from one START to one STOP; `number` is its own where it takes several."""
    one = _single(messages)
    if one:
        return [one]
    made: list[Command] = []
    for address, what in messages[:-1]:
        made += _opening(number, address, what)
        if isinstance(what, int):
            made += [("receive", [number, count, int(more)]) for count, more in _counts(what)]
    address, what = messages[-1]
    turns = made and isinstance(what, int) and messages[-2][0] == address and not isinstance(messages[-2][1], int)
    if not turns:
        made += _opening(number, address, what)
    if isinstance(what, int):
        counts = _counts(what)
        made += [("receive", [number, count, 1]) for count, _ in counts[:-1]]
        made.append(("end", [number, counts[-1][0], ""]))
    elif len(what) <= WRITTEN:
        made.append(("end", [number, 0, ""]))
    else:
        name, (_, rest) = made.pop()
        made.append(("end", [number, 0, rest]))
    return made


def _single(messages: Sequence[Message]) -> Command | None:
    written, read = b"", 0
    (address, first), *others = messages
    if isinstance(first, int):
        read = first
    else:
        written = first
    if others:
        (other, second), *more = others
        if more or other != address or isinstance(first, int) or not isinstance(second, int) or not first:
            return None
        read = second
    if len(written) > WRITTEN or read > READ:
        return None
    return "transfer", [address, read, written.hex().upper()]


def _opening(number: int, address: int, what: bytes | int) -> list[Command]:
    first, *more = _pieces(b"" if isinstance(what, int) else what, WRITTEN)
    opened: list[Command] = [("open", [number, address, first.hex().upper()])]
    return opened + [("send", [number, one.hex().upper()]) for one in more]


def _counts(count: int) -> list[tuple[int, bool]]:
    """The sizes of the parts of a reading, and whether more parts follow."""
    full, rest = divmod(count, READ)
    sizes = [READ] * full + ([rest] if rest else [])
    return [(size, at < len(sizes) - 1) for at, size in enumerate(sizes)]


class Transfers:
    """The bus of one board, as this program sees it. From any thread."""

    def __init__(self, carrier: Carrier):
        self._carrier = carrier
        self._numbers = itertools.count(random.randrange(100))
        self.lock = threading.Lock()

    def scan(self) -> list[int]:
        try:
            return self._carrier.scan()
        except errors.Error as fault:
            raise error_of(fault) from fault

    def transfer(self, *messages: Message) -> list[bytes]:
        """What each message that reads has read."""
        for address, what in messages:
            if not 0 <= address <= 127:
                raise ValueError(f"{address} is no address: 0 to 127")
            if what == 0:
                raise ValueError("no byte is to be read: a chip sends one at least")
        commands = commands_of(messages, next(self._numbers) % 100)
        if len(commands) > MAX_COMMANDS:
            raise OSError(errno.EMSGSIZE, f"the transfer takes {len(commands)} requests, above {MAX_COMMANDS}")
        try:
            answers = self._carrier.commands(commands)
        except errors.Error as fault:
            raise error_of(fault) from fault
        return _shared_out(messages, bytes.fromhex("".join(answers)))


def _shared_out(messages: Sequence[Message], data: bytes) -> list[bytes]:
    counts = [what for _, what in messages if isinstance(what, int)]
    if len(data) != sum(counts):
        raise OSError(errno.EIO, f"{len(data)} bytes came where {sum(counts)} were read")
    ends = list(itertools.accumulate(counts))
    return [data[end - count:end] for count, end in zip(counts, ends)]


class BusCarrier:
    """By a service of a board on the bus. Several commands are one request of it."""

    def __init__(self, service: Commands, timeout: float | None):
        self._service, self._timeout = service, timeout

    def scan(self) -> list[int]:
        found: list[int] = self._service.command("scan", timeout=self._timeout)
        return found

    def commands(self, commands: Sequence[Command]) -> list[str]:
        if len(commands) == 1:
            return [self._service.command(commands[0][0], *commands[0][1], timeout=self._timeout)]
        answers = self._service._together([{name: args} for name, args in commands], "transfer", timeout=self._timeout)
        return [text for one in answers for text in one.values()]


class LineCarrier:
    """By the lines of a board, or of the port of its agent: point to point."""

    _TAGS = {"transfer": "t", "open": "o", "send": "w", "receive": "r", "end": "e"}

    def __init__(self, stream: BinaryIO):
        self._stream = stream
        self._lock = threading.Lock()
        self._fences = itertools.count(random.randrange(1000))
        self._owes = False  # the board may still send what it was asked for before

    def scan(self) -> list[int]:
        with self._lock:
            self._catch_up()
            body = self._ask("J,s", "@J,s,")
        return [int(one) for one in body[body.index("{") + 1:-1].split(",") if one]

    def commands(self, commands: Sequence[Command]) -> list[str]:
        with self._lock:
            self._catch_up()
            return [answer for name, args in commands if (answer := self._one(self._TAGS[name], args)) is not None]

    def _one(self, tag: str, args: list[Any]) -> str | None:
        line = ",".join(["J", tag, *map(str, args)])
        if tag in "ow":  # the board says nothing of these: the fence behind one shows that it was read
            fence = self._fence()
            self._ask(f"{line}\n{fence}", f"@{fence}")
            return None
        return self._ask(line, f"@J,{tag},")

    def _fence(self) -> str:
        return f"#,E,i2c{next(self._fences) % 1000:03}"

    def _catch_up(self) -> None:
        """Past late answers and errors, so that none is taken for the next one."""
        if self._owes:
            fence = self._fence()
            self._ask(fence, f"@{fence}", errors_count=False)

    def _ask(self, lines: str, answer: str, errors_count: bool = True) -> str:
        self._owes = True
        self._stream.write(lines.encode() + b"\n")
        self._stream.flush()
        while True:
            got = self._stream.readline()
            if not got.endswith(b"\n"):
                raise OSError(errno.ETIMEDOUT, "the board did not answer in time")
            line = got.decode("ascii", "replace").strip()
            if line.startswith(answer):
                self._owes = False
                return line[len(answer):]
            if errors_count and line.startswith("~J,"):
                number, _, text = line[len("~J,t,"):].partition("{")
                raise error_of(errors.BoardError(text.rstrip("}"), code=int(number) if number.isdigit() else 0))
