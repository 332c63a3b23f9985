# SPDX-License-Identifier: Apache-2.0
"""What can go wrong, and whether the command may have been executed.

    Error                          sent   also
    ├── Invalid                    False  ValueError      the service's model does not allow it
    ├── BoardError                 True   RuntimeError    the board refused it, in its own words
    ├── Refused                    False  RuntimeError    the agent did not send it to the board
    │   └── NotThere               False  LookupError     no such board, or it is not online
    ├── Unproven                   None   TimeoutError    no answer: it may or may not have been executed
    ├── Disconnected               False  ConnectionError no broker within the time limit
    └── Closed                     False  RuntimeError    the bus was closed, or belongs to the parent process

`error.sent` answers "may I send it again?": False means that the board has not seen the command, True that it has seen and
refused it, None that nothing is known.
"""
from __future__ import annotations

from typing import Any


class Error(Exception):
    """The root of all errors of this package.

    `board`, `service` and `command` name what was asked, `reason` is a word for programs (docs/service-bus.md lists them).
    Each is None where it does not apply.
    """

    sent: bool | None = False

    def __init__(self, text: str, *, board: str | None = None, service: str | None = None, command: str | None = None,
                 reason: str | None = None):
        super().__init__(text)
        self.board = board
        self.service = service
        self.command = command
        self.reason = reason

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (type(self), self.args, self.__dict__.copy())


class Invalid(Error, ValueError):
    """The arguments do not fit the service's model. Nothing was sent."""


class BoardError(Error, RuntimeError):
    """The board refused the command. `code` is the ASIP error number, 0 where the agent names none."""

    sent = True

    def __init__(self, text: str, *, code: int = 0, **names: str | None):
        super().__init__(text, **names)
        self.code = code


class Refused(Error, RuntimeError):
    """The agent did not send the command to the board: `reason` is `queue-full`, `deadline`, `stopped`, `id-reused` ..."""


class NotThere(Refused, LookupError):
    """There is no such board, or it is not online. The text says why, and names the nearest name."""


class Unproven(Error, TimeoutError):
    """No proof within the time limit. The command may or may not have been executed; `reason` may tell more (`doubt`)."""

    sent = None


class Disconnected(Error, ConnectionError):
    """There was no usable broker within the time limit. Nothing was sent."""


class Closed(Error, RuntimeError):
    """The bus was closed, or it was opened before a fork and is used by the child. Nothing was sent."""


def _rebuild(cls: type[Error], args: tuple[Any, ...], state: dict[str, Any]) -> Error:
    made = cls.__new__(cls)
    made.args = args
    made.__dict__.update(state)
    return made


def from_answer(answer: dict[str, Any], *, board: str, service: str | None = None, command: str | None = None) -> Error | None:
    """The error that a final answer of an agent stands for; None where its status is `ok`."""
    status = answer.get("status")
    reason = str(answer["reason"]) if answer.get("reason") else None
    where = f"{board}/{service}" if service else board
    what = f"{where} {command}" if command else where
    words = str(answer.get("error") or "")
    names = {"board": board, "service": service, "command": command, "reason": reason}
    if status == "ok":
        return None
    if status == "error":
        code = answer.get("code")
        number = code if isinstance(code, int) and not isinstance(code, bool) else 0
        return BoardError(f"{what}: the board refused it: {words or 'no reason given'} (error {number})", code=number, **names)
    if status == "refused":
        kind = NotThere if reason == "board-not-there" else Invalid if reason == "invalid" else Refused
        return kind(f"{what}: not sent to the board: {words or reason or 'no reason given'}", **names)
    if status == "timeout":
        return Unproven(f"{what}: {_UNPROVEN.get(reason or '', 'the board gave no proof in time')}; "
                        f"it may or may not have been executed", **names)
    return Unproven(f"{what}: the answer cannot be read (status {status!r}); it may or may not have been executed", **names)


_UNPROVEN = {
    "doubt": "something on the line to the board was lost or damaged",
    "partly": "some of its lines were sent and others were not",
    "no-value": "executed, but the value that was asked for did not come",
    "board-not-there": "the board did not confirm it in time",
}
