# SPDX-License-Identifier: Apache-2.0
"""What happened, in sentences: a lamp that is switched, a robot that is driven, a board whose agent dies, and many boards that are lost at once."""

import itertools
import signal
import time
import unittest
from unittest import mock

import axe_test
from rig import DESK, LAMP, eventually, paho_client, publish_boards

VIEWS = itertools.repeat(axe_test.VIEWS)


class Sentences(axe_test.Axe):
    boards = (DESK, LAMP)

    def rows(self):
        return self.browser.run("return [...document.querySelectorAll('asip-history tbody tr')].map((row) => row.lastChild.innerText.replaceAll('\\u00a0', ' '))")

    def said(self, text, seconds=30):
        eventually(lambda: any(text in row for row in self.rows()), text, seconds)

    def show(self, board):
        """The history of a board; of all without one."""
        self.start()
        self.go(f"board/{board}" if board else "history", "asip-board summary h2" if board else "asip-history .check")
        if board:
            self.browser.run("document.querySelector('details.history').open = true")

    def send(self, *words):
        done = self.bus.asipctl("send", *words)
        self.assertEqual(done.returncode, 0, done.stderr)

    def drive(self, board, rows):
        """Commands one behind the other until the history has so many rows of them, each of a second."""
        path = f"/api/boards/{board}/history?limit=100"
        begin = time.monotonic()
        for i in itertools.count():
            self.bus.post(f"/api/boards/{board}/services/servo/commands/write", [0, 30 + i % 100])
            if i % 20 == 0 and sum(each.get("count", 1) > 1 for each in self.bus.get(path)["items"]) >= rows:
                return i + 1
            self.assertLess(time.monotonic() - begin, 60)

    @mock.patch("axe_test.NEXT", VIEWS)
    def test_LampThatIsSwitched_IsNamedAndSoIsWhoSwitchedIt(self):
        self.assertEqual(self.bus.asipctl("label", "lamp", "pin.13=LED").returncode, 0)
        self.send("lamp/io", "mode", "13", "output")
        self.send("lamp/io", "write", "13", "1")
        self.bus.post("/api/boards/desk/services/servo/commands/write", [0, 45])
        self.show("lamp")
        self.browser.run("document.querySelector('asip-history .check input').click()")
        self.said("LED on, by ")
        self.bus.end("agent-lamp", signal.SIGKILL)
        self.addCleanup(self.bus.start_agent, "lamp")
        self.said("Lost: its agent died or lost the broker")
        self.check("history-lamp")
        self.show("")
        self.said("Servo 0 to 45°, by this machine")

    @mock.patch("axe_test.NEXT", VIEWS)
    def test_RobotThatIsDriven_DoesNotFillThePageOfItsBoard(self):
        count = self.drive("desk", 6)
        self.show("desk")
        eventually(lambda: any("commands, by this machine, since" in row for row in self.rows()), "one row")
        row = next(row for row in self.rows() if "commands, by this machine" in row)
        self.assertGreater(int(row.split()[0].replace(",", "")), count // 2)
        folded = len(self.rows())
        self.said("Online")
        self.check("history-robot")
        self.browser.run("document.querySelector('asip-history .check input').click()")
        eventually(lambda: len(self.rows()) > folded + 3, "each command")
        self.said("Servo 0 to ")
        self.browser.run("document.querySelector('asip-history .check input').click()")
        eventually(lambda: len(self.rows()) <= folded + 1, "folded again")

    @mock.patch("axe_test.NEXT", VIEWS)
    def test_ManyBoardsLostAtOnce_AreOneRowAndInGermanToo(self):
        publish_boards(self.bus, 300)
        client = paho_client()
        client.connect("127.0.0.1", self.bus.broker_port)
        client.loop_start()
        for i in range(300):
            last = client.publish(f"asip/servicebus/board{i}/$state", "lost", qos=1, retain=False)
        last.wait_for_publish(60)
        client.disconnect()
        client.loop_stop()
        self.show("")
        lost = lambda: self.browser.run("return [...document.querySelectorAll('asip-history tbody tr')].map((row) => row.innerText).filter((text) => text.includes('300 boards') && text.includes('Lost'))")
        eventually(lambda: len(lost()) == 1, "one row of all", 40)
        self.assertRegex(lost()[0], r"board\d+, board\d+, board\d+ and 297 more")
        self.check("history-lost")
        self.addCleanup(lambda: self.browser.run("localStorage.removeItem('asip-language')"))
        self.browser.run("localStorage.setItem('asip-language', 'de')")
        self.show("")
        eventually(lambda: "300 Boards" in self.browser.text("asip-history") and "und 297 weitere" in self.browser.text("asip-history"), "in German")
        self.check("history-lost-de")


if __name__ == "__main__":
    unittest.main()
