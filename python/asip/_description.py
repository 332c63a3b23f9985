# SPDX-License-Identifier: Apache-2.0
"""What a `$description` must be before anything is believed of it: anybody may publish anything. Pure.

The bounds are those of asip/catalogue and asip/model: a document that these refuse is refused here.
"""
from __future__ import annotations

import re

from ._topics import valid_board, valid_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

STATES = ("online", "sleeping", "updating", "offline", "lost")
DEFAULT_LEASE = 60
_MAX_LEASE = 86_400
_MAX_AGE = 1e9
_MAX_SERVICES = 64
_MAX_TEXT = 256
_PINS = {*map(str, range(256))}
_LABEL = r"[A-Za-z0-9]([A-Za-z0-9._-]{0,61}[A-Za-z0-9])?\Z"


def read(document: Any, board: str) -> dict[str, Any] | None:
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
