# SPDX-License-Identifier: Apache-2.0
"""What the library needs of an Arduino core is named when it is missing: one sentence, for each. A core is taken that has all of
it, and each thing is renamed in turn."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
LIBRARY = HERE.parents[1] / "firmware" / "src"
FUNCTIONS = ("pinMode", "digitalWrite", "digitalRead", "analogRead", "analogWrite", "millis", "micros", "delayMicroseconds",
             "tone", "noTone", "attachInterrupt", "detachInterrupt", "interrupts", "noInterrupts")
MACROS = ("F", "PROGMEM", "pgm_read_byte", "pgm_read_word", "digitalPinToInterrupt", "NUM_DIGITAL_PINS", "NUM_ANALOG_INPUTS")
OF_THE_BUS = ("begin", "beginTransmission", "write", "endTransmission", "requestFrom", "read")
OF_THE_PORT = ("begin", "read", "write", "availableForWrite", "flush")


class CoreCheck(unittest.TestCase):
    def compile(self, change, source="#include <asip/Hardware.h>\n"):
        with tempfile.TemporaryDirectory() as folder:
            for header in ("core/Arduino.h", "core/ChipSerial.h", "rp2040/pins_arduino.h", "rp2040/Wire.h"):
                text = (HERE / header).read_text(encoding="utf-8")
                pathlib.Path(folder, os.path.basename(header)).write_text(change(text), encoding="utf-8")
            run = subprocess.run([os.environ.get("CXX", "c++"), "-std=c++11", "-fsyntax-only", "-DARDUINO=10819", f"-I{folder}",
                                  f"-I{LIBRARY}", "-x", "c++", "-"], input=source, capture_output=True, text=True, timeout=60)
        return run.stderr if run.returncode != 0 else ""

    def sentences(self, errors):
        return [line for line in errors.splitlines() if "error:" in line and "Asip needs" in line]

    def test_a_core_that_has_all_of_it(self):
        self.assertEqual(self.compile(str), "")

    def test_each_function(self):
        for name in FUNCTIONS:
            errors = self.compile(lambda text: re.sub(rf"\b{name}\(", f"other_{name}(", text))
            sentences = self.sentences(errors)
            self.assertEqual(len(sentences), 1, f"{name}: {errors}")
            self.assertIn(f"Asip needs {name}(", sentences[0])

    def test_each_macro(self):
        for name in MACROS:
            sentences = self.sentences(self.compile(lambda text: re.sub(rf"#define {name}\b", f"#define OTHER_{name}", text)))
            self.assertEqual(len(sentences), 1, name)
            self.assertIn(name, sentences[0])

    def test_each_function_of_the_port(self):
        source = "#include <Asip.h>\n#include <AsipSerial.h>\n"
        self.assertEqual(self.compile(str, source), "")
        for name in OF_THE_PORT:
            errors = self.compile(lambda text: re.sub(rf"\b{name}\(", f"other_{name}(", text), source)
            self.assertIn("ASIP_SERIAL lacks one of them", errors, name)

    def test_each_function_of_the_bus(self):
        for header in ("AsipLcd", "AsipMotion", "AsipPressure"):
            self.assertEqual(self.compile(str, f"#include <Asip.h>\n#include <{header}.h>\n"), "")
        source = "#include <Asip.h>\n#include <AsipMotion.h>\n"
        for name in OF_THE_BUS:
            sentences = self.sentences(self.compile(lambda text: re.sub(rf"\b{name}\(", f"other_{name}(", text), source))
            self.assertEqual(len(sentences), 1, name)
            self.assertIn("Asip needs Wire with", sentences[0])
            self.assertIn(f"{name}(", sentences[0])

    def test_what_needs_an_avr_says_so(self):
        for header in ("AsipFastSerial", "AsipNeoPixels", "AsipPixels", "AsipServos"):
            errors = self.compile(str, f"#include <Asip.h>\n#include <{header}.h>\n")
            self.assertRegex(errors, rf'error: #error "{header}\.h .*AVR', header)

    def test_the_page_lists_them(self):
        page = (LIBRARY.parent / "README.md").read_text(encoding="utf-8")
        for name in (*FUNCTIONS, *MACROS, *OF_THE_PORT, *OF_THE_BUS):
            self.assertIn(f"`{name}`", page)


if __name__ == "__main__":
    unittest.main()
