# SPDX-License-Identifier: Apache-2.0
"""The library, AsipEsp and a sketch with services, compiled for the chips of Espressif with compilers for them, against
headers that declare what their Arduino cores declare: types, sizes and alignment are the chip's."""

import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LIBRARY = ROOT / "firmware" / "src"
ESP = ROOT / "firmware" / "examples" / "AsipEsp"
SOURCES = sorted(path for path in LIBRARY.rglob("*.cpp"))
FLAGS = ["-std=gnu++11", "-Os", "-Wall", "-Wextra", "-Werror", "-fno-exceptions", "-fno-rtti", "-ffreestanding",
          "-DARDUINO=10819", f"-I{HERE / 'esp' / 'libc'}", f"-I{HERE / 'esp'}", f"-I{LIBRARY}"]

# Each undefined name of a sketch that is linked as far as it goes is one of these: the core has it, or the C library.
OF_THE_CORE = {"pinMode", "digitalWrite", "digitalRead", "analogRead", "analogWrite", "millis", "micros", "delayMicroseconds",
               "attachInterrupt", "detachInterrupt", "tone", "noTone", "enableInterruptsOfThisCore", "disableInterruptsOfThisCore",
               "Serial", "Wire", "TwoWire", "EEPROM", "WiFi", "EEPROMClass", "HardwareSerial", "WiFiClient", "WiFiServer", "WiFiClass", "IPAddress"}
OF_THE_C_LIBRARY = {"strlen", "strcmp", "memcmp", "memcpy", "memmove", "memset", "snprintf", "atan2", "pow", "__cxa_pure_virtual", "__cxa_atexit",
                    "__dso_handle", "_ZdlPv", "_ZdlPvj"}


class EspCompile:
    """What is tried with each chip."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.library = [cls.compile(source) for source in SOURCES]

    @classmethod
    def compile(cls, source, *more):
        output = pathlib.Path(cls.folder.name, re.sub(r"\W", "_", str(source)) + ".o")
        run = subprocess.run([f"{cls.tool}-g++", *FLAGS, *cls.flags, *more, "-c", str(source), "-o", str(output)], capture_output=True,
                             text=True, timeout=120)
        if run.returncode != 0:
            raise AssertionError(run.stderr)
        return output

    def link(self, sketch, *others):
        objects = [*self.library, *(self.compile(source) for source in others), self.compile(sketch, "-x", "c++", "-include", "Arduino.h")]
        linked = pathlib.Path(self.folder.name, sketch.stem + ".linked")
        subprocess.run([f"{self.tool}-ld", "-r", *self.link_flags, "-o", str(linked), *map(str, objects)], check=True, timeout=60)
        return linked

    def nm(self, linked, *options):
        return subprocess.run([f"{self.tool}-nm", *options, str(linked)], check=True, capture_output=True, text=True, timeout=60).stdout

    def expect_complete(self, linked):
        for line in self.nm(linked, "--undefined-only").splitlines():
            name = line.split()[-1]
            if name in OF_THE_C_LIBRARY or name.startswith("__") or name in OF_THE_CORE:
                continue
            plain = subprocess.run(["c++filt", name], check=True, capture_output=True, text=True).stdout.strip()
            self.assertIn(re.match(r"(?:vtable for )?(\w+)", plain)[1], OF_THE_CORE, plain)

    def test_the_sketch_with_a_network(self):
        self.expect_complete(self.link(ESP / "AsipEsp.ino", *sorted(ESP.glob("*.cpp"))))

    def test_services_on_the_serial_line(self):
        linked = self.link(HERE / "sketches" / "EspServices" / "EspServices.ino")
        self.expect_complete(linked)
        self.expect_interrupts_in_ram(linked)

    def test_services_on_i2c(self):
        self.expect_complete(self.link(HERE / "sketches" / "ChipI2c" / "ChipI2c.ino"))

    def test_a_sketch_without_i2c_has_no_wire(self):
        linked = self.link(HERE / "sketches" / "EspServices" / "EspServices.ino")
        self.assertNotIn("Wire", self.nm(linked, "--undefined-only"))

    def expect_interrupts_in_ram(self, linked):
        """An ESP stops where an interrupt calls a function in flash while that cannot be read."""
        text = subprocess.run([f"{self.tool}-objdump", "-t", "-C", str(linked)], check=True, capture_output=True, text=True).stdout
        functions = [line for line in text.splitlines() if "onPinChange" in line and " F " in line]
        self.assertEqual(len(functions), 3, text)  # encoders, ultrasonic sensors, DHT sensors
        for line in functions:
            self.assertIn(".iram", line)
        # And what they call is there too, or is the core's.
        calls = subprocess.run([f"{self.tool}-objdump", "-r", "-C", str(linked)], check=True, capture_output=True, text=True).stdout
        in_ram = re.split(r"RELOCATION RECORDS FOR \[", calls)
        for part in in_ram:
            if ".iram" not in part.split("]")[0]:
                continue
            for line in part.splitlines()[3:]:
                self.assertNotRegex(line, r"(?<!iram)\.text|asip::hw|asip::Board", line)


@unittest.skipUnless(shutil.which("xtensa-lx106-elf-g++"), "no compiler for the ESP8266 (gcc-xtensa-lx106)")
class Esp8266(EspCompile, unittest.TestCase):
    tool = "xtensa-lx106-elf"
    flags = ["-mlongcalls", "-DESP8266", "-DARDUINO_ARCH_ESP8266", "-DF_CPU=80000000L", f"-I{HERE / 'esp' / 'esp8266'}"]
    link_flags = []


@unittest.skipUnless(shutil.which("xtensa-lx106-elf-g++"), "no compiler for Xtensa (gcc-xtensa-lx106)")
class Esp32(EspCompile, unittest.TestCase):
    """By the compiler for the ESP8266, whose types have the same sizes; there is none for the ESP32 in Debian."""
    tool = "xtensa-lx106-elf"
    flags = ["-mlongcalls", "-DESP32", "-DARDUINO_ARCH_ESP32", "-DCONFIG_IDF_TARGET_ESP32", f"-I{HERE / 'esp' / 'esp32'}"]
    link_flags = []


@unittest.skipUnless(shutil.which("riscv64-unknown-elf-g++"), "no compiler for RISC-V (gcc-riscv64-unknown-elf)")
class Esp32C3(EspCompile, unittest.TestCase):
    tool = "riscv64-unknown-elf"
    flags = ["-march=rv32imc", "-mabi=ilp32", "-DESP32", "-DARDUINO_ARCH_ESP32", "-DCONFIG_IDF_TARGET_ESP32C3", f"-I{HERE / 'esp' / 'esp32'}"]
    link_flags = ["-melf32lriscv"]


if __name__ == "__main__":
    unittest.main()
