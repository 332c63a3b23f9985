# SPDX-License-Identifier: Apache-2.0
"""The whole package over a bus in memory: threads, callbacks, holds, streams, pins, asyncio."""
import asyncio
import copy
import gc
import importlib.util
import inspect
import multiprocessing
import pickle
import pydoc
import re
import subprocess
import sys
import threading
import time
import unittest
import unittest.mock

import asip
from asip import aio, testing
from asip.service import class_of
from asip.testing import eventually


class Memory(unittest.TestCase):
    def setUp(self):
        self.memory = testing.MemoryBus(desk=["io", "distance", "servo", "motors"], lamp=["io"])
        self.addCleanup(self.memory.close)
        self.bus = self.memory.connect()
        self.desk = self.bus.board("desk")

    def commands(self, board="desk"):
        return self.memory.boards[board].commands


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
        self.assertEqual(self.desk.distance.read(), [42, 0])
        self.assertEqual(self.desk.distance[0].read(), 42)
        with self.assertRaises(asip.Invalid):
            self.desk.distance[2].read()
        self.assertEqual(self.desk.distance.unit, "cm")

    def test_stream_gives_the_newest_and_counts_the_others(self):
        stream = self.desk.distance.stream(details=True)
        for value in range(10):
            self.memory.desk.report("distance", [value, 0])
        eventually(lambda: stream.dropped == 9)
        reading = next(stream)
        self.assertEqual((reading.value, reading.unit), ([9, 0], "cm"))
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
            for value in range(1000):
                self.memory.desk.report("distance", [value, 0])
            self.assertEqual([next(stream)[0] for _ in range(1000)], list(range(1000)))

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
        eventually(lambda: seen == [False, True, False])
        self.assertEqual(self.memory.desk.modes[2], 2)

    def test_wait_for_and_function_without_argument(self):
        called = threading.Event()
        self.desk.pin(2).when_changed = called.set
        threading.Timer(0.05, lambda: self.memory.desk.press(2)).start()
        self.desk.pin(2).wait_for(True, timeout=5)
        self.assertTrue(called.wait(5))


class Dynamic(Memory):
    def test_typos_are_errors_with_a_hint_and_probes_are_quiet(self):
        with self.assertRaises(AttributeError) as raised:
            self.desk.sevro
        self.assertIn("servo", str(raised.exception))
        with self.assertRaises(AttributeError) as raised:
            self.desk.servo.wirte(0, 1)
        self.assertIn("write", str(raised.exception))
        for thing in (self.desk, self.desk.servo):
            self.assertFalse(hasattr(thing, "_ipython_canary_method_should_not_exist_"))
            self.assertIn("write" if thing is self.desk.servo else "servo", dir(thing))
            copy.copy(thing)
        with self.assertRaises(LookupError):
            self.desk["nothing"]

    def test_help_shows_the_model(self):
        self.assertEqual(str(inspect.signature(self.desk.servo.write)), "(servo: 'int', angle: 'int', *, timeout: 'float | None' = None)")
        self.assertIn("0 to 180 degrees", self.desk.servo.write.__doc__)

    def test_static_classes_are_those_made_at_run_time(self):
        from asip import _standard
        from asip.board import standard_model
        for name, static in inspect.getmembers(_standard, inspect.isclass):
            if static.__module__ != _standard.__name__:
                continue
            dynamic = class_of(standard_model(name.lower()))
            own = {attribute for attribute in vars(static) if not attribute.startswith("_")}
            self.assertEqual(own, {attribute for attribute in vars(dynamic) if not attribute.startswith("_") and attribute != "model"})
            for attribute in own:
                self.assertEqual(list(inspect.signature(getattr(static, attribute)).parameters), list(inspect.signature(getattr(dynamic, attribute)).parameters))
                self.assertEqual(inspect.getdoc(getattr(static, attribute)), inspect.getdoc(getattr(dynamic, attribute)))

    def test_help_in_words_a_pupil_reads(self):
        text = pydoc.plain(pydoc.render_doc(self.desk.servo.write)).replace("'", "")  # Python before 3.14 puts annotations into quotes
        for words in ("write(servo: int, angle: int, *, timeout", "servo: integer, 0 to", "angle: integer, 0 to 180 degrees", "Returns when the board has executed it."):
            self.assertIn(words, text)

    def test_boards_and_buses_are_tables(self):
        table = self.desk._repr_html_()
        self.assertIn("<td>distance</td>", table)
        self.assertIn("<td>distance (cm)</td>", table)
        self.assertIn("write(servo, angle)", table)
        self.assertIn("<td>lamp</td>", self.bus._repr_html_())


