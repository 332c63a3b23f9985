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
        return subprocess.run(["mypy", "--strict", "--cache-dir", cache, *arguments], cwd=HERE.parent, capture_output=True, text=True,
                              env={**os.environ, "MYPYPATH": str(HERE.parent)})


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

    def test_classes_of_standard_services_are_made_of_the_models(self):
        self.assertEqual(subprocess.run([sys.executable, HERE.parent / "generate_standard.py", "--check"]).returncode, 0,
                         "run python/generate_standard.py")


if __name__ == "__main__":
    unittest.main()
