# SPDX-License-Identifier: Apache-2.0
"""A whole bus for the tests of the web page: broker, registry, simulated boards, agents, gateway and a browser. All of it
on loopback, on ports that were free, and gone when the test ends."""

import contextlib
import ctypes
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.request

import paho.mqtt.client as mqtt
import websocket
from selenium import webdriver
from selenium.common.exceptions import StaleElementReferenceException, WebDriverException
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["ASIP_BUILD"])
BIN = BUILD / "bin"
IMAGES = BUILD / "firmware" / "images"
SCREENSHOTS = BUILD / "screenshots"

CHROMIUM_OPTIONS = """--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars""".split()

DESK = {
    "name": "desk", "board": "uno", "image": str(IMAGES / "asip_uno_services.elf"), "link": "desk.port",
    "parts": [
        {"kind": "button", "name": "button", "pin": 2},
        {"kind": "led", "name": "led", "pin": 13},
        {"kind": "ultrasonic", "name": "distance", "trigger": 7, "echo": 7, "distance": 42},
        {"kind": "servo", "name": "servo", "pin": 9},
    ],
}
LAMP = {"name": "lamp", "board": "uno", "image": str(IMAGES / "asip_uno.elf"), "link": "lamp.port",
        "parts": [{"kind": "led", "name": "lamp", "pin": 13}]}


def free_port():
    """None of those that the kernel may give to somebody's connection before it is used."""
    while True:
        with socket.socket() as s, contextlib.suppress(OSError):
            s.bind(("127.0.0.1", random.randrange(10000, 32768)))
            return s.getsockname()[1]


def eventually(condition, what, seconds=20):
    """The first true value of `condition`; elements that changed while they were read count as not yet."""
    end = time.monotonic() + seconds
    while True:
        try:
            value = condition()
        except (StaleElementReferenceException, urllib.error.URLError, ConnectionError):
            value = None
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {seconds} s")
        time.sleep(0.08)


def die_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)


class Bus:
    def __init__(self, boards=(DESK, LAMP), simulator_options=()):
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="asip-browser-"))
        self.programs = {}
        self.broker_port = free_port()
        self.http_port = free_port()
        self.url = f"http://127.0.0.1:{self.http_port}"
        self.boards = boards
        self.simulator_options = simulator_options
        try:
            self.start_all()
        except BaseException:
            print(self.logs())
            self.close()
            raise

    def start_all(self):
        self.start_broker()
        self.start("registry", "asip-registry", "--id", "first", "--history", str(self.work / "history.db"))
        self.start_gateway()
        if not self.boards:
            return
        files = []
        for board in self.boards:
            file = self.work / f"{board['name']}.json"
            file.write_text(json.dumps(board))
            files.append(str(file))
        self.start("sim", "asip-sim", "--socket", str(self.work / "sim.sock"), *self.simulator_options, *files)
        for board in self.boards:
            self.start_agent(board["name"])
        eventually(lambda: all(self.state(board["name"]) == "online" for board in self.boards), "all boards online", 60)

    def start_broker(self):
        config = self.work / "mosquitto.conf"
        config.write_text(f"listener {self.broker_port} 127.0.0.1\nallow_anonymous true\nset_tcp_nodelay true\n"
                          "max_queued_messages 100000\n")
        program = shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin")
        self.start("broker", program, "-c", str(config))
        eventually(lambda: can_connect(self.broker_port), "the broker's port")

    def start_gateway(self):
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}")
        eventually(lambda: self.get("/readyz"), "the gateway")

    def start_agent(self, board):
        port = self.work / f"{board}.port"
        eventually(port.exists, f"the port of {board}")
        # At its first rate a simulated board keeps up with its line even where the machine is busy.
        self.start(f"agent-{board}", "asip-agent", "--serial", str(port), "--name", board, "--lease", "6", "--no-step-up",
                   "--patience", "60")

    def start(self, name, program, *arguments):
        path = program if os.path.isabs(program) else str(program_path(program))
        environment = {key: value for key, value in os.environ.items() if not key.startswith("ASIP_")}
        environment["ASIP_BROKER"] = f"127.0.0.1:{self.broker_port}"
        log = open(self.work / f"{name}.log", "ab")
        self.programs[name] = subprocess.Popen([path, *arguments], stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                               env=environment, preexec_fn=die_with_parent)
        log.close()

    def end(self, name, how=signal.SIGTERM):
        program = self.programs.pop(name)
        program.send_signal(how)
        try:
            program.wait(5)
        except subprocess.TimeoutExpired:
            program.kill()
            program.wait()

    def sim(self, *words):
        return subprocess.run([str(BIN / "asip-sim"), "ctl", "--socket", str(self.work / "sim.sock"), *words], check=True,
                              capture_output=True, text=True, timeout=60).stdout

    def part(self, name):
        for line in self.sim("list").splitlines():
            words = line.split()
            if words[0] == name:
                return " ".join(words[2:])
        raise AssertionError(f"no part {name}")

    def get(self, path):
        with urllib.request.urlopen(self.url + path, timeout=30) as answer:
            return json.load(answer)

    def state(self, board):
        try:
            return self.get(f"/api/boards/{board}")["state"]
        except urllib.error.HTTPError:
            return None

    def logs(self):
        ended = {name: program.poll() for name, program in self.programs.items() if program.poll() is not None}
        return f"programs that ended by themselves, with their status: {ended}\n" + "".join(f"--- {path.stem}\n{path.read_text(errors='replace')[-1500:]}" for path in sorted(self.work.glob("*.log")))

    def close(self):
        for name in reversed(list(self.programs)):
            self.end(name)
        shutil.rmtree(self.work, ignore_errors=True)


