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

TYPE_CHECKING = False
if TYPE_CHECKING:
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


_MAYBE = "; it may or may not have been executed"
_TIMEOUTS = {
    "": "the board gave no proof in time",
    "doubt": "something on the line to the board was lost or damaged",
    "partly": "some of its lines were sent and others were not",
    "no-value": "it was executed, but the value that was asked for did not come",
    "board-not-there": "the board did not confirm it in time",
    "no-answer": "nothing answered in time",
    "connection": "the connection to the broker broke before the answer came",
}
_REFUSALS = {
    "invalid": "the board has no such command, or not with these arguments",
    "queue-full": "too many commands wait",
    "board-not-there": "the board is not there",
    "deadline": "its time was over before it could be sent",
    "id-reused": "another command had this id within the last minute",
    "retained": "a stored command is never executed",
    "stopped": "the board was stopped",
    "not-held": "there is nothing to renew",
    "released": "the port is in other hands",
    "not-released": "the port was not released",
    "speaks-asip": "the board runs ASIP already",
    "not-loaded": "the firmware was not loaded",
    "not-kept": "it could not be kept",
    "denied": "the broker's access rules deny it",
}


def _member(answer: dict[str, Any], name: str) -> str:
    value = answer.get(name)
    return value if isinstance(value, str) else ""


def sentence(answer: dict[str, Any]) -> str:
    """What a final answer means, as every program says it: tests/vectors/answers.json. Empty: it was executed."""
    status, reason, words = answer.get("status"), _member(answer, "reason"), _member(answer, "error")
    if status == "ok":
        return ""
    if status == "error":
        return f"the board refused it{f': {words}' if words else ''} (error {_code(answer)})"
    if status == "refused":
        words = words or _REFUSALS.get(reason, "")
        return f"refused{f' ({reason})' if reason else ''}{f': {words}' if words else ''}"
    if status != "timeout":
        return f"the answer cannot be read{_MAYBE}"
    return (words or _TIMEOUTS.get(reason, _TIMEOUTS[""])) + ("" if reason == "no-value" else _MAYBE)


def _code(answer: dict[str, Any]) -> int:
    code = answer.get("code")
    return code if type(code) is int else 0


def from_answer(answer: dict[str, Any], *, board: str, service: str | None = None, command: str | None = None) -> Error | None:
    """The error that a final answer of an agent stands for; None where its status is `ok`."""
    text, status, reason = sentence(answer), answer.get("status"), _member(answer, "reason") or None
    if not text:
        return None
    what = " ".join(filter(None, [f"{board}/{service}" if service else board, command]))
    names = {"board": board, "service": service, "command": command, "reason": reason}
    if status == "error":
        return BoardError(f"{what}: {text}", code=_code(answer), **names)
    kind = Unproven if status != "refused" else NotThere if reason == "board-not-there" else Invalid if reason == "invalid" else Refused
    return kind(f"{what}: {text}", **names)
