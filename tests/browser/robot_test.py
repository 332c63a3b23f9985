# SPDX-License-Identifier: Apache-2.0
"""A robot builder's day, from an empty system to a dashboard on the phone, in English and in German. The robot is simulated with its
real firmware: it drives on a floor, measures how far a box is, and bumps into it."""

import json
import os
import re
import subprocess
import unittest

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from first_test import Evening
from rig import ROOT, Browser, die_with_parent, eventually
from world_test import MIRTO

BOARD = "usb-1"  # as its agent names it, by the port
TOGETHER = "Set the power of the first two motors at once"
FORWARDS, BACKWARDS = (100, -100), (-100, 100)  # the right motor is mounted the other way round
PROGRAM = """
import asip, time

with asip.connect(by="line-follower") as bus:
    robot = bus.board("usb-1")
    print(robot.distance.read(), flush=True)
    with robot.motors.hold(drive=[-80, 80], seconds=5) as held:
        while not held.lost:
            time.sleep(0.05)
"""


class RobotBuilder(Evening):
    boards = ()

    def test_Day_FromAnEmptySystemToAStopOnThePhone(self):
        self.find_and_name_it()
        self.look_at_its_page()
        self.drive_into_the_box_and_back()
        self.stop_it("stop-all", "header", "resume-all")
        self.stop_it("stop-board", ".title-row", "resume-board")
        self.let_a_program_drive()
        self.pull_the_cable_while_it_drives()
        self.stop_it_from_the_phone(self.make_a_dashboard())

    # What the robot does -------------------------------------------------------------------------------------------------------

    def floor(self):
        """Where the robot stands, as one who looks at the floor sees it: "at 12,0 heading 0 laps 0"."""
        return self.bus.part(f"{BOARD}/rover")

    def moving(self):
        """Tells whether it has moved from where it stands now."""
        place = lambda: [int(number) for number in re.findall(r"-?\d+", self.floor())[:2]]
        x, y = place()
        return lambda: abs(place()[0] - x) + abs(place()[1] - y) > 5

    def drives(self):
        eventually(self.moving(), "the robot drives", 60)

    def rests(self):
        eventually(lambda: len({self.floor() for _ in range(5)}) == 1, "the robot stands", 60)

    # What the page shows -------------------------------------------------------------------------------------------------------

    def word(self, name):
        """A word of a model as the page writes it, where it begins a name."""
        text = self.texts.get(f"word.{name}", name)
        return text[0].upper() + text[1:]

    def value(self, name):
        """What stands below the first of these names: "Distance", "Bump 0"."""
        shown = self.browser.run("return [...document.querySelectorAll('.values-box .number')].map((each) => [each.firstChild.textContent, each.lastChild.textContent])")
        return next((value for label, value in shown if label.startswith(self.word(name))), "")

    def centimetres(self):
        """0: no echo."""
        return int((re.match(r"\d+", self.value("distance")) or ["0"])[0])

    def open_robot(self):
        self.browser.find("nav a")[0].click()
        eventually(lambda: "Robot" in self.browser.table(), "the robot in the list", 60)
        self.browser.shown(".filler .row:not([hidden]) a").click()
        self.browser.shown("asip-board.drives .controls-box form", seconds=60)

    def motors(self, power):
        """The form of both motors, filled in."""
        form = self.browser.shown(f"form[aria-label='motors: {self.texts.get(f'model.{TOGETHER}', TOGETHER)}']")
        eventually(lambda: not self.browser.run("return arguments[0].closest('[inert]')", form), "commands can be sent", 60)
        for box, value in zip(form.find_elements("css selector", "input[type=number]"), power):
            box.send_keys(Keys.CONTROL, "a")
            box.send_keys(str(value))
        return form

    def hold(self, power, until=lambda: True, what="it drives"):
        """The button is down until something has happened; again where a busy machine was too slow to renew that."""
        form = self.motors(power)
        button = form.find_element("css selector", "button.hold")
        self.browser.run("arguments[0].scrollIntoView({ block: 'center' })", button)
        moved = self.moving()

        def pressed():
            ActionChains(self.browser.driver).click_and_hold(button).perform()
            try:
                self.answered(form, "ok", self.t("held"))
                return eventually(lambda: "done" if moved() and until() else "" if self.t("held") in form.text else "lost", what, 60) == "done"
            finally:
                ActionChains(self.browser.driver).release().perform()

        eventually(pressed, what, 60)
        self.answered(form, "ok", self.t("let-go-safe"))
        self.rests()

    def keep_on(self, power):
        form = self.motors(power)
        next(each for each in form.find_elements("tag name", "button") if each.text == self.t("keep-on")).click()
        return form

    # The day -------------------------------------------------------------------------------------------------------------------

    def find_and_name_it(self):
        page, bus = self.browser, self.bus
        self.begin()
        file = bus.work / f"{BOARD}.json"
        file.write_text(json.dumps({**MIRTO, "name": BOARD, "link": f"{BOARD}.port"}))
        bus.start("sim", "asip-sim", "--socket", str(bus.work / "sim.sock"), str(file))
        bus.start_agent(BOARD)  # as udev does
        page.button(self.t("take-row", row=BOARD), ".add-board", 60).click()
        bus.sim("block", "rover", "400", "0", "50")  # a box stands on the floor
        self.name_it("Robot", "Lab")
        self.choose(page.shown(".add-board asip-add-widget form"), "distance", "value")
        eventually(lambda: re.search(r"\d+\s?cm", page.text(".dashboard-grid")), "the distance on a dashboard", 60)

    def choose(self, form, name, kind):
        """What is put on a dashboard."""
        what = Select(form.find_element("tag name", "select"))
        offers = [each.text for each in what.options if each.text.startswith(self.word(name)) and each.text.endswith(f": {self.t(f'kind.{kind}')}")]
        self.assertGreater(len(offers), 0, [each.text for each in what.options])
        what.select_by_visible_text(offers[0])
        form.find_element("css selector", "button.main").click()

    def look_at_its_page(self):
        page = self.browser
        self.open_robot()
        eventually(lambda: self.centimetres() > 10, "how far the box is", 60)
        heads = [head.text for head in page.find("asip-board h2") if head.is_displayed()]
        self.assertEqual(heads[:2], [self.t("controls"), self.t("values")])
        stop = page.button(self.t("stop-board", board=BOARD), ".title-row")
        self.assertGreater(stop.rect["height"], 1.3 * page.button(self.t("stop-all"), "header").rect["height"])
        self.assertLess(stop.rect["y"], page.shown(".controls-box form").rect["y"])
        self.assertEqual([each for each in page.find("asip-board asip-plot") if each.is_displayed()], [], "plots are folded")
        page.screenshot(f"robot-{self.language}")

    def drive_into_the_box_and_back(self):
        far = self.centimetres()
        self.assertEqual(self.value("bump"), self.t("off"))
        self.hold(FORWARDS, lambda: "bumped" in self.floor() and self.value("bump") == self.t("on"), "the bumper on the page")
        eventually(lambda: self.centimetres() < far, "the box is near")
        near = self.centimetres()
        self.hold(BACKWARDS, lambda: self.value("bump") == self.t("off") and self.centimetres() > near + 5, "the box is farther away")

    def stop_it(self, button, place, resume):
        """A press while it drives by itself; then it stands, and refuses, until it is resumed."""
        page = self.browser
        self.answered(self.keep_on(BACKWARDS), "ok", "")
        self.drives()
        page.button(self.t(button, board=BOARD), place).click()
        self.rests()
        eventually(lambda: self.t("stopped-who", who=self.t("machine")) in page.text(".stopped-note"), "who stopped it")
        self.answered(self.keep_on(BACKWARDS), "refused", self.texts["answer.refused.stopped"])
        self.rests()
        page.button(self.t(resume, board=BOARD), place).click()
        eventually(lambda: page.text(".stopped-note") == "", "it can be driven again")
        self.rests()

    def let_a_program_drive(self):
        file = self.bus.work / "drive.py"
        file.write_text(PROGRAM)
        environment = {key: value for key, value in os.environ.items() if not key.startswith("ASIP_")}
        environment |= {"ASIP_BROKER": f"127.0.0.1:{self.bus.broker_port}", "PYTHONPATH": str(ROOT / "python")}
        program = subprocess.Popen(["/usr/bin/python3", "-B", file], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=die_with_parent)
        self.addCleanup(program.kill)
        self.drives()
        eventually(lambda: "-80" in self.browser.text(".controls-box"), "the page shows what the program does", 60)
        self.browser.button(self.t("stop-board", board=BOARD), ".title-row").click()
        self.rests()
        said, told = program.communicate(timeout=60)
        self.assertRegex(said, r"\d")
        self.assertIn("refused (stopped): the board is stopped by", told)
        self.browser.button(self.t("resume-board", board=BOARD), ".title-row").click()
        self.hold(FORWARDS)
        self.history()
        eventually(lambda: "line-follower" in self.browser.text("details.history"), "the history names the program", 60)

    def pull_the_cable_while_it_drives(self):
        page = self.browser
        title = lambda: page.text(".title-row")
        self.keep_on(BACKWARDS)
        self.drives()
        self.bus.sim("unplug", BOARD)
        eventually(lambda: self.texts["state.lost"] in title() and self.texts["reason.unplugged"] in title(), "the cable is pulled", 60)
        eventually(lambda: page.text(".unusable") == self.t("commands-off-until"), "nothing can be sent")
        self.bus.sim("replug", BOARD)
        eventually(lambda: self.texts["state.online"] in title(), "the robot is back", 60)
        self.rests()
        self.hold(FORWARDS, lambda: self.centimetres() > 0, "its values are live again")

    def make_a_dashboard(self):
        """The robot's motors, distance, bumper and stop; the link for a phone."""
        page = self.browser
        for part, service, kind in (("values", "bump", "lamp"), ("controls", "motors", "value")):
            title = self.t("add-what", what=self.t("what-service", what=self.t(part), service=self.word(service)))
            page.shown(f"button[title='{title}']").click()
            form = page.shown(f"form[aria-label='{title}']")
            self.choose(form, service, kind)
            eventually(lambda: self.t("added") in form.text, f"{service} is on the dashboard")  # noqa: B023
        form.find_element("tag name", "a").click()
        page.button(self.t("edit")).click()
        page.button(self.t("add-stop")).click()
        page.shown(".kind-stop")
        page.button(self.t("done")).click()
        page.shown("asip-share summary").click()
        page.shown("asip-share input[type=checkbox]").click()
        page.button(self.t("make-share")).click()
        return page.shown(f"input[aria-label='{self.t('the-link')}']").get_property("value")

    def stop_it_from_the_phone(self, link):
        phone = Browser(f"--accept-lang={self.language}")
        self.addCleanup(phone.close)
        phone.size(390, 844, mobile=True)
        phone.driver.get(link)
        stop = phone.shown(".kind-stop button", seconds=60)
        self.assertEqual(len(phone.find("asip-widget")), 4)
        self.assertLessEqual(phone.run("return document.documentElement.scrollWidth"), 390)
        self.assertLessEqual(stop.rect["y"] + stop.rect["height"], 844, "the stop is in sight")
        self.open_robot()
        self.keep_on(BACKWARDS)
        self.drives()
        eventually(lambda: "-100" in phone.text(), "the phone shows the power of a motor", 60)
        phone.screenshot(f"phone-robot-dashboard-{self.language}")
        stop.click()
        self.rests()
        answer = phone.shown(".kind-stop .answer.ok")
        self.assertEqual(answer.text, f"{self.t('stopped')}.", "a link resumes nothing: its stop does not hold, and it says nothing else")
        self.hold(FORWARDS)


class RobotBuilderInGerman(RobotBuilder):
    language = "de"


if __name__ == "__main__":
    unittest.main()
