# SPDX-License-Identifier: Apache-2.0
"""What the web page costs a browser: a bus of ten thousand boards, and a plot that moves all the time.

    bench_page [SECONDS]    of the plot, and of one that gets the points of eight hours; 60 when not given
"""

import contextlib
import http.server
import json
import os
import pathlib
import signal
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests" / "browser"))

from rig import DESK, Browser, Bus, Trace, eventually, meanwhile, paho_client, publish_boards  # noqa: E402

BOARDS = 10_000
CHANGES = 200  # a second
POINTS = 3600
EIGHT_HOURS = 8 * 3600 * 60  # points

# A plot that is full from its beginning, and gets so many points more with each frame.
PLOT = """
const [points, per_frame, seconds, done] = arguments;
if (!window.plotted) {
  const Series = window.Series;
  const numbers = (time) => [{ key: 'a', name: 'a', unit: 'cm', value: 100 * Math.sin(time / 700) + 5 * Math.random() }];
  const series = new Series(points, 1e12);
  for (let i = points; i > 0; --i) series.add(Date.now() - i * 1000 / 60, numbers(Date.now() - i * 1000 / 60));
  document.querySelector('main').replaceChildren(document.createElement('asip-plot').begin(series, 'benchmark', 'benchmark'));
  window.plotted = { series, numbers };
}
const { series, numbers } = window.plotted;
let frames = 0, added = 0;
const end = performance.now() + seconds * 1000;
const step = () => {
  ++frames;
  const last = series.times.at(-1), now = Date.now();
  for (let i = 1; i <= per_frame; ++i) added += series.add(last + (now - last) * i / per_frame, numbers(now));
  if (performance.now() < end) requestAnimationFrame(step);
  else done([frames / seconds, added]);
};
requestAnimationFrame(step);
"""


def row(measure, value, must, aim):
    wanted = "".join(f"  {name} {bound:>9}" for name, bound in (("must", must), ("aim", aim)) if bound)
    print(f"{measure:<58} {value:>12}{wanted}")


