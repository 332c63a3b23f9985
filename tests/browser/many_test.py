# SPDX-License-Identifier: Apache-2.0
"""Ten thousand boards in the table: it stays quick."""

import re
import time
import unittest

import paho.mqtt.client as mqtt

from rig import PageTest, eventually, publish_boards

MANY = 10_000

# The table is scrolled by a row, as long as `ms` and each 20 ms: {old: rows that stay in sight and were changed meanwhile, asked: requests for the
# properties of boards, pause: the longest time between two steps}.
SCROLLED = """
const [ms, done] = arguments;
const scroll = document.querySelector('.scroll'), rows = new Set(), old = new Set();
performance.clearResourceTimings();
const watch = new MutationObserver((records) => {
  const fresh = new Set(records.filter((each) => each.attributeName === 'aria-rowindex').map((each) => each.target));
  for (const { target } of records) {
    const row = (target.closest ? target : target.parentElement).closest('.row');
    if (row && !row.hidden && !fresh.has(row)) old.add(row);
  }
});
watch.observe(document.querySelector('.filler'), { subtree: true, attributes: true, characterData: true, childList: true });
let pause = 0, last = performance.now();
const end = last + ms;
const step = () => {
  const now = performance.now();
  pause = Math.max(pause, now - last);
  last = now;
  scroll.scrollTop += 44;
  if (now < end) return setTimeout(step, 20);
  watch.disconnect();
  done({ old: old.size, asked: performance.getEntriesByType('resource').filter((each) => each.name.endsWith('/properties')).length, pause });
};
step();
"""


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
        eventually(lambda: f"Done on 0 of {found} boards" in self.browser.text("asip-selection output"), "the answer", 60)
        asked = self.browser.run("return performance.getEntriesByType('resource').map((each) => each.name)")
        self.assertEqual([each for each in asked if each.endswith("/stop")], [f"{self.bus.url}/api/stop"])

    def test_RowsThatScrollBy_CostTheirOwnFrameAlone(self):
        """Rows that stay are not written again, and no board is asked whose row only passes."""
        self.open(anew=True)
        eventually(lambda: "board0" in self.browser.table(), "the table")
        scrolled = lambda ms: self.browser.driver.execute_async_script(SCROLLED, ms)
        eventually(lambda: scrolled(300)["old"] == 0, "a time between two seconds, in which nothing but the scrolling changes the table", 60)
        passed = eventually(lambda: next((each for each in (scrolled(1500),) if each["pause"] < 200), None), "a scroll that does not stop", 60)
        self.assertEqual(passed["asked"], 0)
        eventually(lambda: self.browser.run("return performance.getEntriesByType('resource').some((each) => each.name.endsWith('/properties'))"), "rows that stay are asked")

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
