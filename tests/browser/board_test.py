# SPDX-License-Identifier: Apache-2.0
"""The page of one board: its values are live while it is seen, its order, its main buttons, and the names that people give."""

import contextlib
import json
import re
import threading
import time
import unittest
import urllib.request

from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

from rig import PageTest, eventually, paho_client


class Heard:
    """What is published on topics meanwhile: (topic, text, when)."""

    def __init__(self, bus, *topics):
        self.messages = []
        self.granted = threading.Event()
        self.client = paho_client()
        self.client.on_message = lambda _c, _d, message: self.messages.append((message.topic, message.payload.decode(errors="replace"), time.monotonic()))
        self.client.on_subscribe = lambda *_: self.granted.set()
        self.client.connect("127.0.0.1", bus.broker_port)
        self.client.subscribe([(topic, 0) for topic in topics])
        self.client.loop_start()

    def __enter__(self):
        if not self.granted.wait(20):
            raise AssertionError("no subscription")
        return self

    def __exit__(self, *_):
        self.client.disconnect()
        self.client.loop_stop()

    def silent_for(self, seconds):
        return time.monotonic() - (self.messages[-1][2] if self.messages else 0) > seconds

    def rate(self, seconds=2.0):
        """Messages a second of the last seconds."""
        now = time.monotonic()
        return sum(now - when < seconds for _, _, when in self.messages) / seconds


@contextlib.contextmanager
def published(bus, topic, text):
    """A retained message for the time of a test."""
    client = paho_client()
    client.connect("127.0.0.1", bus.broker_port)
    client.loop_start()
    client.publish(topic, text, qos=1, retain=True).wait_for_publish(20)
    try:
        yield client
    finally:
        client.publish(topic, "", qos=1, retain=True).wait_for_publish(20)
        client.disconnect()
        client.loop_stop()


