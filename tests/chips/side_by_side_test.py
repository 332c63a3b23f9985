# SPDX-License-Identifier: Apache-2.0
"""A Pico in the emulator and an Uno in the simulator, on one bus: both are listed, and a button on each lights an LED on the other.
NODE_PATH leads to the emulator."""

import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest

from bus import BIN, IMAGES, Bus, die_with_parent, eventually

ROOT = pathlib.Path(__file__).resolve().parents[2]
UNO = {"name": "uno1", "board": "uno", "image": str(IMAGES / "asip_uno.elf"), "link": "uno1.port",
       "parts": [{"kind": "button", "name": "switch", "pin": 2}, {"kind": "led", "name": "lamp", "pin": 13}]}
PICO = {"name": "pico1", "board": "pico", "image": str(IMAGES / "asip_pico.elf"), "link": "pico1.port",
        "parts": [{"kind": "button", "name": "knob", "pin": 5}, {"kind": "led", "name": "led", "pin": 25},
                  {"kind": "potentiometer", "name": "pot", "pin": "A0", "position": 1}]}
IMU = {"name": "pico2", "board": "pico", "image": str(IMAGES / "asip_pico_i2c.elf"), "link": "pico2.port",
       "parts": [{"kind": "mpu6050", "name": "motion", "ax": 12}, {"kind": "bmp085", "name": "barometer", "pressure": 990}]}


