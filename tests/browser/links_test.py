# SPDX-License-Identifier: Apache-2.0
"""Links that the page makes: the agents execute them, a person turns them on and off, and removes them."""

import pathlib
import unittest

from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

from rig import BUILD, PageTest, eventually, settings_file

AXE = pathlib.Path(BUILD, "axe-core/node_modules/axe-core/axe.min.js")


class Links(PageTest):
    expected_errors = ("status of 400", "status of 401", "status of 403", "ERR_CONNECTION_REFUSED", "WebSocket")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for words in (("label", "desk/io/2", "class=button"), ("pin", "desk", "2", "pullup"), ("pin", "lamp", "13", "low")):
            done = cls.bus.asipctl(*words)
            assert done.returncode == 0, done.stderr

    def section(self):
        return self.browser.shown("section[aria-label='Links']")

    def rows(self):
        return self.browser.run("return [...document.querySelectorAll('asip-links li')].map((each) => each.innerText)")

    def make(self, source, way, target, **typed):
        self.browser.button("Make a link", "asip-links").click()
        form = self.browser.shown("form[aria-label='Make a link']")
        choices = form.find_elements(By.TAG_NAME, "select")
        for choice, text in zip((choices[0], choices[2], choices[1]), (source, target, way)):
            Select(choice).select_by_visible_text(text)
        for label, text in typed.items():
            self.number(form, label).send_keys(text)
        return form

    def press(self):
        self.bus.sim("press", "desk/button")
        self.bus.sim("release", "desk/button")

    def events(self):
        """How often the button was pressed and released."""
        return self.bus.get("/api/boards/desk/values?ids=io/2")["values"]["io/2"]["events"][-1][0]

    def pressed_until(self, what):
        """One press switches once: the other way, whatever it was."""
        self.press()
        eventually(lambda: self.bus.part("lamp/lamp") == what, f"the LED is {what}")

    def check_axe(self):
        self.browser.run(AXE.read_text())
        found = self.browser.driver.execute_async_script(
            "const [done] = arguments; axe.run({ resultTypes: ['violations'] }).then((result) => done(result.violations.map((each) => `${each.id}: ${each.nodes[0].html}`)))")
        self.assertEqual(found, [])
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth - innerWidth"), 0)

    def test_OnAPhone_ALinkOfThreeChoicesSwitchesTheOtherBoard_IsTurnedOffAndRemoved(self):
        self.browser.size(390, 844, mobile=True)
        self.open_board("desk", anew=True)
        form = self.make("desk: Pin 2", "each press switches it", "lamp: Pin 13")
        self.check_axe()
        self.browser.screenshot("links-form")
        self.send(form)
        eventually(lambda: any("lamp: each press of desk/io/2 switches io/13" in each and "\non" in each for each in self.rows()), "the link is on")
        self.pressed_until("on")
        eventually(lambda: any("set to on, because desk/io/2 had a press" in each for each in self.rows()), "the sentence")
        self.pressed_until("off")
        self.check_axe()
        self.browser.screenshot("links")
        self.browser.button("Turn off", "asip-links").click()
        self.browser.button("Turn on", "asip-links")
        heard = self.events()
        self.press()
        eventually(lambda: self.events() >= heard + 2, "the press is heard")
        self.assertEqual(self.bus.part("lamp/lamp"), "off")
        self.browser.button("Turn on", "asip-links").click()
        self.browser.button("Turn off", "asip-links")
        self.pressed_until("on")
        self.browser.button("Remove", "asip-links").click()
        self.check_axe()
        self.browser.button("Keep it", "asip-links").click()
        self.browser.button("Remove", "asip-links").click()
        self.browser.button("Yes, remove", "asip-links").click()
        eventually(lambda: self.rows() == [], "it is gone")
        self.assertIn("no links", self.bus.asipctl("link", "list").stderr)

    def test_WhatCannotBe_IsSaidInASentence_AndALevelIsTyped(self):
        self.open_board("lamp", anew=True)
        form = self.make("desk: Distance 0", "it is on below a level", "lamp: Pin 13", Level="near")
        self.send(form)
        eventually(lambda: "level" in self.browser.text("asip-links > output"), "the refusal")
        self.fill(form, "Level", "20")
        self.send(form)
        eventually(lambda: any("while desk/distance/0 is below 20" in each for each in self.rows()), "the link")
        self.bus.asipctl("send", "desk/distance", "report", "100")
        self.bus.sim("set", "desk/distance", "10")
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "near: on")
        self.bus.sim("set", "desk/distance", "80")
        eventually(lambda: self.bus.part("lamp/lamp") == "off", "far: off")
        self.browser.button("Remove", "asip-links").click()
        self.browser.button("Yes, remove", "asip-links").click()
        eventually(lambda: self.rows() == [], "it is gone")

    def test_ZViewer_LooksAlone_AndIsToldWhoMay(self):
        self.assertEqual(self.bus.asipctl("link", "desk/io/2", "lamp/io/13", "--toggle").returncode, 0)
        self.bus.end("gateway")
        self.bus.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.bus.http_port}", "--anonymous", "viewer", "--config", settings_file("loopback = viewer\n"))
        eventually(lambda: self.bus.get("/readyz"), "the gateway")
        self.open_board("lamp", anew=True)
        eventually(lambda: len(self.rows()) == 1 and "an operator makes and changes them" in self.section().text, "the sentence")
        self.assertEqual([each.text for each in self.section().find_elements(By.TAG_NAME, "button") if each.is_displayed()], [])


if __name__ == "__main__":
    unittest.main()
