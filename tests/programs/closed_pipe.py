# SPDX-License-Identifier: Apache-2.0
"""Each program prints its help into a pipe that no program reads: it ends by itself, not by SIGPIPE.

    closed_pipe.py PROGRAM...
"""
import os
import subprocess
import sys


def status_of(program):
    reading, writing = os.pipe()
    os.close(reading)
    try:  # with the signal as a shell leaves it: Python itself ignores it
        return subprocess.run([program, "--help"], stdout=writing, stderr=subprocess.PIPE, restore_signals=True, timeout=30).returncode
    finally:
        os.close(writing)


faults = [f"{program} --help: ended with {status}" for program in sys.argv[1:] if (status := status_of(program)) < 0]
print("\n".join(faults + [f"{len(sys.argv) - 1} programs, {len(faults)} faults"]))
sys.exit(1 if faults or len(sys.argv) < 2 else 0)
