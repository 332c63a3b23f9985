# SPDX-License-Identifier: Apache-2.0
"""A bus in memory for the tests of this folder."""
import unittest

from asip import testing


class Memory(unittest.TestCase):
    def setUp(self):
        self.memory = testing.MemoryBus(desk=["io", "distance", "servo", "motors"], lamp=["io"])
        self.addCleanup(self.memory.close)
        self.bus = self.memory.connect()
        self.desk = self.bus.board("desk")

    def commands(self, board="desk"):
        return self.memory.boards[board].commands
