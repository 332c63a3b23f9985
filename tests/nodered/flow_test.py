# SPDX-License-Identifier: Apache-2.0
"""The flow of docs/plain-mqtt.md, imported into a real Node-RED: the button switches the LED, distances and what the
board refuses appear in the debug panel."""

import json
import re
import subprocess
import unittest

from bus import BUILD, DESK, ROOT, Bus, eventually, free_port

NODE_RED = BUILD / "node-red" / "node_modules" / "node-red" / "red.js"
SETTINGS = """module.exports = {{ uiPort: {port}, uiHost: "127.0.0.1", flowFile: "flow.json", credentialSecret: false,
    telemetry: {{ enabled: false }}, logging: {{ console: {{ level: "info" }} }} }};"""


def documented_flow():
    text = (ROOT / "docs" / "plain-mqtt.md").read_text()
    return json.loads(re.search(r"### Node-RED.*?```json\n(.*?)```", text, re.DOTALL)[1])


class Flow(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = Bus(({**DESK, "name": "uno1", "link": "uno1.port"},))
        cls.addClassCleanup(cls.bus.close)
        flow = documented_flow()
        for node in flow:
            if node["type"] == "mqtt-broker":
                node["port"] = str(cls.bus.broker_port)
            if node["type"] == "debug":
                node["console"] = True  # where the test can read it
        (cls.bus.work / "flow.json").write_text(json.dumps(flow))
        (cls.bus.work / "settings.js").write_text(SETTINGS.format(port=free_port()))
        cls.bus.start("node-red", "/usr/bin/env", "node", str(NODE_RED), "--userDir", str(cls.bus.work), "--settings",
                      str(cls.bus.work / "settings.js"))
        eventually(lambda: "Started flows" in cls.log(), "Node-RED's start", 120)

    @classmethod
    def log(cls):
        return (cls.bus.work / "node-red.log").read_text(errors="replace")

    def setUp(self):
        self.addCleanup(lambda: self._outcome.success or print(self.bus.logs()))

    def test_button_switches_the_led(self):
        self.distance_comes()  # it is asked for behind the pins' modes
        self.bus.sim("press", "uno1/button")
        eventually(lambda: self.bus.part("uno1/led") == "on", "the LED lit by the button")
        self.bus.sim("release", "uno1/button")
        eventually(lambda: self.bus.part("uno1/led") == "off", "the LED out")

    def test_distance_is_shown(self):
        self.distance_comes()

    def distance_comes(self):
        eventually(lambda: re.search(r"distance: \[ 42, 0 \]", self.log()), "a distance in the debug panel")

    def test_what_the_board_refuses_is_shown(self):
        self.assertNotRegex(self.log(), r"status: '(error|refused)'")
        self.ask("asip/uno1/io/in", {"write": [0, 1]})
        eventually(lambda: re.search(r"status: '(error|refused)'", self.log()), "the board's refusal in the debug panel")

    def ask(self, topic, command):
        """As the flow's own nodes ask, with the flow's place for answers."""
        subprocess.run(["mosquitto_pub", "-V", "5", "-p", str(self.bus.broker_port), "-q", "1", "-t", topic, "-m", json.dumps(command),
                        "-D", "PUBLISH", "response-topic", "asip/reply/node-red", "-D", "PUBLISH", "correlation-data", "refused"],
                       check=True, timeout=30)


if __name__ == "__main__":
    unittest.main()
