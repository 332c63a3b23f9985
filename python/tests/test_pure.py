# SPDX-License-Identifier: Apache-2.0
"""What needs neither broker nor thread: models, errors, topics, clocks, settings, the catalogue and the session."""
import copy
import json
import pathlib
import pickle
import tempfile
import unittest

from asip import _clock, _commands, _envelope, _mdns, _model, _topics, errors, settings
from asip._calls import Drop, Publish, Resolve, Subscribe, Tell, Unsubscribe
from asip._session import DEMAND_LEASE, Hold, Session
from asip.board import standard_model

MODELS = sorted(file.stem for file in (pathlib.Path(_model.__file__).parent / "models").glob("*.json") if file.stem != "schema")


class Models(unittest.TestCase):
    def test_examples_of_each_standard_model_are_checked_in_the_agents_words(self):
        tried = 0
        for name in MODELS:
            model = standard_model(name)
            for example in model.document["examples"]:
                if example.get("wire", "").startswith("@") or '"0:' in json.dumps(example):  # events; items as text
                    continue
                (command, value), = example["json"].items()
                args, named = ((), value) if isinstance(value, dict) else ((), {}) if value is None or value is True else (
                    (value,), {}) if not isinstance(value, list) else (tuple(value), {})
                known = model.commands.get(command)
                if known and len(known.args) == 1 and known.args[0].type == "list" and isinstance(value, list):
                    args = (value,)
                with self.subTest(model=name, example=example):
                    tried += 1
                    if "error" in example:
                        with self.assertRaises(_model.ModelError) as raised:
                            model.command(command).values(args, named)
                        self.assertEqual(str(raised.exception), example["error"])
                    else:
                        self.assertEqual(model.command(command).line(args, named), example["wire"])
        self.assertGreater(tried, 80)

    def test_names_that_python_cannot_have(self):
        self.assertEqual(_model.identifier("stop-all"), "stop_all")
        self.assertEqual(_model.identifier("class"), "class_")
        self.assertEqual(_model.identifier("2nd"), "_2nd")

    def test_keyword_given_twice_or_unknown(self):
        write = standard_model("servo").command("write")
        self.assertEqual(write.values((0,), {"angle": 90}), [0, 90])
        for args, named in [((0, 1), {"angle": 2}), ((0,), {"servo": 1}), ((), {"angel": 1})]:
            with self.assertRaises(_model.ModelError):
                write.values(args, named)

    def test_numbers_that_say_that_there_is_no_value(self):
        document = {"name": "far", "events": {"e": {"name": "far", "fields": [{"name": "cm", "type": "integer", "none": 0}, {"name": "times", "type": "integer"}]}}}
        far = _model.Model(document).event("far")
        self.assertEqual(_commands.shown(far, [{"cm": 0, "times": 0}, {"cm": 4, "times": 1}]), [{"cm": None, "times": 0}, {"cm": 4, "times": 1}])
        self.assertEqual(_commands.shown(far, {"3": {"cm": 0}, "times": 0}), {"3": {"cm": None}, "times": 0})
        self.assertEqual(_commands.shown(standard_model("distance").event(None), {"0": 0, "7": 42}), {"0": None, "7": 42})
        self.assertEqual(_commands.shown(standard_model("io").event("digital"), {"2": 0}), {"2": 0})

    def test_safe_form(self):
        motors, io = standard_model("motors"), standard_model("io")
        self.assertEqual(motors.safe_form(motors.command("power"), [1, 60]), (motors.command("stop"), [1]))
        self.assertEqual(motors.safe_form(motors.command("drive"), [1, 60]), (motors.command("drive"), [0, 0]))
        self.assertEqual(io.safe_form(io.command("write"), [13, 1]), (io.command("write"), [13, 0]))
        servo = standard_model("servo")
        self.assertIsNone(servo.safe_form(servo.command("write"), [0, 1]))

    def test_what_is_no_model(self):
        for document in ({}, {"name": "x", "commands": 3}, {"name": "x", "events": {"e": {}}}, {"name": "x", "version": "y"}):
            with self.assertRaises(_model.ModelError):
                _model.Model(document)


