# SPDX-License-Identifier: Apache-2.0
"""From the box to the bus: boards with a boot loader and no sketch. The real boot loaders of the Nano run in the simulator, and a
real avrdude, started by the board's agent, speaks to them. Agents are started as a service manager starts them."""

import json
import os
import pathlib
import re
import signal
import subprocess
import unittest
import urllib.request

from bus import BIN, IMAGES, ROOT, Bus, eventually, paho_client, settings_file

LOADERS = pathlib.Path("/usr/share/arduino/hardware/arduino/avr/bootloaders")
OLD_NANO = LOADERS / "atmega/ATmegaBOOT_168_atmega328.hex"
EYE = {"kind": "ultrasonic", "name": "eye", "trigger": 7, "echo": 7, "distance": 42}
NOTHING = ":02000000FFCF30\n:00000001FF\n"  # for ever: rjmp .


def needs_tools():
    for tool in ("avrdude", "avr-objcopy"):
        if subprocess.run(["sh", "-c", f"command -v {tool}"], capture_output=True, check=False).returncode != 0:
            raise unittest.SkipTest(f"{tool} is not installed")


class Boxes(Bus):
    """A bus, and boards that are plugged in and pulled out: simulator and agent of each begin and end with that."""

    def __init__(self):
        super().__init__(boards=())
        self.firmware = self.work / "firmware"
        subprocess.run([ROOT / "packaging/loadable_firmware", IMAGES, self.firmware], check=True)

    def start_gateway(self):
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", "--home-assistant")
        eventually(lambda: self.get("/readyz"), "the gateway")

    def plug(self, port, image=OLD_NANO, name=None, parts=(EYE,)):
        """A board in the socket of this name; its memory is what it was, where it was there before by `name`."""
        name = name or port
        file = self.work / f"{name}.json"
        file.write_text(json.dumps({"name": name, "board": "nano", "image": str(image), "link": str(self.work / port),
                                    "reset_on_open": True, "parts": list(parts)}))
        self.start(f"sim-{port}", "asip-sim", "--no-socket", str(file))
        eventually((self.work / port).exists, f"the port of {port}")
        self.start_service(port)

    def start_service(self, port):
        os.environ["INVOCATION_ID"] = "1"  # as a service manager says it
        try:
            self.start(f"agent-{port}", "asip-agent", "--serial", str(self.work / port), "--lease", "6", "--no-step-up",
                       "--config", settings_file(f"firmware-dir = {self.firmware}\n"))
        finally:
            del os.environ["INVOCATION_ID"]

    def pull(self, port):
        self.end(f"agent-{port}")
        self.end(f"sim-{port}")

    def is_without_asip(self, board):
        found = self.get("/api/boards")["items"]
        return any(each["board"] == board and each["state"] == "lost" and each["reason"] == "silent" for each in found)


