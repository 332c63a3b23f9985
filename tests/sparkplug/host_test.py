# SPDX-License-Identifier: Apache-2.0
"""Simulated boards as Sparkplug devices, followed and commanded by the host application of Eclipse Tahu, which is the primary host."""

import os
import pathlib
import signal
import time
import unittest

from bus import eventually, settings_file
from devices import DISTANCE, SERVO, HostTest
from export_bus import ExportBus, Peer

JARS = os.environ["ASIP_SPARKPLUG_JARS"]


class HostedBus(ExportBus):
    export = ("--sparkplug", "plant", "--config", settings_file("sparkplug-host = scada\nexport-hz = 50\n"))


class SparkplugHost(HostTest):
    patience = 60

    def setUp(self):
        self.bus = HostedBus()
        self.addCleanup(self.bus.close)
        self.start_host()
        self.addCleanup(lambda: self.host.close())
        self.devices("desk", "lamp")

    def start_host(self):
        self.host = Peer(pathlib.Path(__file__).with_name("Host.java"), f"tcp://127.0.0.1:{self.bus.broker_port}", "scada",
                         program=("java", "-cp", JARS + "/*"))

    def test_BirthsDataAndCommand_InOrder_ThroughSixHundredMessages(self):
        self.value(DISTANCE, 42.0)
        self.assertEqual(self.host("get", DISTANCE)["property engUnit"], "cm")
        self.assertIsNone(self.host("get", SERVO)["value"])
        births = self.seen()["bdSeqs"]
        # A message that is lost or has a wrong number makes the host ask for births.
        for i in range(620):
            self.host("command", SERVO + ["Int64", i % 180])
            self.value(SERVO, i % 180)
        self.assertGreater(self.seen()["messages"], 600)
        self.assertEqual(self.seen()["bdSeqs"], births)
        self.host("command", SERVO + ["Int64", 181])
        self.until(lambda: self.host("get", SERVO).get("property Quality") == 0, "bad quality")
        self.assertIn("cannot be set to 181", self.host("get", SERVO)["property error"])
        self.assertEqual(self.host("get", SERVO)["value"], 619 % 180)
        self.host("rebirth")
        self.until(lambda: self.seen()["bdSeqs"] == births + births[-1:], "births that it asked for")
        self.devices("desk", "lamp")
        self.value(SERVO, 619 % 180)

    def test_BoardGatewayAndBrokerThatAreGone_AreSeenToBe(self):
        first = self.seen()["bdSeqs"][-1]
        self.bus.end("agent-lamp", signal.SIGKILL)
        self.devices("desk")
        self.bus.start_agent("lamp")
        self.devices("desk", "lamp")
        self.assertEqual(self.seen()["bdSeqs"], [first], "births that the host had to ask for")
        self.bus.end("gateway", signal.SIGKILL)
        self.until(lambda: not self.seen()["node"], "death by its will")
        self.assertEqual(self.seen()["deaths"], [first])
        self.assertGreater(self.seen()["stale"], 0)
        self.bus.start_gateway()
        self.devices("desk", "lamp")
        self.assertEqual(self.seen()["bdSeqs"][-1], (first + 1) % 256)
        self.bus.end("broker", signal.SIGKILL)
        self.bus.start_broker()
        self.until(lambda: self.seen()["bdSeqs"][-1] > (first + 1) % 256, "births of the next connection", 120)
        self.devices("desk", "lamp")
        self.value(DISTANCE, 42.0)

    def test_HostThatIsGone_IsWaitedFor(self):
        self.host("shutdown")
        self.host.close()
        eventually(lambda: "scada is gone" in (self.bus.work / "gateway.log").read_text(), "the end of the session", 60)
        time.sleep(1)  # the next host is later than the last
        self.start_host()
        self.devices("desk", "lamp")
        self.value(DISTANCE, 42.0)


if __name__ == "__main__":
    unittest.main()
