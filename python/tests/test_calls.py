# SPDX-License-Identifier: Apache-2.0
"""Each call that waits, with a real bus: Ctrl-C in it, its agent or its broker killed under it; and a robot whose program dies."""
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "support"))
from bus import IMAGES, ROOT, eventually  # noqa: E402
from bus import Bus as RealBus  # noqa: E402

import asip  # noqa: E402

# By name: the call, and the program that stands still meanwhile, so that the call waits.
CALLS = {
    "command": ("desk.servo.write(0, 90)", "agent-desk"),
    "begin": ("desk.servo.begin('write', 0, 90).result()", "agent-desk"),
    "raw": ("desk.raw('#,?')", "agent-desk"),
    "label": ("desk.label(room='lab')", "agent-desk"),
    "read": ("desk.distance.read()", "agent-desk"),
    "element": ("desk.distance[0].read()", "agent-desk"),
    "stream": ("next(desk.distance.stream(timeout=30))", "agent-desk"),
    "hold": ("desk.io.hold(write=[13, 1]).__enter__()", "agent-desk"),
    "pin on": ("desk.pin(12).on()", "agent-desk"),
    "pin read": ("desk.pin(2).read()", "agent-desk"),
    "pin wait": ("desk.pin(5).wait_for(False)", "agent-desk"),
    "pin on_change": ("desk.pin(6).on_change(print, initial=True)", "agent-desk"),
    "stop": ("desk.stop()", "agent-desk"),
    "stop all": ("bus.stop()", "agent-desk"),
    "wait_for": ("desk.wait_for('lost')", None),
    "board": ("bus.board('nowhere')", None),
    "query": ("bus.query({'find': 'boards'})", "registry"),
    "run": ("bus.run()", None),
    "connect": ("asip.connect(timeout=30)", "broker"),
    "aio": ("import asyncio\nfrom asip import aio\nasync def main():\n  async with aio.connect() as other:\n    board = await other.board('desk')\n"
            "    await asyncio.gather(*(board.pin(pin).wait_for(False) for pin in (2, 3, 4, 5)))\nasyncio.run(main())", None),
}
PROGRAM = """
import asip, sys, threading
bus = asip.connect(timeout=20)
desk = bus.board("desk", timeout=20)
bus.timeout = 30
print("ready", flush=True)
sys.stdin.readline()
print("now", flush=True)
exec(sys.argv[1])
"""
DRIVER = """
import asip, time
with asip.connect(timeout=20) as bus:
    robot = bus.board("mirto", timeout=20)
    with robot.motors.hold(drive=[120, -120], seconds=1.0):
        print("drives", flush=True)
        time.sleep(60)
"""
MIRTO = {"name": "mirto", "link": "mirto.port", "image": str(IMAGES / "asip_uno_mirto.elf"), "world": str(ROOT / "sim" / "worlds" / "track.json"),
         "parts": [{"kind": "rover", "name": "rover"}]}


class Rig(unittest.TestCase):
    @classmethod
    def make(cls, *boards):
        cls.real = RealBus(*boards)
        cls.addClassCleanup(cls.real.close)

    @property
    def address(self):
        return f"127.0.0.1:{self.real.broker_port}"

    def program(self, text, *arguments):
        environment = {**os.environ, "ASIP_BROKER": self.address, "PYTHONPATH": str(HERE.parent)}
        child = subprocess.Popen([sys.executable, "-u", "-c", text, *arguments], env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (child.kill(), child.communicate()))
        return child


class Interrupted(Rig):
    @classmethod
    def setUpClass(cls):
        cls.make()

    def test_ctrl_c_in_each_call(self):
        for name, (call, stands) in CALLS.items():
            with self.subTest(name):
                child = self.program(PROGRAM, call)
                self.assertEqual(child.stdout.readline(), "ready\n", child.poll() is not None and child.stderr.read())
                if stands:
                    self.real.programs[stands].send_signal(signal.SIGSTOP)
                try:
                    child.stdin.write("go\n")
                    child.stdin.flush()
                    self.assertEqual(child.stdout.readline(), "now\n")
                    time.sleep(0.4)
                    self.assertIsNone(child.poll(), f"it did not wait: {child.poll() is not None and child.stderr.read()}")
                    began = time.monotonic()
                    child.send_signal(signal.SIGINT)
                    child.wait(15)
                    self.assertLess(time.monotonic() - began, 4)
                    self.assertEqual(child.returncode, 0 if name == "run" else -signal.SIGINT, child.stderr.read())
                finally:
                    if stands:
                        self.real.programs[stands].send_signal(signal.SIGCONT)
                if stands:
                    eventually(lambda: self.real.state("desk") == "online", "the board", 60)


