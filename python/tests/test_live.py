# SPDX-License-Identifier: Apache-2.0
"""The package with a real broker, registry, agents and real firmware in the simulator: what dies, and what is true then.

ASIP_BUILD is the build folder."""
import contextlib
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import threading
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "support"))
from bus import BIN, Bus as RealBus  # noqa: E402
from bus import eventually, paho_client  # noqa: E402

import asip  # noqa: E402

HOLDER = """
import asip, os, signal, sys, time
how = sys.argv[1]
bus = asip.connect(timeout=20)
desk = bus.board("desk", timeout=20)
desk.pin(13).mode("output", timeout=20)
with desk.io.hold(write=[13, 1], seconds=1.5, feed=1.0 if how == "hang" else None) as hold:
    print("held", flush=True)
    if how == "exit": os._exit(3)
    if how == "raise": raise RuntimeError("the block fails")
    if how == "hang": time.sleep(60)
    while True:
        hold.feed(); time.sleep(0.05)
"""


@contextlib.contextmanager
def paho_publisher(real):
    """publish(topic, content) retains it at the broker, and returns when the broker has it."""
    client = paho_client()
    client.connect("127.0.0.1", real.broker_port)
    client.loop_start()

    def publish(topic, content):
        text = json.dumps(content) if isinstance(content, dict) else content
        client.publish(topic, text, qos=1, retain=True).wait_for_publish(20)
    try:
        yield publish
    finally:
        client.disconnect()
        client.loop_stop()


class Live(unittest.TestCase):
    """One bus for all tests of a class."""

    @classmethod
    def setUpClass(cls):
        cls.real = RealBus()
        cls.addClassCleanup(cls.real.close)

    def setUp(self):
        self.bus = asip.connect(self.address, timeout=20)
        self.bus.timeout = 5
        self.addCleanup(self.bus.close)
        self.desk = self.bus.board("desk", timeout=20)

    @property
    def address(self):
        return f"127.0.0.1:{self.real.broker_port}"

    def part(self, name):
        return self.real.part(f"desk/{name}")

    def program(self, text, *arguments):
        environment = {**os.environ, "ASIP_BROKER": self.address, "PYTHONPATH": str(HERE.parent)}
        child = subprocess.Popen([sys.executable, "-c", text, *arguments], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (child.kill(), child.communicate()))
        return child


