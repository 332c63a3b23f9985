"""The table of boards: appears, changes, is searched, and stays quick with ten thousand boards."""

import time
import unittest

import paho.mqtt.client as mqtt
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from rig import PageTest, eventually, publish_boards

MANY = 10_000


class Boards(PageTest):
    def rows(self):
        return {row.find_element(By.TAG_NAME, "a").text: row.text for row in self.browser.find(".filler .row:not([hidden])")}

    def row_has(self, board, text, seconds=20):
        eventually(lambda: text in self.rows().get(board, ""), f"{board} {text}", seconds)

    def test_PageOpened_ShowsBothBoardsWithTheirServices(self):
        self.open()
        self.row_has("desk", "online")
        self.row_has("lamp", "online")
        for service in ("io", "distance", "servo"):
            self.assertIn(service, self.rows()["desk"])
        self.assertIn("2 boards", self.browser.text(".found"))
        self.assertEqual(self.browser.text("asip-link"), "live")
        self.browser.screenshot("boards")

    def test_AgentKilledAndBack_BoardGoesAndAppearsWithoutReload(self):
        self.open()
        self.row_has("lamp", "online")
        self.browser.run("window.same_page = true")
        self.bus.end("agent-lamp")
        self.row_has("lamp", "offline")
        self.bus.start_agent("lamp")
        self.row_has("lamp", "online")
        self.assertTrue(self.browser.run("return window.same_page"))

    def test_SearchAndFilters_ShowOnlyWhatFits(self):
        self.open()
        self.row_has("lamp", "online")
        search = self.browser.shown("input[type=search]")
        search.send_keys("distance")
        eventually(lambda: list(self.rows()) == ["desk"], "only desk")
        self.assertIn("1 of 2 boards", self.browser.text(".found"))
        search.clear()
        search.send_keys("nothing like it")
        eventually(lambda: "No board fits" in self.browser.text(), "the sentence")
        search.send_keys(Keys.CONTROL, "a")
        search.send_keys(Keys.DELETE)
        eventually(lambda: len(self.rows()) == 2, "both boards")
        self.browser.run("const kind = document.querySelector('.toolbar select'); kind.value = 'servo'; kind.dispatchEvent(new Event('change'))")
        eventually(lambda: list(self.rows()) == ["desk"], "only the board with a servo")

    def test_Nothing_IsSentWhenPagesAreOpened(self):
        heard = []
        client = mqtt.Client()
        client.on_message = lambda _client, _data, message: heard.append(message.topic)
        client.connect("127.0.0.1", self.bus.broker_port)
        client.subscribe([("asip/+/in", 0), ("asip/+/+/in", 0), ("asip/+/$stop", 0)])
        client.loop_start()
        for route in ("", "board/desk", "board/lamp", "history", "bus"):
            self.open(route)
            self.browser.shown("main > *")
        self.open_board("desk")
        client.disconnect()
        client.loop_stop()
        self.assertEqual(heard, [])


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
        eventually(lambda: any("B4" in row.text and "S1" in row.text for row in self.browser.find(".filler .row")), "B4 with S1")
        self.open("board/B4")
        eventually(lambda: "S1" in self.browser.text() and "names only" in self.browser.text(), "its page")
        client.publish("asip/B4/S1/out", "17", qos=1).wait_for_publish()
        client.disconnect()
        client.loop_stop()

    def test_TenThousandBoards_AreThereSoonAndScrollSmoothly(self):
        browser = self.browser
        began = time.monotonic()
        self.open()
        browser.shown("asip-boards .table-box")
        painted = browser.run("return performance.getEntriesByName('first-contentful-paint')[0]?.startTime")
        total = f"{self.bus.get('/api/status')['mirror']['boards']:,}"
        eventually(lambda: f"{total} boards" in browser.text(".found"), "all boards in the table")
        complete = time.monotonic() - began
        self.assertLess(len(browser.find(".filler .row")), 80, "only what is seen may be drawn")
        rate = browser.scroll_rate()
        print(f"10,000 boards: first paint {painted:.0f} ms, all there {complete:.1f} s, scrolling {rate:.0f} frames a second")
        browser.run("document.querySelector('.scroll').scrollTop = 1e9")
        eventually(lambda: any(e.text == "board9999" for e in browser.find(".filler .row a")), "the last board")
        search = browser.shown("input[type=search]")
        search.send_keys("board777")
        eventually(lambda: f"11 of {total}" in browser.text(".found"), "eleven boards that fit")
        browser.screenshot("ten-thousand-boards")


if __name__ == "__main__":
    unittest.main()
