# SPDX-License-Identifier: Apache-2.0
"""Dashboards as a person makes, uses and shares them: from the page of a board, in two browsers, by a link on a third."""

import contextlib
import json
import pathlib
import time
import unittest
import urllib.error
import urllib.request

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

from board_test import published
from rig import BUILD, Browser, PageTest, eventually

AXE = pathlib.Path(BUILD, "axe-core/node_modules/axe-core/axe.min.js")
GREENHOUSE = {"title": "Greenhouse", "widgets": [
    {"id": "far", "kind": "value", "title": "Distance", "board": "desk", "property": "distance/0"},
    {"id": "line", "kind": "plot", "title": "Distance, plot", "size": "wide", "board": "desk", "property": "distance/0"},
    {"id": "lit", "kind": "switch", "title": "Lamp", "board": "lamp", "property": "io/13"},
    {"id": "turn", "kind": "slider", "title": "Vent", "board": "desk", "property": "servo/0/angle"},
    {"id": "seen", "kind": "lamp", "title": "Lamp is lit", "board": "lamp", "property": "io/13"},
    {"id": "halt", "kind": "stop", "title": "Stop"}]}
WHOLE = dict(GREENHOUSE, widgets=GREENHOUSE["widgets"] + [
    {"kind": "gauge", "title": "Room", "board": "desk", "property": "distance/0"}, {"kind": "text", "title": "Rules", "text": "Water by noon."}])


