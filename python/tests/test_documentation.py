# SPDX-License-Identifier: Apache-2.0
"""Each block of docs/python.md and of python/README.md is run as it stands there, on a real bus."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests" / "support"))
from bus import Bus  # noqa: E402


class Pages(unittest.TestCase):
    def test_each_block_runs(self):
        real = Bus()
        self.addCleanup(real.close)
        environment = {**os.environ, "ASIP_BROKER": f"127.0.0.1:{real.broker_port}", "PYTHONPATH": str(HERE.parent)}
        run = 0
        for page in (ROOT / "docs" / "python.md", ROOT / "python" / "README.md"):
            for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL):
                with self.subTest(page=page.name, block=block.splitlines()[:4]):
                    done = subprocess.run([sys.executable, "-X", "dev", "-W", "error::DeprecationWarning", "-c", block], env=environment,
                                          capture_output=True, text=True, timeout=60)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    if "distance.read()" in block and "testing" not in block:
                        self.assertIn("[42, 0]", done.stdout)
                    run += 1
        self.assertGreaterEqual(run, 7)


if __name__ == "__main__":
    unittest.main()
