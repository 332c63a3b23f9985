# SPDX-License-Identifier: Apache-2.0
"""Which broker is tried next, when, and with which version of MQTT: 5, or 3.1.1 where the broker knows no other. Pure;
tests/vectors/mqtt_version.json binds the version to the C++ client.

An attempt fails by `version` (the broker says so), `closed` (it closes the connection before it answers), `silent` (it answers nothing),
or by anything else. A broker that is just going down closes connections, too, so two of them count; one that hangs is silent, so one that
took MQTT 5 before is not suspected. Where 3.1.1 fails in the same way the version was not the reason.
"""
from __future__ import annotations

from .settings import Broker

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Sequence

_CLOSED_UNTIL_311 = 2
_SILENT_UNTIL_311 = 1


class VersionChoice:
    """Which version of MQTT one broker is met with."""

    def __init__(self) -> None:
        self._refused = self._took = False
        self._closed = self._silent = 0  # in a row, with MQTT 5

    @property
    def v5(self) -> bool:
        return not self._refused and self._closed < _CLOSED_UNTIL_311 and self._silent < _SILENT_UNTIL_311

    @property
    def suspected(self) -> bool:
        """Whether the same broker is to be tried again, before the next one of the list."""
        return self._closed > 0

    def accepted(self) -> None:
        self._took = self.v5
        self._closed = self._silent = 0

    def failed(self, how: str, tried_v5: bool) -> None:
        self._refused = self._refused or how == "version"
        self._closed = self._closed + 1 if how == "closed" and tried_v5 else 0
        self._silent = self._silent + 1 if how == "silent" and tried_v5 and not self._took else 0


class Brokers:
    """The list of a program."""

    MAX_BACKOFF: float = 5.0

    def __init__(self, brokers: Sequence[Broker]) -> None:
        self._brokers = [(broker, VersionChoice()) for broker in brokers]
        self._at = self._failures = 0
        self._accepted = False

    @property
    def current(self) -> Broker:
        return self._brokers[self._at][0]

    @property
    def v5(self) -> bool:
        return self._brokers[self._at][1].v5

    def accepted(self) -> None:
        self._accepted = True
        self._brokers[self._at][1].accepted()

    def served(self) -> None:
        """What was accepted is of use, too."""
        self._failures = 0

    def ended(self, how: str, tried_v5: bool, random: float) -> float:
        """An attempt, or a connection that was accepted, has ended: seconds until the next attempt. `random`: from 0 to 1."""
        choice = self._brokers[self._at][1]
        attempt, self._accepted = not self._accepted, False
        if attempt:
            choice.failed(how, tried_v5)
            if how == "version" and tried_v5:
                return 0.0
        if not choice.suspected:
            self._at = (self._at + 1) % len(self._brokers)
        self._failures += 1
        if self._failures < len(self._brokers):
            return 0.0
        return min(self.MAX_BACKOFF, 0.2 * 2.0 ** min(self._failures // len(self._brokers), 6)) * (0.5 + random / 2)
