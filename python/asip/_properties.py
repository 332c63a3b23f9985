# SPDX-License-Identifier: Apache-2.0
"""What can be read and set on a board, and how it stands, as its agent tells it (docs/service-bus.md, "Properties and their values").
Pure. tests/vectors/properties.json binds it to the C++ programs, which make the list."""
from __future__ import annotations

import math

from ._entry import whole
from ._topics import valid_board, valid_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

VERSION = 1
UNKNOWN = {"never": "nothing was reported or set yet", "restart": "nothing was reported or set since the board came back",
           "doubt": "a command may or may not have been executed"}
EVENTS = ("press", "release", "hold", "double")  # what is done with a button
_KINDS = ("sensor", "binary", "switch", "number", "light", "button", "text", "select")
_TYPES = {"binary": "boolean", "switch": "boolean", "light": "light", "button": "action", "text": "text", "select": "choice"}
_BLANKS = str.maketrans("/-_.", "    ")
_MAX_PROPERTIES = 256
_MAX_BYTES = 256  # of a text
_MAX_EVENTS = 64
_TWO_WORDS = {"button": ("pressed", "released"), "door": ("open", "closed"), "window": ("open", "closed"), "moisture": ("wet", "dry"),
              **dict.fromkeys(("motion", "occupancy", "smoke", "vibration"), ("detected", "clear"))}
_FULL = 255  # brightness


class Told:
    """A property as the list tells it; ValueError where it is damaged."""

    def __init__(self, one: Any):
        _need(isinstance(one, dict), "property")
        one = {**_usual(one), **one}
        self.id, self.name, self.service, self.kind, self.type = (_text(one, name) for name in ("id", "name", "service", "kind", "type"))
        self.access, self.unit, self.quantity, self.read = (_text(one, name) for name in ("access", "unit", "quantity", "read"))
        self.refused = _text(one, "refused")  # why it cannot be set now; empty: it can, where something sets it
        _need(f"{self.id}/".startswith(f"{self.service}/") and valid_name(self.service) and self.kind in _KINDS, "id, service or kind")
        _need(all(_is_number(one[name]) for name in ("min", "max", "step", "none") if name in one), "min, max, step or none")
        self.min, self.max, self.step = one.get("min"), one.get("max"), one.get("step")
        self.is_whole = self.type == "integer"
        self.floating = one.get("floating") is True  # nothing holds the level of such a pin
        self.max_length, choices, self.meaning = one.get("max_length", 0), one.get("choices", []), one.get("meaning", {})
        _need(whole(self.max_length, _MAX_BYTES) and (self.max_length > 0 or self.kind != "text"), "max_length")
        _need(isinstance(choices, list) and len(choices) <= 64 and all(
            isinstance(pair, list) and len(pair) == 2 and isinstance(pair[0], str) and _is_number(pair[1]) for pair in choices), "choices")
        self.choices: dict[str, float] = dict(choices)
        _need({*self.choices} == {"on", "off"} if self.kind in ("switch", "binary") or self.kind == "light" and choices else True, "choices")
        _need(isinstance(self.meaning, dict) and isinstance(self.meaning.get("class", ""), str), "meaning")
        # A command and its arguments, None for the value.
        self.calls = {name: _call(one[name]) for name in ("before", "write", "color") if name in one}
        _need(self.read.startswith("/") if self.read else "write" in self.calls or "color" in self.calls, "read")

    @property
    def is_button(self) -> bool:
        """Whether it has events."""
        return self.kind == "binary" and self.meaning.get("class") == "button"

    def words(self, value: Any) -> str:
        """A value for people: `open`, `42 cm`."""
        if value is None:
            return "none"
        if isinstance(value, bool):
            return _TWO_WORDS.get(self.meaning.get("class", ""), ("on", "off"))[not value]
        if isinstance(value, dict):
            return _light_words(value)
        text = value if isinstance(value, str) else f"{value}"
        return text if isinstance(value, str) or not self.unit else f"{text}{'' if self.unit == '%' else ' '}{self.unit}"

    def requests(self, value: Any) -> list[tuple[str, dict[str, Any]]]:
        """What sets it to a value, in order: service and command. Empty: it has no such value, or cannot be set."""
        if self.kind == "light":
            made = self._light(value)
        elif "write" not in self.calls or self.kind != "button" and (value := self.wire(value)) is None:
            made = []
        else:
            made = [self._request("write", value)]
        return [self._request("before", None), *made] if made and "before" in self.calls else made

    def wire(self, value: Any) -> Any:
        """What stands for a value on the wire to the board; None: it has no such value."""
        if self.kind == "text":
            return value if isinstance(value, str) and len(value.encode("utf-8", "replace")) <= self.max_length else None
        if self.kind in ("number", "sensor") and not self.choices:
            good = _is_number(value) and self._within(value) and (not self.is_whole or value == math.floor(value))
            return (int(value) if value == math.floor(value) else value) if good else None
        if self.kind == "light" and isinstance(value, dict) and type(value.get("on")) is bool:
            if self.choices:
                return self.choices["on" if value["on"] else "off"]
            brightness = value.get("brightness", _FULL) if value["on"] else 0
            if not _is_number(brightness) or not 0 <= brightness <= _FULL:
                return None
            level = brightness * (_FULL if self.max is None else self.max) / _FULL
            if not math.isfinite(level):
                return None
            return max(1, math.floor(level + 0.5)) if brightness > 0 else 0  # what is on stays on
        if type(value) is bool and self.kind in ("switch", "binary"):
            return self.choices["on" if value else "off"]
        return self.choices.get(value) if isinstance(value, str) and self.kind in ("select", "sensor") else None

    def _within(self, value: float) -> bool:
        return math.isfinite(value) and (self.min is None or value >= self.min) and (self.max is None or value <= self.max)

    def _request(self, name: str, value: Any) -> tuple[str, dict[str, Any]]:
        command, args = self.calls[name]
        return self.service, {command: [value if one is None else one for one in args]}

    def _light(self, value: Any) -> list[tuple[str, dict[str, Any]]]:
        if not isinstance(value, dict) or type(value.get("on")) is not bool or any(
                name in value and not (_is_number(value[name]) and 0 <= value[name] <= most) for name, most in (("brightness", _FULL), ("color", 0xFFFFFF))):
            return []
        on, made = value["on"], []
        dims = "write" in self.calls
        if "color" in self.calls and (not on or "color" in value or not dims) and (on or not dims):
            made.append(self._request("color", value.get("color", 0xFFFFFF) if on else 0))
        if dims:
            made.append(self._request("write", self.wire(value)))
        return made


