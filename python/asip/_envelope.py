# SPDX-License-Identifier: Apache-2.0
"""Requests and answers as JSON text (docs/service-bus.md, "Request and answer"). Pure.

Everything that belongs to a request stands in its JSON, none of it in properties of MQTT 5: a bridge between two brokers that
speaks MQTT 3.1.1 drops those.
"""
from __future__ import annotations

import json
from typing import Any

_decode = json.JSONDecoder().decode
MAX_REQUEST_BYTES = 16_384
MAX_ANSWER_BYTES = 1 << 20


def request_text(members: dict[str, Any], *, reply_to: str, id: str, timeout: float | None = None, clock: str | None = None,
                 by: str | None = None, hold: float | None = None) -> bytes:
    """The payload of a request. `timeout` and `hold` are in seconds, limited to what agents take (0.05 to 60). `clock`: the
    agent's clock now, empty to ask for it; None: the request is no command."""
    whole = dict(members)
    whole["reply_to"] = reply_to
    whole["id"] = id
    if timeout is not None:
        whole["deadline_ms"] = milliseconds(timeout)
    if hold is not None:
        whole["hold_ms"] = milliseconds(hold)
    if clock is not None:
        whole["clock"] = clock
    if by is not None:
        whole["by"] = by
    return json.dumps(whole, separators=(",", ":"), ensure_ascii=False).encode()


def milliseconds(seconds: float) -> int:
    return min(60_000, max(50, round(seconds * 1000)))


def read_object(payload: bytes, limit: int = MAX_ANSWER_BYTES) -> dict[str, Any] | None:
    """A JSON object, or None for anything else: other programs may publish anything."""
    if len(payload) > limit:
        return None
    try:
        value = _decode(payload.decode())
    except (ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None


def demand_text(services: dict[str, float], lease: int) -> bytes:
    """`services`: values a second by service; empty ends the demand. `lease`: seconds."""
    return json.dumps({"services": services, "lease": lease}, separators=(",", ":")).encode()
