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

from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties

from bus import BIN, IMAGES, ROOT, Bus, eventually, paho_client, settings_file

LOADERS = pathlib.Path("/usr/share/arduino/hardware/arduino/avr/bootloaders")
OLD_NANO = LOADERS / "atmega/ATmegaBOOT_168_atmega328.hex"
EYE = {"kind": "ultrasonic", "name": "eye", "trigger": 7, "echo": 7, "distance": 42}
NOTHING = ":02000000FFCF30\n:00000001FF\n"  # for ever: rjmp .


def needs_tools():
    for tool in ("avrdude", "avr-objcopy"):
        if subprocess.run(["sh", "-c", f"command -v {tool}"], capture_output=True, check=False).returncode != 0:
            raise unittest.SkipTest(f"{tool} is not installed")


def next_version(firmware):
    """A newer package is installed: what it loads is the same, but says that it is 0.3. Agents know it when they ask their boards."""
    for image in firmware.glob("*.hex"):
        raw = image.with_suffix(".bin")
        subprocess.run(["avr-objcopy", "-I", "ihex", "-O", "binary", image, raw], check=True)
        assert b",D:1,F:2}" in raw.read_bytes(), image
        raw.write_bytes(raw.read_bytes().replace(b",D:1,F:2}", b",D:1,F:3}"))
        subprocess.run(["avr-objcopy", "-I", "binary", "-O", "ihex", raw, image], check=True)
        raw.unlink()
    versions = firmware / "versions"
    versions.write_text(versions.read_text().replace(" 2\n", " 3\n"))


def ask_anew(bus, board):
    for option in (("--for", "1m"), ("--back",)):
        released = bus.asipctl("release", board, *option)
        assert released.returncode == 0, released.stderr


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

    def exported(self):
        """{topic: text} of what Home Assistant is told from now on."""
        told = {}
        client = paho_client()
        client.on_message = lambda _client, _data, message: told.update({message.topic: message.payload.decode()})
        client.connect("127.0.0.1", self.bus.broker_port)
        client.subscribe([("homeassistant/#", 0), ("asip/export/#", 0)])
        client.loop_start()
        self.addCleanup(client.loop_stop)
        return told

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

    def test_sketch_that_is_out_of_date_is_said_everywhere_and_updated(self):
        bus = self.bus
        told = self.exported()
        metrics = lambda: urllib.request.urlopen(bus.url + "/metrics", timeout=30).read().decode()
        bus.plug("usb-8")
        eventually(lambda: bus.is_without_asip("usb-8"), "the board, without ASIP", 60)
        self.assertEqual(bus.asipctl("flash", "usb-8", "--board", "nano-old").returncode, 0)
        eventually(lambda: bus.state("usb-8") == "online", "online", 60)
        self.assertRegex(bus.asipctl("list").stdout, r"usb-8 +online +ATmega328P +AsipServices 0\.2  ")
        self.assertIn("asip_boards_out_of_date 0\n", metrics())
        self.assertIn("no board is out of date", bus.asipctl("flash", "--update").stderr)
        next_version(bus.firmware)
        self.assertIn("no board is out of date", bus.asipctl("flash", "--update").stderr)
        ask_anew(bus, "usb-8")
        eventually(lambda: "AsipServices 0.2, out of date" in bus.asipctl("list").stdout, "out of date", 60)
        self.assertIn("asip_boards_out_of_date 1\n", metrics())
        self.assertRegex(bus.asipctl("show", "usb-8").stdout, r"newer +0\.3; asipctl flash --update usb-8")
        board = next(each for each in bus.get("/api/boards")["items"] if each["board"] == "usb-8")
        self.assertEqual((board["sketch"], board["version"], board["available"]), ("AsipServices", "0.2", "0.3"))
        firmware = "asip/export/ha/usb-8/firmware--update"
        latest = lambda: json.loads(told.get(firmware, "{}")).get("latest_version")
        eventually(lambda: latest() == "0.3", "Home Assistant knows", 60)
        entity = json.loads(told["homeassistant/device/asip-usb-8/config"])["cmps"]["firmware--update"]
        self.assertEqual((entity["p"], entity["stat_t"]), ("update", firmware))
        updated = bus.asipctl("flash", "--update")
        self.assertEqual(updated.returncode, 0, updated.stderr + bus.logs())
        self.assertRegex(updated.stdout, r"^usb-8 +updated +AsipServices 0\.3, \d+ s\n$")
        self.assertRegex(bus.asipctl("list").stdout, r"usb-8 +online +ATmega328P +AsipServices 0\.3  ")
        eventually(lambda: "asip_boards_out_of_date 0\n" in metrics(), "up to date", 60)
        eventually(lambda: json.loads(told[firmware])["installed_version"] == "0.3", "Home Assistant knows", 60)
        # A package whose image is not what its list says: the board is asked, and the answer told.
        versions = bus.firmware / "versions"
        versions.write_text(versions.read_text().replace(" 3\n", " 4\n"))
        ask_anew(bus, "usb-8")
        eventually(lambda: "AsipServices 0.3, out of date" in bus.asipctl("list").stdout, "out of date", 60)
        failed = bus.asipctl("flash", "--update")
        self.assertEqual(failed.returncode, 1, failed.stderr)
        self.assertRegex(failed.stdout, r"^usb-8 +failed +.*the board says that it has AsipServices 0\.3, not 0\.4")
        versions.write_text(versions.read_text().replace(" 4\n", " 3\n"))
        bus.pull("usb-8")

    def test_thermometer_from_the_box_shows_degrees_in_home_assistant(self):
        bus = self.bus
        shown = self.exported()
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


