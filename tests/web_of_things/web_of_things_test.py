# SPDX-License-Identifier: Apache-2.0
"""Simulated boards as things, consumed by node-wot by nothing but their Thing Descriptions."""

import os
import pathlib
import threading
import unittest
import urllib.error
import urllib.request

from bus import DESK, IMAGES, eventually
from export_bus import ExportBus, Peer

MODULES = os.environ["ASIP_NODE_WOT"]
ROVER = {"name": "rover", "board": "uno", "image": str(IMAGES / "asip_uno_robot.elf"), "link": "rover.port", "parts": []}


class Things(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = ExportBus(boards=(DESK, ROVER))
        cls.addClassCleanup(cls.bus.close)
        cls.desk, cls.rover = (f"{cls.bus.url}/things/{name}" for name in ("desk", "rover"))

    def consumer(self):
        made = Peer(pathlib.Path(__file__).with_name("consume.cjs"), MODULES)
        self.addCleanup(made.close)
        return made

    def test_Descriptions_PassTheSchemaOfTheW3C(self):
        consumer = self.consumer()
        for address in (self.desk, self.rover, self.bus.url + "/.well-known/wot"):
            self.assertEqual(consumer("validate", address), [], address)
        self.assertEqual([thing["title"] for thing in self.bus.get("/things")], ["desk", "rover"])
        urn = self.bus.get("/things/desk")["id"]
        self.assertEqual(self.bus.get("/things/" + urn)["id"], urn)

    def test_Consumer_ReadsWritesObservesInvokes(self):
        consumer = self.consumer()
        eventually(lambda: consumer("read", [self.desk, "distance-0"]) == 42, "a distance")
        self.assertEqual(len(consumer("observe", [self.desk, "distance-0", 1])), 1)
        for angle in (30, 120):
            consumer("write", [self.desk, "servo-0-angle", angle])
            eventually(lambda: consumer("read", [self.desk, "servo-0-angle"]) == angle, f"the servo at {angle}")
        self.assertEqual(consumer("read", [self.desk, "board-state"]), "online")
        self.assertEqual(consumer("invoke", [self.rover, "motors-stop"]), "invoked")
        # Refused with a status where it cannot be executed.
        consumer("write", [self.desk, "servo-0-angle", 77])
        eventually(lambda: "77" in self.bus.part("desk/servo"), "a pulse of the new length")  # one comes each 20 ms
        eventually(lambda: consumer("read", [self.desk, "servo-0-angle"]) == 77, "the servo at 77")
        with self.assertRaisesRegex(RuntimeError, "Bad Request"):
            consumer("write", [self.desk, "servo-0-angle", 181])
        self.assertEqual(consumer("read", [self.desk, "servo-0-angle"]), 77)
        values = self.bus.get("/things/desk/properties")
        self.assertEqual((values["servo-0-angle"], values["board-state"]), (77, "online"))

    def test_ThingThatIsForgotten_IsGone_AndSaidSo(self):
        events = []
        stream = urllib.request.urlopen(self.bus.url + "/events/thing_deleted", timeout=60)

        def follow():
            for line in stream:
                events.append(line)
                if b"urn:asip:asip:rover" in line:
                    break
            stream.close()
        reader = threading.Thread(target=follow, daemon=True)
        reader.start()
        self.addCleanup(reader.join, 20)
        self.bus.end("agent-rover")
        eventually(lambda: self.bus.state("rover") == "offline", "the rover offline")
        self.assertEqual(self.bus.get("/things/rover/properties/board-state"), "offline")
        urllib.request.urlopen(urllib.request.Request(self.bus.url + "/api/boards/rover", method="DELETE"), timeout=30)
        eventually(lambda: any(b"urn:asip:asip:rover" in line for line in events), "the event")
        with self.assertRaises(urllib.error.HTTPError) as gone:
            self.bus.get("/things/rover")
        self.assertEqual(gone.exception.code, 404)
        gone.exception.close()
        self.bus.start_agent("rover")
        eventually(lambda: self.bus.state("rover") == "online", "the rover back", 60)


if __name__ == "__main__":
    unittest.main()
