# SPDX-License-Identifier: Apache-2.0
"""The table of boards: appears, changes, is searched."""

import unittest

from selenium.webdriver.common.keys import Keys

from rig import PageTest, commands_heard, eventually


class Boards(PageTest):
    def row_has(self, board, text, seconds=20):
        eventually(lambda: text in self.browser.table().get(board, ""), f"{board} {text}", seconds)

    def test_PageOpened_ShowsBothBoardsWithTheirServices(self):
        self.open()
        self.row_has("desk", "online")
        self.row_has("lamp", "online")
        for service in ("io", "distance", "servo"):
            self.assertIn(service, self.browser.table()["desk"])
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

    def test_View_StandsInTheAddressAndIsFoundByIt(self):
        self.open()
        self.row_has("lamp", "online")
        self.browser.shown("input[type=search]").send_keys("lamp")
        eventually(lambda: list(self.browser.table()) == ["lamp"], "only lamp")
        self.assertIn("text=lamp", self.browser.driver.current_url)
        self.open("?text=desk", anew=True)
        eventually(lambda: list(self.browser.table()) == ["desk"], "only desk")
        self.open("?sort=name", anew=True)

    def test_Forget_AsksFirst(self):
        self.bus.end("agent-lamp")
        self.open("board/lamp")
        self.browser.button("Forget this board").click()
        self.assertIn("Forget lamp", self.browser.text(".tools"))
        self.browser.button("Keep it").click()
        self.browser.button("Forget this board")
        self.bus.start_agent("lamp")
        eventually(lambda: self.bus.state("lamp") == "online", "lamp online again", 30)

    def test_SearchAndFilters_ShowOnlyWhatFits(self):
        self.open()
        self.row_has("lamp", "online")
        search = self.browser.shown("input[type=search]")
        search.send_keys("distance")
        eventually(lambda: list(self.browser.table()) == ["desk"], "only desk")
        self.assertIn("1 of 2 boards", self.browser.text(".found"))
        search.clear()
        search.send_keys("nothing like it")
        eventually(lambda: "No board fits" in self.browser.text(), "the sentence")
        search.send_keys(Keys.CONTROL, "a")
        search.send_keys(Keys.DELETE)
        eventually(lambda: len(self.browser.table()) == 2, "both boards")
        self.browser.run("const kind = document.querySelector('.toolbar select'); kind.value = 'servo'; kind.dispatchEvent(new Event('change'))")
        eventually(lambda: list(self.browser.table()) == ["desk"], "only the board with a servo")

    def test_Nothing_IsSentWhenPagesAreOpened(self):
        with commands_heard(self.bus) as heard:
            for route in ("", "board/desk", "board/lamp", "history", "bus"):
                self.open(route)
                self.browser.shown("main > *")
            self.open_board("desk", anew=True)
        self.assertEqual(heard, [])


if __name__ == "__main__":
    unittest.main()
