#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prose that a reader gets through: no sentence of a page has more than 35 words.

    check_prose.py ROOT      the pages of the project
    check_prose.py --try     the check itself, on sentences that are too long and on some that are not

Tables, blocks, headings and comments are left out. What stands as code within a sentence is one word.
"""
import re
import sys
from pathlib import Path

LONGEST = 35
APART = re.compile(r"^(#|\||<|!\[|>)|^ *$")
BEGINS = re.compile(r"^ *([-*]|\d+\.) ")


def paragraphs(text):
    """(line, text) of each paragraph and item of a list."""
    text = re.sub(r"<!--.*?-->", lambda part: "\n" * part[0].count("\n"), text, flags=re.S)
    text = re.sub(r"^ *```.*?^ *```$", lambda block: "\n" * block[0].count("\n"), text, flags=re.M | re.S)
    found, begin = [], 0
    for number, line in enumerate([*text.split("\n"), ""], 1):
        apart = APART.match(line.strip()) or line.startswith("    ") and not found
        if found and (apart or BEGINS.match(line)):
            yield begin, " ".join(found)
            found = []
        if not apart:
            begin = begin if found else number
            found.append(BEGINS.sub("", line).strip())


def sentences(text):
    text = re.sub(r"`[^`]+`", "Code", text)
    text = re.sub(r"!?\[([^]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"<[^>]*>", "Address", text)
    return re.split(r"(?<=[.!?])[*_\")]*\s+(?=[*_\"(]*[A-Z0-9])", text)


def words(sentence):
    return len([word for word in sentence.split() if re.search(r"\w", word)])


def faults(name, text):
    for line, paragraph in paragraphs(text):
        for sentence in sentences(paragraph):
            if words(sentence) > LONGEST:
                yield f"{name}:{line}: {words(sentence)} words: {sentence[:80]}..."


def pages(root):
    return [root / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")] + sorted((root / "docs").glob("*.md"))


def try_it():
    long = " ".join(["Word", *["word"] * LONGEST]) + "."
    good = long.replace("word ", "", 1)
    shown = {long: 1, f"Short.\n{long}": 1, f"- {long}\n- {good}": 1, f"{good} {good}": 0, f"{good}\n\n{good}": 0, f"| {long} |": 0,
             f"```\n{long}\n```": 0, f"# {long}": 0, f"{good[:-6]} `{long}`.": 0, f"<!-- {long} -->\n{good}": 0, f"[{long[:-1]}](a.md).": 1}
    wrong = [text for text, count in shown.items() if len(list(faults("page", text))) != count]
    print("\n".join(wrong) or f"{len(shown)} texts judged as they should be")
    return 1 if wrong else 0


def main(root):
    found = [fault for page in pages(root) for fault in faults(page.relative_to(root), page.read_text(encoding="utf-8"))]
    print("\n".join([*found, f"{len(found)} sentences are too long"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(try_it() if sys.argv[1:] == ["--try"] else main(Path(sys.argv[1])))
