# SPDX-License-Identifier: Apache-2.0
"""Drivers as their authors published them on PyPI, unmodified, on the I2C, SPI and 1-Wire buses of simulated boards, over a real broker and agent.
Each reads what its simulated chip was told to measure, or shows on it what is then read back."""

import errno
import json
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import threading
import types
import unittest

sys.path[:0] = [os.environ["ASIP_DRIVERS"] + f"/lib/python{sys.version_info[0]}.{sys.version_info[1]}/site-packages"]

import bus as bus_module  # noqa: E402
from bus import Bus, eventually, free_port  # noqa: E402

sys.path.insert(0, str(bus_module.ROOT / "python"))
import asip  # noqa: E402
import asip.i2c  # noqa: E402
import asip.onewire  # noqa: E402
import asip.spi  # noqa: E402


def board(name, display, *parts):
    return {"name": name, "board": "uno", "image": str(bus_module.IMAGES / "asip_uno_i2c.elf"), "link": f"{name}.port",
            "parts": [{"kind": display, "name": f"{name}-display"}, *parts]}


CHIPS = [{"kind": "mpu6050", "name": "motion", "ax": 8192, "ay": -4096, "az": 16384, "gx": 262, "gy": -524, "gz": 0},
         {"kind": "bmp085", "name": "barometer", "pressure": 987.6, "temperature": 21.3},
         {"kind": "hmc5883l", "name": "compass", "x": 100, "y": -20, "z": 30},
         {"kind": "ads1115", "name": "voltages", "a0": 1.25, "a1": 3.3, "a2": -0.1, "a3": 0.02},
         {"kind": "pca9685", "name": "outputs"}]
AIR = [{"kind": "bme280", "name": "weather", "temperature": 21.5, "humidity": 45, "pressure": 987.6},
       {"kind": "sht31", "name": "air", "temperature": -3.25, "humidity": 80}, {"kind": "bh1750", "name": "light", "lux": 347.5}]
MORE = [{"kind": "bme280", "name": "pressure", "bmp280": True, "address": 0x77, "temperature": 18.25, "pressure": 1002.5},
        {"kind": "registers", "name": "thermometer", "address": 0x18, "width": 2, "values": "05=C1A4,06=0054,07=0400"},
        {"kind": "registers", "name": "current", "address": 0x40, "width": 2, "values": "01=0FA0,02=5DC2,03=0190,04=07D0"},
        {"kind": "registers", "name": "clock", "address": 0x68, "values": "11=19,12=40"},
        {"kind": "registers", "name": "expander", "address": 0x20, "values": "13=04"},
        {"kind": "registers", "name": "segments", "address": 0x70}]
WIRE = {"name": "wire", "board": "uno", "image": str(bus_module.IMAGES / "asip_uno_onewire.elf"), "link": "wire.port",
        "parts": [{"kind": "ds18b20", "name": "wires", "pin": 2,
                   "devices": [{"number": 1, "temperature": 21.5}, {"number": 2, "temperature": -3.0625}, {"number": 3, "temperature": 85}]}]}
ANALOG = {"name": "analog", "board": "uno", "image": str(bus_module.IMAGES / "asip_uno_spi.elf"), "link": "analog.port",
          "parts": [{"kind": "mcp3008", "name": "volts", "select": 10, "v0": 2.5, "v3": 1.25}, {"kind": "mcp3008", "name": "others", "select": 9, "v7": 5}]}
SECONDS = 20