class Errors(unittest.TestCase):
    def test_each_answer_has_its_class_and_says_whether_it_was_sent(self):
        table = [
            ({"status": "error", "code": 7, "error": "INVALID_DEVICE_NUMBER"}, errors.BoardError, RuntimeError, True),
            ({"status": "refused", "reason": "queue-full"}, errors.Refused, RuntimeError, False),
            ({"status": "refused", "reason": "board-not-there"}, errors.NotThere, LookupError, False),
            ({"status": "refused", "reason": "invalid", "error": "angle"}, errors.Invalid, ValueError, False),
            ({"status": "timeout"}, errors.Unproven, TimeoutError, None),
            ({"status": "timeout", "reason": "doubt"}, errors.Unproven, TimeoutError, None),
            ({"status": "what"}, errors.Unproven, TimeoutError, None),
            ({}, errors.Unproven, TimeoutError, None),
        ]
        for answer, kind, builtin, sent in table:
            with self.subTest(answer=answer):
                error = errors.from_answer(answer, board="desk", service="servo", command="write")
                self.assertIs(type(error), kind)
                self.assertIsInstance(error, (builtin, errors.Error))
                self.assertIs(error.sent, sent)
                self.assertIn("desk/servo write", str(error))
        self.assertIsNone(errors.from_answer({"status": "ok"}, board="desk"))

    def test_each_survives_a_copy_and_a_pickle(self):
        for kind in (errors.Invalid, errors.Refused, errors.NotThere, errors.Unproven, errors.Disconnected, errors.Closed):
            error = kind("text", board="desk", reason="why")
            for other in (pickle.loads(pickle.dumps(error)), copy.copy(error)):
                self.assertEqual((type(other), str(other), other.board, other.reason), (kind, "text", "desk", "why"))
        error = pickle.loads(pickle.dumps(errors.BoardError("text", code=7)))
        self.assertEqual(error.code, 7)


class Clocks(unittest.TestCase):
    def test_the_shortest_way_counts_and_a_new_start_begins_anew(self):
        clocks = _clock.Clocks()
        self.assertEqual(clocks.reading("desk", 1.0), "")
        clocks.note("desk", "aa-5000", 10.0, 10.4)
        self.assertEqual(clocks.reading("desk", 11.0), "aa-6001")
        clocks.note("desk", "aa-6200", 11.1, 11.2)  # 5.1 s behind ours at the most: less far ahead than known
        self.assertEqual(clocks.reading("desk", 12.0), "aa-7001")
        clocks.note("desk", "bb-10", 20.0, 20.1)
        self.assertTrue(clocks.reading("desk", 20.1).startswith("bb-"))

    def test_what_is_no_reading_is_ignored(self):
        clocks = _clock.Clocks()
        for reading in (None, 7, "", "aa", "-5", "aa-", "aa-x", "aa-" + "9" * 100, "aa-\u0661"):
            clocks.note("desk", reading, 1.0, 1.1)
        self.assertEqual(clocks.reading("desk", 2.0), "")