def program_path(name):
    other = pathlib.Path(os.environ.get("ASIP_TEST_PROGRAMS", BIN), name)
    return other if other.exists() else BIN / name


def publish_boards(bus, count):
    """Announces so many boards, as their agents would, and waits until the gateway knows them all."""
    client = mqtt.Client(protocol=mqtt.MQTTv5)
    client.max_queued_messages_set(0)
    client.max_inflight_messages_set(1000)
    client.connect("127.0.0.1", bus.broker_port)
    client.loop_start()
    services = [{"name": name, "id": letter, "model": f"{name}@1"} for name, letter in (("io", "I"), ("distance", "D"), ("servo", "S"))]
    for i in range(count):
        name = f"board{i}"
        document = {"board": name, "session": "5f3a9c01", "seq": 1, "lease": 600,
                    "firmware": {"protocol": "0.4", "chip": "ATmega328P", "sketch": "AsipServices"}, "services": services}
        client.publish(f"asip/servicebus/{name}/$description", json.dumps(document), qos=1)
        last = client.publish(f"asip/servicebus/{name}/$state", "online", qos=1)
    last.wait_for_publish(60)
    client.disconnect()
    client.loop_stop()
    eventually(lambda: bus.get("/api/status")["mirror"]["boards"] >= count, "all boards in the gateway", 60)


@contextlib.contextmanager
def commands_heard(bus):
    """A list of what is sent to boards meanwhile, as text."""
    heard = []
    granted = threading.Event()
    client = mqtt.Client()
    client.on_message = lambda _client, _data, message: heard.append(message.payload.decode(errors="replace"))
    client.on_subscribe = lambda *_: granted.set()
    client.connect("127.0.0.1", bus.broker_port)
    client.subscribe([("asip/+/in", 0), ("asip/+/+/in", 0), ("asip/+/$stop", 0)])
    client.loop_start()
    try:
        if not granted.wait(20):
            raise AssertionError("no subscription to commands")
        yield heard
    finally:
        client.disconnect()
        client.loop_stop()


def can_connect(port):
    with socket.create_connection(("127.0.0.1", port), timeout=1):
        return True


class Browser:
    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix="asip-chromium-")
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for option in CHROMIUM_OPTIONS:
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

    def button(self, text, inside="body"):
        def named():
            return next((e for e in self.find(f"{inside} button") if e.is_displayed() and e.text.strip() == text), None)
        return eventually(named, f"button {text}")

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
        """Of frames that were presented while something scrolled."""
        frames = {}  # one frame may be reported twice: by the compositor and by the main thread
        for event in self.events:
            report = event.get("args", {}).get("frame_reporter")
            if report and report["state"].startswith("STATE_PRESENTED") and report["scroll_state"] != "SCROLL_NONE":
                frames.setdefault((event["pid"], report["frame_source"], report["frame_sequence"]), event["ts"])
        return (len(frames) - 1) * 1e6 / (max(frames.values()) - min(frames.values()))

    def frames_per_second(self):
        """Of all pages together; only one should be moving."""
        times = sorted(event["ts"] for event in self.events if event["name"] == "DrawFrame")
        return (len(times) - 1) * 1e6 / (times[-1] - times[0])


class PageTest(unittest.TestCase):
    """One bus and one browser for all tests of a class. What a page logs as an error is a failure."""

    boards = (DESK, LAMP)
    simulator_options = ()
    expected_errors = ()

    @classmethod
    def setUpClass(cls):
        cls.bus = Bus(cls.boards, cls.simulator_options)
        cls.addClassCleanup(cls.bus.close)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

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
        """Shows a screen, built anew. The document stays, as it does for whoever follows links, unless it is asked for `anew`."""
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
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)  # a command before that is not sent

    def open_board(self, name="desk", anew=False):
        self.open(f"board/{name}", anew)
        self.browser.shown("asip-board asip-command form")

    def form(self, service, title):
        return self.browser.shown(f"form[aria-label='{service}: {title}']")

    def number(self, form, name):
        """The number input of a field, by the name that its label begins with."""
        for label in form.find_elements(By.TAG_NAME, "label"):
            if label.text.startswith(name):
                return form.find_element(By.ID, label.get_attribute("for"))
        raise AssertionError(f"no field {name} in {form.text}")

    def fill(self, form, name, text):
        """Types into a number input, in place of what stands there."""
        number = self.number(form, name)
        number.clear()
        number.send_keys(text)
        return number

    def send(self, form):
        form.find_element(By.CSS_SELECTOR, "button.main").click()

    def answered(self, form, kind, text):
        output = form.find_element(By.TAG_NAME, "output")
        eventually(lambda: kind in output.get_attribute("class") and text in output.text, f"{kind}: {text}")

    def all_commands(self):
        self.browser.run("document.querySelectorAll('asip-service details').forEach((each) => { each.open = true; })")
