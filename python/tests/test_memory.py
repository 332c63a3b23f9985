# SPDX-License-Identifier: Apache-2.0
"""The whole package over a bus in memory: commands, values, holds, pins, odd input."""
import datetime
import gc
import json
import re
import threading
import time
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


class Commands(Memory):
    def test_executed_refused_doubtful_and_silent(self):
        self.assertIsNone(self.desk.servo.write(0, angle=90))
        self.assertEqual(self.commands(), [("servo", "write", [0, 90])])
        self.memory.desk.fail(7)
        with self.assertRaises(asip.BoardError) as raised:
            self.desk.servo.write(9, 90)
        self.assertEqual((raised.exception.code, raised.exception.sent, raised.exception.command), (7, True, "write"))
        self.memory.desk.refuse()
        with self.assertRaises(asip.Refused):
            self.desk.servo.write(0, 90)
        self.memory.desk.doubt()
        with self.assertRaises(asip.Unproven):
            self.desk.servo.write(0, 90)
        self.memory.desk.silence()
        with self.assertRaises(TimeoutError):
            self.desk.servo.write(0, 90, timeout=0.05)
        self.memory.desk.work()
        self.desk.servo.write(0, 90)

    def test_mistakes_are_found_before_anything_is_sent(self):
        for call in (lambda: self.desk.servo.write(0, 181), lambda: self.desk.servo.write(0), lambda: self.desk.servo.write(0, 1, 2),
                     lambda: self.desk.servo.write(servo=0, angel=1), lambda: self.desk.servo.command("wriet", 0, 1),
                     lambda: self.desk.servo.write(0, 90, timeout=0), lambda: self.bus.board("a/b"), lambda: self.desk.servo.read()):
            with self.assertRaises(ValueError) as raised:
                call()
            self.assertIsInstance(raised.exception, asip.Invalid)
        self.assertEqual(self.commands(), [])

    def test_lost_board_and_unknown_board(self):
        self.memory.desk.lose()
        eventually(lambda: self.desk.state == "lost")
        with self.assertRaises(asip.NotThere) as raised:
            self.desk.servo.write(0, 90)
        self.assertIn("cable unplugged", str(raised.exception))
        with self.assertRaises(asip.NotThere) as raised:
            self.bus.board("dsek", timeout=0.2)
        self.assertIn('did you mean "desk"', str(raised.exception))
        self.memory.desk.back()
        self.desk.wait_for("online")

    def test_broken_connection_before_and_after_sending(self):
        self.memory.desk.silence()
        future = self.desk.servo.begin("write", 0, 90)
        eventually(lambda: self.memory.desk.unanswered == 1)
        self.memory.cut()
        with self.assertRaises(asip.Unproven):
            future.result(5)
        self.memory.desk.work()
        eventually(lambda: self.bus.connected)
        self.desk.servo.write(0, 91)
        self.assertEqual(self.commands(), [("servo", "write", [0, 91])])  # the first one was not sent again

    def test_state_is_not_known_while_the_broker_is_not_heard(self):
        seen = []
        disconnected = self.desk._engine.session.disconnected

        def while_disconnected(now, why):
            actions = disconnected(now, why)
            seen.append((self.desk.state, self.desk.reason, self.desk.online, self.desk.status))
            return actions
        with unittest.mock.patch.object(self.desk._engine.session, "disconnected", while_disconnected):
            self.memory.cut()
            eventually(lambda: seen)
        state, reason, online, status = seen[0]
        self.assertEqual((state, reason, online), ("unknown", "", False))
        self.assertRegex(status, r"^not known since \d\d:\d\d:\d\d, when the broker was heard last; it was online")
        self.desk.wait_for("online")

    def test_stop_that_holds(self):
        self.desk.stop(hold=True, why="lesson is over")
        with self.assertRaises(asip.Refused) as refused:
            self.desk.pin(13).write(True)
        self.assertEqual(refused.exception.reason, "stopped")
        self.desk.resume()
        self.desk.pin(13).write(True)
        self.desk.stop()
        self.desk.pin(13).write(False)

    def test_stop_of_all_boards(self):
        self.bus.stop(["desk", "lamp"])
        self.assertEqual(self.commands("lamp")[-1], ("", "stop", []))

    def test_from_many_threads(self):
        def work(servo):
            for angle in range(50):
                self.desk.servo.write(servo, angle)
        threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for servo in range(8):
            self.assertEqual([values[1] for _, _, values in self.commands() if values[0] == servo], list(range(50)))


    def test_services_are_whole_for_a_thread_beside_the_one_that_reads_them(self):
        desk, reads, go, seen = self.desk, threading.Event(), threading.Event(), []
        desk._described, desk._services = ("", -2), {}
        read_services = desk._read_services

        def slowly(description):
            reads.set()
            go.wait(5)
            read_services(description)
        with unittest.mock.patch.object(desk, "_read_services", slowly):
            threads = [threading.Thread(target=lambda: seen.append(sorted(desk.services))) for _ in range(2)]
            threads[0].start()
            reads.wait(5)
            threads[1].start()
            threads[1].join(0.05)
            go.set()
            for thread in threads:
                thread.join()
        self.assertEqual(seen, [["distance", "io", "motors", "servo"]] * 2)


