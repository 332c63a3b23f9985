# SPDX-License-Identifier: Apache-2.0
"""The catalogue says of a board what the C++ programs say after the same messages: tests/vectors/presence.json."""
import json
import os
import pathlib
import unittest

from asip import _catalogue, _envelope

VECTORS = json.loads(pathlib.Path(os.environ.get("ASIP_PRESENCE_VECTORS", pathlib.Path(__file__).resolve().parents[2] / "tests" / "vectors" / "presence.json")).read_text())


def take(catalogue, step, board):
    now, kept, expiry = float(step["at"]), step.get("kept", False), step.get("expiry")
    if step.get("heard") is True:
        catalogue.connected(now)
    elif "heard" in step:
        catalogue.disconnected(now)
    elif "state" in step:
        catalogue.on_state(board, step["state"].encode(), kept, expiry, now)
    elif "say" in step or "text" in step:
        text = step["text"] if "text" in step else json.dumps({"board": board, "services": [], **step["say"]})
        catalogue.on_description(board, _envelope.read_object(text.encode(), 1 << 16), kept, expiry, now)


def shown(catalogue, now, board):
    catalogue.expire(now + 1e-6)  # a sum of seconds may be a little more than it is
    entry = catalogue.boards.get(board)
    if entry is None:
        return None
    return [entry.effective, entry.reason, None if entry.since == float("-inf") else now - entry.since]


class Presence(unittest.TestCase):
    def test_what_is_shown_after_each_message_is_what_the_file_says(self):
        steps = 0
        for history in VECTORS["histories"]:
            catalogue, board = _catalogue.Catalogue(), history.get("board", "desk")
            for number, step in enumerate(history["steps"]):
                take(catalogue, step, board)
                told, wanted = shown(catalogue, float(step["at"]), board), step["then"]
                where = (history["about"], number, step)
                if told is None or wanted is None or None in (told[2], wanted[2]):
                    self.assertEqual(told, wanted, where)
                else:
                    self.assertEqual(told[:2], wanted[:2], where)
                    self.assertAlmostEqual(told[2], wanted[2], delta=0.001, msg=where)
                steps += 1
        self.assertGreater(steps, 1000)

    def test_word_that_the_broker_kept_alone_is_not_shown_as_lost(self):
        catalogue = _catalogue.Catalogue()
        catalogue.on_state("desk", b"online", True, None, 0)
        self.assertEqual((catalogue.boards["desk"].state, catalogue.names()), ("unknown", []))
        catalogue.on_description("desk", {"board": "desk", "session": "s", "seq": 1, "services": []}, True, 30, 0)
        self.assertEqual(catalogue.boards["desk"].state, "online")

    def test_what_a_registry_lists_is_as_it_was_and_what_is_heard_counts_more(self):
        catalogue = _catalogue.Catalogue()
        catalogue.on_listed({"board": "desk", "state": "lost", "reason": "silent", "state_age": 130.0, "services": [{"name": "io"}]}, 1000)
        entry = catalogue.boards["desk"]
        self.assertEqual((entry.words(1000), entry.description["services"]), ("lost 2 min ago: the board answers nothing", [{"name": "io"}]))
        self.assertEqual(catalogue.expire(10**7), [])
        catalogue.on_description("desk", {"board": "desk", "session": "s", "seq": 1, "services": []}, False, None, 10**7)
        catalogue.on_listed({"board": "desk", "state": "lost", "services": []}, 10**7)
        self.assertEqual(catalogue.boards["desk"].state, "online")

    def test_boards_that_are_not_followed_any_more_stay_as_they_were(self):
        catalogue = _catalogue.Catalogue()
        for name in ("desk", "lamp"):
            catalogue.on_description(name, {"board": name, "session": "s", "seq": 1, "services": []}, False, None, 0)
        catalogue.look_away(lambda name: name == "lamp")
        self.assertEqual((catalogue.expire(61), catalogue.boards["desk"].state), (["lamp"], "online"))


if __name__ == "__main__":
    unittest.main()
