# SPDX-License-Identifier: Apache-2.0
"""A board in the computer of the browser: real Chromium, gateway, agent and firmware. Only the port is a test's, since this machine has
no board: an object in place of navigator.serial, with a simulated board behind it (tests/cable)."""

import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

from selenium.webdriver.support.ui import Select

from class_test import Phones, address_of_this_machine
from rig import ROOT, IMAGES, Browser, PageTest, can_connect, eventually, free_port

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1] / folder) for folder in ("box", "cable")]
from box_test import OLD_NANO, needs_tools  # noqa: E402
from lending_test import EYE, SERVICES, LendingBus, Way  # noqa: E402
from port_server import PortServer  # noqa: E402

BOARD = "lent-loopback"


class Cable(PageTest):
    simulated = ({"name": "one", "image": SERVICES, "parts": [EYE]},)
    host = "127.0.0.1"
    expected_errors = ("WebSocket connection to", "Failed to load resource: net::ERR_", "status of 503")  # the gateway ends, and begins

    @classmethod
    def make_bus(cls):
        return LendingBus(cls.simulated)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ports = PortServer(cls.bus.work, cls.host)
        cls.addClassCleanup(cls.ports.close)
        cls.prepare()

    @classmethod
    def prepare(cls, browser=None):
        """The present tab gets the ports. The page may connect to itself alone: for the test's object that is set aside."""
        driver = (browser or cls.browser).driver
        driver.execute_cdp_cmd("Page.enable", {})
        driver.execute_cdp_cmd("Page.setBypassCSP", {"enabled": True})
        driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": cls.ports.script})

    def connect(self, port):
        self.open("add", anew=True)
        self.press(port)

    def press(self, port, browser=None):
        browser = browser or self.browser
        browser.button("Connect the board in this computer", "asip-lend")
        browser.run("window.next_port = arguments[0]", port)
        browser.button("Connect the board in this computer", "asip-lend").click()

    def says(self, text, seconds=60, browser=None):
        eventually(lambda: text in " ".join((browser or self.browser).text("asip-lend").split()), text, seconds)

    def is_online(self):
        eventually(lambda: self.state() == "online", "online", 60)

    def state(self):
        return (self.bus.board(BOARD) or {}).get("state")