class Board(Live):
    def test_what_the_board_does_is_what_the_call_says(self):
        self.desk.servo.write(0, 90)
        eventually(lambda: self.part("servo") in ("89", "90", "91"), "the servo at 90 degrees")
        with self.assertRaises(asip.BoardError) as raised:
            self.desk.servo.write(9, 90)
        self.assertEqual(raised.exception.code, 7)
        self.assertEqual(self.desk.distance.read(timeout=20), [42, None])
        self.desk.pin(13).on()
        self.assertEqual(self.part("led"), "on")
        self.desk.pin(13).off()
        self.assertIn("ATmega328P", self.desk.raw("#,?"))

    def test_boards_with_and_without_a_registry(self):
        names = ["desk", "lamp"]
        self.assertEqual([one.name for one in self.bus.boards()], names)
        self.assertEqual([one.name for one in self.bus.boards("la*")], ["lamp"])
        self.real.end("registry")
        try:
            self.assertEqual([one.name for one in self.bus.boards()], names)
        finally:
            self.real.start("registry", "asip-registry", "--id", "first", "--history", str(self.real.work / "history.db"))
        eventually(self.answers, "the registry's return", 20)

    def answers(self):
        try:
            return self.bus.query({"find": "boards"}, timeout=1)["total"] == 2
        except asip.NotThere:
            return False

    def test_registry_tells_models_that_the_package_lacks(self):
        (self.real.work / "models").mkdir()
        (self.real.work / "models" / "lights.json").write_text(json.dumps({"name": "lights", "version": 3, "id": "Z", "title": "Lights", "commands": {
            "shine": {"tag": "S", "title": "Shine", "args": [{"name": "lamp", "type": "integer", "min": 0, "max": 3}]}}}))
        self.real.end("registry")
        self.real.start("registry", "asip-registry", "--id", "first", "--services", str(self.real.work / "models"))
        eventually(self.answers, "the registry's return", 20)
        with paho_publisher(self.real) as publish:
            publish("asip/servicebus/shed/$description", {"board": "shed", "session": "1", "seq": 1, "lease": 60, "services": [
                {"name": "lights", "id": "Z", "model": "lights@3"}]})
            publish("asip/servicebus/shed/$state", "online")
            try:
                lights = self.bus.board("shed", timeout=20).lights
                self.assertIn("lamp: integer, 0 to 3", lights.shine.__doc__)
                with self.assertRaises(asip.Invalid):
                    lights.shine(4)
            finally:
                publish("asip/servicebus/shed/$description", b"")
                publish("asip/servicebus/shed/$state", b"")

    def test_labels_choose_boards(self):
        self.desk.label(room="lab")
        eventually(lambda: [one.name for one in self.bus.boards(labels="room=lab")] == ["desk"], "the label in the registry")
        self.desk.name_pins({13: "status lamp"})
        eventually(lambda: self.desk.description.get("names"), "the name in the description")
        self.desk.pin("status lamp").on()
        self.assertEqual(self.part("led"), "on")

    def test_thousand_streams(self):
        streams = [self.desk.distance.stream() for _ in range(1000)]
        self.desk.distance.report(100)
        self.addCleanup(lambda: self.desk.distance.report(0) if not self.bus._engine.closed else None)
        for stream in streams:
            self.assertEqual(next(stream), [42, None])
        for stream in streams:
            stream.close()

    def test_lamp_that_another_program_switched_on_stays_on_while_it_is_read(self):
        switch = str(BIN / "asipctl")
        for word in ("high", "low", "high"):
            subprocess.run([switch, "pin", "desk", "13", word], env={**os.environ, "ASIP_BROKER": self.address}, check=True, stdout=subprocess.DEVNULL)
            with asip.connect(self.address, timeout=20) as bus:
                lamp, seen = bus.board("desk", timeout=20).pin(13), []
                lamp.when_changed = seen.append
                self.assertIs(lamp.read(timeout=20), word == "high")
                self.assertEqual(self.part("led"), "on" if word == "high" else "off")
        with asip.connect(self.address, timeout=20) as bus:
            bus.board("desk", timeout=20).pin(13).toggle()
        self.assertEqual(self.part("led"), "off")

    def asipctl(self, *words):
        return subprocess.run([str(BIN / "asipctl"), *words], env={**os.environ, "ASIP_BROKER": self.address}, check=True, capture_output=True, text=True).stdout

    def test_properties_are_those_of_asipctl(self):
        self.asipctl("pin", "desk", "13", "high")
        self.asipctl("send", "desk/servo", "write", "0", "45")
        self.desk.set_meaning("io/2", "door", inverted=True)
        self.addCleanup(self.desk.set_meaning, "io/2", None)
        shown = {one["property"]: one for one in json.loads(self.asipctl("get", "desk", "-o", "json"))}
        told = {one.id: one for one in self.desk.properties}
        self.assertEqual([*shown], [id for id in told if id in shown])
        self.assertGreaterEqual({*shown}, {"distance/0", "servo/0/angle", "io/2", "io/13"})
        self.assertEqual((told["io/13"].value, told["servo/0/angle"].value, told["distance/0"].value), (True, 45, 42))
        for id, one in shown.items():
            self.assertEqual((one.get("value"), one.get("unit", "")), (told[id].read(timeout=20) if "value" in one else None, told[id].unit), id)
        self.assertIn('"class":"door"', json.dumps(self.desk.description["meanings"], separators=(",", ":")))
        self.desk["servo/0/angle"].value = 90
        self.desk["io/13"].value = False
        self.assertEqual(self.part("led"), "off")
        again = {one["property"]: one.get("value") for one in json.loads(self.asipctl("get", "desk", "-o", "json"))}
        self.assertEqual((again["servo/0/angle"], again["io/13"]), (90, False))

    def test_button_that_bounces_is_pressed_once(self):
        self.desk.pin(2).mode("input-pullup")
        self.desk.set_meaning("io/2", "button")
        self.addCleanup(self.desk.set_meaning, "io/2", None)
        button, values, events, ends = self.desk["io/2"], [], [], []
        self.assertIs(button.read(timeout=20), False)
        button.on_change(values.append)
        watch = button.on_event(events.append)
        for act, wanted in (("press", ["press", "hold"]), ("release", ["release"])):
            self.real.sim(act, "desk/button")
            ends += wanted
            eventually(lambda: events == ends, f"{ends} and not {events}")
        eventually(lambda: values == [False, True, False], "one change for each")
        self.assertEqual((button.text, self.desk.pin(2).read()), ("released", True))
        watch.cancel()

    def test_lamp_that_is_on_is_never_dark_while_it_is_read_a_thousand_times(self):
        self.asipctl("pin", "desk", "13", "high")
        history = lambda: self.desk.bus.query({"find": "history", "board": "desk", "limit": 50})["items"]
        # Those of this pin: what is said of commands of the test before may come late.
        sent = lambda: [each["request"] for each in history() if each["what"] == "command" and re.search(r"\b13\b", each["request"])]
        eventually(lambda: "d,13,1" in sent(), "the history has the last command")
        lamp, seen, before = self.desk.pin(13), set(), sent()
        lamp.on_change(seen.add)
        for _ in range(50):
            seen.update((lamp.read(timeout=20), self.desk["io/13"].read(timeout=20)))
        for _ in range(1000):
            seen.add(self.desk["io/13"].text)
        self.assertEqual(seen, {True, "on"})
        self.assertEqual(self.part("led"), "on")
        self.assertEqual(sent(), before)

    def test_pins_of_a_board_that_nothing_decided_yet(self):
        lamp = self.bus.board("lamp", timeout=20)
        for call in (lamp.pin(7).read, lambda: lamp.pin("A3").wait_for(True)):
            with self.assertRaises(asip.Invalid):
                call()
        value = lamp.pin("A3").read(timeout=20)  # this board reports analog pins by itself
        self.assertTrue(isinstance(value, int) and 0 <= value <= 1023, value)
        lamp.pin(7).wait_for(True, timeout=20)  # an input with a pull-up resistor now
        self.assertIs(lamp.pin(7).read(), True)
        lamp.pin(8).mode("input-pullup")
        self.assertIs(lamp.pin(8).read(), True)

    def test_button_of_one_board_lights_the_lamp_of_the_other(self):
        lamp = self.bus.board("lamp", timeout=20)
        self.desk.pin(2).on_change(lambda level: lamp.pin(13).write(not level))
        self.real.sim("press", "desk/button")
        eventually(lambda: self.real.part("lamp/lamp") == "on", "the lamp")
        self.real.sim("release", "desk/button")
        eventually(lambda: self.real.part("lamp/lamp") == "off", "the lamp out")


