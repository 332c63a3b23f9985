# SPDX-License-Identifier: Apache-2.0
"""One board: its state, its services as attributes, its pins."""
from __future__ import annotations

import json
import os
import threading

from . import _model, _wait, errors
from ._bank import Bank
from ._chips import Transfers
from ._followed import Followed
from ._topics import valid_name
from .i2c import I2C, SMBus
from .onewire import OneWire
from .pin import Pin
from .property import Property
from .service import Service, class_of
from .spi import SPI

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Iterator, Mapping
    from ._followed import Home

_standard_models: dict[str, _model.Model] = {}


def standard_model(name: str) -> _model.Model | None:
    """The model of a standard service (`servo`), from the package's own files; None where there is none."""
    if name not in _standard_models:
        file = os.path.join(os.path.dirname(__file__), "models", f"{name}.json")
        if not valid_name(name) or name == "schema" or not os.path.isfile(file):
            return None
        with open(file, encoding="utf-8") as text:
            _standard_models[name] = _model.Model(json.load(text))
    return _standard_models[name]


def model_of(described: dict[str, Any], known: Mapping[str, _model.Model]) -> _model.Model | None:
    """The model of a service: the one that the board carries, else the one that it refers to (`servo@1`), of the package's copies
    or of `known`. The commands and values of one version are the same everywhere, so any copy of it will do."""
    model = described.get("model")
    try:
        if isinstance(model, dict):
            return _model.Model(model)
        if isinstance(model, str):
            name, _, version = model.partition("@")
            own = standard_model(name)
            return own if own and str(own.version) == version else known.get(model)
    except _model.ModelError:
        pass
    return None


