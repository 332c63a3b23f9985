# SPDX-License-Identifier: Apache-2.0
"""A whole bus on a broker that `asipctl secure` made. Each program has the credentials of its role and no others."""

import os
import shutil
import subprocess

from bus import BIN, Bus, can_connect, eventually


class SecuredBus(Bus):
    users = (("board", "desk", "lamp"), ("registry",), ("gateway",))
    """Who is on it beside the administrator: roles and names."""
    sources = ()
    """Boards whose agents hear other ones, and these."""

    def secure(self, *words):
        return subprocess.run([str(BIN / "asipctl"), "secure", "--dir", str(self.work / "bus"), *words], check=True,
                              capture_output=True, text=True, timeout=60).stdout

    def credentials(self, name):
        return self.work / "bus" / "credentials" / f"{name}.credentials"

    def user(self, name):
        """User, password and the certificate of the authority."""
        text = self.credentials(name).read_text()
        said = dict(line.split(" = ", 1) for line in text.splitlines() if " = " in line)
        return said["user"], said["password"], text[text.index("-----BEGIN"):]

    def start_broker(self):
        self.secure("init", "--yes", "--host", "127.0.0.1", "--port", str(self.broker_port))
        for role_and_names in self.users:
            self.secure("add", *role_and_names)
        for board_and_sources in self.sources:
            self.secure("link", *board_and_sources)
        config = self.work / "bus" / "mosquitto.conf"
        if os.geteuid() == 0:
            # It would become another user, for whom this folder is closed.
            config.write_text(config.read_text() + "user root\n")
        program = shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin")
        self.start("broker", program, "-c", str(config))
        eventually(lambda: can_connect(self.broker_port), "the broker's port")

    def start(self, name, program, *arguments):
        own = self.credentials(name.removeprefix("agent-"))
        super().start(name, program, *arguments, *(("--credentials", str(own)) if own.exists() else ()))
