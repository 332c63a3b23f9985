#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the exports of a gateway cost: a start beside many boards, memory, and the time until a value is in each dialect.

    bench_exports [BOARDS]    1000 when not given, each with five services

A start ends when all is retained that will be. Beside it `mosquitto_pub -l` sends the same messages to the same broker, one after the
other. A value is timed from its own topic to that of the dialect, at the same client.
"""

import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests" / "support"))
from bus import Bus, paho_client  # noqa: E402

SERVICES = (("io", "I"), ("distance", "D"), ("servo", "S"), ("bump", "B"), ("motors", "M"))
DIALECTS = {"--home-assistant": ("homeassistant", "asip/export/ha"), "--homie": ("homie",), "--wot-mqtt": ("asip/export/wot",)}
ROUNDS = 5
QUIET = 3  # seconds without a message: all is out


class Listener:
    def __init__(self, port, *filters):
        self.messages, self.first, self.last = [], None, time.monotonic()
        self.client = paho_client()
        self.client.on_message = self.heard
        self.client.connect("127.0.0.1", port)
        for each in filters:
            self.client.subscribe(each)
        self.client.loop_start()

    def heard(self, _client, _data, message):
        self.last = time.monotonic()
        if not message.topic.endswith("$lease") and "/$mark/" not in message.topic:
            self.first = self.first or self.last
            self.messages.append((message.topic, message.payload, self.last))

    def settle(self):
        """Seconds from the first message to the last one before it is quiet."""
        while self.first is None or time.monotonic() - self.messages[-1][2] < QUIET:
            time.sleep(0.1)
        return self.messages[-1][2] - self.first

    def close(self):
        self.client.disconnect()
        self.client.loop_stop()


class Exporting(Bus):
    """A bus with announced boards, and no gateway yet."""

    def start_gateway(self, *more):
        if more:
            self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", *more)

    def announce(self, count):
        client = paho_client()
        client.max_queued_messages_set(0)
        client.max_inflight_messages_set(1000)
        client.connect("127.0.0.1", self.broker_port)
        client.loop_start()
        services = [{"name": name, "id": letter, "model": f"{name}@1", "count": 2} for name, letter in SERVICES]
        for i in range(count):
            document = {"board": f"board{i}", "session": "5f3a9c01", "seq": 1, "lease": 3600, "firmware": {"chip": "ATmega328P"},
                        "services": services}
            client.publish(f"asip/servicebus/board{i}/$description", json.dumps(document), qos=1, retain=True)
            last = client.publish(f"asip/servicebus/board{i}/$state", "online", qos=1, retain=True)
        last.wait_for_publish(60)
        client.disconnect()
        client.loop_stop()


def resident(process):
    """Of memory that is its own, in bytes."""
    for line in pathlib.Path(f"/proc/{process.pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss:"):
            return int(line.split()[1]) * 1024
    return 0


def published(bus, messages):
    """Seconds in which mosquitto_pub sends payloads of the same lengths, until a listener has them all."""
    listener = Listener(bus.broker_port, "beside/#")
    with tempfile.NamedTemporaryFile("wb") as file:
        for _, payload, _ in messages:
            file.write(b"x" * max(len(payload), 1) + b"\n")
        file.flush()
        with open(file.name, "rb") as lines:
            subprocess.run(["mosquitto_pub", "-p", str(bus.broker_port), "-t", "beside/x", "-q", "1", "-l"], stdin=lines, check=True)
    took = listener.settle()
    listener.close()
    return took


def one_start(boards, option, topics):
    """Seconds of a start, seconds of mosquitto_pub, and what was sent."""
    bus = Exporting(boards=())
    try:
        bus.announce(boards)
        listener = Listener(bus.broker_port, *(topic + "/#" for topic in topics))
        bus.start_gateway(option)
        took = listener.settle()
        listener.close()
        return took, published(bus, listener.messages), listener.messages
    finally:
        bus.close()


def start(boards):
    print(f"from the first message of an export to the last beside {boards} boards of {len(SERVICES)} services, over mosquitto_pub's")
    for option, topics in DIALECTS.items():
        rounds = [one_start(boards, option, topics) for _ in range(ROUNDS)]
        took, beside = (statistics.median(each[i] for each in rounds) for i in (0, 1))
        messages = rounds[0][2]
        # The Web of Things has its documents over HTTP: what is sent are states.
        wanted = "" if option == "--wot-mqtt" else "  must     1.50  aim     1.10"
        print(f"  {option:<40} {took / beside:>10.2f} x{wanted}", flush=True)
        size = sum(len(payload) for _, payload, _ in messages)
        print(f"    {len(messages)} messages, {size / 1e6:.2f} MB: {took:.3f} s and {beside:.3f} s, medians of {ROUNDS}")


def memory(boards):
    sizes = []
    for options in (("--no-page",), tuple(DIALECTS)):
        bus = Exporting(boards=())
        try:
            bus.announce(boards)
            listener = Listener(bus.broker_port, "#")
            bus.start_gateway(*options)
            listener.settle()
            time.sleep(5)
            listener.close()
            sizes.append(resident(bus.programs["gateway"]))
        finally:
            bus.close()
    print(f"memory of a gateway with all exports, {boards} boards  {sizes[1] / 1e6:>10.1f} MB  must       60  aim       30", flush=True)
    print(f"  without exports {sizes[0] / 1e6:.1f} MB")


def values():
    print("from the topic of a value to that of a dialect, ms: p50, p99 of 300 values, 20 a second")
    bus = Exporting(boards=())
    try:
        bus.announce(1)
        own = "asip/board0/distance/out"
        shown = {"--home-assistant": "asip/export/ha/board0/distance-0", "--homie": "homie/5/board0/distance/distance-0",
                 "--wot-mqtt": "asip/export/wot/board0/distance-0"}
        listener = Listener(bus.broker_port, own, *shown.values())
        bus.start_gateway(*DIALECTS, "--export-hz", "100")
        sender = paho_client()
        sender.connect("127.0.0.1", bus.broker_port)
        sender.loop_start()
        time.sleep(8)
        for i in range(300):
            sender.publish(own, json.dumps({"distance": {"0": i}}))
            time.sleep(0.05)
        time.sleep(1)
        sender.disconnect()
        sender.loop_stop()
        listener.close()
        seen = {topic: {} for topic in (own, *shown.values())}
        for topic, payload, at in listener.messages:
            number = json.loads(payload)
            seen[topic][number["distance"]["0"] if topic == own else number] = at
        for option, topic in shown.items():
            times = sorted((seen[topic][i] - seen[own][i]) * 1e3 for i in range(300) if i in seen[topic] and i in seen[own])
            print(f"{option:<18} {statistics.median(times):>8.2f} {times[int(len(times) * 0.99)]:>8.2f}    of {len(times)}", flush=True)
    finally:
        bus.close()


def main():
    boards = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    start(boards)
    memory(boards)
    values()


if __name__ == "__main__":
    main()
