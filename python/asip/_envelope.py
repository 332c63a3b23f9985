# SPDX-License-Identifier: Apache-2.0
"""Requests and answers as JSON text (docs/service-bus.md, "Request and answer"). Pure.

Everything that belongs to a request stands in its JSON, none of it in properties of MQTT 5: a bridge between two brokers that
speaks MQTT 3.1.1 drops those.
"""
from __future__ import annotations

import json
import math
import re

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_decode = json.JSONDecoder().decode
_MAX_DEPTH = 32
# Numbers that may be none, or beyond what a double holds, and halves of characters: such a text is read with care.
_ODD = re.compile(rb"NaN|Infinity|[0-9]{19}|[0-9.][eE]\+?[0-9]{3}|\\u[dD][89a-fA-F]")
MAX_REQUEST_BYTES = 16_384
MAX_ANSWER_BYTES = 1 << 20


def request_text(members: dict[str, Any], *, reply_to: str, id: str, timeout: float | None = None, clock: str | None = None,
                 by: str | None = None, hold: float | None = None) -> bytes:
    """The payload of a request. `timeout` and `hold` are in seconds, limited to what agents take (0.05 to 60). `clock`: the
    agent's clock now, empty to ask for it; None: the request is no command."""
    more: dict[str, Any] = {"deadline_ms": milliseconds(timeout), "hold_ms": milliseconds(hold), "clock": clock, "by": by}
    whole = {**members, "reply_to": reply_to, "id": id, **{name: value for name, value in more.items() if value is not None}}
    return json.dumps(whole, separators=(",", ":"), ensure_ascii=False).encode()


def milliseconds(seconds: float | None) -> int | None:
    return None if seconds is None else min(60_000, max(50, round(seconds * 1000)))


def read_object(payload: bytes, limit: int = MAX_ANSWER_BYTES) -> dict[str, Any] | None:
    """A JSON object, or None for anything else: other programs may publish anything."""
    if len(payload) > limit:
        return None
    try:
        text = payload.decode()
        value = _careful(text) if _ODD.search(payload) else _decode(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(value, dict) or payload.count(b"[") + payload.count(b"{") > _MAX_DEPTH and not _is_flat(value):
        return None
    return value


def _careful(text: str) -> Any:
    """Refuses what is no number and no text; whole numbers of many digits become doubles, as elsewhere."""
    value = json.loads(text, parse_constant=_finite, parse_float=_finite, parse_int=lambda digits: int(digits) if len(digits) < 20 else _finite(digits))
    json.dumps(value, ensure_ascii=False).encode()
    return value


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number


def _is_flat(value: Any) -> bool:
    """Whether it nests at most _MAX_DEPTH deep."""
    level = [value]
    for _ in range(_MAX_DEPTH):
        level = [inner for one in level for inner in (one.values() if isinstance(one, dict) else one) if isinstance(inner, (dict, list))]
        if not level:
            return True
    return False


def demand_text(services: dict[str, float], lease: int) -> bytes:
    """`services`: values a second by service; empty ends the demand. `lease`: seconds."""
    return json.dumps({"services": services, "lease": lease}, separators=(",", ":")).encode()
