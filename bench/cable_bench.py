# SPDX-License-Identifier: Apache-2.0
"""What it costs that a board is in the computer of a browser, beside a board at a serial port of this machine: real Chromium and page,
gateway, agents, broker and firmware. Only the port is a test's (tests/cable): its own way to the board and back is measured and taken off.

    bench_cable [ROUNDS]    commands of each measurement; 200 when not given
"""

import itertools
import json
import os
import pathlib
import select
import statistics
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "tests" / folder) for folder in ("browser", "cable", "support")]

from lending_test import EYE, SERVICES, LendingBus  # noqa: E402
from lent_board import Port  # noqa: E402
from paho.mqtt.packettypes import PacketTypes  # noqa: E402
from paho.mqtt.properties import Properties  # noqa: E402
from port_server import PortServer  # noqa: E402
from rig import Browser, eventually, paho_client  # noqa: E402

SECONDS = 20  # of reports of ten boards
DEMAND_ENDS = 20  # seconds after the last reader: by then a service reports at its own period again
LENT = "lent-loopback"

# From a request to its answer at the port of the third board, in ms each.
WAY = """
const [baudRate, rounds, done] = arguments;
(async () => {
  window.next_port = "three";
  const port = await navigator.serial.requestPort();
  await port.open({ baudRate });
  const writer = port.writable.getWriter(), reader = port.readable.getReader(), all = [];
  for (let i = 0; i < rounds; ++i) {
    const began = performance.now();
    await writer.write(new TextEncoder().encode(`I,d,13,${i % 2}\\n#,E,p${i}\\n`));
    for (let text = ""; !text.includes(`@#,E,p${i}\\n`);) text += new TextDecoder().decode((await reader.read()).value);
    all.push(performance.now() - began);
  }
  reader.releaseLock();
  writer.releaseLock();
  await port.close();
  done(all);
})().catch((problem) => done(String(problem)));
"""


class ThirdBoard:
    """Nobody's: what the test's port takes beside one that this program opens."""

    def __init__(self, rig, baud):
        self.rig = rig
        self.baud = baud
        self.port = Port(str(rig.bus.work / "three.port"))
        self.through_page, self.direct = [], []
        self.port.open(57600)
        self.ms("I,A,0\nI,P,13,3\n#,E,a\n", "@#,E,a\n")
        if baud != 57600:
            self.ms(f"#,B,{baud}\n", f"@#,B,{baud}\n")
            self.port.close()
            self.port.open(baud)
            self.ms("#,E,b\n", "@#,E,b\n")
        self.port.close()

    def ms(self, request, answer):
        text, began = "", time.perf_counter()
        self.port.write(request.encode())
        while answer not in text:
            if not select.select([self.port.fd], [], [], 30)[0]:
                raise AssertionError(f"no answer to {request}: {text}")
            text += os.read(self.port.fd, 4096).decode()
        return (time.perf_counter() - began) * 1000

    def measure(self, rounds):
        self.port.open(self.baud)
        self.direct += [self.ms(f"I,d,13,{at % 2}\n#,E,d{at}\n", f"@#,E,d{at}\n") for at in range(rounds)]
        self.port.close()
        self.through_page += self.rig.browser.driver.execute_async_script(WAY, self.baud, rounds)

    def way(self):
        return statistics.median(self.through_page) - statistics.median(self.direct)


def row(measure, value, must, aim):
    wanted = "".join(f"  {name} {bound:>9}" for name, bound in (("must", must), ("aim", aim)) if bound)
    print(f"{measure:<76} {value:>12}{wanted}", flush=True)


def processor_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Commands:
    """Sends a command to a board, and waits for its answer."""

    def __init__(self, bus):
        self.client = paho_client(protocol=5)
        self.client.on_message = self.on_message
        self.client.connect("127.0.0.1", bus.broker_port)
        self.client.subscribe("bench/answers")
        self.client.loop_start()
        self.answered = threading.Event()
        self.ids = itertools.count()
        self.good = False
        self.failed = 0

    def on_message(self, _client, _data, message):
        self.good = json.loads(message.payload)["status"] == "ok"
        self.answered.set()

    def ms(self, board, line):
        where = Properties(PacketTypes.PUBLISH)
        where.ResponseTopic = "bench/answers"
        where.CorrelationData = str(next(self.ids)).encode()
        self.answered.clear()
        began = time.perf_counter()
        self.client.publish(f"asip/{board}/in", line, properties=where)
        assert self.answered.wait(30), f"{board} does not answer {line}"
        self.failed += not self.good
        return (time.perf_counter() - began) * 1000

    def close(self):
        self.client.disconnect()
        self.client.loop_stop()


