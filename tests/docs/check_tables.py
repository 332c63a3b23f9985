# SPDX-License-Identifier: Apache-2.0
"""What pages claim in tables and links, compared with the files and programs that they are about: check_tables.py ROOT BIN"""
import glob
import os
import re
import subprocess
import sys

import yaml


def rows(page, heading):
    """Rows of the table whose first heading this is, as lists of cells."""
    found = re.search(rf"^\| *{re.escape(heading)} *\|.*\n\|[ |-]+\n((\|.*\n)+)", page, re.M)
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1]] for row in found[1].splitlines()] if found else []


def codes(cell):
    return re.findall(r"`([^`]+)`", cell)


class Tables:
    def __init__(self, root, programs):
        self.root, self.programs, self.faults = root, programs, []

    def text(self, name):
        with open(os.path.join(self.root, name)) as file:
            return file.read()

    def expect(self, holds, fault):
        self.faults.extend([] if holds else [fault])

    def compose(self):
        page, compose = self.text("docs/containers.md"), self.text("compose.yaml")
        used = dict(re.findall(r"\$\{(\w+):-([^}]*)\}", compose))
        told = {codes(row[0])[0]: "".join(codes(row[1])) for row in rows(page, "variable") if codes(row[0])}
        for name, default in used.items():
            self.expect(told.get(name) == default, f"docs/containers.md: {name} of compose.yaml has the default \"{default}\", not \"{told.get(name)}\"")
        volumes = {name for row in rows(page, "volume") for name in codes(row[0])}
        there = set(yaml.safe_load(compose)["volumes"])
        self.expect(volumes == there, f"docs/containers.md: volumes {sorted(volumes ^ there)} stand there or in compose.yaml only")

    def services(self):
        page = self.text("docs/run-as-services.md")
        told = {row[0] for row in rows(page, "status")}
        kept = {status for unit in glob.glob(os.path.join(self.root, "packaging/systemd/*.service"))
                for status in re.search(r"^RestartPreventExitStatus=(.*)$", open(unit).read(), re.M)[1].split()}
        self.expect(told == kept, f"docs/run-as-services.md: statuses {sorted(told)}; units are not started again after {sorted(kept)}")
        own = {meaning.split()[0] for meaning in self.help("asip-registry").split("Exit status:")[1].split(";")}
        registry = re.search(r"^RestartPreventExitStatus=(.*)$", self.text("packaging/systemd/asip-registry.service"), re.M)[1].split()
        self.expect(set(registry) <= own, f"asip-registry.service: ends with {sorted(own)}, is not started again after {registry}")
        made = set(re.findall(r"^d (/run/\S+) \d+ asip asip", self.text("packaging/systemd/asip.tmpfiles"), re.M))
        for name in glob.glob(os.path.join(self.root, "docs/*.md")):
            used = set(re.findall(r"(?<![\w.])/run/[a-z]+", open(name).read()))
            self.expect(used <= made, f"{name}: {sorted(used - made)} is made by no line of asip.tmpfiles")
        packages = re.findall(r"^Package: (.*)$", self.text("debian/control"), re.M)
        told = {name for row in rows(page, "package") for name in codes(row[0])}
        self.expect(told == set(packages), f"docs/run-as-services.md: packages {sorted(told ^ set(packages))} stand there or in debian/control only")

    def help(self, program):
        return subprocess.run([os.path.join(self.programs, program), "--help-all"], capture_output=True, text=True, timeout=30, check=True).stdout

    def options(self):
        page, text = self.help("asip-registry"), self.text("docs/asip-registry.md")
        for row in rows(text, "option"):
            told = codes(row[1]) or re.findall(r"^[\d,]+$", row[1])
            for option, default in zip((code.split()[0] for code in codes(row[0])), told):
                # TEXT=7d by CLI11 2.1, TEXT [7d] by 2.4; before it there may be a range. Settings of the file: NAME = 7d.
                there = re.search(rf"{option} [^=\n\[]*(?:\[[^\]\n]* - [^\]\n]*\])?(?:=| ?\[)([^\s\]]+)"
                                  if option.startswith("--") else rf"^  {option} = (\S+)$", page, re.M)
                self.expect(there and there[1].replace(",", "") == default.replace(",", ""), f"docs/asip-registry.md: {option} has the default {there and there[1]}, not {default}")

    def messages(self):
        """What a program is said to print is somewhere in its sources."""
        sources = "".join(open(name).read() for folder in ("agent", "asip") for name in glob.glob(os.path.join(self.root, folder, "**/*.cpp"), recursive=True))
        shown = re.sub(r"\"\s*\n\s*\"", "", sources)
        for row in rows(self.text("docs/containers.md"), "what you see"):
            for part in [part.strip() for code in codes(row[0]) for part in code.split("/dev/board")]:
                self.expect(part in shown, f"docs/containers.md: nothing prints \"{part}\"")


    def pages(self):
        """No line of prose is longer than 160 characters, and each link within the project leads to a file and heading that exist."""
        names = ["README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md"] + sorted(
            os.path.relpath(each, self.root) for each in glob.glob(os.path.join(self.root, "docs", "*.md")))
        prose = {name: re.sub(r"^ *```.*?^ *```", lambda block: "\n" * block[0].count("\n"), self.text(name), flags=re.M | re.S) for name in names}
        anchors = {name: {re.sub(r"[^\w -]", "", each.lower()).replace(" ", "-") for each in re.findall(r"^#+ (.*)$", text, re.M)} for name, text in prose.items()}
        for name, text in prose.items():
            for number, line in enumerate(text.split("\n"), 1):
                self.expect(len(line) <= 160 or line.lstrip().startswith(("|", "<")), f"{name}:{number}: longer than 160 characters")
            for target in re.findall(r"\]\(([^)\s]+)\)", text):
                if re.match(r"\w+:", target):
                    continue
                path, _, anchor = target.partition("#")
                page = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
                self.expect(os.path.exists(os.path.join(self.root, page)), f"{name}: {target} leads nowhere")
                self.expect(not anchor or page not in anchors or anchor in anchors[page], f"{name}: {target}: no such heading")


def main(root, programs):
    tables = Tables(root, programs)
    for check in (tables.compose, tables.services, tables.options, tables.messages, tables.pages):
        check()
    print("\n".join(tables.faults + [f"{len(tables.faults)} faults"]))
    return 1 if tables.faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
