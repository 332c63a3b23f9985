"""A board's page: pins, values, plots, and commands with their answers. What the simulated board does is checked, too."""

import csv
import io
import time
import unittest

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from rig import PageTest, eventually


class Board(PageTest):
    def form(self, service, title):
        return self.browser.shown(f"form[aria-label='{service}: {title}']")

    def field(self, form, name):
        """The number input of a field, by the name that its label begins with."""
        for label in form.find_elements(By.TAG_NAME, "label"):
            if label.text.startswith(name):
                return form.find_element(By.ID, label.get_attribute("for"))
        raise AssertionError(f"no field {name} in {form.text}")

    def answered(self, form, kind, text):
        output = form.find_element(By.TAG_NAME, "output")
        eventually(lambda: kind in output.get_attribute("class") and text in output.text, f"{kind}: {text}")

    def send(self, form):
        form.find_element(By.CSS_SELECTOR, "button.main").click()

    def test_ServoForm_MovesTheServoAndShowsTheProof(self):
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        number = self.field(form, "Angle")
        self.assertEqual((number.get_attribute("min"), number.get_attribute("max")), ("0", "180"))
        self.assertIn("°", form.text)
        number.send_keys("90")
        self.send(form)
        self.answered(form, "ok", "proof: fence")
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 90) < 2, "the servo at 90 degrees")
        self.browser.screenshot("board")

    def test_Slider_SendsOnReleaseAndNotBefore(self):
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        slider = form.find_element(By.CSS_SELECTOR, "input[type=range]")
        before = self.bus.part("desk/servo")
        self.browser.run("arguments[0].value = 45; arguments[0].dispatchEvent(new Event('input', {bubbles: true}))", slider)
        self.assertEqual(self.field(form, "Angle").get_attribute("value"), "45")
        time.sleep(0.3)
        self.assertEqual(self.bus.part("desk/servo"), before)
        self.browser.run("arguments[0].dispatchEvent(new Event('change', {bubbles: true}))", slider)
        self.answered(form, "ok", "Done")
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 45) < 2, "the servo at 45 degrees")

    def test_ValueOutOfRange_IsNotSentAndSaysWhy(self):
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        number = self.field(form, "Angle")
        number.send_keys("181")
        self.send(form)
        self.answered(form, "refused", "above 180")
        self.assertEqual(number.get_attribute("aria-invalid"), "true")

    def test_BoardRefuses_ItsErrorIsShown(self):
        self.open_board()
        self.browser.run("document.querySelectorAll('asip-service details').forEach((each) => { each.open = true; })")
        form = self.form("io", "Set the duty of a PWM pin")
        pin = self.field(form, "Pin")
        pin.clear()
        pin.send_keys("2")
        self.field(form, "Duty").send_keys("10")
        self.send(form)
        self.answered(form, "error", "The board's error")

    def test_BoardUnplugged_CommandIsNoSuccess(self):
        self.open_board("lamp")
        self.browser.run("document.querySelectorAll('asip-service details').forEach((each) => { each.open = true; })")
        form = self.form("io", "Report analog pins periodically; 0 stops")
        self.field(form, "Period").send_keys("0")
        self.bus.sim("unplug", "lamp")
        self.send(form)
        output = form.find_element(By.TAG_NAME, "output")
        eventually(lambda: any(kind in output.get_attribute("class") for kind in ("timeout", "refused")), "an answer that is no success", 30)
        self.bus.sim("replug", "lamp")
        eventually(lambda: self.bus.state("lamp") == "online", "lamp online again", 30)

    def test_DistanceReported_ValueAndPlotMove(self):
        self.open_board()
        form = self.form("distance", "Report periodically; 0 stops")
        self.field(form, "Period").send_keys("50")
        self.send(form)
        self.answered(form, "ok", "Done")
        value = self.browser.shown("asip-service .value")
        self.browser.shown("canvas")
        eventually(lambda: value.text.replace("\u00a0", " ") in ("41 cm", "42 cm", "43 cm"), "42 cm")
        first = self.picture()
        self.bus.sim("set", "desk/distance", "120")
        eventually(lambda: value.text.startswith("12") or value.text.startswith("119"), "120 cm")
        eventually(lambda: self.picture() != first, "another picture")
        self.browser.button("10 s").click()
        self.browser.screenshot("plot")

        self.browser.button("Pause").click()
        eventually(lambda: self.browser.find(".plot-tools button")[0].text == "Follow", "paused")
        paused = self.picture()
        self.bus.sim("set", "desk/distance", "60")
        eventually(lambda: value.text.startswith("6") or value.text.startswith("59"), "60 cm")
        self.assertEqual(self.picture(), paused, "a paused plot stands still")
        self.browser.button("+").click()
        eventually(lambda: self.picture() != paused, "zoomed")
        self.browser.button("Follow").click()

        rows = list(csv.reader(io.StringIO(self.csv())))
        self.assertEqual(rows[0][0], "time")
        self.assertIn("cm", rows[0][1])
        self.assertGreater(len(rows), 20)
        self.assertTrue(any(abs(float(row[1]) - 120) < 2 for row in rows[1:]), "the measured distance is in the CSV")

        self.open_board()  # the last minutes are there at once
        eventually(lambda: (self.browser.run("return document.querySelector('asip-plot')?.series.times.length") or 0) > 20, "the past in the plot", 5)
        form = self.form("distance", "Report periodically; 0 stops")
        self.field(form, "Period").clear()
        self.field(form, "Period").send_keys("0")
        self.send(form)
        self.answered(form, "ok", "Done")

    def picture(self):
        """What the plot shows once it has drawn."""
        return self.browser.driver.execute_async_script("""
            const done = arguments[0];
            requestAnimationFrame(() => requestAnimationFrame(() => done(document.querySelector('canvas').toDataURL())));""")

    def csv(self):
        return self.browser.driver.execute_async_script("""
            const done = arguments[0], make = URL.createObjectURL;
            URL.createObjectURL = (blob) => { blob.text().then(done); return make.call(URL, blob); };
            [...document.querySelectorAll('.plot-tools button')].find((button) => button.textContent === 'CSV').click();""")

    def pin(self, label):
        return self.browser.shown(f".pin[aria-label^='Pin {label}:']")

    def test_FreePin_IsSetToOutputAndHighByClicks(self):
        self.open_board()
        self.pin("13").click()
        self.browser.button("Output", ".pin-panel").click()
        eventually(lambda: "output" in self.pin("13").get_attribute("aria-label"), "pin 13 as output")
        self.browser.button("High", ".pin-panel").click()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        eventually(lambda: "high" in self.pin("13").get_attribute("aria-label"), "pin 13 shown as high")
        self.browser.screenshot("pins")
        self.browser.button("Low", ".pin-panel").click()
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off")

    def test_ButtonPressedOnTheBoard_LightsThePin(self):
        self.open_board()
        self.pin("2").click()
        self.browser.button("Input pullup", ".pin-panel").click()
        eventually(lambda: "high" in self.pin("2").get_attribute("aria-label"), "released is high")
        self.bus.sim("press", "desk/button")
        eventually(lambda: "low" in self.pin("2").get_attribute("aria-label"), "pressed is low")
        self.bus.sim("release", "desk/button")
        eventually(lambda: "high" in self.pin("2").get_attribute("aria-label"), "released is high again")

    def output_form(self):
        """The form that sets pin 13, an output now, to high."""
        self.open_board()
        self.pin("13").click()
        self.browser.button("Output", ".pin-panel").click()
        eventually(lambda: "output" in self.pin("13").get_attribute("aria-label"), "pin 13 as output")
        self.browser.run("document.querySelectorAll('asip-service details').forEach((each) => { each.open = true; })")
        form = self.form("io", "Set the level of an output pin")
        self.field(form, "Pin").send_keys("13")
        self.browser.run("arguments[0].value = '1'", form.find_element(By.TAG_NAME, "select"))
        return form

    def test_HeldOutput_IsOnOnlyWhileTheButtonIsDown(self):
        form = self.output_form()
        hold = form.find_element(By.CSS_SELECTOR, "button.hold")
        ActionChains(self.browser.driver).click_and_hold(hold).perform()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        time.sleep(1.2)  # more than twice the time for which one command is held
        # A machine that is too busy to renew in time is treated like one that is gone, and the page reports it.
        eventually(lambda: (self.bus.part("desk/led") == "on") == (hold.get_attribute("aria-pressed") == "true"), "page and LED agree")
        ActionChains(self.browser.driver).release().perform()
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off", 2)
        eventually(lambda: "safe" in form.text or "Not held" in form.text, "what became of it")

    def test_PageGoneWhileHolding_BoardIsMadeSafe(self):
        form = self.output_form()
        ActionChains(self.browser.driver).click_and_hold(form.find_element(By.CSS_SELECTOR, "button.hold")).perform()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        self.browser.driver.get("about:blank")
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off", 3)
        ActionChains(self.browser.driver).release().perform()

    def test_StopButton_MakesOutputsSafe(self):
        self.open_board()
        self.pin("13").click()
        self.browser.button("Output", ".pin-panel").click()
        self.browser.button("High", ".pin-panel").click()
        eventually(lambda: self.bus.part("desk/led") == "on", "the LED is lit")
        self.browser.button("Stop all").click()
        eventually(lambda: "Stopped" in self.browser.text("header asip-stop"), "what the stop did")
        eventually(lambda: self.bus.part("desk/led") == "off", "the LED is off")
        self.assertNotIn("high", self.pin("13").get_attribute("aria-label"))

    def test_TakenPins_SayWhoseTheyAreAndOfferNothing(self):
        self.open_board()
        self.assertIn("servo", self.pin("9").get_attribute("aria-label"))
        self.assertIn("board itself", self.pin("0").get_attribute("aria-label"))
        self.pin("9").click()
        self.assertIn("servo", self.browser.shown(".pin-panel").text)
        self.assertEqual(self.browser.find(".pin-panel button"), [])

    def test_History_ShowsWhatHappenedToTheBoardAndOnTheBus(self):
        self.open_board()
        eventually(lambda: "online" in self.browser.text("asip-history"), "history of the board")
        self.open("history")
        eventually(lambda: "desk" in self.browser.text("asip-history") and "lamp" in self.browser.text("asip-history"), "history of the bus")
        self.browser.screenshot("history")

    def test_BusPage_ShowsBrokerGatewayAndRegistry(self):
        self.open("bus")
        text = eventually(lambda: "Registry first" in self.browser.text() and self.browser.text(), "the cards")
        self.assertIn("Broker", text)
        self.assertIn("connected", text)
        self.assertIn(str(self.bus.broker_port), text)
        self.assertIn("Every board that is known is there", text)
        self.browser.screenshot("bus")

    def test_BoardThatIsNotKnown_SaysSo(self):
        type(self).expected_errors = ("/api/boards/nobody",)
        self.addCleanup(setattr, type(self), "expected_errors", ())
        self.open("board/nobody")
        eventually(lambda: "There is no board nobody now" in self.browser.text(), "the sentence")
        self.browser.driver.get_log("browser")


if __name__ == "__main__":
    unittest.main()