class OneBoard(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        needs_tools()
        cls.bus = Boxes()
        cls.addClassCleanup(cls.bus.close)

    def test_board_without_asip_is_found_loaded_with_progress_and_read(self):
        bus = self.bus
        bus.plug("usb-3")
        eventually(lambda: bus.is_without_asip("usb-3"), "the board, without ASIP", 40)
        with urllib.request.urlopen(bus.url + "/metrics", timeout=30) as answer:
            shown = answer.read().decode()
        self.assertIn('asip_boards{state="no-asip"} 1\n', shown)
        self.assertNotRegex(shown, r'asip_boards{state="lost"} [1-9]')  # what the shipped alert asks for
        doctor = bus.asipctl("doctor")
        self.assertRegex(doctor.stdout, r"a board at .*usb-3 that speaks no ASIP")
        self.assertIn("asipctl flash usb-3", doctor.stdout)
        flashed = bus.asipctl("flash", "usb-3", "--board", "nano-old")
        self.assertEqual(flashed.returncode, 0, flashed.stderr + bus.logs())
        self.assertEqual(flashed.stdout, "usb-3: AsipServices on ATmega328P\n")
        self.assertRegex(flashed.stderr, r"usb-3: connecting\n(.*\n)*.*usb-3: writing \d+ %\n(.*\n)*.*usb-3: verifying \d+ %")
        eventually(lambda: bus.state("usb-3") == "online", "the board online")
        self.assertIn("42", bus.asipctl("get", "usb-3/distance/0").stdout)
        again = bus.asipctl("flash", "usb-3")
        self.assertEqual(again.returncode, 1)
        self.assertIn("runs ASIP already (AsipServices)", again.stderr)
        self.assertNotIn("speaks no ASIP", bus.asipctl("doctor").stdout)
        bus.pull("usb-3")

    def test_thermometer_from_the_box_shows_degrees_in_home_assistant(self):
        bus = self.bus
        shown = {}
        client = paho_client()
        client.on_message = lambda _client, _data, message: shown.update({message.topic: message.payload.decode()})
        client.connect("127.0.0.1", bus.broker_port)
        client.subscribe([("homeassistant/#", 0), ("asip/export/#", 0)])
        client.loop_start()
        self.addCleanup(client.loop_stop)
        bus.plug("usb-6", parts=[{"kind": "ds18b20", "name": "wire", "pin": 2, "devices": [{"temperature": 21.5}, {"temperature": -3}]}])
        eventually(lambda: bus.is_without_asip("usb-6"), "the board, without ASIP", 40)
        flashed = bus.asipctl("flash", "usb-6", "--board", "nano-old", "--firmware", "AsipThermometers")
        self.assertEqual(flashed.stdout, "usb-6: AsipThermometers on ATmega328P\n", flashed.stderr + bus.logs())

        def temperature(index):
            document = shown.get("homeassistant/device/asip-usb-6/config")
            return json.loads(document)["cmps"].get(f"thermometers-{index}-temperature") if document else None

        entity = eventually(lambda: temperature(0), "the thermometer in Home Assistant")
        self.assertEqual((entity["p"], entity["dev_cla"], entity["unit_of_meas"]), ("sensor", "temperature", "\u00b0C"))
        topics = [f"asip/export/ha/usb-6/thermometers-{index}-temperature" for index in range(2)]
        eventually(lambda: all(topic in shown for topic in topics), "both temperatures")
        self.assertEqual({float(shown[topic]) for topic in topics}, {21.5, -3})
        bus.pull("usb-6")

    def test_board_without_a_boot_loader_fails_in_words_and_leaves_nothing_behind(self):
        bus = self.bus
        empty = bus.work / "empty.hex"
        empty.write_text(NOTHING)
        bus.plug("usb-4", empty)
        eventually(lambda: bus.is_without_asip("usb-4"), "the board, without ASIP", 40)
        flashed = bus.asipctl("flash", "usb-4", "--board", "nano")
        self.assertEqual(flashed.returncode, 1)
        self.assertIn("no boot loader answers: press the board's reset button", flashed.stderr)
        missing = bus.asipctl("flash", "usb-4", "--firmware", "NoSuch", "--board", "uno")
        self.assertRegex(missing.stderr, r"has no firmware .*NoSuch-uno\.hex")
        bus.pull("usb-4")
        eventually(lambda: all(each["board"] != "usb-4" for each in bus.get("/api/boards")["items"]), "the socket is forgotten")


class Class(unittest.TestCase):
    """A teacher with boards from the box: as many as ASIP_CLASS says, two of which fail at first."""

    def begin(self, bus):
        """The bus is there, and no board."""

    def is_seen(self, bus, board):
        """A board of the class was loaded, and is plugged in."""
        self.assertIn("42", bus.asipctl("get", f"{board}/distance/0").stdout)

    def teach(self, bus, log, count=0):
        """A teacher's `asipctl flash --class`, and what it has said."""
        with open(log, "wb") as out:
            teacher = subprocess.Popen([str(BIN / "asipctl"), "flash", "--class", "--names", "student-{}", "--board", "nano-old", "--count", str(count)],
                                       stdout=out, stderr=out, env={**os.environ, "ASIP_BROKER": f"127.0.0.1:{bus.broker_port}"})
        self.addCleanup(lambda: teacher.poll() is None and teacher.kill())
        return teacher

    def test_interrupted_while_a_board_is_loaded_the_next_start_names_it(self):
        needs_tools()
        bus = Boxes()
        self.addCleanup(bus.close)
        bus.plug("usb-1")
        log = bus.work / "class.out"
        teacher = self.teach(bus, log)
        eventually(lambda: "writing" in json.dumps(bus.get("/api/boards?full=true")), "the board is written", 90)
        teacher.send_signal(signal.SIGINT)
        teacher.wait(10)
        self.assertIn("waiting for boards: plug them in. One that is plugged in already is seen", log.read_text())
        self.assertRegex(log.read_text(), r"usb-1 +left +interrupted; its agent goes on; start this again to name it")
        eventually(lambda: bus.state("usb-1") == "online", "the board, loaded, by its port", 90)
        again = bus.asipctl("flash", "--class", "--names", "student-{}", "--count", "1")
        self.assertRegex(again.stdout, r"student-1 +named +AsipServices on ATmega328P")
        self.assertIn("0 loaded, 1 named, 0 passed over, 0 failed", again.stdout)
        eventually(lambda: bus.state("student-1") == "online", "the board by its name")

    def test_each_board_is_loaded_and_named_and_those_that_fail_are_tried_again(self):
        needs_tools()
        bus = Boxes()
        self.addCleanup(bus.close)
        self.begin(bus)
        count = int(os.environ.get("ASIP_CLASS", "2"))
        empty = bus.work / "empty.hex"
        empty.write_text(NOTHING)
        log = bus.work / "class.out"
        teacher = self.teach(bus, log, count)
        rows = lambda: re.findall(r"^(\S+) +(loaded|failed|passed over) ", log.read_text(), re.M)

        def wait_row(row):
            eventually(lambda: row in rows(), f"the row {row}", 90)

        for i in range(1, count + 1):
            if i == 1:  # no boot loader
                bus.plug("usb-1", empty, "broken")
                wait_row(("usb-1", "failed"))
                bus.pull("usb-1")
            if i == 3:  # pulled out while it is written
                bus.plug("usb-3", name="pulled")
                eventually(lambda: "writing" in json.dumps(bus.get("/api/boards?full=true")), "the board is written", 60)
                bus.end("sim-usb-3")
                wait_row(("usb-3", "failed"))
                bus.end("agent-usb-3")
            bus.plug(f"usb-{i}")
            wait_row((f"student-{i}", "loaded"))
            eventually(lambda: bus.state(f"student-{i}") == "online", "the board by its name")
            self.is_seen(bus, f"student-{i}")
            if i < count:
                bus.pull(f"usb-{i}")
        self.assertEqual(teacher.wait(20), 0, log.read_text())
        self.assertIn(f"{count} loaded, 0 passed over, 0 failed", log.read_text())
        self.assertNotIn("student-" + str(count + 1), log.read_text())
        # The board keeps its name, and is passed over next time.
        again = bus.asipctl("flash", "--class", "--names", "student-{}", "--count", "1")
        self.assertRegex(again.stdout, rf"student-{count} +passed over +it runs AsipServices already")
        self.assertFalse([each for each in bus.get("/api/boards")["items"] if each["board"].startswith("usb-")], "sockets are forgotten")


if __name__ == "__main__":
    unittest.main()