LIGHTS = {"name": "lights", "version": 3, "id": "Z", "title": "Lights", "commands": {
    "shine": {"tag": "S", "args": [{"name": "lamp", "type": "integer", "min": 0, "max": 3}]}}}


class Models(Memory):
    """Of a service that only its name and version describe, on a board that another program announces."""

    def announce(self, reference):
        self.memory._publish("servicebus/shed/$description", {"board": "shed", "session": "1", "seq": 1, "lease": 600, "services": [
            {"name": "lights", "id": "Z", "model": reference}]}, retained=True)
        self.memory._publish("servicebus/shed/$state", "online", retained=True)

    def test_a_registry_tells_the_model_that_the_package_lacks(self):
        self.memory.registry_models = [{**LIGHTS, "version": 2}, LIGHTS]
        self.announce("lights@3")
        lights = self.bus.board("shed").lights
        self.assertEqual(str(inspect.signature(lights.shine)), "(lamp: 'int', *, timeout: 'float | None' = None)")
        with self.assertRaises(asip.Invalid):
            lights.shine(4)
        other = self.memory.connect()
        self.assertIn("shine", dir(next(one for one in other.boards("sh*"))["lights"]))

    def test_without_such_a_model_the_service_says_what_can_be_done(self):
        self.memory.registry_models = [{"name": "lights"}, {**LIGHTS, "commands": 7}, {**LIGHTS, "version": 2}]
        self.announce("lights@3")
        began = time.monotonic()
        for _ in range(3):
            with self.assertRaises(asip.Invalid) as raised:
                self.bus.board("shed").lights.command("shine", 1)
            self.assertIn("board.raw()", str(raised.exception))
        self.assertLess(time.monotonic() - began, 5)

    def test_bus_without_a_registry(self):
        self.memory._asked = lambda query: None
        self.announce("lights@3")
        self.assertEqual(list(self.bus.board("shed").services), ["lights"])
        self.bus.board("desk").servo.write(0, 90)  # the package's own copy


class Plots(Memory):
    def test_without_matplotlib_the_error_says_how_to_get_it(self):
        with unittest.mock.patch.dict(sys.modules, {"matplotlib": None, "matplotlib.pyplot": None}):
            with self.assertRaises(ModuleNotFoundError) as raised:
                self.desk.distance.plot(seconds=1)
        self.assertIn("apt install python3-matplotlib", str(raised.exception))

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_a_line_for_each_number(self):
        import matplotlib
        matplotlib.use("Agg")
        told = threading.Event()

        def report():
            for number in range(20):
                self.memory.desk.report("distance", [number, None, 7])
                told.wait(0.02)
        threading.Thread(target=report).start()
        axes = self.desk.distance.plot(seconds=0.7, hz=50)
        lines = {line.get_label(): list(line.get_ydata()) for line in axes.get_lines()}
        self.assertEqual(sorted(lines), ["0", "2"])
        self.assertEqual(lines["0"], sorted(lines["0"]))
        self.assertGreater(len(lines["0"]), 5)
        self.assertEqual(axes.get_ylabel(), "cm")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_a_board_that_reports_nothing_is_asked(self):
        import matplotlib
        matplotlib.use("Agg")
        self.memory.desk._values["distance", "distance"] = [42, 0]
        axes = self.desk.distance.plot(seconds=0.6)
        self.assertIn(42.0, axes.get_lines()[0].get_ydata())
        with self.assertRaises(asip.Unproven):
            self.desk.io.plot(seconds=0.2)