class OddInput(Memory):
    """What people type by mistake: each is an error at once that says what is wrong, and nothing is sent."""

    CALLS = """
        desk.servo.write(0, 90, timeout="x")    desk.servo.write(0, 90, timeout=True)   desk.servo.write(0, 90, timeout=float("nan"))
        desk.pin(13).write("up")                desk.pin(13).write(None)                desk.pin(13).write(2)
        desk.pin(None)                          desk.pin(13.5)                          desk.pin(True)
        desk.pin(-1)                            desk.pin("13")                          desk.pin(3).pwm(300)
        desk.pin(3).pwm("5")                    desk.pin(2).wait_for("x")               desk.pin(2).wait_for(True, timeout="x")
        bus.board(5)                            bus.board(None)                         bus.board("desk", timeout="5")
        bus.boards(timeout="5")                 bus.query("x")                          bus.query({"find": "boards", "x": object()})
        bus.query({"find": "shoes"})            desk.raw(b"x")                          desk.wait_for("onlin")
        desk.io.hold()                          desk.io.hold(write=[13, 1], seconds=0)  desk.io.hold(write=[13, 1], seconds="a")
        desk.io.hold(write=[13, 1], feed=-1)    desk.distance.stream(hz=0)              desk.distance.stream(hz="a")
        desk.distance.stream(hz=float("nan"))   desk.distance.stream(keep="a")          desk.distance.stream(keep=0)
        desk.distance.stream(timeout="a")       desk.distance.stream(event=5)           desk.distance.on_value(print, hz=-1)
        bus.run("x")                            asip.connect(5)                         asip.connect("")
        asip.connect(timeout="a")               asip.connect("http://pi")               desk.distance.read("nothing")
    """

    def test_each_is_invalid(self):
        calls = [one for line in self.CALLS.strip().splitlines() for one in re.split(r"\s{2,}", line.strip())]
        self.assertGreater(len(calls), 40)
        for call in calls:
            with self.subTest(call), self.assertRaises(asip.Invalid) as raised:
                eval(call, {"desk": self.desk, "bus": self.bus, "asip": asip})
            self.assertNotRegex(str(raised.exception), r"object has no|unsupported operand|not supported between")
        self.assertEqual(self.commands(), [])

    def test_what_is_meant_works(self):
        self.desk.pin(13).write("off")
        self.assertEqual(self.memory.desk.levels[13], 0)
        self.desk.pin(13).write("on")
        self.assertEqual(self.memory.desk.levels[13], 1)
        self.memory.desk.press(2)
        self.desk.pin(2).wait_for(1, timeout=5)
        self.assertIn("servo", self.desk)
        self.assertNotIn("sevro", self.desk)
        self.bus.stop("desk")
        self.assertEqual(self.commands()[-1], ("", "stop", []))
        with self.assertRaises(LookupError):
            self.desk[0]


