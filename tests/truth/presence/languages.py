#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Python package and the nodes of Node-RED as views of the truth test of presence: in random histories they say of each board, after each
message, what the bus view of C++ says, which is compared with what is so.

    languages.py TRUTH_PRESENCE [FIRST_SEED [HISTORIES]]
"""
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
AT_ONCE = 5000  # what fits into memory


def main(program, first=1, histories=5000):
    for begin in range(int(first), int(first) + int(histories), AT_ONCE):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "recorded.json")
            subprocess.run([program, "--record", file, "--first", str(begin), "--histories", str(AT_ONCE)], check=True)
            environment = {**os.environ, "ASIP_PRESENCE_VECTORS": str(file), "PYTHONPATH": str(ROOT / "python")}
            subprocess.run([sys.executable, "-B", "-m", "unittest", "-q", "test_presence.Presence.test_what_is_shown_after_each_message_is_what_the_file_says"],
                           cwd=ROOT / "python" / "tests", env=environment, check=True)
            subprocess.run(["node", "--test", "--test-reporter", "tap", "--test-name-pattern", "what is shown after each message", "node-red/tests/presence.test.mjs"],
                           cwd=ROOT, env=environment, check=True, stdout=None if "-v" in sys.argv else subprocess.DEVNULL)
            print(f"seeds {begin} to {begin + AT_ONCE - 1}: {file.stat().st_size / 1e6:.1f} MB of what views got, said alike in three languages", flush=True)


if __name__ == "__main__":
    main(*[one for one in sys.argv[1:] if one != "-v"])
