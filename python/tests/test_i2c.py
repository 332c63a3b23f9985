# SPDX-License-Identifier: Apache-2.0
"""Transfers on an I2C bus: which commands they are, and what drivers get. A recorded bus stands for the board: it does what the
commands say, and notes what goes over its two wires."""
import errno
import io
import unittest

from asip import _chips, errors
from asip.i2c import I2C, SMBus, over


class Wires:
    """The service: one chip at 0x50 whose bytes count up from the register that was written last. `S`, `P` and bytes stand in `seen`."""

    def __init__(self):
        self.seen, self.lists, self.fault = "", 0, None
        self._open, self._next = None, 0

    def command(self, name, *args, timeout=None):
        return [0x50] if name == "scan" else self._do([(name, args)])[0]

    def _together(self, commands, what, *, timeout=None):
        return [{"answer": answer} for answer in self._do([*one.items()][0] for one in commands)]

    def _do(self, commands):
        self.lists += 1
        if self.fault:
            raise self.fault
        answers = []
        for name, args in commands:
            hexes = [one for one in args if isinstance(one, str)]
            assert all(len(one) <= 2 * 25 for one in hexes)
            if name == "transfer":
                address, read, write = args
                self._write(address, write, read == 0 or write)
                answers.append(self._read(address, read, True) if read else "")
                self.seen += "P"
            elif name == "open":
                assert self._open in (None, args[0])
                self._open, self._address, self._way = args[0], args[1], ""
                if args[2]:
                    self._write(args[1], args[2], True)
                    self._way = "w"
            else:
                assert args[0] == self._open, "the number of the transfer"
                if name == "send":
                    assert self._way == "w"
                    self.seen += args[1].lower()
                elif name == "receive":
                    answers.append(self._read(self._address, args[1], self._way != "r"))
                    self._way = "r" if args[2] else ""
                else:
                    if args[2]:
                        assert self._way == "w"
                        self.seen += args[2].lower()
                    answers.append(self._read(self._address, args[1], self._way != "r") if args[1] else "")
                    self._open = None
                    self.seen += "P"
        assert self._open is None, "the bus is free"
        return answers

    def _write(self, address, text, starts):
        if starts:
            self.seen += f"S{address:02x}w{text.lower()}"
            if text:
                self._next = int(text[:2], 16)

    def _read(self, address, count, starts):
        assert 1 <= count <= 16
        data = bytes((self._next + at) & 255 for at in range(count))
        self._next += count
        self.seen += (f"S{address:02x}r" if starts else "") + data.hex()
        return data.hex().upper()

    def taken(self):
        seen, self.seen = self.seen, ""
        return seen


