# SPDX-License-Identifier: Apache-2.0
"""Wheel and source archive: built, installed in a fresh virtual environment, used from there."""
import ast
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import venv

HERE = pathlib.Path(__file__).resolve().parent
USE = ("import asip, pathlib, sys; from asip import testing; from asip.board import standard_model; memory = testing.MemoryBus(desk=['servo']);"
       "memory.connect().board('desk').servo.write(0, 90); memory.close(); print(asip.__version__, pathlib.Path(asip.__file__).parent)")


class Package(unittest.TestCase):
    def test_wheel_and_source_archive_install_and_work(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "source")
            shutil.copytree(HERE.parent, source, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "build"))
            build = "import setuptools.build_meta as b, sys; print(b.build_wheel(sys.argv[1])); print(b.build_sdist(sys.argv[1]))"
            subprocess.run([sys.executable, "-c", build, folder], cwd=source, check=True, capture_output=True)
            for archive in [*pathlib.Path(folder).glob("*.whl"), *pathlib.Path(folder).glob("*.tar.gz")]:
                with self.subTest(archive.name):
                    place = pathlib.Path(folder, archive.suffix[1:])
                    venv.create(place, system_site_packages=True, with_pip=True)
                    subprocess.run([place / "bin" / "pip", "install", "-q", "--no-index", "--no-deps", "--no-build-isolation", "--ignore-installed", archive],
                                   check=True, capture_output=True)
                    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
                    done = subprocess.run([place / "bin" / "python", "-c", USE], cwd=folder, env=environment, check=True, capture_output=True, text=True)
                    self.assertIn(str(place), done.stdout)
                    self.assertTrue(list(place.rglob("asip/py.typed")))

    def test_python_without_paho_says_what_to_install(self):
        done = subprocess.run([sys.executable, "-c", "import sys; sys.modules['paho'] = None; import asip"], cwd=HERE.parent, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("pip install paho-mqtt", done.stderr.splitlines()[-1])

    def test_version_is_that_of_the_project(self):
        text = (HERE.parent / "asip" / "_version.py").read_text()
        self.assertEqual(text.split('"')[1], (HERE.parents[1] / "VERSION").read_text().strip())


class Files(unittest.TestCase):
    def test_no_file_of_the_package_is_longer_than_a_reader_likes(self):
        long = {file.name: lines for file in (HERE.parent / "asip").glob("*.py") if (lines := len(file.read_text().splitlines())) > 350}
        self.assertEqual(long, {})


class Imports(unittest.TestCase):
    def test_no_file_of_the_package_imports_itself_by_way_of_others(self):
        """Types and functions count, too: who reads one file need not read all."""
        folder = HERE.parent / "asip"
        needs = {file.stem: set(needed(file)) for file in folder.glob("*.py") if file.stem != "__init__"}
        self.assertIn("_session", needs["_engine"])
        while needs:
            free = [name for name, wanted in needs.items() if not wanted & {*needs}]
            self.assertTrue(free, f"these import each other: {sorted(needs)}")
            for name in free:
                del needs[name]

    def test_importing_the_package_needs_little_that_paho_does_not(self):
        text = "import sys, paho.mqtt.client; before = {*sys.modules}; import asip; print(*sorted(one for one in {*sys.modules} - before if one[0] != '_'))"
        done = subprocess.run([sys.executable, "-c", text], cwd=HERE.parent, check=True, capture_output=True, text=True)
        others = {one.partition(".")[0] for one in done.stdout.split()} - {"asip"}
        self.assertLessEqual(others, {"concurrent", "heapq", "json", "queue"})  # `typing` would be a fifth of it


def needed(file):
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            yield from [node.module] if node.module else [one.name for one in node.names]


if __name__ == "__main__":
    unittest.main()
