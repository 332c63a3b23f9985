# SPDX-License-Identifier: Apache-2.0
"""A bus whose gateway exports its boards, and a peer of that export that is written in another language."""

import json
import pathlib
import queue
import subprocess
import threading

from bus import Bus, die_with_parent, eventually


class ExportBus(Bus):
    export = ()
    """The options of the gateway that begin the export."""

    def start_gateway(self, *more):
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", *self.export, *more)
        eventually(lambda: self.get("/readyz"), "the gateway")

    def start_agent(self, board):
        """Values come because the export wants them."""
        port = self.work / f"{board}.port"
        eventually(port.exists, f"the port of {board}")
        self.start(f"agent-{board}", "asip-agent", "--serial", str(port), "--name", board, "--lease", "6", "--no-step-up",
                   "--patience", "60", "--reports", "on-demand")


class Peer:
    """A program that takes tasks, {TASK: ARGUMENT} a line, and answers each by a line of JSON behind "="."""

    def __init__(self, script: pathlib.Path, *arguments, program=("node",)):
        self.process = subprocess.Popen([*program, str(script), *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        preexec_fn=die_with_parent)
        self.answers = queue.Queue()
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stdout:
            if line.startswith("="):
                self.answers.put(json.loads(line[1:]))

    def ask(self, task, argument):
        self.process.stdin.write(json.dumps({task: argument}) + "\n")
        self.process.stdin.flush()

    def answer(self):
        return self.answers.get(timeout=60)

    def __call__(self, task, argument=0):
        self.ask(task, argument)
        answer = self.answer()
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer.get("value")

    def close(self):
        self.process.stdin.close()
        self.process.wait(20)
        self.process.stdout.close()
