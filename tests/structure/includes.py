#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each source of a program includes, directly or through its headers, the header of every type of ours that it names.

Several sources are compiled as one. Which ones these are depends on the machine's memory, so a header that only a neighbour includes is
missing on the next machine.

    includes.py FOLDER [--try]     the project's; --try: on a source that misses one, and is found
"""
import re
import sys
from functools import cache
from pathlib import Path

FOLDERS = ("agent", "asip", "bench", "cli", "gateway", "registry", "sim")
INCLUDE = re.compile(r'^\s*#\s*include ["<]([^">]+)[">]', re.MULTILINE)
TYPE = re.compile(r"^(?:class|struct|enum class) (?:\[\[\w+\]\] )?([A-Z]\w+)(?: final)?\s*(?::[^:;]|\{)", re.MULTILINE)
DECLARED = re.compile(r"\b(?:class|struct|enum(?: class)?|union) (?:\[\[\w+\]\] )?([A-Z]\w+)")
ANY = re.compile(r"\b(?:(?:class|struct|enum(?: class)?|union) (?:\[\[\w+\]\] )?([A-Z]\w+)(?: final)?\s*(?::[^:;]|\{)|using ([A-Z]\w+) =)")
COMMENT_OR_TEXT = re.compile(r"(?<![\w'])'(?:[^'\\\n]|\\.)+'|"
                             r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:[^"\\\n]|\\.)*"', re.DOTALL)
WORD = re.compile(r"(?<![.>])(?<!boost::)(?<!CLI::)(?<!std::)\b[A-Z][a-z]\w+\b")


def code_of(text):
    return COMMENT_OR_TEXT.sub(" ", text)


def missing(texts):
    """(source, type, header) of each type that is named where its header is not reached. `texts`: path -> what is in it."""
    included = {path: [each for name in INCLUDE.findall(text) for each in (name, str(Path(path).parent / name)) if each in texts]
                for path, text in texts.items()}

    @cache
    def reached(path):
        found, new = set(), [path]
        while new:
            each = new.pop()
            if each not in found:
                found.add(each)
                new += included[each]
        return found

    homes, everywhere = {}, {}
    for path, text in texts.items():
        code = code_of(INCLUDE.sub("", text))
        for names in ANY.findall(code):
            everywhere.setdefault("".join(names), set()).add(path.rsplit(".", 1)[0])
        if path.endswith(".hpp"):
            for name in TYPE.findall(code):
                homes.setdefault(name, set()).add(path)
    for path, text in sorted(texts.items()):
        code = code_of(INCLUDE.sub("", text))
        own = set(DECLARED.findall(code))
        for name in sorted(set(WORD.findall(code)) - own):
            if name in homes and len(homes[name] | everywhere[name]) == 2 and not homes[name] & reached(path):
                yield path, name, min(homes[name])


def sources(folder):
    files = [file for each in FOLDERS for file in (folder / each).rglob("*") if file.suffix in (".cpp", ".hpp")]
    return {str(file.relative_to(folder)): file.read_text() for file in files}


def main():
    texts = sources(Path(sys.argv[1]))
    if "--try" in sys.argv:
        texts = {"asip/a.hpp": "struct Alpha {\n};\n", "asip/b.hpp": '#include "asip/a.hpp"\nstruct Beta {\n};\n',
                 "asip/c.cpp": '#include "asip/b.hpp"\nAlpha a; Beta b; // Gamma\n', "asip/d.cpp": "Beta b;\n",
                 "asip/e.cpp": "class Beta;\nBeta* b;\n"}
        return 0 if list(missing(texts)) == [("asip/d.cpp", "Beta", "asip/b.hpp")] else 1
    found = list(missing(texts))
    for path, name, header in found:
        print(f'{path} names {name}: #include "{header}"')
    print(f"{len(texts)} sources, {len(found)} includes are missing")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
