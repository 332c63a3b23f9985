# SPDX-License-Identifier: Apache-2.0
"""What a program knows of the clocks of the agents that it commands (docs/guarantees.md, "The life of a command", 12). Pure.

An agent answers with a reading of its clock, `1f3c09aa-123456`: which start of which agent, and milliseconds. The reading was
taken between the question and the answer, so each answer bounds how far that clock is ahead of ours. A command says when it was
sent by that clock, so that no agent executes it late, however long brokers held it.
"""
from __future__ import annotations

MAX_CLOCKS = 16_384


def split_reading(text: object) -> tuple[str, int] | None:
    """`1f3c09aa-123456` -> ("1f3c09aa", 123456); None for anything else."""
    if not isinstance(text, str) or len(text) > 64:
        return None
    start, dash, count = text.partition("-")
    if not dash or not start or not count.isascii() or not count.isdigit():
        return None
    return start, int(count)


class Clocks:
    """Times are in seconds of this program's monotonic clock."""

    def __init__(self) -> None:
        self._ahead: dict[str, tuple[str, float]] = {}

    def note(self, board: str, reading: object, asked: float, answered: float) -> None:
        """`reading` came with an answer to a question of `asked`, at `answered`. What is no reading is ignored."""
        read = split_reading(reading)
        if read is None:
            return
        start, milliseconds = read
        most = (milliseconds + 1) / 1000 - asked
        least = milliseconds / 1000 - answered
        known = self._ahead.get(board)
        if known is None or known[0] != start or known[1] < least or most < known[1]:
            if known is None and len(self._ahead) >= MAX_CLOCKS:
                self._ahead.clear()
            self._ahead[board] = (start, most)

    def reading(self, board: str, now: float) -> str:
        """What the board's agent's clock shows at `now`: never less than it does. Empty: not known yet."""
        known = self._ahead.get(board)
        if known is None:
            return ""
        return f"{known[0]}-{max(0, int((now + known[1]) * 1000))}"
