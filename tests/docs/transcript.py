# SPDX-License-Identifier: Apache-2.0
"""Runs what a page of the documentation shows: each ```console block, command by command, and compares the outputs.

A block holds what a terminal shows: a line "$ COMMAND", then what it prints. Commands of one page run one after the
other, in one folder. "..." alone on a line is any number of lines, within a line any text. A line "^C" is where the
reader ends the command: it must have printed the lines before it. The reader stands where the project's folders are. Times, identifiers and ports are not compared, nor
how wide a column is. A comment after two blanks and "#" belongs to the reader.

    transcript.py PAGE            runs it, in the environment that it gets
    transcript.py --write PAGE    writes what the commands print into the page instead
"""
import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

LIMIT_SECONDS = 60
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FOLDERS = "build examples sim".split()

VOLATILE = [
    (r"\d{4}-\d\d-\d\dT[\d:.]+Z", "<time>"),
    (r"\b\d{4}-\d\d-\d\d\b", "<date>"),
    (r"\b\d+(\.\d+)? (ns|us|ms|s|min|h|d)\b", "<duration>"),
    (r"\b(minimum|p50|p99|maximum) [\d.]+( ms)?", "<duration>"),
    (r"127\.0\.0\.1:\d+", "<address>"),
    (r"/tmp/asip-demo\.\w+", "<folder>"),
    (r"\b[0-9a-f]{8,16}\b", "<id>"),
    (r"\s+", " "),
]


class Step:
    def __init__(self, line, command):
        self.line, self.command, self.expected, self.interrupt = line, command, [], False


def blocks(text):
    """The steps of each console block, and where in the page its lines are: [(first, last, [Step])]."""
    found, lines, i = [], text.split("\n"), 0
    while i < len(lines):
        if lines[i].strip() != "```console":
            i += 1
            continue
        first, steps = i + 1, []
        i += 1
        while lines[i].strip() != "```":
            if lines[i].startswith("$ "):
                steps.append(Step(i + 1, re.sub(r"  +# .*$", "", lines[i][2:])))
            elif not steps:
                raise SystemExit(f"line {i + 1}: a console block begins with \"$ COMMAND\"")
            elif lines[i] == "^C":
                steps[-1].interrupt = True
            else:
                steps[-1].expected.append(lines[i])
            i += 1
        found.append((first, i, steps))
    return found


def pattern(line):
    line = normal(line.rstrip())
    return ".*".join(re.escape(part) for part in line.split("..."))


def normal(text):
    for what, instead in VOLATILE:
        text = re.sub(what, instead, text)
    return text.strip()


def matches(expected, got):
    """Whether the lines that came are those of the page."""
    if not expected:
        return not got
    if expected[0].strip() == "...":
        return any(matches(expected[1:], got[i:]) for i in range(len(got) + 1))
    return bool(got) and re.fullmatch(pattern(expected[0]), normal(got[0])) is not None and matches(expected[1:], got[1:])


def end_all(groups):
    """What a command left running in the background is of the process group that it had. A broker writes its store before it ends."""
    number, end = signal.SIGTERM, time.monotonic() + 10
    while groups and time.monotonic() < end:
        for group in [*groups]:
            try:
                os.killpg(group, number)
            except ProcessLookupError:
                groups.remove(group)
        number = 0
        time.sleep(0.02)


def run(step, folder, background):
    """What the command prints, standard error included, as a terminal shows it."""
    with tempfile.NamedTemporaryFile(dir=folder, prefix=".output") as output:
        child = subprocess.Popen(["bash", "-c", step.command], cwd=folder, env=dict(os.environ, HOME=folder), stdin=subprocess.DEVNULL, stdout=output,
                                 stderr=subprocess.STDOUT, start_new_session=True)
        end = time.monotonic() + LIMIT_SECONDS
        while child.poll() is None and time.monotonic() < end:
            if step.interrupt and matches(step.expected + ["..."], read(output)):
                os.killpg(child.pid, signal.SIGINT)
                step.interrupt = False
            time.sleep(0.02)
        if re.search(r" &( |$)", step.command):
            background.append(child.pid)
        ended = child.poll() is not None
        if not ended:
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()
        lines = read(output)
    return lines if ended else lines + [f"(did not end within {LIMIT_SECONDS} s)"]


def read(output):
    """By a descriptor of its own: that of the command would write where this one reads."""
    with open(output.name) as beside:
        lines = beside.read().split("\n")
    return lines[:-1] if lines[-1] == "" else lines


def main(words):
    write = words[:1] == ["--write"]
    page = words[-1]
    text = open(page).read()
    lines, shift, failed, count = text.split("\n"), 0, 0, 0
    background = []
    with tempfile.TemporaryDirectory(prefix="asip-docs-") as folder, contextlib.ExitStack() as at_end:
        at_end.callback(end_all, background)
        for name in FOLDERS:
            os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
        for first, last, steps in blocks(text):
            written = []
            for step in steps:
                count += 1
                interrupted = step.interrupt
                got = run(step, folder, background)
                fits = matches(step.expected + (["..."] if interrupted else []), got)
                written += [lines[step.line - 1 + shift]] + (step.expected if fits else got) + (["^C"] if interrupted else [])
                if not fits and not write:
                    failed += 1
                    print(f"{page}:{step.line}: {step.command}\n  the page shows:")
                    print("".join(f"    {line}\n" for line in step.expected) + "  it printed:")
                    print("".join(f"    {line}\n" for line in got), end="")
            if write:
                lines[first + shift:last + shift] = written
                shift += len(written) - (last - first)
    if write:
        open(page, "w").write("\n".join(lines))
    print(f"{page}: {count} commands, {failed} printed something else")
    return 1 if failed or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
