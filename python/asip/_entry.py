# SPDX-License-Identifier: Apache-2.0
"""What is known of one board, and its words for people; and what a `$description` must be before anything is believed of it, since anybody
may publish anything: its bounds are those of asip/catalogue and asip/model, and a document that these refuse is refused here. Pure.
"""
from __future__ import annotations

import re

from ._topics import valid_board, valid_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

THERE = ("online", "sleeping", "updating")
NEVER = float("-inf")
_MAX_OLD_SESSIONS = 8
STATES = ("online", "sleeping", "updating", "offline", "lost")
DEFAULT_LEASE = 60
_MAX_LEASE = 86_400
_MAX_AGE = 1e9
_MAX_SERVICES = 64
_MAX_TEXT = 256
_PINS = {*map(str, range(256))}
_LABEL = r"[A-Za-z0-9]([A-Za-z0-9._-]{0,61}[A-Za-z0-9])?\Z"
WORDS = {"unplugged": "cable unplugged", "silent": "the board answers nothing", "agent-gone": "its agent died or lost the broker",
         "expired": "its agent fell silent and the lease ran out", "released": "its port is in other hands", "stopped": "its agent was stopped",
         "conflict": "two agents claim its name", "latched": "STOPPED until it is resumed"}


class Entry:
    """What is known of one board. Times are of the monotonic clock."""

    def __init__(self, name: str, now: float) -> None:
        self.name = name
        self.reported, self.reported_reason, self.reported_since = "online", "", NEVER
        self.effective, self.judged_reason, self.since = "lost", "", now
        self.session, self.seq, self.lease = "", -1, float(DEFAULT_LEASE)
        self.description: dict[str, Any] = {}
        self.described = self.says_state = False  # its descriptions hold the state: they alone make it be there
        self.said_at = NEVER  # when its state was said last, as far as can be known
        self.proven = False         # its session was heard live, not only retained
        self.deadline = self.first_seen = now
        self.last_heard = NEVER
        self.session_ends = NEVER  # the lease of its session's descriptions, without grace
        self.epoch_heard = self.epoch_gone = 0
        self.kept_until = NEVER
        self.old_sessions: dict[str, int] = {}  # the newest last, with the highest seq seen
        self.challenger: Challenger | None = None
        self.listed = False  # as a registry listed it, or as it was when this program looked last
        self.hinted = False  # only a retained word says that it is there

    def remember(self, session: str, seq: int) -> None:
        self.old_sessions[session] = max(seq, self.old_sessions.get(session, seq))
        if len(self.old_sessions) > _MAX_OLD_SESSIONS:
            del self.old_sessions[next(iter(self.old_sessions))]

    @property
    def state(self) -> str:
        """`unknown` until something says more than that it was there once."""
        return "unknown" if self.hinted else self.effective

    @property
    def reason(self) -> str:
        """A word of docs/service-bus.md, "Presence", or empty."""
        return "conflict" if self.conflict and not self.judged_reason else self.judged_reason

    def words(self, now: float) -> str:
        """`lost 3 min ago: cable unplugged`"""
        ago = "" if now - self.since < 1 or self.since == NEVER else f" {_duration(now - self.since)} ago"
        why = WORDS.get(self.reason, "")
        return f"{self.state}{ago}" + (f": {why}" if why and self.state != "online" else "")

    def alive(self, now: float) -> bool:
        return self.reported in THERE and now < self.deadline

    @property
    def conflict(self) -> bool:
        return self.challenger is not None and self.challenger.confirmed


class Challenger:
    """A session that claims a board beside its holder."""

    def __init__(self, session: str, known: bool) -> None:
        self.session, self.seq, self.deadline = session, 0, 0.0
        self.answered = self.confirmed = known  # the holder announced itself after it; and it announced itself again


def _duration(seconds: float) -> str:
    for size, unit in ((86400, "d"), (3600, "h"), (60, "min")):
        if seconds >= size:
            return f"{int(seconds // size)} {unit}"
    return f"{int(seconds)} s"


def read_description(document: Any, board: str) -> dict[str, Any] | None:
    """The document with `lease` as it counts; None where it is no description of this board."""
    if not isinstance(document, dict) or document.get("board") != board or not valid_board(board):
        return None
    session, lease = document.get("session"), document.get("lease", 0)
    if not isinstance(session, str) or not 0 < len(session) <= 64 or not whole(document.get("seq")) or not whole(lease):
        return None
    if not all(isinstance(document.get(name, {}), dict) for name in ("firmware", "link", "agent", "pins", "on_demand", "stopped")):
        return None
    if not _are_services(document.get("services")) or not _are_labels(document) or "state" in document and not _is_state(document["state"]):
        return None
    return {**document, "lease": min(lease, _MAX_LEASE) or DEFAULT_LEASE}


def whole(value: Any, most: int = 10**19 - 1) -> bool:
    return type(value) is int and 0 <= value <= most


def _are_services(services: Any) -> bool:
    if not isinstance(services, list) or len(services) > _MAX_SERVICES or not all(isinstance(one, dict) for one in services):
        return False
    names = [one.get("name") for one in services]
    return all(valid_name(name) for name in names) and len({*names}) == len(names) and all(map(_is_service, services))


def _is_service(one: dict[str, Any]) -> bool:
    model, title, letter = one.get("model", {}), one.get("title", ""), one.get("id", "-")
    return (isinstance(model, dict) or isinstance(model, str) and len(model) <= _MAX_TEXT) and isinstance(title, str) and len(title) <= _MAX_TEXT \
        and isinstance(letter, str) and len(letter) == 1 and all(whole(one.get(name, 0), 2**31 - 1) for name in ("count", "period"))


def _are_labels(document: dict[str, Any]) -> bool:
    names = document.get("names", {})
    return isinstance(names, dict) and _texts(document.get("labels", {}), 32, lambda key: re.match(_LABEL, key)) \
        and _texts(names.get("services", {}), 64, valid_name) \
        and _texts(names.get("pins", {}), 64, lambda key: key in _PINS)


def _texts(value: Any, most: int, is_key: Any) -> bool:
    return isinstance(value, dict) and len(value) <= most and all(isinstance(one, str) and len(one.encode("utf-8", "replace")) <= 63 for one in value.values()) \
        and all(map(is_key, value))


def _is_state(state: Any) -> bool:
    if not isinstance(state, dict) or not isinstance(state.get("reason", ""), str):
        return False
    age = state.get("age", 0)
    return state.get("is") in STATES and type(age) in (int, float) and 0 <= age <= _MAX_AGE
