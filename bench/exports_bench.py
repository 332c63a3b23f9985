#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the exports of a gateway cost: the time until a value is in each dialect, a start beside many boards, memory, and messages of
a pin that changes all the time.

    bench_exports [BOARDS]    1000 when not given, each with five services

A start ends when all is retained that will be. Beside it `mosquitto_pub -l` sends as many bytes in as many retained messages to the
same broker. A value is timed from a scripted board, through its agent, to its own topic and to that of the dialect, at one client.
"""

import contextlib
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests" / "support"))
from bus import Bus, paho_client  # noqa: E402
from scripted_board import ScriptedBoard  # noqa: E402

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
            subprocess.run(["mosquitto_pub", "-p", str(bus.broker_port), "-t", "beside/x", "-q", "1", "-r", "-l"], stdin=lines, check=True)
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


SHOWN = {"--home-assistant": "asip/export/ha/desk/", "--homie": "homie/5/desk/", "--wot-mqtt": "asip/export/wot/desk/"}


class BoardAndExports(contextlib.AbstractContextManager):
    """A scripted board, its agent, a gateway with all exports, and one client that hears all of them."""

    def __init__(self, own, service, entity, *options):
        self.own = own
        self.shown = {option: begin + (f"{service}/" if option == "--homie" else "") + entity for option, begin in SHOWN.items()}
        self.bus = Exporting(boards=())
        self.board = ScriptedBoard()
        self.listener = Listener(self.bus.broker_port, own, *self.shown.values(), "asip/servicebus/desk/$state")
        self.bus.start("agent", "asip-agent", "--tcp", f"127.0.0.1:{self.board.port}", "--name", "desk",
                       "--state-dir", str(self.bus.work / "agent"))
        self.bus.start_gateway(*DIALECTS, *options)
        time.sleep(8)

    def __exit__(self, *_):
        self.listener.close()
        self.board.close()
        self.bus.close()


def latency():
    print("from a board to its own topic and to that of each dialect, over its own: p50 of 300 values, 20 a second")
    with BoardAndExports("asip/desk/distance/out", "distance", "distance-0", "--export-hz", "100") as all_of_it:
        said = {}
        for i in range(1000, 1300):
            said[i] = all_of_it.board.say(f"@D,e,1,{{{i}}}")
            time.sleep(0.05)
        time.sleep(1)
        took = {topic: [] for topic in (all_of_it.own, *all_of_it.shown.values())}
        for topic, payload, at in all_of_it.listener.messages:
            if topic not in took:
                continue
            number = json.loads(payload)["distance"][0] if topic == all_of_it.own else int(float(payload))
            if number in said:
                took[topic].append((at - said[number]) * 1e3)
        own = statistics.median(took[all_of_it.own])
        print(f"  {'its own topic':<40} {own:>10.3f} ms")
        for option, topic in all_of_it.shown.items():
            p50 = statistics.median(took[topic])
            wanted = "  must     1.30  aim     1.10" if option == "--home-assistant" else ""
            print(f"  {option:<40} {p50 / own:>10.2f} x{wanted}")
            print(f"    {p50:.3f} ms, p99 {sorted(took[topic])[int(len(took[topic]) * 0.99)]:.3f} ms, {len(took[topic])} of {len(said)} values", flush=True)


def square_wave(seconds=20):
    print(f"square wave of 1 kHz on a pin for {seconds} s: messages a second, and whether the newest value is last")
    with BoardAndExports("asip/desk/io/out", "io", "pin-0") as all_of_it:
        start = time.monotonic()
        level = 0
        for i in range(seconds * 1000):
            level = 1 - level
            all_of_it.board.say(f"@I,d,4,{level:x}")
            time.sleep(max(0, start + (i + 1) / 1000 - time.monotonic()))
        end = time.monotonic()
        all_of_it.board.say("@I,d,4,0")
        all_of_it.board.say("@I,d,4,1")  # the newest
        time.sleep(2)
        heard, last = {}, {}
        for topic, payload, at in all_of_it.listener.messages:
            last[topic] = payload.decode()
            heard[topic] = heard.get(topic, 0) + (start <= at <= end)
        print(f"    {heard.get(all_of_it.own, 0) / (end - start):.0f} a second on its own topic")
        for option, topic in all_of_it.shown.items():
            newest = last.get(topic) in ("ON", "true")
            print(f"  {option:<40} {heard.get(topic, 0) / (end - start):>10.2f} /s must     5.00  newest last: {'yes' if newest else 'no'}", flush=True)


def main():
    boards = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    latency()
    start(boards)
    memory(boards)
    square_wave()


if __name__ == "__main__":
    main()
