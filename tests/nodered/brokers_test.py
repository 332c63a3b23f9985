# SPDX-License-Identifier: Apache-2.0
"""The bus of the nodes with a real MQTT.js, and TCP ports that do what each test says: brokers that know MQTT 3.1.1 alone, packets that are
none, and moments at which a flow ends."""
import re
import subprocess
import sys
import threading
import unittest

from bus import BUILD, ROOT, eventually

sys.path.insert(0, str(ROOT / "python" / "tests"))
from scripted_broker import CONNACK, PUBLISH, ScriptedBroker, good  # noqa: E402

# With Node-RED's own MQTT.js, as where npm linked the folder of the nodes.
PROGRAM = f"""
const {{ Bus }} = require({str(ROOT / "node-red" / "lib" / "bus.js")!r});
const bus = new Bus({{ brokers: process.argv[2], user: 'ann', password: process.argv[3] }});
for (const event of ['connected', 'disconnected', 'fault']) bus.on(event, (what) => console.log(event, what ?? ''));
bus.start();
process.stdin.on('data', () => bus.close(() => {{ console.log('closed'); process.exit(0); }}));
"""


def silent(connection):
    while connection.packet():
        pass


def over_4(otherwise):
    return lambda connection: good(connection) if connection.version == 4 else otherwise(connection)


def refuses_with(*body):
    def refuse(connection):
        connection.send(CONNACK, bytes(body))
        silent(connection)
    return refuse


class Brokers(unittest.TestCase):
    def start(self, *brokers, password="secret"):
        for broker in brokers:
            self.addCleanup(broker.close)
        file = BUILD / "node-red" / "bus_of_a_test.cjs"
        file.write_text(PROGRAM)
        program = subprocess.Popen(["node", file, ",".join(f"127.0.0.1:{broker.port}" for broker in brokers), password], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True)
        self.addCleanup(lambda: (program.kill(), program.communicate()))
        return program

    def until(self, program, word):
        lines, patience = [], threading.Timer(30, program.kill)
        patience.start()
        for line in program.stdout:
            lines.append(line)
            if line.startswith(word):
                patience.cancel()
                return line
        self.fail(f"it ended: {''.join(lines)}")

    def end(self, program):
        self.assertIn("closed", program.communicate("x", timeout=5)[0])
        self.assertEqual(program.returncode, 0)

    def test_each_way_in_which_a_broker_knows_no_mqtt_5(self):
        for name, script, versions in (("closes", lambda connection: None, [5, 5, 4]), ("silent", silent, [5, 4]), ("code of 5", refuses_with(0, 132, 0), [5, 4]),
                                       ("code of 3.1.1", refuses_with(0, 1), [5, 4]), ("another code of 3.1.1", refuses_with(0, 2), [5, 4])):
            with self.subTest(name):
                broker = ScriptedBroker(over_4(script))
                program = self.start(broker)
                self.until(program, "connected")
                self.assertEqual((broker.versions, broker.faults), (versions, []))
                self.end(program)

    def test_refused_password_has_a_hint(self):
        for name, body, password, hint in (("of 5", (0, 134, 0), "secret ", "the password ends with a blank"), ("not authorised", (0, 135, 0), "secret\n", "the password has a line end"),
                                           ("of 3.1.1", (0, 4), "\ufffdl", "the password is no UTF-8: was it written as Latin-1?"), ("of 3.1.1, not authorised", (0, 5), " secret", "the password begins with a blank")):
            with self.subTest(name):
                broker = ScriptedBroker(refuses_with(*body))
                program = self.start(broker, password=password)
                self.assertRegex(self.until(program, "disconnected"), re.escape(f"({hint})"))
                self.end(program)

    def test_next_broker_of_the_list_serves_where_one_is_silent_or_gone(self):
        mute, closed, serves = ScriptedBroker(silent), ScriptedBroker(lambda connection: None), ScriptedBroker(good)
        self.end_after_connected(mute, closed, serves)
        self.assertEqual((mute.versions, serves.versions), ([5], [5]))

    def end_after_connected(self, *brokers):
        program = self.start(*brokers)
        self.until(program, "connected")
        self.end(program)

    def test_damaged_packets_count_as_a_lost_connection(self):
        hello = b"\x00\x04asip"
        for name, kind, body, flags in (("publish without a topic", PUBLISH, b"", 0), ("topic longer than the packet", PUBLISH, b"\xff\xffx", 0),
                                        ("properties of no kind", PUBLISH, hello + b"\x02\xff\xff{}", 0), ("packet of no kind", 0, b"xx", 0), ("suback of nothing", 9, b"", 0),
                                        ("connack again", CONNACK, b"\xff", 0), ("topic that is no text", PUBLISH, b"\x00\x02\xff\xfe\x00{}", 0)):
            def damaged(connection):
                connection.accept()
                connection.send(kind, body, flags)
                connection.serve()
            with self.subTest(name):
                broker = ScriptedBroker(damaged, good)
                self.end_after_connected(broker)

    def test_flow_ends_at_each_moment_of_a_connection(self):
        for name, script in (("before an answer", silent), ("accepted, nothing served", lambda connection: (connection.accept(), silent(connection))), ("served", good),
                             ("closed", lambda connection: None)):
            with self.subTest(name):
                broker = ScriptedBroker(script)
                program = self.start(broker)
                eventually(lambda: broker.versions, "the connection")
                self.end(program)
        broker = ScriptedBroker(good)
        broker.close()
        self.end(self.start(broker))


if __name__ == "__main__":
    unittest.main()
