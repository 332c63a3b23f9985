# SPDX-License-Identifier: Apache-2.0
"""Simulated boards as Homie devices, controlled by node-homie."""

import os
import pathlib
import signal
import unittest
import urllib.request

from bus import eventually
from export_bus import ExportBus, Peer

MODULES = os.environ["ASIP_NODE_HOMIE"]
SERVO = ["desk", "servo", "servo-0-angle"]
DISTANCE = ["desk", "distance", "distance-0"]


class HomieBus(ExportBus):
    export = ("--homie",)


def controller(broker):
    return Peer(pathlib.Path(__file__).with_name("control.cjs"), MODULES, broker)


class HomieDevices(unittest.TestCase):
    def setUp(self):
        self.bus = HomieBus()
        self.addCleanup(self.bus.close)
        self.home = controller(f"mqtt://127.0.0.1:{self.bus.broker_port}")
        self.addCleanup(self.home.close)
        self.states({"asip": "ready", "desk": "ready", "lamp": "ready"})

    def states(self, wanted, seconds=40):
        try:
            eventually(lambda: self.home("devices") == wanted, f"devices {wanted}", seconds)
        except AssertionError:
            self.fail(f"{self.home('devices')} instead of {wanted}\n{self.bus.logs()}")

    def value(self, which, value):
        try:
            eventually(lambda: (self.home("get", which) or {}).get("value") == value, f"{which} is {value}", 30)
        except AssertionError:
            self.fail(f"{self.home('get', which)} instead of {value}\n{self.bus.logs()}")

    def test_Board_IsReadAndSet_AndItsValueFollowsItsProof(self):
        self.value(DISTANCE, "42")
        for angle in ("30", "120"):
            self.home("set", SERVO + [angle])
            self.value(SERVO, angle)
            self.assertEqual(self.home("get", SERVO)["target"], angle)
        self.home("publish", ["homie/5/desk/servo/servo-0-angle/set", "181"])
        eventually(lambda: self.home("log"), "the log of what failed")
        self.assertEqual(self.home("log")[0]["level"], "error")
        self.assertIn("cannot be set to 181", self.home("log")[0]["message"])
        self.value(SERVO, "120")
        self.assertEqual(self.home("faults"), [])

    def test_BoardAndGatewayThatAreGone_AreSaidToBe(self):
        self.bus.end("agent-lamp", signal.SIGKILL)
        self.states({"asip": "ready", "desk": "ready", "lamp": "lost"})
        self.bus.start_agent("lamp")
        self.states({"asip": "ready", "desk": "ready", "lamp": "ready"})
        # Children share the state of their root.
        self.bus.end("gateway", signal.SIGKILL)
        self.states({"asip": "lost", "desk": "lost", "lamp": "lost"})
        self.bus.start_gateway()
        self.states({"asip": "ready", "desk": "ready", "lamp": "ready"})
        self.assertEqual(self.home("faults"), [])

    def test_BoardThatIsForgotten_AndOptionThatIsTakenAway_LeaveNothing(self):
        self.bus.end("agent-lamp")
        self.states({"asip": "ready", "desk": "ready", "lamp": "disconnected"})
        urllib.request.urlopen(urllib.request.Request(self.bus.url + "/api/boards/lamp", method="DELETE"), timeout=30)
        self.states({"asip": "ready", "desk": "ready"})
        eventually(lambda: not [topic for topic in self.home("topics") if "/lamp/" in topic], "nothing of the lamp")
        self.bus.end("gateway")
        self.bus.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.bus.http_port}")
        self.states({})
        eventually(lambda: self.home("topics") == [], "nothing retained")


if __name__ == "__main__":
    unittest.main()
