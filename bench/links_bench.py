#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a link takes from a press on one board to the level on another, beside plain MQTT programs and beside the ports alone, and what a
hundred links cost an agent.

    bench_links [ROUNDS]    so many rounds of 200 presses of each, 5 when not given; of each the best round counts

The boards are scripted, at TCP ports of this process. Plain MQTT: mosquitto_pub sends each line of one board, mosquitto_sub gives it to
the other. The ports alone: a program reads one and writes the other.
"""

import asyncio
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

from agent_boards_bench import ANSWERS, PROGRAMS, Bus, memory, start, wake_ups

PRESSES = 200
LINKS = 100
QUIET = 20  # seconds that an idle agent is watched
RELAY = """
import socket, sys
a, b = (socket.create_connection(("127.0.0.1", int(port))) for port in sys.argv[1:])
b.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
while data := a.recv(4096): b.sendall(data)
"""


class Board:
    """Pins 2 and 3 share a port; it answers what an agent asks, and tells the rest."""

    def __init__(self):
        self.heard, self.writer = asyncio.Queue(), None

    async def serve(self):
        self.server = await asyncio.start_server(self.connected, "127.0.0.1", 0)
        self.port = self.server.sockets[0].getsockname()[1]
        return self

    async def connected(self, reader, writer):
        self.writer = writer
        while line := (await reader.readline()).decode(errors="replace").strip():
            answer = "@" + line if line.startswith("#,E,") else ANSWERS.get(line)
            if answer is None and line.startswith("#"):
                answer = f"~#,{line[2:3]},2{{UNKNOWN_REQUEST}}"
            if answer is None:
                self.heard.put_nowait(line)
            else:
                writer.write((answer + "\r\n").encode())
        writer.close()

    def level(self, on):
        self.writer.write(f"@I,d,4,{4 if on else 0}\r\n".encode())


async def presses(press, came):
    """Seconds from each press until it came, the median."""
    took = []
    for number in range(PRESSES):
        began = time.perf_counter()
        press(number % 2 == 0)
        await asyncio.wait_for(came(number % 2 == 0), 20)
        took.append(time.perf_counter() - began)
        await asyncio.sleep(0.06)  # twenty a second are a flood, and a pin bounces
    return statistics.median(took)


async def asipctl(bus, *words):
    done = await asyncio.create_subprocess_exec(PROGRAMS / "asipctl", "--broker", f"127.0.0.1:{bus.port}", *words,
                                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    _, errors = await done.communicate()
    if done.returncode:
        raise RuntimeError(f"asipctl {' '.join(words)}: {errors.decode()}")


async def wrote(board, on):
    while await board.heard.get() != f"I,d,3,{int(on)}":
        pass


async def shown(bus, wanted):
    """Until the links of lamp are so many, and each hears its source."""
    for _ in range(100):
        asked = await asyncio.create_subprocess_exec("mosquitto_sub", "-p", str(bus.port), "-t", "asip/lamp/$links", "-C", "1", "-W", "2",
                                                     stdout=asyncio.subprocess.PIPE)
        heard, _ = await asked.communicate()
        links = json.loads(heard or b'{"links":[]}')["links"]
        if len(links) == wanted and not any("fault" in link for link in links):
            return
    raise RuntimeError(f"there are not {wanted} links that hear their source")


async def linked(bus, agents, rounds, desk, lamp):
    """The median of the best round; the agents end."""
    try:
        await bus.online(2)
        await asipctl(bus, "pin", "desk", "2", "input")
        await asipctl(bus, "pin", "lamp", "3", "low")
        desk.level(False)
        await asipctl(bus, "link", "desk/io/2", "lamp/io/3", "--name", "l")
        await shown(bus, 1)
        return min([await presses(desk.level, lambda on: wrote(lamp, on)) for _ in range(rounds)])
    finally:
        await asipctl(bus, "link", "remove", "lamp/l")
        for agent in agents:
            agent.terminate()
            agent.wait()


async def plain_mqtt(bus, rounds):
    sub = await asyncio.create_subprocess_exec("mosquitto_sub", "-p", str(bus.port), "-q", "1", "-t", "press", stdout=asyncio.subprocess.PIPE)
    pub = await asyncio.create_subprocess_exec("mosquitto_pub", "-p", str(bus.port), "-q", "1", "-t", "press", "-l", stdin=asyncio.subprocess.PIPE)

    async def came(on):
        while await sub.stdout.readline() != b"I,d,3,%d\n" % on:
            pass
    try:
        while True:  # until they are connected
            pub.stdin.write(b"I,d,3,0\n")
            try:
                await asyncio.wait_for(came(False), 1)
                break
            except asyncio.TimeoutError:
                pass
        return min([await presses(lambda on: pub.stdin.write(b"I,d,3,%d\n" % on), came) for _ in range(rounds)])
    finally:
        for program in (sub, pub):
            program.terminate()
            await program.wait()


async def ports_alone(rounds, desk, lamp):
    relay = subprocess.Popen([sys.executable, "-c", RELAY, str(desk.port), str(lamp.port)])
    try:
        while not (desk.writer and lamp.writer):
            await asyncio.sleep(0.01)

        async def came(on):
            while await lamp.heard.get() != f"@I,d,4,{4 if on else 0}":
                pass
        return min([await presses(desk.level, came) for _ in range(rounds)])
    finally:
        relay.terminate()
        relay.wait()


async def hundred_links(bus, agents):
    """Bytes, and share of a processor, of the agent of lamp while nothing happens: without links, and with them."""
    figures = []
    for wanted in (0, LINKS):
        for number in range(wanted):
            await asipctl(bus, "link", "desk/io/2", "lamp/io/3", "--name", f"l{number}", "--after", "1h")
        if wanted:
            await shown(bus, wanted)
        await asyncio.sleep(2)
        before = wake_ups(agents)
        await asyncio.sleep(QUIET)
        after = wake_ups(agents)
        figures.append((memory(agents), (after[1] - before[1]) / QUIET))
    return figures


def ratio(what, took, beside, name, must, aim):
    print(f"{what:<76} {took / beside:5.2f} x  must {must:5.2f}  aim {aim:5.2f}", flush=True)
    print(f"  {took * 1e3:.2f} ms, {name} {beside * 1e3:.2f} ms, medians of {PRESSES}", flush=True)


async def run(rounds, folder):
    bus = Bus(folder)

    def agent(board, port, *more):
        return start(["--broker", f"127.0.0.1:{bus.port}", "--tcp", f"127.0.0.1:{port}", "--name", board, "--state-dir", str(folder / "state"), *more])
    desk, lamp = await Board().serve(), await Board().serve()
    try:
        plain = await plain_mqtt(bus, rounds)
        alone = await ports_alone(rounds, desk, lamp)
        two = await linked(bus, [agent("desk", desk.port), agent("lamp", lamp.port)], rounds, desk, lamp)
        ratio("press on one board to the line of another, p50, two agents, over plain MQTT", two, plain, "mosquitto_pub and mosquitto_sub", 1.1, 0.9)
        conf = folder / "boards.conf"
        conf.write_text(f"broker = 127.0.0.1:{bus.port}\nstate-dir = {folder / 'state'}\n" +
                        "".join(f"[board {name}]\ntcp = 127.0.0.1:{board.port}\n" for name, board in (("desk", desk), ("lamp", lamp))))
        one = await linked(bus, [start(["--config", str(conf)])], rounds, desk, lamp)
        ratio("the same, one agent, over the ports alone", one, alone, "a program between them", 1.3, 1.1)
        of_desk, of_lamp = agent("desk", desk.port), agent("lamp", lamp.port)
        await bus.online(2)
        (before, _), (after, busy) = await hundred_links(bus, [of_lamp])
        print(f"{f'agent with {LINKS} links: memory beyond that without':<76} {(after - before) / 1e6:5.2f} MB  must  1.00  aim  0.50")
        print(f"{f'agent with {LINKS} links: processor, idle':<76} {busy * 100:5.2f} % core  must  0.10  aim  0.05", flush=True)
        for each in (of_desk, of_lamp):
            each.terminate()
            each.wait()
    finally:
        bus.broker.terminate()
        bus.broker.wait()


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with tempfile.TemporaryDirectory() as folder:
        asyncio.run(run(rounds, pathlib.Path(folder)))


if __name__ == "__main__":
    main()
