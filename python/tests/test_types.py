# SPDX-License-Identifier: Apache-2.0
"""Type checkers know the package, the standard services, and the mistakes in their use. Needs mypy."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent


def mypy(*arguments):
    with tempfile.TemporaryDirectory() as cache:
        (pathlib.Path(cache) / "lab.py").write_text(subprocess.run([sys.executable, "-m", "asip.stubs"], cwd=HERE.parent, check=True,
                                                                   capture_output=True, text=True).stdout)
        return subprocess.run(["mypy", "--strict", "--cache-dir", cache, *arguments], cwd=HERE.parent, capture_output=True, text=True,
                              env={**os.environ, "MYPYPATH": f"{HERE.parent}:{cache}"})


class Types(unittest.TestCase):
    def test_package_is_strictly_typed(self):
        done = mypy("asip")
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_good_use_passes_and_each_mistake_is_found(self):
        self.assertEqual(mypy(str(HERE / "typed_good.py")).returncode, 0)
        bad = HERE / "typed_bad.py"
        wanted = {number for number, line in enumerate(bad.read_text().splitlines(), 1) if line.endswith("# fault")}
        found = {int(number) for number in re.findall(r"typed_bad\.py:(\d+): error", mypy(str(bad)).stdout)}
        self.assertEqual(found, wanted)


if __name__ == "__main__":
    unittest.main()