class Values(Memory):
    def test_read_asks_a_board_that_reports_nothing(self):
        with self.assertRaises(asip.Unproven):
            self.desk.distance.read()
        self.memory.desk.report("distance", [42, 0])
        self.assertEqual(self.desk.distance.read(), [42, None], "the second sensor got no echo")
        self.assertEqual((self.desk.distance[0].read(), self.desk.distance[1].read()), (42, None))
        with self.assertRaises(asip.Invalid):
            self.desk.distance[2].read()
        self.assertEqual(self.desk.distance.unit, "cm")

    def test_stream_gives_the_newest_and_counts_the_others(self):
        stream = self.desk.distance.stream(details=True)
        for value in range(10):
            self.memory.desk.report("distance", [value, 0])
        eventually(lambda: stream.dropped == 9)
        reading = next(stream)
        self.assertEqual((reading.value, reading.unit), ([9, None], "cm"))
        stream.close()
        self.assertEqual(list(stream), [])

    def test_stream_of_a_board_that_reports_nothing_says_what_to_do(self):
        with unittest.mock.patch("asip.stream._SILENCE_SECONDS", 0.1), self.assertLogs("asip", "WARNING") as logged:
            threading.Timer(0.5, lambda: self.memory.desk.report("distance", [1, 2])).start()
            self.assertEqual(next(self.desk.distance.stream()), [1, 2])
        self.assertIn("desk.distance.report(100)", logged.output[0])
        with self.assertRaises(asip.Unproven) as raised:
            next(self.desk.distance.stream(timeout=0.1))
        self.assertIn("desk.distance.report(100)", str(raised.exception))

    def test_stream_that_keeps_loses_nothing(self):
        with self.desk.distance.stream(keep=2000) as stream:
            for value in range(1, 1001):
                self.memory.desk.report("distance", [value, 0])
            self.assertEqual([next(stream)[0] for _ in range(1000)], list(range(1, 1001)))

    def test_stream_ends_when_the_board_is_lost_or_waits(self):
        stream, waiting = self.desk.distance.stream(), self.desk.distance.stream(lost="wait", timeout=5)
        self.memory.desk.lose()
        with self.assertRaises(asip.NotThere):
            next(stream)
        self.memory.desk.back()
        self.desk.wait_for("online")
        self.memory.desk.report("distance", [1, 1])
        self.assertEqual(next(waiting), [1, 1])

    def test_forgotten_stream_ends_its_subscription(self):
        stream = self.desk.distance.stream()
        topic = "asip/desk/distance/out"
        self.assertTrue(self.bus._engine.peek(lambda session: topic in session._filters))
        del stream
        gc.collect()
        eventually(lambda: not self.bus._engine.peek(lambda session: topic in session._filters))

    def test_callback_may_command_and_block_and_raise(self):
        seen = []

        def react(value):
            self.desk.servo.write(0, value[0])
            seen.append(value)
            if len(seen) == 1:
                raise RuntimeError("once")
        faults = []
        self.bus.on_error = faults.append
        watch = self.desk.distance.on_value(react)
        with self.assertLogs("asip", "ERROR"):
            self.memory.desk.report("distance", [10, 0])
            eventually(lambda: faults)
        self.memory.desk.report("distance", [11, 0])
        eventually(lambda: len(seen) == 2)
        self.assertEqual(self.commands()[-1], ("servo", "write", [0, 11]))
        watch.cancel()
        watch.cancel()
        self.memory.desk.report("distance", [12, 0])
        time.sleep(0.05)
        self.assertEqual(len(seen), 2)

    def test_blocked_callback_delays_no_answer(self):
        blocked = threading.Event()
        self.desk.distance.on_value(lambda: blocked.wait(5))
        self.memory.desk.report("distance", [1, 0])
        began = time.monotonic()
        self.desk.servo.write(0, 1)
        self.assertLess(time.monotonic() - began, 2)
        blocked.set()

    def test_callback_that_cannot_be_called_is_refused_at_once(self):
        with self.assertRaises(TypeError):
            self.desk.distance.on_value(lambda a, b: None)
        with self.assertRaises(TypeError):
            self.desk.distance.on_value(7)


