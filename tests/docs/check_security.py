#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Each point of SECURITY.md stands in tests/docs/security.txt, by its first words, with the tests that show it; and these tests are there.
check_security.py ROOT"""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
points = re.findall(r"^- (.*?)(?=^- |^$|\Z)", (root / "SECURITY.md").read_text(), re.M | re.S)
points = [" ".join(point.split()) for point in points]
lines = [line.split(" | ") for line in (root / "tests/docs/security.txt").read_text().splitlines() if line and not line.startswith("#")]
shown = {first: tests.split(", ") for first, tests in lines}
sources = {*(root / "tests").rglob("*.cpp"), *(root / "tests").rglob("*.py"), *(root / "tests").rglob("*.mjs")}
text = "".join(path.read_text(errors="replace") for path in sorted(sources) if "__pycache__" not in path.parts)
there = {f"{suite}.{name}" for suite, name in re.findall(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", text, re.M)}
there |= set(re.findall(r"^    def (test_\w+)\(", text, re.M))

faults = [f"no line begins as this point does: {point[:100]}" for point in points if not any(point.startswith(first) for first in shown)]
faults += [f"no point begins so: {first}" for first in shown if sum(point.startswith(first) for point in points) != 1]
faults += [f"there is no test {test}, of: {first}" for first, tests in shown.items() for test in tests if test not in there | {"-"}]
if len(points) < 20:
    faults.append("too few points were found")
print("\n".join(faults))
sys.exit(bool(faults))
