# SPDX-License-Identifier: Apache-2.0
"""From an empty system to a named board whose value is on a dashboard, with a board from the box (boot loader, avrdude and firmware are
real) and with a simulated one; and the help of every screen."""

import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import time
import unittest

from rig import BIN, DESK, IMAGES, ROOT, PageTest, die_with_parent, eventually

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "box"))
from box_test import Boxes, needs_tools  # noqa: E402

MOST_CLICKS = 12
MOST_SECONDS = 30  # beside the loading


class Evening(PageTest):
    """What both ways have in common."""

    def begin(self):
        page = self.browser
        page.driver.get("about:blank")
        page.driver.get(f"{self.bus.url}/")
        eventually(lambda: self.t("no-board-there") in page.text(".empty"), "the invitation", 30)
        page.run("window.clicks = 0; addEventListener('pointerdown', () => { ++clicks; }, true);")
        self.began = time.monotonic()
        page.shown(".empty .button").click()
        self.at_step("find")

    def at_step(self, name, seconds=20):
        eventually(lambda: self.browser.text(".steps [aria-current]") == self.t(name), f"the step {name}", seconds)

    def name_it(self, name, room):
        page = self.browser
        self.at_step("name", 60)
        form = page.shown(f"form[aria-label='{self.t('name-place')}']")
        page.driver.switch_to.active_element.send_keys(name)
        form.find_elements("css selector", "input")[1].click()
        page.driver.switch_to.active_element.send_keys(room)
        page.screenshot(f"add-board-name-{name}")
        page.button(self.t("save"), ".add-board").click()
        self.at_step("show", 30)

    def name_and_show(self, name, room, value, beside=0.0):
        """Names the board, adds its first value to a dashboard, and sees it there."""
        page = self.browser
        self.name_it(name, room)
        page.button("Add", ".add-board").click()
        eventually(lambda: value in page.text(".dashboard-grid"), f"{value} on the dashboard", 30)
        seconds, clicks = time.monotonic() - self.began - beside, page.run("return clicks")
        print(f"{clicks} clicks, {seconds:.1f} s beside the loading")
        self.assertLessEqual(clicks, MOST_CLICKS)
        self.assertLess(seconds, MOST_SECONDS)
        page.screenshot(f"add-board-done-{name}")


class FromTheBox(Evening):
    expected_errors = ("/load",)  # what ends otherwise is told on the page, and so is what takes longer than a request

    @classmethod
    def make_bus(cls):
        needs_tools()
        return Boxes()

    def test_EmptySystem_BoardFromTheBoxIsLoadedNamedAndOnADashboard(self):
        page, bus = self.browser, self.bus
        self.begin()
        eventually(lambda: "asip-agent --serial" in page.text(".add-board"), "what to type where there is no agent")
        page.size(390, 844, mobile=True)
        page.screenshot("phone-add-board")
        page.desktop()
        bus.plug("usb-3")
        page.button("Load usb-3", ".add-board").click()
        self.at_step("load")
        loading = time.monotonic()
        eventually(lambda: "AsipServices: writing" in page.text(".loading-log"), "the log", 40)
        page.screenshot("add-board-loading")
        self.at_step("name", 90)
        self.assertNotIn("does not answer", page.text(".add-board"), "loading takes longer than other requests")
        beside = time.monotonic() - loading
        self.name_and_show("Left window", "Kitchen", "42", beside)
        eventually(lambda: bus.get("/api/boards/usb-3").get("labels") == {"name": "Left window", "room": "Kitchen"}, "the announced labels")
        self.open()
        eventually(lambda: "room=Kitchen" in page.table().get("Left window", ""), "its place in the list")

    def test_LoadingThatFails_SaysWhyAndIsTriedAgain(self):
        page, bus = self.browser, self.bus
        bus.plug("usb-4")
        self.open("add", anew=True)
        eventually(lambda: "usb-4" in page.text(".add-board"), "the board", 40)
        page.button("Load usb-4", ".add-board").click()
        bus.end("sim-usb-4", signal.SIGKILL)  # the cable is pulled while it is loaded
        page.button("Try again", ".add-board", 60)
        self.assertIn("Not loaded", page.text(".add-board output"))
        self.assertGreaterEqual(len(page.find(".loading-log li")), 2, "the log says why")


