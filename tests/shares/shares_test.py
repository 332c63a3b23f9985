# SPDX-License-Identifier: Apache-2.0
"""Complete: whatever topic a user may write, and whatever resource a gateway has, has rows. Few: some floods on a small bus, after which
every program lives and answers; how long others waited is measured by shares.py, on a machine that does nothing else."""

import json
import re
import subprocess
import unittest
import urllib.request

import rows
import shares
from bus import ROOT, die_with_parent, eventually, free_port, program_path

NAME = {"home-assistant": "Home Assistant"}


def writers():
    """By topic the roles that may write it: the table of the access rules, which a test of asipctl keeps true."""
    table = re.search(r"^\| topic \|.*?(?=^<!-- end)", (ROOT / "SECURITY.md").read_text(), re.M | re.S)[0].splitlines()
    columns = [cell.strip() for cell in table[0].split("|")]
    found = {}
    for row in table[2:]:
        cells = [cell.strip() for cell in row.split("|")]
        may = {role for role in rows.USERS if "write" in cells[columns.index(NAME.get(role, role))]}
        found.update({topic: may for topic in re.findall(r"`([^`]+)`", cells[1]) if may})
    return found


class Complete(unittest.TestCase):
    def test_EachTopicThatAUserMayWrite_HasRows(self):
        found = writers()
        self.assertGreater(len(found), 20)
        self.assertEqual(set(rows.TOPICS), set(found))
        for topic, (role, _, _) in rows.TOPICS.items():
            self.assertIn(role, found[topic], topic)

    def test_EachResourceOfAGateway_HasRows(self):
        port = free_port()
        gateway = subprocess.Popen([str(program_path("asip-gateway")), "--http", f"127.0.0.1:{port}", "--broker", f"127.0.0.1:{free_port()}",
                                    "--log-level", "off"], preexec_fn=die_with_parent)
        self.addCleanup(gateway.wait)
        self.addCleanup(gateway.terminate)
        with eventually(lambda: urllib.request.urlopen(f"http://127.0.0.1:{port}/api/openapi.json", timeout=20), "OpenAPI") as answer:
            paths = json.load(answer)["paths"]
        there = {f"{method.upper()} {path}" for path, methods in paths.items() for method in methods if method != "parameters"}
        self.assertEqual(set(rows.RESOURCES), there)


class Few(unittest.TestCase):
    ROWS = (("topic", "servicebus/$probe", "viewer", "large"), ("topic", "servicebus/BOARD/$description", "board", "costly"),
            ("topic", "BOARD/SERVICE/in", "operator", "costly"), ("topic", "BOARD/$values", "board", "costly"),
            ("topic", "BOARD/$link/USER/CLIENT", "operator", "costly"), ("topic", "registry/query", "viewer", "costly"),
            ("topic", "servicebus/BOARD/$state", "board", "many"), ("http", "POST /api/stop", "operator", "many"),
            ("http", "GET /{nothing}", "viewer", "many"), ("http", "GET /metrics", "viewer", "costly"), ("broker", "subscribe", "viewer", "many"))

    def test_AfterAFlood_EverybodyIsAnswered(self):
        bus = shares.SharedBus(100)
        self.addCleanup(bus.close)
        askers = shares.start_askers(bus)
        for row in self.ROWS:
            with self.subTest(row):
                figures = shares.measure(bus, askers, row, 0.5)
                print(shares.line(figures))
                self.assertEqual(figures["gone"], [])
                self.assertGreater(figures["sent"], 0)
                self.assertEqual(set(figures["after"]), set(askers), figures)
                self.assertNotIn("no answer", figures["said"]["stop"] + figures["said"]["stop-http"], figures)
                self.assertLess(max(figures["memory"].values()), shares.SHARE)


if __name__ == "__main__":
    unittest.main()
