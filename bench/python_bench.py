#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Python package beside what it is compared with: a command beside the C++ library, a stream beside plain paho, the import beside
that of paho, and the lines of the two-board switch.

    bench_python [ROUNDS]    so many rounds of each, 5 when not given; of latencies the best round counts, else the median

Commands go to a simulated board with the real firmware, and to a board that answers at once, where only the programs between count.
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "tests" / "support")]
BIN = pathlib.Path(os.environ["ASIP_BUILD"]) / "bin"
WRITES = 300
VALUES = 20_000

PACKAGE_WRITES = """
import asip, statistics, sys, time
with asip.connect(sys.argv[1], timeout=20) as bus:
    write, samples = bus.board(sys.argv[2], timeout=20).servo.write, []
    for number in range(int(sys.argv[3])):
        began = time.perf_counter()
        write(0, number % 180)
        samples.append((time.perf_counter() - began) * 1000)
print(statistics.median(samples))
"""
PACKAGE_STREAM = """
import asip, sys, time
with asip.connect(sys.argv[1], timeout=20) as bus:
    stream = bus.board("quick", timeout=20).distance.stream(keep=1_000_000)
    print("ready", flush=True)
    count, wanted = 0, int(sys.argv[2])
    next(stream)
    began = time.process_time()
    for value in stream:
        count += 1
        if count == wanted - 1: break
    print(count + 1, time.process_time() - began, flush=True)
"""
PAHO_STREAM = """
import json, sys, threading, time
import paho.mqtt.client as mqtt
extra = {"callback_api_version": mqtt.CallbackAPIVersion.VERSION2} if hasattr(mqtt, "CallbackAPIVersion") else {}
client = mqtt.Client(protocol=mqtt.MQTTv5, **extra)
count, wanted, began, done = 0, int(sys.argv[2]), 0.0, threading.Event()
def on_message(client, userdata, message):
    global count, began
    value = json.loads(message.payload)["distance"]
    count += 1
    if count == 1: began = time.process_time()
    if count == wanted: done.set()
client.on_message = on_message
host, _, port = sys.argv[1].partition(":")
client.connect(host, int(port))
client.subscribe("asip/quick/distance/out")
client.on_subscribe = lambda *_: print("ready", flush=True)
client.loop_start()
done.wait(120)
print(count, time.process_time() - began, flush=True)
"""
IMPORT = "import sys, time; began = time.process_time(); import {}; print(time.process_time() - began)"


# As installed: modules are compiled once, not at each import.
COMPILED = tempfile.TemporaryDirectory()


def python(text, *arguments, **options):
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "PYTHONPYCACHEPREFIX": COMPILED.name}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    return subprocess.Popen([sys.executable, "-c", text, *map(str, arguments)], env=environment, stdout=subprocess.PIPE, text=True, **options)


def output(process):
    text = process.communicate(timeout=300)[0]
    if process.returncode != 0:
        sys.exit(f"a program that is measured ended with status {process.returncode}")
    return text.split()


class QuickBoard:
    """A board `quick` whose agent answers each command at once, and reports what report() is given."""

    def __init__(self, address):
        from asip import _paho, settings
        broker = settings.find(address).brokers[0]
        self.up = threading.Event()
        self.link = _paho.Link(broker, settings.find(address), "bench-quick", True, lambda _: self.up.set(), lambda *_: None, self.asked, lambda *_: None)
        self.link.start()
        self.up.wait(20)
        self.link.subscribe("asip/quick/servo/in", 1)
        services = [{"name": name, "id": id, "model": f"{name}@1"} for name, id in (("servo", "S"), ("distance", "D"))]
        description = {"board": "quick", "session": "1", "seq": 1, "lease": 3600, "services": services, "state": {"is": "online", "age": 0}}
        self.link._client.publish("asip/servicebus/quick/$description", json.dumps(description), 1, True)
        self.link._client.publish("asip/servicebus/quick/$state", "online", 1, True).wait_for_publish(20)

    def asked(self, _topic, payload, _retained, _expiry):
        request = json.loads(payload)
        self.link.publish(request["reply_to"], json.dumps({"id": request["id"], "status": "ok", "proof": "fence"}).encode(), 1, None)

    def close(self):
        self.link.close()