class SideBySide(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = Bus((UNO, PICO, IMU))
        cls.addClassCleanup(cls.bus.close)

    def setUp(self):
        self.addCleanup(lambda: self._outcome.success or print(self.bus.logs()))

    def asipctl(self, *words):
        return subprocess.run([str(BIN / "asipctl"), "--broker", f"127.0.0.1:{self.bus.broker_port}", *words], check=True,
                              capture_output=True, text=True, timeout=60).stdout

    def switch(self, button, led, *pins):
        address = f"mqtt://127.0.0.1:{self.bus.broker_port}/"
        name = f"switch-{button}"
        self.bus.start(name, str(BIN / "example-two_board_switch"), address + button, address + led, *pins)
        self.addCleanup(self.bus.end, name)
        eventually(lambda: "switches pin" in (self.bus.work / f"{name}.log").read_text(), f"the start of {name}", 60)

    def lights(self, button, led):
        for verb, state in (("press", "on"), ("release", "off"), ("press", "on"), ("release", "off")):
            self.bus.sim(verb, button)
            eventually(lambda: self.bus.part(led) == state, f"{led} {state}")

    def test_both_are_listed(self):
        rows = {words[0]: words for words in map(str.split, self.asipctl("list").splitlines())}
        self.assertEqual(rows["uno1"][1:4], ["online", "ATmega328P", "AsipHello"])
        self.assertEqual(rows["pico1"][1:4], ["online", "RP2040", "AsipPlainSerial"])

    def test_chips_on_the_i2c_bus_of_a_pico_are_read_and_set(self):
        self.assertEqual(self.asipctl("get", "pico2/acceleration").splitlines(), ["x 12", "y 0", "z 16384"])
        self.bus.sim("set", "pico2/motion", "ax=-7,az=1")
        eventually(lambda: self.asipctl("get", "pico2/acceleration").splitlines() == ["x -7", "y 0", "z 1"], "what it measures now")
        eventually(lambda: "pressure 990.0" in self.asipctl("get", "pico2/pressure"), "a pressure")
        self.bus.sim("detach", "pico2/barometer")
        eventually(lambda: self.bus.part("pico2/barometer") == "detached", "a chip that is gone")

    def test_a_button_of_the_uno_lights_the_led_of_the_pico(self):
        self.switch("uno1", "pico1", "2", "25")
        self.lights("uno1/switch", "pico1/led")

    def test_a_button_of_the_pico_lights_the_led_of_the_uno(self):
        self.switch("pico1", "uno1", "5", "13")
        self.lights("pico1/knob", "uno1/lamp")

    def test_the_potentiometer_is_ten_bits(self):
        eventually(lambda: "1023" in self.asipctl("get", "pico1/io/analog/0"), "the end of its range")
        self.bus.sim("set", "pico1/pot", "0.25")
        eventually(lambda: any(value in self.asipctl("get", "pico1/io/analog/0") for value in ("255", "256")), "a quarter of it")

    def test_what_a_person_types_is_refused_with_a_reason(self):
        for words, why in ((("set", "pico1/pot", "2"), "a number from 0 to 1"), (("press", "pico1/led"), "cannot press"),
                           (("load", "pico1", str(IMAGES / "asip_uno.elf")), "an image for another chip")):
            with self.assertRaises(subprocess.CalledProcessError) as refused:
                self.bus.sim(*words)
            self.assertIn(why, refused.exception.stderr)

    def test_unplugged_and_replugged_it_comes_back(self):
        self.bus.sim("unplug", "pico1")
        eventually(lambda: self.bus.state("pico1") != "online", "pico1 away", 60)
        self.bus.sim("replug", "pico1")
        eventually(lambda: self.bus.state("pico1") == "online", "pico1 back", 60)


class BadBoards(unittest.TestCase):
    def refused(self, board, **environment):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "pico.json")
            with open(file, "w", encoding="utf-8") as stream:
                json.dump({**PICO, **board}, stream)
            run = subprocess.run([str(BIN / "asip-sim"), "--no-socket", file], stdin=subprocess.DEVNULL, capture_output=True,
                                 text=True, timeout=60, env={**os.environ, **environment})
        self.assertEqual(run.returncode, 2, run.stderr)
        return run.stderr

    def test_each_fault_is_named(self):
        led = {"kind": "led", "pin": 25}
        for board, why in (({"parts": [{"kind": "servo", "pin": 9}]}, "/parts/0/kind: a Pico has no \"servo\""),
                           ({"parts": [led, {**led, "pin": 30}]}, "/parts/1/pin: there is no pin 30 on the pico (0 to 29, A0 to A3)"),
                           ({"parts": [led, led]}, "/parts/1/pin: has a part already"),
                           ({"parts": [{**led, "pin": 1}]}, "/parts/0/pin: the serial line has this pin"),
                           ({"parts": [{"kind": "potentiometer", "pin": 3}]}, "/parts/0/pin: not an analog input"),
                           ({"parts": [{**led, "low": True}]}, "/parts/0/low: a led has no such member"),
                           ({"image": str(IMAGES / "asip_uno.elf")}, "an image for another chip"),
                           ({"image": "/nowhere.elf"}, "/nowhere.elf"),
                           ({"frequency": 1e9}, "/frequency")):
            self.assertIn(why, self.refused(board))

    def test_without_its_emulator_it_says_what_to_install(self):
        if any(os.path.exists(f"{folder}/rp2040js") for folder in ("/usr/lib/node_modules", "/usr/local/lib/node_modules")):
            self.skipTest("rp2040js is installed for all")
        self.assertIn("npm install --global rp2040js@", self.refused({}, NODE_PATH=""))

    def test_an_emulator_that_ends_is_told_and_costs_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "pico.json")
            with open(file, "w", encoding="utf-8") as stream:
                json.dump({**PICO, "link": os.path.join(folder, "port")}, stream)
            sim = subprocess.Popen([str(BIN / "asip-sim"), "--json", "--no-socket", file], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, preexec_fn=die_with_parent)
            self.addCleanup(lambda: (sim.kill(), sim.communicate()))
            self.assertEqual(json.loads(sim.stdout.readline())["event"], "port")
            children = [int(child) for task in pathlib.Path(f"/proc/{sim.pid}/task").iterdir()
                        for child in (task / "children").read_text(encoding="ascii").split()]
            self.assertEqual(len(children), 1)
            os.kill(children[0], signal.SIGKILL)
            while (event := json.loads(sim.stdout.readline())).get("event") != "stopped":
                pass
            self.assertEqual(event["reason"], "the emulator of the Pico has ended")
            before = self.processor_seconds(sim.pid)
            time.sleep(1)
            self.assertLess(self.processor_seconds(sim.pid) - before, 0.3)
            sim.stdin.write("press pico1/knob\n")
            sim.stdin.flush()
            self.assertIn("pico1 has stopped", sim.stderr.readline())
            sim.communicate("quit\n", timeout=60)
            self.assertEqual(sim.returncode, 0)

    def test_an_image_is_a_bare_board(self):
        sim = subprocess.Popen([str(BIN / "asip-sim"), "--json", "--no-socket", "--board", "pico", str(IMAGES / "asip_pico.elf")],
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, preexec_fn=die_with_parent)
        self.addCleanup(lambda: (sim.kill(), sim.communicate()))
        with open(json.loads(sim.stdout.readline())["path"], "r+b", buffering=0) as port:
            port.write(b"I,A,0\n#,?\n")
            text = b""
            while b"@#,?,0,4,RP2040,30,AsipPlainSerial\n" not in text:
                text += port.read(200)
        sim.communicate("quit\n", timeout=60)
        self.assertEqual(sim.returncode, 0)

    @staticmethod
    def processor_seconds(pid):
        with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
            words = stat.read().rsplit(")", 1)[1].split()
        return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")

    def test_without_node_it_says_what_to_install(self):
        text = self.refused({}, PATH="/nowhere")
        self.assertIn("apt install nodejs npm", text)
        version = re.search(r"VERSION = '(.+)'", (ROOT / "sim/pico/emulator.mjs").read_text(encoding="utf-8"))[1]
        said = [text, *((ROOT / file).read_text(encoding="utf-8") for file in ("debian/control", "docs/asip-sim.md", "docs/containers.md"))]
        for words in said:
            self.assertIn(f"npm install --global rp2040js@{version}", words)


if __name__ == "__main__":
    unittest.main()
