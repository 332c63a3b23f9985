# SPDX-License-Identifier: Apache-2.0
"""The whole package over a bus in memory: commands, values, holds, pins, odd input."""
import gc
import re
import threading
import time
import unittest
import unittest.mock

import asip
from asip.testing import eventually
from memory_rig import Memory


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

    def test_wait_for_and_function_without_argument(self):
        called = threading.Event()
        self.desk.pin(2).when_changed = called.set
        threading.Timer(0.05, lambda: self.memory.desk.press(2)).start()
        self.desk.pin(2).wait_for(True, timeout=5)
        self.assertTrue(called.wait(5))


if __name__ == "__main__":
    unittest.main()