class OneBoard(Cable):
    def test_Board_IsConnectedInOneStep_AndItsValuesAreOnThePage(self):
        began = time.monotonic()
        self.connect("one")
        self.says(f"On the bus: {BOARD}")
        self.browser.screenshot("cable-connected")
        self.browser.find("asip-lend li a")[0].click()
        eventually(lambda: "42" in self.browser.text(".values-box"), "the distance, live", 60)
        print(f"from the click to the value: {time.monotonic() - began:.1f} s")
        eventually(lambda: self.ports.opened["one"][-1] == 1_000_000, "the port is opened anew for another rate", 60)
        self.assertEqual(self.bus.asipctl("send", f"{BOARD}/servo", "write", "0", "90").returncode, 0)

    def test_GatewayStartedAgain_TheTabConnectsByItself(self):
        self.connect("one")
        self.is_online()
        button = self.browser.button("Disconnect", "asip-lend")
        self.bus.end("gateway")
        self.bus.start_gateway()
        self.says(f"On the bus: {BOARD}")
        self.is_online()
        button.click()  # it is there all the time
        eventually(lambda: self.state() == "lost", "lost", 60)

    def test_TabClosed_IsAPulledCable(self):
        driver = self.browser.driver
        first = driver.current_window_handle
        driver.switch_to.new_window("tab")
        self.prepare()
        self.connect("one")
        self.is_online()
        driver.close()
        driver.switch_to.window(first)
        lost = eventually(lambda: (lambda board: board["state"] == "lost" and board)(self.bus.board(BOARD)), "lost", 60)
        self.assertEqual((lost["reason"], lost["description"]["warnings"][0]), ("unplugged", "the browser that lent it closed"))
        self.open(f"board/{BOARD}")
        eventually(lambda: self.browser.text(".warnings") == "the browser that lent it closed", "the reason on its page", 60)

    def test_UnpluggedThere_AndPluggedInAgain(self):
        self.connect("one")
        self.is_online()
        self.bus.sim("unplug", "one")
        self.says("The board was unplugged.")
        eventually(lambda: self.state() == "lost", "lost", 60)
        self.bus.sim("replug", "one")
        eventually((self.bus.work / "one.port").exists, "the port")
        self.browser.run("window.plug_again('one')")
        self.says(f"On the bus: {BOARD}")
        self.is_online()
        self.browser.button("Disconnect", "asip-lend").click()
        eventually(lambda: self.state() == "lost", "lost", 60)
        self.assertEqual(self.browser.find("asip-lend li"), [])

    def test_WhatWaitsInThePage_HasABound(self):
        driver = self.browser.driver
        script = driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": """
            window.sockets = [];
            window.WebSocket = class extends WebSocket {
              constructor(url) { super(url); sockets.push(this); }
              get bufferedAmount() { return window.buffered ?? super.bufferedAmount; }
            };"""})
        self.addCleanup(driver.execute_cdp_cmd, "Page.removeScriptToEvaluateOnNewDocument", {"identifier": script["identifier"]})
        self.connect("one")
        self.is_online()
        self.browser.run("window.buffered = 300_000")
        self.says("No connection to the gateway.")
        self.browser.run("window.buffered = undefined")
        self.says(f"On the bus: {BOARD}")
        self.is_online()
        self.browser.run("sockets.findLast((each) => each.url.includes('api/cable')).onmessage({ data: new Uint8Array(300_000).fill(68).buffer })")
        self.says("The port cannot be used: the board takes no bytes")
        eventually(lambda: self.state() == "lost", "lost", 60)

    def test_GatewayThatLetsItLendNoMore_IsNotAskedForEver(self):
        self.connect("one")
        self.is_online()
        self.bus.end("gateway")
        self.addCleanup(self.bus.start_gateway)
        self.addCleanup(self.bus.end, "gateway")
        self.bus.start("gateway", "asip-gateway", "--http", f"{self.bus.host}:{self.bus.http_port}")
        self.says("This browser may not lend a board any more.")
        self.browser.button("Remove", "asip-lend").click()
        self.assertEqual(self.browser.find("asip-lend li"), [])

    def test_PortInOtherHands_IsSaid(self):
        self.connect("none")
        self.says("The port cannot be used: Failed to open serial port.")

    def test_BrowserWithoutWebSerial_IsToldInPlainWords(self):
        script = self.browser.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": "Object.defineProperty(navigator, 'serial', { value: undefined });"})
        self.open("add", anew=True)
        self.says("This browser cannot open a serial port.")
        self.assertEqual(self.browser.find("asip-lend button"), [])
        self.browser.driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", {"identifier": script["identifier"]})


class ByAnotherName(PageTest):
    boards = ()
    expected_errors = ("Failed to load resource",)

    @classmethod
    def make_bus(cls):
        bus = LendingBus()
        bus.certificate = [str(bus.work / name) for name in ("http.pem", "http.key")]
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=school.test",
                        "-out", bus.certificate[0], "-keyout", bus.certificate[1]], check=True, capture_output=True)
        return bus

    def start(self, name, *options):
        port = free_port()
        self.bus.start(name, "asip-gateway", "--http", f"127.0.0.1:{port}", "--cables", str(self.bus.cables), "--host", "school.test", *options)
        self.addCleanup(self.bus.end, name)
        eventually(lambda: can_connect(port), name, 60)
        return f"http://school.test:{port}/#/add"

    def test_PageThatCameByHttp_SaysWhatIsMissing_AndLeadsToHttpsWhereThatIs(self):
        page = Browser("--host-resolver-rules=MAP school.test 127.0.0.1", "--ignore-certificate-errors")
        self.addCleanup(page.close)
        says = lambda text: eventually(lambda: text in page.text("asip-lend"), text, 60)
        page.driver.get(self.start("plain"))
        says("Browsers open serial ports only on pages that came by HTTPS.")
        self.assertEqual(page.find("asip-lend button"), [])
        cert, key = self.bus.certificate
        address = self.start("tls", "--http-cert", cert, "--http-key", key)
        page.driver.get(address)
        says("Connect the board in this computer")
        self.assertEqual(page.driver.current_url, address.replace("http:", "https:"))
        self.assertTrue(page.run("return isSecureContext && navigator.serial !== undefined"))


class FromTheBox(Cable):
    simulated = ({"name": "nano", "board": "nano", "image": OLD_NANO, "reset_on_open": True, "parts": [EYE]},)

    @classmethod
    def make_bus(cls):
        needs_tools()
        bus = super().make_bus()
        subprocess.run([ROOT / "packaging/loadable_firmware", IMAGES, bus.firmware], check=True)
        return bus

    def test_BoardWithoutAsip_IsLoadedOverTheCable(self):
        page = self.browser
        self.connect("nano")
        self.says(f"On the bus: {BOARD}", 60)
        page.find("asip-lend li a")[0].click()
        eventually(lambda: "speaks no ASIP" in page.text("asip-firmware"), "the question")
        page.run("document.querySelector('asip-firmware select').value = 'nano-old'")
        page.button("Load AsipServices", "asip-firmware").click()
        eventually(lambda: "AsipServices: writing" in page.text("asip-firmware"), "progress", 60)
        eventually(lambda: "AsipServices is loaded." in page.text("asip-firmware"), "the end", 90)
        eventually(lambda: "42" in page.text(".values-box"), "the distance, live", 30)
        self.assertGreaterEqual(self.ports.restarts["nano"], 1)


def processes_below(parent):
    found = []
    for children in pathlib.Path(f"/proc/{parent}/task").glob("*/children"):
        for child in children.read_text().split():
            found += [int(child), *processes_below(child)]
    return found


class Away(Cable):
    simulated = ({"name": "one", "image": SERVICES, "parts": [EYE, {"kind": "servo", "name": "servo", "pin": 9}]},)

    def sleep_until(self, reason):
        """The laptop sleeps: all of the browser stands still."""
        asleep = processes_below(self.browser.driver.service.process.pid)
        for pid in asleep:
            os.kill(pid, signal.SIGSTOP)
        try:
            eventually(lambda: self.bus.board(BOARD).get("reason") == reason, f"lost, {reason}", 90)
        finally:
            for pid in asleep:
                os.kill(pid, signal.SIGCONT)

    def test_LaptopAsleep_BoardIsLostAndBack(self):
        self.connect("one")
        self.is_online()
        for reason in ("silent", "unplugged"):
            self.sleep_until(reason)
            self.is_online()
            self.says(f"On the bus: {BOARD}")

    def test_CommandThatThePortHasNotTaken_EndsWithTheCable(self):
        self.connect("one")
        self.is_online()
        self.assertEqual(self.bus.asipctl("send", f"{BOARD}/servo", "write", "0", "90").returncode, 0)
        eventually(lambda: self.bus.part("one/servo").startswith("90"), "the servo turns", 60)
        self.browser.run("window.stalled = new Promise((done) => { window.go_on = done; })")
        self.assertNotEqual(self.bus.asipctl("send", f"{BOARD}/servo", "write", "0", "33").returncode, 0)
        self.bus.end("gateway")
        eventually(lambda: self.browser.text("asip-link") != "live", "the page has no connection", 60)
        self.browser.run("window.stalled = undefined; go_on()")
        self.bus.start_gateway()
        self.is_online()  # the board has read all that came before
        self.assertTrue(self.bus.part("one/servo").startswith("90"), self.bus.part("one/servo"))

    def test_NetworkGoneForTenSeconds_NoCommandOfThatTimeReachesTheBoard(self):
        way = Way(self.bus.http_port)
        self.addCleanup(way.close)
        self.browser.driver.get(f"{way.url}/#/add")
        self.press("one")
        self.is_online()
        self.assertEqual(self.bus.asipctl("send", f"{BOARD}/servo", "write", "0", "90").returncode, 0)
        eventually(lambda: self.bus.part("one/servo").startswith("90"), "the servo turns", 60)
        way.there.clear()
        began = time.monotonic()
        self.assertNotEqual(self.bus.asipctl("send", f"{BOARD}/servo", "write", "0", "33").returncode, 0)
        time.sleep(max(0, began + 10 - time.monotonic()))
        self.assertEqual(self.state(), "lost")
        way.there.set()
        self.is_online()
        self.assertTrue(self.bus.part("one/servo").startswith("90"), self.bus.part("one/servo"))

    def test_NetworkGoneForAMinute_PageSaysSo_AndConnectsByItself(self):
        way = Way(self.bus.http_port)
        self.addCleanup(way.close)
        self.browser.driver.get(f"{way.url}/#/add")
        self.press("one")
        self.is_online()
        began = time.monotonic()
        way.there.clear()
        self.says("No connection to the gateway.", 120)
        eventually(lambda: self.bus.board(BOARD).get("reason") == "unplugged", "the gateway ends the cable", 90)
        time.sleep(max(0, began + 60 - time.monotonic()))
        way.there.set()
        self.is_online()
        self.says(f"On the bus: {BOARD}")
        self.assertEqual([each["board"] for each in self.bus.get("/api/boards")["items"]], [BOARD])


class School(LendingBus):
    host = "0.0.0.0"
    gateway_options = ("--anonymous", "class")


class Lesson(Cable):
    expected_errors = (*Cable.expected_errors, "status of 401", "status of 404", "response code: 401")

    @classmethod
    def make_bus(cls):
        bus = School(cls.simulated)
        cls.host = address_of_this_machine()
        cls.outside = f"http://{cls.host}:{bus.http_port}"
        return bus

    def open_lesson(self):
        self.open("class", anew=True)
        theirs = "Those that the pupils plug in"
        eventually(lambda: theirs in self.browser.text("form.open-lesson select"), theirs, 60)
        Select(self.browser.shown("form.open-lesson select")).select_by_visible_text(theirs)
        self.browser.button("Open the lesson").click()
        return self.browser.shown("p.class-code").text

    def join(self, laptop, code):
        self.prepare(laptop)
        laptop.driver.get(f"{self.outside}/join")
        # What the browser may do is known: the screen does not change any more.
        eventually(lambda: laptop.run("return document.querySelector('nav').hidden") or laptop.text("asip-link") == "live", "the way in", 60)
        laptop.shown("input.class-code", seconds=60).send_keys(code)
        laptop.button("Join").click()


class TwoBoardsOfAPupil(Lesson):
    simulated = tuple({"name": name, "image": SERVICES, "parts": [EYE]} for name in ("one", "two"))

    def test_TheSecondHasThePlace_AndTheFirstSaysSo(self):
        code = self.open_lesson()
        laptops = Phones(1, "about:blank")
        self.addCleanup(laptops.close)
        laptop = laptops[0]
        self.join(laptop, code)
        eventually(lambda: laptop.text("asip-pupil").startswith("You are student-1."), "the pupil is in", 60)
        self.press("one", laptop)
        self.says("On the bus: lent-student-1", browser=laptop)
        self.press("two", laptop)
        self.says("Not connected: another board was connected in its place. Remove", browser=laptop)
        self.says("On the bus: lent-student-1", browser=laptop)
        eventually(lambda: self.bus.board("lent-student-1")["state"] == "online", "online", 60)


class TenPupils(Lesson):
    simulated = tuple({"name": f"board{i}", "image": SERVICES, "parts": [EYE, {"kind": "led", "name": f"light{i}", "pin": 13}]} for i in range(1, 11))

    def test_TenPupils_LendTenBoards_UntilTheLessonEnds(self):
        code = self.open_lesson()
        laptops = Phones(10, "about:blank")
        self.addCleanup(laptops.close)
        names = [f"lent-student-{number}" for number in range(1, 11)]
        for number, name in enumerate(names, 1):
            laptop = laptops[number - 1]
            self.join(laptop, code)
            eventually(lambda: laptop.text("asip-pupil").startswith(f"You are student-{number}. Your board is {name}"), f"pupil {number} is in", 60)
            self.press(f"board{number}", laptop)
            self.says(f"On the bus: {name}", browser=laptop)
        for number in range(10):
            laptop = laptops[number]
            laptop.find("asip-lend li a")[0].click()
            eventually(lambda: "42" in laptop.text(".values-box"), "the distance, live", 60)
            laptop.button("Identify", "asip-pupil").click()
            eventually(lambda: "Its light blinked." in laptop.text("asip-pupil"), "a command", 60)
            if number == 2:
                laptop.screenshot("cable-pupil")
        eventually(lambda: "10 of 10 boards have a pupil" in self.browser.text(".lesson"), "all in the teacher's list", 60)
        eventually(lambda: all((self.bus.board(name) or {}).get("state") == "online" for name in names), "ten boards online", 60)
        self.browser.screenshot("cable-teacher")
        self.browser.button("End the lesson").click()
        for number, name in enumerate(names):
            laptop = laptops[number]
            eventually(lambda: "the lesson is over" in laptop.text(), "the pupil is told", 60)
            eventually(lambda: self.bus.board(name)["state"] == "lost", "lost", 60)


class TenBoards(Cable):
    simulated = tuple({"name": f"board{i}", "image": SERVICES, "parts": [EYE]} for i in range(10))

    def test_TenTabs_TenBoards(self):
        driver = self.browser.driver
        for i in range(10):
            if i > 0:
                driver.switch_to.new_window("tab")
                self.prepare()
            self.connect(f"board{i}")
            self.says("On the bus: lent-loopback", 60)
        names = [BOARD] + [f"{BOARD}-{i}" for i in range(2, 11)]
        eventually(lambda: all((self.bus.board(name) or {}).get("state") == "online" for name in names), "ten boards online", 60)
        for name in names:
            self.assertIn("42", self.bus.asipctl("get", f"{name}/distance/0").stdout)


if __name__ == "__main__":
    unittest.main()
