#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the project weighs: lines of the product and of its tests in all languages, words of its documentation, and options of the programs.

    weight.py ROOT [BIN]     BIN: the folder of built programs, whose options are counted

A line is a line of a committed file. The product is what users run or compile against; examples, benchmarks, packaging and documentation
are not in it. A word of the documentation is what stands between blanks in one of its pages. An option is what may stand on the command
line of a program, except for help, version and configuration file. features.txt has the files of the features that came after the first
weighing, and sections of pages, as FILE#ANCHOR: they have rows of their own, and "the house" is what the rest weighs. Status 1: features.txt
names a file or a section that is not there.
"""
import re
import subprocess
import sys
from pathlib import Path

PRODUCT = ("agent", "asip", "cli", "firmware", "gateway", "node-red", "python", "registry", "sim")
ASIDE = ("bench",)
PAGES = ("README.md", "CONTRIBUTING.md", "SECURITY.md")  # beside those in docs/
TESTS = re.compile(r"^(tests|[\w-]+/tests?)/")
LANGUAGES = {"C++": (".c", ".cpp", ".h", ".hpp"), "Python": (".py",), "JavaScript": (".cjs", ".js", ".mjs")}
PROGRAMS = ("asip-gateway", "asip-agent", "asip-registry")
OPTION = re.compile(r"^  (?:-\w,)?--([a-z][\w-]*)", re.MULTILINE)
OF_ALL = {"help", "help-all", "version", "config"}


def pattern(text):
    """A pattern of features.txt, with * and {a,b}, as a regular expression."""
    return re.sub(r"\\\{(.*?)\\\}", lambda each: f"({each[1].replace(',', '|')})", re.escape(text).replace(r"\*", ".*"))


def section(text, anchor):
    """The words below the heading with this anchor, until the next heading of its level; None: there is no such heading."""
    below, words = 0, None
    for line in re.sub(r"^ *```.*?^ *```$", lambda block: block[0].replace("\n#", "\n.#"), text, flags=re.M | re.S).split("\n"):
        heading = re.match(r"(#+) (.*)", line)
        if heading and below and len(heading[1]) <= below:
            return words
        if heading and not below and re.sub(r"[^\w -]", "", heading[2].lower()).replace(" ", "-") == anchor:
            below, words = len(heading[1]), 0
        words = words + len(line.split()) if below else words
    return words


def features(root, names):
    """{file: feature}, {feature: words of its sections in pages of others}, and what features.txt names that is not there."""
    found, sections, missing = {}, {}, []
    for line in (Path(__file__).parent / "features.txt").read_text(encoding="utf-8").splitlines()[3:]:
        feature, *patterns = line.split()
        for each in patterns:
            page, _, anchor = each.partition("#")
            own = [name for name in names if re.fullmatch(pattern(page), name)]
            words = section((Path(root) / page).read_text(encoding="utf-8"), anchor) if own and anchor else 0
            if not own or words is None:
                missing.append(each)
            elif anchor:
                sections[feature] = sections.get(feature, 0) + words
            else:
                found.update(dict.fromkeys(own, feature))
    return found, sections, missing


def lines(root):
    """{(room, language): lines} and {(feature, "product" or "tests"): lines}: the rooms are the folders of the product, those beside it, and
    `tests`; of pages, {(feature, "words"): words}. And what features.txt names that is not there."""
    found, later = {}, {}
    names = subprocess.run(["git", "-C", root, "ls-files", "-z"], capture_output=True, text=True, check=True).stdout.split("\0")
    owner, sections, missing = features(root, names)
    for name in names:
        folder = "tests" if TESTS.match(name) else "" if "/examples/" in name else name.split("/")[0]
        language = next((each for each, ends in LANGUAGES.items() if Path(name).suffix in ends), None)
        if language and folder in PRODUCT + ASIDE + ("tests",):
            count = (Path(root) / name).read_bytes().count(b"\n")
            found[folder, language] = found.get((folder, language), 0) + count
            if name in owner:
                where = owner[name], "tests" if folder == "tests" else "product"
                later[where] = later.get(where, 0) + count
        elif name in owner and name.endswith(".md"):
            where = owner[name], "words"
            later[where] = later.get(where, 0) + len((Path(root) / name).read_text(encoding="utf-8").split())
    for feature, words in sections.items():
        later[feature, "words"] = later.get((feature, "words"), 0) + words
    return found, later, missing


def show_features(found, later, words):
    """The features that came later, and what the house weighs without them."""
    kinds = "product", "tests", "words"
    print(f"\n{'came later':14}" + "".join(f"{kind:>12}" for kind in kinds))
    for feature in dict.fromkeys(each for each, _ in later):
        print(f"{feature:14}" + "".join(f"{later.get((feature, kind), 0):12,}" for kind in kinds))
    house = {kind: sum(count for (folder, _), count in found.items() if folder in folders)
             for kind, folders in (("product", PRODUCT), ("tests", ("tests",)))} | {"words": words}
    for (_, kind), count in later.items():
        house[kind] -= count
    print(f"{'the house':14}" + "".join(f"{house[kind]:12,}" for kind in kinds) + "\n")


def row(name, found, folders):
    counts = [sum(found.get((folder, language), 0) for folder in folders) for language in LANGUAGES]
    print(f"{name:14}" + "".join(f"{count:12,}" for count in counts + [sum(counts)]))


def main():
    found, later, missing = lines(sys.argv[1])
    print(f"{'':14}" + "".join(f"{each:>12}" for each in (*LANGUAGES, "all")))
    for folder in PRODUCT:
        row(folder, found, [folder])
    row("product", found, PRODUCT)
    row("tests", found, ["tests"])
    row("beside", found, ASIDE)
    root = Path(sys.argv[1])
    pages = [*(root / "docs").glob("*.md"), *(root / name for name in PAGES)]
    words = sum(len(page.read_text(encoding="utf-8").split()) for page in pages)
    print(f"{'documentation':14}{words:12,} words")
    show_features(found, later, words)
    for program in PROGRAMS if len(sys.argv) > 2 else ():
        told = [subprocess.run([Path(sys.argv[2]) / program, each], capture_output=True, text=True, check=False).stdout
                for each in ("--help", "--help-all")]
        print(f"{program:14}{len(set(OPTION.findall(told[0] + told[1])) - OF_ALL):12} options")
    for each in missing:
        print(f"features.txt: {each} is not there", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
