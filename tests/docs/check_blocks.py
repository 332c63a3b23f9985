# SPDX-License-Identifier: Apache-2.0
"""Each block of the documentation is run, or stands in blocks.txt with what checks it or why nothing does.

    check_blocks.py ROOT BIN PAGE...    PAGE: a page whose console blocks are run

What a line of blocks.txt may name behind the block's first line (or the beginning of it):

    compose        the files and commands of docker compose agree with compose.yaml
    json, json lines, yaml, xml    is such a text; "..." in it stands for more
    agent          the agent reads this configuration
    load script    asip-load reads it
    in FILE        FILE has the block, word for word
    names WORD in FILE    the block and FILE have the word
    tested: FILE   FILE, which names the page, tests it
    figure: WHY    nothing that a reader types
    not run: WHY

Whatever the line says, and in pages that are run, too: each option, verb, unit, script and file of this project that a
command names is there.
"""
import glob
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import textwrap
import xml.etree.ElementTree

import yaml

FORMATS = {"json": json.loads, "json lines": lambda text: [json.loads(line) for line in text.split("\n")], "yaml": yaml.safe_load,
           "xml": xml.etree.ElementTree.fromstring}
WITH_HELP_ALL = {("asip-agent",), ("asip-gateway",), ("asip-registry",)}
PROGRAMS = "asipctl asip-agent asip-gateway asip-load asip-registry asip-sim".split()


class Block:
    def __init__(self, page, line, language, lines):
        self.page, self.line, self.language, self.lines = page, line, language, lines
        self.first = lines[0].strip() if lines else ""

    def where(self):
        return f"{self.page}:{self.line}"

    def commands(self):
        """What is typed: behind a prompt, or all of a block of a shell, or lines that begin with a program of ours."""
        prompted = [typed[1] for typed in (re.match(r" *[a-z]*\$ (.*)", line) for line in self.lines) if typed]
        if self.language == "console":
            return prompted + [line.strip()[2:] for line in self.lines if re.match(r" *# ", line)]
        if self.language == "sh":
            return prompted or [line.strip() for line in self.lines]
        own = r" *(\./run|docker|(build/dev/bin/)?(" + "|".join(PROGRAMS) + r")) "
        return prompted + [line.strip() for line in self.lines if self.language == "" and re.match(own, line)]


def blocks_of(root, page):
    lines = open(os.path.join(root, page)).read().split("\n")
    i = 0
    while i < len(lines):
        fence = re.match(r" *```(\S*)", lines[i])
        if fence:
            end = next(j for j in range(i + 1, len(lines)) if re.match(r" *```$", lines[j]))
            yield Block(page, i + 2, fence[1], lines[i + 1:end])
            i = end
        i += 1


