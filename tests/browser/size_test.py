# SPDX-License-Identifier: Apache-2.0
"""What the page weighs, and what it must not contain. No browser is needed."""

import gzip
import os
import pathlib
import re
import subprocess
import unittest

PAGE = pathlib.Path(__file__).resolve().parents[2] / "gateway" / "page"
CMAKE = PAGE.parents[1] / "cmake"
LIMIT = 100_000
HOMEPAGE = re.search(r"^Homepage: (.*)$", (PAGE.parents[1] / "debian" / "control").read_text(), re.M)[1]
DOCS = f"{HOMEPAGE}/blob/main/docs/".encode()  # followed by a person, never loaded


def served(name, content):
    """As cmake/AsipEmbedPage.cmake builds it into the program."""
    run = lambda command: subprocess.run(command, input=content, capture_output=True, check=True, env={**os.environ, "LC_ALL": "C"}).stdout
    if pathlib.Path(name).suffix in (".js", ".html", ".json"):
        content = run(["awk", "-f", CMAKE / "name_texts.awk", PAGE / "languages" / "en.json", PAGE / name])
    shorten = {".js": ["awk", "-f", CMAKE / "shorten_script.awk"], ".css": ["sed", "-E", "-f", CMAKE / "shorten_style.sed"]}.get(pathlib.Path(name).suffix)
    if shorten:
        content = run(shorten)
    return gzip.compress(content, 9, mtime=0)


class Size(unittest.TestCase):
    def files(self):
        names = [line for line in (PAGE / "files.txt").read_text().splitlines() if line and not line.startswith("#")]
        return {name: (PAGE / name).read_bytes() for name in names}

    def test_WholePage_IsSmallWhenCompressed(self):
        sizes = {name: len(served(name, content)) for name, content in self.files().items()}
        languages = {name: size for name, size in sizes.items() if name.startswith("languages/")}
        total = sum(sizes.values()) - sum(languages.values()) + max(languages.values())
        print(f"the page with its longest language is {total} bytes, compressed")
        self.assertLess(total, LIMIT)

    def test_ShortenedScripts_KeepTheirLinesAndCanBeRead(self):
        for name, content in self.files().items():
            if name.endswith(".js"):
                short = gzip.decompress(served(name, content))
                self.assertEqual(short.count(b"\n"), content.count(b"\n"), f"{name}: lines stay where they are")
                checked = subprocess.run(["node", "--input-type=module", "--check"], input=short, capture_output=True)
                self.assertEqual(checked.stderr, b"", name)

    def test_EveryFile_IsListed(self):
        there = {str(path.relative_to(PAGE)) for path in PAGE.rglob("*") if path.suffix in (".js", ".css", ".html", ".svg", ".webmanifest") or path.parent.name == "languages"}
        self.assertEqual(there, set(self.files()))

    def test_Nothing_IsLoadedFromElsewhere(self):
        for name, content in self.files().items():
            addresses = re.findall(rb"https?://[^\s\"')]+", content)
            self.assertEqual([each for each in addresses if each not in (b"http://www.w3.org/2000/svg", DOCS)], [], name)

    def test_Names_NeverBecomeHtml(self):
        forbidden = re.compile(rb"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function|style=|onclick=")
        for name, content in self.files().items():
            self.assertEqual(forbidden.findall(content), [], name)


if __name__ == "__main__":
    unittest.main()
