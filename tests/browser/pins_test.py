# SPDX-License-Identifier: Apache-2.0
"""The pins of a board: set by clicks, lit by what happens on the board, held and stopped. What the simulated board does is checked, too."""

import json
import time
import unittest
import urllib.request

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

from rig import PageTest, eventually


class Pins(PageTest):
    def pin(self, label):
        return self.browser.shown(f".pin[title^='Pin {label}:']")

    def switch(self):
        return self.browser.shown(".pin-panel .toggle:enabled")

    def output_form(self):
        """The form that sets pin 13, an output now, to high."""
        self.open_board()
        self.pin("13").click()
        self.browser.button("Output", ".pin-panel").click()
        eventually(lambda: "output" in self.pin("13").get_attribute("title"), "pin 13 as output")
        self.all_commands()
        form = self.form("io", "Set the level of an output pin")
        self.fill(form, "Pin", "13")
        self.browser.run("arguments[0].value = '1'", form.find_element(By.TAG_NAME, "select"))
        return form

    def test_FreePin_IsSetToOutputAndHighByClicks(self):
        self.open_board()
        self.pin("13").click()
        self.browser.button("Output", ".pin-panel").click()
        eventually(lambda: "output" in self.pin("13").get_attribute("title"), "pin 13 as output")
        self.switch().click()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        eventually(lambda: "set to on" in self.pin("13").get_attribute("title"), "pin 13 shown as set to on")
        self.assertIn("set to on", self.browser.shown(".pin-panel").text)
        self.browser.screenshot("pins")
        self.switch().click()
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off")

    def test_ButtonPressedOnTheBoard_LightsThePin(self):
        self.open_board()
        self.pin("2").click()
        self.browser.button("Input pullup", ".pin-panel").click()
        eventually(lambda: self.pin("2").get_attribute("title").endswith(", off"), "released is off")
        self.bus.sim("press", "desk/button")
        eventually(lambda: self.pin("2").get_attribute("title").endswith(", on"), "pressed is on")
        self.bus.sim("release", "desk/button")
        eventually(lambda: self.pin("2").get_attribute("title").endswith(", off"), "released is off again")

    def test_HeldOutput_IsOnOnlyWhileTheButtonIsDown(self):
        form = self.output_form()
        hold = form.find_element(By.CSS_SELECTOR, "button.hold")
        ActionChains(self.browser.driver).click_and_hold(hold).perform()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        # More than twice the time for which one command is held. A machine that is too busy to renew in time is treated like one
        # that is gone, and the page reports it.
        end = time.monotonic() + 1.2
        eventually(lambda: time.monotonic() > end or self.bus.part("desk/led") == "off", "the time to pass")
        eventually(lambda: (self.bus.part("desk/led") == "on") == (hold.get_attribute("aria-pressed") == "true"), "page and LED agree")
        ActionChains(self.browser.driver).release().perform()
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off")
        eventually(lambda: "safe" in form.text or "Not held" in form.text, "what became of it")

    def test_PageGoneWhileHolding_BoardIsMadeSafe(self):
        form = self.output_form()
        ActionChains(self.browser.driver).click_and_hold(form.find_element(By.CSS_SELECTOR, "button.hold")).perform()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        self.browser.driver.get("about:blank")
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off")
        ActionChains(self.browser.driver).release().perform()

    def test_StopButton_MakesOutputsSafe(self):
        self.open_board()
        self.pin("13").click()
        self.browser.button("Output", ".pin-panel").click()
        self.switch().click()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        self.browser.button("Stop all").click()
        eventually(lambda: "Stopped" in self.browser.text("header asip-stop"), "what the stop did")
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off")
        eventually(lambda: "set to on" not in self.pin("13").get_attribute("title"), "that it is not on any more")
        eventually(lambda: "stopped" in self.browser.text(".pin-panel asip-widget"), "that it is stopped")
        self.assertFalse(self.browser.shown(".pin-panel .toggle").is_enabled())
        self.browser.button("Resume all").click()
        eventually(lambda: "Resumed" in self.browser.text("header asip-stop"), "what the button did")
        self.switch().click()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit again")
        self.switch().click()
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off")

    def test_MeaningOfAPin_IsSetInItsPanel(self):
        self.open_board()
        self.pin("12").click()
        form = self.browser.shown("form[aria-label='Name of pin 12']")
        nothing = urllib.request.Request(f"{self.bus.url}/api/boards/desk/labels", b'{"meanings":{"io/12":null}}', {"Content-Type": "application/json"})
        self.addCleanup(urllib.request.urlopen, nothing, timeout=20)
        Select(form.find_elements(By.TAG_NAME, "select")[0]).select_by_visible_text("light")
        Select(form.find_elements(By.TAG_NAME, "select")[1]).select_by_visible_text("low")
        form.find_element(By.TAG_NAME, "button").click()
        eventually(lambda: "Kept" in form.text, "the agent has it")

        def listed():
            with urllib.request.urlopen(f"{self.bus.url}/api/boards/desk/properties?ids=io/12", timeout=20) as answer:
                return json.load(answer)["properties"][0]
        made = eventually(listed, "the property of the pin")
        self.assertEqual((made["kind"], made["meaning"]), ("light", {"class": "light", "inverted": True}))

    def test_TakenPins_SayWhoseTheyAreAndOfferNothing(self):
        self.open_board()
        self.assertIn("Servo", self.pin("9").get_attribute("title"))
        self.assertIn("board itself", self.pin("0").get_attribute("title"))
        self.pin("9").click()
        self.assertIn("Servo", self.browser.shown(".pin-panel").text)
        self.assertEqual(self.browser.find(".pin-panel .chips"), [], "nothing that sets it")


if __name__ == "__main__":
    unittest.main()
