# SPDX-License-Identifier: Apache-2.0
"""A whole bus for tests in Python: broker, registry, gateway, simulated boards, agents. All of it on loopback, on ports that
were free, and gone when the test ends. ASIP_BUILD is the build folder."""

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
import urllib.error
import urllib.request

import paho.mqtt.client as mqtt

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["ASIP_BUILD"])
BIN = BUILD / "bin"
IMAGES = BUILD / "firmware" / "images"
NOT_YET = (urllib.error.URLError, ConnectionError, TimeoutError)

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


def paho_client(**options):
    """A client of paho-mqtt 1.6 or 2.x."""
    if hasattr(mqtt, "CallbackAPIVersion"):
        options["callback_api_version"] = mqtt.CallbackAPIVersion.VERSION2
    return mqtt.Client(**options)


def settings_file(text):
    """The path of a configuration file for --config that is there until this process ends."""
    if not _settings:
        _settings.append(tempfile.TemporaryDirectory())
    path = pathlib.Path(_settings[0].name) / f"{len(_settings)}.conf"
    path.write_text(text)
    _settings.append(path)
    return str(path)


_settings = []


def free_port():
    """None of those that the kernel may give to another connection before it is used."""
    while True:
        with socket.socket() as s, contextlib.suppress(OSError):
            s.bind(("127.0.0.1", random.randrange(10000, 32768)))
            return s.getsockname()[1]


def eventually(condition, what, seconds=20):
    """The first true value of `condition`; a fault of NOT_YET counts as none."""
    end = time.monotonic() + seconds
    while True:
        try:
            value = condition()
        except NOT_YET:
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
        environment.pop("STATE_DIRECTORY", None)
        environment["XDG_STATE_HOME"] = str(self.work / "state")  # labels of a user's own boards are not the test's
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

    def post(self, path, body):
        request = urllib.request.Request(self.url + path, json.dumps(body).encode(), {"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)

    def asipctl(self, *words, limit=120):
        return subprocess.run([str(program_path("asipctl")), *words], capture_output=True, text=True, timeout=limit, check=False,
                              env={**os.environ, "ASIP_BROKER": f"127.0.0.1:{self.broker_port}"})

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
    client = paho_client(protocol=mqtt.MQTTv5)
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
    client = paho_client()
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
