#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The documentation as a site: each page is there and is found by the search, and a browser needs nothing from elsewhere: site ROOT"""
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def faults(root, site):
    pages = {"index.html": root / "README.md", **{f"{name}.html": root / f"{name}.md" for name in ("SECURITY", "CONTRIBUTING", "CHANGELOG")},
             **{f"{page.stem}.html": page for page in (root / "docs").glob("*.md")}}
    found = {entry["location"].split("#")[0] for entry in json.loads((site / "search" / "search_index.json").read_text(encoding="utf-8"))["docs"]}
    for name, page in pages.items():
        if not (site / name).exists():
            yield f"{name}: is not there"
            continue
        text = (site / name).read_text(encoding="utf-8")
        if name not in found and not (name == "index.html" and {"", "index.html"} & found):
            yield f"{name}: the search does not find it"
        blocks = len(re.findall(r"^ *```\w*$", page.read_text(encoding="utf-8"), re.M)) // 2
        if text.count("<pre>") < blocks:
            yield f"{name}: {text.count('<pre>')} blocks of {blocks}"
        for address in re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(https?:[^"]*)"', text):
            yield f"{name}: needs {address}"


def main(root):
    with tempfile.TemporaryDirectory(prefix="asip-site-") as folder:
        site = Path(folder, "site")
        subprocess.run([root / "packaging" / "site", site], check=True)
        wrong = list(faults(root, site))
        again = subprocess.run([root / "packaging" / "site", site], capture_output=True, text=True, check=False)
        if again.returncode == 0 or "is not empty" not in again.stderr:
            wrong.append(f"a folder with files is written over: {again.stderr}")
    print("\n".join([*wrong, f"{len(wrong)} faults"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
