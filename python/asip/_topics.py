# SPDX-License-Identifier: Apache-2.0
"""Names and topics of the bus. No other module builds a topic. The reference is docs/service-bus.md, "Topics"."""
from __future__ import annotations

import re

_NAME = re.compile(r"[A-Za-z0-9._-]{1,64}\Z")
_RESERVED = ("servicebus", "registry")


def valid_name(name: object) -> bool:
    """Whether a board or service can have this name."""
    return isinstance(name, str) and bool(_NAME.match(name)) and name not in (".", "..")


def valid_board(name: object) -> bool:
    return valid_name(name) and name not in _RESERVED


def user_level(user: str | None) -> str:
    """A user of the broker as one level of a topic: `$nobody` where there is none, or it cannot be a level."""
    if not user or any(ord(c) < 0x20 or ord(c) == 0x7F or c in "+#/" for c in user):
        return "$nobody"
    return user


class Topics:
    """All topics below one root, for one program. `client` is a name that no other program has."""

    def __init__(self, root: str, user: str | None, client: str):
        self.root = root
        self._reply = f"{root}/reply/{user_level(user)}"
        self._client = client
        self._demand = f"$demand/{user_level(user)}/{client}"
        self._link = f"$link/{user_level(user)}/{client}"

    def state(self, board: str) -> str:
        return f"{self.root}/servicebus/{board}/$state"

    def description(self, board: str) -> str:
        return f"{self.root}/servicebus/{board}/$description"

    def demand(self, board: str) -> str:
        return f"{self.root}/servicebus/{board}/{self._demand}"

    def lines_in(self, board: str) -> str:
        """For raw request lines, labels and the port."""
        return f"{self.root}/{board}/in"

    def command(self, board: str, service: str) -> str:
        return f"{self.root}/{board}/{service}/in"

    def link(self, board: str) -> str:
        return f"{self.root}/{board}/{self._link}"

    def stop(self, board: str) -> str:
        return f"{self.root}/{board}/$stop"

    def event(self, board: str, service: str) -> str:
        return f"{self.root}/{board}/{service}/out"

    def properties(self, board: str) -> str:
        return f"{self.root}/servicebus/{board}/$properties"

    def values(self, board: str) -> str:
        return f"{self.root}/{board}/$values"

    def question(self, board: str) -> str:
        """Asks an agent how its board stands. A level of its own: the demand of this program stays as it is."""
        return f"{self.demand(board)}-values"

    def query(self, registry: str = "") -> str:
        """To this registry; to whichever, where none is named."""
        return "/".join(filter(None, [self.root, "registry", registry, "query"]))

    def registries(self) -> str:
        return f"{self.root}/registry/+/$state"

    def reply(self, asked: str) -> str:
        """Where the answer of `asked` (a board, or `registry`) to this program comes."""
        return f"{self._reply}/{asked}/{self._client}"

    def replies(self) -> str:
        return self.reply("+")

    def own(self) -> str:
        """What this program sends to itself."""
        return self.reply("$self")

    def split(self, topic: str) -> list[str] | None:
        """The levels below the root; None for a topic that is not below it."""
        if not topic.startswith(self.root + "/"):
            return None
        return topic[len(self.root) + 1:].split("/")