class Killed(Rig):
    """Calls go on in threads while the program under them is killed; each ends by its value or by an error of the package."""

    @classmethod
    def setUpClass(cls):
        cls.make()

    CALLS = {
        "command": lambda desk, bus: desk.servo.write(0, 90), "raw": lambda desk, bus: desk.raw("#,?"), "label": lambda desk, bus: desk.label(room="lab"),
        "read": lambda desk, bus: desk.distance.read(), "stream": lambda desk, bus: next(desk.distance.stream(timeout=2)),
        "hold": lambda desk, bus: Killed.hold(desk), "pin": lambda desk, bus: desk.pin(12).toggle(), "pin read": lambda desk, bus: desk.pin(2).read(),
        "stop": lambda desk, bus: desk.stop(), "board": lambda desk, bus: bus.board("desk"), "boards": lambda desk, bus: bus.boards("de*"),
        "query": lambda desk, bus: bus.query({"find": "boards"}),
    }

    @staticmethod
    def hold(desk):
        with desk.io.hold(write=[13, 1], seconds=0.5):
            time.sleep(0.1)

    def check(self, kill, back):
        bus = asip.connect(self.address, timeout=20)
        self.addCleanup(bus.close)
        bus.timeout = 3
        desk = bus.board("desk", timeout=20)
        desk.pin(13).mode("output", timeout=20)
        killed, over, strange, ended = threading.Event(), threading.Event(), [], dict.fromkeys(self.CALLS, 0)

        def go_on(name, call):
            while not over.is_set():
                began, before = time.monotonic(), killed.is_set()
                try:
                    call(desk, bus)
                except asip.Error:
                    time.sleep(0.02)
                except BaseException as error:  # noqa: BLE001
                    strange.append((name, repr(error)))
                if time.monotonic() - began > 12:  # a call of several steps may wait for each
                    strange.append((name, f"took {time.monotonic() - began:.1f} s"))
                ended[name] += killed.is_set() and not before
        threads = [threading.Thread(target=go_on, args=one, daemon=True) for one in self.CALLS.items()]
        for thread in threads:
            thread.start()
        time.sleep(1)
        killed.set()
        kill()
        time.sleep(4)
        back()
        over.set()
        for thread in threads:
            thread.join(20)
        self.assertEqual(strange, [])
        self.assertEqual([thread for thread in threads if thread.is_alive()], [])
        self.assertLessEqual({name for name, count in ended.items() if count == 0}, {"pin read"}, "calls that were not under way")  # a level that is known is told at once
        desk.wait_for("online", timeout=90)
        eventually(lambda: self.works(desk), "a command after it", 60)

    @staticmethod
    def works(desk):
        try:
            desk.servo.write(0, 45, timeout=5)
            return desk.distance.read(timeout=5) == [42, None]
        except asip.Error:
            return False

    def test_agent_is_killed(self):  # no agent undoes the hold of a pin then (docs/guarantees.md, "Motors when something dies")
        self.check(lambda: self.real.end("agent-desk", signal.SIGKILL), lambda: self.real.start_agent("desk"))

    def test_broker_is_killed(self):
        self.check(lambda: self.real.end("broker", signal.SIGKILL), self.real.start_broker)
        eventually(lambda: self.real.part("desk/led") == "off", "what was held is off", 20)


class Robot(Rig):
    @classmethod
    def setUpClass(cls):
        cls.make((MIRTO,))

    def stands(self):
        one = self.real.sim("list", "mirto")
        time.sleep(0.4)
        return one == self.real.sim("list", "mirto")

    def test_a_program_that_dies_while_it_holds_the_motors(self):
        for how in (signal.SIGKILL, signal.SIGTERM, signal.SIGSTOP):
            with self.subTest(how):
                driver = self.program(DRIVER)
                self.assertEqual(driver.stdout.readline(), "drives\n", driver.poll() is not None and driver.stderr.read())
                time.sleep(2)  # longer than one hold: it was renewed
                self.assertFalse(self.stands(), "the robot drives")
                driver.send_signal(how)
                eventually(self.stands, "the robot's stop", 10)
                driver.send_signal(signal.SIGCONT)
                time.sleep(0.5)
                self.assertTrue(self.stands(), "nothing starts it again")
                driver.kill()
                driver.wait()

    def test_a_callback_that_raises_harms_no_other(self):
        with asip.connect(self.address, timeout=20) as bus:
            robot = bus.board("mirto", timeout=20)
            seen, failures = [], []
            bus.on_error = failures.append
            robot.reflectance.on_value(lambda value: 1 / 0)
            robot.reflectance.on_value(seen.append)
            with self.assertLogs("asip", "ERROR"):
                robot.reflectance.report(50)
                eventually(lambda: len(seen) > 5 and len(failures) > 5, "values and failures")
            self.assertEqual({type(one) for one in failures}, {ZeroDivisionError})
            robot.motors.stop(0)
            robot.reflectance.report(0)


if __name__ == "__main__":
    unittest.main()
