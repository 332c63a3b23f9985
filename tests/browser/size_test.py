# SPDX-License-Identifier: Apache-2.0
"""What the page weighs, and what it must not contain. No browser is needed."""

import gzip
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

PAGE = pathlib.Path(__file__).resolve().parents[2] / "gateway" / "page"
CMAKE = PAGE.parents[1] / "cmake"
LIMIT = 100_000
CABLE_LIMIT = 8_000
HOMEPAGE = re.search(r"^Homepage: (.*)$", (PAGE.parents[1] / "debian" / "control").read_text(), re.M)[1]
DOCS = f"{HOMEPAGE}/blob/main/docs/".encode()  # followed by a person, never loaded


def make_page(page, folder):
    """{path: compressed}, as a program has it built in; or what is wrong."""
    made = subprocess.run([CMAKE / "make_page", page, folder], capture_output=True, text=True)
    if made.returncode != 0:
        raise ValueError(made.stderr)
    return {name: pathlib.Path(folder, f"{name}.gz").read_bytes() for name in pathlib.Path(folder, "files").read_text().splitlines()}


class Size(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.served = make_page(PAGE, f"{folder.name}/page")

    def files(self):
        names = [line for line in (PAGE / "files.txt").read_text().splitlines() if line and not line.startswith("#")]
        return {name: (PAGE / name).read_bytes() for name in names}

    def test_WholePage_IsSmallWhenCompressed(self):
        sizes = {name: len(content) for name, content in self.served.items() if not name.startswith("cable/")}
        languages = {name: size for name, size in sizes.items() if name.startswith("languages/")}
        total = sum(sizes.values()) - sum(languages.values()) + max(languages.values())
        print(f"the page with its longest language is {total} bytes, compressed")
        self.assertLess(total, LIMIT)

    def test_Cable_IsApart_AndSmallWhenCompressed(self):
        """It is loaded by those who add a board, and by no phone, kiosk or other screen: no part of what every reader waits for."""
        sizes = {name: len(content) for name, content in self.served.items() if name.startswith("cable/")}
        languages = {name: size for name, size in sizes.items() if "/languages/" in name}
        total = sum(sizes.values()) - sum(languages.values()) + max(languages.values())
        print(f"the cable with its longest language is {total} bytes, compressed")
        self.assertLess(total, CABLE_LIMIT)
        importing = [name for name, content in self.files().items() if re.search(rb"^import .*cable/", content, re.M)]
        self.assertEqual(importing, [], "imported before it is needed")

    def test_ServedScripts_CanBeReadAndImportWhatIsServed(self):
        for name, content in self.served.items():
            if name.endswith(".js"):
                script = gzip.decompress(content)
                checked = subprocess.run(["node", "--input-type=module", "--check"], input=script, capture_output=True)
                self.assertEqual(checked.stderr, b"", name)
                imported = re.findall(r'(?:^import[^"\n]*|import\()"([^"]*)"', script.decode(), re.M)
                paths = {os.path.normpath(os.path.join(os.path.dirname(name), each)) for each in imported}
                self.assertEqual(paths - set(self.served), set(), name)

    def test_JoinedScript_HasEachFunctionAndElementOfItsParts(self):
        joined = gzip.decompress(self.served["ui/screens.js"])
        parts = [content for name, content in self.files().items() if name.endswith(".js") and name not in self.served]
        self.assertGreater(len(parts), 30)
        for content in parts:
            for name in re.findall(rb"^(?:export )?(?:async )?(?:function|class) \w+|^customElements.define\(.*\);", content, re.M):
                name = name.removeprefix(b"export ").replace(b", ", b",")
                self.assertEqual(len(re.findall(rb"^" + re.escape(name) + rb"(?!\w)", joined, re.M)) > 0, True, name)

    def make_small(self, scripts):
        """The same for a page of these scripts alone, unpacked: its folder."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        files = {"main.js": "", "net/worker.js": "", "languages/en.json": "{}", **scripts}
        for name, content in {**files, "files.txt": "\n".join(files)}.items():
            path = pathlib.Path(folder.name, "page", name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"// A script.\n{content}\n" if name.endswith(".js") else content + "\n")
        made = pathlib.Path(folder.name, "made")
        for name, content in make_page(f"{folder.name}/page", made).items():
            (made / name).write_bytes(gzip.decompress(content))
        (made / "package.json").write_text('{"type": "module"}')
        return made

    def test_JoinedScripts_RunInTheirOrderAndShareWhatIsLoadedLater(self):
        made = self.make_small({
            "core/a.js": 'export const box = { said: ["a"] };\nexport function say(text) { box.said.push(text); }',
            "core/b.js": 'import { say as told } from "./a.js";\nconst say = (text) => told(`b: ${text}`);\nexport { say };\nsay("first");',
            "net/own.js": 'export const own = { of: "worker" };', "net/worker.js": 'import { own } from "./own.js";\nown.of = "w";',
            "ui/screens.js": 'import { box } from "../core/a.js";\nimport { say } from "../core/b.js";\nimport { own } from "../net/own.js";\nsay(own.of);\n'
                             'import("../late/late.js").then(({ ended }) => console.log(box.said.join(), ended));',
            "late/late.js": 'import { box, say as tell } from "../core/a.js";\nimport { say } from "../core/b.js";\nimport { own } from "../net/own.js";\n'
                            'await Promise.resolve();\ntell("late");\nsay("too");\nexport const ended = `${box.said.length} ${own.of}`;'})
        self.assertFalse((made / "core" / "a.js").exists())
        self.assertTrue((made / "net" / "own.js").exists(), "what the worker needs, too")
        done = subprocess.run(["node", made / "ui" / "screens.js"], capture_output=True, text=True)
        self.assertEqual((done.stdout.strip(), done.stderr), ("a,b: first,b: worker,late,b: too 5 worker", ""))

    def test_ScriptsThatImportEachOther_AreRefused(self):
        with self.assertRaisesRegex(ValueError, "core/b.js and core/a.js import each other"):
            self.make_small({"ui/screens.js": 'import { f } from "../core/a.js";\nf();', "core/a.js": 'import { g } from "./b.js";\nexport function f() { g(); }',
                             "core/b.js": 'import { f } from "./a.js";\nexport function g() { f(); }'})

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