class Board(Followed):
    """A board on the bus. Services are attributes, `board.servo`, or `board["servo"]`; what can be read and set stands in
    `board.properties`, `board["io/13"]`.

    Get one by `bus.board("desk")`. Its state is followed from then on.
    """

    def __init__(self, bus: Home, name: str):
        super().__init__(bus, name)
        self._services: dict[str, Service] = {}
        self._described: tuple[str, int] = ("", -2)
        self._reading = threading.Lock()
        self._bank = Bank(self)
        self._pins: dict[int, Pin] = {}
        self._properties: dict[str, Property] = {}
        self._chips = threading.Lock()
        self._spi = threading.Lock()

    # Services -----------------------------------------------------------------------------------------------------------

    @property
    def services(self) -> Mapping[str, Service]:
        """Services by name."""
        entry = self._entry()
        if entry is not None and (entry.session, entry.seq) != self._described:
            with self._reading:  # of several threads none sees services that another one is still making
                if (entry.session, entry.seq) != self._described:
                    self._read_services(entry.description)
                    self._described = (entry.session, entry.seq)
        return self._services

    def _read_services(self, description: dict[str, Any]) -> None:
        kept = {}
        for described in description.get("services") or []:
            name = described["name"]
            made = class_of(model_of(described, self.bus._models))
            old = self._services.get(name)
            kept[name] = old if type(old) is made else made(self, name, str(described.get("title", "")))
        self._services = kept

    def _unknown_models(self) -> set[str]:
        """The models that its description refers to, and that are not known here: `lights@3`."""
        described = [one for one in self.description.get("services") or [] if isinstance(one.get("model"), str)]
        return {one["model"] for one in described if model_of(one, self.bus._models) is None}

    def __getitem__(self, name: str) -> Any:
        """The service of this name, or the property of this id (`io/13`); KeyError (NotThere) names the nearest one."""
        if isinstance(name, str) and "/" in name:
            return self.property(name)
        services = self.services
        found = services.get(name) or next((one for own, one in services.items() if _model.identifier(own) == name), None)
        if found is None:
            raise errors.NotThere(f"{self.name} has no service {name!r}" + (_model.near(str(name), services) or (
                f"; it has {', '.join(services)}" if services else "; it has none")), board=self.name, service=name)
        return found

    @property
    def properties(self) -> list[Property]:
        """What can be read and set, as the board's agent tells it, in its order; of a board that is away, what it told last. Unproven where
        its agent is of a version that tells nothing."""
        return [self._property(id) for id in self._known_properties()]

    def _known_properties(self) -> list[str]:
        bank = self._bank
        if self._is_gone():
            bank.hear()
            with bank.changed:
                _wait.until(bank.changed, lambda: bank.standing.listed, min(1.0, self._timeout(None)))
        else:
            bank.ask("*", self._timeout(None))
        return [*bank.standing.properties]

    def property(self, id: str) -> Property:
        """The property of this id, `servo/0/angle`; NotThere (a LookupError) names the nearest one."""
        known = self._bank.standing.properties
        if id not in known and id not in self._known_properties():
            ids = self._bank.standing.properties
            raise errors.NotThere(f"{self.name} has no property {id!r}" + (_model.near(str(id), ids) or (
                f"; it has {', '.join([*ids][:12])}" if ids else "; it has none")), board=self.name)
        return self._property(id)

    def _property(self, id: str) -> Property:
        if id not in self._properties:
            self._properties[id] = Property(self, self._bank, lambda: self.services, id)
        return self._properties[id]

    def __contains__(self, name: object) -> bool:
        return name in self.services

    def __iter__(self) -> Iterator[Service]:
        return iter(list(self.services.values()))

    # What a board can be asked beside its services -------------------------------------------------------------------------

    def raw(self, line: str, *, timeout: float | None = None) -> Any:
        """Sends an ASIP request line, `S,W,0,90`. Returns the board's answer, None where the line asks for none."""
        return self._ask({"raw": line}, "raw", timeout).get("answer")

    def label(self, **labels: str | None) -> None:
        """Sets labels, which the board's agent keeps; None removes one: `board.label(room="lab", shelf=None)`."""
        self._ask({"labels": labels}, "label", timeout=None)
        self._until_told(lambda: all(self.labels.get(name) == value for name, value in labels.items()))

    def name_pins(self, names: Mapping[int, str | None]) -> None:
        """Gives pins friendly names: `board.name_pins({13: "status lamp"})`. None removes one."""
        wanted = {str(number): name for number, name in names.items()}
        self._ask({"names": {"pins": wanted}}, "name", timeout=None)
        self._until_told(lambda: all(self._bank.names().get(number) == name for number, name in names.items()))

    def set_meaning(self, id: str, kind: str | None = "", **members: Any) -> None:
        """Says what a property is, for every program; the board's agent keeps it: `board.set_meaning("io/2", "door", inverted=True)`.
        `kind` is its class (docs/service-bus.md, "Properties and their values"), None: the meaning is removed. Members are `inverted`,
        `debounce` (ms), `unit` with `line` (`[0, 1023, 0, 100]`), `icon`, `hidden`; None removes one."""
        wanted = None if kind is None else {**({"class": kind} if kind else {}), **members}
        if wanted == {}:
            raise errors.Invalid(f"{self.name}/{id}: nothing is said of it", board=self.name, reason="invalid")
        self._ask({"meanings": {id: wanted}}, "meaning", timeout=None)
        self._until_told(lambda: _says(self.description.get("meanings"), id, wanted))

    def _until_told(self, true: Any) -> None:
        """What was accepted stands in the next description: it comes soon, and what follows here may count on it."""
        self._follow()
        changed = self._engine.changed
        with changed:
            _wait.until(changed, lambda: true() or self._engine.closed, 2.0)

    def _ask(self, members: dict[str, Any], what: str, timeout: float | None) -> dict[str, Any]:
        seconds = self._timeout(timeout)
        call = self._engine.ask(lambda session, now: session.command(now, self.name, None, what, members, seconds))
        answer: dict[str, Any] = _wait.result(call.future)
        return answer

    def stop(self, *, hold: bool = False, why: str = "", timeout: float | None = None) -> None:
        """Makes the board safe: what waits is refused, and every service's safe form is executed ahead of it. With `hold`
        the board refuses the commands of every sender until `resume()`, and tells them `why`."""
        seconds = self._timeout(timeout)
        _wait.result(self._engine.stop(self.name, seconds, hold=hold, why=why).future)

    def resume(self, *, timeout: float | None = None) -> None:
        """Lets a board that is stopped take commands again. Nothing that was refused is sent then."""
        self._ask({"resume": True}, "resume", timeout)

    def pin(self, which: int | str) -> Pin:
        """A pin by its number, by the friendly name that people gave it, or an analog one as `A0`."""
        if isinstance(which, str):
            number = self._bank.number_of(which)
            if number is None:
                raise errors.Invalid(f"{self.name} has no pin named {which!r}" + _model.near(which, self._bank.names().values()), board=self.name)
            which = number
        if not isinstance(which, int) or isinstance(which, bool) or not 0 <= which <= 255:
            raise errors.Invalid(f"{self.name}: {which!r} is no pin: a number from 0 to 255, or a name", board=self.name)
        if which not in self._pins:
            self._pins[which] = Pin(self, self._bank, self._io, which)
        return self._pins[which]

    def _io(self) -> Service:
        return self._bank.io(self.services)

    # Any chip ------------------------------------------------------------------------------------------------------------

    def i2c(self, *, timeout: float | None = None) -> I2C:
        """The board's I2C bus, as drivers for CircuitPython expect it (`busio.I2C`). Needs the service `i2c` on the board, which is
        `board["i2c"]`. All of a program share its lock."""
        return I2C(self._transfers(timeout))

    def smbus(self, *, timeout: float | None = None) -> SMBus:
        """The same, as programs of `smbus2` expect it."""
        return SMBus(self._transfers(timeout))

    def onewire(self, *, timeout: float | None = None) -> OneWire:
        """The board's 1-Wire bus, as drivers for CircuitPython expect it (`OneWireBus` of `adafruit_onewire.bus`). Needs the service
        `onewire` on the board."""
        return OneWire(self["onewire"], timeout)

    def spi(self, *, timeout: float | None = None) -> SPI:
        """The board's SPI bus, as drivers for CircuitPython expect it (`busio.SPI`). Needs the service `spi` on the board."""
        return SPI(self["spi"], timeout, self._spi)

    def _transfers(self, timeout: float | None) -> Transfers:
        transfers = Transfers(self["i2c"], timeout)
        transfers.lock = self._chips
        return transfers

    # For people ---------------------------------------------------------------------------------------------------------

    def __repr__(self) -> str:
        return f"<asip board {self.name}: {self.status}>"

    def _repr_html_(self) -> str:
        import html
        head = "".join(f"<th>{one}</th>" for one in ("service", "", "values", "commands"))
        rows = "".join("<tr>" + "".join(f"<td>{html.escape(text)}</td>" for text in (one.name, one.title, *_told(one.model))) + "</tr>" for one in self)
        labels = html.escape(", ".join(f"{name}={value}" if value else name for name, value in sorted(self.labels.items())))
        return (f"<b>{html.escape(self.name)}</b>: {html.escape(self.status)}{f' ({labels})' if labels else ''}"
                f"<table><tr>{head}</tr>{rows}</table>")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(_model.identifier(name) for name in self.services)})

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except errors.NotThere as fault:
            raise AttributeError(str(fault)) from None


def _says(meanings: Any, id: str, wanted: dict[str, Any] | None) -> bool:
    told: dict[str, Any] = meanings.get(id, {}) if isinstance(meanings, dict) else {}
    return told == {} if wanted is None else all(told.get(name) == value for name, value in wanted.items())


def _told(model: _model.Model | None) -> tuple[str, str]:
    """A service's values and commands, for a table: `distance (cm)`, `measure(), report(period)`."""
    if model is None:
        return "", ""
    values = ", ".join(f"{one.name} ({one.unit})" if one.unit else one.name for one in model.events.values())
    commands = ", ".join(f"{name}({', '.join(_model.identifier(field.name) for field in one.args)})" for name, one in model.attributes.items())
    return values, commands