class Where(unittest.TestCase):
    def test_brokers(self):
        self.assertEqual(settings.Broker.parse("pi"), settings.Broker("pi", 1883, None))
        self.assertEqual(settings.Broker.parse("mqtts://pi"), settings.Broker("pi", 8883, True))
        self.assertEqual(settings.Broker.parse("[2001:db8::1]:99"), settings.Broker("2001:db8::1", 99, None))

    def test_mistakes_are_named_without_the_password(self):
        for text, hint in (("http://x", "only mqtt://"), ("mqtt://ann:secret@pi", "password="), ("2001:db8::1", "brackets"), ("pi:x", "pi:x"),
                           ("pi:0", "is not HOST"), ("pi:", "is not HOST"), ("pi:99999", "range")):
            with self.assertRaises(ValueError) as raised:
                settings.Broker.parse(text)
            self.assertIn(hint, str(raised.exception))
            self.assertNotIn("secret", str(raised.exception))

    def test_order_connect_environment_file_default(self):
        with tempfile.TemporaryDirectory() as home:
            pathlib.Path(home, "asip").mkdir()
            pathlib.Path(home, "asip", "asipctl.conf").write_text('broker = "lab:99"\nuser = "ann"\n')
            base = {"XDG_CONFIG_HOME": home}
            self.assertEqual(settings.find(environment=base).brokers[0].host, "lab")
            self.assertEqual(settings.find(environment={**base, "ASIP_BROKER": "b1,b2"}).brokers[1].host, "b2")
            self.assertEqual(settings.find("given", environment={**base, "ASIP_USER": "u"}).user, None)
            self.assertEqual(settings.find(environment={}).brokers[0].host, "127.0.0.1")
            pathlib.Path(home, "shed.conf").write_text("broker = shed\n[asip-agent]\nbroker = no\n[asipctl]\ntopic_root = lab\n")
            shed = settings.find(environment={**base, "ASIP_CONFIG": home + "/shed.conf"})
            self.assertEqual((shed.brokers[0].host, shed.root), ("shed", "lab"))
            with self.assertRaises(OSError):
                settings.find(environment={**base, "ASIP_CONFIG": home + "/nowhere"})

    def test_credentials(self):
        with tempfile.NamedTemporaryFile("w", suffix=".credentials") as file:
            file.write("\ufeffbroker = pi:8883\nuser = ann\npassword = a=b\ntopic-root = lab\n-----BEGIN CERTIFICATE-----\nx=y\n-----END CERTIFICATE-----\n")
            file.flush()
            found = settings.find(credentials=file.name)
            self.assertEqual((found.user, found.password, found.root, found.brokers[0].tls), ("ann", "a=b", "lab", True))
        with self.assertRaises(OSError):
            settings.find(credentials="/nowhere")


def described(board="desk", session="0000000001000000", seq=1, **more):
    return {"board": board, "session": session, "seq": seq, "lease": 60, "services": [{"name": "io"}], **more}