def processes(pid):
    """A process and all below it: {pid: seconds of a processor that it used}."""
    times = {}
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        times[int(stat.parent.name)] = (int(fields[1]), (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"))
    below = {pid}
    while True:
        more = {child for child, (parent, _) in times.items() if parent in below} - below
        if not more:
            return {each: times[each][1] for each in below if each in times}
        below |= more


def processor_seconds(pid):
    return sum(processes(pid).values())


def private_megabytes(pid):
    """Memory that a process and all below it share with no other process."""
    total = 0
    for each in processes(pid):
        try:
            lines = pathlib.Path(f"/proc/{each}/status").read_text().splitlines()
        except OSError:
            continue
        total += sum(int(line.split()[1]) for line in lines if line.startswith("RssAnon:"))
    return total / 1024


def heap(browser):
    browser.driver.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
    return browser.driver.execute_cdp_cmd("Runtime.getHeapUsage", {})["usedSize"] / 1e6


@contextlib.contextmanager
def states_that_change(bus):
    """One board after the other falls asleep meanwhile."""
    client = paho_client()
    client.connect("127.0.0.1", bus.broker_port)
    client.loop_start()

    def say(n):
        client.publish(f"asip/servicebus/board{n * 7 % BOARDS}/$state", "sleeping" if n // BOARDS % 2 == 0 else "online", retain=True)

    with meanwhile(CHANGES, say):
        yield
    client.disconnect()
    client.loop_stop()


def many_boards(bus, browser):
    publish_boards(bus, BOARDS)
    began = time.monotonic()
    browser.driver.get(f"{bus.url}/#/")
    eventually(lambda: f"{BOARDS:,} boards" in browser.text(".found"), "the table", 60)
    complete = time.monotonic() - began
    paint = browser.run("return performance.getEntriesByName('first-contentful-paint')[0].startTime")
    row(f"{BOARDS:,} boards: first paint", f"{paint:.0f} ms", "300 ms", "100 ms")
    row(f"{BOARDS:,} boards: all of them in the table", f"{complete:.1f} s", "", "")
    row(f"{BOARDS:,} boards: frames a second while scrolling", f"{browser.scroll_rate():.0f}", "45", "60")
    with states_that_change(bus):
        row(f"  and {CHANGES} of them a second change their state", f"{browser.scroll_rate():.0f}", "45", "60")
    row(f"{BOARDS:,} boards: memory of the page's scripts", f"{heap(browser):.0f} MB", "", "")


class ToldBus(Bus):
    """Its registry tells losses to a receiver here: `told` has the time of each message."""

    def __init__(self):
        self.told = []
        told = self.told

        class Receiver(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                told.append(time.monotonic())
                self.rfile.read(int(self.headers["Content-Length"]))
                self.send_response(204)
                self.end_headers()

            def log_message(self, *_):
                pass

        self.receiver = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Receiver)
        threading.Thread(target=self.receiver.serve_forever, daemon=True).start()
        super().__init__(boards=())

    def start(self, name, program, *arguments):
        if name == "registry":
            arguments += ("--notify", f"http://127.0.0.1:{self.receiver.server_port}/")
        super().start(name, program, *arguments)

    def close(self):
        super().close()
        self.receiver.shutdown()


def since(began, condition, what):
    """Looked for each 10 ms: until then it took so long."""
    while not condition():
        if time.monotonic() > began + 60:
            raise AssertionError(f"{what}: not within a minute")
        time.sleep(0.01)
    return time.monotonic() - began


def come_and_go(browser):
    """A board is plugged in and pulled out while the table is open."""
    bus = ToldBus()
    try:
        browser.driver.get(f"{bus.url}/#/")
        eventually(lambda: browser.text("asip-link") == "live", "live", 30)
        file = bus.work / "desk.json"
        file.write_text(json.dumps(DESK))
        bus.start("sim", "asip-sim", "--socket", str(bus.work / "sim.sock"), str(file))
        eventually((bus.work / "desk.port").exists, "the port")
        began = time.monotonic()
        bus.start("agent", "asip-agent", "--serial", str(bus.work / "desk.port"), "--name", "desk")
        seen = since(began, lambda: "42" in browser.text(".filler .c-value"), "a value in the table")
        row("board plugged in until its first value is seen", f"{seen:.1f} s", "5 s", "3 s")
        bus.end("agent", signal.SIGKILL)
        since(time.monotonic(), lambda: bus.state("desk") == "lost", "lost in the catalogue")
        began = time.monotonic()
        badge = since(began, lambda: "1 lost" in browser.driver.title, "the badge")
        hook = max(0, since(began, lambda: bool(bus.told), "the webhook") and bus.told[0] - began)
        row("lost in the catalogue until badge of the tab", f"{badge:.2f} s", "1 s", "0.2 s")
        row("lost in the catalogue until the webhook is told", f"{hook:.2f} s", "1 s", "0.7 s")
    finally:
        bus.close()


METER = {"board": "meter", "session": "5f3a9c01", "seq": 1, "lease": 600, "services": [{"name": "pressure", "id": "B", "model": "pressure@1"}]}


def plot(bus, browser, seconds):
    client = paho_client()
    client.connect("127.0.0.1", bus.broker_port)
    client.loop_start()
    client.publish("asip/servicebus/meter/$description", json.dumps(METER), qos=1, retain=True)
    client.publish("asip/servicebus/meter/$state", "online", qos=1, retain=True).wait_for_publish(20)
    browser.driver.get(f"{bus.url}/#/board/meter")

    def plotted():
        client.publish("asip/meter/pressure/out", '{"pressure":{"pressure":1013,"temperature":21,"altitude":90}}').wait_for_publish(20)
        return browser.run("return Boolean(window.Series = document.querySelector('asip-plot')?.series.constructor)")

    eventually(plotted, "a plot, whose points are of the class that is measured", 30)
    client.disconnect()
    client.loop_stop()
    browser.run("location.hash = '#/settings'")
    browser.shown("asip-settings")
    browser.driver.set_script_timeout(seconds + 60)
    browser.driver.execute_async_script(PLOT, POINTS, 1, 3)
    pid = browser.driver.service.process.pid
    used, began = processor_seconds(pid), time.monotonic()
    with Trace(browser.driver) as trace:
        browser.driver.execute_async_script(PLOT, POINTS, 1, seconds)
    share = (processor_seconds(pid) - used) / (time.monotonic() - began)
    row(f"plot of {POINTS} points, each frame a new one: frames a second", f"{trace.frames_per_second():.0f}", "30", "60")
    row("  processor of the whole browser, no graphics card", f"{share * 100:.0f} %", "", "15 %")


def plot_for_long(browser, seconds):
    """As many points as in eight hours, in a short time: what memory is meanwhile."""
    pid = browser.driver.service.process.pid
    heaps, private, points = [], [], 0
    while len(heaps) < 10 or points < EIGHT_HOURS:
        points += browser.driver.execute_async_script(PLOT, POINTS, EIGHT_HOURS // (seconds * 60), seconds / 10)[1]
        heaps.append(heap(browser))
        private.append(private_megabytes(pid))
    hours = points / 60 / 3600
    print(f"meanwhile, of {points:,} points, as 60 a second give in {hours:.1f} hours:")
    print("  heap " + " ".join(f"{each:.2f}" for each in heaps) + " MB")
    print("  all of the browser's own memory " + " ".join(f"{each:.0f}" for each in private) + " MB")
    row("  growth of the heap behind its first fifth", f"{heaps[-1] - heaps[len(heaps) // 5]:.2f} MB", "none", "none")


def main():
    seconds = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    bus = Bus(boards=())
    try:
        browser = Browser()
        try:
            row("", "measured", "must", "aim")
            come_and_go(browser)
            many_boards(bus, browser)
            plot(bus, browser, seconds)
            plot_for_long(browser, seconds)
        finally:
            browser.close()
    finally:
        bus.close()


if __name__ == "__main__":
    main()