def write_seconds(address, board, rounds):
    """Medians of milliseconds of the best round: of the package and of BlockingBoard, one after the other in turn."""
    package, library = [], []
    for _ in range(rounds):
        package.append(float(output(python(PACKAGE_WRITES, address, board, WRITES))[-1]))
        library.append(float(subprocess.run([BIN / "blocking_write", f"mqtt://{address}/{board}", str(WRITES)], stdout=subprocess.PIPE, text=True,
                                            check=True, timeout=300).stdout.split()[0]))
    return min(package), min(library)


def values_of_a_core(text, address):
    """Values a second of processor time; each of them is counted, none may be lost."""
    reader = python(text, address, VALUES)
    if reader.stdout.readline() != "ready\n":
        sys.exit("a reader did not start")
    time.sleep(0.2)
    host, _, port = address.partition(":")
    publisher = subprocess.Popen(["mosquitto_pub", "-h", host, "-p", port, "-q", "0", "-l", "-t", "asip/quick/distance/out"], stdin=subprocess.PIPE)
    for first in range(0, VALUES, 100):  # about 4,000 a second, so that the broker drops none
        publisher.stdin.write(b"".join(b'{"distance":[%d,0]}\n' % number for number in range(first, first + 100)))
        publisher.stdin.flush()
        time.sleep(0.025)
    publisher.stdin.close()
    count, seconds = output(reader)
    publisher.wait()
    if int(count) != VALUES:
        sys.exit(f"{VALUES - int(count)} values were lost")
    return VALUES / float(seconds)


def import_seconds(module):
    return float(output(python(IMPORT.format(module)))[0])


def lines_of(path):
    return sum(1 for line in (ROOT / path).read_text().splitlines() if line.strip() and not line.lstrip().startswith("#"))


def row(what, ours, theirs, unit, must, aim):
    ratio = ours / theirs
    verdict = "ok" if ratio <= must else "MISSED"
    print(f"{what:<58} {ours:10.3f} {theirs:10.3f} {unit:<9} ratio {ratio:5.2f}  must {must:4.1f}  aim {aim:4.1f}  {verdict}", flush=True)
    return ratio <= must


def main():
    from bus import Bus
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    good = []
    print(f"{'':<58} {'asip':>10} {'beside it':>10}")
    modules = [(import_seconds("asip"), import_seconds("paho.mqtt.client")) for _ in range(4 * rounds + 1)][1:]
    good.append(row("import asip / import paho.mqtt.client", statistics.median(one for one, _ in modules) * 1000,
                    statistics.median(other for _, other in modules) * 1000, "ms CPU", 1.3, 1.2))
    real = Bus()
    quick = None
    try:
        address = f"127.0.0.1:{real.broker_port}"
        good.append(row("servo.write, p50 / BlockingBoard; simulated board", *write_seconds(address, "desk", rounds), "ms", 2, 1.3))
        quick = QuickBoard(address)
        good.append(row("servo.write, p50 / BlockingBoard; answers at once", *write_seconds(address, "quick", rounds), "ms", 2, 1.3))
        pairs = [(values_of_a_core(PACKAGE_STREAM, address), values_of_a_core(PAHO_STREAM, address)) for _ in range(rounds)]
        package, paho = (statistics.median(one) for one in zip(*pairs))
        good.append(row("one value of a stream / plain paho with json", 1e6 / package, 1e6 / paho, "us of CPU", 1.5, 1.2))
    finally:
        if quick is not None:
            quick.close()
        real.close()
    lines = lines_of("examples/two_board_switch.py")
    print(f"two-board switch: {lines} lines, must 8, aim 6; in C++ {lines_of('examples/two_board_switch.cpp')}")
    return 0 if all(good) and lines <= 8 else 1


if __name__ == "__main__":
    sys.exit(main())