class Checks:
    def __init__(self, root, programs):
        self.root, self.programs = root, programs
        self.faults, self.helps = [], {}
        compose = yaml.safe_load(self.text("compose.yaml"))
        self.services, self.volumes = compose["services"], compose["volumes"]
        self.profiles = {profile for service in self.services.values() for profile in service.get("profiles", [])}
        self.targets = set(re.findall(r"^FROM .* AS (\S+)", self.text("docker/Containerfile"), re.M))
        self.installed = {"/usr/share/doc/asip-agent/examples/board.env.example"}
        for name in glob.glob(os.path.join(root, "debian/*.install")):
            for entry in open(name):
                source, target = (entry.split() + [""])[:2]
                self.installed.update({"/" + source} if source.startswith("usr/") else ())
                self.installed.add("/" + (os.path.join(target, os.path.basename(source)) if target else source))

    def text(self, name):
        with open(os.path.join(self.root, name)) as file:
            return file.read()

    def has(self, name):
        return os.path.exists(os.path.join(self.root, name))

    def fault(self, block, what):
        self.faults.append(f"{block.where()}: {what}")

    def help(self, words):
        words = tuple(words)
        if words not in self.helps:
            helps = ["help", "all"] if words == ("asipctl",) else ["--help-all" if words in WITH_HELP_ALL else "--help"]
            done = subprocess.run([os.path.join(self.programs, words[0]), *words[1:], *helps], capture_output=True, text=True, timeout=30)
            self.helps[words] = done.stdout if done.returncode == 0 else None
        return self.helps[words]

    def command(self, block, text):
        """One line as it is typed: each part of it that is ours."""
        text = re.sub(r"(^| )#(=>)? .*$", "", text)
        try:
            lexer = shlex.shlex(text, posix=True, punctuation_chars=True)
            lexer.whitespace_split = True
            words = list(lexer)
        except ValueError:
            words = text.split() # goes on in the next line
        part = []
        for word in words + [";"]:
            if re.fullmatch(r"[|;&()<>]+", word):
                self.simple_command(block, part)
                part = []
            else:
                part.append(word)

    def simple_command(self, block, words):
        while words and (words[0] in ("sudo", "exec", "then", "do", "until", "while", "time") or re.match(r"[A-Z_]+=", words[0])):
            words = words[1:]
        if not words:
            return
        name = os.path.basename(words[0])
        if name in PROGRAMS:
            self.our_program(block, name, words[1:])
        elif words[0] == "./run":
            if not re.search(rf"^ *([\w|]+\|)?{re.escape(words[1])}(\|[\w|]+)?\)", self.text("run"), re.M):
                self.fault(block, f"./run has no {words[1]}")
        elif name in ("systemctl", "journalctl"):
            self.units(block, words)
        elif name in ("docker", "docker-compose"):
            self.docker(block, words[1:])
        for word in words:
            if re.match(r"/(usr/share|lib|usr/lib)/(asip|doc/asip)", word) and not any(
                    word == there or word.startswith(there + "/") or there.startswith(word.rstrip("/") + "/") for there in self.installed):
                self.fault(block, f"no package has {word}")

    def our_program(self, block, name, words):
        verbs, page = [name], self.help([name])
        for word in words:
            if word.startswith("-") or page is None:
                break
            deeper = re.search(rf"^  {re.escape(word)}(,| )", page, re.M) and self.help(verbs + [word])
            if not deeper:
                break
            verbs, page = verbs + [word], deeper
        if page is None:
            return self.fault(block, f"{name} is not built")
        if len(verbs) == 1 and name == "asipctl" and words and not words[0].startswith("-"):
            self.fault(block, f"asipctl has no {words[0]}")
        for word in words:
            option = re.match(r"--[a-z][a-z-]*", word)
            if option and not any(re.search(rf"(^|[ ,]){option[0]}(,| |=|\n|$)", self.help(verbs[:i]), re.M) for i in range(1, len(verbs) + 1)):
                self.fault(block, f"{' '.join(verbs)} has no option {option[0]}")

    def units(self, block, words):
        for word in words[1:]:
            unit = re.match(r"(asip-[a-z]+)(@?)", word)
            if unit and not self.has(f"packaging/systemd/{unit[1]}{unit[2]}.service"):
                if not re.search(rf"systemctl edit .*--full {re.escape(word)}", self.text(block.page)):
                    self.fault(block, f"no package has the unit {word}")

    def docker(self, block, words):
        if words[:1] == ["build"]:
            named = {"--target": self.targets, "-f": {"docker/Containerfile"}}
            for option, value in zip(words, words[1:]):
                if option in named and value not in named[option]:
                    self.fault(block, f"docker build: no {value}")
        if words[:1] != ["compose"]:
            return
        services = dict(self.services)
        words = words[1:]
        while words and words[0].startswith("-"):
            option, value, words = words[0], words[1], words[2:]
            if option == "--profile" and value not in self.profiles:
                self.fault(block, f"compose.yaml has no profile {value}")
            if option == "-f" and not self.has(value):
                written = [other for other in blocks_of(self.root, block.page) if other.language == "yaml" and f"`{value}`" in self.text(block.page)]
                if not written:
                    self.fault(block, f"no file {value}")
                for other in written:
                    services.update(yaml.safe_load("\n".join(other.lines))["services"])
        if words and words[0] in ("exec", "run", "restart", "logs"):
            service = next((word for word in words[1:] if not word.startswith("-")), None)
            if service and service not in services:
                self.fault(block, f"compose.yaml has no service {service}")

    def compose_file(self, block):
        for name, service in yaml.safe_load("\n".join(block.lines))["services"].items():
            build = service.get("build", {})
            if build.get("target") not in self.targets or not self.has(build.get("dockerfile", "")) or service["image"] != f"asip-{build['target']}":
                self.fault(block, f"service {name} is built from what is not there: {build}")
            for volume in service.get("volumes", []):
                if not volume.startswith(("./", "/")) and volume.split(":")[0] not in self.volumes:  # those are files of the host
                    self.fault(block, f"compose.yaml has no volume {volume}")
            for option in [word for word in service.get("command", []) if word.startswith("--")]:
                if option not in (self.help(["asip-agent"]) or ""):
                    self.fault(block, f"asip-agent has no option {option}")

    def agent_reads(self, block):
        with tempfile.NamedTemporaryFile("w", suffix=".conf") as file:
            file.write(re.sub(r"^broker = .*", "broker = 127.0.0.1:1", "\n".join(block.lines), flags=re.M))
            file.flush()
            try:
                done = subprocess.run([os.path.join(self.programs, "asip-agent"), "--config", file.name], capture_output=True, text=True, timeout=1)
                self.fault(block, f"the agent ends with {done.returncode}: {done.stderr}")
            except subprocess.TimeoutExpired as waits:
                for board in re.findall(r"\[board (\w+)\]", "\n".join(block.lines)):
                    if board not in (waits.stderr or b"").decode():
                        self.fault(block, f"the agent does not speak of board {board}")

    def load_reads(self, block):
        with tempfile.NamedTemporaryFile("w", suffix=".load") as file:
            file.write("\n".join(block.lines))
            file.flush()
            done = subprocess.run([os.path.join(self.programs, "asip-load"), "--broker", "127.0.0.1:1", "--time", "1s", "--script", file.name],
                                  capture_output=True, text=True, timeout=60)
            if "is over before" not in done.stderr: # what it says when it has read all of it
                self.fault(block, f"asip-load: {done.stderr}")

    def listed(self, block, how):
        kind, _, rest = how.partition(": ")
        names = re.fullmatch(r"names (\S+) in (\S+)", how)
        text = textwrap.dedent("\n".join(block.lines))
        if kind in FORMATS:
            try:
                FORMATS[kind](text)
            except (ValueError, yaml.YAMLError, xml.etree.ElementTree.ParseError) as error:
                self.fault(block, f"is no {kind}: {error}")
        elif kind == "compose":
            if block.language == "yaml":
                self.compose_file(block)
            elif not any("docker" in command for command in block.commands()):
                self.fault(block, "has no command of docker")
        elif names:
            if names[1] not in text or names[1] not in self.text(names[2]):
                self.fault(block, f"{names[1]} is not in {names[2]}")
        elif kind == "load script":
            self.load_reads(block)
        elif kind == "agent":
            self.agent_reads(block)
        elif kind.startswith("in "):
            if text not in self.text(kind[3:]):
                self.fault(block, f"{kind[3:]} has another text")
        elif kind == "tested":
            if not self.has(rest) or os.path.basename(block.page) not in self.text(rest):
                self.fault(block, f"{rest} does not name {block.page}")
        elif kind not in ("figure", "not run") or not rest:
            self.fault(block, f"blocks.txt: what is \"{how}\"?")