class Conversation(unittest.TestCase):
    """The session: calls, messages and time in, actions out."""

    def setUp(self):
        self.topics = _topics.Topics("asip", "ann", "c1")
        self.session = Session(self.topics, "c1", "anna")

    def ready(self, now=0.0):
        actions = self.session.connected(now, True)
        self.assertEqual(actions[0], Subscribe("asip/reply/ann/+/c1", 1))
        self.assertEqual(actions[-1], Publish("asip/reply/ann/$self/c1", b"hello", 1))
        return self.session.message(self.topics.own(), b"hello", False, None, now)

    def command(self, now=0.0, timeout=5.0, **more):
        return self.session.command(now, "desk", "servo", "write", {"write": [0, 90]}, timeout, **more)

    def answer(self, call, now, topic=None, **answer):
        return self.session.message(topic or self.topics.reply("desk"), json.dumps({"id": call.id, **answer}).encode(), False, None, now)

    def test_command_and_answer(self):
        self.ready()
        call, (publish,) = self.command()
        request = json.loads(publish.payload)
        self.assertEqual(publish.topic, "asip/desk/servo/in")
        self.assertEqual(request, {"write": [0, 90], "reply_to": "asip/reply/ann/desk/c1", "id": call.id, "deadline_ms": 5000, "clock": "", "by": "anna"})
        (done,) = self.answer(call, 0.1, status="ok", proof="fence", clock="aa-100")
        self.assertEqual((done.future, done.error), (call.future, None))
        self.assertEqual(self.answer(call, 0.2, status="ok"), [])  # twice
        _, (publish,) = self.command(now=1.0)
        self.assertEqual(json.loads(publish.payload)["clock"], "aa-1101")

    def test_link_is_a_request_of_this_user(self):
        self.ready()
        call, (publish,) = self.session.link(0.0, "lamp", {"set": {"name": "l", "from": "desk/io/2", "to": "io/13"}}, 5.0)
        self.assertEqual(publish.topic, "asip/lamp/$link/ann/c1")
        self.assertEqual(json.loads(publish.payload)["set"], {"name": "l", "from": "desk/io/2", "to": "io/13"})
        (done,) = self.answer(call, 0.1, topic=self.topics.reply("lamp"), status="refused", reason="invalid", error="there is no property io/13")
        self.assertIsInstance(done.error, errors.Invalid)

    def test_answers_of_others_prove_nothing(self):
        self.ready()
        call, _ = self.command()
        self.assertEqual(self.answer(call, 0.1, topic=self.topics.reply("lamp"), status="ok"), [])
        self.assertEqual(self.session.message(self.topics.reply("desk"), b"{", False, None, 0.1), [])
        self.assertEqual(self.session.message(self.topics.reply("desk"), b'{"id":7}', False, None, 0.1), [])
        (done,) = self.answer(call, 0.2, status="error", code=7, error="INVALID_DEVICE_NUMBER")
        self.assertIsInstance(done.error, errors.BoardError)

    def test_nothing_is_sent_before_the_way_back_is_proven(self):
        call, actions = self.command()
        self.assertEqual(actions, [])
        self.session.connected(1.0, True)
        sent = self.session.message(self.topics.own(), b"hello", False, None, 1.1)
        self.assertEqual(json.loads(sent[0].payload)["deadline_ms"], 3900)  # what is left of its time

    def test_way_back_that_does_not_work_drops_the_connection(self):
        self.session.connected(0.0, True)
        actions, _ = self.session.tick(5.1)
        self.assertIsInstance(actions[0], Drop)
        self.assertIn("access rules", actions[0].why)

    def test_never_sent_is_disconnected_and_broken_after_sending_is_unproven(self):
        call, _ = self.command()
        (done,), _ = self.session.tick(5.0)
        self.assertIsInstance(done.error, errors.Disconnected)
        self.assertIs(done.error.sent, False)
        self.ready(6.0)
        call, _ = self.command(6.0)
        (done,) = self.session.disconnected(6.5, "cut")
        self.assertIsInstance(done.error, errors.Unproven)
        self.assertIsNone(done.error.sent)
        self.assertEqual(self.ready(7.0), [])  # it is not sent again

    def test_no_answer_is_unproven_after_the_deadline_that_the_agent_knows(self):
        self.ready()
        call, _ = self.command(timeout=1.0)
        self.assertEqual(self.session.tick(1.2)[0], [])
        (done,), _ = self.session.tick(1.6)
        self.assertIsInstance(done.error, errors.Unproven)

    def test_what_the_broker_denies_was_not_sent(self):
        self.ready()
        call, _ = self.session.command(0, "desk", "servo", "write", {"write": [0, 90]}, 5)
        ends = self.session.calls.denied(call.id)
        self.assertEqual((type(ends[0].error), ends[0].error.reason, ends[0].error.sent), (errors.Refused, "denied", False))
        self.assertEqual(self.session.calls.denied(call.id), [])

    def test_lost_board_is_refused_here(self):
        self.ready()
        self.session.look_at("desk")
        self.session.message("asip/servicebus/desk/$state", b"lost", True, None, 0)
        _, (done,) = self.command()
        self.assertIsInstance(done.error, errors.NotThere)
        self.assertIn("nothing was sent", str(done.error))

    def test_what_comes_behind_the_end_of_a_subscription_changes_nothing(self):
        self.ready()
        self.session.look_at("+")
        description = json.dumps(described(state={"is": "online", "age": 1})).encode()
        self.session.message("asip/servicebus/desk/$description", description, True, 60, 0)
        self.session.look_away("+")
        self.assertEqual(self.session.message("asip/servicebus/desk/$state", b"online", True, None, 0), [])
        self.assertEqual(self.session.catalogue.names(), ["desk"])

    def test_demand_is_told_repeated_and_ended(self):
        self.ready()
        self.session.look_at("desk")
        sink = lambda *_: None  # noqa: E731
        actions = self.session.watch(0, "desk", "distance", sink, 20)
        self.assertEqual(actions, [Subscribe("asip/desk/distance/out", 0)])  # it is not known yet whether the board wants to be told
        told = self.session.message("asip/servicebus/desk/$description", json.dumps(described(on_demand={"fastest": 20})).encode(), False, None, 1)
        self.assertEqual(json.loads(told[0].payload), {"services": {"distance": 20}, "lease": DEMAND_LEASE})
        self.assertEqual(self.session.tick(3)[0], [])
        again, _ = self.session.tick(6.1)
        self.assertEqual(again[0].topic, "asip/servicebus/desk/$demand/ann/c1")
        ended = self.session.unwatch(7, "desk", "distance", sink)
        self.assertEqual(ended[0], Unsubscribe("asip/desk/distance/out"))
        self.assertEqual(json.loads(ended[1].payload)["services"], {})
        self.assertEqual(self.session.tick(40)[0], [])

    def test_values_go_to_each_who_watches_and_damaged_ones_to_none(self):
        self.ready()
        seen = []
        sink = lambda *args: seen.append(args)  # noqa: E731
        self.session.watch(0, "desk", "distance", sink, 1)
        self.assertEqual(self.session.message("asip/desk/distance/out", b'{"distance":[1]}', False, None, 1), [Tell(sink, ({"distance": [1]}, 1, False))])
        for payload in (b"[1]", b"{", b"\xff", b"[" * 100_000):
            self.assertEqual(self.session.message("asip/desk/distance/out", payload, False, None, 1), [])

    def test_hold_is_renewed_in_time_while_it_is_fed(self):
        self.ready()
        lost = []
        self.session.keep_hold(Hold("desk", "asip/desk/motors/in", "h1", 0.6, 0.2, feed=1.0, fed=0.0, lost=lambda *args: lost.append(args)))
        (renewal,), due = self.session.tick(0.2)
        self.assertEqual(json.loads(renewal.payload)["renew"], "h1")
        self.assertAlmostEqual(due, 0.4)
        self.assertEqual(self.session.tick(1.3)[0], [])  # the program does not feed it any more
        self.session.feed("h1", 1.4)
        self.assertEqual(len(self.session.tick(1.6)[0]), 1)
        told = self.session.message(self.topics.reply("desk"), b'{"id":"h1/renewal","status":"refused","reason":"not-held"}', False, None, 2)
        self.assertIsInstance(told[0], Tell)
        self.assertEqual(self.session.tick(9)[0], [])

    def test_hold_of_a_broken_connection_is_told_and_not_renewed_over_the_next(self):
        self.ready()
        sink = lambda *_: None  # noqa: E731
        self.session.keep_hold(Hold("desk", "asip/desk/motors/in", "h1", 0.6, 0.2, lost=sink))
        self.assertEqual(self.session.disconnected(0.3, "cut"), [Tell(sink, ("the connection to the broker broke",))])
        self.ready(0.4)
        self.assertEqual(self.session.tick(2)[0], [])

    def test_query_and_silent_registry(self):
        self.ready()
        call, (publish,) = self.session.query(0, {"find": "boards"}, 1.0)
        self.assertNotIn("deadline_ms", json.loads(publish.payload))
        (done,) = self.session.message(self.topics.reply("registry"), json.dumps({"id": call.id, "items": []}).encode(), False, None, 0.1)
        self.assertEqual(done.result["items"], [])
        call, _ = self.session.query(0, {"find": "boards"}, 1.0)
        (done,), _ = self.session.tick(1.6)
        self.assertIsInstance(done.error, errors.NotThere)

    def test_too_long_request_is_refused_here(self):
        self.ready()
        _, (done,) = self.session.command(0, "desk", None, "raw", {"raw": "x" * 20_000}, 5.0)
        self.assertIsInstance(done.error, errors.Invalid)

    def test_close_ends_everything(self):
        self.ready()
        self.command()
        ends = [action for action in self.session.close() if isinstance(action, Resolve)]
        self.assertIsInstance(ends[0].error, errors.Unproven)

    def test_topics_and_names(self):
        self.assertTrue(_topics.valid_name("a.b-c_9"))
        for name in ("", ".", "..", "a/b", "a b", "é", "x" * 65):
            self.assertFalse(_topics.valid_name(name))
        self.assertFalse(_topics.valid_board("servicebus"))
        self.assertEqual(_topics.user_level("a/b"), "$nobody")
        self.assertIsNone(_envelope.read_object(b"[]"))


