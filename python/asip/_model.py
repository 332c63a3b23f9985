# SPDX-License-Identifier: Apache-2.0
"""Service models: what a service's commands take and its events carry (docs/service-models.md). Pure.

The checks are those that agents make, in the same words, so that a mistake is an error here and not after a round trip.
"""
from __future__ import annotations

import json
import keyword
import math
import re

TYPE_CHECKING = False
if TYPE_CHECKING:
    import inspect
    from typing import Any, Iterable

_INT32 = (-2**31, 2**31 - 1)
_MAX_REQUEST_BYTES = 62


class ModelError(ValueError):
    """The arguments do not fit the model, or the document is no model. The text is one line for a person."""


def near(word: str, names: Iterable[str], quote: str = "'") -> str:
    """`; did you mean 'write'?`, or nothing."""
    import difflib
    lower = {name.lower(): name for name in names}
    found = difflib.get_close_matches(word.lower(), lower, 1, 0.6)
    return f"; did you mean {quote}{lower[found[0]]}{quote}?" if found else ""


def identifier(name: str) -> str:
    """A command's or service's name as Python writes it: `stop-all` is `stop_all`, `class` is `class_`."""
    made = "_".join(re.findall("[A-Za-z0-9]+", name)) or "_"
    if made[0].isdigit():
        made = "_" + made
    return made + "_" if keyword.iskeyword(made) or made == "self" else made


def _shown(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), default=str)
    return text if len(text) <= 40 else text[:40] + "..."


def _number_text(number: float) -> str:
    return str(int(number)) if number == math.floor(number) else repr(number)


_REQUIRED: Any = object()


def _member(document: Any, name: str, kind: type, default: Any = _REQUIRED) -> Any:
    """A member of this type; another type is a ValueError, a missing one a KeyError where there is no default."""
    if not isinstance(document, dict):
        raise ValueError(f"what should have {name!r} is no object")
    value = document[name] if default is _REQUIRED else document.get(name, default)
    if value is not default and (not isinstance(value, kind) or isinstance(value, bool)):
        raise ValueError(f"{name!r} is of another type")
    return value


def _number(document: dict[str, Any], name: str) -> float | None:
    value = document.get(name)
    if value is not None and (isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < 1e15):
        raise ValueError(f"{name!r} is no number")
    return value


