# SPDX-License-Identifier: Apache-2.0
"""Home Assistant on a bus that `asipctl secure` made, with the credentials of its role and no others."""

import os
import pwd
import shutil
import subprocess
import unittest

from bus import BIN, Bus, can_connect, eventually
from home_assistant import HomeAssistant

DISTANCE = "sensor.desk_distance_0"
SERVO = "number.desk_servo_0_angle"
NO_VALUE = (None, "unavailable", "unknown")


class SecuredBus(Bus):
    def secure(self, *words):
        return subprocess.run([str(BIN / "asipctl"), "secure", "--dir", str(self.work / "bus"), *words], check=True,
                              capture_output=True, text=True, timeout=60).stdout

    def credentials(self, name):
        return self.work / "bus" / "credentials" / f"{name}.credentials"

    def start_broker(self):
        system = self.work / "system"
        system.mkdir()
        self.secure("init", "--yes", "--host", "127.0.0.1", "--port", str(self.broker_port), "--mosquitto", str(system))
        self.secure("add", "board", "desk", "lamp")
        for role in ("registry", "gateway", "home-assistant"):
            self.secure("add", role)
        config = system / "asip-secured.conf"
        # Started by root the broker becomes another user, for whom this folder is closed.
        with open(config, "a") as file:
            file.write(f"user {pwd.getpwuid(os.getuid()).pw_name}\npersistence_location {system}/\n")
        program = shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin")
        self.start("broker", program, "-c", str(config))
        eventually(lambda: can_connect(self.broker_port), "the broker's port")

    def start(self, name, program, *arguments):
        if name == "registry":
            arguments += ("--credentials", str(self.credentials("registry")))
        super().start(name, program, *arguments)

    def start_gateway(self):
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", "--credentials",
                   str(self.credentials("gateway")), "--home-assistant")
        eventually(lambda: self.get("/readyz"), "the gateway")

    def start_agent(self, board):
        port = self.work / f"{board}.port"
        eventually(port.exists, f"the port of {board}")
        self.start(f"agent-{board}", "asip-agent", "--serial", str(port), "--name", board, "--no-step-up", "--patience", "60",
                   "--reports", "on-demand", "--credentials", str(self.credentials(board)))


class Secured(unittest.TestCase):
    def test_role_of_home_assistant_is_enough(self):
        bus = SecuredBus()
        self.addCleanup(bus.close)
        text = bus.credentials("home-assistant").read_text()
        said = dict(line.split(" = ", 1) for line in text.splitlines() if " = " in line)
        home = HomeAssistant(bus.broker_port, said["user"], said["password"], text[text.index("-----BEGIN"):])
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
