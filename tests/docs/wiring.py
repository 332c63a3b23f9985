# SPDX-License-Identifier: Apache-2.0
"""The table of pins with a meaning in docs/sensors.md: its commands, with simulated parts wired as it says."""
import re
import shlex
import sys
import unittest

import bus as bus_module
from bus import Bus, eventually

sys.path.insert(0, str(bus_module.ROOT / "python"))
import asip  # noqa: E402

HOME = {"name": "home", "board": "uno", "image": str(bus_module.IMAGES / "asip_uno.elf"), "link": "home.port", "parts": [
    {"kind": "led", "name": "relay", "pin": 4, "active_low": True}, {"kind": "button", "name": "motion", "pin": 5, "to_vcc": True, "steady": True},
    {"kind": "button", "name": "reed", "pin": 6}, {"kind": "potentiometer", "name": "soil", "pin": "A0", "position": 0.43},
    {"kind": "led", "name": "lamp", "pin": 9}]}
SECONDS = 20


class Wiring(unittest.TestCase):
    def test_each_row_does_what_it_says(self):
        real = Bus((HOME,))
        self.addCleanup(real.close)
        page = (bus_module.ROOT / "docs" / "sensors.md").read_text()
        rows = page[page.index("## Relay, lamp"):page.index("## Any chip on I2C")]
        commands = [shlex.split(one.replace("BOARD", "home"))[1:] for one in re.findall(r"`(asipctl (?:pin|label) BOARD[ /][^`]*)`", rows)]
        self.assertEqual(len(commands), 11)
        for words in commands:
            done = real.asipctl(*words)
            self.assertEqual(done.returncode, 0, f"{words}: {done.stderr}")
        with asip.connect(f"mqtt://127.0.0.1:{real.broker_port}", timeout=SECONDS) as bus:
            home = bus.board("home", timeout=SECONDS)

            def value(pin):
                try:
                    return home[f"io/{pin}"].value
                except asip.Unproven:
                    return None

            def switched():
                return re.findall(r"relay (on|off)$", (real.work / "sim.log").read_text(), re.MULTILINE)

            def shows(pin, wanted):
                eventually(lambda: value(pin) == wanted, f"io/{pin} is {wanted}")
            shows(4, False)
            self.assertEqual(real.part("home/relay"), "off")
            home["io/4"].write(True)
            eventually(lambda: real.part("home/relay") == "on", "the relay switches on low")
            shows(4, True)
            shows(5, False)
            real.sim("press", "motion")
            shows(5, True)
            shows(6, True)
            real.sim("press", "reed")  # the door is closed
            shows(6, False)
            eventually(lambda: abs(home["io/14"].read() - 50) < 2, "the soil is half wet")
            home["io/9"].write({"on": True, "brightness": 128})
            eventually(lambda: real.part("home/lamp") == "pwm 128", "the lamp is dimmed")
            for level, relay in ((True, ["off", "on"]), (False, [])):
                home["io/4"].write(level)
                home["io/9"].write({"on": True, "brightness": 128})
                before = len(switched())
                real.sim("reset", "home")
                eventually(lambda: home["io/9"].how == "" and value(4) is level, "the board restarts, and its level is restored", 60)
                self.assertEqual(switched()[before:], relay, "what the relay did meanwhile")
                self.assertEqual(real.part("home/lamp"), "off")
                shows(6, False)


if __name__ == "__main__":
    unittest.main()
