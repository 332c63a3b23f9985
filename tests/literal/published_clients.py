# SPDX-License-Identifier: Apache-2.0
"""Clients as their authors published them on PyPI, unmodified, against simulated boards with our firmware, also without its
extensions (not with ASIP 0.4 itself, which is no part of this project): on the serial port, on an agent's TCP port, over MQTT. A
driver chooses the port, and makes up for what a pseudo-terminal lacks (DTR) and for imports that the packages have wrong; what is
sent and read is theirs."""

import json
import os
import pathlib
import re
import subprocess
import sys
import unittest

import bus as bus_module
from bus import Bus, eventually, free_port, settings_file

PYTHON = os.environ["ASIP_PUBLISHED_CLIENTS"] + "/bin/python"
ROOT = bus_module.ROOT
IMAGES = bus_module.IMAGES

# Which port, and what a pseudo-terminal lacks.
SERIAL = """
import sys, time, serial, serial.tools.list_ports
PORT = sys.argv[1]
serial.Serial._update_dtr_state = lambda self: None
serial.Serial._update_rts_state = lambda self: None
import glob
glob.glob = lambda pattern: [PORT]
"""

# The MQTT classes import each other by bare names, by two names of their package, and know one port of a broker.
MQTT = """
import pathlib, sys, time, types
import python_asip_client
folder = pathlib.Path(python_asip_client.__file__).parent
sys.path += [str(folder), str(folder / "boards")]
import mqtt_board
mqtt_board.MQTTBoard._MQTTBoard__TCP_port = int(sys.argv[1])
mqtt_board.MQTTBoard.DEBUG = False
import mqtt_mirto_robot
sys.modules["mirto_robot_classes"] = types.ModuleType("mirto_robot_classes")
sys.modules["mirto_robot_classes.mqtt_mirto_robot"] = mqtt_mirto_robot
"""


def board(name, image, led=True):
    parts = [{"kind": "led", "name": "led", "pin": 13}] if led else []
    return {"name": name, "board": "uno", "image": str(IMAGES / image), "link": f"{name}.port", "parts": parts}


def robot(name, wiring):
    file = json.loads((ROOT / "sim" / "examples" / wiring).read_text())
    file["name"] = name
    file["image"] = str(IMAGES / "asip_uno_mirto.elf")
    file["world"] = str(ROOT / "sim" / "worlds" / "track.json")
    file["link"] = f"{name}.port"
    return file