class Dashboards(PageTest):
    expected_errors = ("status of 404", "response code: 404", "status of 401", "response code: 401", "status of 412")

    def ask(self, method, path, body=None, **headers):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.bus.url + path, data, {"Content-Type": "application/json", **headers}, method=method)
        with urllib.request.urlopen(request, timeout=20) as answer:
            text = answer.read()
            return json.loads(text) if text else None

    def make(self, name, dashboard):
        """Made anew, with what it was before gone."""
        self.ask("PUT", f"/api/dashboards/{name}", dashboard, **{"If-Match": "*"})
        self.addCleanup(self.ask, "DELETE", f"/api/dashboards/{name}")

    def another_browser(self):
        other = Browser()
        self.addCleanup(other.close)
        return other

    def widget(self, title, browser=None, seconds=20):
        return (browser or self.browser).shown(f"asip-widget:is([aria-label='{title}'], [aria-label^='{title}, '])", seconds=seconds)

    def titles(self, browser=None):
        return [each.get_attribute("aria-label") for each in (browser or self.browser).find("asip-widget")]

    def shows(self, title, text, browser=None):
        eventually(lambda: text in self.widget(title, browser).text, f"{title} shows {text}")

    def output(self, pin, board="lamp"):
        self.ask("POST", f"/api/boards/{board}/services/io/commands/mode", [pin, "output"])

    def slide(self, title, value, browser=None):
        browser = browser or self.browser
        slider = self.widget(title, browser).find_element("css selector", "input")
        browser.run("arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input')); arguments[0].dispatchEvent(new Event('change'));", slider, value)

    def press(self, label, browser=None):
        """A button that is there anew after each change of what it stands beside."""
        browser = browser or self.browser

        def press():
            button = browser.shown(f"button[aria-label='{label}']")
            browser.run("arguments[0].scrollIntoView({ block: 'center' })", button)
            button.click()
            return True
        eventually(press, f"a press of {label}")

    def add(self, what, offer, title=None):
        """From the page of a board."""
        box = self.browser.shown(f"button[title='Add {what} to a dashboard']")
        if box.get_attribute("aria-expanded") == "false":
            box.click()
        form = self.browser.shown(f"form[aria-label='Add {what} to a dashboard']")
        selects = [Select(each) for each in form.find_elements("tag name", "select")]
        selects[0].select_by_visible_text(offer)
        if title:
            selects[1].select_by_visible_text("A new dashboard")
            box = form.find_element("css selector", "input[type=text]")
            self.assertEqual(box.get_property("value"), "desk", "a title that it can have")
            box.clear()
            box.send_keys(title)
        form.find_element("css selector", "button.main").click()
        eventually(lambda: "Added." in form.text, f"{offer} is added: {form.text}")

    def test_FromTheBoardsPage_ADashboardIsMadeUsedAndReloaded(self):
        self.addCleanup(self.ask, "DELETE", "/api/dashboards/class-room")
        self.open_board("desk")
        self.add("Values of Distance", "Distance 0 (cm): value", "Class room!")
        self.add("Values of Distance", "Distance 0 (cm): plot")
        self.add("Controls of Servo", "Servo 0 angle (\u00b0): slider")
        self.output(13)
        self.open_board("lamp")
        self.browser.shown(".pin[title^='Pin 13:']").click()
        eventually(lambda: "output" in self.browser.text(".pin-panel"), "the mode of pin 13")
        self.add("pin 13", "Pin 13: switch")
        self.add("pin 13", "Pin 13: lamp")
        self.open("dashboard/class-room")
        self.browser.button("Edit").click()
        self.browser.button("Add a stop").click()
        self.widget("Stop")
        self.open("dashboard/class-room", anew=True)
        for title in ("Distance 0", "Servo 0 angle", "Pin 13", "Stop"):
            self.widget(title)
        self.assertEqual(len(self.browser.find("asip-widget")), 6)
        self.assertIn("Class room!", self.browser.text("h1"))
        self.bus.sim("set", "desk/distance", "77")
        self.shows("Distance 0", "77")
        self.slide("Servo 0 angle", 135)
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 135) < 2, "the servo at 135 degrees")
        self.browser.shown(".kind-switch .toggle").click()
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "the lamp is lit")
        self.browser.shown(".toggle[aria-checked='true']")
        self.browser.shown(".bulb.on")
        self.browser.shown(".kind-stop button").click()
        self.shows("Stop", "Stopped. Commands are refused until it is resumed.")
        eventually(lambda: self.bus.part("lamp/lamp") == "off", "the lamp is off")
        self.shows("Servo 0 angle", "is stopped until it is resumed")
        self.assertTrue(self.browser.shown(".toggle").get_property("disabled"))
        self.browser.button("Resume all").click()
        eventually(lambda: not self.browser.shown(".toggle").get_property("disabled"), "the switch works again")

    def test_TwoEditors_SeeEachOtherAndOverwriteNothing(self):
        self.make("greenhouse", GREENHOUSE)
        other = self.another_browser()
        other.driver.get(f"{self.bus.url}/#/dashboard/greenhouse")
        self.widget("Vent", other)
        self.open("dashboard/greenhouse")
        self.browser.button("Edit").click()
        self.widget("Vent").find_element("css selector", ".grip").send_keys(Keys.ARROW_UP)
        eventually(lambda: self.titles(other)[2] == "Vent, desk", "the other browser sees the new order")
        # Another user changes it between what this editor has read and what it sends.
        stale = self.ask("GET", "/api/dashboards/greenhouse")
        self.browser.run("const page = document.querySelector('asip-dashboard'); page.unfollow();")
        self.ask("PUT", "/api/dashboards/greenhouse", {"title": "Winter garden", "widgets": stale["widgets"]}, **{"If-Match": "*"})
        self.press("Remove Vent")
        eventually(lambda: "another user changed it" in self.browser.text(".dashboard-editor"), "the conflict is named")
        self.assertEqual(len(self.ask("GET", "/api/dashboards/greenhouse")["widgets"]), 6)
        eventually(lambda: "Winter garden" in other.text("h1"), "the other browser sees the new title")

    def test_Tiles_AreDraggedByMouseAndFingerMovedByKeysAndDuplicated(self):
        self.make("greenhouse", GREENHOUSE)
        self.open("dashboard/greenhouse")
        self.shows("Distance", "cm")
        self.assertEqual([each for each in self.browser.find(".grip") if each.is_displayed()], [], "only while it is edited")
        self.browser.button("Edit").click()
        grip = lambda name: self.browser.shown(f"asip-widget[aria-label='{name}'] .grip")
        ActionChains(self.browser.driver).drag_and_drop(grip("Vent, desk"), self.widget("Distance")).perform()
        eventually(lambda: self.titles()[:2] == ["Vent, desk", "Distance, desk"], "dragged by the mouse")
        eventually(lambda: "cm" in self.widget("Distance").text and len(self.widget("Distance").find_elements("tag name", "h2")) == 1, "each is whole")
        places = [self.browser.run("const { x, y, width, height } = arguments[0].getBoundingClientRect(); return { x: x + width / 2, y: y + height / 2 }", each)
                  for each in (grip("Vent, desk"), self.widget("Distance"))]
        touch = lambda kind, *points: self.browser.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": list(points)})
        touch("touchStart", places[0])
        touch("touchMove", places[1])
        touch("touchEnd")
        eventually(lambda: self.titles()[:2] == ["Distance, desk", "Vent, desk"], "dragged by a finger")
        grip("Stop").send_keys(Keys.ARROW_LEFT)
        eventually(lambda: self.titles()[-2:] == ["Stop", "Lamp is lit, lamp"], "moved by a key")
        eventually(lambda: self.browser.run("return document.activeElement.textContent").endswith("Move Stop"), "and can be moved on")
        self.press("Duplicate Vent")
        eventually(lambda: self.titles().count("Vent, desk") == 2, "twice")
        widgets = self.ask("GET", "/api/dashboards/greenhouse")["widgets"]
        self.assertEqual([each["title"] for each in widgets], ["Distance", "Vent", "Vent", "Distance, plot", "Lamp", "Stop", "Lamp is lit"])
        self.browser.button("Add a text").click()
        # The tiles are made anew where the document comes back.
        eventually(lambda: len(self.ask("GET", "/api/dashboards/greenhouse")["widgets"]) == 8, "the text is kept")
        eventually(lambda: self.browser.shown("textarea").send_keys(Keys.CONTROL, "a") is None, "its field")
        self.browser.shown("textarea").send_keys("Water by noon.", Keys.TAB)
        eventually(lambda: "Water by noon." in self.browser.text(".dashboard-grid"), "the text")

    def test_TenPupils_ThreeWidgetsEachInOneMinute(self):
        names = [f"pupil-{number}" for number in range(1, 11)]
        services = [{"name": "distance", "id": "D", "model": "distance@1", "count": 1}, {"name": "servo", "id": "S", "model": "servo@1", "count": 1}]
        with contextlib.ExitStack() as there:
            for name in names:
                board = {"board": name, "session": "5f3a9c01", "seq": 1, "lease": 600, "labels": {"class": "4b", "name": f"{name} of 4b"}, "services": services}
                client = there.enter_context(published(self.bus, f"asip/servicebus/{name}/$description", json.dumps(board)))
                there.enter_context(published(self.bus, f"asip/servicebus/{name}/$state", "online"))
            self.make("four-b", {"title": "4b", "widgets": []})
            self.open("dashboard/four-b")
            eventually(lambda: len([name for name in names if self.bus.state(name) == "online"]) == 10, "ten boards")
            began = time.monotonic()
            self.browser.button("Edit").click()
            for kind, tiles in (("value", 10), ("gauge", 20), ("slider", 30)):
                board, offer = [Select(each) for each in self.browser.find(".adder select")]
                board.select_by_visible_text("class=4b")
                what = eventually(lambda: next((each.text for each in offer.options if each.text.endswith(f": {kind}")), None), f"a {kind}")
                offer.select_by_visible_text(what)
                self.browser.button("Add").click()
                eventually(lambda: len(self.titles()) == tiles, f"{tiles} tiles", 30)
            took = time.monotonic() - began
            print(f"three widgets of ten pupils took {took:.1f} s and 10 presses")
            self.assertLess(took, 60)
            self.browser.button("Done").click()
            self.widget("Distance, pupil-7 of 4b")
            self.assertIn("pupil-7 of 4b", self.browser.shown(".kind-slider[aria-label$=', pupil-7 of 4b']").text)
            client.publish("asip/pupil-10/distance/out", '{"distance":[300]}').wait_for_publish(20)
            gauge = self.browser.shown("asip-widget.kind-gauge[aria-label='Distance, pupil-10 of 4b']")
            eventually(lambda: "300" in gauge.text and "0 cm to 400 cm" in gauge.text.replace("\u00a0", " "), "the gauge")
            self.assertEqual(gauge.find_element("css selector", ".gauge-part").get_attribute("stroke-dasharray"), "75 200")
            self.browser.size(1280, 2000)
            self.browser.screenshot("dashboard-pupils")
            self.browser.size(390, 844, mobile=True)
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 390)
            self.browser.screenshot("phone-dashboard-pupils")

    def test_KioskLink_ShowsTheDashboardAndNothingElse(self):
        self.make("greenhouse", GREENHOUSE)
        self.output(13)
        self.open("dashboard/greenhouse")
        eventually(lambda: self.browser.find("asip-share summary"), "Share")[0].click()
        self.browser.shown("asip-share input[type=checkbox]").click()
        self.browser.button("Make a link").click()
        address = self.browser.shown("input[aria-label='The link']").get_property("value")
        hall = self.another_browser()
        hall.driver.get(address)
        self.shows("Distance", "cm", hall)
        self.assertEqual([each.text for each in hall.find("nav a, button.stop") if each.is_displayed()], ["Stop"])
        self.assertFalse(hall.find("header")[0].is_displayed())
        hall.driver.get(f"{address}#/board/desk")
        self.widget("Vent", hall)
        self.assertEqual(hall.find("asip-board, asip-boards"), [])
        hall.shown(".toggle").click()
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "the lamp is lit by the link")
        hall.screenshot("dashboard-kiosk")
        for path in ("boards", "boards/desk", "history", "services", "models", "dashboards", "events"):
            self.assertEqual(status_of(f"{address}api/{path}"), 403, path)
        self.press("End " + self.browser.shown("asip-share .link-list span").text)
        eventually(lambda: "This link is not valid any more" in hall.text("main"), "the link is over", 40)
        self.assertEqual(hall.find("asip-widget"), [])

    def test_BrokerAndGatewayRestart_TheDashboardIsThere(self):
        self.make("greenhouse", GREENHOUSE)
        self.open("dashboard/greenhouse")
        self.shows("Distance", "cm")
        self.bus.end("broker")  # which keeps nothing on its disk
        self.bus.start_broker()
        eventually(lambda: self.bus.get("/readyz"), "the gateway", 60)
        eventually(lambda: self.bus.state("desk") == "online", "desk", 60)
        self.bus.end("gateway")
        self.bus.start_gateway()
        eventually(lambda: len(self.bus.get("/api/dashboards/greenhouse")["widgets"]) == 6, "the dashboard")
        eventually(lambda: self.bus.state("desk") == "online", "desk", 60)
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 40)
        self.shows("Distance", "cm")
        self.browser.driver.get_log("browser")  # of the time without a gateway

    def test_BoardThatIsLost_IsNamedAndItsControlsAreOff(self):
        self.make("greenhouse", GREENHOUSE)
        self.open("dashboard/greenhouse")
        self.widget("Vent")
        self.bus.end("agent-desk")
        self.shows("Vent", "Board desk is")
        self.assertTrue(self.widget("Vent").find_element("tag name", "input").get_property("disabled"))
        self.bus.start_agent("desk")
        eventually(lambda: self.bus.state("desk") == "online", "desk", 60)
        eventually(lambda: "Board desk is" not in self.widget("Vent").text, "it works again")
        unknown = dict(GREENHOUSE, widgets=[dict(GREENHOUSE["widgets"][0], board="attic")])
        self.ask("PUT", "/api/dashboards/greenhouse", unknown, **{"If-Match": "*"})
        self.shows("Distance", "Board attic is not known. It may have been forgotten.")

    def faults(self, **rules):
        found = self.browser.driver.execute_async_script(
            "const [rules, done] = arguments; axe.run({ resultTypes: ['violations'], ...rules }).then((result) => done(result.violations))", rules)
        return [f"{each['id']}: {each['nodes'][0]['html'][:160]}" for each in found]

    def test_LightDarkAndPhone_NoFaultAndNothingHidden(self):
        self.make("greenhouse", WHOLE)
        self.open("dashboards", anew=True)
        self.browser.run(AXE.read_text())
        eventually(lambda: "Greenhouse" in self.browser.text(), "the list")
        self.assertEqual(self.faults(), [])
        self.open("dashboard/greenhouse")
        self.shows("Distance", "cm")
        for editing in (False, True):
            if editing:
                self.browser.button("Edit").click()
                self.browser.run("document.querySelector('asip-share details').open = true;")
            for scheme in ("light", "dark"):
                self.browser.color_scheme(scheme)
                eventually(lambda: self.browser.run("return document.getAnimations().length === 0"), "the colors in place")
                self.assertEqual(self.faults(), [], scheme)
                self.browser.screenshot(f"dashboard-{'editor-' if editing else ''}{scheme}")
        self.browser.color_scheme("light")
        self.browser.size(390, 844, mobile=True)
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 390)
        self.browser.screenshot("phone-dashboard-editor")
        self.browser.button("Done").click()
        self.browser.run("document.querySelector('asip-share details').open = false;")
        self.browser.screenshot("phone-dashboard")
        self.browser.size(1920, 1080)
        self.browser.run("location.hash = '#/dashboard/greenhouse?full'")
        eventually(lambda: not self.browser.find("nav")[0].is_displayed(), "nothing but the dashboard")
        self.assertTrue(self.browser.button("Stop all", "header").is_displayed(), "and the stop")
        self.shows("Distance", "cm")
        self.browser.screenshot("dashboard-full")


def status_of(address):
    try:
        with urllib.request.urlopen(address, timeout=10) as answer:
            return answer.status
    except urllib.error.HTTPError as refused:
        return refused.code


if __name__ == "__main__":
    unittest.main()