class Field:
    """One argument of a command, or one field of an event or of an item of a list."""

    def __init__(self, document: dict[str, Any]):
        self.name: str = _member(document, "name", str)
        self.type: str = _member(document, "type", str)
        self.title: str = _member(document, "title", str, "")
        self.unit: str = _member(document, "unit", str, "")
        self.min: float | None = _number(document, "min")
        self.max: float | None = _number(document, "max")
        self.none: float | None = _number(document, "none")
        self.names: dict[str, int] = dict(_member(document, "names", dict, {}))
        self.items = [Field(item) for item in _member(document, "items", list, [])]
        self.of: str = _member(document, "of", str, "")
        self.max_length: int | None = _member(document, "max_length", int, None)
        self.braces: bool = bool(document.get("braces", False))
        if any(type(number) is not int for number in self.names.values()):
            raise ValueError("'names' are names of numbers")

    @property
    def what(self) -> str:
        """`integer, 0 to 180 degrees`"""
        if self.type == "list":
            return "list of " + ":".join(item.name for item in self.items)
        text = self.type
        if self.min is not None and self.max is not None:
            text += f", {_number_text(self.min)} to {_number_text(self.max)}"
        text += f" {self.unit}" if self.unit else ""
        if self.names:
            text += " or " + ", ".join(f'"{name}"' for name in self.names)
        return text

    @property
    def annotation(self) -> str:
        kinds = {"integer": "int", "number": "float", "text": "str", "color": "int | str", "list": "list"}
        kind = kinds.get(self.type, "object")
        return kind + " | str" if self.names and self.type == "integer" else kind

    def check(self, value: Any, place: str) -> tuple[Any, str]:
        """The value as it is sent, and as it stands on the line to the board. Raises ModelError."""
        if self.type == "list":
            return self._check_list(value, place)
        if self.type == "text":
            return self._check_text(value, place)
        return self._check_number(value, place)

    def _check_number(self, value: Any, place: str) -> tuple[Any, str]:
        number = self._number_of(value)
        if number is None or not math.isfinite(number):
            raise ModelError(f"{place}: {self._wrong_kind(value)}")
        if self.type != "number" and number != math.floor(number):
            raise ModelError(f"{place}: {_number_text(number)} is not an integer")
        low = _INT32[0] if self.min is None else self.min
        high = _INT32[1] if self.max is None else self.max
        if self.type == "color":
            low, high = 0 if self.min is None else low, 0xFFFFFF if self.max is None else high
        if number < low:
            raise ModelError(f"{place}: {_number_text(number)} is below {_number_text(low)}")
        if number > high:
            raise ModelError(f"{place}: {_number_text(number)} is above {_number_text(high)}")
        return (int(number) if number == math.floor(number) else number), _number_text(number)

    def _number_of(self, value: Any) -> float | None:
        if isinstance(value, str):
            if value in self.names:
                return self.names[value]
            if self.type == "color" and len(value) == 7 and value[0] == "#":
                try:
                    return int(value[1:], 16)
                except ValueError:
                    return None
            return None
        try:  # bool and whatever counts as a number, those of NumPy too
            return float(value)
        except (TypeError, ValueError, OverflowError):
            return None

    def _wrong_kind(self, value: Any) -> str:
        if self.type == "color":
            return f'{_shown(value)} is not a color: a number or "#rrggbb"'
        if self.type == "number":
            return f"{_shown(value)} is not a number"
        if not self.names or not isinstance(value, str):
            return f"{_shown(value)} is not an integer"
        return f"{_shown(value)} is neither an integer nor a name" + near(value, self.names, '"')

    def _check_text(self, value: Any, place: str) -> tuple[Any, str]:
        if not isinstance(value, str):
            raise ModelError(f"{place}: {_shown(value)} is not a string")
        if not all(" " <= c <= "~" for c in value):
            raise ModelError(f"{place}: holds characters that are not printable ASCII")
        if self.max_length is not None and len(value) > self.max_length:
            raise ModelError(f"{place}: {len(value)} characters are more than {self.max_length}")
        return value, value

    def _check_list(self, value: Any, place: str) -> tuple[Any, str]:
        if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
            raise ModelError(f"{place}: {_shown(value)} is not a list")
        items = list(value)
        if not items:
            raise ModelError(f"{place}: the list is empty")
        most = self.max_length if self.max_length is not None else _MAX_REQUEST_BYTES // 2
        if len(items) > most:
            raise ModelError(f"{place}: {len(items)} items are more than {most}")
        checked = [self._check_item(item, f"{place}/{i}") for i, item in enumerate(items)]
        text = ",".join(wire for _, wire in checked)
        return [made for made, _ in checked], f"{{{text}}}" if self.braces else text

    def _check_item(self, item: Any, place: str) -> tuple[Any, str]:
        if len(self.items) == 1 and not isinstance(item, (list, tuple, dict)):
            return self.items[0].check(item, place)
        form = ":".join(field.name for field in self.items)
        if isinstance(item, dict):
            missing = [field.name for field in self.items if field.name not in item]
            if missing:
                raise ModelError(f"{place}: '{missing[0]}' is missing")
            if len(item) != len(self.items):
                raise ModelError(f"{place}: not an item of {form}")
            item = [item[field.name] for field in self.items]
        if isinstance(item, str) or not hasattr(item, "__iter__"):
            raise ModelError(f"{place}: not an item of {form}")
        values = list(item)
        if len(values) != len(self.items):
            raise ModelError(f"{place}: not an item of {form}")
        alone = len(self.items) == 1
        checked = [field.check(part, place if alone else f"{place}/{field.name}") for field, part in zip(self.items, values)]
        return [made for made, _ in checked], ":".join(wire for _, wire in checked)