class Shapes(unittest.TestCase):
    def setUp(self):
        self.wires = Wires()
        transfers = _chips.Transfers(self.wires)
        self.i2c, self.smbus = I2C(transfers), SMBus(transfers)

    def test_each_length_is_one_transfer_and_one_request_of_the_board(self):
        for written in [*range(0, 60), 200, 1025]:
            for read in [0, 1, 15, 16, 17, 32, 33, 100]:
                with self.subTest(written=written, read=read):
                    self.wires.lists = 0
                    out, into = bytes(at & 255 for at in range(7, 7 + written)), bytearray(read)
                    if read == 0:
                        self.i2c.writeto(0x50, out)
                    elif written == 0:
                        self.wires._next = 7
                        self.i2c.readfrom_into(0x50, into)
                    else:
                        self.i2c.writeto_then_readfrom(0x50, out, into)
                    wanted = bytes((7 + at) & 255 for at in range(read))
                    self.assertEqual(into, wanted)
                    self.assertEqual(self.wires.taken(), ("" if read and not written else f"S50w{out.hex()}") + (f"S50r{wanted.hex()}" if read else "") + "P")
                    self.assertEqual(self.wires.lists, 1)

    def test_parts_of_buffers_are_those_that_start_and_end_say(self):
        into = bytearray(6)
        self.i2c.writeto(0x50, b"\x01\x02\x03\x04", start=1, end=3)
        self.i2c.readfrom_into(0x50, into, start=2, end=4)
        self.assertEqual(into.hex(), "000002030000")
        self.i2c.writeto_then_readfrom(0x50, bytearray(b"\x09\x08\x07"), into, out_start=1, out_end=2, in_start=5)
        self.assertEqual(self.wires.taken(), "S50w0203PS50r0203PS50w08S50r08P")
        self.i2c.readfrom_into(0x50, into, start=6)
        self.assertEqual(self.wires.taken(), "", "no byte, no transfer")

    def test_lock_is_that_of_busio(self):
        self.assertTrue(self.i2c.try_lock())
        self.assertFalse(self.i2c.try_lock())
        self.i2c.unlock()
        self.assertTrue(self.i2c.try_lock())

    def test_smbus_calls_are_the_packets_of_the_specification(self):
        bus = self.smbus
        bus.write_quick(0x50)
        bus.write_byte(0x50, 3)
        self.assertEqual(bus.read_byte(0x50), 3)
        self.assertEqual(bus.read_byte_data(0x50, 9), 9)
        bus.write_byte_data(0x50, 1, 2)
        self.assertEqual(bus.read_word_data(0x50, 0x10), 0x1110)
        bus.write_word_data(0x50, 1, 0x1234)
        self.assertEqual(bus.process_call(0x50, 1, 0x1234), 0x0201)
        self.assertEqual(self.wires.taken(), "S50wPS50w03PS50r03PS50w09S50r09PS50w0102PS50w10S50r1011PS50w013412PS50w013412S50r0102P")
        self.assertEqual(bus.read_i2c_block_data(0x50, 0x20, 3), [0x20, 0x21, 0x22])
        bus.write_i2c_block_data(0x50, 1, [2, 3])
        bus.write_block_data(0x50, 1, [9, 8])
        self.assertEqual(self.wires.taken(), "S50w20S50r202122PS50w010203PS50w01020908P")
        self.assertEqual(bus.read_block_data(0x50, 2), [3, 4])
        with self.assertRaises(OSError):
            bus.pec = 1
        bus.pec = 0

    def test_messages_of_smbus2_are_one_transfer(self):
        class Message:
            def __init__(self, addr, flags, data):
                self.addr, self.flags, self.buf, self.len = addr, flags, [bytes([one]) for one in data], len(data)

            def __iter__(self):
                return (one[0] for one in self.buf)
        first, second, third = Message(0x50, 0, b"\x05"), Message(0x50, 1, bytes(20)), Message(0x51, 0, b"\x07" * 40)
        last = Message(0x51, 1, bytes(2))
        self.smbus.i2c_rdwr(first, second, third, last)
        self.assertEqual(b"".join(second.buf), bytes(range(5, 25)))
        self.assertEqual(b"".join(last.buf), b"\x07\x08")
        self.assertEqual(self.wires.taken(), f"S50w05S50r{bytes(range(5, 25)).hex()}S51w{'07' * 40}S51r0708P")
        self.smbus.i2c_rdwr()
        self.assertEqual(self.wires.taken(), "")

    def test_each_fault_is_an_oserror_with_the_number_that_drivers_know(self):
        board = {code: errors.BoardError("text", code=code) for code in (6, 8, 9, 12, 13, 14, 15, 16, 99)}
        numbers = {6: errno.ETIMEDOUT, 8: errno.EBUSY, 9: errno.ENODEV, 12: errno.EREMOTEIO, 13: errno.EIO, 14: errno.EBUSY, 15: errno.ETIMEDOUT,
                   16: errno.EMSGSIZE, 99: errno.EIO}
        cases = [(board[code], numbers[code]) for code in board] + [
            (errors.Unproven("no answer"), errno.ETIMEDOUT), (errors.NotThere("gone"), errno.ENODEV), (errors.Refused("full", reason="queue-full"), errno.EAGAIN),
            (errors.Invalid("wrong"), errno.EINVAL)]
        for self.wires.fault, number in cases:
            with self.assertRaises(OSError) as caught:
                self.i2c.writeto(0x50, b"")
            self.assertEqual(caught.exception.errno, number)
            self.assertIs(caught.exception.__cause__, self.wires.fault)
        self.wires.fault = None
        self.i2c.writeto(0x50, b"")
        for wrong in (-1, 128):
            with self.assertRaises(ValueError):
                self.i2c.writeto(wrong, b"")
        with self.assertRaises(OSError) as caught:
            self.i2c.writeto(0x50, bytes(2000))
        self.assertEqual(caught.exception.errno, errno.EMSGSIZE)


class Line(io.BytesIO):
    """The line of a board: what it answers was written down before."""

    def __init__(self, *answers):
        super().__init__("".join(one + "\r\n" for one in answers).encode())
        self.asked = b""

    def write(self, data):
        self.asked += data
        return len(data)


