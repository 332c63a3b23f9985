#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Nobody takes another's share: while one user floods a secured bus, a stop over MQTT and over HTTP, a command, a query and a page of others
are asked for every 50 ms. Prints the worst delay of each, and what memory the programs took.

    shares.py [--runs N] [--rows PATTERN...] [--boards N] [--json FILE]    of rows such as 'topic viewer servicebus/$probe large'
"""

import argparse
import collections
import fnmatch
import http.client
import json
import os
import pathlib
import re
import ssl
import subprocess
import sys
import threading
import time
import urllib.request

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS / "support"))
os.environ.setdefault("ASIP_BUILD", str(TESTS.parent / "build" / "dev"))

import flood as flood_module  # noqa: E402
import rows  # noqa: E402
from bus import BIN, DESK, LAMP, ROOT, can_connect, eventually, paho_client  # noqa: E402
from secured_bus import SecuredBus  # noqa: E402

SECONDS = 4
EVERY = 0.05
NEVER = 30.0  # is a question waited for
LONGEST = 60.0  # it takes to be well again
MUSTS = {"stop": 0.5, "stop-http": 1.0, "command": 2.0, "command-http": 2.0, "query": 2.0, "page": 2.0}
UNITS = {"agent-desk": "asip-agent@", "agent-lamp": "asip-agent@", "registry": "asip-registry", "gateway": "asip-gateway"}
FINE = ("ok", "stopped")  # answers; an operator may stop a board
SHARE = 0.7  # of a unit's limit
# Commands of all users for one board wait in one queue at the broker, and a board that is being stopped executes none: an operator who floods
# it delays the commands of others (SECURITY.md), but no stop.
OWN_QUEUE = tuple(f"topic {name} operator" for name in ("BOARD/in", "BOARD/SERVICE/in", "BOARD/$link/USER/CLIENT", "BOARD/$stop"))


class SharedBus(SecuredBus):
    users = (("board", "desk", "lamp", "crook"), ("registry",), ("gateway",), ("home-assistant",), ("operator", "ann", "olga"),
             ("viewer", "bob", "eve"))
    sources = (("lamp", "crook"),)
    answers = ""

    def __init__(self, boards):
        self.count = boards
        super().__init__(boards=(DESK, LAMP))

    def start_all(self):
        super().start_all()
        self.start("load", "asip-load", "--boards", str(self.count), "--boards-per-connection", "50", "--join-rate", "400",
                   "--credentials", str(self.credentials("admin")))
        eventually(lambda: self.get("/api/status")["mirror"]["boards"] >= self.count + 2, "all boards in the gateway", 600)
        for name in ("lab", "hall"):
            eventually(lambda: name in json.dumps(self.get("/api/dashboards")) or self.make_dashboard(name), "a dashboard", 60)
        link = {"name": "l1", "from": "crook/io/2", "when": "follows", "to": "io", "command": {"write": [13, 1]}}
        asker = OverMqtt(self, "ann", "link", "lamp", "asip/lamp/$link/ann/c1", set=link)
        eventually(lambda: asker.ask() == "ok", "a link to the board that floods", 60)
        asker.client.disconnect()
        self.answers = self.topic_of_answers()

    def topic_of_answers(self):
        """Where the gateway hears how its stops ended: a board that was stopped once knows it."""
        crook = OverMqtt(self, "crook", "gone", topic="asip/servicebus/crook/$state")
        heard = []
        crook.client.on_message = lambda _client, _data, message: heard.append(json.loads(message.payload))
        crook.client.subscribe("asip/crook/$stop", 1)
        service = {"name": "io", "id": "I", "model": "io@1"}
        description = {"board": "crook", "session": "5f3a9c01", "seq": 1, "lease": 600, "services": [service],
                       "firmware": {"protocol": "0.4", "chip": "ATmega328P", "sketch": "x"}}
        for topic, text in (("$description", json.dumps(description)), ("$state", "online")):
            crook.client.publish(f"asip/servicebus/crook/{topic}", text, 1, True)
        eventually(lambda: self.get("/api/boards/crook")["state"] == "online", "crook in the gateway")
        stop = OverHttp(self, "ann", "POST", "/api/boards/crook/stop?once=true")
        asked = threading.Thread(target=stop.ask, daemon=True)
        asked.start()
        eventually(lambda: heard, "a stop of crook")
        crook.client.publish(heard[0]["reply_to"], json.dumps({"id": heard[0]["id"], "status": "ok"}), 1)
        asked.join()
        stop.connection.close()
        crook.client.disconnect()
        return heard[0]["reply_to"]

    def make_dashboard(self, name):
        widget = {"id": "w1", "kind": "slider", "board": "desk", "property": "servo/0/angle"}
        text = json.dumps({"title": name, "widgets": [widget]}).encode()
        asked = urllib.request.Request(f"{self.url}/api/dashboards/{name}", text, self.headers("ann"), method="PUT")
        urllib.request.urlopen(asked, timeout=NEVER).close()

    def start(self, name, program, *arguments):
        if name == "registry":
            arguments = ("--id", "hall", *arguments[2:])
        super().start(name, program, *arguments)

    def start_gateway(self):
        self.tokens = {}
        for role, name, more in (("viewer", "eve", ()), ("operator", "olga", ()), ("operator+raw", "oscar", ()), ("admin", "alba", ()),
                                 ("kiosk", "hall", ("--dashboard", "lab", "--control")), ("operator", "ann", ()), ("viewer", "bob", ())):
            made = subprocess.run([str(BIN / "asip-gateway"), "token", role, name, "--tokens", str(self.work / "tokens"), *more],
                                  check=True, capture_output=True, text=True, timeout=20)
            self.tokens[name if name in ("ann", "bob") else role] = made.stdout.strip()
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", "--tokens", str(self.work / "tokens"),
                   "--home-assistant", "--homie", "--sparkplug", "hall")
        eventually(lambda: can_connect(self.http_port), "the gateway")

    def headers(self, name):
        return {"Authorization": f"Bearer {self.tokens[name]}", "Content-Type": "application/json"}

    def get(self, path):
        asked = urllib.request.Request(self.url + path, headers=self.headers("bob"))
        with urllib.request.urlopen(asked, timeout=NEVER) as answer:
            return json.load(answer)

    def place(self):
        """All that a flood must know."""
        users = {name: self.user(name)[:2] for name in rows.USERS.values()}
        largest = int(re.search(r"max_packet_size (\d+)", (self.work / "bus" / "mosquitto.conf").read_text())[1])
        return {"users": users, "tokens": self.tokens, "largest": largest, "answers": self.answers, "http": ("127.0.0.1", self.http_port),
                "broker": ("127.0.0.1", self.broker_port), "ca": str(self.work / "bus" / "ca.crt")}


class Asker(threading.Thread):
    """Asks again and again, and keeps when each question was asked and answered, and how."""

    def __init__(self):
        super().__init__(daemon=True)
        self.asked = []

    def run(self):
        while True:
            begun = time.monotonic()
            try:
                said = self.ask()
            except OSError as error:
                said = repr(error)
            self.asked.append((begun, time.monotonic() if said is not None else begun + NEVER, said or "no answer"))
            time.sleep(max(0, begun + EVERY - time.monotonic()))

    def well_since(self, begin):
        """Whether something asked later was answered soon."""
        return any(begun > begin and answered - begun < MUSTS["command"] and said in FINE for begun, answered, said in self.asked[-10:])

    def within(self, begin, end):
        return [(answered - begun, said) for begun, answered, said in list(self.asked) if answered >= begin and begun <= end]


class OverMqtt(Asker):
    """`topic`: where the question goes; none: to itself."""

    def __init__(self, bus, user, kind, board="", topic="", **question):
        super().__init__()
        self.reply = f"asip/reply/{user}/{board or '$self'}/{kind}"
        self.topic, self.question, self.number = topic or self.reply, question, 0
        self.answered = threading.Condition()
        name, password, _ = bus.user(user)
        self.client = paho_client()
        self.client.username_pw_set(name, password)
        self.client.tls_set_context(ssl.create_default_context(cafile=bus.place()["ca"]))
        self.client.on_connect = lambda *_: self.client.subscribe(self.reply, 1)
        self.client.on_message = self.message
        self.client.reconnect_delay_set(1, 1)
        self.client.connect("127.0.0.1", bus.broker_port)
        self.client.loop_start()

    def message(self, _client, _data, message):
        answer = json.loads(message.payload)
        with self.answered:
            if answer.get("id") == str(self.number):
                self.said = answer.get("reason") or answer.get("status") or answer.get("refused") or "ok"
                self.answered.notify()

    def ask(self):
        with self.answered:
            self.number, self.said = self.number + 1, None
            self.client.publish(self.topic, json.dumps({**self.question, "id": str(self.number), "reply_to": self.reply}), 1)
            self.answered.wait_for(lambda: self.said, NEVER)
            return self.said


class BareMqtt(OverMqtt):
    """As far as a stop and its answer, with no program of ours: to a second connection, which answers, and back."""

    def __init__(self, bus, user):
        super().__init__(bus, user, "bare", topic=f"asip/reply/{user}/$self/far")
        self.far = OverMqtt(bus, user, "far").client
        self.far.on_message = lambda client, _data, message: client.publish(self.reply, message.payload, 1)


class OverHttp(Asker):
    def __init__(self, bus, name, method, path, body=None):
        super().__init__()
        self.request = method, path, body, bus.headers(name)
        self.connection = http.client.HTTPConnection("127.0.0.1", bus.http_port, timeout=NEVER)

    def ask(self):
        try:
            self.connection.request(*self.request)
            answer = self.connection.getresponse()
            reason = re.search(rb'"reason":"([a-z-]+)"', answer.read())
            return "ok" if answer.status == 200 else reason[1].decode() if reason else str(answer.status)
        except (OSError, http.client.HTTPException) as error:
            self.connection.close()
            return None if isinstance(error, TimeoutError) else repr(error)


def start_askers(bus):
    askers = {
        "bare": BareMqtt(bus, "ann"),
        "stop": OverMqtt(bus, "ann", "stop", "desk", "asip/desk/$stop"),
        "stop-http": OverHttp(bus, "ann", "POST", "/api/boards/desk/stop?once=true"),
        "command": OverMqtt(bus, "ann", "command", "lamp", "asip/lamp/in", raw="#,?"),
        "command-http": OverHttp(bus, "ann", "POST", "/api/boards/lamp/services/io/commands/write", "[13,1]"),
        "query": OverMqtt(bus, "bob", "query", "registry", "asip/registry/query", find="boards", limit=100),
        "page": OverHttp(bus, "bob", "GET", "/api/boards?limit=100"),
    }
    for asker in askers.values():
        asker.start()
    eventually(lambda: all(asker.well_since(0) for asker in askers.values()), "an answer to each", 60)
    return askers


def limits():
    """Bytes that each program may take."""
    found = {}
    for program, unit in UNITS.items():
        text = (ROOT / "packaging" / "systemd" / f"{unit}.service").read_text()
        number, scale = re.search(r"^MemoryMax=(\d+)([MG])$", text, re.M).groups()
        found[program] = int(number) << {"M": 20, "G": 30}[scale]
    return found


def processor_seconds(bus):
    """What each program used, this one with its floods, and the whole machine."""
    found = {}
    tick = os.sysconf("SC_CLK_TCK")
    for name, program in bus.programs.items():
        fields = pathlib.Path(f"/proc/{program.pid}/stat").read_text().rsplit(")", 1)[1].split()
        found[name] = (int(fields[11]) + int(fields[12])) / tick
    found["test"] = sum(os.times()[:4])
    user, nice, system, _idle, _waiting, *more = map(int, pathlib.Path("/proc/stat").read_text().split("\n")[0].split()[1:8])
    found["machine"] = (user + nice + system + sum(more)) / tick
    return found


def peak(program):
    return int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{program.pid}/status").read_text())[1]) << 10


def measure(bus, askers, row, seconds=SECONDS):
    """Figures of one flood. On a machine that does other things, too, delays are those of the part of it that the bus had."""
    for program in bus.programs.values():
        pathlib.Path(f"/proc/{program.pid}/clear_refs").write_text("5")  # its peak begins anew
    before = processor_seconds(bus)
    flood = subprocess.run([sys.executable, "-B", flood_module.__file__], input=json.dumps([row, bus.place(), seconds]), capture_output=True,
                           text=True, check=True)
    figures = {"row": " ".join(row), "load": os.getloadavg()[0], **json.loads(flood.stdout)}
    begun, ended = figures["begun"], figures["ended"]
    figures["gone"] = [name for name, program in bus.programs.items() if program.poll() is not None]
    used = {}
    if not figures["gone"]:
        used = figures["processor"] = {name: now - before[name] for name, now in processor_seconds(bus).items()}
        figures["share"] = min(1, (sum(used.values()) - used["machine"]) / used["machine"])
    after = figures["after"] = {}
    while len(after) < len(askers) and time.monotonic() < ended + LONGEST:
        after.update({name: time.monotonic() - ended for name, asker in askers.items() if name not in after and asker.well_since(ended)})
        time.sleep(EVERY)
    answers = {name: asker.within(begun, ended) for name, asker in askers.items()}
    figures["delay"] = {name: figures.get("share", 1) * max(delay for delay, _ in each) for name, each in answers.items()}
    figures["said"] = {name: collections.Counter(said for _, said in each) for name, each in answers.items()}
    if used:
        figures["memory"] = {name: peak(bus.programs[name]) / limit for name, limit in limits().items()}
        figures["broker"] = peak(bus.programs["broker"])
    return figures


def faults(figures):
    """Which of the musts do not hold."""
    delay = figures["delay"]
    found = [f"{name} ended" for name in figures["gone"]]
    own_queue = figures["row"].startswith(OWN_QUEUE)
    musts = {name: must for name, must in MUSTS.items() if not (own_queue and name.startswith("command"))}
    found += [name for name, must in musts.items() if delay[name] > max(must, 2 * delay["bare"])]
    found += [f"{name}: {said}" for name, each in figures["said"].items() for said in each if said not in FINE and name in ("bare", *musts)]
    found += [f"{name} not well again" for name in delay if name not in figures["after"]]
    return found + [f"memory of {name}" for name, share in figures.get("memory", {}).items() if share > SHARE]


HEAD = (f"{'milliseconds at worst; seconds until all is well; % of memory':<78} " + " ".join(f"{name[:9]:>9}" for name in ("bare", *MUSTS)) +
        "  after agnt agnt regi gate      MB share  load  musts that do not hold")


def line(figures):
    after = max(figures["after"].values()) if len(figures["after"]) == len(figures["delay"]) else LONGEST
    delays = " ".join(f"{figures['delay'][name] * 1000:9.0f}" for name in ("bare", *MUSTS))
    memory = " ".join(f"{figures.get('memory', {}).get(name, 0) * 100:4.0f}" for name in UNITS)
    return (f"{figures['row']:<78} {delays} {after:6.1f} {memory} {figures['sent'] / 1e6:7.1f} {figures.get('share', 1):5.2f} "
            f"{figures['load']:5.1f}  {', '.join(faults(figures))}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--boards", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=SECONDS)
    parser.add_argument("--rows", nargs="*", default=["*"])
    parser.add_argument("--json")
    options = parser.parse_args()
    wanted = [row for row in rows.all_rows() if any(fnmatch.fnmatch(" ".join(row), pattern) for pattern in options.rows)]
    print(HEAD)
    measured, failed, bus = [], 0, None
    for row in wanted * options.runs:
        if not bus:
            bus = SharedBus(options.boards)
            askers = start_askers(bus)
        measured.append(measure(bus, askers, row, options.seconds))
        print(line(measured[-1]), flush=True)
        failed += bool(faults(measured[-1]))
        if options.json:
            pathlib.Path(options.json).write_text(json.dumps(measured, indent=1))
        if measured[-1]["gone"]:
            print(bus.logs())
            bus.close()
            bus = None
    print(f"{failed} of {len(measured)} rows do not hold")
    if bus:
        bus.close()
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