class Twins(unittest.TestCase):
    def test_asynchronous_names_have_the_same_arguments(self):
        pairs = [(asip.Bus, aio.Bus, {"on_error", "run"}), (asip.Board, aio.Board, set()), (asip.Service, aio.Service, {"begin", "plot"}),
                 (asip.Pin, aio.Pin, {"when_changed"})]
        for sync, other, missing in pairs:
            for name, member in inspect.getmembers(sync):
                if name.startswith("_") or name in missing:
                    continue
                self.assertTrue(hasattr(other, name), f"{other.__module__}.{other.__name__}.{name}")
                if inspect.isfunction(member) and name not in ("board",):
                    self.assertEqual(list(inspect.signature(member).parameters), list(inspect.signature(getattr(other, name)).parameters), name)


class Asynchronous(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self):
        self.memory = testing.MemoryBus(desk=["io", "distance", "servo", "motors"])
        self.bus = aio.Bus(self.memory.connect())
        self.desk = await self.bus.board("desk")

    async def asyncTearDown(self):
        await self.bus.close()

    async def test_commands_values_streams_holds_and_pins(self):
        await asyncio.gather(*(self.desk.servo.write(number, 90) for number in range(20)))
        self.assertEqual(len(self.memory.desk.commands), 20)
        self.memory.desk.report("distance", [3, 4])
        self.assertEqual(await self.desk.distance.read(), [3, 4])
        seen = []

        async def listen():
            async for value in self.desk.distance.stream(keep=10):
                seen.append(value)
                if len(seen) == 3:
                    return
        task = asyncio.create_task(listen())
        await asyncio.sleep(0.05)
        for value in range(3):
            self.memory.desk.report("distance", [value, 0])
        await asyncio.wait_for(task, 5)
        self.assertEqual(seen, [[0, 0], [1, 0], [2, 0]])
        async with self.desk.motors.hold(power=[0, 60]):
            pass
        self.assertEqual(self.memory.desk.commands[-1], ("motors", "stop", [0]))
        await self.desk.pin(13).on()
        with self.assertRaises(asip.Invalid):
            await self.desk.servo.write(0, 200)

    async def test_functions_and_coroutines_are_called_in_the_loop(self):
        seen, failures = [], []
        self.bus.on_error = failures.append

        async def take(value):
            await asyncio.sleep(0)
            seen.append(value)
        for wrong in (5, None, lambda one, two: 0):
            with self.assertRaises(TypeError):
                self.desk.distance.on_value(wrong)
        self.desk.distance.on_value(take)
        self.desk.distance.on_value(lambda: seen.append("called"))
        self.desk.distance.on_value(lambda value: 1 / 0)
        with self.assertLogs("asip", "ERROR"):
            self.memory.desk.report("distance", [1, 2])
            for _ in range(200):
                await asyncio.sleep(0.01)
                if len(seen) == 2 and failures:
                    break
        self.assertEqual((sorted(map(str, seen)), [type(one) for one in failures]), (["[1, 2]", "called"], [ZeroDivisionError]))

    async def test_what_is_in_a_board(self):
        self.assertIn("servo", self.desk)
        self.assertEqual([one.name for one in self.desk], ["io", "distance", "servo", "motors"])
        self.memory.desk._values["distance", "distance"] = [3, 4]
        self.assertEqual(await self.desk.distance[1].read(), 4)
        with self.assertRaisesRegex(AttributeError, "asip.aio has no plot"):
            self.desk.distance.plot()
        await self.desk.name_pins({13: "status lamp"})
        await self.desk.label(room="lab")
        await self.desk.pin("status lamp").on()
        self.assertEqual((self.memory.desk.levels[13], self.desk.labels), (1, {"room": "lab"}))

    async def test_many_calls_that_wait_keep_no_other_from_its_end(self):
        waiting = [asyncio.create_task(self.desk.pin(2).wait_for(True)) for _ in range(100)]
        await asyncio.sleep(0.1)
        self.memory.desk.report("distance", [3, 4])
        self.memory.desk._values["distance", "distance"] = [3, 4]
        self.assertEqual(await asyncio.wait_for(self.desk.distance.read(), 5), [3, 4])
        waiting[0].cancel()
        await self.bus.close()
        ends = await asyncio.wait_for(asyncio.gather(*waiting, return_exceptions=True), 5)
        self.assertEqual({type(end) for end in ends}, {asyncio.CancelledError, asip.Closed})

    async def test_cancelled_command(self):
        self.memory.desk.silence()
        task = asyncio.create_task(self.desk.servo.write(0, 90))
        await asyncio.sleep(0.05)
        task.cancel()
        with self.assertRaises(asyncio.CancelledError):
            await task
        self.memory.desk.work()
        await self.desk.servo.write(0, 91)

    async def test_other_loop(self):
        def other():
            async def use():
                await self.desk.servo.write(0, 1)
            with self.assertRaises(asip.Closed):
                asyncio.run(use())
        await asyncio.get_running_loop().run_in_executor(None, other)


