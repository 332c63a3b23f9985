# SPDX-License-Identifier: Apache-2.0
"""docs/start-develop.md and docs/start-robot.md from where their readers stand: an empty home, the PATH of a user, a built clone.

Develop: the demo as `./run demo` starts it, and a second terminal with nothing but the line that the demo says to paste. Robot: a bus,
and a robot that is plugged in, whose agent is started as the packages start it. (Its laps are the test demo_robot; the other three
pages are tests/packages/pages.py.)"""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from bus import BIN, IMAGES, ROOT, Bus, eventually
from page_commands import commands_of, page_text

PATH = "/usr/local/bin:/usr/bin:/bin"


class Terminal:
    """A user with an empty home reads the pages, in the folder of the clone."""

    def __init__(self, home, before):
        self.home, self.before = home, before

    def types(self, command):
        done = subprocess.run(["bash", "-c", f"{self.before}\n{command}"], cwd=ROOT, env={"HOME": self.home, "PATH": PATH, "LC_ALL": "C.UTF-8"}, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60, check=False)
        print(f"$ {command}\n{done.stdout}", end="", file=sys.stderr)
        return done

    def runs(self, program, how="python3"):
        file = os.path.join(self.home, "first.py")
        with open(file, "w", encoding="utf-8") as out:
            out.write(program)
        return self.types(f"{how} {file}")


class FirstSteps(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name

    def demo(self):
        """The line to paste."""
        demo = subprocess.Popen([ROOT / "demo/demo"], cwd=ROOT, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, start_new_session=True)

        def end():
            demo.send_signal(signal.SIGTERM)
            demo.stdout.read()
            demo.wait(30)
            demo.stdout.close()

        self.addCleanup(end)
        for line in demo.stdout:
            if line.strip().startswith("export "):
                return line.strip()
        return self.fail("the demo ended without a line to paste")

    def test_develop(self):
        page = page_text("start-develop")
        self.assertIn("./run demo\n", page)
        self.assertIn(' exec demo/demo "$@"\n', (ROOT / "run").read_text(encoding="utf-8"), "what ./run demo starts")
        reader = Terminal(self.folder, self.demo())
        how = re.search(r"run it by `(.*) first\.py`", page)[1]
        with open(os.path.join(self.folder, "page.md"), "w", encoding="utf-8") as out:
            out.write(page)
        shown = reader.types(f"/usr/bin/python3 -B tests/docs/transcript.py {self.folder}/page.md")
        self.assertEqual(shown.returncode, 0, shown.stdout)
        programs = [text for language, text in commands_of(page) if language == "python"]
        self.assertEqual(len(programs), 1)
        ran = reader.runs(programs[0], how)
        self.assertEqual(ran.returncode, 0)
        self.assertRegex(ran.stdout, r"^\[42, (0|None)\] cm\n$")

    def test_robot(self):
        page = page_text("start-robot")
        bus = Bus(boards=())
        self.addCleanup(bus.close)
        robot = bus.work / "robot.json"
        robot.write_text(json.dumps({"name": "arduino", "image": str(IMAGES / "asip_uno_mirto.elf"), "link": str(bus.work / "usb-arduino"), "world":
                                     str(ROOT / "sim/worlds/track.json"), "parts": [{"kind": "rover", "name": "rover"}]}))
        bus.start("sim", "asip-sim", "--socket", str(bus.work / "sim.sock"), str(robot))
        eventually((bus.work / "usb-arduino").exists, "the robot's port")
        with set_for_a_moment("INVOCATION_ID", "1"):
            bus.start("agent", "asip-agent", "--serial", str(bus.work / "usb-arduino"), "--no-step-up", "--patience", "60")
        eventually(lambda: bus.state("usb-arduino") == "online", "the robot, by its port", 60)
        reader = Terminal(self.folder, f"export ASIP_BROKER=127.0.0.1:{bus.broker_port} PATH={BIN}:$PATH PYTHONPATH={ROOT}/python")
        self.assertIn("usb-arduino", reader.types("asipctl list").stdout)
        self.assertIn("./build/deb/python3-asip_*.deb", page, "which PYTHONPATH stands for here")
        naming = re.search(r"`(asipctl send BOARD --raw '#,I,robot')`", page)[1]
        self.assertEqual(reader.types(naming.replace("BOARD", "usb-arduino")).returncode, 0)
        for plug in ("unplug", "replug"):
            subprocess.run([BIN / "asip-sim", "ctl", "--socket", bus.work / "sim.sock", plug], check=True, stdout=subprocess.DEVNULL)
        eventually(lambda: bus.state("robot") == "online", "the robot by its name", 60)
        for language, text in commands_of(page):
            began = time.monotonic()
            done = reader.runs(text) if language == "python" else reader.types(text)
            self.assertEqual(done.returncode, 0, text)
            if "stop" in text:
                refused = reader.types("asipctl send robot/motors power 0 120")
                self.assertIn("stopped", refused.stdout)
                again = re.search(r"(asipctl resume robot)", page)[1]
                self.assertEqual(reader.types(again).returncode, 0)
            else:
                self.assertGreaterEqual(time.monotonic() - began, 2, text)
                self.assertIn("M,s,0: ok" if "hold 500ms" in text else "", done.stdout)


@contextlib.contextmanager
def set_for_a_moment(name, value):
    os.environ[name] = value
    try:
        yield
    finally:
        del os.environ[name]


if __name__ == "__main__":
    unittest.main()
