# SPDX-License-Identifier: Apache-2.0
"""Brokers that know MQTT 3.1.1 alone, and brokers of a list: a real paho-mqtt, and TCP ports that do what each test says."""
import socket
import time
import types
import unittest
import unittest.mock

import asip
from asip._paho import Link
from asip.testing import eventually
from scripted_broker import CONNACK, ScriptedBroker, good


def closes_over_5(connection):
    if connection.version == 4:
        good(connection)


def silent_over_5(connection):
    if connection.version == 4:
        good(connection)
    else:
        connection.packet()  # until the client has gone


def refuses_with(*body):
    def refuses(connection):
        if connection.version == 4:
            return good(connection)
        connection.send(CONNACK, bytes(body))
        return connection.packet()
    return refuses


class Denials(unittest.TestCase):
    def test_a_broker_that_gives_no_reason_has_refused_nothing(self):
        """A cluster of RabbitMQ says so of each topic to which a dead node had a subscription."""
        denied = []
        settings = types.SimpleNamespace(user=None, password_bytes=None)
        link = Link(types.SimpleNamespace(tls=False), settings, "test", True, None, None, None, denied.append)
        link._asked = {1: "delivered", 2: "denied"}
        link._published(None, None, 1, 131)
        link._published(None, None, 2, 135)
        self.assertEqual(denied, ["denied"])


class Versions(unittest.TestCase):
    def connect(self, *brokers, timeout=8.0):
        for broker in brokers:
            self.addCleanup(broker.close)
        bus = asip.connect(",".join(f"127.0.0.1:{broker.port}" for broker in brokers), timeout=timeout)
        self.addCleanup(bus.close)
        for broker in brokers:
            self.assertEqual(broker.faults, [])
        return bus

    def test_each_way_in_which_a_broker_knows_no_mqtt_5(self):
        for name, script, versions in (("closes", closes_over_5, [5, 5, 4]), ("silent", silent_over_5, [5, 4]), ("code of 5", refuses_with(0, 132, 0), [5, 4]),
                                       ("code of 3.1.1", refuses_with(0, 1), [5, 4]), ("another code of 3.1.1", refuses_with(0, 2), [5, 4])):
            with self.subTest(name):
                broker = ScriptedBroker(script)
                self.connect(broker, timeout=5.0)  # the default: it must be enough
                self.assertEqual(broker.versions, versions)

    def test_broker_that_took_mqtt_5_and_hangs_is_not_suspected(self):
        broker = ScriptedBroker(lambda connection: (connection.accept(), connection.serve()) if len(broker.versions) == 1 else connection.packet() if len(broker.versions) == 2 else good(connection))
        bus = self.connect(broker)
        next(iter(broker._sockets)).shutdown(socket.SHUT_RDWR)
        eventually(lambda: len(broker.versions) >= 3 and bus.connected, 15)
        self.assertEqual(broker.versions[:3], [5, 5, 5])

    def test_next_broker_of_the_list_serves_where_one_is_silent_or_gone(self):
        mute, closed, serves = ScriptedBroker(lambda connection: connection.packet()), ScriptedBroker(lambda connection: None), ScriptedBroker(good)
        self.assertTrue(self.connect(mute, closed, serves, timeout=12.0).connected)
        self.assertEqual((mute.versions, serves.versions), ([5], [5]))
        self.assertGreaterEqual(len(closed.versions), 2)

    def test_broker_that_closes_everything_is_told_and_not_hammered(self):
        broker = ScriptedBroker(lambda connection: None)
        self.addCleanup(broker.close)
        began = time.monotonic()
        with self.assertRaises(asip.Disconnected) as raised:
            asip.connect(f"127.0.0.1:{broker.port}", timeout=3)
        self.assertIn("ended", str(raised.exception))
        self.assertLess(len(broker.versions), 12)
        self.assertIn(4, broker.versions)
        self.assertLess(time.monotonic() - began, 8)


if __name__ == "__main__":
    unittest.main()
