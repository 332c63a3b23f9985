# SPDX-License-Identifier: Apache-2.0
"""A bus (tests/support/bus.py) and a browser for the tests of the web page."""

import contextlib
import itertools
import json
import pathlib
import shutil
import sys
import tempfile
import threading
import time
import unittest
import urllib.request

import websocket
from selenium import webdriver
from selenium.common.exceptions import StaleElementReferenceException
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import bus  # noqa: E402
from bus import BIN, BUILD, DESK, IMAGES, LAMP, ROOT, Bus, can_connect, commands_heard, die_with_parent, eventually, free_port, paho_client, program_path, publish_boards, settings_file  # noqa: E402,F401

bus.NOT_YET += (StaleElementReferenceException,)  # elements that changed while they were read
SCREENSHOTS = BUILD / "screenshots"

CHROMIUM_OPTIONS = """--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars""".split()


@contextlib.contextmanager
def meanwhile(hertz, work):
    """Calls work(n) so often, in the background."""
    ended = threading.Event()

    def run():
        began = time.monotonic()
        for n in itertools.count():
            if ended.wait(max(0, began + n / hertz - time.monotonic())):
                return
            work(n)
    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


class Browser:
    def __init__(self, *more_options):
        self.profile = tempfile.mkdtemp(prefix="asip-chromium-")
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for option in (*CHROMIUM_OPTIONS, *more_options):
            options.add_argument(option)
        options.add_argument(f"--user-data-dir={self.profile}")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
        self.driver.set_script_timeout(30)
        self.desktop()

    def close(self):
        self.driver.quit()
        shutil.rmtree(self.profile, ignore_errors=True)

    def size(self, width, height, mobile=False):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile})

    def desktop(self):
        self.size(1280, 900)

    def color_scheme(self, name):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                    {"features": [{"name": "prefers-color-scheme", "value": name}]})

    def screenshot(self, name):
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        self.driver.save_screenshot(str(SCREENSHOTS / f"{name}.png"))

    def find(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def shown(self, selector, what=None, seconds=20):
        """The first visible element."""
        return eventually(lambda: next((e for e in self.find(selector) if e.is_displayed()), None), what or selector, seconds)

    def button(self, text, inside="body", seconds=20):
        def named():
            return next((e for e in self.find(f"{inside} button") if e.is_displayed() and e.text.strip() == text), None)
        return eventually(named, f"button {text}", seconds)

    def text(self, selector="main"):
        elements = self.find(selector)
        return elements[0].text if elements else ""

    def table(self):
        """The rows of the table of boards that are drawn: {name: text}."""
        return self.run("""
            return Object.fromEntries([...document.querySelectorAll('.filler .row:not([hidden])')].map(
                (row) => [row.querySelector('a').textContent, row.innerText]));""")

    def scroll_rate(self):
        """Frames a second that Chromium drew, by its own trace, while the table of boards is scrolled with a wheel."""
        box = self.run("const box = document.querySelector('.scroll').getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]")
        with Trace(self.driver) as trace:
            for direction in (-1, 1):
                self.driver.execute_cdp_cmd("Input.synthesizeScrollGesture",
                                            {"x": box[0], "y": box[1], "yDistance": direction * 6000, "speed": 4000, "gestureSourceType": "mouse"})
        return trace.scrolled_frames_per_second()

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)


class Trace:
    """Chromium's own record of its frames while this is open. Asked for over the browser's socket for tools: chromedriver's log of
    performance holds nothing of it."""

    def __init__(self, driver):
        address = driver.capabilities["goog:chromeOptions"]["debuggerAddress"]
        with urllib.request.urlopen(f"http://{address}/json/version", timeout=10) as answer:
            self.url = json.load(answer)["webSocketDebuggerUrl"]
        self.events = []

    def __enter__(self):
        self.socket = websocket.create_connection(self.url, suppress_origin=True, timeout=30)
        categories = ["-*", "disabled-by-default-devtools.timeline.frame"]
        self.send(1, "Tracing.start", {"transferMode": "ReportEvents", "traceConfig": {"includedCategories": categories}})
        while self.receive().get("id") != 1:
            pass
        return self

    def __exit__(self, *_):
        self.send(2, "Tracing.end", {})
        while (message := self.receive()).get("method") != "Tracing.tracingComplete":
            if message.get("method") == "Tracing.dataCollected":
                self.events += message["params"]["value"]
        self.socket.close()

    def send(self, number, method, parameters):
        self.socket.send(json.dumps({"id": number, "method": method, "params": parameters}))

    def receive(self):
        message = json.loads(self.socket.recv())
        if "error" in message:
            raise RuntimeError(message["error"]["message"])
        return message

    def scrolled_frames_per_second(self):
        """The frames that were presented while something scrolled."""
        frames = {}  # one frame may be reported twice: by the compositor and by the main thread
        for event in self.events:
            report = event.get("args", {}).get("frame_reporter")
            if report and report["state"].startswith("STATE_PRESENTED") and report["scroll_state"] != "SCROLL_NONE":
                frames.setdefault((event["pid"], report["frame_source"], report["frame_sequence"]), event["ts"])
        return (len(frames) - 1) * 1e6 / (max(frames.values()) - min(frames.values()))

    def frames_per_second(self):
        """Counts all pages together; only one should be moving."""
        times = sorted(event["ts"] for event in self.events if event["name"] == "DrawFrame")
        return (len(times) - 1) * 1e6 / (times[-1] - times[0])


