# SPDX-License-Identifier: Apache-2.0
"""The file VERSION is what programs, packages, images, libraries and the HTTP API say, and images of others have a version: versions.py ROOT BIN"""
import os
import re
import subprocess
import sys

ROOT, BIN = sys.argv[1:]
PROGRAMS = ("asip-agent", "asip-gateway", "asip-registry", "asipctl", "asip-sim")
# Files that no build may write: each with what stands before the version.
REPEATED = {
    "debian/changelog": r"\Aasip \(",
    "docker/Containerfile": r"^ARG VERSION=",
    "firmware/library.properties": r"^version=",
    "firmware/library.json": r'^  "version": "',
    "python/asip/_version.py": r'^__version__ = "',
    "node-red/package.json": r'^  "version": "',
    "CHANGELOG.md": r"^## (?:Unreleased \()?",
}
PATTERN = r"(\d+\.\d+\.\d+(?:~[a-z0-9]+)?)"


def text(name):
    with open(os.path.join(ROOT, name)) as file:
        return file.read()


version = text("VERSION").strip()
said = {}
for name, before in REPEATED.items():
    found = re.search(before + PATTERN, text(name), re.M)
    said[name] = found and found[1]
for program in PROGRAMS:
    output = subprocess.run([os.path.join(BIN, program), "--version"], capture_output=True, text=True, timeout=30, check=True).stdout
    found = re.search(PATTERN, output)
    said[program] = found and found[1]
faults = [f"{name}: {found}, but VERSION says {version}" for name, found in said.items() if found != version]
# What others make is of one version, and not of whatever is there on the day.
for image in re.findall(r"^\s*image: (.*/.*)$", text("compose.yaml"), re.M):
    if not re.search(r":v?\d+\.\d+\.\d+$", image):
        faults.append(f"compose.yaml: {image} names no version")
print("\n".join(faults + [f"{len(said)} places, {len(faults)} faults"]))
sys.exit(1 if faults else 0)