class Fleet(unittest.TestCase):
    """Boards that are out of date, whose agents are played here."""

    COUNT = 300

    def setUp(self):
        self.bus = Bus(boards=())
        self.addCleanup(self.bus.close)
        self.asked = []
        self.refuses = "not-loaded"
        self.client = paho_client(protocol=5)
        self.client.on_message = self.on_message
        self.client.connect("127.0.0.1", self.bus.broker_port)
        self.client.subscribe("asip/+/in", 1)
        self.client.loop_start()
        self.addCleanup(self.client.loop_stop)
        for number in range(self.COUNT):
            self.describe(f"uno{number}", available="0.3")

    def describe(self, board, **firmware):
        self.client.publish(f"asip/servicebus/{board}/$state", "online", 1, True)
        self.client.publish(f"asip/servicebus/{board}/$description", json.dumps({
            "board": board, "session": "1", "seq": len(self.asked) + 1, "lease": 600, "state": {"is": "online", "age": 1},
            "firmware": {"chip": "ATmega328P", "sketch": "AsipServices", "extensions": {"E": 1}, **firmware}, "services": []}), 1, True)

    def on_message(self, client, _data, message):
        board = message.topic.split("/")[1]
        request = json.loads(message.payload)
        self.asked.append((board, request["port"], request["update"]))
        if self.refuses == "dies":
            client.publish(f"asip/servicebus/{board}/$state", "lost", 1, True)
            return
        answer = {"status": "refused", "reason": self.refuses, "error": "no boot loader answers"} if self.refuses else {
            "status": "ok", "answer": {"same": True, "after": {"sketch": "AsipServices", "version": "0.3", "chip": "ATmega328P"}}}
        if not self.refuses:
            self.describe(board, version="0.3")
        where = Properties(PacketTypes.PUBLISH)
        where.CorrelationData = message.properties.CorrelationData
        client.publish(message.properties.ResponseTopic, json.dumps(answer), 1, properties=where)

    def test_update_ends_behind_three_failures_and_the_next_goes_on_with_what_is_left(self):
        eventually(lambda: self.bus.asipctl("list").stdout.count("out of date") == self.COUNT, "all of them", 60)
        failed = self.bus.asipctl("flash", "--update")
        self.assertEqual(failed.returncode, 1, failed.stderr)
        tried = len(self.asked)
        self.assertTrue(3 <= tried <= 6, tried)  # four at once, and none behind the third failure
        self.assertEqual(set(self.asked), {(board, "load", True) for board, *_ in self.asked})
        self.assertEqual(failed.stdout.count("failed       no boot loader answers"), tried)
        self.assertIn(f"0 updated, {tried} failed, {self.COUNT - tried} left; the same again goes on with them", failed.stderr)
        self.refuses = "released"  # another user has them
        others = self.bus.asipctl("flash", "--update")
        self.assertEqual(others.stdout.count("passed over"), self.COUNT, others.stderr)
        self.refuses = ""
        one = self.bus.asipctl("flash", "--update", "uno1")
        self.assertRegex(one.stdout, r"^uno1 +updated +AsipServices 0\.3, 0 s\n$")
        others = self.bus.asipctl("flash", "--update", "-o", "jsonl")
        self.assertEqual(others.returncode, 0, others.stderr)
        self.assertEqual(sorted(json.loads(line)["board"] for line in others.stdout.splitlines()),
                         sorted(f"uno{number}" for number in range(self.COUNT) if number != 1))
        self.assertIn("no board is out of date", self.bus.asipctl("flash", "--update").stderr)


    def test_agent_that_ends_meanwhile_is_a_failure_at_once(self):
        eventually(lambda: self.bus.asipctl("list").stdout.count("out of date") == self.COUNT, "all of them", 60)
        self.refuses = "dies"
        failed = self.bus.asipctl("flash", "--update", "uno1")  # its answer would be waited for six minutes
        self.assertEqual(failed.returncode, 1, failed.stderr)
        self.assertRegex(failed.stdout, r"^uno1 +failed +.*its agent ended; start it, and load it again")


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
