# SPDX-License-Identifier: Apache-2.0
"""What a reader of a page types."""
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def commands_of(page):
    """What stands behind the prompts of its blocks, without comments, and its programs in Python, in order: [(language, text)]."""
    found = []
    for block in re.finditer(r"^( *)```(console|python)\n(.*?)^ *```$", page, re.M | re.S):
        lines = [line[len(block[1]):] for line in block[3].split("\n")]
        if block[2] == "python":
            found.append(("python", "\n".join(lines)))
        else:
            found += [("console", re.sub(r"  +#.*", "", line[2:])) for line in lines if line.startswith("$ ")]
    return found


def page_text(name):
    return (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