class Holds(Memory):
    def test_held_while_the_block_runs_and_undone_at_its_end(self):
        with self.desk.motors.hold(power=[[0, 60], [1, 60]], seconds=0.1) as hold:
            self.assertEqual(self.commands(), [("motors", "power", [0, 60]), ("motors", "power", [1, 60])])
            hold.set(power=[0, 30])
        self.assertEqual(sorted(self.commands()[3:]), [("motors", "stop", [0]), ("motors", "stop", [1])])

    def test_undone_where_the_block_raises(self):
        with self.assertRaises(KeyError):
            with self.desk.motors.hold(power=[0, 60]):
                raise KeyError("x")
        self.assertEqual(self.commands()[-1], ("motors", "stop", [0]))

    def test_what_nothing_undoes_cannot_be_held(self):
        with self.assertRaises(asip.Invalid):
            with self.desk.servo.hold(write=[0, 90]):
                self.fail("not reached")

    def test_hold_that_ended_early_is_told_at_the_end(self):
        with self.assertRaises(asip.Refused):
            with self.desk.motors.hold(power=[0, 60], seconds=0.1) as hold:
                self.memory.cut()
                eventually(lambda: hold.lost)
                eventually(lambda: self.bus.connected)


class Pins(Memory):
    def test_output(self):
        pin = self.desk.pin(13)
        pin.on()
        self.assertEqual(self.memory.desk.levels[13], 1)
        pin.toggle()
        self.assertEqual(self.memory.desk.levels[13], 0)
        self.assertIs(pin.read(), False)
        self.assertEqual(self.memory.desk.modes[13], 3)

    def test_input_tells_changes_and_again_when_the_board_returns(self):
        seen = []
        button = self.desk.pin(2)
        button.on_change(seen.append, initial=True)
        eventually(lambda: seen == [False])
        self.memory.desk.press(2)
        eventually(lambda: seen == [False, True])
        self.memory.desk.lose()
        eventually(lambda: self.desk.state == "lost")
        self.memory.desk._inputs[2] = 0  # it changes while the board is away
        self.memory.desk.modes.clear()
        self.memory.desk.back()
        eventually(lambda: seen == [False, True, False] and self.memory.desk.modes.get(2) == 2)

    def as_set(self, pin, **done):
        """Another program sets a pin of the desk: mode=3, write=1, pwm=128."""
        for command, value in done.items():
            self.memory.desk._set_pin(command, [pin, value])

    def test_reading_sets_nothing_whatever_the_pin_is(self):
        self.as_set(13, mode=3, write=1)
        self.as_set(3, pwm=128)
        self.as_set(12, mode=3)
        self.as_set(4, mode=2)
        self.memory.desk.press(4)
        seen, desk = [], self.memory.connect(timeout=5).board("desk")
        self.assertIs(desk.pin(13).read(), True)
        self.assertEqual(desk.pin(3).read(), 128)
        with self.assertRaises(asip.Unproven) as raised:
            desk.pin(12).read()
        self.assertIn("nothing was reported or set yet", str(raised.exception))
        desk.pin(13).wait_for(True, timeout=5)
        desk.pin(13).on_change(seen.append, initial=True)
        desk.pin("A0").when_changed = seen.append
        for call in (lambda: desk.pin(2).read(), lambda: desk.pin("A1").wait_for(True), lambda: desk.pin(3).wait_for(True)):
            with self.assertRaises(asip.Invalid) as raised:
                call()
            self.assertIn('.mode("input-pullup")', str(raised.exception))
        self.assertIs(desk.pin(4).read(), True)
        self.assertEqual(self.commands(), [])
        self.as_set(13, write=0)
        eventually(lambda: seen == [True, False])
        self.assertIs(desk.pin(13).read(), False)
        self.assertEqual(self.commands(), [])

    def test_toggle_works_from_what_any_program_set(self):
        self.as_set(13, mode=3, write=1)
        self.desk.pin(13).toggle()
        self.assertEqual(self.commands(), [("io", "write", [13, 0])])
        self.as_set(13, write=1)
        eventually(lambda: self.desk.pin(13).read() is True)
        self.desk.pin(13).toggle()
        self.desk.pin(13).toggle()
        self.assertEqual(self.memory.desk.levels[13], 1)
        self.desk.pin(7).toggle()  # nothing was set on it
        self.assertEqual(self.commands()[-2:], [("io", "mode", [7, 3]), ("io", "write", [7, 1])])

    def test_input_keeps_the_mode_that_another_program_gave_it(self):
        self.as_set(4, mode=1)
        self.memory.desk.press(4)
        self.desk.pin(4).wait_for(True, timeout=5)
        self.assertIs(self.desk.pin(4).read(), True)
        self.memory.desk.press(4, 0)
        self.desk.pin(4).wait_for(False, timeout=5)
        self.assertEqual(self.commands(), [])  # its agent knows the level

    def test_read_of_an_input_that_the_program_made(self):
        button = self.desk.pin(2)
        button.mode("input-pullup")
        self.assertIs(button.read(), False)
        self.memory.desk.press(2)
        eventually(lambda: button.read() is True)

    def test_analog_pin_by_name(self):
        knob = self.desk.pin("A0")
        self.assertEqual((knob.number, self.desk.pin("A5").number), (14, 19))
        with self.assertRaises(asip.Invalid):
            self.desk.pin("A6")
        with self.assertRaises(asip.Unproven):
            knob.read(timeout=0.1)
        threading.Timer(0.1, lambda: self.memory.desk.report("io", {"0": 512, "1": 3}, "analog")).start()
        self.assertEqual(knob.read(timeout=5), 512)
        seen = []
        knob.when_changed = seen.append
        for value in (512, 512, 600):
            self.memory.desk.report("io", {"0": value}, "analog")
        eventually(lambda: seen == [600])
        self.assertEqual(self.commands(), [])

    def test_returning_board_whose_input_became_an_output_meanwhile_keeps_it(self):
        button = self.desk.pin(2)
        button.mode("input-pullup")
        self.memory.desk.lose()
        eventually(lambda: self.desk.state == "lost")
        self.as_set(2, mode=3, write=1)
        self.memory.desk.back()
        self.desk.wait_for("online")
        self.assertIs(button.read(), True, "the agent sets levels of outputs again")
        self.as_set(2, write=0)
        self.assertIs(button.read(), False)
        self.desk.servo.write(0, 1)
        self.assertEqual(self.memory.desk.modes[2], 3)

    def test_what_was_set_ends_when_the_board_restarts(self):
        self.as_set(13, mode=3, write=1)
        lamp = self.desk.pin(13)
        self.assertIs(lamp.read(), True)
        self.memory.desk.lose()
        self.desk.wait_for("lost")
        self.memory.desk.modes.clear()
        self.memory.desk.back()
        self.desk.wait_for("online")
        with self.assertRaises(asip.Unproven) as raised:
            lamp.read()
        self.assertIn("since the board came back", str(raised.exception))
        lamp.on()
        self.assertEqual(self.commands(), [("io", "mode", [13, 3]), ("io", "write", [13, 1])])
        self.memory.desk.lose()
        self.memory.desk.back()
        self.desk.wait_for("online")
        self.assertIs(lamp.read(), True, "the agent sets levels of outputs again")

    def test_read_sees_each_command_that_was_answered_before_and_many_reads_at_once_are_few_questions(self):
        asked, questioned = [], self.memory.desk._questioned
        self.memory.desk._questioned = lambda services: asked.append(services) or questioned(services)
        lamp = self.desk.pin(13)
        for number in range(30):
            self.as_set(13, write=number % 2) if number % 3 else lamp.write(number % 2)
            self.assertIs(lamp.read(timeout=5), bool(number % 2), number)
        began, done = time.monotonic(), []
        readers = [threading.Thread(target=lambda: done.append(lamp.read(timeout=5))) for _ in range(100)]
        for reader in readers:
            reader.start()
        for reader in readers:
            reader.join()
        self.assertEqual(done, [True] * 100)
        self.assertLess(len(asked), 70)
        self.assertLess(time.monotonic() - began, 3)

    def test_level_of_an_input_is_read_in_a_fast_loop(self):
        button = self.desk.pin(2)
        button.mode("input-pullup")
        began = time.monotonic()
        for number in range(500):
            self.assertIs(button.read(), False)
        self.assertLess(time.monotonic() - began, 3)

    def test_agent_that_does_not_tell_how_its_board_stands(self):
        self.memory.desk._questioned = lambda services: None
        with self.assertRaises(asip.Unproven) as raised:
            self.desk.pin(13).read(timeout=0.3)
        self.assertIn("update asip-agent", str(raised.exception))
        self.assertEqual(self.commands(), [])
        self.desk.pin(13).on()  # without it, too
        self.assertEqual(self.memory.desk.levels[13], 1)

    def test_wait_for_and_function_without_argument(self):
        called = threading.Event()
        self.desk.pin(2).when_changed = called.set
        threading.Timer(0.05, lambda: self.memory.desk.press(2)).start()
        self.desk.pin(2).wait_for(True, timeout=5)
        self.assertTrue(called.wait(5))


