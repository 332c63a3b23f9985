# SPDX-License-Identifier: Apache-2.0
"""Nothing that arrives ends or deafens a program: the corpora of the C++ fuzz targets, and structured mutations of good messages, on every
topic; and brokers that send what is no packet."""
import copy
import json
import pathlib
import random
import re
import threading
import unittest
import unittest.mock

import asip
from asip import _envelope, _model, _properties, board
from asip.testing import eventually
from memory_rig import Memory
from scripted_broker import PUBLISH, ScriptedBroker, good

ROOT = pathlib.Path(__file__).resolve().parents[2]
RUNS = 4000
ODD = [None, True, False, 0, -1, 1e300, -1e300, 10**18, 10**19, 10**30, float("nan"), float("inf"), float("-inf"), "", "x", "x" * 300, "\0", "\ud800", "é",
       "__proto__", "constructor", [], {}, [[]], [None], {"": None}, {"__proto__": {"is": "online"}}, {"is": "lost"}, ["servo"], [[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]
GOOD = {
    "board": "desk", "session": "00673f0000aaaaaa", "seq": 7, "lease": 60, "state": {"is": "online", "reason": "", "age": 12.5},
    "firmware": {"protocol": "0.4", "chip": "ATmega328P", "extensions": {"B": 1}}, "link": {"kind": "serial", "baud": 57600}, "agent": {"host": "pi"},
    "pins": {"capabilities": "1115", "owners": "@@II", "modes": "6613", "analog": {"14": 0}}, "on_demand": {"fastest": 20, "resting": 0},
    "services": [{"name": "io", "id": "I", "model": "io@1", "title": "Pins"}, {"name": "distance", "id": "D", "model": "distance@1", "count": 2, "period": 100},
                 {"name": "thermo", "id": "W", "model": {"name": "thermo", "version": 1, "id": "W", "events": {"e": {"name": "heat", "fields": [{"name": "value", "type": "number"}]}},
                                                         "commands": {"set": {"tag": "S", "safe": [0], "args": [{"name": "level", "type": "integer", "min": 0, "max": 9, "names": {"off": 0}}]}}}}],
    "labels": {"room": "lab"}, "names": {"services": {"distance": "front"}, "pins": {"13": "status lamp"}}}
TOPICS = ("asip/servicebus/desk/$description", "asip/servicebus/desk/$state", "asip/desk/io/out", "asip/desk/distance/out", "asip/servicebus/desk/$properties", "asip/desk/$values", "REPLY/desk", "REPLY/registry",
          "asip/servicebus/__proto__/$description", "asip/servicebus/a b/$state", "asip/servicebus//$state", "asip", "")


def corpora():
    """Each input on which a fuzz target ever failed, and each JSON object within."""
    for file in sorted((ROOT / "tests" / "fuzz").glob("*/corpus/**/*")):
        if file.is_file():
            payload = file.read_bytes()
            yield payload
            yield from re.findall(rb"\{.*?\}(?=[^,\]}\"]|$)", payload, re.DOTALL)


def places(value):
    """(container, key) of each value within."""
    for key in list(value) if isinstance(value, dict) else range(len(value)):
        yield value, key
        if isinstance(value[key], (dict, list)):
            yield from places(value[key])


def mutated(document, dice):
    made = copy.deepcopy(document)
    for _ in range(dice.choice((1, 1, 1, 2, 4))):
        where, key = dice.choice(list(places(made)))
        how = dice.randrange(4)
        if how == 0 and isinstance(where, dict):
            del where[key]
            where[dice.choice(("x", "__proto__", "", "1" * 400))] = copy.deepcopy(dice.choice(ODD))
        elif how == 1:
            where[key] = copy.deepcopy(dice.choice([one[key2] for one, key2 in places(document)]))
        else:
            where[key] = copy.deepcopy(dice.choice(ODD))
        if not made:
            break
    text = json.dumps(made)
    if dice.randrange(8) == 0:
        text = re.sub(r"\d+", lambda found: dice.choice((found[0], "9" * 400, "1e400", "-0", "1" + "0" * 25)), text)
    if dice.randrange(16) == 0:
        text = text[:dice.randrange(len(text))]
    return text.encode()


class Fuzz(Memory):
    def setUp(self):
        super().setUp()
        self.seen = []
        self.bus.watch(lambda board, state: self.seen.append(state))
        self.desk.pin(2).when_changed = self.seen.append
        self.desk.pin(13).on()
        self.desk.distance.on_value(self.seen.append)
        self.desk.set_meaning("io/5", "button")
        self.desk["io/5"].on_event(self.seen.append)
        self.stream = self.desk.distance.stream(lost="wait")

        self.odd = []
        self.bus._engine._faults.note = lambda what, fault: "are damaged" in str(fault) or self.odd.append(fault)  # damaged documents are told

    def give(self, topic, payload, retained=False, expiry=None):
        engine = self.bus._engine
        topic = topic.replace("REPLY", f"asip/reply/$nobody") + (f"/{engine.client}" if topic.startswith("REPLY") else "")
        engine._message(engine._link, topic, payload, retained, expiry)

    def use(self):
        """What programs read of boards: no message makes any of it raise but an error of the package."""
        for one in list(self.bus._boards.values()):
            for look in (lambda: one.state, lambda: one.reason, lambda: one.status, lambda: one.labels, lambda: one.services, lambda: dir(one),
                         lambda: one._repr_html_(), lambda: one.description, lambda: one.pin(13).name, lambda: one.pin("status lamp"), lambda: one.pin("A0"),
                         lambda: one._unknown_models(), lambda: [(each.unit, each.title, dir(each)) for each in one],
                         lambda: [getattr(each, name).__signature__ for each in one if each.model for name in each.model.attributes]):
                try:
                    look()
                except asip.Error:
                    pass

    def works(self):
        self.assertEqual(self.odd, [])
        self.memory.desk._seq = 10**18 + self.memory.desk._seq
        self.give(TOPICS[0], json.dumps({**GOOD, "session": "fffffffffffffff0", "seq": self.memory.desk._seq, "services": [{"name": "distance", "model": "distance@1"}]}).encode())
        self.desk.wait_for("online", timeout=5)
        self.assertEqual(list(self.desk.services), ["distance"])
        self.seen.clear()
        self.memory.desk.report("distance", [17, 4])
        eventually(lambda: [17, 4] in self.seen)

    def test_properties_and_values_are_taken_or_refused(self):
        told = json.loads((ROOT / "tests" / "vectors" / "properties.json").read_text())
        taken = 0
        for seed in range(RUNS // 10):
            dice, standing = random.Random(seed), _properties.Standing()
            standing.take_list(told["list"], "desk", "")
            for take, document in ((standing.take_list, told["list"]), (standing.take_values, told["values"]), (standing.take_answer, {**told["list"], **told["values"]})):
                made = _envelope.read_object(mutated(document, dice))
                with self.subTest(seed=seed, made=str(made)[:300]):
                    try:
                        take(made or {}, "desk", "", *{"take_list": [], "take_values": [1.0], "take_answer": [1.0, lambda name: True]}[take.__name__])
                        taken += 1
                    except ValueError:
                        pass
                    for id, one in standing.properties.items():
                        for value in (*(each.value for each in standing.values.values()), dice.choice(ODD), {"on": True, "brightness": dice.choice(ODD), "color": dice.choice(ODD)}):
                            one.words(value), one.wire(value), one.requests(value)
        self.assertGreater(taken, RUNS // 20)

    def test_corpora_on_each_topic(self):
        count = 0
        for payload in corpora():
            for topic in TOPICS:
                self.give(topic, payload, retained=count % 3 == 0, expiry=(None, 0, 7, 4_294_967_295)[count % 4])
                count += 1
            self.use()
        self.assertGreater(count, 3000)
        self.works()

    def test_mutations_on_each_topic(self):
        for seed in range(RUNS):
            dice = random.Random(seed)
            payload = mutated(dice.choice((GOOD, GOOD, {"distance": [1, 2], "digital": {"2": 1}, "analog": {"0": 320}},
                                           {"id": "1", "status": "error", "code": 7, "error": "x", "clock": "aa-1", "items": [{"board": "desk", "state": "lost", "description": GOOD}]})), dice)
            topic = TOPICS[0] if dice.randrange(3) else dice.choice(TOPICS)
            with self.subTest(seed=seed, topic=topic, payload=payload[:300]):
                self.give(topic, payload, dice.randrange(2) == 0, dice.choice((None, 0, 30, 2_999_999_000)))
                self.use()
                self.assertEqual(self.odd, [])
        self.works()

    def test_answers_of_a_registry(self):
        for seed in range(300):
            dice = random.Random(seed)
            items = [{"board": "desk", "state": "lost", "reason": "silent", "labels": {"a": "b"}, "services": [{"name": "servo"}], "description": GOOD},
                     {"name": "lights", "version": 3, "id": "Z", "commands": {"shine": {"tag": "S", "args": [{"name": "lamp", "type": "integer"}]}}}]
            answer = _envelope.read_object(mutated({"items": items}, dice)) or {"items": dice.choice(ODD)}
            with unittest.mock.patch.object(self.bus, "query", lambda *_, **__: {**answer, "cursor": ""}), self.subTest(seed=seed):
                try:
                    self.bus.boards()
                    self.bus._learn([self.desk], 0)
                except asip.Error:
                    pass
                self.use()

    def mutated_models(self):
        for seed in range(RUNS):
            dice = random.Random(seed)
            try:
                yield seed, json.loads(mutated(board.standard_model(dice.choice(("io", "motors", "lcd", "pixels", "tone"))).document, dice))
            except ValueError:
                pass

    def test_models_are_models_or_refused(self):
        for seed, document in self.mutated_models():
            try:
                model = _model.Model(document)
            except _model.ModelError:
                continue
            with self.subTest(seed=seed):
                for command in model.commands.values():
                    self.assertTrue(command.doc and command.signature)
                    try:
                        command.line(tuple(1 for _ in command.args), {})
                    except _model.ModelError:
                        pass


class Numbers(unittest.TestCase):
    def test_what_is_no_number_is_refused_and_large_whole_ones_are_doubles(self):
        for text in (b'{"a":NaN}', b'{"a":[Infinity]}', b'{"a":-Infinity}', b'{"a":1e400}', b'{"a":1.5E+999}', b'{"a":' + b"9" * 400 + b"}", b'{"a":"\\ud800"}',
                     b'{"a":' + b"[" * 40 + b"]" * 40 + b"}", b"[" * 100_000, b'{"a":' * 50_000):
            self.assertIsNone(_envelope.read_object(text), text[:40])
        self.assertEqual(_envelope.read_object(b'{"a":[1e300,' + b"9" * 30 + b',1234567890123456789,"NaN","\\ud83d\\ude00"]}'),
                         {"a": [1e300, 1e30, 1234567890123456789, "NaN", "\U0001f600"]})


class Faults(Memory):
    """What nobody thought of."""

    def test_message_that_raises_is_counted_logged_once_and_dropped(self):
        with unittest.mock.patch.object(self.bus._engine.session.catalogue, "on_state", side_effect=OverflowError("x")), self.assertLogs("asip", "ERROR") as logged:
            for _ in range(5):
                self.memory._publish("servicebus/desk/$state", "lost")
            eventually(lambda: self.bus._engine.faults == 5)
        self.assertEqual(len(logged.output), 1)
        self.desk.servo.write(0, 90)

    def test_sink_that_raises_keeps_no_other_from_its_value(self):
        engine, seen = self.bus._engine, []
        engine.do(lambda session, now: session.watch(now, "desk", "distance", lambda *_: 1 / 0, 1))
        self.desk.distance.on_value(seen.append)
        with self.assertLogs("asip", "ERROR"):
            self.memory.desk.report("distance", [1, 2])
            eventually(lambda: seen == [[1, 2]])

    def test_clock_whose_turn_raises_goes_on(self):
        engine, tick = self.bus._engine, self.bus._engine.session.tick
        turns = iter([ZeroDivisionError("x")] * 3)

        def ticked(now):
            fault = next(turns, None)
            if fault:
                raise fault
            return tick(now)
        with unittest.mock.patch.object(engine.session, "tick", ticked), self.assertLogs("asip", "ERROR"):
            engine.later(lambda: 1 / 0)
            eventually(lambda: engine.faults == 4)
            self.memory.cut()
            eventually(lambda: self.bus.connected)
        self.desk.servo.write(0, 90)


class Packets(unittest.TestCase):
    """A real paho-mqtt, and a broker that sends what is no packet: the connection counts as lost, and the next one serves."""

    def test_each_damaged_packet(self):
        hello = b"\x00\x04asip"
        for name, kind, body, flags in (("publish without a topic", PUBLISH, b"", 0), ("topic longer than the packet", PUBLISH, b"\xff\xffx", 0),
                                        ("properties of no kind", PUBLISH, hello + b"\x02\xff\xff{}", 0), ("packet of no kind", 0, b"xx", 0), ("auth", 15, b"\x18\x05\x15\x00\x01x", 0),
                                        ("suback of nothing", 9, b"", 0), ("connack again", 2, b"\xff", 0), ("topic that is no text", PUBLISH, b"\x00\x02\xff\xfe\x00{}", 0)):
            def damaged(connection):
                connection.accept()
                connection.send(kind, body, flags)
                connection.serve()
            with self.subTest(name):
                broker = ScriptedBroker(damaged, good)
                self.addCleanup(broker.close)
                bus = asip.connect(f"127.0.0.1:{broker.port}", timeout=4)
                self.addCleanup(bus.close)
                self.assertTrue(bus.connected)
                self.assertEqual(broker.faults, [])
                self.assertTrue(any(thread.name == "asip-clock" for thread in threading.enumerate()))


if __name__ == "__main__":
    unittest.main()
