# SPDX-License-Identifier: Apache-2.0
"""Each new line of the page about old sketches stands in a sketch that is compiled.

    old_sketches.py PAGE SKETCH...
"""
import re
import sys
from pathlib import Path

WORDS = {"Serial", "#,R", "add()", "begin()", "reportValue()", "delay()"}  # of sentences

page, sketches = Path(sys.argv[1]).read_text(), "\n".join(Path(name).read_text() for name in sys.argv[2:])
rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.startswith("| `") or line.startswith("| old: ")]
codes = [code for row in rows for code in re.findall("`([^`]+)`", row[1])]
missing = [code for code in codes if code not in WORDS and code not in sketches]
print("\n".join(f"in no sketch: {code}" for code in missing) or f"{len(codes)} pieces of code are compiled")
sys.exit(1 if missing or len(codes) < 40 else 0)
