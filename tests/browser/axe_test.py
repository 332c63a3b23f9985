# SPDX-License-Identifier: Apache-2.0
"""Every screen under axe-core: on a desk or on a phone of 390 px, light or dark, with all that can be unfolded in it. With ASIP_EVERY_VIEW each
in every of these ways, otherwise one after the other in the next of them."""

import contextlib
import itertools
import json
import os
import pathlib
import subprocess
import unittest
import urllib.request

from board_test import published
from cable_test import LendingBus
from dashboard_test import WHOLE
from rig import BIN, BUILD, PageTest, eventually, settings_file

AXE = pathlib.Path(BUILD, "axe-core/node_modules/axe-core/axe.min.js")
VIEWS = (("desk", "light"), ("phone", "light"), ("phone", "dark"))
NEXT = itertools.repeat(VIEWS) if os.environ.get("ASIP_EVERY_VIEW") else itertools.cycle((view,) for view in VIEWS)


class Axe(PageTest):
    expected_errors = ("status of 401", "status of 404", "status of 503", "response code: 40", "ERR_CONNECTION_REFUSED", "WebSocket")

    def start(self, address=""):
        """The page anew, with axe in it."""
        self.browser.driver.get("about:blank")
        self.browser.driver.get(f"{self.bus.url}/{address}")
        self.browser.run(AXE.read_text())

    def go(self, route, there):
        self.browser.run("location.hash = '#/left'; location.hash = arguments[0]", f"#/{route}")
        self.browser.shown(there)

    def unfold(self):
        self.browser.run("document.querySelectorAll('main details').forEach((each) => { each.open = true; })")
        eventually(lambda: "Looking …" not in self.browser.text(), "what is looked for")

    def check(self, name):
        """Nothing is found, and nothing is wider than the phone, or cut."""
        for device, scheme in next(NEXT):
            self.browser.size(390, 844, mobile=True) if device == "phone" else self.browser.desktop()
            self.browser.color_scheme(scheme)
            eventually(lambda: self.browser.run("return document.getAnimations().length === 0"), "the colors in place")
            found = self.browser.driver.execute_async_script("""const [done] = arguments;
                axe.run({ resultTypes: ['violations'], rules: { 'label-content-name-mismatch': { enabled: true } } }).then(
                    (result) => done(result.violations.map((each) => `${each.id}: ${each.nodes[0].html.slice(0, 160)}`)), (error) => done([String(error)]));""")
            self.assertEqual(found, [], f"{name}, {device}, {scheme}")
            self.assertEqual(self.cut(), [], f"{name}, {device}")
            if device == "phone":
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 390, name)
                self.assertTrue(all(each.rect["height"] == 48 for each in self.browser.find("header") if each.is_displayed()), f"{name}: the header has one line")
            self.browser.screenshot(f"axe-{name}-{device}-{scheme}")
        self.browser.color_scheme("light")
        self.browser.desktop()

    def cut(self):
        """Buttons, links and headings, states and uses of pins, of which a part is not seen."""
        return self.browser.run("""return [...document.querySelectorAll("button, a, h1, h2, h3, summary, label, dt, .c-state, .pin-text")].filter((each) => each.offsetParent && (!each.closest(".hidden, .pin, .row") || each.matches(".c-state, .few .pin-text")))
            .filter((each) => each.scrollWidth > each.clientWidth + 1 && getComputedStyle(each).display !== "inline").map((each) => each.outerHTML.slice(0, 120))""")


