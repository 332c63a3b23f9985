# SPDX-License-Identifier: Apache-2.0
"""Every program beside others whose clocks are right: with a clock a year ahead, a year behind, of 1970 (no battery), and one that
steps while it runs. Boards are listed, commanded and read as always. ASIP_STEPPED_CLOCK is the library that moves a clock."""

import json
import os
import struct
import subprocess
import time
import unittest

import bus as bus_module
from bus import BIN, LAMP, Bus, eventually

YEAR = 366 * 24 * 3600
WRONG = {"a year ahead": YEAR, "a year behind": -YEAR, "1970": None, "steps": 0}


class ClockedBus(Bus):
    """A bus in which one program has a clock of its own."""

    def __init__(self, who, **options):
        self.who = who
        super().__init__(**options)

    def start_all(self):
        self.clock = self.work / "clock"
        self.set_clock(0)
        super().start_all()

    def set_clock(self, seconds):
        # In place: the program has it mapped.
        with open(self.clock, "r+b" if self.clock.exists() else "w+b") as file:
            file.write(struct.pack("=q", seconds))

    def with_clock(self):
        return {"LD_PRELOAD": os.environ["ASIP_STEPPED_CLOCK"], "CLUSTER_CLOCK": str(self.clock)}

    def start(self, name, program, *arguments):
        saved = {}
        if name.startswith(self.who):
            for key, value in self.with_clock().items():
                saved[key] = os.environ.get(key)
                os.environ[key] = value
        try:
            super().start(name, program, *arguments)
        finally:
            for key, value in saved.items():
                os.environ.pop(key) if value is None else os.environ.update({key: value})

    def asipctl(self, *words, clocked=False):
        environment = dict(os.environ, ASIP_BROKER=f"127.0.0.1:{self.broker_port}", XDG_STATE_HOME=str(self.work / "state"))
        if clocked:
            environment.update(self.with_clock())
        return subprocess.run([str(BIN / "asipctl"), *words], env=environment, capture_output=True, text=True, timeout=60)


def seconds_of(offset):
    return int(3600 - time.time()) if offset is None else offset


class Clocks(unittest.TestCase):
    def works(self, bus, clocked=False):
        """What users do, each as with a right clock."""
        listed = bus.asipctl("list", "-o", "json", clocked=clocked)
        self.assertEqual(listed.returncode, 0, listed.stderr)
        boards = {board["board"]: board["state"] for board in map(json.loads, listed.stdout.splitlines())} if not listed.stdout.startswith("[") \
            else {board["board"]: board["state"] for board in json.loads(listed.stdout)}
        self.assertEqual(boards.get("lamp"), "online", listed.stdout)
        for words in (("send", "lamp/io", "mode", "13", "output"), ("send", "lamp/io", "write", "13", "1"), ("ping", "lamp", "-c", "2", "-i", "0"),
                      ("show", "lamp"), ("wait", "lamp", "--timeout", "5s"),
                      ("send", "lamp/io", "ports")):
            done = bus.asipctl(*words, clocked=clocked)
            self.assertEqual(done.returncode, 0, f"{words}: {done.stdout}{done.stderr}")
        self.assertEqual(bus.state("lamp"), "online")
        posted = bus_module.urllib.request.Request(bus.url + "/api/boards/lamp/services/io/commands/write", b"[13,0]",
                                                   {"Content-Type": "application/json"})
        with bus_module.urllib.request.urlopen(posted, timeout=30) as answer:
            self.assertEqual(json.load(answer)["status"], "ok")

    def try_clocks(self, who, restart):
        for what, offset in WRONG.items():
            with self.subTest(f"{who}: {what}"):
                bus = ClockedBus(who, boards=(LAMP,))
                try:
                    if what == "steps":
                        for step in (YEAR, -YEAR, seconds_of(None), 60, 0):
                            bus.set_clock(step)
                            time.sleep(1)
                            self.works(bus)
                    else:
                        bus.set_clock(seconds_of(offset))
                        restart(bus)
                        eventually(lambda: bus.state("lamp") == "online", "online again")
                        time.sleep(3)
                        self.works(bus)
                except BaseException:
                    print(bus.logs())
                    raise
                finally:
                    bus.close()

    def test_agent(self):
        def restart(bus):
            bus.end("agent-lamp")
            bus.start_agent("lamp")
        self.try_clocks("agent", restart)

    def test_registry(self):
        def restart(bus):
            bus.end("registry")
            bus.start("registry", "asip-registry", "--id", "first", "--history", str(bus.work / "history.db"))
            time.sleep(2)
        self.try_clocks("registry", restart)

    def test_gateway(self):
        def restart(bus):
            bus.end("gateway")
            bus.start_gateway()
        self.try_clocks("gateway", restart)

    def test_broker(self):
        def restart(bus):
            bus.end("broker")
            bus.start_broker()
            time.sleep(3)
        self.try_clocks("broker", restart)

    def test_asipctl(self):
        bus = ClockedBus("nobody", boards=(LAMP,))
        try:
            for what, offset in WRONG.items():
                with self.subTest(f"asipctl: {what}"):
                    bus.set_clock(seconds_of(offset))
                    self.works(bus, clocked=True)
        finally:
            bus.close()


if __name__ == "__main__":
    unittest.main()