class Command:
    """One command of a service."""

    def __init__(self, letter: str, name: str, document: dict[str, Any]):
        self.name = name
        self.title: str = _member(document, "title", str, "")
        self.tag: str = _member(document, "tag", str, "")
        self.answer: str | None = _member(document, "answer", str, None)
        self.safe: Any = document.get("safe")
        self.all_args = [Field(field) for field in _member(document, "args", list, [])]
        self.args = [field for field in self.all_args if field.type != "count"]
        if any(field.type == "count" and field.of not in [one.name for one in self.args if one.type == "list"] for field in self.all_args):
            raise ValueError(f"{name!r} counts what is no list of it")
        identifiers = ["self", "timeout", *(identifier(field.name) for field in self.args)]
        if len({*identifiers}) != len(identifiers):
            raise ValueError(f"{name!r} has two arguments of one name")
        self._letter = letter

    def values(self, args: tuple[Any, ...], named: dict[str, Any]) -> list[Any]:
        """The arguments of a call in the order of the model, checked. Raises ModelError, in the words of agents."""
        return self._checked(args, named)[0]

    def line(self, args: tuple[Any, ...], named: dict[str, Any]) -> str:
        """The request as it stands on the line to the board, `S,W,0,90`."""
        return self._checked(args, named)[1]

    def _checked(self, args: tuple[Any, ...], named: dict[str, Any]) -> tuple[list[Any], str]:
        names = [field.name for field in self.args]
        by_identifier = {identifier(name): name for name in names}
        given = {by_identifier.get(name, name): value for name, value in named.items()}
        for name in given:
            if name not in names:
                raise ModelError(f"{self.name} has no argument '{name}'" + near(name, names))
        if len(args) + len(given) > len(names):
            raise ModelError(self._wrong_count(len(args) + len(given)))
        for name in names[:len(args)]:
            if name in given:
                raise ModelError(f"{self.name}: argument '{name}' is given twice")
        whole = list(args)
        for name in names[len(args):]:
            if name not in given:
                raise ModelError(f"{self.name}: argument '{name}' is missing")
            whole.append(given[name])
        values, wire = [], ""
        checked = {field.name: field.check(value, field.name) for field, value in zip(self.args, whole)}
        for field in self.all_args:
            if field.type == "count":
                wire += f",{len(checked[field.of][0])}"
            else:
                values.append(checked[field.name][0])
                wire += f",{checked[field.name][1]}"
        if len(wire) + 3 > _MAX_REQUEST_BYTES:
            raise ModelError(f"{self.name}: the request would be {len(wire) + 3} bytes long, above {_MAX_REQUEST_BYTES}; "
                             f"send it in parts")
        return values, f"{self._letter},{self.tag}{wire}"

    def _wrong_count(self, given: int) -> str:
        if not self.args:
            return f"{self.name} takes no argument, not {given}"
        names = ", ".join(field.name for field in self.args)
        return f"{self.name} takes {len(self.args)} argument{'' if len(self.args) == 1 else 's'} ({names}), not {given}"

    @property
    def signature(self) -> inspect.Signature:
        """As `help()` shows it: the model's arguments, then `timeout`."""
        import inspect
        kind = inspect.Parameter
        own = [kind(identifier(field.name), kind.POSITIONAL_OR_KEYWORD, annotation=field.annotation) for field in self.args]
        return inspect.Signature([kind("self", kind.POSITIONAL_OR_KEYWORD), *own,
                                  kind("timeout", kind.KEYWORD_ONLY, default=None, annotation="float | None")])

    @property
    def doc(self) -> str:
        lines = [f"{self.title or self.name}."]
        if self.args:
            lines.append("")
            lines += [f"{identifier(field.name)}: {field.title + ', ' if field.title else ''}{field.what}" for field in self.args]
        lines += ["", "Returns when the board has executed it." if not self.answer else
                  "Returns the board's answer.", "Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected."]
        return "\n".join(lines)


class Event:
    """One kind of value that a service reports."""

    def __init__(self, tag: str, document: dict[str, Any]):
        self.tag = tag
        self.name: str = _member(document, "name", str)
        self.fields = [Field(field) for field in _member(document, "fields", list, [])]
        self.nones = {field.name: field.none for field in self.fields if field.none is not None}

    @property
    def unit(self) -> str:
        return self.fields[0].unit if self.fields else ""


class Model:
    """A service model. Raises ModelError where `document` is none."""

    def __init__(self, document: dict[str, Any]):
        try:
            self.name: str = _member(document, "name", str)
            self.version: int = _member(document, "version", int, 1)
            self.letter: str = _member(document, "id", str, "")
            self.title: str = _member(document, "title", str, self.name)
            self.commands = {name: Command(self.letter, name, one) for name, one in _member(document, "commands", dict, {}).items()}
            events = [Event(tag, one) for tag, one in _member(document, "events", dict, {}).items()]
            self.events = {event.name: event for event in events}
        except (KeyError, ValueError) as fault:
            raise ModelError(f"this is no service model: {fault}") from None
        self.document = document
        self.attributes = {identifier(name): command for name, command in self.commands.items()}

    def command(self, name: str) -> Command:
        found = self.commands.get(name) or self.attributes.get(name)
        if found is None:
            all_names = ", ".join(self.commands)
            hint = near(str(name), self.commands) or (f"; {self.name} has {all_names}" if all_names else f"; {self.name} takes none")
            raise ModelError(f"no command '{name}'{hint}")
        return found

    def event(self, name: str | None) -> Event:
        """The event of this name; without a name the first one."""
        if name is None:
            for first in self.events.values():
                return first
            raise ModelError(f"{self.name} reports no values")
        if name not in self.events:
            raise ModelError(f"{self.name} has no event '{name}'" + (near(str(name), self.events) or "; it has " + ", ".join(self.events)))
        return self.events[name]

    def answer_of(self, command: Command) -> Event | None:
        return next((event for event in self.events.values() if event.tag == command.answer), None)

    def safe_form(self, command: Command, values: list[Any]) -> tuple[Command, list[Any]] | None:
        """What undoes `command` with these values: a command and its arguments; None where nothing does."""
        if isinstance(command.safe, str):
            other = self.commands.get(command.safe)
            if other is None:
                return None
            given = {field.name: value for field, value in zip(command.args, values)}
            return other, [given[field.name] for field in other.args if field.name in given]
        if isinstance(command.safe, list):
            return command, [value if fixed is None else fixed for fixed, value in zip(command.safe, values)]
        return None
