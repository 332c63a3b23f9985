#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No shell script pipes into `grep -q`.

It ends at the first line that matches; the program before it is then ended by SIGPIPE, and with `pipefail` the line that was found
counts as missing. Whether that happens depends on how fast both are. `grep ... >/dev/null` reads to the end.

    pipes.py FOLDER [--try]     the project's; --try: on a script that does it, and is found
"""
import os
import re
import sys
from pathlib import Path

QUIET_GREP = re.compile(r"(?<!\|)\|\s*grep\s+(?:-\S+\s+)*?-(?:[a-zA-Z]*q|-quiet|-silent)")
SCRIPT = re.compile(r"#!.*\b(?:ba|da)?sh\b")


def found(name, text):
    return [f"{name}:{number}: {line.strip()}" for number, line in enumerate(text.splitlines(), 1)
            if QUIET_GREP.search(line) and not line.lstrip().startswith("#")]


def scripts(folder):
    for path, folders, names in os.walk(folder):
        folders[:] = sorted(each for each in folders if each not in ("build", "dist", ".git", "node_modules"))
        for name in sorted(names):
            file = Path(path, name)
            if file.is_symlink() or not file.is_file():
                continue
            with file.open("rb") as opened:
                first = opened.readline(100).decode(errors="replace")
            if file.suffix == ".sh" or SCRIPT.match(first):
                yield str(file.relative_to(folder)), file.read_text(errors="replace")


def main():
    if "--try" in sys.argv:
        sys.exit(0 if found("a", "true\nlist | grep -q x") == ["a:2: list | grep -q x"] and found("a", "list | grep -E --quiet x")
                 and not found("a", "grep -q x file || list | grep x >/dev/null\n# a | grep -q b") else "a pipe is not found")
    all_scripts = list(scripts(Path(sys.argv[1])))
    if not all_scripts:
        sys.exit("there is no script")
    problems = [problem for name, text in all_scripts for problem in found(name, text)]
    sys.exit("\n".join(["`grep -q` behind a pipe; write `grep ... >/dev/null`:"] + problems) if problems else 0)


main()
