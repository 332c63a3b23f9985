# SPDX-License-Identifier: Apache-2.0
"""An SPI bus as drivers see it: which commands it gives. A recorded service stands for the board, and answers each byte by its complement."""
import errno
import io
import threading
import unittest

from asip import errors
from asip.spi import SPI, over


class Recorded:
    def __init__(self):
        self.seen, self.lists, self.fault, self.lost_release = [], 0, None, None

    def command(self, name, *args, timeout=None):
        assert name == "transfer" and len(args[-1]) <= 32
        self.seen.append(list(args))
        if self.fault or (self.lost_release and not args[-1]):
            raise self.fault or self.lost_release
        return bytes(255 - byte for byte in bytes.fromhex(args[-1])).hex().upper()

    def _together(self, commands, what, *, timeout=None):
        assert len(commands) <= 64
        self.lists += 1
        return [{"answer": self.command("transfer", *one["transfer"])} for one in commands]


class SpiBus(unittest.TestCase):
    def setUp(self):
        self.board = Recorded()
        self.spi = SPI(self.board, 5, threading.Lock())

    def test_chip_is_chosen_from_its_first_byte_to_its_pin(self):
        select = self.spi.chip_select(10)
        select.switch_to_output(value=True)
        self.spi.configure(baudrate=1_000_000, polarity=1, phase=0)
        select.value = False
        self.assertEqual(self.board.seen, [])
        self.spi.write(b"\1\2\3", start=1, end=2)
        into = bytearray(b"....")
        self.spi.readinto(into, start=1, end=3, write_value=0x0F)
        self.assertEqual(into, b".\xf0\xf0.")
        select.value = True
        self.assertEqual(self.board.seen, [[10, 1000, 2, 1, "02"], [10, 1000, 2, 1, "0F0F"], [10, 1000, 2, 0, ""]])
        select.value = False
        select.value = True
        self.spi.write(b"\7")
        self.assertEqual(self.board.seen[3:], [[255, 1000, 2, 0, "07"]], "no chip, and nothing for one that was told nothing")

    def test_more_than_a_request_holds_is_one_command_of_several(self):
        self.spi.chip_select(9).value = False
        data = bytes(range(40))
        into = bytearray(40)
        self.spi.write_readinto(data, into)
        self.assertEqual(into, bytes(255 - byte for byte in data))
        self.assertEqual((self.board.lists, [one[3] for one in self.board.seen]), (1, [1, 1, 1]))
        self.spi.write(bytes(1100))
        self.assertEqual(self.board.lists, 3)

    def test_lock_settings_and_faults(self):
        self.assertTrue(self.spi.try_lock())
        self.assertFalse(self.spi.try_lock())
        self.spi.unlock()
        for wrong in ({"bits": 9}, {"polarity": 2}, {"baudrate": 10}):
            self.assertRaises(ValueError, self.spi.configure, **wrong)
        self.assertEqual(self.spi.frequency, 100000)
        self.assertRaises(ValueError, self.spi.write_readinto, b"12", bytearray(3))
        self.board.fault = errors.BoardError("DEVICE_NOT_AVAILABLE", code=8)
        with self.assertRaises(OSError) as caught:
            self.spi.write(b"1")
        self.assertEqual(caught.exception.errno, errno.EBUSY)
        self.board.fault = None
        self.spi.write(b"1")

    def test_transfer_whose_end_is_lost_is_over(self):
        """As the SPIDevice of drivers does it: it gives the lock back behind the pin, and only if that raises nothing."""
        select = self.spi.chip_select(10)
        for self.board.lost_release in (errors.Unproven("no answer"), errors.BoardError("DEVICE_NOT_AVAILABLE", code=8)):
            self.board.seen.clear()
            self.assertTrue(self.spi.try_lock())
            select.value = False
            self.spi.write(b"1")
            select.value = True
            self.spi.unlock()
            self.assertTrue(select.value)
            self.spi.write(b"2")
            self.assertEqual([(one[0], one[3], one[4]) for one in self.board.seen], [(10, 1, "31"), (10, 0, ""), (255, 0, "32")])

    def test_point_to_point_the_same_are_lines(self):
        class Line(io.BytesIO):
            asked = b""

            def write(self, data):
                self.asked += data
        line = Line(b"@I,a,1,{0:5}\r\n@V,t," + b"00" * 16 + b"\r\n@V,t,FF\r\n@V,t,\r\n~V,t,3{INVALID_PIN}\r\n")
        spi, into = over(line), bytearray(17)
        select = spi.chip_select(10)
        select.value = False
        spi.write_readinto(bytes(range(17)), into)
        select.value = True
        self.assertEqual(into, bytes(16) + b"\xff")
        self.assertEqual(line.asked, b"V,t,10,100,0,1,000102030405060708090A0B0C0D0E0F\nV,t,10,100,0,1,10\nV,t,10,100,0,0,\n")
        with self.assertRaises(OSError) as caught:
            spi.write(b"1")
        self.assertEqual(caught.exception.errno, errno.EIO)


if __name__ == "__main__":
    unittest.main()
