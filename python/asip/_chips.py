# SPDX-License-Identifier: Apache-2.0
"""Transfers on a board's I2C bus, as commands of its service `i2c` (docs/protocol.md), and such services by the lines of a board. What is made
of messages is pure."""
from __future__ import annotations

import errno
import itertools
import random
import threading

from . import errors

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, BinaryIO, Callable, Protocol, Sequence, Union

    Message = tuple[int, Union[bytes, int]]  # the address of a chip, and what is written to it or how many bytes are read
    Command = tuple[str, list[Any]]

    class Commanded(Protocol):
        """A service of a board, by whatever brings its commands there."""

        def command(self, name: str, *args: Any, timeout: float | None = None) -> Any: ...

        def _together(self, commands: list[dict[str, list[Any]]], what: str, *, timeout: float | None = None) -> list[dict[str, Any]]: ...

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
    """The bus of one board, as this program sees it. From any thread. Several commands are one request of the service."""

    def __init__(self, service: Commanded, timeout: float | None = None):
        self._service, self._timeout = service, timeout
        self._numbers = itertools.count(random.randrange(100))
        self.lock = threading.Lock()

    def scan(self) -> list[int]:
        try:
            found: list[int] = self._service.command("scan", timeout=self._timeout)
            return found
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
            answers = self._answers(commands)
        except errors.Error as fault:
            raise error_of(fault) from fault
        return _shared_out(messages, bytes.fromhex("".join(answers)))

    def _answers(self, commands: Sequence[Command]) -> list[str]:
        if len(commands) == 1:
            return [self._service.command(commands[0][0], *commands[0][1], timeout=self._timeout)]
        answers = self._service._together([{name: args} for name, args in commands], "transfer", timeout=self._timeout)
        return [text for one in answers for text in one.values()]


def _shared_out(messages: Sequence[Message], data: bytes) -> list[bytes]:
    counts = [what for _, what in messages if isinstance(what, int)]
    if len(data) != sum(counts):
        raise OSError(errno.EIO, f"{len(data)} bytes came where {sum(counts)} were read")
    ends = list(itertools.accumulate(counts))
    return [data[end - count:end] for count, end in zip(counts, ends)]


class LineService:
    """A service of a board by its lines, or by the port of its agent, in the place of one on the bus: point to point."""

    def __init__(self, stream: BinaryIO, letter: str, tags: dict[str, str], silent: str = "", read: Callable[[str, str], Any] = lambda tag, body: body):
        """`tags` by command; the board says nothing to those of `silent`. `read` makes a value of tag and body of an answer."""
        self._stream, self._letter, self._tags, self._silent, self._read = stream, letter, tags, silent, read
        self._lock = threading.Lock()
        self._fences = itertools.count(random.randrange(1000))
        self._owes = False  # the board may still send what it was asked for before

    def command(self, name: str, *args: Any, timeout: float | None = None) -> Any:
        return self._together([{name: [*args]}], name)[0]["answer"]

    def _together(self, commands: list[dict[str, list[Any]]], what: str, *, timeout: float | None = None) -> list[dict[str, Any]]:
        with self._lock:
            self._catch_up()
            answers = [self._one(self._tags[name], args) for one in commands for name, args in one.items()]
        return [{"answer": answer} for answer in answers if answer is not None]

    def _one(self, tag: str, args: list[Any]) -> Any:
        line = ",".join([self._letter, tag, *map(str, args)])
        if tag in self._silent:  # the fence behind it shows that it was read
            fence = self._fence()
            self._ask(f"{line}\n{fence}", f"@{fence}")
            return None
        return self._read(tag, self._ask(line, f"@{self._letter},{tag},"))

    def _fence(self) -> str:
        return f"#,E,chip{next(self._fences) % 1000:03}"

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
            if errors_count and line.startswith(f"~{self._letter},"):
                number, _, text = line[len("~J,t,"):].partition("{")
                raise errors.BoardError(text.rstrip("}"), code=int(number) if number.isdigit() else 0)