class PublishedClients(unittest.TestCase):
    def setUp(self):
        self.bus = None

    def tearDown(self):
        if self.bus:
            if sys.exc_info()[0]:
                print(self.bus.logs())
            self.bus.close()

    def begin(self, *boards):
        """Broker and simulated boards; agents are started by each test."""
        self.bus = Bus(boards=())
        files = []
        for each in boards:
            file = self.bus.work / f"{each['name']}.json"
            file.write_text(json.dumps(each))
            files.append(str(file))
        self.bus.start("sim", "asip-sim", "--socket", str(self.bus.work / "sim.sock"), *files)
        for each in boards:
            eventually((self.bus.work / f"{each['name']}.port").exists, f"the port of {each['name']}")

    def agent(self, name, *options):
        self.bus.start(f"agent-{name}", "asip-agent", "--serial", self.port(name), "--name", name, "--no-step-up",
                       "--patience", "60", *options)
        eventually(lambda: self.bus.state(name) == "online", f"{name} online", 30)

    def port(self, name):
        return str(self.bus.work / f"{name}.port")

    def run_client(self, code, *arguments, seconds=60):
        """What the client printed. It must end by itself."""
        done = subprocess.run([PYTHON, "-B", "-c", code, *map(str, arguments)], capture_output=True, text=True, timeout=seconds)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr[-3000:])
        return done.stdout

    BLINK = """
from python_asip_client.boards.{module} import {board}
board = {make}
asip = board.get_asip_client()
asip.set_pin_mode(13, asip.OUTPUT)
asip.digital_write(13, asip.HIGH)
time.sleep(1)
print("ANALOG", asip.analog_read(0), flush=True)
print("PINS", len(asip.get_digital_pins()), flush=True)
board.thread_killer()
"""

    def assert_blinked(self, printed, name):
        eventually(lambda: self.bus.part(f"{name}/led").split()[0] == "on", f"the LED of {name}: {self.bus.part(f'{name}/led')}", 5)
        self.assertNotIn("Error message received", printed)
        self.assertRegex(printed, r"ANALOG \d+")
        self.assertRegex(printed, r"PINS [1-9]")

    def test_python_asip_on_the_serial_port(self):
        self.begin(board("ours", "asip_uno_services.elf"), board("old", "asip_uno_04_services.elf"))
        for name in ("ours", "old"):
            with self.subTest(name):
                printed = self.run_client(SERIAL + self.BLINK.format(module="serial_board", board="SerialBoard",
                                                                     make="SerialBoard()"), self.port(name))
                self.assert_blinked(printed, name)

    def test_python_asip_over_tcp(self):
        self.begin(board("ours", "asip_uno_services.elf"), board("old", "asip_uno_04_services.elf"))
        for name in ("ours", "old"):
            with self.subTest(name):
                port = free_port()
                self.agent(name, "--listen", str(port))
                printed = self.run_client("import sys, time\n" + self.BLINK.format(
                    module="tcp_board", board="TCPBoard", make="TCPBoard(tcp_port=int(sys.argv[1]))"), port)
                self.assert_blinked(printed, name)

    def test_python_asip_over_tcp_on_boards_that_browsers_lend(self):
        sys.path[:0] = [str(ROOT / "tests" / folder) for folder in ("cable", "box")]
        from lending_test import LendingBus

        first = free_port()

        class ListeningBus(LendingBus):
            agent_options = ("--listen", str(first))

        names = ("one", "two")
        self.bus = ListeningBus([{"name": name, "image": str(IMAGES / "asip_uno_services.elf"), "parts": board(name, "")["parts"]} for name in names])
        for number, name in enumerate(names):
            lent = self.bus.lend(name)
            self.addCleanup(lent.close)
            eventually(lambda: lent.name, "its name", 60)
            self.bus.online(lent.name)
            printed = self.run_client("import sys, time\n" + self.BLINK.format(
                module="tcp_board", board="TCPBoard", make="TCPBoard(tcp_port=int(sys.argv[1]))"), first + number)
            self.assert_blinked(printed, name)

    def test_python_asip_over_mqtt(self):
        self.begin(board("ours", "asip_uno_services.elf"), board("old", "asip_uno_04_services.elf"))
        for name in ("ours", "old"):
            with self.subTest(name):
                self.agent(name, "--config", settings_file("topics = client-side\n"))
                code = MQTT + self.BLINK.replace("from python_asip_client.boards.{module} import {board}", "").format(
                    make="mqtt_board.MQTTBoard('127.0.0.1', sys.argv[2])")
                # This class sets the period of analog reports to 0 before it reads any.
                printed = self.run_client(code.replace("time.sleep(1)", "asip.set_auto_report_interval(50); time.sleep(1)"),
                                          self.bus.broker_port, name)
                self.assert_blinked(printed, name)

    def test_robot_of_python_asip_drives_by_requests_without_line_end(self):
        self.begin(robot("mirto", "mirto-motors-exchanged.json"))
        code = """
import sys, time
from python_asip_client.tcp_mirto_robot import TCPMirtoRobot
from python_asip_client.mirto_robot import MirtoRobot
board = TCPMirtoRobot(tcp_port=int(sys.argv[1]))
robot = MirtoRobot(board.get_services())
time.sleep(1)
print("IR", robot.get_all_ir_values([2, 1, 0]), flush=True)
print("BUMPS", robot.is_bump_pressed(0), robot.is_bump_pressed(1), flush=True)
robot.set_motors(50, -50)
time.sleep(2)
robot.stop_motors()
time.sleep(1.2)
board.thread_killer()
"""
        port = free_port()
        self.agent("mirto", "--listen", str(port))
        before = self.place()
        printed = self.run_client(code, port)
        after = self.place()
        moved = ((after[0] - before[0]) ** 2 + (after[1] - before[1]) ** 2) ** .5
        self.assertGreater(moved, 40, f"{before} {after}\n{printed}")
        self.assertLess(moved, 500, "it stopped")
        ir = [int(text) for text in re.search(r"IR \[(\d+), (\d+), (\d+)\]", printed).groups()]
        self.assertGreater(ir[1], ir[0], "it begins with its middle sensor on the line")

    def place(self):
        """x and y of the rover, in mm."""
        numbers = re.findall(r"-?\d+(?:\.\d+)?", self.bus.part("mirto/rover"))
        return float(numbers[0]), float(numbers[1])

    def test_line_follower_of_python_asip_drives_laps(self):
        self.begin(robot("mirto", "mirto-motors-exchanged.json"))
        self.agent("mirto", "--config", settings_file("topics = client-side\n"))
        code = MQTT + """
# Its robot calls a method that this class of the package does not have.
from services.encoder_service import EncoderService
EncoderService.set_reporting_interval = lambda self, ms: self.asip.get_asip_writer().write(f"E,A,{ms}")
from python_asip_client.examples.example_apps.mqtt_mirto_pid_follower import MQTTMirtoPIDFollower
MQTTMirtoPIDFollower("127.0.0.1", "mirto").main()
"""
        follower = subprocess.Popen([PYTHON, "-B", "-c", code, str(self.bus.broker_port)], stdout=subprocess.DEVNULL,
                                    stderr=subprocess.PIPE, text=True, preexec_fn=bus_module.die_with_parent)
        log = pathlib.Path(self.bus.work / "sim.log")
        try:
            laps = eventually(lambda: (found := re.findall(r"rover lap .*", log.read_text())) and len(found) >= 2 and found,
                              "two laps", 120)
        except AssertionError:
            follower.terminate()
            raise AssertionError(log.read_text()[-2000:] + follower.communicate()[1][-2000:]) from None
        finally:
            follower.terminate()
            follower.wait(10)
            follower.stderr.close()
        print(laps)
        self.assertNotIn("off-track", log.read_text())

    def test_mirto_asip_manager_on_the_serial_port(self):
        self.begin(robot("mirto", "mirto.json"))
        code = SERIAL + """
import logging
begin = logging.FileHandler.__init__
logging.FileHandler.__init__ = lambda self, name, *rest, **options: begin(self, sys.argv[2], *rest, **options)
from mirto_asip_manager.mirto_robot import MirtoRobot
robot = MirtoRobot(debug=False, services_on={"encoders": [False, False], "motors": [True, False], "ir_sensors": [True, False]})
print("IR", robot.get_ir_sensors_values(), flush=True)
print("VERSION", robot.robot.all_services["sys_info"].system_version, flush=True)
robot.set_motors(100, -100)
time.sleep(2)
robot.stop_motors()
time.sleep(.3)
robot.terminate()
"""
        before = self.place()
        printed = self.run_client(code, self.port("mirto"), self.bus.work / "client.log")
        after = self.place()
        self.assertNotEqual(before, after, printed)
        self.assertRegex(printed, r"IR \[.*\d{2,}")


if __name__ == "__main__":
    unittest.main()
