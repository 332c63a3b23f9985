# SPDX-License-Identifier: Apache-2.0
"""Services of a board: values, plots, commands with their answers; history and the bus. What the simulated board does is checked, too."""

import csv
import io
import json
import unittest
import urllib.request

from selenium.webdriver.common.by import By

from rig import PageTest, commands_heard, eventually


class Services(PageTest):
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

    def test_FreshLoad_HasEachFormOnce(self):
        self.open_board()
        self.form("servo", "Turn a servo to an angle")
        labels = self.browser.run(
            "return [...document.querySelectorAll('form[aria-label]')].map((form) => form.getAttribute('aria-label'))")
        self.assertGreater(len(labels), 2)
        self.assertEqual(sorted(labels), sorted(set(labels)))

    def test_ServoForm_MovesTheServoAndShowsTheProof(self):
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        number = self.fill(form, "Angle", "90")
        self.assertEqual((number.get_attribute("min"), number.get_attribute("max")), ("0", "180"))
        self.assertIn("°", form.text)
        self.send(form)
        self.answered(form, "ok", "Done")
        self.all_commands()
        self.assertIn("servo write: fence", self.browser.text(".advanced"))
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 90) < 2, "the servo at 90 degrees")
        self.browser.screenshot("board")

    def test_Slider_SendsOnReleaseAndNotBefore(self):
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        slider = form.find_element(By.CSS_SELECTOR, "input[type=range]")
        with commands_heard(self.bus) as heard:
            self.browser.run("arguments[0].value = 45; arguments[0].dispatchEvent(new Event('input', {bubbles: true}))", slider)
            eventually(lambda: self.number(form, "Angle").get_attribute("value") == "45", "the slider's value in the field")
            self.browser.run("arguments[0].value = 46; arguments[0].dispatchEvent(new Event('input', {bubbles: true}))", slider)
            self.browser.run("arguments[0].dispatchEvent(new Event('change', {bubbles: true}))", slider)
            self.answered(form, "ok", "Done")
        self.assertEqual([json.loads(text)["write"]["angle"] for text in heard], [46])
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 46) < 2, "the servo at 46 degrees")

    def test_ValueOutOfRange_IsNotSentAndSaysWhy(self):
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        number = self.fill(form, "Angle", "181")
        self.send(form)
        self.answered(form, "refused", "above 180")
        self.assertEqual(number.get_attribute("aria-invalid"), "true")

    def test_BoardRefuses_ItsErrorIsShown(self):
        self.open_board()
        self.all_commands()
        form = self.form("io", "Set the duty of a PWM pin")
        self.fill(form, "Pin", "2")
        self.fill(form, "Duty", "10")
        self.send(form)
        self.answered(form, "error", "The board's error")

    def test_BoardUnplugged_ItsFormsAreOffUntilItIsBack(self):
        self.open_board("lamp")
        self.all_commands()
        off = lambda: self.browser.run("return [...document.querySelectorAll('asip-board asip-command')].every((each) => each.closest('[inert]'))")
        eventually(lambda: not off(), "the forms can be used")
        self.bus.sim("unplug", "lamp")
        eventually(off, "the forms are off", 30)
        self.assertIn("Commands are off until the board is back", self.browser.text(".unusable"))
        eventually(lambda: "(1 lost)" in self.browser.driver.title, "the tab's title")
        self.browser.run("location.hash = '#/'")
        eventually(lambda: "1 board lost" in self.browser.text(".attention") and "cable unplugged" in self.browser.text(".attention"), "lost boards first")
        self.bus.sim("replug", "lamp")
        eventually(lambda: self.bus.state("lamp") == "online", "lamp online again", 30)
        eventually(lambda: self.browser.text(".attention") == "", "nothing to look after")
        self.open_board("lamp")
        eventually(lambda: not off(), "the forms can be used again")

    def test_WhatAnotherProgramSet_IsShownAlsoAfterAReload(self):
        self.open_board()
        urllib.request.urlopen(urllib.request.Request(f"{self.bus.url}/api/boards/desk/services/servo/commands/write", b"[0,33]",
                                                      {"Content-Type": "application/json"}), timeout=10)
        known = lambda: self.browser.shown(".setters [aria-label='Servo 0 angle']").text
        eventually(lambda: "33" in known(), "what was set by another program")
        self.open_board(anew=True)
        eventually(lambda: "33" in known(), "and after a reload")

    def test_SliderOfAServo_IsWhereTheServoIs_AndOnlyServosOfTheBoardAreOffered(self):
        self.open_board()
        slider = self.setter("Servo 0 angle")
        for angle in (150, 21):
            urllib.request.urlopen(urllib.request.Request(f"{self.bus.url}/api/boards/desk/services/servo/commands/write", f"[0,{angle}]".encode(),
                                                          {"Content-Type": "application/json"}), timeout=10)
            eventually(lambda: slider.get_property("value") == str(angle), f"the slider at {angle}")  # noqa: B023
            self.assertNotIn("unknown", slider.get_attribute("class"), "a value that is known is not pale")
        self.assertEqual([each.text for each in self.browser.find(".setters h3") if "ervo" in each.text], ["Servo 0 angle", "Servo 1 angle"])
        offered = [each.get_property("textContent") for each in self.form("servo", "Turn a servo to an angle").find_elements(By.TAG_NAME, "option")]
        self.assertEqual(offered, ["Servo 0", "Servo 1"])  # the pins that the sketch gives it, not 256

    def test_SliderMoved_MovesTheServo_AndSaysWhatTheBoardDid(self):
        self.open_board()
        self.slide("Servo 0 angle", 60, 75)
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 75) < 2, "the servo at 75 degrees")
        eventually(lambda: "75" in self.browser.text(".setters [aria-label='Servo 0 angle']"), "what the board was told")

    def test_ValuesOfABoard_HaveTheNamesAndWordsOfItsProperties(self):
        label = lambda body: urllib.request.urlopen(urllib.request.Request(f"{self.bus.url}/api/boards/desk/labels", body.encode(), {"Content-Type": "application/json"}), timeout=20)
        self.addCleanup(label, '{"meanings":{"io/14":null}}')
        label('{"meanings":{"io/14":{"class":"button","inverted":false}}}')
        self.open_board()
        value = lambda name: self.browser.run("""const box = [...document.querySelectorAll(".number")].find((each) => each.firstChild.textContent === arguments[0]);
            return box?.lastChild.textContent""", name)
        listed = lambda: {each["name"]: each["id"] for each in self.bus.get("/api/boards/desk/properties")["properties"]}
        eventually(lambda: "Pin A0" in listed(), "pin A0 is listed")
        for name in ("Distance 0", "Distance 1", "Pin A0"):
            eventually(lambda: value(name), name)  # noqa: B023
        stands = lambda name: self.bus.get("/api/boards/desk/values")["values"][listed()[name]].get("value")
        eventually(lambda: value("Distance 0").startswith(f"{stands('Distance 0')}\u00a0cm"), "the same value")
        self.assertNotIn("Pin A1", self.browser.text(".values-box"), "an input that nobody uses is no value")

    def test_DistanceReported_ValueAndPlotMove(self):
        self.open_board()
        value = self.browser.shown("[aria-label='Distance'] .value")
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

        self.open_board(anew=True)  # the last minutes are there at once
        eventually(lambda: (self.browser.run("return document.querySelector('asip-plot')?.series.times.length") or 0) > 20, "the past in the plot")

    def test_History_ShowsWhatHappenedToTheBoardAndOnTheBus(self):
        self.open_board()
        self.history()
        eventually(lambda: "Online" in self.browser.text("asip-history"), "history of the board")
        self.open("history")
        eventually(lambda: "desk" in self.browser.text("asip-history") and "lamp" in self.browser.text("asip-history"), "history of the bus")
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        self.fill(form, "Angle", "33")
        self.send(form)
        self.answered(form, "ok", "Done")

        def who_did_what():
            self.open("history")
            self.every_command()
            return "Servo 0 to 33°, by this machine" in eventually(lambda: self.browser.text("asip-history"), "the history")

        eventually(who_did_what, "who moved the servo")
        self.browser.screenshot("history")

    def test_BoardThatIsNotKnown_SaysSo(self):
        type(self).expected_errors = ("/api/boards/nobody",)
        self.addCleanup(setattr, type(self), "expected_errors", ())
        self.open("board/nobody")
        eventually(lambda: "There is no board nobody now" in self.browser.text(), "the sentence")
        self.browser.driver.get_log("browser")


if __name__ == "__main__":
    unittest.main()
