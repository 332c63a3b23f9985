# SPDX-License-Identifier: Apache-2.0
"""Picos in the emulator and an Uno in the simulator, on one bus: all are listed, and a button on each lights an LED on the other.
ASIP_RP2040JS leads to the emulator."""

import json
import pathlib
import subprocess
import threading
import unittest

from bus import BIN, IMAGES, Bus, die_with_parent, eventually

MAIN = pathlib.Path(__file__).resolve().parent / "pico" / "main.mjs"
UNO = {"name": "uno1", "board": "uno", "image": str(IMAGES / "asip_uno.elf"), "link": "uno1.port",
       "parts": [{"kind": "button", "name": "switch", "pin": 2}, {"kind": "led", "name": "lamp", "pin": 13}]}
PICO = {"image": str(IMAGES / "asip_pico.elf"),
        "parts": [{"kind": "button", "name": "knob", "pin": 5}, {"kind": "led", "name": "led", "pin": 25},
                  {"kind": "potentiometer", "name": "pot", "pin": "A0", "position": 1}]}
IMU = {"image": str(IMAGES / "asip_pico_i2c.elf"),
       "parts": [{"kind": "mpu6050", "name": "motion", "ax": 12}, {"kind": "bmp085", "name": "barometer", "pressure": 990}]}


class Pico:
    """One in a process of its own, with its agent on `bus`."""

    def __init__(self, bus, name, board):
        self.values = {}
        self.program = subprocess.Popen(["node", str(MAIN), json.dumps(board)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        preexec_fn=die_with_parent)
        port = json.loads(self.program.stdout.readline())["tcp"]
        threading.Thread(target=self.follow, daemon=True).start()
        bus.start(f"agent-{name}", "asip-agent", "--tcp", f"127.0.0.1:{port}", "--name", name, "--lease", "6", "--patience", "60")

    def follow(self):
        for line in self.program.stdout:
            change = json.loads(line)
            self.values[change.get("part")] = change.get("value")

    def do(self, words):
        self.program.stdin.write(words + "\n")
        self.program.stdin.flush()

    def close(self):
        self.program.kill()
        self.program.communicate()


class SideBySide(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = Bus((UNO,))
        cls.addClassCleanup(cls.bus.close)
        cls.pico = Pico(cls.bus, "pico1", PICO)
        cls.addClassCleanup(cls.pico.close)
        cls.imu = Pico(cls.bus, "pico2", IMU)
        cls.addClassCleanup(cls.imu.close)
        eventually(lambda: all(cls.bus.state(name) == "online" for name in ("pico1", "pico2")), "both Picos online", 60)

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

    def lights(self, do, led):
        for verb, state in (("press", "on"), ("release", "off"), ("press", "on"), ("release", "off")):
            do(verb)
            eventually(lambda: led() == state, f"the LED {state}")

    def test_all_are_listed(self):
        rows = {words[0]: words for words in map(str.split, self.asipctl("list").splitlines())}
        self.assertEqual(rows["uno1"][1:4], ["online", "ATmega328P", "AsipHello"])
        self.assertEqual(rows["pico1"][1:4], ["online", "RP2040", "AsipPlainSerial"])

    def test_chips_on_the_i2c_bus_of_a_pico_are_read_and_set(self):
        self.assertEqual(self.asipctl("get", "pico2/acceleration").splitlines(), ["x 12", "y 0", "z 16384"])
        self.imu.do("set motion ax=-7,az=1")
        eventually(lambda: self.asipctl("get", "pico2/acceleration").splitlines() == ["x -7", "y 0", "z 1"], "what it measures now")
        eventually(lambda: "990" in self.asipctl("get", "pico2/pressure"), "a pressure")

    def test_a_button_of_the_uno_lights_the_led_of_the_pico(self):
        self.switch("uno1", "pico1", "2", "25")
        self.lights(lambda verb: self.bus.sim(verb, "uno1/switch"), lambda: self.pico.values.get("led"))

    def test_a_button_of_the_pico_lights_the_led_of_the_uno(self):
        self.switch("pico1", "uno1", "5", "13")
        self.lights(lambda verb: self.pico.do(f"{verb} knob"), lambda: self.bus.part("uno1/lamp"))

    def test_the_potentiometer_is_ten_bits(self):
        eventually(lambda: "1023" in self.asipctl("get", "pico1/io/analog/0"), "the end of its range")
        self.pico.do("set pot 0.25")
        eventually(lambda: any(value in self.asipctl("get", "pico1/io/analog/0") for value in ("255", "256")), "a quarter of it")


if __name__ == "__main__":
    unittest.main()