class Screens(Axe):
    def test_Boards_AndWhatIsDoneWithThem(self):
        bare = {"board": "usb-9", "session": "5f3a9c01", "seq": 1, "lease": 600, "services": [], "state": {"is": "lost", "reason": "silent"}}
        with contextlib.ExitStack() as more:
            more.enter_context(published(self.bus, "asip/servicebus/usb-9/$description", json.dumps(bare)))
            for name, state in (("usb-9", "lost"), ("gone", "lost"), ("asleep", "sleeping")):
                more.enter_context(published(self.bus, f"asip/servicebus/{name}/$state", state))
            self.start()
            eventually(lambda: "1 board lost" in self.browser.text(".attention") and "without ASIP" in self.browser.text(".attention"), "what is to be looked after", 30)
            self.browser.run("document.querySelector('.c-pick input').click()")
            self.browser.button("Send …", "asip-selection").click()
            self.browser.shown("asip-selection form")
            self.check("boards")
            self.browser.button("Label …", "asip-selection").click()
            self.check("boards-label")
            self.browser.button("Clear", "asip-selection").click()
            self.go("add", ".add-board .link-list button")
            self.unfold()
            self.check("add-find")
            self.browser.button("Load usb-9", ".add-board").click()
            self.browser.shown(".loading-log li")
            self.check("add-load")
            self.go("add/desk", "form[aria-label='Name and place']")
            self.check("add-name")
            self.browser.button("Save", ".add-board").click()
            self.browser.shown(".add-board asip-add-widget form")
            self.check("add-show")
            self.go("board/gone", "asip-board .title-row button")
            self.browser.button("Forget this board").click()
            self.check("board-lost")

    def test_ABoard_WithEverythingOpen(self):
        self.start()
        self.go("board/desk", ".setters [aria-label='Servo 0 angle']")
        self.all_pins()
        self.browser.shown(".pin:not(.taken)").click()
        for each in self.browser.find("asip-add-widget > button"):
            if each.is_displayed():
                self.browser.run("arguments[0].click()", each)
        self.unfold()
        eventually(lambda: self.browser.find("asip-history tbody tr"), "its history")
        self.check("board")

    def test_Dashboards_AndTheirEditor(self):
        self.browser.driver.get("about:blank")
        self.put_dashboard()
        self.start()
        self.go("dashboards", ".dashboard-list a")
        self.check("dashboards")
        self.go("dashboard/greenhouse", ".kind-gauge")
        self.check("dashboard")
        self.browser.button("Edit").click()
        self.browser.shown(".widget-list li")
        self.unfold()
        self.browser.button("Make a link").click()
        link = self.browser.shown("input[aria-label='The link']").get_property("value")
        self.check("dashboard-editor")
        self.start(link.removeprefix(f"{self.bus.url}/"))
        self.browser.shown(".kind-gauge")
        self.check("kiosk")
        ended = urllib.request.Request(f"{self.bus.url}/api/dashboards/greenhouse/links/{self.bus.get('/api/dashboards/greenhouse')['links'][0]['name']}",
                                       b"{}", {"Content-Type": "application/json"}, method="DELETE")
        urllib.request.urlopen(ended, timeout=20).close()
        eventually(lambda: "not valid any more" in self.browser.text(), "the sentence")
        self.check("link-over")

    def put_dashboard(self):
        request = urllib.request.Request(f"{self.bus.url}/api/dashboards/greenhouse", json.dumps(WHOLE).encode(), {"Content-Type": "application/json"}, method="PUT")
        urllib.request.urlopen(request, timeout=20).close()

    def test_AClass_AndTheWayIn(self):
        self.start()
        self.go("class", "form.open-lesson")
        self.check("class-none")
        self.browser.button("Open the lesson").click()
        code = self.browser.shown("p.class-code").text
        self.browser.shown("button[aria-label='Take over lamp']")
        self.check("class")
        self.go(f"join/{code}", "input.class-code")
        self.check("class-join")
        self.browser.button("Join").click()
        eventually(lambda: "You are" in self.browser.text("asip-pupil"), "the pupil", 30)
        self.browser.shown("asip-board .title-row")
        self.browser.run(AXE.read_text())
        self.check("class-pupil")
        for each in self.browser.driver.get_cookies():
            self.browser.driver.add_cookie({**each, "value": "lesson.over"})
        self.start()
        self.browser.button("Leave the lesson")
        self.check("class-over")
        self.browser.button("Leave the lesson").click()
        eventually(lambda: self.bus.get("/api/lessons") and self.browser.text("asip-link") == "live", "the teacher again", 30)

    def test_History_Settings_AndWhatIsNotThere(self):
        self.bus.asipctl("send", "desk/servo", "write", "7", "90")
        self.start()
        self.go("history", "asip-history tbody tr")
        self.check("history")
        self.go("settings", "asip-exports .card")
        eventually(lambda: "Registry first" in self.browser.text(), "the registry")
        self.unfold()
        self.check("settings")
        self.go("nowhere", "main h1")
        self.check("unknown")


class Empty(Axe):
    boards = ()

    def test_EmptySystem_AndSigningIn(self):
        self.start()
        self.browser.shown(".empty .button")
        self.check("empty")
        self.go("add", ".add-board details[open]")
        self.check("empty-add")
        for route, there in (("dashboards", "form[aria-label='New dashboard']"), ("history", "asip-history"), ("settings", "asip-exports .card")):
            self.go(route, there)
            self.check(f"empty-{route}")
        tokens = self.bus.work / "tokens"
        subprocess.run([BIN / "asip-gateway", "token", "viewer", "anna", "--tokens", tokens], check=True, capture_output=True)
        self.bus.end("gateway")
        self.bus.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.bus.http_port}", "--config", settings_file(f"tokens = {tokens}\n"))
        eventually(lambda: self.bus.get("/readyz"), "the gateway")
        self.start()
        self.browser.shown("#token", seconds=40)
        self.check("sign-in")


class Lending(Axe):
    @classmethod
    def make_bus(cls):
        return LendingBus()

    def test_BoardInThisComputer_AsATeacherAndAsAPupil(self):
        self.start()
        self.go("add", "asip-lend p")
        self.check("add-lend")
        self.go("class", "form.open-lesson")
        self.check("class-lend")
        code = self.bus.post("/api/lessons", {"lend": True})["code"]
        self.addCleanup(self.browser.driver.delete_all_cookies)
        joined = self.browser.driver.execute_async_script("""const [code, done] = arguments;
            fetch("api/join", { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ code }) }).then((answer) => done(answer.status));""", code)
        self.assertEqual(joined, 200)
        self.start("#/lend")
        self.browser.shown("asip-pupil a.button")
        self.browser.shown("asip-lend p")
        for _ in VIEWS:
            self.check("lend-pupil")


if __name__ == "__main__":
    unittest.main()