def _child(bus, result):
    try:
        bus.board("desk")
        result.put("no error")
    except asip.Closed as error:
        result.put(str(error))


class End(Memory):
    def test_close_twice_from_a_callback_and_during_a_call(self):
        self.memory.desk.silence()
        future = self.desk.servo.begin("write", 0, 90)
        self.desk.distance.on_value(self.bus.close)
        self.memory.desk.report("distance", [1, 0])
        with self.assertRaises(asip.Unproven):
            future.result(5)
        self.bus.close()
        with self.assertRaises(asip.Closed):
            self.desk.servo.write(0, 90)
        with self.assertRaises(asip.Closed):
            self.bus.boards()

    @unittest.skipUnless(hasattr(__import__("os"), "fork"), "no fork here")
    def test_forked_child_is_told(self):
        context = multiprocessing.get_context("fork")
        result = context.Queue()
        child = context.Process(target=_child, args=(self.bus, result))
        child.start()
        self.assertIn("forked", result.get(timeout=10))
        child.join()
        self.desk.servo.write(0, 1)

    def test_hundred_buses_leave_no_thread(self):
        before = threading.active_count()
        for _ in range(100):
            self.memory.connect().close()
        eventually(lambda: threading.active_count() <= before)

    def test_bus_that_is_forgotten_closes_itself(self):
        bus = self.memory.connect()
        self.memory._buses.remove(bus)
        engine = bus._engine
        del bus
        gc.collect()
        eventually(lambda: engine.closed)

    def test_program_without_close_ends_quietly(self):
        text = ("import asip\nfrom asip import testing\nmemory = testing.MemoryBus(desk=['servo'])\n"
                "bus = memory.connect()\ndesk = bus.board('desk')\ndesk.servo.write(0, 90)\nprint('done')\n")
        done = subprocess.run([sys.executable, "-X", "dev", "-W", "error", "-c", text], capture_output=True, text=True, timeout=20)
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("done\n", "", 0))

    def test_calls_that_wait_end_when_the_bus_is_closed(self):
        stream, ends = self.desk.distance.stream(), []
        calls = [lambda: self.desk.pin(2).wait_for(True), lambda: next(stream), lambda: next(stream), lambda: self.desk.wait_for("lost", timeout=None),
                 lambda: self.bus.board("nowhere", timeout=60), self.bus.run]

        def wait(call):
            try:
                call()
            except (asip.Closed, StopIteration) as end:
                ends.append(type(end).__name__)
            else:
                ends.append("returned")
        threads = [threading.Thread(target=wait, args=(call,)) for call in calls]
        for thread in threads:
            thread.start()
        time.sleep(0.2)
        self.bus.close()
        for thread in threads:
            thread.join(5)
        self.assertEqual(sorted(ends), ["Closed"] * 5 + ["returned"])

    def test_settings_are_shown_without_the_password(self):
        from asip import settings
        self.assertNotIn("secret", repr(settings.find("pi", user="ann", password="secret")))
        self.assertIn("ann", repr(settings.find("pi", user="ann", password="secret")))

    def test_run_ends_by_close_and_by_time(self):
        self.bus.run(0.05)
        threading.Timer(0.05, self.bus.close).start()
        self.bus.run()

    def test_public_names(self):
        self.assertEqual(sorted(asip.__all__), ["Board", "BoardError", "Bus", "Closed", "Disconnected", "Error", "Invalid", "NotThere", "Pin",
                                                "Reading", "Refused", "Service", "Unproven", "__version__", "connect"])
        pickle.dumps(asip.Reading([1], "cm", 1.0))


if __name__ == "__main__":
    unittest.main()