class Properties(Memory):
    def setUp(self):
        super().setUp()
        self.memory.desk.offer("servo/0/angle", "number", min=0, max=180, unit="degrees", write=["write", 0, None])
        self.memory.desk.offer("distance/0", "sensor", unit="cm")
        self.memory.desk._set_pin("mode", [13, 3])
        self.memory.desk._set_pin("write", [13, 1])

    def test_list_and_values(self):
        self.assertEqual([(one.id, one.type, one.access, one.unit) for one in self.desk.properties],
                         [("servo/0/angle", "integer", "both", "degrees"), ("distance/0", "integer", "read", "cm"), ("io/13", "boolean", "both", "")])
        lamp = self.desk["io/13"]
        self.assertEqual((lamp.value, lamp.how, lamp.text, lamp.why), (True, "set", "on", ""))
        self.assertLess(lamp.age, 1)
        with self.assertRaises(asip.Unproven) as raised:
            self.desk["servo/0/angle"].read()
        self.assertIn("nothing was reported or set yet", str(raised.exception))
        self.memory.desk.report("distance", [42, 0])
        self.assertEqual((self.desk["distance/0"].value, self.desk["distance/0"].text), (42, "42 cm"))
        with self.assertRaises(asip.NotThere) as raised:
            self.desk["servo/0/angel"]
        self.assertIn("did you mean", str(raised.exception))
        self.assertEqual(self.commands(), [])

    def test_pin_that_nothing_holds_is_refused_at_once(self):
        self.memory.desk.offer("io/4", "binary", read="/digital/4", choices=[["off", 0], ["on", 1]], floating=True)
        began = time.monotonic()
        for read in (self.desk["io/4"].read, self.desk.pin(4).read):
            with self.assertRaises(asip.Invalid) as raised:
                read(timeout=20)
            self.assertIn('pin(4).mode("input-pullup") makes it an input', str(raised.exception))
        self.assertLess(time.monotonic() - began, 10)
        self.assertEqual(self.commands(), [])

    def test_write(self):
        self.desk["servo/0/angle"].value = 90
        self.assertEqual((self.desk["servo/0/angle"].value, self.commands()), (90, [("servo", "write", [0, 90])]))
        self.desk["io/13"].write(False)
        self.assertEqual((self.memory.desk.levels[13], self.desk.pin(13).read()), (0, False))
        for id, bad in (("servo/0/angle", 181), ("servo/0/angle", "90"), ("io/13", "on"), ("distance/0", 1)):
            with self.assertRaises(asip.Invalid):
                self.desk[id].value = bad
        self.assertEqual(len(self.commands()), 2)

    def test_meaning_turns_the_value_and_not_the_level(self):
        self.desk.set_meaning("io/2", "door", inverted=True)
        self.memory.desk.press(2)
        door = self.desk["io/2"]
        self.assertEqual((door.value, door.text, door.meaning), (False, "closed", {"class": "door", "inverted": True}))
        self.assertIs(self.desk.pin(2).read(), True)
        self.desk.set_meaning("io/2", inverted=False)
        self.assertEqual((door.value, door.text), (True, "open"))
        self.desk.set_meaning("io/13", inverted=True)
        self.assertEqual((self.desk["io/13"].value, self.desk.pin(13).read()), (False, True))
        self.desk["io/13"].value = True
        self.assertEqual((self.memory.desk.levels[13], self.desk.pin(13).read()), (0, False))
        self.desk.set_meaning("io/2", None)
        with self.assertRaises(asip.NotThere):
            door.read()
        with self.assertRaises(asip.Invalid):
            self.desk.set_meaning("io/2")

    def test_changes_are_told(self):
        seen = []
        self.desk["io/13"].on_change(seen.append)
        eventually(lambda: seen == [True])
        self.memory.desk._set_pin("write", [13, 0])
        eventually(lambda: seen == [True, False])
        self.desk["io/13"].on_change(None)
        self.memory.desk._set_pin("write", [13, 1])
        self.assertIs(self.desk["io/13"].value, True)
        self.assertEqual(seen, [True, False])

    def test_none_is_a_value(self):
        seen = []
        self.memory.desk.offer("distance/0", "sensor", unit="cm", read="/distance/0", none=0)
        self.desk["distance/0"].on_change(seen.append)
        for distance in (42, None, 7):
            self.memory.desk.report("distance", [distance or 0, 0])
            eventually(lambda: seen[-1:] == [distance])
            self.assertEqual((self.desk["distance/0"].read(), self.desk["distance/0"].text), (distance, "none" if distance is None else f"{distance} cm"))
        self.assertEqual(seen, [42, None, 7])

    def test_contradiction_is_refused_in_a_sentence_and_nothing_is_sent(self):
        self.desk.set_meaning("io/7", "plug")
        self.desk["io/7"].value = True
        self.desk.pin(7).mode("input-pullup")
        before = len(self.commands())
        with self.assertRaisesRegex(asip.Refused, "^desk/io/7: a command made pin 7 no output, and plug needs one: asipctl pin desk 7 output$") as raised:
            self.desk["io/7"].value = True
        self.assertIs(raised.exception.sent, False)
        self.assertEqual(len(self.commands()), before)
        self.desk.pin(7).mode("output")
        self.desk["io/7"].value = True
        self.assertEqual(self.memory.desk.levels[7], 1)

    def test_what_is_done_with_a_button_is_told_once(self):
        with self.assertRaisesRegex(asip.Invalid, "no button"):
            self.desk["io/13"].on_event(print)
        self.desk.set_meaning("io/2", "button")
        self.memory.desk.press(2)  # before anybody listens
        button, seen = self.desk["io/2"], []
        watch = button.on_event(seen.append)
        changes = []
        button.on_change(changes.append)
        with button.events() as events:
            self.memory.desk.press(2, 0)
            self.memory.desk.press(2, 0)
            self.memory.desk.button(2, "hold")
            self.assertEqual([next(events), next(events)], ["press", "hold"])
            self.memory.cut()
            eventually(lambda: self.bus.connected)
            self.assertIs(button.read(), True)
            self.memory.desk.lose()
            self.memory.desk.back()
            self.desk.wait_for("online")
            self.memory.desk.press(2)
            self.assertEqual(next(events), "release")
        eventually(lambda: seen == ["press", "hold", "release"])
        self.assertEqual(changes, [False, True, False])
        watch.cancel()
        self.memory.desk.press(2, 0)
        eventually(lambda: changes[-1] is True)
        self.assertEqual((seen, self.desk._bank.button_sinks), (["press", "hold", "release"], {"io/2": []}))
        with self.assertRaisesRegex(asip.Unproven, "desk/io/2: no value within 0.05 s"):
            next(button.events(timeout=0.05))
        self.assertEqual(self.commands(), [])

    def test_of_a_board_that_is_away(self):
        self.memory.desk.lose()
        self.desk.wait_for("lost")
        lamp = {one.id: one for one in self.desk.properties}["io/13"]
        self.assertEqual((lamp.text, lamp.how), ("on", "set"))  # its last value
        with self.assertRaises(asip.NotThere):
            lamp.read()
        self.memory.desk.modes.clear()
        self.memory.desk.back()
        self.desk.wait_for("online")
        with self.assertRaises(asip.Unproven) as raised:
            lamp.read()
        self.assertIn("came back", str(raised.exception))

    def test_damaged_documents_are_counted_and_the_next_one_works(self):
        lamp = self.desk["io/13"]
        good = lamp.value
        faults = self.bus._engine.faults
        for topic in ("servicebus/desk/$properties", "desk/$values"):
            for document in ({"version": 1}, {"version": 1, "board": "desk", "session": "x", "seq": 10**6, "values": [], "properties": 7}, {"version": 2}):
                self.memory._publish(topic, document)
            self.memory._publish(topic, "[[[")
        eventually(lambda: self.bus._engine.faults == faults + 6)
        self.assertIs(lamp.value, good)
        self.memory.desk._set_pin("write", [13, 0])
        self.assertIs(lamp.value, False)


if __name__ == "__main__":
    unittest.main()
