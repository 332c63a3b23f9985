# SPDX-License-Identifier: Apache-2.0
"""The boards that this program looks at: their state, why, and since when (docs/service-bus.md, "Presence"). Pure.

It says what `asip/catalogue` of the C++ programs says after the same messages: tests/vectors/presence.json binds both. The agent that holds a
board's name says its state, in its descriptions, and the broker says `lost` on `$state` on its behalf. This module adds one judgement
only: the lease is over. A renewed description changes no state.
"""
from __future__ import annotations

import re

from . import _model
from ._entry import NEVER, STATES, THERE, WORDS, Challenger, Entry, read_description
from ._topics import valid_board

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# `$state` is published with this expiry, in seconds: what is left of it says how old a retained one is.
_STATE_EXPIRY = 3_000_000_000
# Ages of stored messages are whole seconds, and messages take a while: what is less apart may be one moment.
_APART = 2.0
# After the broker was away, leases get this time to be renewed.
_GRACE = 10.0
_FORGET_AFTER = 7 * 86_400.0
_REASON_OF_WORD = {"lost": "agent-gone", "offline": "stopped", "updating": "released"}
_TIMED = r"[0-9a-f]{16}(-|\Z)"


def _is_older(session: str, than: str) -> bool:
    """Sessions of our agents begin with the time of their start; those of other programs have no order."""
    return bool(re.match(_TIMED, session) and re.match(_TIMED, than)) and session < than