class PageTest(unittest.TestCase):
    """One bus and one browser for all tests of a class. What a page logs as an error is a failure."""

    boards = (DESK, LAMP)
    simulator_options = ()
    expected_errors = ()
    language = "en"

    @classmethod
    def setUpClass(cls):
        cls.bus = cls.make_bus()
        cls.addClassCleanup(cls.bus.close)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)
        cls.texts = json.loads((ROOT / "gateway/page/languages" / f"{cls.language}.json").read_text())
        if cls.language != "en":
            cls.browser.driver.get(cls.bus.url)
            cls.browser.run("localStorage.setItem('asip-language', arguments[0])", cls.language)
            cls.browser.driver.get("about:blank")

    def t(self, name, **values):
        """A text of the page in its language."""
        return self.texts[name].format(**values)

    @classmethod
    def make_bus(cls):
        return Bus(cls.boards, cls.simulator_options)

    def setUp(self):
        self.browser.desktop()

    def tearDown(self):
        outcome = self._outcome
        failed = any(error for _, error in getattr(outcome, "errors", []) or [])
        result = getattr(outcome, "result", None)
        failed = failed or (result and any(test is self for test, _ in result.failures + result.errors))
        if failed:
            self.browser.screenshot(f"failed-{self.id().split('.')[-1]}")
            print(self.bus.logs())
        errors = [entry["message"] for entry in self.browser.driver.get_log("browser") if entry["level"] == "SEVERE"]
        errors = [error for error in errors if not any(part in error for part in self.expected_errors)]
        if not failed:
            self.assertEqual(errors, [])

    def open(self, route="", anew=False):
        """Shows a screen, built anew. The document stays, as it does for a user who follows links, unless it is asked for `anew`."""
        if anew or not self.browser.driver.current_url.startswith(self.bus.url):
            self.browser.driver.get("about:blank")
            self.browser.driver.get(f"{self.bus.url}/#/{route}")
        else:
            self.browser.driver.execute_async_script("""
                const [hash, done] = arguments;
                const go = (to) => new Promise((gone) => {
                  if (location.hash === to) return gone();
                  addEventListener('hashchange', () => gone(), { once: true });
                  location.hash = to;
                });
                go('#/left').then(() => go(hash)).then(done);""", f"#/{route}")
        eventually(lambda: self.browser.text("asip-link") == self.t("live-within"), "live", 30)  # a command before that is not sent

    def open_board(self, name="desk", anew=False):
        self.open(f"board/{name}", anew)
        self.browser.shown("asip-board .all-pins, asip-board asip-command form")
        self.all_pins()

    def all_pins(self):
        """Also those that nobody uses."""
        self.browser.run("document.querySelector('.all-pins[aria-expanded=false]')?.click()")

    def form(self, service, title):
        """The form of a command, also where it is folded away."""
        selector = f"form[aria-label='{service}: {title}']"
        eventually(lambda: self.browser.find(selector), selector)
        self.all_commands()
        return self.browser.shown(selector)

    def setter(self, name):
        """What sets a property of the board: a switch or a slider, by its name."""
        return self.browser.shown(f"asip-board .setters [aria-label='{name}']:is(button, input)")

    def slide(self, name, *values):
        slider = self.setter(name)
        for value in values:
            self.browser.run("arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input', {bubbles: true}))", slider, value)
        return slider

    def number(self, form, name):
        """The number input of a field, by the name that its label begins with."""
        for label in form.find_elements(By.TAG_NAME, "label"):
            if label.text.startswith(name):
                return form.find_element(By.ID, label.get_attribute("for"))
        raise AssertionError(f"no field {name} in {form.text}")

    def fill(self, form, name, text):
        """Types into a number input, in place of what stands there, as a person does: a value that comes meanwhile stays away."""
        number = self.number(form, name)
        number.send_keys(Keys.CONTROL, "a")
        number.send_keys(text)
        return number

    def send(self, form):
        form.find_element(By.CSS_SELECTOR, "button.main").click()

    def answered(self, form, kind, text):
        output = form.find_element(By.TAG_NAME, "output")
        eventually(lambda: kind in output.get_attribute("class") and text in output.text, f"{kind}: {text}")

    def history(self):
        """Unfolds what happened to the board."""
        self.browser.run("document.querySelector('details.history').open = true")
        self.every_command()

    def every_command(self):
        """Unfolds the commands in a history, from now on."""
        self.browser.shown("asip-history .check")
        self.browser.run("document.querySelectorAll('asip-history .check input:not(:checked)').forEach((each) => each.click())")

    def all_commands(self):
        self.browser.run("document.querySelectorAll('asip-board details').forEach((each) => { each.open = true; })")
