# SPDX-License-Identifier: Apache-2.0
"""The package on a bus that `asipctl secure` made: certificates, credentials files, access rules of a real Mosquitto."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests" / "support"))
from bus import BIN, DESK, can_connect, die_with_parent, eventually, free_port  # noqa: E402

import paho.mqtt.client as mqtt  # noqa: E402

import asip  # noqa: E402


class Secured(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = pathlib.Path(tempfile.mkdtemp(prefix="asip-secure-"))
        cls.addClassCleanup(shutil.rmtree, cls.work)
        cls.port, cls.programs = free_port(), []
        cls.addClassCleanup(cls.end)
        cls.secure("init", "--host", "localhost", "--port", str(cls.port))
        cls.secure("add", "board", "desk")
        cls.secure("add", "operator", "ann")
        cls.secure("add", "viewer", "bob")
        config = (cls.work / "bus" / "mosquitto.conf").read_text() + ("user root\n" if os.geteuid() == 0 else "")
        (cls.work / "run.conf").write_text(config)
        cls.start(shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin"), "-c", cls.work / "run.conf")
        eventually(lambda: can_connect(cls.port), "the broker")
        (cls.work / "desk.json").write_text(json.dumps({**DESK, "link": str(cls.work / "desk.port")}))
        cls.start(BIN / "asip-sim", "--no-socket", cls.work / "desk.json")
        eventually((cls.work / "desk.port").exists, "the board's port")
        cls.start(BIN / "asip-agent", "--serial", cls.work / "desk.port", "--name", "desk", "--no-step-up", "--patience", "60", "--credentials", cls.file("desk"))

    @classmethod
    def start(cls, *words):
        environment = {**{name: value for name, value in os.environ.items() if not name.startswith("ASIP_")}, "XDG_STATE_HOME": str(cls.work / "state")}
        cls.programs.append(subprocess.Popen(list(map(str, words)), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                             env=environment, preexec_fn=die_with_parent))

    @classmethod
    def end(cls):
        for program in reversed(cls.programs):
            program.send_signal(signal.SIGTERM)
        for program in cls.programs:
            try:
                program.wait(10)
            except subprocess.TimeoutExpired:
                program.kill()
                program.wait()

    @classmethod
    def secure(cls, *words):
        subprocess.run([BIN / "asipctl", "secure", *words, "--dir", cls.work / "bus"], check=True, capture_output=True, timeout=60)

    @classmethod
    def file(cls, user):
        return str(cls.work / "bus" / "credentials" / f"{user}.credentials")

    def connect(self, user, **more):
        bus = asip.connect(credentials=self.file(user), timeout=20, **more)
        self.addCleanup(bus.close)
        return bus

    def test_an_operator_reads_and_commands(self):
        bus = self.connect("ann")
        desk = bus.board("desk", timeout=60)
        desk.servo.write(0, 90, timeout=20)
        self.assertEqual(desk.distance.read(timeout=20), [42, None])
        desk.distance.report(100, timeout=20)
        with desk.distance.stream(hz=10, timeout=20) as values:
            self.assertEqual(next(values), [42, None])
        self.assertEqual(desk["servo/0/angle"].read(timeout=20), 90)
        desk.pin(13).mode("output", timeout=20)
        with desk.io.hold(write=[13, 1], seconds=2):
            pass
        bus.stop(["desk"], timeout=20)
        self.assertNotIn("password", repr(bus.settings))

    def test_a_viewer_reads_and_its_commands_do_nothing(self):
        bus = self.connect("bob")
        desk = bus.board("desk", timeout=60)
        self.assertIn("servo/0/angle", [one.id for one in desk.properties])
        desk["distance/0"].read(timeout=20)
        with self.assertRaises(asip.Error) as raised:
            desk.servo.write(0, 10, timeout=2)
        if hasattr(mqtt, "CallbackAPIVersion"):
            self.assertEqual((type(raised.exception), raised.exception.reason, raised.exception.sent), (asip.Refused, "denied", False))
        else:  # paho-mqtt 1.6 does not tell
            self.assertIsInstance(raised.exception, asip.Unproven)

    def test_a_wrong_password_is_told_without_it(self):
        text = pathlib.Path(self.file("ann")).read_text()
        wrong = self.work / "wrong.credentials"
        password = next(line.partition("=")[2].strip() for line in text.splitlines() if line.startswith("password"))
        wrong.write_text(text.replace(password, "hunter2"))
        with self.assertRaises(asip.Disconnected) as raised:
            asip.connect(credentials=str(wrong), timeout=2)
        self.assertRegex(str(raised.exception), "(?i)not authori[sz]ed")
        self.assertNotIn("hunter2", str(raised.exception))

    def test_a_certificate_for_another_name_is_refused(self):
        with self.assertRaises(asip.Disconnected) as raised:
            asip.connect(f"mqtts://127.0.0.2:{self.port}", user="ann", password="x", ca=self.file("ann"), timeout=2)
        self.assertRegex(str(raised.exception), "(?i)certificate")

    def test_without_tls_nothing_is_told(self):
        with self.assertRaises(asip.Disconnected):
            asip.connect(f"mqtt://localhost:{self.port}", timeout=2)


if __name__ == "__main__":
    unittest.main()
