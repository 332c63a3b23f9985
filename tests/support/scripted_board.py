# SPDX-License-Identifier: Apache-2.0
"""A board that is a few lines of text: with pins and a distance sensor."""

import contextlib
import socket
import threading
import time


class ScriptedBoard:
    """At a TCP port of this process: answers what an agent asks, and says what it is told to."""

    ANSWERS = {
        "#,?": "@#,?,0,4,ATmega328P,6,Script", "#,X": "@#,X,2,{E:1,I:1}", "#,I": "@#,I,",
        "I,M": "@I,M,6,{4:1,4:2,4:4,4:8,4:10,3:1}", "I,m": "@I,m,1,{5:0}", "I,p": "@I,p,6,{1,1,1,1,1,7}", "I,c": "@I,c,6,{1,1,1,1,1,3}",
        "#,N": "@#,N,2,{I:ASIP core IO,D:Distance}", "#,S": "@#,S,6,{I,I,I,I,I,D}",
    }

    def __init__(self):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        self.socket = None
        threading.Thread(target=self.run, daemon=True).start()

    def answer(self, line):
        if line.startswith("#,E,"):
            return "@" + line
        if line in self.ANSWERS:
            return self.ANSWERS[line]
        return f"~#,{line[2:3]},2{{UNKNOWN_REQUEST}}" if line.startswith("#") else None

    def run(self):
        with contextlib.suppress(OSError):
            while True:
                accepted, _ = self.server.accept()
                if self.socket:
                    self.socket.close()
                self.socket = accepted
                self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                with contextlib.suppress(OSError):
                    self.serve()

    def serve(self):
        """One agent, until it hangs up."""
        for line in self.socket.makefile(errors="replace"):
            if answer := self.answer(line.strip()):
                self.say(answer)

    def say(self, line):
        """Returns when."""
        now = time.monotonic()
        self.socket.sendall((line + "\r\n").encode())
        return now

    def close(self):
        self.server.close()
        if self.socket:
            self.socket.close()
