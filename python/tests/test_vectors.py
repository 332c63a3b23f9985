# SPDX-License-Identifier: Apache-2.0
"""The vectors that every implementation of the bus reads: tests/vectors/bus.json."""
import copy
import json
import pathlib
import unittest

from asip import _brokers, _clock, _entry, _envelope, _properties, _topics, errors, settings


def vectors(name):
    return json.loads((pathlib.Path(__file__).resolve().parents[2] / "tests" / "vectors" / f"{name}.json").read_text())


VECTORS = vectors("bus")


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
            made = {"state": topics.state(board), "description": topics.description(board), "demand": topics.demand(board),
                    "lines": topics.lines_in(board), "command": topics.command(board, service), "stop": topics.stop(board),
                    "event": topics.event(board, service), "properties": topics.properties(board), "values": topics.values(board), "question": topics.question(board), "reply": topics.reply(board),
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
        for broker in vectors("mqtt_version")["brokers"]:
            choice = _brokers.VersionChoice()
            for attempt in broker["attempts"]:
                if attempt["ended"] == "accepted":
                    choice.accepted()
                else:
                    choice.failed(attempt["ended"], choice.v5)
                self.assertEqual((5 if choice.v5 else 4, choice.suspected), (attempt["then"], attempt["same"]), (broker["about"], attempt))

    def test_hints_at_refused_passwords(self):
        for vector in vectors("passwords")["passwords"]:
            self.assertEqual(settings.password_hint(bytes.fromhex(vector["hex"])), vector["hint"], vector["about"])
        self.assertEqual(settings.password_hint(None), "")

    def test_sentences_of_answers(self):
        told = vectors("answers")
        for one in told["answers"] + told["unreadable"]:
            error = errors.from_answer(one["answer"], board="desk")
            self.assertEqual(errors.sentence(one["answer"]), one["text"])
            self.assertEqual(None if error is None else str(error), None if one["executed"] == "yes" and not one["text"] else f"desk: {one['text']}")
            self.assertEqual(one["text"].endswith(told["maybe"]), one["executed"] == "maybe")
        for status, words in told["words"].items():
            for reason, text in words.items():
                self.assertIn(text, errors.sentence({"status": status, "reason": reason}))
        self.assertEqual((errors._TIMEOUTS, errors._REFUSALS), (told["words"]["timeout"], told["words"]["refused"]))

    def test_words_of_reasons(self):
        told = vectors("reasons")
        self.assertEqual({"": "", **_entry.WORDS}, told["states"])
        self.assertEqual({name: f"unknown: {text}" for name, text in _properties.UNKNOWN.items()}, told["unknown"])


class Properties(unittest.TestCase):
    """tests/vectors/properties.json."""

    def setUp(self):
        self.told = vectors("properties")
        self.standing = _properties.Standing()
        self.standing.take_list(self.told["list"], "desk", "")

    def changed(self, name, change):
        place, value = change
        document = copy.deepcopy(self.told[name])
        *path, last = [one.replace("~1", "/").replace("~0", "~") for one in place.split("/")[1:]]
        at = document
        for one in path:
            at = at[int(one)] if isinstance(at, list) else at[one]
        at[int(last) if isinstance(at, list) else last] = value
        return document

    def test_list(self):
        listed = self.told["list"]["properties"]
        self.assertEqual([*self.standing.properties], [one["id"] for one in listed])
        for one in listed:
            told = self.standing.properties[one["id"]]
            for name in ("unit", "min", "max", "meaning", "refused"):
                self.assertEqual(getattr(told, name), one.get(name, getattr(told, name)), (one["id"], name))
        self.assertEqual([id for id, told in self.standing.properties.items() if told.is_button], ["io/5"])

    def test_members_that_are_left_out(self):
        for id, *derived in self.told["left_out"]:
            told = self.standing.properties[id]
            self.assertEqual([told.service, told.kind, told.type, told.access, told.name, told.choices], [*derived[:5], dict(derived[5])], id)

    def test_damaged_documents_are_refused(self):
        for change in self.told["damaged_lists"]:
            with self.assertRaises(ValueError, msg=change):
                _properties.Standing().take_list(self.changed("list", change), "desk", "")
        for change in self.told["damaged_values"]:
            with self.assertRaises(ValueError, msg=change):
                _properties.Standing().take_values(self.changed("values", change), "desk", "", 100)
        self.assertTrue(self.standing.take_values(self.told["values"], "desk", "", 100))
        known, unknown = self.standing.values["io/13"], self.standing.values["servo/0/angle"]
        self.assertEqual((known.value, known.how, known.why, known.since), (True, "set", "", 83))
        self.assertEqual((unknown.value, unknown.how, unknown.why, unknown.since), (None, "", "restart", 100 - 3.1))

    def test_commands_that_set_a_value(self):
        for one in self.told["set"]:
            told = self.standing.properties.get(one["id"])
            self.assertEqual([[service, request] for service, request in told.requests(one["value"])] if told else [], one["requests"], one)

    def test_words(self):
        for one in self.told["text"]:
            self.assertEqual(self.standing.properties[one["id"]].words(one["value"]), one["text"], one)

    def test_which_documents_count(self):
        for one in self.told["order"]:
            for take in ("take_list", "take_values"):
                standing = _properties.Standing()
                for session, seq, counts in (each or ("", 0, True) for each in one["documents"]):
                    document = {"version": 1, "board": "desk", "session": session, "seq": seq, "properties": [], "values": {}} if session else {}
                    self.assertEqual(getattr(standing, take)(document, "desk", one["holder"], *[0] * (take == "take_values")), counts, one)

    def test_when_nothing_that_was_reported_counts_any_more(self):
        for one in self.told["begins"]:
            standing = _properties.Standing()
            for session, seq, restarts, anew in (each or ("", 0, 0, False) for each in one["documents"]):
                document = {"version": 1, "board": "desk", "session": session, "seq": seq, "restarts": restarts, "values": {}} if session else {}
                counts = standing.take_values(document, "desk", "", 0)
                self.assertEqual(counts and standing.anew, anew, one)

    def test_what_is_told_of_buttons(self):
        for one in self.told["acts"]:
            standing = _properties.Standing()
            for each in one["documents"]:
                if each is None:
                    self.assertTrue(standing.take_values({}, "desk", "", 0))
                    self.assertEqual(standing.acts, [], one["about"])
                    continue
                values = {id: {"value": True, "how": "reported", "age": 0, "events": events} for id, events in each["events"].items()}
                standing.take_values({"version": 1, "board": "desk", "session": each["session"], "seq": each["seq"], "values": values}, "desk", "", 0, each.get("stored", False))
                self.assertEqual([[*act] for act in standing.acts], each["acts"], one["about"])


if __name__ == "__main__":
    unittest.main()
