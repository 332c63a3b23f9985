# SPDX-License-Identifier: Apache-2.0
"""What is known of one board, and its words for people. Pure."""
from __future__ import annotations

from . import _description

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

THERE = ("online", "sleeping", "updating")
NEVER = float("-inf")
_MAX_OLD_SESSIONS = 8
WORDS = {"unplugged": "cable unplugged", "silent": "the board answers nothing", "agent-gone": "its agent died or lost the broker",
         "expired": "its agent fell silent and the lease ran out", "released": "its port is in other hands", "stopped": "its agent was stopped",
         "conflict": "two agents claim its name", "latched": "STOPPED until it is resumed"}


class Entry:
    """What is known of one board. Times are of the monotonic clock."""

    def __init__(self, name: str, now: float) -> None:
        self.name = name
        self.reported, self.reported_reason, self.reported_since = "online", "", NEVER
        self.effective, self.judged_reason, self.since = "lost", "", now
        self.session, self.seq, self.lease = "", -1, float(_description.DEFAULT_LEASE)
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