class Rig:
    """A board that Chromium lends, and one at a serial port of this machine."""

    def __init__(self, *options):
        class Lending(LendingBus):
            agent_options = options

        boards = [{"name": name, "image": SERVICES, "parts": [EYE]} for name in ("one", "two", "three")]
        self.bus = Lending(boards)
        self.ports = PortServer(self.bus.work)
        self.browser = Browser()
        driver = self.browser.driver
        driver.execute_cdp_cmd("Page.enable", {})
        driver.execute_cdp_cmd("Page.setBypassCSP", {"enabled": True})
        driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": self.ports.script})
        self.bus.start("serial", "asip-agent", "--serial", str(self.bus.work / "two.port"), "--name", "serial", *options)
        driver.get(f"{self.bus.url}/#/add")
        self.browser.button("Connect the board in this computer", "asip-lend")
        self.browser.run("window.next_port = 'one'")
        self.began = time.monotonic()
        self.browser.button("Connect the board in this computer", "asip-lend").click()

    def value_is_seen(self):
        """Seconds from the click to the value of the board on its page."""
        eventually(lambda: f"On the bus: {LENT}" in " ".join(self.browser.text("asip-lend").split()), "it is on the bus", 60)
        self.browser.find("asip-lend li a")[0].click()
        while "42" not in self.browser.text(".values-box"):
            assert time.monotonic() < self.began + 60
            time.sleep(0.01)
        return time.monotonic() - self.began

    def close(self):
        self.browser.close()
        self.ports.close()
        self.bus.close()


def answers(rig, rounds, baud):
    """p50 in ms: over the cable, over the serial port, and of the test's port alone."""
    commands = Commands(rig.bus)
    boards = {LENT: [], "serial": []}
    for board in boards:
        rig.bus.online(board)
        for setup in ("I,A,0", "I,P,13,3"):
            commands.ms(board, setup)
    rig.browser.run("location.hash = '#/add'")  # whose page asks for no reports
    time.sleep(DEMAND_ENDS)
    third = ThirdBoard(rig, baud)
    for at in range(rounds):
        if at % 50 == 0:
            third.measure(50)
        for board, samples in boards.items():
            samples.append(commands.ms(board, f"I,d,13,{at % 2}"))
            time.sleep(0.003 + at % 7 / 3000)
    commands.close()
    if commands.failed:
        print(f"{commands.failed} of {2 * rounds} commands failed")
    return *(statistics.median(each) for each in boards.values()), third.way()


def one_cable(rounds):
    for text, baud, options, must, aim in (("at 57600", 57600, ("--no-step-up",), 1.5, 1.2), ("line stepped up", 1_000_000, (), 3, 1)):
        rig = Rig(*options)
        try:
            seen = rig.value_is_seen()
            cable, serial, way = answers(rig, rounds, baud)
            print(f"command to answer, {text}, p50:\n  cable {cable:.2f} ms, of which the test's port {way:.2f} ms; serial port {serial:.2f} ms")
            if options:
                row("  cable without the test's port, over the serial port", f"{(cable - way) / serial:.2f} x", must, aim)
            else:
                row("  cable without the test's port, beyond the serial port", f"{cable - way - serial:.2f} ms", must, aim)
                row("board plugged in until its value is on the page", f"{seen:.1f} s", "5 s", "3 s")
        finally:
            rig.close()


def ten_cables():
    bus = LendingBus([{"name": f"b{number}", "image": SERVICES, "parts": [EYE]} for number in range(10)])
    try:
        lent = [bus.lend(f"b{number}") for number in range(10)]
        for each in lent:
            eventually(lambda each=each: each.name, "its name", 60)
            bus.online(each.name)
        commands = Commands(bus)
        heard = []
        commands.client.message_callback_add("asip/+/io/out", lambda *_: heard.append(1))
        for each in lent:
            commands.ms(each.name, "I,A,50")
        commands.client.subscribe("asip/+/io/out")
        time.sleep(2)
        pid = bus.programs["gateway"].pid
        begun, used, before = time.monotonic(), processor_seconds(pid), len(heard)
        time.sleep(SECONDS)
        passed = time.monotonic() - begun
        share, reports = (processor_seconds(pid) - used) / passed, (len(heard) - before) / passed / 10
        row(f"ten cables with {reports:.0f} reports a second each: processor of the gateway", f"{share * 100:.1f} % core", 10, 5)
        commands.close()
        for each in lent:
            each.close()
    finally:
        bus.close()


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    row("", "measured", "must", "aim")
    one_cable(rounds)
    ten_cables()


if __name__ == "__main__":
    main()
