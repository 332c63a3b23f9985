# SPDX-License-Identifier: Apache-2.0
"""What both hosts of the tests are asked: which devices there are, and which values they have."""

import unittest

from bus import eventually

SERVO = ["desk", "servo/0/angle"]
DISTANCE = ["desk", "distance/0"]


class HostTest(unittest.TestCase):
    """A test with `self.bus` and `self.host`."""

    patience = 30

    def until(self, condition, what, seconds=None):
        try:
            return eventually(condition, what, seconds or self.patience)
        except AssertionError:
            self.fail(f"not {what}: {self.explained()}\n{self.bus.logs()}")

    def explained(self):
        return self.host("seen")

    def seen(self):
        return self.host("seen")

    def devices(self, *names):
        self.until(lambda: self.seen()["node"] and self.seen()["devices"] == list(names), f"devices {names}")

    def value(self, which, value):
        self.until(lambda: (self.host("get", which) or {}).get("value") == value, f"{which} = {value}")