class Drivers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.real = Bus((board("desk", "ssd1306", *CHIPS), board("wall", "sh1106", *AIR), board("shed", "ssd1306", *MORE), WIRE, ANALOG))
        cls.addClassCleanup(cls.real.close)

    def setUp(self):
        self.bus = asip.connect(f"mqtt://127.0.0.1:{self.real.broker_port}", timeout=SECONDS)
        self.addCleanup(self.bus.close)
        self.desk = self.bus.board("desk", timeout=SECONDS)
        self.wall = self.bus.board("wall", timeout=SECONDS)
        self.i2c, self.smbus = self.desk.i2c(timeout=SECONDS), self.desk.smbus(timeout=SECONDS)

    def picture(self, display):
        """The pixels of a display, rows of `0` and `1`."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "display.pbm"
            self.real.sim("picture", display, str(file))
            eventually(lambda: file.exists() and file.read_text().count("\n") == 66, "the picture is written")
            return file.read_text().split("\n")[2:66]

    def test_block_of_the_page_runs_as_it_stands(self):
        text = (bus_module.ROOT / "docs" / "python.md").read_text()
        block = re.search(r"```python\n(import adafruit.*?)```", text, re.DOTALL)[1]
        path = os.pathsep.join([str(bus_module.ROOT / "python"), sys.path[0], *sys.path])
        done = subprocess.run([sys.executable, "-c", block], capture_output=True, text=True, timeout=60,
                              env={**os.environ, "ASIP_BROKER": f"127.0.0.1:{self.real.broker_port}", "PYTHONPATH": path})
        self.assertEqual(done.stderr, "")
        self.assertRegex(done.stdout, r"^\(4\.9\d*, .*\)\n0x68\n$")

    def test_scan_finds_the_chips(self):
        self.assertEqual(self.i2c.scan(), [0x1E, 0x3C, 0x40, 0x48, 0x68, 0x77])

    def test_adafruit_mpu6050(self):
        import adafruit_mpu6050
        sensor = adafruit_mpu6050.MPU6050(self.i2c)
        for measured, told in zip(sensor.acceleration, (0.5, -0.25, 1)):
            self.assertAlmostEqual(measured, told * 9.80665, 2)
        for measured, told in zip(sensor.gyro, (2, -4, 0)):
            self.assertAlmostEqual(measured, told * 3.14159265 / 180, 3)
        sensor.accelerometer_range = adafruit_mpu6050.Range.RANGE_8_G
        self.assertAlmostEqual(sensor.acceleration[2], 9.80665, 2)

    def test_mpu6050_raspberrypi(self):
        """A program of smbus."""
        sys.modules["smbus"] = types.SimpleNamespace(SMBus=lambda port: self.smbus)
        import mpu6050
        sensor = mpu6050.mpu6050(0x68)
        self.assertEqual(sensor.get_accel_data(g=True), {"x": 0.5, "y": -0.25, "z": 1.0})
        self.assertEqual(sensor.get_gyro_data(), {"x": 2.0, "y": -4.0, "z": 0.0})

    def test_bmp180(self):
        """A program of smbus2."""
        import bmp180.bmp180 as module
        module.SMBus = lambda port: self.smbus
        sensor = module.BMP180()
        self.assertAlmostEqual(sensor.read_temperature(), 21.3, delta=0.11)

    def test_messages_of_smbus2(self):
        from smbus2 import i2c_msg
        register, field = i2c_msg.write(0x1E, [0x0A]), i2c_msg.read(0x1E, 3)
        self.smbus.i2c_rdwr(register, field)
        self.assertEqual(bytes(field), b"H43")
        register, words = i2c_msg.write(0x77, [0xAA]), i2c_msg.read(0x77, 22)
        self.smbus.i2c_rdwr(register, words)
        self.assertEqual(bytes(words).hex(), "0198ffb8c7d17fe57ff55a71182e00048000ddf90b34")

    def test_adafruit_bme280(self):
        from adafruit_bme280 import advanced, basic
        i2c = self.wall.i2c(timeout=SECONDS)
        sensor = basic.Adafruit_BME280_I2C(i2c, 0x76)
        self.assertAlmostEqual(sensor.temperature, 21.5, delta=0.02)
        self.assertAlmostEqual(sensor.relative_humidity, 45, delta=0.1)
        self.assertAlmostEqual(sensor.pressure, 987.6, delta=0.1)
        sensor = advanced.Adafruit_BME280_I2C(i2c, 0x76)
        sensor.overscan_pressure = advanced.OVERSCAN_X16
        self.assertAlmostEqual(sensor.pressure, 987.6, delta=0.1)

    def test_adafruit_sht31d(self):
        import adafruit_sht31d
        sensor = adafruit_sht31d.SHT31D(self.wall.i2c(timeout=SECONDS))
        self.assertEqual(sensor.serial_number, 0x0A51B731)
        self.assertAlmostEqual(sensor.temperature, -3.25, delta=0.01)
        self.assertAlmostEqual(sensor.relative_humidity, 80, delta=0.01)
        sensor.heater = True
        self.assertTrue(sensor.heater)
        sensor.heater = False
        self.real.sim("damage", "wall/air", "1")
        with self.assertRaisesRegex(RuntimeError, "CRC"):
            sensor.temperature  # noqa: B018 - reading it is the test
        self.assertAlmostEqual(sensor.temperature, -3.25, delta=0.01)

    def test_adafruit_bh1750(self):
        import adafruit_bh1750
        sensor = adafruit_bh1750.BH1750(self.wall.i2c(timeout=SECONDS))
        self.assertAlmostEqual(sensor.lux, 347.5, delta=0.9)
        sensor.resolution = adafruit_bh1750.Resolution.LOW
        self.assertAlmostEqual(sensor.lux, 347.5, delta=4)

    def shed(self):
        return self.bus.board("shed", timeout=SECONDS).i2c(timeout=SECONDS)

    def test_adafruit_bmp280(self):
        import adafruit_bmp280
        sensor = adafruit_bmp280.Adafruit_BMP280_I2C(self.shed())
        self.assertAlmostEqual(sensor.temperature, 18.25, delta=0.02)
        self.assertAlmostEqual(sensor.pressure, 1002.5, delta=0.1)

    def test_adafruit_mcp9808(self):
        import adafruit_mcp9808
        sensor = adafruit_mcp9808.MCP9808(self.shed())
        self.assertEqual(sensor.temperature, 26.25)
        sensor.upper_temperature = 30
        self.assertEqual((sensor.upper_temperature, sensor.above_critical, sensor.above_upper), (30, True, True))
        sensor.resolution = 1
        self.assertEqual(sensor.resolution, 1)

    def test_adafruit_ina219(self):
        from adafruit_ina219 import INA219, ADCResolution
        sensor = INA219(self.shed())
        self.assertAlmostEqual(sensor.shunt_voltage, 0.04)
        self.assertAlmostEqual(sensor.bus_voltage, 12)
        self.assertAlmostEqual(sensor.current, 200)
        self.assertAlmostEqual(sensor.power, 0.8)
        sensor.bus_adc_resolution = ADCResolution.ADCRES_12BIT_32S
        self.assertEqual((sensor.bus_adc_resolution, sensor.conversion_ready), (ADCResolution.ADCRES_12BIT_32S, True))

    def test_adafruit_ds3231(self):
        import time
        import adafruit_ds3231
        clock = adafruit_ds3231.DS3231(self.shed())
        told = time.struct_time((2026, 11, 28, 16, 5, 59, 5, -1, -1))
        clock.datetime = told
        self.assertEqual(tuple(clock.datetime)[:7], tuple(told)[:7])
        clock.alarm1 = (told, "daily")
        self.assertEqual(clock.alarm1[1], "daily")
        self.assertEqual(clock.temperature, 25.25)

    def test_adafruit_mcp23017(self):
        from adafruit_mcp230xx.mcp23017 import MCP23017
        chip = MCP23017(self.shed())
        lamp, button = chip.get_pin(3), chip.get_pin(10)
        lamp.switch_to_output(value=True)
        button.direction = type(lamp.direction).INPUT
        self.assertTrue(button.value)
        eventually(lambda: "12=08" in self.real.part("shed/expander"), "the lamp is on")
        lamp.value = False
        eventually(lambda: "12=" not in self.real.part("shed/expander"), "the lamp is off")

    def test_adafruit_ht16k33(self):
        from adafruit_ht16k33.segments import Seg7x4
        display = Seg7x4(self.shed())
        display.print("12.34")
        display.brightness = 0.5
        eventually(lambda: self.real.part("shed/segments") == "00=06,02=DB,06=4F,08=66", "the digits are lit")

    def test_adafruit_ds18x20(self):
        from adafruit_ds18x20 import DS18X20
        wire = self.bus.board("wire", timeout=SECONDS).onewire(timeout=SECONDS)
        found = wire.scan()
        self.assertEqual([wire.crc8(one.rom) for one in found], [0, 0, 0])
        sensors = [DS18X20(wire, one) for one in found]
        self.assertEqual(sorted(one.temperature for one in sensors), [-3.0625, 21.5, 85])
        sensors[0].resolution = 9
        self.assertEqual([one.resolution for one in sensors], [9, 12, 12])
        self.real.sim("short", "wire/wires")
        with self.assertRaises(OSError) as caught:
            sensors[1].read_temperature()
        self.assertEqual(caught.exception.errno, errno.ENODEV)
        self.real.sim("unshort", "wire/wires")
        self.assertAlmostEqual(sensors[1].temperature, sensors[1].read_temperature())

    def test_adafruit_mcp3008(self):
        from adafruit_mcp3xxx.analog_in import AnalogIn
        from adafruit_mcp3xxx.mcp3008 import MCP3008
        spi = self.bus.board("analog", timeout=SECONDS).spi(timeout=SECONDS)
        volts, others = (MCP3008(spi, spi.chip_select(pin), ref_voltage=5) for pin in (10, 9))
        for chip, pin, told in ((volts, 0, 2.5), (volts, 3, 1.25), (others, 7, 5), (others, 0, 0)):
            self.assertAlmostEqual(AnalogIn(chip, pin).voltage, told, delta=0.01)
        with self.assertRaises(OSError) as caught:
            AnalogIn(MCP3008(spi, spi.chip_select(8), ref_voltage=5), 0).voltage  # noqa: B018 - reading it is the test
        self.assertEqual(caught.exception.errno, errno.EIO)

    def test_adafruit_ads1x15(self):
        from adafruit_ads1x15 import ads1x15
        from adafruit_ads1x15.ads1115 import ADS1115
        from adafruit_ads1x15.analog_in import AnalogIn
        chip = ADS1115(self.i2c)
        pins = getattr(ads1x15, "Pin", None)
        number = (lambda at: getattr(pins, f"A{at}")) if pins is not None and hasattr(pins, "A0") else (lambda at: at)
        for at, told in enumerate((1.25, 3.3, -0.1, 0.02)):
            self.assertAlmostEqual(AnalogIn(chip, number(at)).voltage, told, 3)
        self.assertAlmostEqual(AnalogIn(chip, number(0), number(1)).voltage, -2.05, 3)
        chip.gain = 16
        self.assertAlmostEqual(AnalogIn(chip, number(3)).voltage, 0.02, 5)

    def test_adafruit_pca9685_and_a_servo(self):
        from adafruit_motor import servo
        from adafruit_pca9685 import PCA9685
        chip = PCA9685(self.i2c)
        chip.frequency = 50
        chip.channels[15].duty_cycle = 0xFFFF
        servo.Servo(chip.channels[0], min_pulse=1000, max_pulse=2000).angle = 90  # 1.5 of 20 ms: 307 of 4096
        eventually(lambda: self.real.part("desk/outputs") in [f"50 Hz 0:{slots} 15:4096" for slots in range(305, 309)], "the outputs are set")

    def test_adafruit_ssd1306_each_pixel(self):
        import adafruit_ssd1306
        display = adafruit_ssd1306.SSD1306_I2C(128, 64, self.i2c)
        display.fill(0)
        wanted = [["0"] * 128 for _ in range(64)]
        for y in range(64):
            for x in range(128):
                if (x * 7 + y * 13) % 11 < 3:
                    display.pixel(x, y, 1)
                    wanted[y][x] = "1"
        display.show()
        self.assertEqual(self.picture("desk-display"), ["".join(row) for row in wanted])

    def luma(self, device, display, smbus):
        from luma.core.interface.serial import i2c
        from luma.core.render import canvas
        from PIL import ImageDraw, Image
        screen = device(i2c(bus=smbus, address=0x3C))
        self.addCleanup(lambda: setattr(screen, "persist", True))
        screen.persist = True  # else it is cleared at the end of the program, behind the end of the bus

        def draw(on):
            on.rectangle((0, 0, 127, 63), outline="white")
            on.text((30, 40), "Hello World", fill="white")
            on.ellipse((5, 5, 40, 35), fill="white")
        with canvas(screen) as on:
            draw(on)
        wanted = Image.new("1", (128, 64))
        draw(ImageDraw.Draw(wanted))
        rows = ["".join("1" if wanted.getpixel((x, y)) else "0" for x in range(128)) for y in range(64)]
        self.assertIn("1", "".join(rows))
        self.assertEqual(self.picture(display), rows)

    def test_luma_oled_sh1106_each_pixel(self):
        from luma.oled.device import sh1106
        self.luma(sh1106, "wall-display", self.wall.smbus(timeout=SECONDS))

    def test_luma_oled_ssd1306_each_pixel(self):
        from luma.oled.device import ssd1306
        self.luma(ssd1306, "desk-display", self.smbus)

    def test_frame_of_a_display_is_one_transfer_and_one_command(self):
        from smbus2 import i2c_msg
        self.smbus.write_i2c_block_data(0x3C, 0, [0xAE, 0x20, 0x00, 0xA1, 0xC8, 0xAF])
        for picture in (bytes(1024), bytes(at * 37 & 255 for at in range(1024))):
            self.smbus.write_i2c_block_data(0x3C, 0, [0x21, 0, 127, 0x22, 0, 7])
            self.smbus.i2c_rdwr(i2c_msg.write(0x3C, [0x40, *picture]))
            rows = ["".join(str(picture[y // 8 * 128 + x] >> y % 8 & 1) for x in range(128)) for y in range(64)]
            self.assertEqual(self.picture("desk-display"), rows)

    def test_chip_that_is_missing_is_what_each_package_says_of_it(self):
        import adafruit_mpu6050
        import luma.core.error
        from luma.core.interface.serial import i2c
        for ask in (lambda: self.smbus.read_byte_data(0x50, 0), lambda: self.smbus.read_i2c_block_data(0x50, 0, 32),
                    lambda: self.smbus.write_i2c_block_data(0x50, 0, bytes(100)), lambda: self.i2c.readfrom_into(0x50, bytearray(50))):
            with self.assertRaises(OSError) as caught:
                ask()
            self.assertEqual(caught.exception.errno, errno.EREMOTEIO)
            self.assertRegex(str(caught.exception), "ADDRESS_NOT_ACKNOWLEDGED 80")
        with self.assertRaisesRegex(ValueError, "No I2C device at address: 0x50"):
            adafruit_mpu6050.MPU6050(self.i2c, 0x50)
        with self.assertRaises(luma.core.error.DeviceNotFoundError):
            i2c(bus=self.smbus, address=0x50).command(0xAE)
        self.assertEqual(self.smbus.read_byte_data(0x68, 0x75), 0x68)

    def test_two_programs_on_one_bus_each_transfer_is_whole(self):
        other = asip.connect(f"mqtt://127.0.0.1:{self.real.broker_port}", timeout=SECONDS)
        self.addCleanup(other.close)
        faults, words = [], []

        def program(bus, rounds):
            try:
                smbus = bus.board("desk", timeout=SECONDS).smbus(timeout=SECONDS)
                words.extend(bytes(smbus.read_i2c_block_data(0x77, 0xAA, 22)).hex() for _ in range(rounds))
            except Exception as fault:  # noqa: BLE001 - it is told below
                faults.append(fault)
        threads = [threading.Thread(target=program, args=(bus, 20)) for bus in (self.bus, other)]
        for one in threads:
            one.start()
        for one in threads:
            one.join(60)
        self.assertEqual(faults, [])
        self.assertEqual(words, ["0198ffb8c7d17fe57ff55a71182e00048000ddf90b34"] * 40)

    def bare(self, told):
        """The stream of a board that has no agent."""
        port, name = free_port(), told["name"]
        file = self.real.work / f"{name}.json"
        file.write_text(json.dumps({**told, "tcp": port}))
        self.real.start(name, "asip-sim", "--socket", str(self.real.work / f"{name}.sock"), str(file))
        self.addCleanup(self.real.end, name)
        eventually(lambda: bus_module.can_connect(port), "the port of the board")
        connection = socket.create_connection(("127.0.0.1", port), SECONDS)
        self.addCleanup(connection.close)
        stream = connection.makefile("rwb")
        self.addCleanup(stream.close)
        return stream

    def test_1_wire_and_spi_without_an_agent_point_to_point(self):
        from adafruit_ds18x20 import DS18X20
        from adafruit_mcp3xxx.analog_in import AnalogIn
        from adafruit_mcp3xxx.mcp3008 import MCP3008
        wire = asip.onewire.over(self.bare({**WIRE, "name": "barewire", "link": "barewire.port"}))
        sensors = [DS18X20(wire, one) for one in wire.scan()]
        self.assertEqual(sorted(one.temperature for one in sensors), [-3.0625, 21.5, 85])
        spi = asip.spi.over(self.bare({**ANALOG, "name": "bareanalog", "link": "bareanalog.port"}))
        self.assertAlmostEqual(AnalogIn(MCP3008(spi, spi.chip_select(10), ref_voltage=5), 3).voltage, 1.25, delta=0.01)

    def test_board_without_an_agent_point_to_point(self):
        from luma.core.interface.serial import i2c as luma_i2c
        from luma.oled.device import sh1106
        import adafruit_mpu6050
        stream = self.bare(board("bare", "sh1106", CHIPS[0]))
        i2c = asip.i2c.over(stream)
        eventually(lambda: 0x68 in i2c.scan(), "the board answers")
        self.assertAlmostEqual(adafruit_mpu6050.MPU6050(i2c).acceleration[0], 0.5 * 9.80665, 2)
        with self.assertRaises(OSError) as caught:
            i2c.writeto(0x50, bytes(40))
        self.assertEqual(caught.exception.errno, errno.EREMOTEIO)
        sh1106(luma_i2c(bus=asip.i2c.smbus_over(stream), address=0x3C)).persist = True
        self.assertEqual(i2c.scan(), [0x3C, 0x68])


if __name__ == "__main__":
    unittest.main()
