# SPDX-License-Identifier: Apache-2.0
"""Ten thousand boards in the table: it stays quick."""

import re
import time
import unittest

import paho.mqtt.client as mqtt

from rig import PageTest, eventually, publish_boards

MANY = 10_000


class ManyBoards(PageTest):
    boards = ()

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        publish_boards(cls.bus, MANY)

    def test_BoardThatOnlyPublishesNames_IsABoardLikeAnyOther(self):
        client = mqtt.Client()
        client.connect("127.0.0.1", self.bus.broker_port)
        client.loop_start()
        client.publish("asip/servicebus", "B4", qos=1).wait_for_publish()
        client.publish("asip/servicebus/B4", "S1", qos=1).wait_for_publish()
        self.open()
        eventually(lambda: "S1" in self.browser.table().get("B4", ""), "B4 with S1")
        self.open("board/B4")
        eventually(lambda: "S1" in self.browser.text() and "names only" in self.browser.text(), "its page")
        client.publish("asip/B4/S1/out", "17", qos=1).wait_for_publish()
        client.disconnect()
        client.loop_stop()

    def test_ThousandBoardsThatAreTicked_AreStoppedByOneRequest(self):
        self.open(anew=True)
        self.browser.shown("input[type=search]").send_keys("board1")
        found = eventually(lambda: re.match(r"(1,\d\d\d) of ", self.browser.text(".found")), "more than a thousand boards")[1]
        self.browser.shown("input[aria-label='Select all that are shown']").click()
        eventually(lambda: f"{found} boards selected" in self.browser.text("asip-selection"), "all are selected")
        self.browser.button("Stop", "asip-selection").click()
        # They have no agents, so each is told to give no proof.
        eventually(lambda: f"Done on 0 of {found.replace(',', '')} boards" in self.browser.text("asip-selection output"), "the answer", 60)
        asked = self.browser.run("return performance.getEntriesByType('resource').map((each) => each.name)")
        self.assertEqual([each for each in asked if each.endswith("/stop")], [f"{self.bus.url}/api/stop"])

    def test_TenThousandBoards_AreThereSoonAndScrollSmoothly(self):
        browser = self.browser
        began = time.monotonic()
        self.open(anew=True)
        browser.shown("asip-boards .table-box")
        painted = browser.run("return performance.getEntriesByName('first-contentful-paint')[0]?.startTime")
        total = f"{self.bus.get('/api/status')['mirror']['boards']:,}"
        eventually(lambda: f"{total} boards" in browser.text(".found"), "all boards in the table")
        complete = time.monotonic() - began
        self.assertLess(len(browser.find(".filler .row")), 80, "only what is seen may be drawn")
        left = "return [...arguments[0].querySelectorAll('[class^=c-]')].map((each) => each.getBoundingClientRect().left)"
        self.assertEqual(browser.run(left, browser.shown(".row.head")), browser.run(left, browser.shown(".filler .row")), "heads stand above their columns")
        rate = browser.scroll_rate()
        print(f"10,000 boards: first paint {painted:.0f} ms, all there {complete:.1f} s, scrolling {rate:.0f} frames a second")
        browser.run("document.querySelector('.scroll').scrollTop = 1e9")
        eventually(lambda: "board9999" in browser.table(), "the last board")
        search = browser.shown("input[type=search]")
        search.send_keys("board777")
        eventually(lambda: f"11 of {total}" in browser.text(".found"), "eleven boards that fit")
        browser.screenshot("ten-thousand-boards")


if __name__ == "__main__":
    unittest.main()
