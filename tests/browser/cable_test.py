# SPDX-License-Identifier: Apache-2.0
"""A board in the computer of the browser: real Chromium, gateway, agent and firmware. Only the port is a test's, since this machine has
no board: an object in place of navigator.serial, with a simulated board behind it (tests/cable)."""

import pathlib
import subprocess
import sys
import time
import unittest

from rig import ROOT, IMAGES, PageTest, eventually

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1] / folder) for folder in ("box", "cable")]
from box_test import OLD_NANO, needs_tools  # noqa: E402
from lending_test import EYE, SERVICES, LendingBus  # noqa: E402
from port_server import PortServer  # noqa: E402

BOARD = "lent-loopback"


class Cable(PageTest):
    simulated = ({"name": "one", "image": SERVICES, "parts": [EYE]},)
    expected_errors = ("WebSocket connection to", "Failed to load resource: net::ERR_", "status of 503")  # the gateway ends, and begins

    @classmethod
    def make_bus(cls):
        return LendingBus(cls.simulated)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ports = PortServer(cls.bus.work)
        cls.addClassCleanup(cls.ports.close)
        cls.prepare()

    @classmethod
    def prepare(cls):
        """The present tab gets the ports. The page may connect to itself alone: for the test's object that is set aside."""
        driver = cls.browser.driver
        driver.execute_cdp_cmd("Page.enable", {})
        driver.execute_cdp_cmd("Page.setBypassCSP", {"enabled": True})
        driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": cls.ports.script})

    def connect(self, port):
        self.open("add", anew=True)
        self.browser.run("window.next_port = arguments[0]", port)
        self.browser.button("Connect the board in this computer", "asip-lend").click()

    def says(self, text, seconds=60):
        eventually(lambda: text in " ".join(self.browser.text("asip-lend").split()), text, seconds)

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

    def test_PortInOtherHands_IsSaid(self):
        self.connect("none")
        self.says("The port cannot be used: Failed to open serial port.")

    def test_BrowserWithoutWebSerial_IsToldInPlainWords(self):
        script = self.browser.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": "Object.defineProperty(navigator, 'serial', { value: undefined });"})
        self.open("add", anew=True)
        self.says("This browser cannot open a serial port.")
        self.assertEqual(self.browser.find("asip-lend button"), [])
        self.browser.driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", {"identifier": script["identifier"]})


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
