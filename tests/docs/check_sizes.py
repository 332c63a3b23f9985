#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""check_sizes.py ROOT BUILD [--write]: flash and RAM in docs/sensors.md are those of sketches with that service alone, on an Uno, beyond
one of the pins alone, as avr-size has them, to a hundredth or 16 bytes: compilers differ; with --write the page is written so. A sketch with
sensors of three services does not grow beyond what a small chip has left."""
import pathlib
import re
import subprocess
import sys
import tempfile

CORE = pathlib.Path("/usr/share/arduino/hardware/arduino/avr")
SERVICES = {
    "Bump": "Bump s(10, 11);", "Dht": "Dht s(Dht::kDht22, 4);", "Distance": "Distance s(7);", "Encoders": "Encoders s(2, 4, 3, 12);",
    "Hygrometer": "Hygrometer s;", "I2cChips": "I2cChips s;", "Illuminance": "Illuminance s;", "Lcd": "Lcd s;",
    "Motion": "Motion s(Motion::kAccelerometer);", "Motors": "Motors s(7, 8, 5, 12, 13, 6);", "NeoPixels": "PixelStripOf<8> p(6); NeoPixels s(p);",
    "OneWire": "OneWireBus bus(2); OneWire s(bus);", "Pixels": "Pixels<8> s(6);", "Pressure": "Pressure s;",
    "Reflectance": "Reflectance s(4, A0, A1);", "Servos": "Servos s(9, 10);", "Spi": "Spi s(10);",
    "Steppers": "Stepper a(8, 9, 10, 11), b(2, 3, 4); Steppers s(a, b);",
    "Thermometers": "OneWireBus bus(2); ThermometersOf<8> s(bus);", "Tone": "Tone s(9);", "Weather": "Weather s;"}

TOGETHER, MOST = ("I2cChips", "Thermometers", "Dht"), (12288, 550)


def near(told, measured):
    return abs(int(told.replace(",", "")) - measured) <= max(16, measured // 100)


def size(root, build, folder, *services):
    """Flash and RAM of a sketch, in bytes."""
    include = "".join(f"#include <Asip{service}.h>\n" for service in services)
    declared = "\n".join(SERVICES[service].replace(" s", f" s{at}", 1) if at else SERVICES[service] for at, service in enumerate(services))
    added = "".join(f"board.add(s{at or ''});" for at in range(len(services)))
    if services == TOGETHER:
        declared = declared.replace("ThermometersOf<8>", "ThermometersOf<1>")
    (folder / "sketch.cpp").write_text(f"#include <Arduino.h>\n#include <Asip.h>\n#include <AsipFastSerial.h>\n{include}using namespace asip;\n{declared}\n"
                                       f'void setup() {{ {added} board.begin(ASIP_NAME("Sketch")); }}\nvoid loop() {{ board.run(); }}\n')
    chip = ["-mmcu=atmega328p", "-Os", "-g", "-flto"]
    subprocess.run(["avr-g++", "-std=gnu++11", "-fpermissive", "-fno-exceptions", "-fno-threadsafe-statics", "-ffunction-sections", "-fdata-sections",
                    *chip, "-DF_CPU=16000000L", "-DARDUINO=10819", "-DARDUINO_ARCH_AVR", f"-I{CORE}/cores/arduino", f"-I{CORE}/variants/standard",
                    f"-I{root}/firmware/src", "-c", folder / "sketch.cpp", "-o", folder / "sketch.o"], check=True)
    subprocess.run(["avr-gcc", *chip, "-fuse-linker-plugin", "-Wl,--gc-sections", "-o", folder / "sketch.elf", folder / "sketch.o",
                    build / "firmware/library_uno/asip.a", build / "firmware/core_uno/core.a", "-lm"], check=True)
    told = subprocess.run(["avr-size", folder / "sketch.elf"], check=True, capture_output=True, text=True).stdout
    text, data, bss = map(int, told.splitlines()[1].split()[:3])
    return text + data, data + bss


def main(root, build, writes):
    page = root / "docs/sensors.md"
    text, faults, seen = page.read_text(), 0, set()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        flash, ram = size(root, build, folder)

        def row(found):
            nonlocal faults
            service = found[2]
            seen.add(service)
            sizes = size(root, build, folder, service)
            right = f"{found[1]}| {sizes[0] - flash:,} | {sizes[1] - ram} |"
            if near(found[3], sizes[0] - flash) and near(found[4], sizes[1] - ram):
                return found[0]
            faults += 1
            print(f"docs/sensors.md: {service}: is {right[len(found[1]):]}")
            return right
        text = re.sub(r"^(\|.*`Asip(\w+)\.h` )\| ([\d,]+) \| (\d+) \|$", row, text, flags=re.MULTILINE)
        told = re.search(r"the pins alone \(([\d,]+) and (\d+)\)", text)
        if not told or not near(told[1], flash) or not near(told[2], ram):
            pins = f"the pins alone ({flash:,} and {ram})"
            faults += 1
            print(f"docs/sensors.md: {pins}")
            text = text.replace(told[0], pins) if told else text
        sizes = size(root, build, folder, *TOGETHER)
        told = re.search(r"one DHT22 take ([\d,]+) and (\d+) together", text)
        if not told or not near(told[1], sizes[0]) or not near(told[2], sizes[1]):
            together = f"one DHT22 take {sizes[0]:,} and {sizes[1]} together"
            faults += 1
            print(f"docs/sensors.md: {together}")
            text = text.replace(told[0], together) if told else text
        if sizes[0] > MOST[0] or sizes[1] > MOST[1]:
            faults += 1
            print(f"{', '.join(TOGETHER)} take {sizes[0]} and {sizes[1]} bytes together, more than {MOST[0]} and {MOST[1]}")
            writes = False
    for service in sorted(SERVICES.keys() - seen):
        print(f"docs/sensors.md has no row of Asip{service}.h")
        faults += 1
    if writes:
        page.write_text(text)
    return 0 if faults == 0 or writes else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), "--write" in sys.argv))
