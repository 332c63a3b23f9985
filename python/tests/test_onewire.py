# SPDX-License-Identifier: Apache-2.0
"""A 1-Wire bus as drivers see it: which commands it gives. A recorded service stands for the board."""
import errno
import io
import unittest

from asip import errors
from asip.onewire import OneWire, over


class Recorded:
    def __init__(self):
        self.seen, self.ids, self.fault, self.present = [], [], None, 1

    def command(self, name, *args, timeout=None):
        self.seen.append([name, *args])
        if self.fault:
            raise self.fault
        if name == "reset":
            return self.present
        if name == "find":
            return self.ids[args[0]] if args[0] < len(self.ids) else ""
        read, write = args
        assert read <= 16 and len(write) <= 32
        return bytes(range(read)).hex().upper()


ROM = bytes.fromhex("28FF641D8316036C")


class OneWireBus(unittest.TestCase):
    def setUp(self):
        self.board = Recorded()
        self.wire = OneWire(self.board, 5)

    def test_device_is_chosen_in_the_request_of_what_it_is_told(self):
        self.assertTrue(self.wire.reset())
        self.wire.write(b"\x55")
        self.wire.write(ROM)
        self.assertEqual(self.board.seen, [["reset"]])
        self.wire.write(b"\x4e")
        self.wire.write(bytearray(b"\1\2\3\4"), start=1, end=3)
        into = bytearray(b"\xff" * 4)
        self.wire.readinto(into, start=1, end=3)
        self.assertEqual(self.board.seen[1:], [["transfer", 0, "5528FF641D8316036C4E"], ["continue", 0, "0203"], ["continue", 2, ""]])
        self.assertEqual(into, b"\xff\0\1\xff")

    def test_all_devices_or_one_that_is_read_at_once(self):
        self.wire.reset()
        self.wire.write(b"\xcc\x44")
        self.wire.reset()
        self.wire.write(b"\x33")  # read the id
        into = bytearray(8)
        self.wire.readinto(into)
        self.wire.readinto(bytearray())
        self.assertEqual(self.board.seen, [["reset"], ["transfer", 0, "CC44"], ["reset"], ["transfer", 0, "33"], ["continue", 8, ""]])

    def test_more_than_a_request_holds_is_several(self):
        self.wire.reset()
        self.wire.write(b"\xcc" + bytes(range(1, 33)))
        into = bytearray(20)
        self.wire.readinto(into)
        self.assertEqual([one[:2] for one in self.board.seen],
                         [["reset"], ["transfer", 0], ["continue", 0], ["continue", 0], ["continue", 16], ["continue", 4]])
        self.assertEqual(bytes.fromhex("".join(one[2] for one in self.board.seen[1:4])), b"\xcc" + bytes(range(1, 33)))
        self.assertEqual(into, bytes(range(16)) + bytes(range(4)))

    def test_scan_finds_ids(self):
        self.board.ids = [ROM.hex().upper(), "10A0A1A2A3A4A5A6"]
        first, second = self.wire.scan()
        self.assertEqual((first.rom, first.family_code, first.serial_number, first.crc), (ROM, 0x28, ROM[1:7], 0x6C))
        self.assertEqual(second.family_code, 0x10)
        self.wire.maximum_devices = 1
        self.assertRaises(RuntimeError, self.wire.scan)
        self.assertEqual(OneWire.crc8(b"\x02\x1c\xb8\x01\0\0\0\xa2"), 0, "an example of Maxim's")

    def test_faults_are_of_the_operating_system(self):
        self.board.present = 0
        self.assertFalse(self.wire.reset())
        with self.assertRaises(OSError) as caught:
            self.wire.reset(required=True)
        self.assertEqual(caught.exception.errno, errno.ENODEV)
        for fault, number in ((errors.BoardError("DEVICE_NOT_AVAILABLE", code=8), errno.ENODEV), (errors.BoardError("BAD_ARGUMENT", code=11), errno.EIO),
                              (errors.Unproven("?"), errno.ETIMEDOUT)):
            self.board.fault = fault
            with self.assertRaises(OSError) as caught:
                self.wire.write(b"\xcc\x44")
            self.assertEqual((caught.exception.errno, caught.exception.__cause__), (number, fault))
        self.board.fault = None
        self.assertEqual(self.wire.scan(), [])

    def test_point_to_point_the_same_are_lines(self):
        class Line(io.BytesIO):
            asked = b""

            def write(self, data):
                self.asked += data
        line = Line(b"@O,R,0\r\n@O,R,1\r\n@O,T,\r\n@O,t,9101\r\n@O,S,28FF641D8316036C\r\n@O,S,\r\n~O,R,8{DEVICE_NOT_AVAILABLE}\r\n")
        wire, into = over(line), bytearray(2)
        self.assertFalse(wire.reset())
        self.assertTrue(wire.reset())
        wire.write(b"\xcc\xbe")
        wire.readinto(into)
        self.assertEqual(into, b"\x91\x01")
        self.assertEqual([one.rom for one in wire.scan()], [ROM])
        self.assertEqual(line.asked, b"O,R\nO,R\nO,T,0,CCBE\nO,t,2,\nO,S,0\nO,S,1\n")
        with self.assertRaises(OSError) as caught:
            wire.reset()
        self.assertEqual(caught.exception.errno, errno.ENODEV)


if __name__ == "__main__":
    unittest.main()