class Board(io.RawIOBase):
    """The line of a board that answers each request by the next answer of its tag, None by nothing, and echoes."""

    def __init__(self, silent=0, **answers):
        super().__init__()
        self.asked, self._silent = [], silent
        self._answers = {tag: list(texts) for tag, texts in answers.items()}
        self._said = []

    def write(self, data):
        for line in data.decode().splitlines():
            self.asked.append(line)
            if len(self.asked) <= self._silent:
                continue
            answer = f"@{line}" if line.startswith("#") else self._answers[line[2]].pop(0)
            if answer:
                self.say(answer)
        return len(data)

    def say(self, line):
        self._said.append(line)

    def readline(self):
        return f"{self._said.pop(0)}\r\n".encode() if self._said else b""

    def unread(self):
        return self._said


class PointToPoint(unittest.TestCase):
    def test_requests_are_lines_and_reports_of_others_pass(self):
        line = Line("@I,a,1,{0:5}", "@J,t,60", "@J,s,2,{60,118}", "@J,s,0,{}")
        i2c, into = over(line), bytearray(1)
        i2c.writeto_then_readfrom(118, b"\xd0", into)
        self.assertEqual(into, b"\x60")
        self.assertEqual([i2c.scan(), i2c.scan()], [[60, 118], []])
        self.assertEqual(line.asked, b"J,t,118,1,D0\nJ,s\nJ,s\n")

    def test_parts_of_a_long_transfer_are_fenced(self):
        board = Board(o=[""], e=["@J,e,"])
        over(board).writeto(60, bytes(range(20)))
        opened, fence, ended = board.asked
        number = opened.split(",")[2]
        self.assertEqual((opened, fence[:4], ended), (f"J,o,{number},60,{bytes(range(18)).hex().upper()}", "#,E,", f"J,e,{number},0,1213"))

    def test_fault_of_the_board_and_its_silence_are_oserrors(self):
        for answers, number in ((["~J,t,12{ADDRESS_NOT_ACKNOWLEDGED 60}"], errno.EREMOTEIO), ([], errno.ETIMEDOUT), (["~J,?,1{INVALID_SERVICE}"], errno.EIO)):
            with self.assertRaises(OSError) as caught:
                over(Line(*answers)).writeto(60, b"\x00")
            self.assertEqual(caught.exception.errno, number)

    def test_echo_behind_an_error_is_no_echo_of_the_next_transfer(self):
        board = Board(o=["~J,o,8{DEVICE_NOT_AVAILABLE}"] * 2 + [""], e=["@J,e,"], s=["@J,s,1,{60}"])
        i2c = over(board)
        for _ in range(2):
            with self.assertRaises(OSError) as caught:
                i2c.writeto(60, bytes(20))
            self.assertEqual(caught.exception.errno, errno.EBUSY)
        i2c.writeto(60, bytes(20))
        self.assertEqual(i2c.scan(), [60])
        self.assertEqual(board.unread(), [])

    def test_late_answer_is_not_that_of_the_next_transfer(self):
        for late in ("@J,t,5800", "~J,t,12{ADDRESS_NOT_ACKNOWLEDGED 118}"):
            board = Board(t=[None, "@J,t,0102", "@J,t,0304"], s=["@J,s,1,{60}"])
            i2c, into = over(board), bytearray(2)
            with self.assertRaises(OSError) as caught:
                i2c.writeto_then_readfrom(118, b"\xd0", into)
            self.assertEqual(caught.exception.errno, errno.ETIMEDOUT)
            board.say(late)
            for expected in (b"\x01\x02", b"\x03\x04"):
                i2c.writeto_then_readfrom(60, b"\xd0", into)
                self.assertEqual(into, expected)
            self.assertEqual(i2c.scan(), [60])
            self.assertEqual([line for line in board.asked if line.startswith("#")], board.asked[1:2], "one fence, before the next transfer")

    def test_board_that_stays_silent_is_asked_for_nothing_more(self):
        board = Board(t=[None], silent=2)
        i2c = over(board)
        for _ in range(2):
            with self.assertRaises(OSError) as caught:
                i2c.writeto(60, b"\x00")
            self.assertEqual(caught.exception.errno, errno.ETIMEDOUT)
        self.assertEqual([line[:4] for line in board.asked], ["J,t,", "#,E,"])


if __name__ == "__main__":
    unittest.main()
