# SPDX-License-Identifier: Apache-2.0
"""What properties are and say in the real Home Assistant: meanings of pins, ids for ever, values that were never announced, classes, the gateway."""

import json
import unittest

from bus import DESK, LAMP, ROOT, eventually, free_port
from home_assistant import HomeAssistant
from home_assistant_test import SmartBus
from scripted_board import ScriptedBoard

BOARD = {**DESK, "parts": [*DESK["parts"], {"kind": "potentiometer", "name": "pot", "pin": "A0", "position": 0.5}]}
GAUGE = {"name": "distance", "version": 1, "id": "D", "match": ["Distance"], "title": "Gauge", "element": "gauge", "commands": {},
         "events": {"e": {"name": "distance", "per": "element", "title": "What it reads", "fields": [
             {"name": "level", "type": "integer", "min": 10, "max": 20},
             {"name": "speed", "type": "integer", "min": 0, "max": 2, "names": {"off": 0, "slow": 1, "fast": 2}},
             {"name": "used", "type": "number", "unit": "kWh", "quantity": "energy"}]}}}
AIM = {"aim": {"tag": "A", "title": "Aim", "args": [{"name": "at", "type": "integer", "min": 0, "max": 9}]}}


class MeaningBus(SmartBus):
    export = ("--home-assistant", "--host", "boards.example")

    def __init__(self):
        self.gauge = ScriptedBoard()
        super().__init__(boards=(BOARD, LAMP))

    def start_gateway(self, *more):
        # An address that is none of this machine's own names, so that the page has a link; 127.0.0.1 all the same.
        super().start_gateway("--http", f"[::ffff:127.0.0.1]:{self.page_port}", "--anonymous", "viewer", *more)

    def start_gauge(self, **commands):
        """With a model of its own, of which Home Assistant and the gateway learn from the board's agent."""
        folder = self.work / "services"
        folder.mkdir(exist_ok=True)
        (folder / "gauge.json").write_text(json.dumps(GAUGE | {"commands": commands}))
        self.start("agent-gauge", "asip-agent", "--tcp", f"127.0.0.1:{self.gauge.port}", "--name", "gauge", "--lease", "6",
                   "--patience", "60", "--services", str(folder))
        eventually(lambda: self.state("gauge") == "online", "the gauge", 60)

    def close(self):
        super().close()
        self.gauge.close()