class Deaths(Live):
    def led_goes_off(self, seconds=10):
        eventually(lambda: self.part("led") == "off", "the LED switched off", seconds)

    def held(self, how):
        child = self.program(HOLDER, how)
        self.assertEqual(child.stdout.readline(), "held\n", child.poll() is not None and child.stderr.read())
        return child

    def test_each_death_of_the_program_ends_its_hold(self):
        for how, kill in (("exit", None), ("raise", None), ("hang", None), ("loop", signal.SIGKILL), ("loop", signal.SIGINT), ("loop", signal.SIGTERM),
                          ("loop", signal.SIGSTOP)):
            with self.subTest(how=how, kill=kill):
                child = self.held(how)
                if kill is not None:
                    eventually(lambda: self.part("led") == "on", "the LED on")
                    time.sleep(2)  # longer than one hold: it was renewed
                    self.assertEqual(self.part("led"), "on")
                    child.send_signal(kill)
                self.led_goes_off()
                if kill == signal.SIGSTOP:
                    child.send_signal(signal.SIGCONT)
                    time.sleep(1)
                    self.assertEqual(self.part("led"), "off")  # nothing switches it on again
                child.kill()
                child.wait()

    def test_agent_killed_under_a_call(self):
        futures = [self.desk.servo.begin("write", 0, angle) for angle in range(60)]
        self.real.end("agent-desk", signal.SIGKILL)
        ends = set()
        for future in futures:
            try:
                future.result(10)
                ends.add("ok")
            except asip.Error as error:
                ends.add(type(error).__name__)
        self.assertLessEqual(ends, {"ok", "Unproven", "NotThere"})
        self.desk.wait_for("lost", timeout=20)
        with self.assertRaises(asip.NotThere):
            self.desk.servo.write(0, 1)
        with self.assertRaises(asip.NotThere):
            next(self.desk.distance.stream())
        self.real.start_agent("desk")
        self.desk.wait_for("online", timeout=60)
        self.desk.servo.write(0, 90, timeout=20)

    def test_broker_killed_under_a_call_and_back(self):
        stream = self.desk.distance.stream(lost="wait", timeout=60)
        self.desk.servo.write(0, 10)
        eventually(lambda: self.part("servo") == "10", "the servo at 10 degrees")
        self.real.programs["broker"].send_signal(signal.SIGSTOP)
        future = self.desk.servo.begin("write", 0, 170)
        time.sleep(0.1)
        self.real.end("broker", signal.SIGKILL)
        with self.assertRaises(asip.Unproven):
            future.result(10)
        with self.assertRaises(asip.Disconnected):
            self.desk.servo.write(0, 20, timeout=0.5)
        self.real.start_broker()
        eventually(lambda: self.bus.connected, "the connection", 20)
        eventually(lambda: self.reports_again(), "the agent's return", 60)
        self.assertEqual(next(stream), [42, None])
        self.desk.distance.report(0)
        self.assertEqual(self.part("servo"), "10")  # the command of the broken connection never came

    def reports_again(self):
        try:
            self.desk.distance.report(100, timeout=2)
            return True
        except asip.Error:  # the agent is not back yet
            return False

    def test_ctrl_c_in_each_call_that_waits(self):
        texts = {
            "read": "bus.board('desk').pin(5).wait_for(False)", "stream": "for _ in bus.board('desk').distance.stream(): pass",
            "board": "bus.board('desk'); print('now', flush=True); bus.board('nowhere', timeout=30)", "run": "bus.run()",
            "wait": "bus.board('desk').wait_for('lost')"}
        for name, text in texts.items():
            with self.subTest(name):
                child = self.program(f"import asip, sys\nbus = asip.connect(timeout=20)\nbus.board('desk', timeout=20)\nprint('now', flush=True)\n{text}\n")
                self.assertEqual(child.stdout.readline(), "now\n")
                time.sleep(0.5)
                child.send_signal(signal.SIGINT)
                began = time.monotonic()
                child.wait(10)
                self.assertLess(time.monotonic() - began, 5)
                self.assertEqual(child.returncode, 0 if name == "run" else -signal.SIGINT)

    def test_callback_that_sleeps_delays_no_answer(self):
        self.desk.distance.report(100, timeout=20)
        busy = threading.Event()
        self.desk.distance.on_value(lambda: busy.wait(10))
        time.sleep(0.5)
        began = time.monotonic()
        self.desk.servo.write(0, 45, timeout=20)
        self.assertLess(time.monotonic() - began, 5)
        busy.set()
        self.desk.distance.report(0)

    def test_connections_leave_no_descriptor(self):
        for _ in range(3):
            asip.connect(self.address, timeout=20).close()
        before = len(os.listdir("/proc/self/fd"))
        for _ in range(30):
            asip.connect(self.address, timeout=20).close()
        eventually(lambda: len(os.listdir("/proc/self/fd")) <= before, "descriptors")

    def test_no_broker_is_told_with_its_address(self):
        with self.assertRaises(asip.Disconnected) as raised:
            asip.connect("127.0.0.1:1", timeout=0.5)
        self.assertIn("127.0.0.1:1", str(raised.exception))


if __name__ == "__main__":
    unittest.main()
