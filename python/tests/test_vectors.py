# SPDX-License-Identifier: Apache-2.0
"""The vectors that every implementation of the bus reads: tests/vectors/bus.json."""
import json
import pathlib
import unittest

from asip import _brokers, _clock, _envelope, _topics, errors

VECTORS = json.loads((pathlib.Path(__file__).resolve().parents[2] / "tests" / "vectors" / "bus.json").read_text())


class Vectors(unittest.TestCase):
    def test_names(self):
        for name in VECTORS["names"]["board"]:
            self.assertTrue(_topics.valid_board(name), name)
        for name in VECTORS["names"]["service"]:
            self.assertTrue(_topics.valid_name(name), name)
        for name in VECTORS["names"]["neither"]:
            self.assertFalse(_topics.valid_name(name), name)
        for name in VECTORS["names"]["no_board"]:
            self.assertFalse(_topics.valid_board(name), name)

    def test_topics(self):
        for vector in VECTORS["topics"]:
            topics, board, service = _topics.Topics(vector["root"], vector["user"], vector["client"]), vector["board"], vector["service"]
            made = {"state": topics.state(board), "description": topics.description(board), "demand": topics.demand(board), "probe": topics.probe(),
                    "lines": topics.lines_in(board), "command": topics.command(board, service), "stop": topics.stop(board),
                    "event": topics.event(board, service), "fault": topics.fault(board, service), "set": topics.set(board, service), "reply": topics.reply(board),
                    "replies": topics.replies(), "own": topics.own()}
            self.assertEqual(made, {name: vector[name] for name in made})

    def test_requests(self):
        for vector in VECTORS["requests"]:
            given = {name: vector[name] for name in ("reply_to", "id", "timeout", "clock", "by", "hold") if name in vector}
            self.assertEqual(json.loads(_envelope.request_text(vector["members"], **given)), vector["payload"])

    def test_answers(self):
        for vector in VECTORS["answers"]:
            error = errors.from_answer(vector["payload"], board="desk")
            if "kind" not in vector:
                self.assertIsNone(error)
                continue
            self.assertEqual((type(error).__name__, error.sent, error.reason), (vector["kind"], vector["sent"], vector.get("reason")))
            if "code" in vector:
                self.assertEqual(error.code, vector["code"])

    def test_demands(self):
        for vector in VECTORS["demands"]:
            self.assertEqual(json.loads(_envelope.demand_text(vector["services"], vector["lease"])), vector["payload"])

    def test_clock(self):
        for vector in VECTORS["clock"]:
            clocks = _clock.Clocks()
            for reading, asked, answered in vector["notes"]:
                clocks.note("desk", reading, asked, answered)
            self.assertEqual(clocks.reading("desk", vector["now"]), vector["reading"], vector["about"])

    def test_versions_of_mqtt(self):
        vectors = json.loads((pathlib.Path(__file__).resolve().parents[2] / "tests" / "vectors" / "mqtt_version.json").read_text())
        for broker in vectors["brokers"]:
            choice = _brokers.VersionChoice()
            for attempt in broker["attempts"]:
                if attempt["ended"] == "accepted":
                    choice.accepted()
                else:
                    choice.failed(attempt["ended"], choice.v5)
                self.assertEqual((5 if choice.v5 else 4, choice.suspected), (attempt["then"], attempt["same"]), (broker["about"], attempt))


if __name__ == "__main__":
    unittest.main()
