# SPDX-License-Identifier: Apache-2.0
"""asyncio, threads, and the end: close, fork, garbage, Ctrl-C."""
import asyncio
import gc
import multiprocessing
import pickle
import subprocess
import sys
import threading
import time
import unittest

import asip
from asip import aio, testing
from asip.testing import eventually
from memory_rig import Memory


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
        self.assertEqual(seen, [[None, None], [1, None], [2, None]])
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

    async def test_buttons(self):
        await self.desk.set_meaning("io/2", "button")
        self.memory.desk.press(2)
        seen = []
        watch = await self.desk["io/2"].on_event(seen.append)
        events = self.desk["io/2"].events()
        coming = asyncio.create_task(events.__anext__())
        while len(self.desk._one._bank.button_sinks["io/2"]) < 2:
            await asyncio.sleep(0.01)
        self.memory.desk.press(2, 0)
        self.assertEqual(await asyncio.wait_for(coming, 5), "press")
        while not seen:
            await asyncio.sleep(0.01)
        self.assertEqual(seen, ["press"])
        watch.cancel()
        coming = asyncio.create_task(events.__anext__())
        await self.bus.close()
        with self.assertRaises(asip.Closed):
            await asyncio.wait_for(coming, 5)

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
        self.assertEqual(sorted(asip.__all__), ["Board", "BoardError", "Bus", "Closed", "Disconnected", "Error", "Invalid", "NotThere", "Pin", "Property",
                                                "Reading", "Refused", "Service", "Unproven", "__version__", "connect"])
        pickle.dumps(asip.Reading([1], "cm", 1.0))


if __name__ == "__main__":
    unittest.main()
