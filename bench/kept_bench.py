#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the keeping of values costs the users of a gateway: delays of a GET, a stop, a command and a stream while a registry keeps 2,000
changes a second, over the same while it keeps none. The changes are on the bus in both cases.

    bench_kept [ROUNDS]    5 pairs when not given; a pair is two parts of ten seconds, one with and one without
"""

import collections
import http.client
import json
import pathlib
import statistics
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests" / "support"))
from bus import DESK, Bus, eventually, paho_client, settings_file  # noqa: E402

BOARDS, PROPERTIES, RATE = 40, 10, 5  # numbers a second of each property
SECONDS = 10
WAIT = 0.01  # between two questions


class Changing(threading.Thread):
    """Boards whose numbers change all the time. The first number of each board is the time at which it was sent."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.client = paho_client()
        self.client.connect("127.0.0.1", port)
        self.client.loop_start()
        self.ended = False
        self.seq = 1
        each = {"service": "n", "kind": "number", "type": "number", "access": "read", "read": "/n"}
        properties = [{"id": f"n/{i}", "name": f"n{i}", **each} for i in range(PROPERTIES)]
        for board in range(BOARDS):
            self.publish(board, "servicebus/{}/$description", services=[{"name": "n", "id": "N"}], lease=3600)
            self.client.publish(f"asip/servicebus/many{board}/$state", "online", 1, True)
            self.publish(board, "servicebus/{}/$properties", version=1, properties=properties)

    def publish(self, board, topic, **members):
        name = f"many{board}"
        document = {"board": name, "session": "5f3a9c01", "seq": self.seq, **members}
        self.client.publish("asip/" + topic.format(name), json.dumps(document), 1, True)

    def run(self):
        begun = time.monotonic()
        while not self.ended:
            self.seq += 1
            board = self.seq % BOARDS
            now = time.monotonic()
            values = {f"n/{i}": {"value": now if i == 0 else self.seq + i, "how": "reported", "age": 0} for i in range(PROPERTIES)}
            self.publish(board, "{}/$values", version=1, clock=f"1-{int(now * 1000)}", values=values)
            time.sleep(max(0, begun + self.seq / BOARDS / RATE - time.monotonic()))


class Stream(threading.Thread):
    """Follows a board that changes; keeps the delay of each value."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.delays = collections.deque()
        connection = http.client.HTTPConnection("127.0.0.1", port)
        connection.request("GET", "/api/boards/many0/values/stream?max_hz=1000")
        self.answer = connection.getresponse()

    def run(self):
        for line in self.answer:
            if line.startswith(b"data:"):
                sent = json.loads(line[5:]).get("values", {}).get("n/0", {}).get("value")
                if sent:
                    self.delays.append(time.monotonic() - sent)


class Ask:
    QUESTIONS = {"GET of a board": ("GET", "/api/boards/many1/properties", None), "stop": ("POST", "/api/boards/desk/stop?once=true", "{}"),
                 "command": ("POST", "/api/boards/desk/services/io/commands/write", "[13,1]")}

    def __init__(self, port):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)

    def part(self):
        """The delays of each question, asked in turn."""
        delays = {what: [] for what in self.QUESTIONS}
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            for what, (method, path, body) in self.QUESTIONS.items():
                begun = time.monotonic()
                self.connection.request(method, path, body, {"Content-Type": "application/json"})
                answer = self.connection.getresponse()
                answer.read()
                if answer.status != 200:
                    sys.exit(f"bench_kept: {what}: status {answer.status}")
                delays[what].append(time.monotonic() - begun)
                time.sleep(WAIT)
        return delays


class Kept(Bus):
    def registry(self, values):
        if "registry" in self.programs:
            self.end("registry")
        self.start("registry", "asip-registry", "--id", "first", "--history", str(self.work / "history.db"), "--config",
                   settings_file(f"values = {values}\n"))
        eventually(lambda: self.get("/api/boards?limit=1"), "the registry", 60)
        if values != "none":
            eventually(self.kept, "values that are kept", 60)
        time.sleep(2)

    def kept(self):
        asked = self.get("/api/boards/many1/values/kept?property=n/1&points=100")
        return [each for each in asked["items"] if each[1] is not None]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    bus = Kept(boards=(DESK,))
    try:
        changing = Changing(bus.broker_port)
        changing.start()
        eventually(lambda: bus.get("/api/boards/many0/values")["values"], "the values of a board that changes", 60)
        stream, ask = Stream(bus.http_port), Ask(bus.http_port)
        stream.start()
        medians = collections.defaultdict(lambda: {"none": [], "*/*": []})
        for _ in range(rounds):
            for values in ("none", "*/*"):
                bus.registry(values)
                stream.delays.clear()
                delays = ask.part() | {"value to a stream": list(stream.delays)}
                for what, each in delays.items():
                    medians[what][values].append(statistics.median(each))
        changing.ended = True
        print(f"p50 while a registry keeps {BOARDS * PROPERTIES * RATE} changes a second, over the same while it keeps none")
        for what, each in medians.items():
            without, beside = statistics.median(each["none"]), statistics.median(each["*/*"])
            print(f"  {what:<40} {beside / without:>10.2f} x  must     1.05  aim     1.00")
            print(f"    {beside * 1000:.3f} ms and {without * 1000:.3f} ms, medians of {rounds}")
    finally:
        bus.close()


if __name__ == "__main__":
    main()
