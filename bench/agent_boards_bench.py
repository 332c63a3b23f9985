#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a board costs an agent that serves several: memory and wake-ups while nothing happens, beside an agent for each board.

    bench_agent_boards [SECONDS]    for each number of boards; 60 when not given

The boards are scripted, at TCP ports of this process, and say nothing by themselves. Memory is the proportional set size: pages that
processes share count once.
"""

import asyncio
import contextlib
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import time

PROGRAMS = pathlib.Path(os.environ["ASIP_BUILD"]) / "bin"
ANSWERS = {
    "#,?": "@#,?,0,4,ATmega328P,20,Script",
    "#,N": "@#,N,3,{I:ASIP core IO,S:Servos,D:Distance}",
    "#,S": "@#,S,6,{@,@,I,I,S,D}",
    "#,X": "@#,X,2,{E:1,I:1}",
    "#,I": "@#,I,",
    "I,M": "@I,M,6,{4:1,4:2,4:4,4:8,4:10,3:1}",
    "I,m": "@I,m,1,{5:0}",
    "I,p": "@I,p,6{6,6,1,1,7,7}",
    "I,c": "@I,c,6,{1,1,1,5,1,3}",
}


async def board(reader, writer):
    """Until the agent hangs up, or all ends."""
    with contextlib.suppress(asyncio.CancelledError, ConnectionError):
        await answer_lines(reader, writer)
    writer.close()


async def answer_lines(reader, writer):
    while line := (await reader.readline()).decode(errors="replace").strip():
        if line.startswith("#,E,"):
            answer = "@" + line
        elif line in ANSWERS:
            answer = ANSWERS[line]
        elif line.startswith("#"):
            answer = f"~#,{line[2:3]},2{{UNKNOWN_REQUEST}}"
        else:
            continue
        writer.write((answer + "\r\n").encode())


def memory(processes):
    """Proportional set size in bytes."""
    total = 0
    for process in processes:
        for line in pathlib.Path(f"/proc/{process.pid}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                total += int(line.split()[1]) * 1024
    return total


def wake_ups(processes):
    """How often their threads waited and went on, and the processor time of all in seconds."""
    switches, seconds = 0, 0.0
    for process in processes:
        for status in pathlib.Path(f"/proc/{process.pid}/task").glob("*/status"):
            for line in status.read_text().splitlines():
                if line.startswith("voluntary_ctxt_switches:"):
                    switches += int(line.split()[1])
        fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        seconds += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return switches, seconds


class Bus:
    """A broker, and a client that hears which boards are online."""

    def __init__(self, folder):
        self.port = 20_000 + os.getpid() % 20_000
        conf = folder / "mosquitto.conf"
        conf.write_text(f"listener {self.port} 127.0.0.1\nallow_anonymous true\nset_tcp_nodelay true\nmax_queued_messages 0\n")
        path = f"{os.environ.get('PATH', '')}:/usr/sbin"
        self.broker = subprocess.Popen(["mosquitto", "-c", conf], stderr=subprocess.DEVNULL, env={**os.environ, "PATH": path})
        while self.broker.poll() is None:
            try:
                return socket.create_connection(("127.0.0.1", self.port)).close()
            except OSError:
                time.sleep(0.05)
        raise RuntimeError(f"mosquitto ended with status {self.broker.returncode}")

    async def online(self, boards, seconds=300):
        """Until so many boards are online."""
        for _ in range(seconds):
            asked = await asyncio.create_subprocess_exec(
                "mosquitto_sub", "-p", str(self.port), "-t", "asip/servicebus/+/$state", "-W", "1",
                stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL)
            heard, _ = await asked.communicate()
            if heard.count(b"online") == boards:
                return
        raise RuntimeError(f"not all of {boards} boards are online")


async def measure(bus, agents, boards, seconds):
    """Memory in bytes, wake-ups a second and share of a processor of all boards together."""
    try:
        await bus.online(boards)
        await asyncio.sleep(5)
        before, busy_before = wake_ups(agents)
        await asyncio.sleep(seconds)
        after, busy = wake_ups(agents)
        return memory(agents), (after - before) / seconds, (busy - busy_before) / seconds
    finally:
        for agent in agents:
            agent.terminate()
        for agent in agents:
            agent.wait()


def start(arguments):
    return subprocess.Popen([PROGRAMS / "asip-agent", *arguments], stderr=subprocess.DEVNULL)


def row(what, boards, memory_bytes, wakes, busy):
    print(f"{what:<28} {boards:>6} {memory_bytes / 1e6:>10.2f} {memory_bytes / boards / 1e3:>12.0f} "
          f"{wakes / boards:>14.2f} {busy * 1e3 / boards:>14.2f}", flush=True)


async def run(seconds, folder):
    bus = Bus(folder)
    servers = [await asyncio.start_server(board, "127.0.0.1", 0) for _ in range(100)]
    ports = [server.sockets[0].getsockname()[1] for server in servers]
    state = ["--state-dir", str(folder / "state")]
    print(f"{'':<28} {'boards':>6} {'memory MB':>10} {'kB a board':>12} {'wake-ups/s':>14} {'ms CPU/s':>14}")
    try:
        agents = [start(["--broker", f"127.0.0.1:{bus.port}", "--tcp", f"127.0.0.1:{port}", "--name", f"alone-{i}", *state])
                  for i, port in enumerate(ports[:10])]
        row("an agent for each board", 10, *await measure(bus, agents, 10, seconds))
        one = None
        for boards in (1, 10, 100):
            conf = folder / "boards.conf"
            conf.write_text(f"broker = 127.0.0.1:{bus.port}\n" + "".join(
                f"[board many-{i}]\ntcp = 127.0.0.1:{port}\n" for i, port in enumerate(ports[:boards])))
            figures = await measure(bus, [start(["--config", str(conf), *state])], boards, seconds)
            row("one agent for all", boards, *figures)
            one = one or figures[0]
            if boards > 1:
                print(f"{'  each beyond the first':<28} {'':>6} {'':>10} {(figures[0] - one) / (boards - 1) / 1e3:>12.0f} kB"
                      "    must 400 kB, aim 150 kB")
    finally:
        bus.broker.terminate()
        bus.broker.wait()
        for server in servers:
            server.close()


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60
    with tempfile.TemporaryDirectory() as folder:
        asyncio.run(run(seconds, pathlib.Path(folder)))


if __name__ == "__main__":
    main()
