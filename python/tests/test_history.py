# SPDX-License-Identifier: Apache-2.0
"""How values were, by the registries of a bus in memory."""
import datetime
import json
import unittest
import unittest.mock

import asip
from asip.testing import eventually
from memory_rig import Memory


class Histories(Memory):
    def test_points_are_read_and_what_is_none_is_passed_over(self):
        self.memory.desk.offer("servo/0/angle", "number", min=0, max=180, write=["write", 0, None])
        self.memory.kept["desk/servo/0/angle"] = [["2026-01-31T12:00:00.000Z", 42], ["2026-01-31T12:01:00.000Z", 2.5, 1, 4],
                                                  ["2026-01-31T12:02:00.000Z", None], ["yesterday", 1], 7, ["2026-01-31T12:03:00.000Z", "x"]]
        history = self.desk["servo/0/angle"].history(days=7)
        self.assertEqual([(one.mean, one.min, one.max) for one in history], [(42, 42, 42), (2.5, 1, 4), (None, None, None)])
        self.assertEqual(history[1].at.isoformat(), "2026-01-31T12:01:00+00:00")
        self.assertEqual((history.level, history.registry), ("changes", "memory"))
        self.memory.kept.clear()
        self.assertEqual((self.desk["servo/0/angle"].history(), self.desk["servo/0/angle"].history().level), ([], ""))
        for wrong in ({"days": -1}, {"hours": "2"}, {"points": 0}, {"points": 1.5}):
            with self.assertRaises(asip.Invalid):
                self.desk["servo/0/angle"].history(**wrong)

    def test_a_service_of_one_property_tells_its_history(self):
        self.memory.desk.offer("servo/0/angle", "number", min=0, max=180, write=["write", 0, None])
        self.memory.kept["desk/servo/0/angle"] = [["2026-01-31T12:00:00.000Z", 42]]
        self.assertEqual([one.mean for one in self.desk["servo"].history(days=7)], [42])
        self.memory.desk.offer("servo/1/angle", "number", min=0, max=180, write=["write", 1, None])
        with self.assertRaisesRegex(asip.Invalid, r'board\["servo/1/angle"\].history\(\)'):
            self.desk["servo"].history()

    def test_a_board_that_is_away_tells_its_history_by_what_the_refusal_says(self):
        self.memory.desk.offer("servo/0/angle", "number", min=0, max=180, write=["write", 0, None])
        self.memory.kept["desk/servo/0/angle"] = [["2026-01-31T12:00:00.000Z", 42]]
        self.memory.desk.lose()
        with self.memory.connect() as bus:
            with self.assertRaisesRegex(asip.NotThere, r'desk is lost.*; bus.boards\("desk"\)\[0\] is that board with its history'):
                bus.board("desk", timeout=0.2)
            board = bus.boards("desk")[0]
            self.assertEqual([one.mean for one in board["servo/0/angle"].history()], [42])
        self.memory.desk.back()

    def test_of_two_registries_the_one_counts_that_knew_it_for_the_longest(self):
        self.memory.desk.offer("servo/0/angle", "number", min=0, max=180, write=["write", 0, None])
        hours_ago = lambda hours: f"{datetime.datetime.now(datetime.timezone.utc) - datetime.timedelta(hours=hours):%Y-%m-%dT%H:%M:%S.000Z}"
        kept = {"r1": [[hours_ago(20), None], [hours_ago(2), 1]], "r2": [[hours_ago(9), 2]], "r3": None}
        for name in kept:
            self.memory._publish(f"registry/{name}/$state", "online", True)
        self.memory._publish("registry/r4/$state", "lost", True)
        received, asked = self.memory._received, []

        def answers(topic, payload):
            levels = topic.split("/")[1:]
            if levels[0] != "registry" or len(levels) != 3:
                return received(topic, payload)
            query = json.loads(payload)
            asked.append(levels[1])
            says = {"refused": "no-history", "error": "none is kept"} if kept[levels[1]] is None else {"items": kept[levels[1]]}
            self.memory._publish(query["reply_to"].split("/", 1)[1], {"id": query["id"], "registry": levels[1], **says})
        with unittest.mock.patch.object(self.memory, "_received", answers):
            for _ in range(2):
                history = self.desk["servo/0/angle"].history()
                self.assertEqual((history.registry, [one.mean for one in history]), ("r2", [2]))
            self.memory._publish("registry/r2/$state", "offline", True)
            self.assertEqual(eventually(lambda: (history := self.desk["servo/0/angle"].history()).registry == "r1" and history)[1].mean, 1)
            kept.update(r1=None)
            with self.assertRaises(asip.NotThere):
                self.desk["servo/0/angle"].history()
        self.assertEqual(asked[:6], ["r1", "r2", "r3"] * 2)


if __name__ == "__main__":
    unittest.main()
