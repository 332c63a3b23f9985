# SPDX-License-Identifier: Apache-2.0
"""Simulated boards as Sparkplug devices, read and commanded by a host made of Eclipse Tahu's JavaScript payload library."""

import os
import pathlib
import signal
import unittest
import urllib.request

from bus import eventually
from devices import DISTANCE, SERVO, HostTest
from export_bus import ExportBus, Peer

MODULES = os.environ["ASIP_SPARKPLUG_JS"]


class SparkplugBus(ExportBus):
    export = ("--sparkplug", "plant")


class SparkplugDevices(HostTest):
    def setUp(self):
        self.bus = SparkplugBus()
        self.addCleanup(self.bus.close)
        self.host = Peer(pathlib.Path(__file__).with_name("host.cjs"), MODULES, f"mqtt://127.0.0.1:{self.bus.broker_port}")
        self.addCleanup(self.host.close)
        self.host("rebirth")  # it may have come behind the births
        self.devices("desk", "lamp")

    def explained(self):
        return f"{self.seen()} {self.host('faults')}"

    def test_BoardIsReadAndSet_AndItsMetricFollowsItsProof(self):
        self.value(DISTANCE, 42)
        self.assertEqual(self.host("get", DISTANCE)["properties"]["engUnit"], "cm")
        self.assertEqual(self.host("get", SERVO)["value"], None)
        for angle in (30, 120):
            self.host("command", SERVO + ["Int64", angle])
            self.value(SERVO, angle)
        eventually(lambda: "120" in self.bus.part("desk/servo"), "a pulse of the new length")
        self.host("command", SERVO + ["Int32", 181])
        self.until(lambda: self.host("get", SERVO)["properties"].get("Quality") == 0, "bad quality")
        self.assertIn("cannot be set to 181", self.host("get", SERVO)["properties"]["error"])
        self.assertEqual(self.host("get", SERVO)["value"], 120)
        self.host("command", SERVO + ["Double", 60])
        self.value(SERVO, 60)
        self.until(lambda: self.host("get", SERVO)["properties"].get("Quality") == 192, "good quality")
        self.assertEqual(self.host("faults"), [])

    def test_WhatIsNoPayload_IsDropped_AndTheNextCommandWorks(self):
        for text in ("90", "{}", "\x12\x7f", "x" * 300_000):
            self.host("publish", ["spBv1.0/plant/DCMD/asip/desk", text])
            self.host("publish", ["spBv1.0/plant/NCMD/asip", text])
        self.host("command", SERVO + ["Int64", 77])
        self.value(SERVO, 77)
        self.assertIn("is dropped", (self.bus.work / "gateway.log").read_text())

    def test_BoardAndGatewayThatAreGone_Die_AndAreBornAgain_WithTheNextNumber(self):
        first = self.seen()["bdSeqs"][-1]
        self.bus.end("agent-lamp", signal.SIGKILL)
        self.devices("desk")
        self.bus.start_agent("lamp")
        self.devices("desk", "lamp")
        self.bus.end("gateway", signal.SIGKILL)
        self.until(lambda: not self.seen()["node"], "death by its will")
        self.assertEqual(self.seen()["deaths"], [first])
        self.bus.start_gateway()
        self.devices("desk", "lamp")
        self.assertEqual(self.seen()["bdSeqs"][-1], (first + 1) % 256)
        self.bus.end("gateway")
        self.until(lambda: self.seen()["deaths"] == [first, (first + 1) % 256], "death of a gateway that ends")
        self.bus.start_gateway()
        self.devices("desk", "lamp")
        # A broker that is killed publishes no will.
        self.bus.end("broker", signal.SIGKILL)
        self.bus.start_broker()
        # A host that comes behind the births asks for them.
        self.until(lambda: self.host("rebirth") and self.seen()["bdSeqs"][-1] == (first + 3) % 256, "the births of the next connection", 60)
        self.devices("desk", "lamp")
        self.assertEqual(self.host("faults"), [])

    def test_BoardThatIsForgotten_AndOptionThatIsTakenAway_LeaveNothing(self):
        self.bus.end("agent-lamp")
        self.devices("desk")
        urllib.request.urlopen(urllib.request.Request(self.bus.url + "/api/boards/lamp", method="DELETE"), timeout=30)
        self.bus.end("gateway")
        self.until(lambda: not self.seen()["node"], "death")
        self.bus.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.bus.http_port}")
        eventually(lambda: self.bus.get("/readyz"), "the gateway")
        self.bus.end("gateway")
        self.bus.start("clean", "asip-gateway", "clean", "sparkplug")
        self.assertEqual(self.bus.programs.pop("clean").wait(30), 0, self.bus.logs())


if __name__ == "__main__":
    unittest.main()
