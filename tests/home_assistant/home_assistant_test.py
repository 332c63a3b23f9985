# SPDX-License-Identifier: Apache-2.0
"""Both boards of the demo in the real Home Assistant, by nothing but the gateway's option."""

import subprocess
import time
import unittest

from bus import BIN, Bus, eventually, paho_client
from export_bus import ExportBus
from home_assistant import HomeAssistant

DISTANCE = "sensor.desk_distance_0"
SERVO = "number.desk_servo_0_angle"
LAMP = "switch.lamp_status_lamp"
GATEWAY = "ASIP gateway"


class SmartBus(ExportBus):
    export = ("--home-assistant",)

    def ctl(self, *words):
        return subprocess.run([str(BIN / "asipctl"), "--broker", f"127.0.0.1:{self.broker_port}", *words], check=True,
                              capture_output=True, text=True, timeout=60).stdout

    def publish(self, topic, payload, retain=False):
        client = paho_client()
        client.connect("127.0.0.1", self.broker_port)
        client.loop_start()
        client.publish(topic, payload, qos=1, retain=retain).wait_for_publish(20)
        client.disconnect()
        client.loop_stop()


class RealHomeAssistant(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = SmartBus()
        cls.addClassCleanup(cls.bus.close)
        # A name makes a pin an entity that is not hidden, and a mode says of which kind.
        cls.bus.ctl("send", "lamp/io", "mode", "13", "output")
        cls.bus.ctl("label", "lamp", "pin.13=status lamp")
        cls.home = HomeAssistant(cls.bus.broker_port)
        cls.addClassCleanup(cls.home.close)

    def becomes(self, entity, value, seconds=30):
        try:
            eventually(lambda: self.home.value(entity) == value, entity, seconds)
        except AssertionError:
            self.fail(f"{entity} is {self.home.value(entity)}, not {value}; there are {sorted(self.home.entities())}\n{self.bus.logs()}")

    def tearDown(self):
        self.assertEqual(self.home.complaints(), [])
        known = self.home.entities()
        twice = [entity for entity in known if entity.removesuffix("_2") in known and entity.endswith("_2")]
        self.assertEqual(twice, [])

    def test_1_entities_have_names_units_classes_and_availability(self):
        self.becomes(DISTANCE, "42")
        distance = self.home.state(DISTANCE)["attributes"]
        self.assertEqual((distance["unit_of_measurement"], distance["device_class"], distance["state_class"],
                          distance["friendly_name"]), ("cm", "distance", "measurement", "desk Distance 0"))
        servo = self.home.state(SERVO)
        self.assertEqual(servo["state"], "unknown")
        self.assertEqual([servo["attributes"][key] for key in ("min", "max", "step", "unit_of_measurement")], [0, 180, 1, "°"])
        self.becomes(LAMP, "unknown")
        self.assertEqual(self.home.devices(), {GATEWAY, "desk", "lamp"})
        hidden = {entity for entity, each in self.home.entities().items() if each["disabled_by"] == "integration"}
        self.assertFalse({DISTANCE, SERVO, LAMP} & hidden)

    def test_2_state_follows_the_acknowledgement(self):
        self.home.call("number.set_value", SERVO, value=90)
        self.becomes(SERVO, "90")
        eventually(lambda: self.bus.part("desk/servo").split(".")[0] in ("89", "90", "91"), "the servo itself")
        self.bus.ctl("send", "desk/servo", "write", "0", "45")
        self.becomes(SERVO, "45")
        self.home.call("switch.turn_on", LAMP)
        self.becomes(LAMP, "on")
        eventually(lambda: self.bus.part("lamp/lamp").startswith("on"), "the lamp itself")
        self.bus.sim("set", "desk/distance", "77")
        self.becomes(DISTANCE, "77")

    def test_3_refused_command_leaves_the_state(self):
        before = self.home.value(SERVO)
        self.bus.publish("asip/export/ha/desk/servo-0-angle/set", "181")
        self.becomes("sensor.desk_last_error", "Servo 0 angle cannot be set to 181")
        self.assertEqual(self.home.value(SERVO), before)

    def test_4_lost_board_is_unavailable_until_it_is_back(self):
        self.bus.end("agent-desk", 9)
        self.becomes(DISTANCE, "unavailable")
        self.bus.start_agent("desk")
        eventually(lambda: self.home.value(DISTANCE) not in ("unavailable", None), "the board in Home Assistant", 60)

    def settled(self):
        """Until it has made no further entity for three seconds."""
        seen, since = None, time.monotonic()
        while time.monotonic() - since < 3:
            if (now := set(self.home.entities())) != seen:
                seen, since = now, time.monotonic()
            time.sleep(0.3)

    def is_called(self, entity, name):
        def name_of():
            return (self.home.state(entity) or {"attributes": {}})["attributes"].get("friendly_name")
        try:
            eventually(lambda: name_of() == name, entity)
        except AssertionError:
            self.fail(f"{entity} is called {name_of()}, not {name}")

    def test_5_renamed_things_stay_what_they_are(self):
        self.everything_is_there()
        # While it makes the entities of one document it may pass over parts of the next.
        self.settled()
        before = set(self.home.entities())
        self.rename("name=My desk", "name=left arm", "red lamp")
        for entity, name in ((SERVO, "My desk left arm 0"), (LAMP, "lamp red lamp")):
            self.is_called(entity, name)
        self.assertEqual(set(self.home.entities()), before)
        # Home Assistant makes ids out of names again when a device was gone.
        self.rename("name-", "name-", "status lamp")
        for entity, name in ((SERVO, "desk Servo 0 angle"), (LAMP, "lamp status lamp")):
            self.is_called(entity, name)
        self.assertEqual(set(self.home.entities()), before)

    def rename(self, board, servo, pin):
        self.bus.ctl("label", "desk", board)
        self.bus.ctl("label", "desk/servo", servo)
        self.bus.ctl("label", "lamp", "pin.13=" + pin)

    def everything_is_there(self):
        for entity in (DISTANCE, SERVO, LAMP):
            eventually(lambda: self.home.value(entity) not in (None, "unavailable"), f"{entity} is there again", 60)

    def test_6_restarts_in_any_order(self):
        self.home.restart()
        self.everything_is_there()
        self.bus.end("gateway", 9)
        self.becomes(DISTANCE, "unavailable")
        self.bus.start_gateway()
        self.everything_is_there()
        self.bus.end("gateway", 9)
        self.home.restart()
        self.bus.start_gateway()
        self.everything_is_there()

    def test_7_documents_that_were_deleted_come_back(self):
        for device in ("asip-desk", "asip-lamp", "asip_gateway"):
            self.bus.publish(f"homeassistant/device/{device}/config", "", retain=True)
        eventually(lambda: not self.home.devices(), "the devices are gone")
        self.home.restart()
        eventually(lambda: self.home.devices() == {GATEWAY, "desk", "lamp"}, "the devices are back", 60)
        self.everything_is_there()

    def test_8_forgotten_board_is_gone(self):
        self.bus.end("agent-lamp")
        self.becomes(LAMP, "unavailable")
        self.bus.ctl("forget", "lamp")
        eventually(lambda: self.home.devices() == {GATEWAY, "desk"}, "the device is gone", 60)

    def test_9_option_that_is_taken_away_leaves_nothing(self):
        self.bus.end("gateway")
        Bus.start_gateway(self.bus)
        eventually(lambda: not self.home.devices(), "the devices are gone", 60)


if __name__ == "__main__":
    unittest.main()
