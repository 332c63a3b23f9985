# SPDX-License-Identifier: Apache-2.0
"""The boards that this program looks at: their state, why, and since when (docs/guarantees.md, "Presence"). Pure.

The agent that holds a board's name says its state, in the description and on `$state`; the broker says `lost` on its behalf.
This module adds one judgement only: the lease is over. A renewed description changes no state.
"""
from __future__ import annotations

from typing import Any

from . import _description, _model
from ._description import STATES
from ._topics import valid_board

THERE = ("online", "sleeping", "updating")
# Agents publish `$state` with this expiry, in seconds: what is left of it says how old a retained one is.
_STATE_EXPIRY = 3_000_000_000
# Of two messages whose ages are whole seconds, the one that is this much older was published first.
_APART = 2.0
# After the broker was away, leases get this time to be renewed.
_GRACE = 10.0
_WORDS = {"latched": "STOPPED until it is resumed", "unplugged": "cable unplugged", "silent": "the board does not answer", "agent-gone": "its agent ended or lost the broker",
          "expired": "nothing renewed its lease", "released": "another program has its port", "stopped": "its agent was stopped",
          "conflict": "two agents claim its name"}
_REASON_OF_WORD = {"lost": "agent-gone", "offline": "stopped", "updating": "released"}


class Entry:
    """What is known of one board. Times are of the monotonic clock."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.state = self.said = "unknown"
        self.reason = ""
        self.since: float | None = None
        self.session = ""
        self.seq = -1
        self.lease = float(_description.DEFAULT_LEASE)
        self.deadline: float | None = None
        self.description: dict[str, Any] = {}
        self.says_state = False
        self.described_at: float | None = None  # when its description was published
        self.gone_at: float | None = None  # when `$state` said over this connection that it is not there

    def words(self, now: float) -> str:
        """`lost 3 min ago: cable unplugged`"""
        ago = "" if self.since is None or now - self.since < 1 else f" {_duration(now - self.since)} ago"
        why = _WORDS.get(self.reason, self.reason)
        return f"{self.state}{ago}" + (f": {why}" if why and self.state != "online" else "")


def _duration(seconds: float) -> str:
    for size, unit in ((86400, "d"), (3600, "h"), (60, "min")):
        if seconds >= size:
            return f"{int(seconds // size)} {unit}"
    return f"{int(seconds)} s"


class Catalogue:
    """Feed it messages and time; it returns the names of boards whose state or description changed."""

    def __init__(self) -> None:
        self.boards: dict[str, Entry] = {}
        self.unheard_since: float | None = None  # the broker is not heard: no state is known, and no lease is judged

    def connected(self, now: float) -> None:
        self.unheard_since = None
        for entry in self.boards.values():
            entry.gone_at = None
            if entry.deadline is not None and entry.state in THERE:
                entry.deadline = max(entry.deadline, now + min(_GRACE, entry.lease))

    def disconnected(self, now: float) -> None:
        if self.unheard_since is None:
            self.unheard_since = now

    def names(self) -> list[str]:
        return [name for name, entry in self.boards.items() if entry.state != "unknown"]

    def on_state(self, board: str, payload: bytes, retained: bool, expiry: int | None, now: float) -> bool:
        if not valid_board(board):
            return False
        word = payload.decode("utf-8", "replace").rstrip("\r\n ")
        if not word:
            return self.boards.pop(board, None) is not None
        if word not in STATES:
            return False
        entry = self.boards.setdefault(board, Entry(board))
        there = word in THERE
        published = now - (_STATE_EXPIRY - expiry) if expiry is not None and expiry <= _STATE_EXPIRY else None
        if entry.says_state and not there and published is not None and entry.described_at is not None \
                and published + _APART < entry.described_at:
            return False  # stored before what the agent has said since
        if not there:
            entry.gone_at = now if published is None else published
        if entry.says_state and (there or entry.said not in THERE):
            return False  # the description says it, with the reason; only the broker's word for a board that was there is news
        since = now if not retained and word != entry.said else entry.since
        if retained and published is not None:
            since = published
        entry.said, entry.reason, entry.since = word, _REASON_OF_WORD.get(word, ""), since
        if there and not retained:
            entry.deadline = now + entry.lease
        return self._judge(entry, now)

    def on_description(self, board: str, document: dict[str, Any] | None, retained: bool, expiry: int | None, now: float) -> bool:
        document = _description.read(document, board)
        if document is None:
            return False
        session, seq = document["session"], document["seq"]
        entry = self.boards.setdefault(board, Entry(board))
        if entry.session == session and seq < entry.seq or entry.session > session and retained:
            return False
        news = entry.session != session or seq > entry.seq
        entry.lease = float(document["lease"])
        left = entry.lease if not retained or expiry is None else min(float(expiry), entry.lease)
        entry.deadline = now + left
        if news:
            entry.session, entry.seq, entry.description = session, seq, document
            self._take_state(entry, document.get("state"), retained, now - (entry.lease - left), now)
        return self._judge(entry, now) or news

    @staticmethod
    def _take_state(entry: Entry, said: Any, retained: bool, published: float, now: float) -> None:
        entry.says_state = said is not None
        if not entry.says_state:
            if entry.said == "unknown":
                entry.said = "online"
            return
        entry.described_at = published
        if retained and said["is"] in THERE and entry.said not in (*THERE, "unknown") and entry.gone_at is not None \
                and published <= entry.gone_at + _APART:
            return  # the broker's word for an agent that is gone came behind the description that is stored
        since = published - float(said.get("age", 0))
        if entry.said != said["is"] or entry.since is None or abs(entry.since - since) > 5:
            entry.since = since
        entry.said, entry.reason = said["is"], said.get("reason", "")

    def on_listed(self, item: dict[str, Any], now: float) -> None:
        """A board as a registry lists it."""
        name, services = item.get("board"), item.get("services", [])
        if not isinstance(name, str) or not valid_board(name) or item.get("state") not in STATES or not isinstance(services, list):
            return
        entry = self.boards.setdefault(name, Entry(name))
        document = _description.read(item.get("description"), name)
        if document is not None and (entry.session != document["session"] or entry.seq <= document["seq"]):
            self.on_description(name, document, True, None, now)
        entry.state = entry.said = item["state"]
        entry.reason = str(item.get("reason", ""))
        if not entry.description:
            plain = {"board": name, "session": "-", "seq": 0, "services": services, "labels": item.get("labels", {})}
            entry.description = _description.read(plain, name) or {}

    def expire(self, now: float) -> list[str]:
        """Boards whose lease is over since the last call."""
        if self.unheard_since is not None:
            return []
        return [entry.name for entry in self.boards.values() if entry.deadline is not None and self._judge(entry, now)]

    def next_expiry(self) -> float | None:
        return min((entry.deadline for entry in self.boards.values() if entry.deadline is not None and entry.state in THERE), default=None)

    def _judge(self, entry: Entry, now: float) -> bool:
        state, reason = entry.said, entry.reason
        if state in THERE and entry.deadline is not None and now >= entry.deadline:
            state, reason = "lost", "expired"
            entry.said, entry.reason, entry.since = state, reason, entry.deadline
            entry.says_state = False
        changed = state != entry.state
        entry.state = state
        return changed

    def unknown(self, board: str) -> str:
        """A sentence for a board that does not show itself, with the nearest name."""
        names = self.names()
        return f'there is no board "{board}"' + (_model.near(board, names, '"') or (f"; there are {', '.join(sorted(names)[:8])}" if names else ""))
