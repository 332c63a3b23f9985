# SPDX-License-Identifier: Apache-2.0
"""A board from the box on the page: it is seen, loaded with progress, and its values are live; then its history. Boot loader,
avrdude and firmware are real (tests/box)."""

import pathlib
import sys
import unittest

from rig import PageTest, eventually

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "box"))
from box_test import Boxes, ask_anew, needs_tools, next_version  # noqa: E402


class Firmware(PageTest):
    @classmethod
    def make_bus(cls):
        needs_tools()
        return Boxes()

    def test_BoardFromTheBox_IsLoadedOnThePageAndItsValuesAreSeen(self):
        page, bus = self.browser, self.bus
        self.open()
        bus.plug("usb-3")
        eventually(lambda: "1 board without ASIP: usb-3" in page.text(".attention"), "the board without ASIP", 40)
        self.assertNotIn("lost", page.driver.title)
        self.assertIn("no ASIP sketch yet", page.table()["usb-3"])
        page.button("Load AsipServices")
        page.screenshot("board-without-asip")
        self.open("board/usb-3")
        eventually(lambda: "that speaks no ASIP. Load AsipServices?" in page.text("asip-firmware"), "the question")
        page.run("document.querySelector('asip-firmware select').value = 'nano-old'")
        page.button("Load AsipServices", "asip-firmware").click()
        self.assertTrue(page.run("return !document.querySelector('asip-firmware progress').hidden"), "from the click on")
        eventually(lambda: "AsipServices: writing" in page.text("asip-firmware"), "progress", 40)
        self.assertTrue(0 <= float(page.run("return document.querySelector('asip-firmware progress').value")) <= 100)
        page.screenshot("board-is-loaded")
        eventually(lambda: "AsipServices is loaded." in page.text("asip-firmware"), "the end", 60)
        eventually(lambda: "42" in page.text(".values-box"), "the distance, live", 30)
        page.screenshot("board-was-loaded")
        # Plugged in again, with the table open: its first value is there soon.
        self.open()
        eventually(lambda: "online" in page.table().get("usb-3", ""), "online", 30)

    def test_History_HasEachCommandFoldsEqualOnesAndIsSearchedOnAPhone(self):
        page, bus = self.browser, self.bus
        eventually(lambda: bus.state("usb-3") == "online", "the board of the test before", 60)
        for _ in range(3):
            self.assertEqual(bus.asipctl("send", "usb-3/servo", "write", "0", "90").returncode, 0)
        self.assertEqual(bus.asipctl("send", "usb-3/servo", "write", "7", "90").returncode, 1)
        page.size(390, 800, mobile=True)
        self.open("board/usb-3", anew=True)
        self.history()
        rows = lambda: page.run("return [...document.querySelectorAll('asip-history tbody tr')].filter((row) => row.offsetParent).map((row) => row.innerText)")
        eventually(lambda: any("Servo 7 to 90°" in row for row in rows()), "the commands", 15)
        search = page.shown("asip-history input[type=search]")
        search.send_keys("servo to 90")
        eventually(lambda: rows() and all("Servo" in row for row in rows()), "only those of the servo")
        self.assertTrue(any("error" in row for row in rows()), "the one that the board refused, too")
        self.assertLessEqual(len(rows()), 4, "three that are equal are not told apart where nothing is between them")
        wide = page.run("const table = document.querySelector('asip-history table').getBoundingClientRect(); const last = document.querySelector('asip-history tbody td:last-child').getBoundingClientRect(); return [table.right, last.width, last.right, innerWidth]")
        self.assertLessEqual(wide[2], wide[3] + 1, "what happened is on the screen")
        self.assertGreater(wide[1], 100, "and wide enough to be read")
        page.screenshot("history-on-a-phone")


    def test_OutOfDate_IsSaid_AndUpdateAllLoadsTheNewerOne(self):
        page, bus = self.browser, self.bus
        eventually(lambda: bus.state("usb-3") == "online", "the board of the tests before", 60)
        next_version(bus.firmware)
        ask_anew(bus, "usb-3")
        page.desktop()
        self.open(anew=True)
        eventually(lambda: "AsipServices 0.2, out of date" in page.table().get("usb-3", ""), "the row", 60)
        self.assertIn("1 board is out of date: usb-3", page.text(".attention"))
        page.screenshot("board-out-of-date")
        page.button("Update all", ".attention").click()
        eventually(lambda: "updating" in page.table()["usb-3"], "it is loaded", 60)
        eventually(lambda: "AsipServices 0.3" in page.table()["usb-3"] and "online" in page.table()["usb-3"], "up to date", 240)
        self.assertNotIn("out of date", page.text(".attention"))


if __name__ == "__main__":
    unittest.main()