class Announcements(unittest.TestCase):
    """An answer of Avahi 0.8 to question(0x1234), and what no packet may do."""

    ANSWER = bytes.fromhex(
        "123484000001000500000000055f6d717474045f746370056c6f63616c00000c0001c00c000c00010000000a00141142"
        "726f6b6572206f6620746865206c6162c00cc02e001000010000000a000100c02e002100010000000a000b0000000007"
        "6b027069c017c061001c00010000000a001000000000000000000000000000000001c061000100010000000a00040a09"
        "0801")

    def test_an_answer_names_broker_address_and_port(self):
        self.assertEqual(_mdns.announced(self.ANSWER, 0x1234, "10.0.0.9"), [_mdns.Announced("Broker of the lab", "10.9.8.1", 1899)])

    def test_without_an_address_the_sender_is_meant(self):
        packet = bytearray(self.ANSWER)
        packet[-13] = 16  # the address record becomes a text
        self.assertEqual(_mdns.announced(bytes(packet), 0x1234, "10.0.0.9"), [_mdns.Announced("Broker of the lab", "10.0.0.9", 1899)])

    def test_what_was_not_asked_is_no_answer(self):
        self.assertEqual(_mdns.announced(self.ANSWER, 0x1235, "10.0.0.9"), [])
        self.assertEqual(_mdns.announced(_mdns.question(0x1234), 0x1234, "10.0.0.9"), [])

    def test_cut_and_damaged_packets_harm_nothing(self):
        for size in range(len(self.ANSWER)):
            self.assertLessEqual(len(_mdns.announced(self.ANSWER[:size], 0x1234, "10.0.0.9")), 1)
        for at in range(len(self.ANSWER)):
            for bit in range(8):
                packet = bytearray(self.ANSWER)
                packet[at] ^= 1 << bit
                self.assertLessEqual(len(_mdns.announced(bytes(packet), 0x1234, "10.0.0.9")), 1)
        loop = self.ANSWER[:12] + b"\xc0\x0c" * 40
        self.assertEqual(_mdns.announced(loop, 0x1234, "10.0.0.9"), [])

    def test_the_question_is_as_the_standard_wants_it(self):
        self.assertEqual(_mdns.question(0xABCD), b"\xab\xcd\0\0\0\1\0\0\0\0\0\0\5_mqtt\4_tcp\5local\0\0\x0c\0\1")

    def test_only_a_bus_that_nothing_names_is_searched(self):
        for given, environment in (({"broker": "pi"}, {}), ({}, {"ASIP_BROKER": "pi"}), ({"user": "ann", "password": "x"}, {}), ({}, {"ASIP_USER": "ann"}),
                                   ({}, {"ASIP_CERT": "x", "ASIP_KEY": "y"})):
            self.assertFalse(settings.find(**given, environment=environment).is_default, (given, environment))
        self.assertTrue(settings.find(environment={}).is_default)


if __name__ == "__main__":
    unittest.main()
