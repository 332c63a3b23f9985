# SPDX-License-Identifier: Apache-2.0
"""Home Assistant on a bus that `asipctl secure` made, with the credentials of its role and no others."""

import unittest

from bus import eventually
from home_assistant import HomeAssistant
from secured_bus import SecuredBus

DISTANCE = "sensor.desk_distance_0"
SERVO = "number.desk_servo_0_angle"
NO_VALUE = (None, "unavailable", "unknown")


class HomeBus(SecuredBus):
    users = (*SecuredBus.users, ("home-assistant",))

    def start_gateway(self):
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", "--home-assistant")
        eventually(lambda: self.get("/readyz"), "the gateway")

    def start_agent(self, board):
        port = self.work / f"{board}.port"
        eventually(port.exists, f"the port of {board}")
        self.start(f"agent-{board}", "asip-agent", "--serial", str(port), "--name", board, "--no-step-up", "--patience", "60",
                   "--reports", "on-demand")


class Secured(unittest.TestCase):
    def test_role_of_home_assistant_is_enough(self):
        bus = HomeBus()
        self.addCleanup(bus.close)
        home = HomeAssistant(bus.broker_port, *bus.user("home-assistant"))
        self.addCleanup(home.close)

        eventually(lambda: home.value(DISTANCE) not in NO_VALUE, "a distance", 60)
        home.call("number.set_value", SERVO, value=77)
        eventually(lambda: home.value(SERVO) in ("77", "77.0"), "the servo's angle", 30)
        bus.end("gateway")
        eventually(lambda: home.value(DISTANCE) == "unavailable", "the gateway's absence", 30)
        bus.start_gateway()
        eventually(lambda: home.value(DISTANCE) not in NO_VALUE, "the gateway's return", 60)
        self.assertEqual(home.complaints(), [])


if __name__ == "__main__":
    unittest.main()
