# SPDX-License-Identifier: Apache-2.0
"""One board of asip.testing, and its agent."""
from __future__ import annotations

import fnmatch
import json
from typing import Any, Callable, Iterable, Mapping

from . import _model
from .board import standard_model

Answer = Mapping[str, Any]


class FakeBoard:
    """A board of a MemoryBus. It executes each command that its models allow, and remembers it.

    `commands` is the list of (service, command, arguments) in the order of their arrival. `levels` holds what pins were set to.
    """

    def __init__(self, publish: Callable[..., None], name: str, services: Iterable["str | dict[str, Any]"]):
        self.name = name
        self.commands: list[tuple[str, str, list[Any]]] = []
        self.unanswered = 0  # requests that came while the board was silent
        self.levels: dict[int, int] = {}
        self.modes: dict[int, int] = {}
        self.labels: dict[str, str] = {}
        self._pin_names: dict[str, str] = {}
        self._pin_modes: dict[int, int] = {}  # as commands set them
        self._meanings: dict[str, dict[str, Any]] = {}
        self._offered: dict[str, dict[str, Any]] = {}  # properties by id
        self._stands: dict[str, Any] = {}              # their values, as on the wire
        self._told: dict[str, str] = {}
        self._acts: dict[str, list[Any]] = {}          # events of a button
        self._last_act = 0
        self.state = "online"
        self._publish = publish
        self._seq = self._restarts = 0
        self._models: dict[str, _model.Model] = {}
        for service in services:
            model = _model.Model(service) if isinstance(service, dict) else standard_model(service)
            if model is None:
                raise ValueError(f"there is no standard service {service!r}; give its model as a dict")
            self._models[model.name] = model
        self._inputs: dict[int, int] = {}
        self._fault: Callable[[str, str], Answer | None] = lambda service, command: None
        self._silent = False
        self.stopped = False  # and kept so, until it is resumed
        self._values: dict[tuple[str, str], Any] = {}

    def report(self, service: str, value: Any, event: str | None = None) -> None:
        """Publishes a value as the board's agent would; later `read()` calls that ask the board get it, too."""
        name = self._models[service].event(event).name
        self._values[service, name] = value
        for one in self._offered.values():
            place = one.get("read", "" if "write" in one else f"/{one['id']}").split("/")[1:]
            if one["service"] == service and place[:1] == [name]:
                self._stands[one["id"]] = value if len(place) == 1 else value[place[1] if isinstance(value, dict) else int(place[1])]
        self._tell()
        self._publish(f"{self.name}/{service}/out", {name: value})

    def press(self, pin: int, level: int = 1) -> None:
        """Changes the level of an input pin; of a button that is a `press` or a `release`."""
        before, self._inputs[pin] = self._inputs.get(pin, 0), level
        if before != level and self._meanings.get(f"io/{pin}", {}).get("class") == "button":
            self._act(pin, "press" if self._value(self._pin(pin, 2))["value"] else "release")
        self._tell()
        self._publish(f"{self.name}/io/out", {"digital": {str(pin): level}})

    def button(self, pin: int, event: str) -> None:
        """What is done with a button beside `press()`: `hold`, `double`."""
        self._act(pin, event)
        self._tell()

    def _act(self, pin: int, event: str) -> None:
        """Told as an agent tells it; those before are a second old."""
        self._last_act += 1
        self._acts = {f"io/{pin}": [[self._last_act, event]]}

    def fail(self, code: int, text: str = "INVALID_DEVICE_NUMBER", command: str | None = None) -> None:
        """From now on the board refuses commands (or the one that is named) with this error."""
        self._fault = lambda _service, name: {"status": "error", "code": code, "error": text} if command in (None, name) else None

    def refuse(self, reason: str = "queue-full", text: str = "the queue is full") -> None:
        """From now on the agent refuses commands with this reason."""
        self._fault = lambda *_: {"status": "refused", "reason": reason, "error": text}

    def doubt(self) -> None:
        """From now on commands are executed, but not proven."""
        self._fault = lambda *_: {"status": "timeout", "reason": "doubt"}

    def silence(self) -> None:
        """From now on nothing is answered."""
        self._silent = True

    def work(self) -> None:
        """Ends what fail(), refuse(), doubt() and silence() began."""
        self._fault, self._silent = lambda *_: None, False

    def lose(self, reason: str = "unplugged") -> None:
        """The board's cable is pulled."""
        self._say("lost", reason)

    def back(self) -> None:
        self._say("online", "")

    def _say(self, state: str, reason: str) -> None:
        if state == "online" and self.state != state:  # nothing is known of what it did meanwhile; levels of outputs are set again
            outputs = {f"io/{pin}" for pin, mode in self.modes.items() if mode == 3}
            self._stands = {id: value if id in outputs else None for id, value in self._stands.items()}
            self._restarts += 1
        self.state = state
        self._seq += 1
        self._announce(reason)
        self._tell()

    def _announce(self, reason: str = "") -> None:
        described = [{"name": name, "id": model.letter, "title": model.title, "model": model.document} for name, model in self._models.items()]
        self._publish(f"servicebus/{self.name}/$description", {
            "board": self.name, "session": "00000000000000aa", "seq": self._seq, "lease": 86400, "services": described, "labels": self.labels, "names": {"pins": self._pin_names}, "meanings": self._meanings,
            "pins": {"modes": "".join(map(str, self._all_modes())), "analog": {str(14 + channel): channel for channel in range(6)}},
            "state": {"is": self.state, "reason": reason, "age": 0}}, retained=True)
        self._publish(f"servicebus/{self.name}/$state", self.state, retained=True)

    def _name(self, request: dict[str, Any]) -> None:
        """Labels and names of pins: None takes one away."""
        for kept, given in ((self.labels, request.get("labels")), (self._pin_names, (request.get("names") or {}).get("pins"))):
            for key, value in (given or {}).items():
                kept.pop(key, None)
                if value is not None:
                    kept[key] = value
        for id, meaning in (request.get("meanings") or {}).items():
            self._meanings[id] = {name: value for name, value in {**self._meanings.get(id, {}), **(meaning or {})}.items() if meaning and value is not None}
        if {"labels", "names", "meanings"} & {*request}:
            self._say(self.state, "")

    def _asked(self, service: str | None, request: dict[str, Any]) -> Answer | None:
        if self._silent:
            self.unanswered += 1
            return None
        if self.state != "online":
            return {"status": "refused", "reason": "board-not-there", "error": f"the board is {self.state}"}
        if "renew" in request:
            return {"status": "ok", "proof": "renewed"}
        if service is None and request.get("resume") is True:
            self.stopped = False
            return {"status": "ok", "proof": "resumed"}
        if service is not None and self.stopped:
            return {"status": "refused", "reason": "stopped", "error": "the board is stopped"}
        if service is None:
            self._name(request)
            return {"status": "ok", "proof": "fence"}
        model = self._models.get(service)
        names = [name for name in request if model and name in model.commands]
        if model is None or not names:
            return {"status": "refused", "reason": "invalid", "error": f"no command in {json.dumps(request)}"}
        command = model.commands[names[0]]
        try:
            values = command.values(tuple(request[command.name]), {})
        except _model.ModelError as fault:
            return {"status": "refused", "reason": "invalid", "error": str(fault)}
        faulty = self._fault(service, command.name)
        if faulty is not None and faulty["status"] != "timeout":
            return faulty
        if model.name == "io" and command.name == "modes":
            return {"status": "ok", "proof": "answer", "answer": {"modes": self._all_modes()}}
        self.commands.append((service, command.name, values))
        if model.name == "io" and faulty is None:
            self._set_pin(command.name, values)
        for one in self._offered.values():
            name, *args = one.get("write", [""])
            if faulty is None and one["service"] == service and name == command.name and all(own in (None, given) for own, given in zip(args, values)):
                self._stands[one["id"]] = next((given for own, given in zip(args, values) if own is None), None)
        self._tell()
        event = model.answer_of(command)
        if faulty is None and event is not None:
            if (service, event.name) not in self._values:
                return {"status": "timeout", "reason": "no-value"}
            return {"status": "ok", "proof": "answer", "answer": {event.name: self._values[service, event.name]}}
        return faulty or {"status": "ok", "proof": "fence"}

    def _all_modes(self) -> list[int]:
        """As the standard firmware starts: digital pins are inputs, analog ones analog."""
        return [self.modes.get(pin, 4 if 14 <= pin < 20 else 1) for pin in range(max(19, *self.modes, 0) + 1)]

    def _set_pin(self, command: str, values: list[Any]) -> None:
        if command not in ("mode", "write", "pwm"):
            return
        pin, value = values
        if command == "write":
            self.levels[pin] = value
        else:
            self.modes[pin] = self._pin_modes[pin] = 5 if command == "pwm" else value
        if command == "mode":
            self._stands.pop(f"io/{pin}", None)
        else:
            self._stands[f"io/{pin}"] = value
        if command == "write":
            self._tell()
        else:
            self._say(self.state, "")  # its modes stand in its description
        if command == "mode" and value in (1, 2):
            self._publish(f"{self.name}/io/out", {"digital": {str(pin): self._inputs.get(pin, 0)}})

    # How it stands, as its agent tells it ---------------------------------------------------------------------------------

    def offer(self, id: str, kind: str, **members: Any) -> None:
        """Adds a property beside those of pins, as the agent of such a board tells it (docs/service-bus.md, "Properties and their values"):
        `offer("servo/0/angle", "number", min=0, max=180, write=["write", 0, None])`,
        `offer("distance/0", "sensor", unit="cm")`."""
        type = {"binary": "boolean", "switch": "boolean", "select": "choice", "button": "action", "light": "light", "text": "text"}.get(kind, "integer")
        self._offered[id] = {"id": id, "name": id, "service": id.partition("/")[0], "kind": kind, "type": type,
                             "access": "both" if "write" in members else "read", **members}
        self._tell()

    def _properties(self) -> list[dict[str, Any]]:
        """Those that were offered, and the pins that a command or a meaning made something."""
        inputs = ("button", "door", "window", "motion", "occupancy", "moisture", "smoke", "vibration")
        pins = {**self._pin_modes, **{int(id[3:]): 2 if one.get("class") in inputs else 3 for id, one in self._meanings.items() if one.get("class") and id.startswith("io/")}}
        return [*self._offered.values(), *(self._pin(pin, mode) for pin, mode in sorted(pins.items()) if mode in (1, 2, 3, 4, 5))]

    def _pin(self, pin: int, mode: int) -> dict[str, Any]:
        meaning = self._meanings.get(f"io/{pin}", {})
        one: dict[str, Any] = {"id": f"io/{pin}", "name": self._pin_names.get(str(pin), f"Pin {pin}"), "service": "io", "meaning": meaning, "type": "integer",
                               "access": "both" if mode in (3, 5) else "read", "kind": {3: "switch", 4: "sensor", 5: "number"}.get(mode, "binary")}
        if mode in (4, 5):
            one.update(min=0, max=255 if mode == 5 else 1023)
        else:
            on = 0 if meaning.get("inverted", mode == 2) else 1
            one.update(type="boolean", choices=[["off", 1 - on], ["on", on]])
        if mode in (3, 5):
            one["write"] = ["write" if mode == 3 else "pwm", pin, None]
        else:
            one["read"] = f"/analog/{pin - 14}" if mode == 4 else f"/digital/{pin}"
        if mode in (3, 5) and self.modes.get(pin) != mode:
            one["before"] = ["mode", pin, mode]
        if mode in (3, 5) and self._pin_modes.get(pin) in (1, 2, 4):
            one["refused"] = f"a command made pin {pin} no output, and {meaning['class']} needs one: asipctl pin {self.name} {pin} output"
        return one

    def _value(self, one: dict[str, Any]) -> dict[str, Any]:
        pin = int(one["id"][3:]) if one["id"].startswith("io/") else None
        raw = self._inputs.get(pin, 0) if one["kind"] == "binary" and pin is not None else self._stands.get(one["id"])
        if raw is None:
            return {"unknown": "restart" if one["id"] in self._stands else "never", "age": 0}
        value = None if raw == one.get("none") else {number: word == "on" for word, number in one.get("choices", [])}.get(raw, raw)
        told = {"value": value, "how": "set" if "write" in one else "reported", "age": 0}
        return {**told, "events": self._acts[one["id"]]} if one["id"] in self._acts else told

    def _document(self, **members: Any) -> dict[str, Any]:
        return {"version": 1, "board": self.name, "session": "00000000000000aa", "seq": self._seq, **members}

    def _tell(self) -> None:
        """Publishes what is told now, where it is something else than before."""
        listed = self._properties()
        documents: dict[str, dict[str, Any]] = {
            f"servicebus/{self.name}/$properties": {"properties": listed},
            f"{self.name}/$values": {"restarts": self._restarts, "values": {one["id"]: self._value(one) for one in listed if one["kind"] != "button"}}}
        for topic, members in documents.items():
            text = json.dumps(members)
            if self._told.get(topic) != text:
                self._told[topic] = text
                self._seq += 1
                self._publish(topic, self._document(**members), retained=True)

    def _questioned(self, services: Iterable[str]) -> Answer | None:
        if self._silent:
            return None
        listed = [one for one in self._properties() if any(fnmatch.fnmatchcase(one["service"], service) for service in services)]
        pins = {"digital": {str(pin): level for pin, level in self._inputs.items()}, "analog": self._values.get(("io", "analog"), {})}
        return {"status": "ok", "proof": "memory", "answer": self._document(properties=listed, pins=pins, restarts=self._restarts, values={one["id"]: self._value(one) for one in listed})}
