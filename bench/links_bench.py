#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a link takes from a press on one board to the level on another, beside programs that do the same and nothing else, and what a
hundred links cost an agent.

    bench_links [ROUNDS]    of each; 5 when not given

The boards are simulated, with real firmware: at 57600 baud on both sides, and as agents run them, which step the line up. Or they are
scripted, at TCP ports of this process, where the programs alone count: plain_link checks and proves nothing. Beside them stands
plain_link, at 57600 baud: two MQTT programs, of which one reads a port and publishes, the other subscribes and writes a port; and one
program that reads one port and writes the other. Rounds alternate; all presses and releases of a side count together.
"""

import json
import os
import pathlib
import select
import socket
import subprocess
import sys
import tempfile
import time

from agent_boards_bench import ANSWERS, PROGRAMS, Bus, memory, start

PRESSES = 40  # of a round, each with its release
GAP = 0.12  # seconds between them, at least: values are told ten times a second
LINKS = 100
QUIET = 30  # seconds that an idle agent is watched
DEADLINE = 60


class Boards:
    """Two boards: a button at pin 2 of `desk`, and a pin of `lamp`. They are served while next_lines() is called."""

    def pass_time(self, seconds):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.next_lines(left)

    def run(self, *words):
        """What a program printed."""
        program = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while program.poll() is None:
            self.next_lines(0.01)
        printed, errors = program.communicate()
        return program.returncode, printed, errors

    def took(self, on):
        """Seconds from a press, or release, until the level is there."""
        began = time.perf_counter()
        self.press(on)
        end = time.monotonic() + DEADLINE
        while self.LEVELS[on] not in self.next_lines(1):
            if time.monotonic() > end:
                raise RuntimeError("a press did not arrive")
        return time.perf_counter() - began

    def presses(self):
        self.took(True), self.pass_time(GAP), self.took(False)
        took = []
        for number in range(2 * PRESSES):
            self.pass_time(GAP + number * 0.037 % 0.05)  # at any moment of the 50 ms between a board's reports of its analog pins
            took.append(self.took(number % 2 == 0))
        return took


class Scripted(Boards):
    """They answer what an agent asks, and tell the rest."""

    PIN, OPTION, MORE = 3, "tcp", []
    LEVELS = {True: "I,d,3,1", False: "I,d,3,0"}

    def __init__(self, _):
        self.listeners = {name: socket.create_server(("127.0.0.1", 0)) for name in ("desk", "lamp")}
        self.places = {name: f"127.0.0.1:{each.getsockname()[1]}" for name, each in self.listeners.items()}
        self.lines = {}

    def plain(self, name):
        return self.places[name].split(":")[1]

    def next_lines(self, seconds):
        new = []
        for ready in select.select([*self.listeners.values(), *self.lines], [], [], seconds)[0]:
            if ready in self.listeners.values():
                line, _ = ready.accept()
                line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self.lines[line] = b""
                if ready is self.listeners["desk"]:
                    self.desk = line
            elif data := ready.recv(4096):
                *lines, self.lines[ready] = (self.lines[ready] + data).split(b"\n")
                for each in lines:
                    new.append(each.decode().strip())
                    if answer := self.answer(new[-1]):
                        ready.sendall(answer.encode() + b"\r\n")
            else:
                del self.lines[ready]
                ready.close()
        return new

    @staticmethod
    def answer(line):
        if line.startswith("#,E,"):
            return "@" + line
        return ANSWERS.get(line) or (f"~#,{line[2:3]},2{{UNKNOWN_REQUEST}}" if line.startswith("#") else "")

    def press(self, on):
        self.desk.sendall(b"@I,d,4,%d\r\n" % (0 if on else 4))

    def end(self):
        for each in (*self.listeners.values(), *self.lines):
            each.close()


class Simulated(Boards):
    PIN, OPTION, MORE = 13, "serial", ["--no-step-up"]
    LEVELS = {True: "bulb on", False: "bulb off"}

    def __init__(self, folder):
        parts = {"desk": {"kind": "button", "name": "key", "pin": 2, "steady": True}, "lamp": {"kind": "led", "name": "bulb", "pin": 13}}
        image = str(PROGRAMS.parent / "firmware" / "images" / "asip_uno.elf")
        self.places = {name: str(folder / name) for name in parts}
        for name, part in parts.items():
            (folder / f"{name}.json").write_text(json.dumps({"name": name, "board": "uno", "image": image, "link": self.places[name], "parts": [part]}))
        self.program = subprocess.Popen([PROGRAMS / "asip-sim", *(folder / f"{name}.json" for name in parts), "--no-socket"],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.rest = b""
        while not all(pathlib.Path(place).exists() for place in self.places.values()):
            self.next_lines(0.1)

    def plain(self, name):
        return self.places[name]

    def next_lines(self, seconds):
        if not select.select([self.program.stdout], [], [], seconds)[0]:
            return []
        *lines, self.rest = (self.rest + os.read(self.program.stdout.fileno(), 65536)).split(b"\n")
        return [line.decode().split(None, 2)[-1] for line in lines if line]

    def press(self, on):
        os.write(self.program.stdin.fileno(), b"press key\n" if on else b"release key\n")

    def end(self):
        self.program.terminate()
        self.program.wait()


class SteppedUp(Simulated):
    MORE = []


class World:
    def __init__(self, folder, kind):
        self.folder, self.bus, self.boards, self.programs = folder, Bus(folder), kind(folder), []

    def agent(self, name, *more):
        self.programs.append(start(["--broker", f"127.0.0.1:{self.bus.port}", f"--{self.boards.OPTION}", self.boards.places[name], "--name", name,
                                    "--state-dir", str(self.folder / "state"), *self.boards.MORE, *more]))

    def one_agent(self):
        conf = self.folder / "boards.conf"
        conf.write_text(f"broker = 127.0.0.1:{self.bus.port}\nstate-dir = {self.folder / 'state'}\n" + "".join(
            f"{option[2:]} = true\n" for option in self.boards.MORE) + "".join(
                f"[board {name}]\n{self.boards.OPTION} = {place}\n" for name, place in self.boards.places.items()))
        self.programs.append(start(["--config", str(conf)]))

    def plain(self, *words):
        self.programs.append(subprocess.Popen([PROGRAMS / "plain_link", *map(str, words)]))

    def asipctl(self, *words):
        status, _, errors = self.boards.run(PROGRAMS / "asipctl", "--broker", f"127.0.0.1:{self.bus.port}", *words)
        if status:
            raise RuntimeError(f"asipctl {' '.join(words)}: {errors}")

    def heard(self, topic, good):
        """Until what is retained there is so."""
        end = time.monotonic() + DEADLINE
        while time.monotonic() < end:
            _, printed, _ = self.boards.run("mosquitto_sub", "-p", self.bus.port, "-t", topic, "-W", "1")
            if good(printed.splitlines()):
                return
        raise RuntimeError(f"not so: {topic}")

    def online(self):
        self.heard("asip/servicebus/+/$state", lambda states: states == ["online"] * 2)

    def links(self, wanted):
        """Until lamp has so many, and each hears its source."""
        def good(lines):
            links = json.loads(lines[-1])["links"] if lines and lines[-1] else []
            return len(links) == wanted and not any("fault" in link for link in links)
        self.heard("asip/lamp/$links", good)

    def linked(self):
        self.online()
        self.asipctl("label", "desk/io/2", "class=button")
        self.asipctl("pin", "desk", "2", "pullup")
        self.asipctl("send", "lamp/io", "mode", str(self.boards.PIN), "output")
        self.boards.press(False)
        self.asipctl("link", "desk/io/2", f"lamp/io/{self.boards.PIN}", "--name", "l")
        self.links(1)
        took = self.boards.presses()
        self.asipctl("link", "remove", "lamp/l")
        return took

    def two_agents(self):
        self.agent("desk"), self.agent("lamp")
        return self.linked()

    def agent_alone(self):
        self.one_agent()
        return self.linked()

    def plain_mqtt(self):
        self.plain("sub", self.bus.port, self.boards.plain("lamp"), self.boards.PIN), self.plain("pub", self.bus.port, self.boards.plain("desk"))
        self.boards.pass_time(2)
        return self.boards.presses()

    def ports_alone(self):
        self.plain("ports", self.boards.plain("desk"), self.boards.plain("lamp"), self.boards.PIN)
        self.boards.pass_time(2)
        return self.boards.presses()

    def end_programs(self):
        for each in self.programs:
            each.terminate()
        while any(each.poll() is None for each in self.programs):
            self.boards.next_lines(0.01)
        self.programs.clear()

    def end(self):
        self.end_programs()
        self.boards.end()
        self.bus.broker.terminate()
        self.bus.broker.wait()


def figures(took):
    took = sorted(took)
    return took[len(took) // 2] * 1e3, took[len(took) * 99 // 100] * 1e3


def press_to_level(kind, what, rounds, bounded=True):
    ways = ("plain_mqtt", "two_agents", "ports_alone", "agent_alone")
    took = {way: [] for way in ways}
    with tempfile.TemporaryDirectory() as folder:
        world = World(pathlib.Path(folder), kind)
        try:
            for _ in range(rounds):
                for way in ways:
                    took[way] += getattr(world, way)()
                    world.end_programs()
        finally:
            world.end()
    for way, beside, name, must, aim in (("two_agents", "plain_mqtt", "two agents, over plain MQTT", 1.1, 0.9),
                                         ("agent_alone", "ports_alone", "one agent, over the ports alone", 1.3, 1.1)):
        (p50, p99), (plain50, plain99) = figures(took[way]), figures(took[beside])
        bounds = f"  must {must:5.2f}  aim {aim:5.2f}" if bounded else ""
        print(f"{f'{what}: press to level, p50, {name}':<80} {p50 / plain50:5.2f} x{bounds}")
        print(f"  p50 {p50:.3f} p99 {p99:.3f} ms, beside p50 {plain50:.3f} p99 {plain99:.3f} ms, {len(took[way])} of each", flush=True)


def processor(process):
    """Seconds."""
    return sum(int(each.read_text().split()[0]) for each in pathlib.Path(f"/proc/{process.pid}/task").glob("*/schedstat")) / 1e9


def hundred_links():
    """What an agent takes while nothing happens: without links, and with them."""
    took = []
    with tempfile.TemporaryDirectory() as folder:
        world = World(pathlib.Path(folder), Scripted)
        try:
            world.agent("desk"), world.agent("lamp")
            agent = world.programs[-1]
            world.online()
            world.asipctl("pin", "desk", "2", "pullup")
            world.asipctl("send", "lamp/io", "mode", "3", "output")
            for wanted in (0, LINKS):
                for number in range(wanted):
                    world.asipctl("link", "desk/io/2", "lamp/io/3", "--name", f"l{number}", "--after", "1h")
                if wanted:
                    world.links(wanted)
                world.boards.pass_time(5)
                before = processor(agent)
                world.boards.pass_time(QUIET)
                took.append((memory([agent]), (processor(agent) - before) / QUIET))
        finally:
            world.end()
    (before, idle), (after, busy) = took
    print(f"{f'agent with {LINKS} links: memory beyond that without':<80} {(after - before) / 1e6:5.2f} MB  must  1.00  aim  0.50")
    print(f"{f'agent with {LINKS} links: processor, idle':<80} {busy * 100:5.3f} % core  must  0.10  aim  0.05")
    print(f"  {idle * 100:.3f} % without links", flush=True)


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    press_to_level(Simulated, "boards at 57600 baud", rounds)
    press_to_level(SteppedUp, "lines of agents stepped up", rounds)
    press_to_level(Scripted, "programs alone", rounds, bounded=False)
    hundred_links()


if __name__ == "__main__":
    main()