def entries(name):
    for number, line in enumerate(open(name), 1):
        if line.strip() and not line.startswith("#"):
            page, first, how = (part.strip() for part in line.split(" | ", 2))
            yield number, page, first, how


def main(root, programs, run):
    checks = Checks(root, programs)
    listed = list(entries(os.path.join(os.path.dirname(__file__), "blocks.txt")))
    used, blocks = set(), 0
    pages = ["README.md", "CONTRIBUTING.md", "SECURITY.md"] + [f"docs/{name}" for name in sorted(os.listdir(os.path.join(root, "docs"))) if name.endswith(".md")]
    for page in pages:
        for block in blocks_of(root, page):
            blocks += 1
            found = [entry for entry in listed if entry[1] == page and block.first.startswith(entry[2])]
            if not found or not found[0][3].startswith("figure"):
                for command in block.commands():
                    checks.command(block, command)
            if page in run and block.language == "console":
                continue
            if not found:
                checks.fault(block, f"is neither run nor in tests/docs/blocks.txt: {block.first}")
            for number, _, _, how in found[:1]:
                used.add(number)
                checks.listed(block, how)
    for number, page, first, _ in listed:
        if number not in used:
            checks.faults.append(f"tests/docs/blocks.txt:{number}: {page} has no such block: {first}")
    print("\n".join(checks.faults + [f"{blocks} blocks, {len(checks.faults)} faults"]))
    return 1 if checks.faults or not blocks else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))