def _light_words(value: dict[str, Any]) -> str:
    if value.get("on") is not True:
        return "off"
    bright: Any = value.get("brightness")
    color: Any = value.get("color")
    return "on" + (f", {int(bright)} of {_FULL}" if _is_number(bright) else "") + (f", #{color & 0xFFFFFF:06x}" if type(color) is int else "")


class Value:
    """How a property stands. `how`: `reported`, `answered` or `set`; empty, and `why` says why it is not known. `since`: when it was last
    said or set, by the monotonic clock. `events` of a button within the last second: number and word."""

    def __init__(self, one: Any, now: float):
        _need(isinstance(one, dict), "value")
        age, how, why, events = one.get("age", 0), one.get("how", ""), one.get("unknown", ""), one.get("events", [])
        _need(_is_number(age) and 0 <= age <= 1e10 and isinstance(how, str) and isinstance(why, str), "value")
        known = how in ("reported", "answered", "set")
        _need("value" in one or not known, "value")
        _need(isinstance(events, list) and len(events) <= _MAX_EVENTS and all(
            isinstance(event, list) and len(event) == 2 and whole(event[0]) and isinstance(event[1], str) for event in events), "events")
        self.value: Any = one["value"] if known else None
        self.how: str = how if known else ""
        self.since: float = now - age
        self.why = "" if known else why if why in UNKNOWN else "never"
        self.events = [(number, word) for number, word in events if word in EVENTS]


_NONE = ("", (-1, 0))  # no document came


