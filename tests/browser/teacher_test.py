# SPDX-License-Identifier: Apache-2.0
"""A teacher's day: from an empty bus and boards in their boxes to the value of each board in a page that is open all the time.
Boot loader, avrdude and firmware are real; as many boards as ASIP_CLASS says, two of which fail at first."""

import pathlib
import sys

from rig import Browser, eventually

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "box"))
import box_test  # noqa: E402


class TeachersDay(box_test.Class):
    def begin(self, bus):
        self.browser = Browser()
        self.addCleanup(self.browser.close)
        self.browser.driver.get(f"{bus.url}/#/")
        eventually(lambda: "No board is there yet" in self.browser.text(".empty"), "the empty page", 30)
        self.browser.run("window.same_page = true")

    def is_seen(self, bus, board):
        eventually(lambda: "42" in self.browser.table().get(board, ""), f"the value of {board} in the table", 30)
        self.assertTrue(self.browser.run("return window.same_page"), "without a reload")