class Catalogue:
    """Feed it messages and time; it says whether a board changed."""

    def __init__(self) -> None:
        self.boards: dict[str, Entry] = {}
        self.unheard_since: float | None = None  # the broker is not heard: no state is known, and no lease is judged
        self._epoch = 1

    def connected(self, now: float) -> None:
        self.unheard_since = None
        self._epoch += 1
        for entry in self.boards.values():
            if entry.effective in THERE:
                entry.deadline = max(entry.deadline, now + min(_GRACE, entry.lease))
            else:
                entry.kept_until = now + _GRACE

    def disconnected(self, now: float) -> None:
        if self.unheard_since is None:
            self.unheard_since = now

    def names(self) -> list[str]:
        return [name for name, entry in self.boards.items() if entry.state != "unknown"]

    def followed(self) -> list[str]:
        return [name for name in self.names() if not self.boards[name].listed]

    def _of(self, name: str, now: float) -> Entry:
        entry = self.boards.get(name)
        if entry is None or entry.listed:
            entry = self.boards[name] = Entry(name, now)
        return entry

    def _known(self, name: str) -> Entry | None:
        entry = self.boards.get(name)
        return None if entry is None or entry.listed else entry

    # Descriptions ---------------------------------------------------------------------------------------------------------

    def on_description(self, board: str, document: dict[str, Any] | None, retained: bool, expiry: int | None, now: float) -> bool:
        document = read_description(document, board)
        if document is None:
            return False
        added = self._known(board) is None
        entry = self._of(board, now)
        session, seq = document["session"], document["seq"]
        described, other = entry.described, entry.session != session
        published = now - max(0.0, document["lease"] - expiry) if expiry is not None else NEVER if retained else now
        verdict = self._judge(entry, document, retained, published, now)
        if verdict == "refuse":
            return False
        if verdict == "accept":
            if not described:  # that of a word ahead of it was a guess
                entry.deadline = entry.session_ends = NEVER
            entry.session, entry.seq, entry.description, entry.lease, entry.described = session, seq, document, float(document["lease"]), True
            self._take_said_state(entry, retained, published, other or not described, now)
            if not entry.says_state and not retained and described and other and entry.reported not in THERE:
                self._say(entry, "online", "", now, now)
        if published != NEVER or verdict == "accept":  # from when it was published: a bridge may deliver one late, or again
            ends = (now if published == NEVER else published) + entry.lease
            sets = not retained and verdict == "accept"  # a lease that became shorter, too
            entry.session_ends = ends if sets else max(entry.session_ends, ends)
            entry.deadline = ends if sets else max(entry.deadline, entry.session_ends)
        if not retained:
            entry.proven, entry.last_heard = True, max(entry.last_heard, published)
            if entry.says_state:
                entry.epoch_heard = self._epoch
        entry.hinted = False
        return self._update(entry, now, added) or verdict == "accept"

    def _judge(self, entry: Entry, document: dict[str, Any], retained: bool, published: float, now: float) -> str:
        if not entry.described:
            return "accept"
        if entry.session != document["session"]:
            return self._judge_other_session(entry, document, retained, published, now)
        if document["seq"] <= entry.seq:
            return "refuse" if document["seq"] < entry.seq else "renew"
        if not retained and entry.challenger is not None:
            if now >= entry.challenger.deadline:
                entry.challenger = None
            else:
                entry.challenger.answered = True
        return "accept"

    @staticmethod
    def _judge_other_session(entry: Entry, document: dict[str, Any], retained: bool, published: float, now: float) -> str:
        """A later session counts, whatever was before. An earlier one counts by what it says after the lease of the later one: the clock of its
        agent went back, and nothing on the bus told it of the later one."""
        session = document["session"]
        old = entry.old_sessions.get(session)
        if old is not None and document["seq"] <= old:
            return "refuse"
        earlier, later = _is_older(session, entry.session), _is_older(entry.session, session)
        too_early = earlier and published < entry.session_ends
        if too_early:  # for ever, however late a bridge delivers it again
            entry.remember(session, document["seq"])
        if too_early or not earlier and not later:
            holder_lives = entry.alive(now) and entry.proven
            if retained:
                if earlier or old is not None or holder_lives:
                    return "refuse"
            elif holder_lives:
                disputed = entry.conflict and entry.challenger is not None and now < entry.challenger.deadline
                if earlier or old is not None or disputed:
                    return "accept" if Catalogue._challenge(entry, document, now) else "refuse"
            elif earlier:
                return "refuse"
        Catalogue._take_over(entry, session)
        return "accept"

    @staticmethod
    def _challenge(entry: Entry, document: dict[str, Any], now: float) -> bool:
        """Another session lives beside the holder, or lived when its message was sent. Only one that comes after the holder has answered
        proves that both live; then the larger session holds the board."""
        session = document["session"]
        if session in entry.old_sessions:
            entry.old_sessions[session] = document["seq"]
        other = entry.challenger
        if other is None or other.session != session:
            other = entry.challenger = Challenger(session, other is not None and other.confirmed)
        other.confirmed = other.confirmed or other.answered
        other.seq, other.deadline = document["seq"], now + document["lease"]
        if not (other.confirmed and entry.session < session):
            return False
        Catalogue._take_over(entry, session)
        return True

    @staticmethod
    def _take_over(entry: Entry, session: str) -> None:
        """The old session is remembered, so that its old messages cannot come back."""
        entry.old_sessions.pop(session, None)
        entry.remember(entry.session, entry.seq)
        other = entry.challenger
        if other is not None and other.session == session:
            if other.confirmed:
                other.session, other.seq, other.deadline = entry.session, entry.seq, entry.deadline
            else:
                entry.challenger = None
        entry.session, entry.seq, entry.session_ends, entry.deadline, entry.proven, entry.epoch_heard = session, 0, NEVER, NEVER, False, 0

    def _take_said_state(self, entry: Entry, retained: bool, published: float, new_session: bool, now: float) -> None:
        """An agent publishes the state in its description before the same on `$state`: so a retained `$state` that says something else of a
        board that was there is newer, and the word of the broker, unless the description is the younger one. The board was there behind
        what was known of it, and is gone anew."""
        said = entry.description.get("state")
        entry.says_state = said is not None
        if said is None:
            return
        word = retained and entry.epoch_gone == self._epoch and entry.reported not in THERE and said["is"] != entry.reported
        if word and not published > entry.said_at + _APART > NEVER:
            entry.reported_since = NEVER
            self._say(entry, entry.reported, _REASON_OF_WORD.get(entry.reported, ""), entry.said_at, now)
            return
        said_at = entry.said_at = now if published == NEVER else published
        if new_session:  # it came into its state when it says, though the one before it had been in the same
            entry.reported_since = NEVER
        self._say(entry, said["is"], said.get("reason", ""), said_at - said.get("age", 0), now)

    @staticmethod
    def _say(entry: Entry, state: str, reason: str, since: float, now: float) -> None:
        """Messages that say the same again can only be later than the moment, so the earliest counts, unless the board left the state
        meanwhile and came into it again."""
        reason = reason if reason in WORDS else ""
        if entry.reported == state and entry.reported_reason == reason and entry.reported_since != NEVER:
            if since == NEVER:
                since = entry.reported_since
            if abs(since - entry.reported_since) < _APART:
                since = min(since, entry.reported_since)
        entry.reported, entry.reported_reason, entry.reported_since = state, reason, min(since, now)

    # `$state` -------------------------------------------------------------------------------------------------------------

    def on_state(self, board: str, payload: bytes, retained: bool, expiry: int | None, now: float) -> bool:
        if not valid_board(board):
            return False
        entry = self._known(board)
        if not payload:  # another program forgot this board: so does this one, unless it is known to be there
            return entry is not None and entry.effective not in THERE and self.boards.pop(board, None) is not None
        word = payload.decode("utf-8", "replace").rstrip("\r\n ")
        if word not in STATES:
            return False
        added = entry is None
        if entry is None:
            entry = self._of(board, now)
            entry.hinted = retained and word in THERE
        elif retained and entry.epoch_heard == self._epoch:
            return False
        there = word in THERE
        published = now - (_STATE_EXPIRY - expiry) if expiry is not None and expiry <= _STATE_EXPIRY else None
        # A bridge delivers what it has stored again: the agent has said more since then.
        if entry.says_state and not there and published is not None and published + _APART < entry.said_at:
            return False
        # The newer of two words counts, also where both say that it is not there: a will comes after a stop, too, and the description that
        # came with a stop may have come and gone while nothing was heard.
        gone_otherwise = not there and entry.reported not in THERE and word != entry.reported and (not retained or published is not None)
        # It was there again behind all that is known of it.
        was_back = (there and retained and published is not None and entry.effective not in THERE
                    and published > max(entry.said_at, entry.since))
        again = retained and published is not None and published <= entry.said_at + _APART and word == entry.reported
        if not entry.says_state and not again or not there and entry.reported in THERE or gone_otherwise or was_back:
            since = now if not retained and (added or word != entry.reported) else NEVER
            if retained and published is not None:
                since = published
            self._say(entry, word, _REASON_OF_WORD.get(word, ""), since, now)
        if there and published is not None and entry.described and not entry.says_state:
            entry.deadline = max(entry.deadline, published + entry.lease)
        if retained and not entry.described:  # no description told a lease: behind an interruption the board has to be heard again
            entry.deadline = min(entry.deadline, now + _GRACE)
        # The broker has forgotten the description that said so: when the lease ended is not known.
        if was_back and (entry.says_state or not entry.described or entry.deadline <= now):
            entry.deadline = entry.since = NEVER
        if not there and entry.reported == word:
            entry.epoch_gone = self._epoch
        # Beside descriptions that hold the state, a word that the board is there says nothing: the description that came with it may
        # never be heard.
        if not there or not entry.says_state:
            entry.said_at = max(entry.said_at, published if published is not None else NEVER if retained else now)
        if not retained and not entry.says_state and there:
            entry.deadline, entry.last_heard = now + entry.lease, now
        if not retained:
            entry.epoch_heard = self._epoch
        entry.hinted = entry.hinted and retained and there
        return self._update(entry, now, added) or added

    # Leases ---------------------------------------------------------------------------------------------------------------

    @staticmethod
    def _lease_ended(entry: Entry) -> float:
        """What the grace after an interruption added is no time in which the board was there. Words beside descriptions without a state open
        a lease, too."""
        renewed = NEVER if entry.says_state else max(entry.last_heard, entry.said_at) + entry.lease
        return min(entry.deadline, max(entry.session_ends, renewed))

    @staticmethod
    def _update(entry: Entry, now: float, added: bool = False) -> bool:
        """Brings the effective state into line with what was reported and the lease; whether it changed."""
        state = entry.reported if entry.alive(now) or entry.reported not in THERE else "lost"
        judged = state != entry.reported  # by its lease
        was, entry.effective = entry.effective, state
        entry.kept_until = NEVER
        changed = was != state or added
        if changed:
            unknown = judged and (added or entry.deadline == NEVER) or not judged and state not in THERE and entry.reported_since == NEVER
            entry.since = NEVER if unknown else Catalogue._lease_ended(entry) if judged else now
        if not judged and entry.reported_since != NEVER and (entry.says_state or state not in THERE):
            entry.since = entry.reported_since
        entry.judged_reason = "expired" if judged else entry.reported_reason
        if was != state and entry.conflict and not entry.alive(now):
            entry.challenger = None
        return changed

    def expire(self, now: float) -> list[str]:
        """Boards that were lost, or forgotten, since the last call, because their lease ran out."""
        if self.unheard_since is not None:
            return []
        changed = []
        for entry in [*self.boards.values()]:
            if entry.listed:
                continue
            if entry.effective in THERE and now >= entry.deadline and self._update(entry, now):
                changed.append(entry.name)
            gone = entry.first_seen if entry.since == NEVER else entry.since
            if entry.effective not in THERE and now >= max(max(gone, entry.last_heard) + _FORGET_AFTER, entry.kept_until):
                del self.boards[entry.name]
                changed.append(entry.name)
        return changed

    def next_expiry(self) -> float | None:
        return min((entry.deadline for entry in self.boards.values() if entry.effective in THERE and not entry.listed), default=None)

    # Boards that this program does not follow -----------------------------------------------------------------------------

    def on_listed(self, item: dict[str, Any], now: float) -> None:
        """A board as a registry lists it; what this program hears itself counts more."""
        name, services = item.get("board"), item.get("services", [])
        if not isinstance(name, str) or not valid_board(name) or item.get("state") not in STATES or self._known(name) is not None:
            return
        entry = self.boards[name] = Entry(name, now)
        entry.listed = True
        entry.effective, entry.judged_reason = item["state"], item["reason"] if item.get("reason") in [*WORDS] else ""
        age = item.get("state_age", -1)
        entry.since = now - age if isinstance(age, (int, float)) and 0 <= age <= 1e9 else NEVER
        document = read_description(item.get("description"), name) or read_description(
            {"board": name, "session": "-", "seq": 0, "services": services, "labels": item.get("labels", {})}, name)
        if document is not None:
            entry.description, entry.session, entry.seq = document, document["session"], document["seq"]

    def look_away(self, followed: Any) -> None:
        """Boards that are not followed any more keep their state: nothing is heard that would renew a lease."""
        for name, entry in self.boards.items():
            entry.listed = entry.listed or not followed(name)

    def unknown(self, board: str) -> str:
        """A sentence for a board that does not show itself, with the nearest name."""
        names = self.names()
        return f'there is no board "{board}"' + (_model.near(board, names, '"') or (f"; there are {', '.join(sorted(names)[:8])}" if names else ""))