class Standing:
    """The list and the values of one board, of the documents that come. Raises ValueError for what is none."""

    def __init__(self) -> None:
        self.properties: dict[str, Told] = {}
        self.values: dict[str, Value] = {}
        self.listed = False  # a list came
        self.anew = False  # by the document that came last: the board restarted, and what it reported before does not count
        self._begun: tuple[str, int] | None = None
        self.acts: list[tuple[str, str]] = []  # what was done with buttons by the values that came last: id and word, each once
        self._last_act = ("", 0)  # session and number
        self._heads = dict.fromkeys(("list", "values"), _NONE)

    def take_list(self, document: dict[str, Any], board: str, holder: str) -> bool:
        """`holder`: the session of the board's description. Whether it counts; an empty one clears."""
        if not document:
            self.properties, self.listed, self._heads["list"] = {}, False, _NONE
            return True
        session, seq = _head(document, board)
        listed = _list(document.get("properties"))
        if not self._counts("list", session, (seq, 0), holder):
            return False
        self.properties, self.listed = listed, True
        return True

    def take_values(self, document: dict[str, Any], board: str, holder: str, now: float, stored: bool = False) -> bool:
        """`stored`: the broker kept it; what was done with a button is of an earlier time."""
        self.acts = []
        if not document:
            self.values, self._heads["values"], self._begun, self.anew = {}, _NONE, None, False
            return True
        session, seq = _head(document, board)
        values = _values(document, now)
        if not self._counts("values", session, (seq, 0), holder):
            return False
        self.values = values
        self._begin(document)
        last = self._last_act[1] if session == self._last_act[0] else 0
        new = {number: (id, word) for id, one in values.items() for number, word in one.events if number > last}
        self._last_act = session, max(new, default=last)
        if not stored:
            self.acts = [new[number] for number in sorted(new)]
        return True

    def take_answer(self, document: Any, board: str, holder: str, now: float, of: Callable[[str], bool]) -> dict[str, Any] | None:
        """The answer of the agent that was asked, about the services that `of` accepts: newer than what it published until then.
        Returns the levels of pins in it; None: it does not count."""
        _need(isinstance(document, dict), "answer")
        session, seq = _head(document, board)
        values, listed = _values(document, now), _list(document.get("properties", []))
        if not self._counts("values", session, (seq, 1), holder) or not self._counts("list", session, (seq, 1), holder):
            return None
        self._begin(document)
        self.properties = {**{id: one for id, one in self.properties.items() if not of(one.service)}, **listed}
        self.values = {**{id: one for id, one in self.values.items() if not of(id.partition("/")[0])}, **values}
        self.listed = True
        pins: dict[str, Any] = document.get("pins", {})
        return pins

    def _begin(self, document: dict[str, Any]) -> None:
        begun = document["session"], document.get("restarts", 0)
        self.anew = self._begun not in (None, begun)
        self._begun = begun

    def _counts(self, what: str, session: str, place: tuple[int, int], holder: str) -> bool:
        """A document of the session in the description counts, else that of the later session; within one session the later document."""
        old, newest = self._heads[what]
        if session == old:
            good = place >= newest
        else:  # its description may be on its way
            good = session == holder or (not old or old != holder) and session >= old and session >= holder
        if good:
            self._heads[what] = session, place
        return good


def _need(true: Any, what: str) -> None:
    if not true:
        raise ValueError(f"a board's properties or values are damaged: {what}")


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _head(document: dict[str, Any], board: str) -> tuple[str, int]:
    session, seq = document.get("session"), document.get("seq")
    _need(document.get("version") == VERSION and type(document["version"]) is int, "version")
    _need(document.get("board") == board and valid_board(board), "board")
    _need(isinstance(session, str) and valid_name(session), "session")
    _need(whole(seq), "seq")
    return str(session), document["seq"]


def _list(properties: Any) -> dict[str, Told]:
    _need(isinstance(properties, list) and len(properties) <= _MAX_PROPERTIES, "properties")
    told = {}
    for one in properties:
        made = Told(one)
        _need(made.id not in told, f"{made.id} twice")
        told[made.id] = made
    return told


def _text(one: dict[str, Any], name: str) -> str:
    text = one.get(name, "")
    _need(_is_text(text), name)
    return str(text)


def _is_text(text: Any) -> bool:
    return isinstance(text, str) and len(text.encode("utf-8", "replace")) <= _MAX_BYTES and not any(ord(c) < 32 or ord(c) == 127 for c in text)


def _usual(one: dict[str, Any]) -> dict[str, Any]:
    """The members that a list leaves out, since others say them."""
    id, settable = str(one.get("id")), "write" in one or "color" in one
    kind = one.get("kind", "number" if settable else "sensor")
    choices = [["off", 0], ["on", 1]] if kind in ("binary", "switch") else []
    type = _TYPES.get(str(kind)) or ("text" if one.get("max_length") else "choice" if one.get("choices") else "integer")
    read = f"/{id}" if kind in ("sensor", "binary") and not settable else ""
    name = id.translate(_BLANKS)
    return {"read": read, "name": name[:1].upper() + name[1:], "service": id.partition("/")[0], "kind": kind, "type": type, "choices": choices,
            "access": "read" if not settable else "write" if kind == "button" else "both"}


def _call(call: Any) -> tuple[str, list[float | None]]:
    _need(isinstance(call, list) and 0 < len(call) <= 17 and isinstance(call[0], str) and all(one is None or _is_number(one) for one in call[1:]), "command")
    return call[0], call[1:]


def _values(document: dict[str, Any], now: float) -> dict[str, Value]:
    values = document.get("values")
    _need(isinstance(values, dict) and len(values) <= _MAX_PROPERTIES and isinstance(document.get("clock", ""), str), "values")
    _need(all(map(_is_text, values or ())), "ids")
    pins, left_out = document.get("pins", {}), document.get("left_out", 0)
    _need(whole(document.get("restarts", 0)), "restarts")
    _need(isinstance(pins, dict) and all(isinstance(one, dict) for one in pins.values()) and whole(left_out, _MAX_PROPERTIES), "pins")
    return {id: Value(one, now) for id, one in (values or {}).items()}
