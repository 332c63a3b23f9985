# SPDX-License-Identifier: Apache-2.0
"""The page for people who use no mouse, read with a screen reader, or hold a phone."""

import contextlib
import unittest

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from board_test import published
from rig import PageTest, eventually

ROUTES = {"boards": "", "board": "board/desk", "history": "history", "add": "add", "dashboards": "dashboards", "settings": "settings", "unknown": "nowhere"}


class People(PageTest):
    def settle(self, route):
        self.open(route)
        self.browser.shown("main > *")
        if route.startswith("board/"):
            self.setter("Servo 0 angle")
            self.all_pins()
            self.browser.shown(".pin:not(.taken)").click()
            self.all_commands()

    def test_PhoneWidth_NothingIsWiderThanTheScreen(self):
        self.browser.size(360, 740, mobile=True)
        for name, route in ROUTES.items():
            self.settle(route)
            width = self.browser.run("return document.documentElement.scrollWidth")
            self.assertLessEqual(width, 360, name)
            stop = self.browser.shown("button.stop").rect
            self.assertLessEqual(stop["x"] + stop["width"], 360, name)
            self.assertEqual(self.broken_words(), [], name)
            for right in self.browser.run("return [...document.querySelectorAll('asip-history td:last-child')].map((each) => each.getBoundingClientRect().right)"):
                self.assertLessEqual(right, 360, f"{name}: what happened is in sight")
            self.browser.screenshot(f"phone-{name}")
        self.browser.size(390, 844, mobile=True)
        self.open("")
        self.assertEqual(self.browser.shown("header").rect["height"], 48)
        self.assertEqual(self.browser.run("return getComputedStyle(document.querySelector('.row.head'), '::before').content"), '"Sort by"')
        heads = [(each.rect["x"], each.text) for each in self.browser.find(".row.head button") if each.is_displayed()]
        self.assertEqual([text for _, text in sorted(heads)], ["Board", "State", "Since"])
        self.browser.screenshot("phone-boards-390")
        self.browser.size(320, 568, mobile=True)
        self.assertEqual(self.broken_words(), [])
        self.assertLessEqual(self.browser.run("return document.querySelector('header').scrollWidth"), 320)

    def test_Page_CanBeInstalled(self):
        self.open(anew=True)
        ask = self.browser.driver.execute_cdp_cmd
        self.assertEqual(ask("Page.getInstallabilityErrors", {})["installabilityErrors"], [])
        manifest = ask("Page.getAppManifest", {})
        self.assertEqual(manifest["errors"], [])
        self.assertIn("ASIP boards", manifest["data"])

    def test_MassLossOnAPhone_IsReadWholeAndItsBoardsAreInReach(self):
        self.browser.size(360, 740, mobile=True)
        with contextlib.ExitStack() as lost:
            for name in ("a-board-with-a-long-name-in-the-cellar", "another-board-with-a-long-name", "third"):
                lost.enter_context(published(self.bus, f"asip/servicebus/{name}/$state", "lost"))
            self.open("")
            eventually(lambda: "3 boards lost (all: its agent died" in self.browser.text(".attention"), "the alarm", 30)
            edges = self.browser.run("""return [...document.querySelectorAll(".attention strong, .attention a, .attention button")]
                .flatMap((each) => [...each.getClientRects()]).map((box) => box.right)""")
            self.assertGreaterEqual(len(edges), 4)
            self.assertLessEqual(max(edges), 360)
            self.browser.screenshot("phone-mass-loss")

    def broken_words(self):
        """Pages of the navigation whose name does not stand in one line."""
        return self.browser.run("""return [...document.querySelectorAll("nav a")].filter((link) => {
            const words = document.createRange();
            words.selectNodeContents(link);
            return new Set([...words.getClientRects()].map((box) => box.top)).size > 1;
        }).map((link) => link.textContent)""")

    def keys(self, *keys):
        actions = ActionChains(self.browser.driver)
        for key in keys:
            actions = actions.send_keys(key)
        actions.perform()

    def focused(self):
        """The page itself, whose text is that of all, is not taken for a control."""
        return self.browser.run("""const each = document.activeElement;
            return each === document.body ? "" : each.getAttribute('aria-label') ?? each.textContent""")

    def tab_to(self, text, most=160):
        """The second time around at the latest: a control may have been off the first time."""
        for _ in range(most):
            self.keys(Keys.TAB)
            if text in (self.focused() or ""):
                return
        self.fail(f"Tab does not reach {text}")

    def test_KeyboardOnly_OpensABoardAndMovesItsServo(self):
        self.open()
        eventually(lambda: len(self.browser.find(".filler .row:not([hidden]) a")) == 2, "both boards")
        self.tab_to("Select desk")
        self.keys(Keys.TAB)
        self.assertEqual(self.focused(), "desk")
        self.keys(Keys.ARROW_DOWN)
        self.assertEqual(self.focused(), "lamp")
        self.keys(Keys.ARROW_UP, Keys.ENTER)
        self.setter("Servo 0 angle")
        self.assertEqual(self.focused(), "desk")  # the heading of the new screen
        self.tab_to("Servo 0 angle")
        self.keys(Keys.END)
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 180) < 2, "the servo at 180 degrees")
        self.keys(Keys.ARROW_LEFT)
        eventually(lambda: "179" in self.browser.text(".setters [aria-label='Servo 0 angle']"), "one degree less")

    def test_KeyboardOnly_ControlKeepsTheFocusWhileAnotherOneComes(self):
        self.assertEqual(self.bus.asipctl("pin", "desk", "12", "low").returncode, 0)
        self.open_board()
        self.browser.run("arguments[0].focus()", self.setter("Pin 12"))
        self.assertEqual(self.bus.asipctl("pin", "desk", "13", "low").returncode, 0)
        self.setter("Pin 13")
        self.keys(Keys.SPACE)
        eventually(lambda: self.setter("Pin 12").get_attribute("aria-checked") == "true", "pin 12 is on")

    def test_KeyboardOnly_SetsAPin(self):
        self.open_board("lamp")
        self.tab_to("Pin 13")
        self.keys(Keys.ENTER)
        self.tab_to("Output")
        self.keys(Keys.ENTER)
        eventually(lambda: "output" in self.browser.shown(".pin[title^='Pin 13:']").get_attribute("title"), "pin 13 as output")
        self.tab_to("Pin 13")
        self.keys(Keys.ENTER)
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "the lamp is lit")


if __name__ == "__main__":
    unittest.main()