class BoardPage(PageTest):
    def value(self):
        return self.browser.shown("[aria-label='Distance'] .value").text.replace("\u00a0", " ")

    def hide(self, hidden):
        self.browser.run("""Object.defineProperty(document, 'hidden', { value: arguments[0], configurable: true });
            document.dispatchEvent(new Event('visibilitychange'))""", hidden)

    def test_BoardSeen_ReportsUntilItIsLeft_HiddenOrShownAgain(self):
        with Heard(self.bus, "asip/desk/distance/out") as values:
            self.open("history")
            eventually(lambda: values.silent_for(2), "nobody looks, nothing is reported", 30)
            for _ in range(2):
                self.open_board()
                eventually(lambda: self.value() in ("41 cm", "42 cm", "43 cm"), "42 cm, without any period", 10)
                eventually(lambda: 4 < values.rate() < 14, "about ten a second")
                self.open("history")
                eventually(lambda: values.silent_for(2), "the end of the reports", 30)
            self.open_board()
            eventually(lambda: values.rate() > 4, "reports again")
            self.hide(True)
            eventually(lambda: values.silent_for(2), "the end of the reports of a page that nobody sees", 30)
            self.hide(False)
            eventually(lambda: values.rate() > 4, "reports to a page that is seen again")
            self.browser.run("const rate = document.querySelector('.rate select'); rate.value = '2'; rate.dispatchEvent(new Event('change'))")
            eventually(lambda: 0.4 < values.rate() < 3.2, "two a second", 30)
            self.browser.run("const rate = document.querySelector('.rate select'); rate.value = '10'; rate.dispatchEvent(new Event('change'))")

    def test_BoardPluggedIn_ItsFirstValueIsSeenSoonInAnOpenPage(self):
        self.open_board()
        self.value()
        self.bus.sim("unplug", "desk")
        eventually(lambda: self.bus.state("desk") == "lost", "desk lost", 30)
        self.bus.sim("set", "desk/distance", "77")
        self.bus.sim("replug", "desk")
        began = time.monotonic()
        eventually(lambda: self.value() in ("76 cm", "77 cm", "78 cm"), "its first value", 30)
        print(f"first value {time.monotonic() - began:.1f} s after the board was plugged in")
        self.bus.sim("set", "desk/distance", "42")

    def test_Order_IsValuesControlsPinsLinksAbout_AndTheRestIsUnderAdvanced(self):
        self.open_board()
        self.value()
        self.setter("Servo 0 angle")
        heads = [head.text for head in self.browser.find("asip-board h2") if head.is_displayed()]
        self.assertEqual(heads, ["Values", "Controls", "Pins", "Links", "About", "History"])
        self.assertEqual([each.text for each in self.browser.find("input[type=number]") if each.is_displayed() and "Period" in each.text], [])
        shown = self.browser.text("asip-board")
        for rare in ("proof", "ASIP 0.", "Agent", "Period", "bits"):
            self.assertNotIn(rare, shown)
        self.all_commands()
        shown = self.browser.text("asip-board")
        for rare in ("proof", "Last command", "Protocol", "Agent", "Period"):
            self.assertIn(rare, shown)
        self.browser.run("document.querySelectorAll('asip-board details').forEach((each) => { each.open = false; })")
        self.browser.screenshot("board-page")

    def test_RobotsPage_HasALargeStopAndItsMotorsFirst(self):
        rover = {"board": "rover2", "session": "5f3a9c01", "seq": 1, "lease": 600, "services": [
            {"name": "motors", "id": "M", "model": "motors@1", "count": 2}, {"name": "encoders", "id": "E", "model": "encoders@1", "count": 2}]}
        heads = lambda: [head.text for head in self.browser.find("asip-board h2") if head.is_displayed()][:2]
        height = lambda selector: self.browser.shown(selector).rect["height"]
        with published(self.bus, "asip/servicebus/rover2/$description", json.dumps(rover)), published(self.bus, "asip/servicebus/rover2/$state", "online"):
            self.open("board/rover2")
            eventually(lambda: heads() == ["Controls", "Values"], "motors before values")
            self.assertGreater(height(".title-row button.stop"), 1.3 * height("header button.stop"))
            large = self.browser.shown("header button.stop").size
        self.open_board()
        eventually(lambda: heads() == ["Values", "Controls"], "values before servos")
        self.assertGreater(height(".title-row button.stop"), height("header button.stop"))
        small = self.browser.shown("header button.stop").size
        self.assertTrue(large["height"] > small["height"] and large["width"] > 1.3 * small["width"], (large, small))

    def test_StopAll_IsOnEveryScreenAndStopsWithOnePress(self):
        for route in ("", "add", "board/desk", "dashboards", "dashboard/none", "history", "settings", "nowhere"):
            for width in (1280, 390):
                with self.subTest(route, width=width):
                    self.browser.size(width, 844, mobile=width == 390)
                    self.open(route)
                    self.browser.button("Stop all", "header").click()
                    eventually(lambda: self.bus.get("/api/boards/desk").get("reason") == "latched", "the stop")
                    self.browser.button("Resume all", "header").click()
                    eventually(lambda: self.bus.get("/api/boards/desk").get("reason") != "latched", "commands again")

    def test_PinMap_ShowsWhatIsInUse(self):
        self.open("board/desk")
        pins = lambda: [each.find_element(By.CLASS_NAME, "pin-name").get_property("textContent") for each in self.browser.find(".pin") if each.is_displayed()]
        eventually(lambda: set(pins()) >= {"Pin 7", "Pin 9"} and "Pin 0" not in pins() and "Pin A3" not in pins(), "pins in use")
        self.browser.button("All 20 pins").click()
        eventually(lambda: len(pins()) == 20, "all pins")

    def dashboard(self, name, document):
        def ask(method, body):
            request = urllib.request.Request(f"{self.bus.url}/api/dashboards/{name}", body, {"Content-Type": "application/json"}, method=method)
            urllib.request.urlopen(request, timeout=20).close()
        ask("PUT", json.dumps(document).encode())
        self.addCleanup(ask, "DELETE", b"{}")

    def test_NoWordOfTheWire_StandsOutsideAdvanced(self):
        send = lambda *words: self.bus.asipctl("send", *words)
        send("desk/io", "mode", "13", "3")
        send("desk/servo", "write", "7", "90")
        self.bus.post("/api/boards/desk/raw", {"lines": ["I,d,13,1"]})
        self.bus.post("/api/boards/desk/services/io/commands/mode", [13, 0])
        self.dashboard("lit", {"title": "Lit", "widgets": [{"kind": "lamp", "board": "lamp", "property": "io/12"}]})
        self.bus.post("/api/dashboards/lit/links", {})
        wire = re.compile(r"\b(io|loopback|complete|[A-Z]+_[A-Z_]+)\b|\b[A-Z],\w|[\[{]\S|\bmode \d|\blatched\b")
        for route, there in (("", "Pins, Distance"), ("board/desk", "Servo 0 angle"), ("history", "Set the mode of pin 13: no mode"), ("settings", "Gateway"), ("dashboards", "changed by this machine"),
                             ("dashboard/lit", "has no pin 12 now")):
            self.open(route, anew=True)
            if route == "history":
                self.every_command()
            eventually(lambda: there in self.browser.text(), f"{route}: {there}", 40)  # noqa: B023
            self.browser.run("document.querySelectorAll('asip-share details').forEach((each) => { each.open = true; })")
            eventually(lambda: not self.browser.find("asip-share") or "made by this machine" in self.browser.text(), "who shared it")
            shown = self.browser.run("""for (const each of document.querySelectorAll("main code")) each.hidden = true; // what is typed elsewhere
                const words = [document.querySelector("main").innerText];
                for (const each of document.querySelectorAll("main select")) words.push(...[...each.options].map((option) => option.text));
                return words.join("\\n");""")
            self.assertIsNone(wire.search(shown), f"{route}: {wire.search(shown)} in {shown}")
            if route == "board/desk":
                self.bus.post("/api/boards/desk/stop", {})
                self.addCleanup(self.bus.post, "/api/boards/desk/resume", {})
                eventually(lambda: "Stopped by this machine" in self.browser.text(), "who stopped it")
                self.bus.post("/api/boards/desk/resume", {})
        self.open("history", anew=True)
        self.every_command()
        for told in ("Set the mode of pin 13: output", "Servo 7 to 90°, by", "error, invalid device number", "Pin 13 on"):
            eventually(lambda: told in self.browser.text(), told)  # noqa: B023

    def test_SerialMonitor_ShowsTheLineBothWays_AndGoesOnBehindALentPort(self):
        page, bus = self.browser, self.bus
        self.open_board()
        page.run("document.querySelector('details.advanced').open = document.querySelector('details.monitor').open = true")
        text = lambda: page.text("asip-monitor pre")
        eventually(lambda: re.search(r"^\d\d:\d\d:\d\d\.\d{3} < @D,e,2,\{\d+,\d+\}", text(), re.M), "a report, readable", 60)
        self.assertEqual(bus.asipctl("send", "desk/servo", "write", "0", "33").returncode, 0)
        eventually(lambda: re.search(r"> S,W,0,33", text()), "the command", 60)
        self.assertNotIn("\\n", text())
        self.assertNotIn("$line", bus.asipctl("subscribe", "desk", "-n", "20").stdout, "it is no service of the board")
        page.screenshot("serial-monitor")
        page.run("document.querySelector('asip-monitor input').click()")
        eventually(lambda: re.search(r"> .*S,W,0,33(\*[0-9A-F]{2})?\\n", text()), "the bytes as they went", 60)
        page.run("document.querySelector('asip-monitor input').click()")
        self.assertEqual(bus.asipctl("release", "desk", "--for", "5m").returncode, 0)
        eventually(lambda: "updating" in page.text(".title-row"), "the port is lent", 60)
        page.button("Clear", "asip-monitor").click()
        eventually(lambda: text() == "", "nothing goes over the line")
        self.assertEqual(bus.asipctl("release", "desk", "--back").returncode, 0)
        eventually(lambda: "> #,?" in text() and "< @D,e," in text(), "the board is asked, and reports again", 60)
        # The monitor is closed: the agent tells nothing more.
        with Heard(bus, "asip/desk/$line/out") as told:
            eventually(lambda: told.messages, "it is told", 60)
            page.run("document.querySelector('details.monitor').open = false")
            eventually(lambda: told.silent_for(3), "it is told no more", 60)

    def test_AnalogInputThatNothingSaysIsConnected_IsNoValue(self):
        self.bus.asipctl("send", "lamp/io", "mode", "14", "analog")
        self.addCleanup(self.bus.asipctl, "send", "lamp/io", "mode", "14", "input")
        self.addCleanup(self.bus.post, "/api/boards/lamp/labels", {"names": {"pins": {"14": None}}})
        stands = lambda: self.bus.get("/api/boards/lamp/values")["values"].get("io/14", {}).get("value")
        eventually(lambda: stands() is not None, "the board reports it")
        self.open("?value=io", anew=True)
        self.open("board/lamp")
        pin = lambda: self.browser.shown(".pin[title^='Pin A0']")
        eventually(lambda: "free, analog" in pin().get_attribute("title"), "the pin is there")
        self.assertEqual((pin().find_element(By.CLASS_NAME, "pin-text").text, self.browser.find(".values-box .number")), ("A in", []))
        self.bus.post("/api/boards/lamp/labels", {"names": {"pins": {"14": "Soil"}}})
        eventually(lambda: [each.text for each in self.browser.find(".values-box .number .muted")] == ["Soil"], "with a name it is a value")
        eventually(lambda: pin().find_element(By.CLASS_NAME, "pin-text").text.isdigit(), "and on its pin")

    def test_MainButton_IsHoldToRunForMotorsAndSetForLampsAndServos(self):
        rover = {"board": "rover", "session": "5f3a9c01", "seq": 1, "lease": 600, "firmware": {"protocol": "0.4", "chip": "ATmega2560"},
                 "services": [{"name": "motors", "id": "M", "model": "motors@1", "count": 2}, {"name": "pixels", "id": "P", "model": "pixels@1"}]}
        with published(self.bus, "asip/servicebus/rover/$description", json.dumps(rover)) as client:
            client.publish("asip/servicebus/rover/$state", "online", qos=1, retain=True).wait_for_publish(20)
            self.open("board/rover")
            main = lambda form: form.find_element(By.CSS_SELECTOR, "button.main").text
            self.assertEqual(main(self.form("motors", "Set the power of the first two motors at once")), "Hold to run")
            self.assertEqual(main(self.form("motors", "Set the power of one motor")), "Hold to run")
            self.assertEqual(main(self.form("motors", "Stop every motor")), "Stop every motor")
            self.assertEqual(main(self.form("pixels", "Set the brightness of the strip")), "Set the brightness")
            stop = self.form("motors", "Stop one motor")
            self.assertEqual(main(stop), "Stop motor 0")
            Select(self.number(stop, "Motor")).select_by_value("1")
            self.assertEqual(main(stop), "Stop motor 1")
            client.publish("asip/servicebus/rover/$state", "", qos=1, retain=True).wait_for_publish(20)
        self.open_board()
        self.assertEqual(main(self.form("servo", "Turn a servo to an angle")), "Turn servo 0")
        self.all_commands()
        self.assertEqual(main(self.form("io", "Set the level of an output pin")), "Set the level")

    def test_ValuesOfSeveralUnits_HaveAPlotAndAnAxisEach(self):
        meter = {"board": "meter", "session": "5f3a9c01", "seq": 1, "lease": 600, "services": [{"name": "pressure", "id": "B", "model": "pressure@1"}]}
        with published(self.bus, "asip/servicebus/meter/$description", json.dumps(meter)) as client, published(self.bus, "asip/servicebus/meter/$state", "online"):
            self.open("board/meter")
            plots = lambda: self.browser.run("return [...document.querySelectorAll('asip-plot canvas')].map((each) => each.getAttribute('aria-label'))")

            def drawn():
                value = {"pressure": {"pressure": 1013, "temperature": 21, "altitude": 90}}
                client.publish("asip/meter/pressure/out", json.dumps(value)).wait_for_publish(20)
                return len(plots()) == 3 and all("Nothing yet" not in each for each in plots())

            eventually(drawn, "three plots")
            units = [[unit for unit in ("hPa", "C", "m") if each.endswith(f"\u00a0{unit}")] for each in plots()]
            self.assertEqual(sorted(units), [["C"], ["hPa"], ["m"]])

    def test_NamesAndLabels_AreGivenInThePageAndStandEverywhere(self):
        self.open_board()
        self.browser.shown("asip-names summary").click()
        form = self.browser.shown("form[aria-label='Names and labels']")
        field = lambda name: form.find_element(By.ID, next(label for label in form.find_elements(By.TAG_NAME, "label") if label.text.startswith(name)).get_attribute("for"))
        field("Name of this board").send_keys("left desk")
        field("Name of Servo").send_keys("arm")
        field("Labels").send_keys("room=lab, camera")
        form.find_element(By.CSS_SELECTOR, "button.main").click()
        eventually(lambda: "Kept" in form.text, "the agent's word")
        eventually(lambda: self.browser.text("h1") == "left desk desk", "the name in the heading")
        headings = lambda: " ".join(each.text for each in self.browser.find(".controls-box h3"))
        widths = lambda: [each.rect["width"] for each in self.browser.find(".controls-box .card") if each.is_displayed()]
        eventually(lambda: widths()[0] > 1.5 * widths()[-1] or len(widths()) == 1 and widths()[0] > 900, "what has a name is large")
        eventually(lambda: "arm" in headings(), "the name of the service")
        self.browser.shown(".pin[title^='Pin 13']").click()
        name = self.browser.shown("form[aria-label='Name of pin 13'] input")
        name.send_keys("status lamp")
        self.browser.button("Save", "form[aria-label='Name of pin 13']").click()
        eventually(lambda: "status lamp" in self.browser.text(".pin[title^='Pin 13']"), "the name on the pin")
        self.assertIn("room=lab", self.browser.text("dl.facts"))
        self.browser.size(360, 740, mobile=True)
        eventually(lambda: "status lamp" in self.browser.text(".pin[title^='Pin 13']"), "the name on the pin of a phone")
        called = self.browser.shown(".pin[title^='Pin 13'] .pin-called")
        self.assertLessEqual(called.get_property("scrollWidth"), called.get_property("clientWidth"), "none of it is cut")
        self.assertLessEqual(called.get_property("scrollHeight"), called.get_property("clientHeight") + 1)
        self.browser.screenshot("phone-pin-names")
        self.browser.desktop()
        self.open()
        eventually(lambda: "desk" in self.browser.table().get("left desk", ""), "the name in the list")
        self.assertIn("room=lab", self.browser.table()["left desk"])
        self.bus.end("agent-desk")
        self.bus.start_agent("desk")
        eventually(lambda: self.bus.state("desk") == "online", "desk again", 30)
        self.open_board(anew=True)
        eventually(lambda: self.browser.text("h1") == "left desk desk", "kept by the agent")
        self.browser.shown("asip-names summary").click()
        form = self.browser.shown("form[aria-label='Names and labels']")
        for name in ("Name of this board", "Name of Servo", "Labels"):
            self.browser.run("arguments[0].value = ''", field(name))
        form.find_element(By.CSS_SELECTOR, "button.main").click()
        eventually(lambda: self.browser.text("h1") == "desk", "the name is gone")
        eventually(lambda: "arm" not in headings(), "that of the service, too")

    def test_NameThatCannotBe_IsRefusedWithTheReason(self):
        self.open_board("lamp")
        self.expected_errors = ("/api/boards/lamp/labels",)
        self.browser.shown("asip-names summary").click()
        form = self.browser.shown("form[aria-label='Names and labels']")
        form.find_elements(By.TAG_NAME, "input")[-1].send_keys("-room=lab")
        form.find_element(By.CSS_SELECTOR, "button.main").click()
        eventually(lambda: "refused" in form.find_element(By.TAG_NAME, "output").get_attribute("class") and "-room" in form.text, "the agent's reason")
        self.assertNotIn("room=lab", self.browser.text("dl.facts"))


if __name__ == "__main__":
    unittest.main()