class Simulated(Evening):
    boards = ()

    def type_command(self, text):
        """In a shell of the machine; its programs end with the test."""
        file = self.bus.work / "desk.json"
        file.write_text(re.sub(r'"link": "[^"]*",?', "", (ROOT / "demo/boards/desk.json").read_text()).replace("../../build/dev/firmware/images", str(IMAGES)))
        text = text.replace("/usr/share/asip/boards/desk.json", shlex.quote(str(file))).replace("/tmp/desk", shlex.quote(str(self.bus.work / "desk.tty")))
        environment = {key: value for key, value in os.environ.items() if not key.startswith("ASIP_")}
        environment |= {"PATH": f"{BIN}:{environment['PATH']}", "ASIP_BROKER": f"127.0.0.1:{self.bus.broker_port}", "XDG_STATE_HOME": str(self.bus.work / "state"),
                        "ASIP_SOCKET": str(self.bus.work / "sim.sock")}
        with open(self.bus.work / "typed.log", "ab") as log:
            shell = subprocess.Popen(["sh", "-c", text], env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True, preexec_fn=die_with_parent)
        self.addCleanup(shell.wait)
        self.addCleanup(os.killpg, shell.pid, signal.SIGTERM)

    def test_EmptySystem_SimulatedBoardIsTypedNamedAndOnADashboard(self):
        page = self.browser
        self.begin()
        command = eventually(lambda: next((each.text for each in page.find(".add-board code") if "asip-sim" in each.text and each.is_displayed()), None), "the command")
        self.type_command(command)
        page.button("Take desk", ".add-board").click()
        self.name_and_show("Desk", "Office", "42")
        self.open("add/desk")
        self.at_step("name")

    def test_BoardsOfAViewer_AreNotAdded(self):
        self.open(anew=True)
        self.browser.run("""const real = fetch; window.fetch = async (...all) => {
            const answer = await real(...all);
            if (!String(all[0]).endsWith("api/status")) return answer;
            const body = await answer.json();
            Object.assign(body.you, { label: false, command: false, arrange: false });
            return new Response(JSON.stringify(body), { headers: answer.headers });
        };""")
        self.open("settings")  # asks for the status
        self.open("add")
        eventually(lambda: "Your token adds no boards" in self.browser.text(".add-board"), "the sentence", 30)
        self.assertEqual([each.text for each in self.browser.find(".add-board .link-list button")], [])


class Help(PageTest):
    boards = (DESK,)

    def test_EveryScreen_LeadsToThePageThatIsAboutIt(self):
        control = (ROOT / "debian" / "control").read_text()
        docs = re.search(r"^Homepage: (.*)$", control, re.M)[1] + "/blob/main/docs/"
        for route, page in (("", "gateway"), ("add", "asipctl"), ("board/desk", "gateway"), ("dashboards", "dashboards"), ("dashboard/any", "dashboards"),
                            ("history", "service-bus"), ("settings", "gateway"), ("nowhere", "gateway")):
            self.open(route)
            link = self.browser.shown("footer a")
            self.assertEqual(link.text, "Help with this page")
            address = link.get_attribute("href")
            self.assertTrue(address.startswith(docs), address)
            name, _, anchor = address.removeprefix(docs).partition("#")
            self.assertEqual(name, f"{page}.md")
            text = (ROOT / "docs" / name).read_text()
            anchors = [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in re.findall(r"^#+ (.*)$", text, re.M)]
            self.assertTrue(anchor == "" or anchor in anchors, address)


if __name__ == "__main__":
    unittest.main()
