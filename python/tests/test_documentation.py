# SPDX-License-Identifier: Apache-2.0
"""Each block of docs/python.md and of python/README.md is run as it stands there, on a real bus."""
import io
import os
import pathlib
import pydoc
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import tokenize
import unittest

import paho.mqtt

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests" / "support"))
from bus import Bus, eventually  # noqa: E402


def other_pythons():
    """The oldest Python that the package supports and Debian 13's, where they are on this machine and are not the one that runs."""
    for version in ("3.9", "3.13"):
        places = [shutil.which(f"python{version}"), *sorted(pathlib.Path.home().glob(f".pyenv/versions/{version}.*/bin/python3"))]
        for place in filter(None, places):
            done = subprocess.run([place, "-c", "import sys; print('%d.%d' % sys.version_info[:2])"], capture_output=True, text=True)
            if done.stdout.strip() == version != "%d.%d" % sys.version_info[:2]:
                yield str(place)
                break


class Pages(unittest.TestCase):
    def test_each_block_runs(self):
        self.run_blocks(sys.executable, [str(HERE.parent)])

    def test_each_block_runs_with_other_pythons(self):
        with tempfile.TemporaryDirectory() as folder:  # paho-mqtt of this Python: it is the same files for all of them
            pathlib.Path(folder, "paho").symlink_to(pathlib.Path(paho.mqtt.__file__).parents[1])
            for python in other_pythons():
                with self.subTest(python):
                    self.run_blocks(python, [str(HERE.parent), folder])

    def run_blocks(self, python, path):
        real = Bus()
        self.addCleanup(real.close)
        environment = {**os.environ, "ASIP_BROKER": f"127.0.0.1:{real.broker_port}", "PYTHONPATH": os.pathsep.join(path)}
        run = 0
        for page in (*(ROOT / "docs" / name for name in ("python.md", "start-in-class.md", "start-develop.md")), ROOT / "python" / "README.md"):
            for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL):
                if "import adafruit" in block:
                    continue  # tests/drivers has the package, and a board with the chip
                block = textwrap.dedent(block).replace('"student-1"', '"desk"')  # a board of the reader's
                with self.subTest(page=page.name, block=block.splitlines()[:4]):
                    done = subprocess.run([python, "-X", "dev", "-W", "error::DeprecationWarning", "-c", block], env=environment,
                                          capture_output=True, text=True, timeout=60)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    if "distance.read()" in block and "testing" not in block:
                        self.assertIn("[42, None]", done.stdout)
                    run += 1
        self.assertGreaterEqual(run, 7)


    def test_help_is_what_the_page_shows(self):
        from asip import testing
        shown = re.search(r"```console\n(write\(servo.*?)```", (ROOT / "docs" / "python.md").read_text(), re.DOTALL)[1]
        with testing.MemoryBus(desk=["servo"]) as memory:
            text = pydoc.plain(pydoc.render_doc(memory.connect().board("desk").servo.write))
        for line in filter(None, shown.splitlines()):
            self.assertIn(line, text)


def lines_of_code(path):
    """Without comments, blank lines and texts for the reader."""
    found = set()
    for token in tokenize.generate_tokens(io.StringIO(path.read_text()).readline):
        if token.type in (tokenize.NAME, tokenize.OP, tokenize.NUMBER) or token.type == tokenize.STRING and not token.string.startswith('"""'):
            found.update(range(token.start[0], token.end[0] + 1))
    return len(found)


class Lines(unittest.TestCase):
    def test_a_switch_between_two_boards_takes_six_lines(self):
        self.assertLessEqual(lines_of_code(ROOT / "examples" / "two_board_switch.py"), 6)


class Examples(unittest.TestCase):
    def setUp(self):
        self.real = Bus()
        self.addCleanup(self.real.close)

    def start(self, name, *arguments):
        environment = {**os.environ, "ASIP_BROKER": f"127.0.0.1:{self.real.broker_port}", "PYTHONPATH": str(HERE.parent)}
        program = subprocess.Popen([sys.executable, "-u", ROOT / "examples" / name, *arguments], env=environment, stdout=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (program.kill(), program.communicate()))
        return program

    def lights(self, part):
        eventually(lambda: self.real.part(part) == "off", f"{part} is off")
        self.real.sim("press", "desk/button")
        eventually(lambda: self.real.part(part) == "on", f"{part} is on")
        self.real.sim("release", "desk/button")
        eventually(lambda: self.real.part(part) == "off", f"{part} is off again")

    def test_two_board_switch(self):
        program = self.start("two_board_switch.py")
        self.lights("lamp/lamp")
        self.real.end("agent-desk", signal.SIGKILL)  # the board's cable, as it were
        self.real.sim("press", "desk/button")
        self.real.start_agent("desk")
        eventually(lambda: self.real.part("lamp/lamp") == "on", "the lamp shows the level when the board returns", 60)
        program.send_signal(signal.SIGTERM)
        self.assertEqual(program.wait(10), 0)

    def test_lamp(self):
        program = self.start("lamp.py", "desk")
        self.assertEqual(program.stdout.readline(), "desk is online\n")
        self.assertEqual(program.stdout.readline(), "distance [42, None] cm\n")
        self.lights("desk/led")


if __name__ == "__main__":
    unittest.main()
