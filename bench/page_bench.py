"""What the web page costs a browser: a bus of ten thousand boards, and a plot that moves all the time.

    bench_page [SECONDS]    of the plot; 60 when not given
"""

import os
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests" / "browser"))

from rig import Browser, Bus, eventually, publish_boards  # noqa: E402

BOARDS = 10_000
POINTS = 3600

PLOT = """
const [points, seconds, done] = arguments;
(async () => {
  const { Series } = await import('/core/series.js');
  await import('/ui/plot.js');
  const series = new Series(points, 1e12);
  const numbers = (time) => [{ key: 'a', name: 'a', unit: 'cm', value: 100 * Math.sin(time / 700) + 5 * Math.random() }];
  const now = Date.now();
  for (let i = points; i > 0; --i) series.add(now - i * 1000 / 60, numbers(now - i * 1000 / 60));
  const plot = document.createElement('asip-plot').begin(series, 'benchmark', 'benchmark');
  document.querySelector('main').replaceChildren(plot);
  let frames = 0;
  const end = performance.now() + seconds * 1000;
  const step = () => {
    ++frames;
    series.add(Date.now(), numbers(Date.now()));
    if (performance.now() < end) requestAnimationFrame(step);
    else done(frames / seconds);
  };
  requestAnimationFrame(step);
})();
"""


def row(measure, value, must, aim):
    print(f"{measure:<58} {value:>12} {must:>12} {aim:>12}")


def processor_seconds(pid):
    """Of a process and all below it."""
    total = 0.0
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
            return sum(times[each][1] for each in below if each in times)
        below |= more


times = {}


def heap(browser):
    browser.driver.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
    return browser.run("return performance.memory.usedJSHeapSize") / 1e6


def many_boards(bus, browser):
    publish_boards(bus, BOARDS)
    began = time.monotonic()
    browser.driver.get(f"{bus.url}/#/")
    eventually(lambda: f"{BOARDS:,} boards" in browser.text(".found"), "the table", 60)
    complete = time.monotonic() - began
    paint = browser.run("return performance.getEntriesByName('first-contentful-paint')[0].startTime")
    row(f"{BOARDS:,} boards: first paint", f"{paint:.0f} ms", "1500 ms", "500 ms")
    row(f"{BOARDS:,} boards: all of them in the table", f"{complete:.1f} s", "", "")
    row(f"{BOARDS:,} boards: frames a second while scrolling", f"{browser.scroll_rate():.0f}", "30", "60")
    row(f"{BOARDS:,} boards: memory of the page's scripts", f"{heap(browser):.0f} MB", "", "")


def plot(bus, browser, seconds):
    browser.driver.get(f"{bus.url}/#/bus")
    browser.shown("asip-system")
    browser.driver.set_script_timeout(seconds + 60)
    browser.driver.execute_async_script(PLOT, POINTS, 3)
    pid = browser.driver.service.process.pid
    before, used, began = heap(browser), processor_seconds(pid), time.monotonic()
    rate = browser.driver.execute_async_script(PLOT, POINTS, seconds)
    share = (processor_seconds(pid) - used) / (time.monotonic() - began)
    row(f"plot of {POINTS} points, each frame a new one: frames a second", f"{rate:.0f}", "30", "60")
    row("  processor of the whole browser, no graphics card", f"{share * 100:.0f} %", "", "15 %")
    row(f"  growth of its memory in {seconds} s", f"{heap(browser) - before:.2f} MB", "none", "none")


def main():
    seconds = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    bus = Bus(boards=())
    try:
        browser = Browser()
        try:
            row("", "measured", "must", "aim")
            many_boards(bus, browser)
            plot(bus, browser, seconds)
        finally:
            browser.close()
    finally:
        bus.close()


if __name__ == "__main__":
    main()