class Properties(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        MeaningBus.page_port = free_port()
        cls.bus = MeaningBus()
        cls.addClassCleanup(cls.bus.close)
        cls.bus.start_gauge()
        cls.home = HomeAssistant(cls.bus.broker_port)
        cls.addClassCleanup(cls.home.close)

    def tearDown(self):
        self.assertEqual(self.home.complaints(), [])

    def find(self, unique):
        """The id of an entity, by the id that it keeps for ever."""
        return next((entity for entity, each in self.home.entities().items() if each["unique_id"] == unique), None)

    def entity(self, unique, platform):
        eventually(lambda: (self.find(unique) or "").startswith(platform + "."), f"{unique} as {platform}", 30)
        entity = self.find(unique)
        eventually(lambda: self.home.value(entity) not in (None, "unavailable"), f"{entity}, available", 30)
        return entity

    def becomes(self, entity, value):
        try:
            eventually(lambda: self.home.value(entity) == value, entity, 30)
        except AssertionError:
            self.fail(f"{entity} is {self.home.state(entity)}, not {value}\n{self.bus.logs()}")

    def attributes(self, entity, *names):
        return [self.home.state(entity)["attributes"].get(name) for name in names]

    def test_Button_IsOnWhilePressed_AndIsAnEvent(self):
        self.bus.ctl("label", "desk/io/2", "class=button")
        button, events = self.entity("asip-desk_io-2", "binary_sensor"), self.entity("asip-desk_io-2--event", "event")
        self.bus.ctl("send", "desk/io", "mode", "2", "input-pullup")
        self.becomes(button, "off")
        # It may be held for 0.8 s before it is looked at.
        for act, state, told in (("press", "on", ("press", "hold")), ("release", "off", ("release",))):
            self.bus.sim(act, "desk/button")
            self.becomes(button, state)
            eventually(lambda wanted=told: self.attributes(events, "event_type")[0] in wanted, f"the event {told}")
        # The same entity tells the other level by its meaning.
        self.bus.ctl("label", "desk/io/2", "class=door", "inverted=no")
        self.becomes(button, "on")
        self.assertEqual(self.attributes(button, "device_class"), ["door"])
        eventually(lambda: self.find("asip-desk_io-2--event") is None, "no events of a door")
        self.assertEqual(self.find("asip-desk_io-2"), button)

    def test_PinWithAMeaning_IsShownAndSetByIt(self):
        self.bus.ctl("label", "lamp/io/13", "class=light")
        lamp = self.entity("asip-lamp_io-13", "light")
        self.home.call("light.turn_on", lamp)
        self.becomes(lamp, "on")
        self.assertTrue(self.bus.part("lamp/lamp").startswith("on"))
        self.bus.ctl("label", "desk/io/14", "class=energy", "unit=kWh", "line=0:1023:0:100")
        meter = self.entity("asip-desk_io-14", "sensor")
        self.bus.ctl("send", "desk/io", "mode", "14", "analog")
        eventually(lambda: 45 < float(self.home.value(meter)) < 55, "half of the line")
        self.assertEqual(self.attributes(meter, "device_class", "state_class", "unit_of_measurement", "friendly_name"),
                         ["energy", "total_increasing", "kWh", "desk Pin A0"])

    def test_DistanceWithoutEcho_IsUnknown(self):
        distance = self.entity("asip-desk_distance-0", "sensor")
        self.becomes(distance, "42")
        self.bus.sim("set", "desk/distance", "none")
        self.becomes(distance, "unknown")

    def test_Ids_AreThoseOfTheCommittedTable(self):
        rows = [line.split() for line in (ROOT / "tests/vectors/property_ids.txt").read_text().splitlines()]
        table = {f"asip-desk_{row[4]}" for row in rows}
        shown = {each["unique_id"] for each in self.home.entities().values() if each["unique_id"].startswith("asip-desk_")}
        of_pins = {unique for unique in shown if unique.startswith("asip-desk_io-")}
        self.assertEqual(shown - table - of_pins, {"asip-desk_last-error"})
        self.assertLessEqual({f"asip-desk_{each}" for each in ("distance-0", "servo-0-angle")}, shown)

    def test_ValueThatWasNeverAnnounced_IsNotShown_NorDoesACommandInFrontMoveAnId(self):
        level, speed, used = (self.entity(f"asip-gauge_distance-0-{name}", "sensor") for name in ("level", "speed", "used"))
        self.bus.gauge.say("@D,e,1,{15:2:1.5}")
        for entity, value in ((level, "15"), (speed, "fast"), (used, "1.5")):
            self.becomes(entity, value)
        self.assertEqual(self.attributes(used, "device_class", "state_class", "unit_of_measurement"),
                         ["energy", "total_increasing", "kWh"])
        self.assertEqual(self.attributes(speed, "device_class", "options"), ["enum", ["fast", "off", "slow"]])
        self.bus.gauge.say("@D,e,1,{200:7:2.5}")
        self.becomes(used, "2.5")
        self.assertNotIn(self.home.value(level), ("200",))
        self.assertNotIn(self.home.value(speed), ("7",))
        self.bus.gauge.say("@D,e,1,{16:1:3.5}")
        self.becomes(level, "16")
        self.becomes(speed, "slow")
        self.bus.end("agent-gauge")
        self.bus.start_gauge(**AIM)
        self.entity("asip-gauge_distance-at", "number")
        self.assertEqual([self.find(f"asip-gauge_distance-0-{name}") for name in ("level", "speed", "used")], [level, speed, used])

    def test_Gateway_IsADeviceOfDiagnostics_AndDevicesHaveALink(self):
        connection = self.entity("asip_gateway_connection", "binary_sensor")
        self.becomes(connection, "on")
        self.becomes(self.find("asip_gateway_boards"), "3")
        self.assertEqual(self.attributes(self.find("asip_gateway_started"), "device_class"), ["timestamp"])
        known = self.home.entities()
        self.assertEqual({each["entity_category"] for each in known.values() if each["unique_id"].startswith("asip_gateway_")},
                         {"diagnostic"})
        links = {each["name"]: each["configuration_url"] for each in self.home.ask(type="config/device_registry/list")
                 if each["manufacturer"] == "ASIP"}
        page = f"http://boards.example:{self.bus.page_port}/"
        self.assertEqual((links["ASIP gateway"], links["desk"]), (page, page + "#/board/desk"))
        self.bus.end("gateway", 9)
        self.becomes(connection, "off")
        self.bus.start_gateway()
        self.becomes(connection, "on")


if __name__ == "__main__":
    unittest.main()
