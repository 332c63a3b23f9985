#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The pages that lead from nothing to the first success, literally, by a reader with a fresh Debian, sudo, and an empty folder.

    pages.py SYSTEM PAGE     SYSTEM: the container of tests/packages/debian, with /debs and /boot-loader.hex; PAGE: in-class, at-home, operate

`operate` also needs SYSTEM-hall, another machine. Each line behind a prompt is typed as it stands there, in its order. Not typed: `./run deb`, whose packages the test before has built,
and which are where it leaves them. The boards are simulated ones from the box: a boot loader and no sketch.
"""
import os
import pty
import re
import select
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from page_commands import commands_of, page_text  # noqa: E402

PORT = "/dev/serial/by-id/usb-Arduino__simulated_0001-if00"
BOARD = '{"name":"box","board":"nano","image":"/boot-loader.hex","link":"%s","reset_on_open":true,"parts":[' \
        '{"kind":"led","name":"light","pin":13},{"kind":"ultrasonic","name":"eye","trigger":7,"echo":7,"distance":42}]}' % PORT
LIMIT_S = 300


class Reader:
    def __init__(self, system):
        self.system = system
        # As `prepare` of tests/packages/inside: the first process of a container hears its own udev once it is executed again.
        self.root("for i in {1..600}; do ! test -S /run/udev/control || break; sleep 0.1; done; systemctl daemon-reexec; "
                  "for i in {1..600}; do ! systemctl is-system-running --quiet || break; sleep 0.1; done; systemctl is-system-running")
        self.root("apt-get -qq update && apt-get install -y -qq sudo")
        self.root("useradd --create-home --shell /bin/bash reader && echo 'reader ALL=(ALL) NOPASSWD: ALL' >/etc/sudoers.d/reader")
        self.root("mkdir -p /home/reader/asip/build && ln -s /debs /home/reader/asip/build/deb && chown -R reader /home/reader/asip")

    def root(self, command):
        done = subprocess.run(["podman", "exec", "-e", "DEBIAN_FRONTEND=noninteractive", self.system, "bash", "-c", command], text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT_S, check=False)
        if done.returncode != 0:
            raise SystemExit(f"# {command}\n{done.stdout}ended with {done.returncode}")
        return done.stdout

    def types(self, command, answers=None, until=None, meanwhile=lambda: None, fails=False):
        """On a terminal. `answers`: {what is asked: what is typed}; `until`: Ctrl-C once this is shown; `meanwhile` is done once it runs."""
        print(f"$ {command}", flush=True)
        asked = dict(answers or {})
        pid, terminal = pty.fork()
        if pid == 0:
            os.execvp("podman", ["podman", "exec", "-it", "--user", "reader", "-e", "HOME=/home/reader", "--workdir", "/home/reader/asip", self.system,
                                 "bash", "-c", command])
        meanwhile()
        shown, end = "", time.monotonic() + LIMIT_S
        while time.monotonic() < end:
            if not select.select([terminal], [], [], 0.2)[0]:
                continue
            try:
                part = os.read(terminal, 65536).decode(errors="replace")
            except OSError:
                break
            if not part:
                break
            shown += part
            for question in [each for each in asked if each in shown]:
                os.write(terminal, (asked.pop(question) + "\n").encode())
            if until and re.search(until, shown):
                os.write(terminal, b"\x03")
                until = None
        else:
            os.write(terminal, b"\x03")
        status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        os.close(terminal)
        shown = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", shown.replace("\r\n", "\n"))
        print("".join(f"    {line}\n" for line in shown.rstrip().split("\n")), end="", flush=True)
        if until or asked or (status != 0) != fails:
            raise SystemExit(f"{command}: ended with {status}; not seen: {until or list(asked)}")
        return shown

    def sees(self, what, command, seconds=60):
        """The reader looks again until it is so."""
        end = time.monotonic() + seconds
        while True:
            done = subprocess.run(["podman", "exec", "--user", "reader", self.system, "bash", "-c", command], capture_output=True, text=True, timeout=LIMIT_S, check=False)
            if re.search(what, done.stdout):
                return done.stdout
            if time.monotonic() > end:
                raise SystemExit(f"{command}: does not say \"{what}\":\n{done.stdout}{done.stderr}")
            time.sleep(0.5)

    def gets_a_board(self):
        """Simulated hardware: the simulator, an udev rule that says what the kernel says of an Arduino, a board without a sketch."""
        self.root("apt-get install -y -qq /debs/asip-sim_*.deb && cp /asip-test/69-simulated.rules /etc/udev/rules.d/ && udevadm control --reload")
        self.root(f"mkdir -p {os.path.dirname(PORT)} && echo '{BOARD}' >/box.json")
        self.root("systemd-run --quiet --unit=simulated-board -p StandardOutput=null asip-sim --no-socket /box.json")

    def plugs_it_in(self):
        self.root(f"until test -e {PORT}; do sleep 0.1; done; chgrp dialout {PORT} && chmod 660 {PORT}")
        self.root("udevadm trigger --action=add /sys/class/tty/ttyS0 && udevadm settle")


def install(reader, commands):
    assert commands[0] == "./run deb" and "apt install ./build/deb/" in commands[1], commands[:2]
    reader.types(commands[1], answers={"[Y/n]": "y"})
    return commands[2:]


def inline(beginning, text):
    """The commands within sentences that begin so."""
    return re.findall(f"`({beginning}[^`]*)`", re.sub(r"\s+", " ", text))


def in_class(reader, commands, text):
    flash, look, *commands = install(reader, commands)
    reader.gets_a_board()
    assert "flash --class" in flash, flash
    reader.types(flash, until=r"student-1 +loaded", meanwhile=reader.plugs_it_in)
    reader.sees("student-1 +online", look)
    reader.sees("(?i)<!doctype html", "bash -c 'exec 3<>/dev/tcp/127.0.0.1/8080; printf \"GET / HTTP/1.0\\r\\nHost: 127.0.0.1\\r\\n\\r\\n\" >&3; cat <&3'")
    for command in commands:
        reader.types(command.replace("student-2", "student-1"))  # one board stands for both
    # A pupil, from another computer: nothing without the code, and one board with it.
    reader.root("apt-get install -y -qq curl")
    json, outside = "-s -H 'Content-Type: application/json'", "http://$(hostname -I | cut -d' ' -f1):8080"
    reader.sees("a token is needed", f"curl -s {outside}/api/boards")
    code = re.search(r'"code":"(\w+)"', reader.sees('"free":1', f"curl {json} -d '{{\"boards\":[\"*\"]}}' http://127.0.0.1:8080/api/lessons"))[1]
    reader.sees('"board":"student-1"', f"curl {json} -c /tmp/pupil -d '{{\"code\":\"{code}\"}}' {outside}/api/join")
    reader.sees('"status":"ok"', f"curl {json} -b /tmp/pupil -d '[13,1]' {outside}/api/boards/student-1/services/io/commands/write")
    for command in inline(r"asipctl (?:stop|resume) ", text):
        reader.types(command)


def at_home(reader, commands, _):
    look, flash, *commands = install(reader, commands)
    reader.gets_a_board()
    reader.plugs_it_in()
    reader.sees("no ASIP sketch yet", look)
    reader.types(flash)
    reader.sees("uno1 +online", look)
    for command in commands:
        reader.types(command)
    reader.root("apt-get install -y -qq mosquitto-clients")
    shown = reader.sees('"Lamp"', "mosquitto_sub -t homeassistant/device/asip-uno1/config -C 1 -W 10")
    for word in ("Desk", "Office", "Distance 0"):
        assert word in shown, f"{word} is not in {shown}"
    reader.types("sudo asip-gateway export home-assistant --off")
    reader.sees("^$", "mosquitto_sub -t 'homeassistant/device/#' -C 1 -W 2")


def prompted(name, text):
    """What is typed at another machine."""
    return re.findall(rf"^ *{name}\$ (.*)$", text, re.M)


def copied(reader, other, name):
    other.root(f"cat >/home/reader/asip/{name} <<'TEXT'\n{reader.root(f'cat /etc/asip/bus/credentials/{name}')}TEXT")


def operate(reader, commands, text):
    secure, look, *commands = install(reader, commands)
    reader.root("echo '127.0.0.1 bus.example' >>/etc/hosts")
    reader.types(secure, answers={"[y/N]": "y"})
    reader.types(look)
    add_ann, add_board, *commands = commands
    # Ann and the board of the hall are at one other machine.
    other = Reader(f"{reader.system}-hall")
    other.root(f"echo '{reader.root('hostname -I').split()[0]} bus.example' >>/etc/hosts; cp /debs/*.deb /home/reader/asip/")
    reader.types(add_ann)
    copied(reader, other, "ann.credentials")
    get_tool, *use_file, sees = prompted("ann", text)
    other.types(get_tool, answers={"[Y/n]": "y"})
    for command in use_file:
        other.types(command)
    other.types(sees)
    get_agent, called, give_file, again = prompted("hall", text)
    other.types(get_agent, answers={"[Y/n]": "y"})
    other.gets_a_board()
    other.plugs_it_in()
    name = re.search(r"board=(\S+)", other.sees("board=", called))[1]
    shown = reader.types(add_board.replace("hall-1", name))
    assert f"{give_file} && {again}".replace("hall-1", name) in shown, "what it prints is what the page says"
    copied(reader, other, f"{name}.credentials")
    other.types(give_file.replace("hall-1", name))
    other.types(again)
    other.sees(f"{name} .*no ASIP sketch yet", sees)
    other.types(inline("asipctl flash ", text)[0].replace("hall-1", name))
    other.sees(f"{name} +online", sees)
    for command in commands:
        reader.types(command)
    for command in inline("sudo systemctl restart asip-registry", text):
        reader.types(command)
    reader.sees("asip.rules.yml", "ls -R /usr/share/asip")
    for command in inline("sudo asipctl backup", text):
        reader.types(command, answers={"Passphrase: ": "correct horse", "The same again: ": "correct horse"})


def main(system, page):
    text = page_text(f"start-{page}")
    commands = [f"python3 - <<'PROGRAM'\n{typed}PROGRAM" if language == "python" else typed for language, typed in commands_of(text)]
    {"in-class": in_class, "at-home": at_home, "operate": operate}[page](Reader(system), commands, text)
    print(f"start-{page}.md: each line did what it says")


if __name__ == "__main__":
    main(*sys.argv[1:])
