# SPDX-License-Identifier: Apache-2.0
"""A broker that is found: in a network of its own, with the responder Avahi and a real Mosquitto. What runs there ends with the
first process of its namespace."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
NETWORK = r"""
set -e
ip link set lo up multicast on
ip address add 10.9.8.1/24 dev lo
ip route add 224.0.0.0/4 dev lo
mount -t tmpfs none /etc/avahi/services
mount -t tmpfs none /run
printf '[server]\nhost-name=pi\nuse-ipv6=no\nenable-dbus=no\n[publish]\npublish-workstation=no\n' >$dir/avahi.conf
wait_for() { for _ in $(seq 200); do grep -q "$1" "$2" && return; sleep 0.05; done; cat "$2" >&2; exit 1; }
announce() {
    printf '<?xml version="1.0"?><!DOCTYPE service-group SYSTEM "avahi-service.dtd"><service-group><name>%s</name><service><type>_mqtt._tcp</type><port>%s</port></service></service-group>' \
        "$1" "$2" >"/etc/avahi/services/$2.service"
}
broker() { printf 'listener %s %s\nallow_anonymous true\n' "$2" "$1" >$dir/$2.conf; mosquitto -c $dir/$2.conf >$dir/$2.log 2>&1 & wait_for running $dir/$2.log; }
responder() { avahi-daemon -f $dir/avahi.conf --no-drop-root --no-chroot --no-rlimits --no-proc-title >$dir/avahi.log 2>&1 & wait_for 'successfully established' $dir/avahi.log; }
connect() { "$python" -c "import asip; print(asip.connect($1))" || true; }
"""


class Found(unittest.TestCase):
    def in_a_network(self, script):
        with tempfile.TemporaryDirectory() as folder:
            environment = {**{name: value for name, value in os.environ.items() if not name.startswith("ASIP_")}, "dir": folder, "HOME": folder,
                           "python": sys.executable, "PYTHONPATH": str(HERE.parent), "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}
            environment.pop("XDG_CONFIG_HOME", None)
            return subprocess.run(["unshare", "--net", "--mount", "--pid", "--fork", "--mount-proc", "--kill-child", "bash", "-c", NETWORK + script],
                                  env=environment, capture_output=True, text=True, timeout=100)

    def setUp(self):
        possible = self.in_a_network("exit 0")
        if possible.returncode != 0:
            self.skipTest(f"no network of our own can be made here (root may): {possible.stderr}")

    def test_the_one_that_is_announced_is_used_and_named(self):
        done = self.in_a_network("announce 'Broker of the lab' 1899; broker 10.9.8.1 1899; responder; connect")
        self.assertEqual(done.stdout, "<asip bus 10.9.8.1:1899: connected>\n", done.stderr)
        self.assertIn("using mqtt://10.9.8.1:1899 (Broker of the lab), which is announced on this network", done.stderr)

    def test_of_several_none_is_taken(self):
        done = self.in_a_network("announce One 1899; announce Two 1900; responder; connect")
        self.assertIn("several brokers are announced on this network: mqtt://10.9.8.1:1899 (One), mqtt://10.9.8.1:1900 (Two); choose one", done.stderr)
        self.assertIn("Disconnected", done.stderr)

    def test_what_says_where_or_wants_none_searches_nothing(self):
        done = self.in_a_network("announce 'Broker of the lab' 1899; broker 10.9.8.1 1899; responder\n"
                                 "ASIP_NO_MDNS=true connect timeout=0.5; connect \"'127.0.0.1', timeout=0.5\"; connect \"user='ann', password='x', timeout=0.5\"\n"
                                 "broker 127.0.0.1 1883; connect")
        self.assertNotIn("is announced on", done.stderr)
        self.assertEqual(done.stderr.count("asip.errors.Disconnected"), 3, done.stderr)
        self.assertEqual(done.stdout, "<asip bus 127.0.0.1:1883: connected>\n")

    def test_without_any_the_error_says_what_was_tried(self):
        done = self.in_a_network("connect timeout=1.5")
        self.assertIn("none is on this machine, and none is announced on this network", done.stderr)


if __name__ == "__main__":
    unittest.main()
