# SPDX-License-Identifier: Apache-2.0
"""The library on RISC-V (RV32IMAC), in qemu's model of a HiFive1: system messages, extensions and the I/O service over its UART, and
as a board of a bus."""

import json
import os
import socket
import subprocess
import time
import unittest

from bus import BIN, IMAGES, Bus, die_with_parent, eventually, free_port


class Chip:
    """The emulator, with the board's line as a TCP port."""

    def __init__(self):
        self.port, self.control = free_port(), free_port()
        self.process = subprocess.Popen(
            [os.environ["ASIP_QEMU"], "-M", "sifive_e", "-display", "none", "-monitor", "none", "-qmp", f"tcp:127.0.0.1:{self.control},server=on,wait=off",
             "-serial", f"tcp:127.0.0.1:{self.port},server=on,wait=off,nodelay=on", "-kernel", str(IMAGES / "asip_riscv.elf")],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=die_with_parent)

    def word(self, address):
        """The chip's memory, as its registers show it."""
        with socket.create_connection(("127.0.0.1", self.control), timeout=20) as control:
            stream = control.makefile("rw")
            for command in ({"execute": "qmp_capabilities"},
                            {"execute": "human-monitor-command", "arguments": {"command-line": f"xp /1wx {address:#x}"}}):
                stream.write(json.dumps(command) + "\n")
                stream.flush()
                while "return" not in (answer := json.loads(stream.readline())):
                    pass
        return int(answer["return"].split(":")[1], 16)

    def connect(self):
        return eventually(lambda: socket.create_connection(("127.0.0.1", self.port), timeout=20), "the board's line")

    def close(self):
        self.process.kill()
        self.process.wait()


class Line:
    def __init__(self, chip):
        self.socket = chip.connect()
        self.lines = self.socket.makefile("rb")
        self.socket.sendall(b"\nI,A,0\n#,E,start\n")
        while self.lines.readline() != b"@#,E,start\n":
            pass

    def ask(self, request):
        """All lines until a fence behind it, joined by '|'."""
        self.socket.sendall(request.encode() + b"\n#,E,f\n")
        found = []
        while (line := self.lines.readline().decode().rstrip("\n")) != "@#,E,f":
            self.check(line)
            found.append(line)
        return "|".join(found)

    def check(self, line):
        if not line:
            raise AssertionError("the line has ended")

    def close(self):
        self.lines.close()
        self.socket.close()


class OnItsLine(unittest.TestCase):
    def setUp(self):
        self.chip = Chip()
        self.addCleanup(self.chip.close)
        self.line = Line(self.chip)
        self.addCleanup(self.line.close)

    def expect(self, *pairs):
        for request, answer in pairs:
            self.assertEqual(self.line.ask(request), answer, request)

    def test_system_messages(self):
        self.expect(("#,?", "@#,?,0,4,FE310,32,AsipPlainSerial"), ("#,N", "@#,N,1,{I:ASIP core IO}"), ("#,X", "@#,X,6,{E:1,I:1,B:1,C:1,V:1,D:1}"),
                    ("Z,x", "~Z,?,1{INVALID_SERVICE}"), ("#,y", "~#,y,2{UNKNOWN_REQUEST}"), ("#,I,desk", "@#,I,"))
        self.assertTrue(self.line.ask("#,S").startswith("@#,S,32,{I,I,"))

    def test_pins(self):
        self.assertTrue(self.line.ask("I,M").startswith("@I,M,32,{0:1,0:2,0:4,0:8,0:10,0:20,0:40,0:80,1:1,"))
        self.expect(("I,P,31,3", ""), ("I,d,31,1", ""), ("I,P,31,1", "@I,d,3,0"), ("I,P,5,2", "@I,d,0,20"), ("I,P,6,2", "@I,d,0,60"),
                    ("I,P,5,1", "@I,d,0,40"), ("I,P,16,3", "~I,P,4{MODE_UNAVAILABLE}"), ("I,P,17,3", "~I,P,4{MODE_UNAVAILABLE}"),
                    ("I,P,0,3", ""), ("I,a,5,64", "~I,a,3{INVALID_PIN}"), ("I,P,5,4", "~I,P,4{MODE_UNAVAILABLE}"),
                    ("I,P,32,3", "~I,P,3{INVALID_PIN}"), ("I,d,256,1", "~I,d,3{INVALID_PIN}"), ("I,m", "@I,m,0,{}"))
        self.assertTrue(self.line.ask("I,c").startswith("@I,c,32,{1,1,"))

    def test_what_was_written_is_on_the_pin(self):
        enabled, level, pull_up = 0x10012008, 0x1001200c, 0x10012010
        for pin in (0, 7, 8, 15, 24, 31):
            self.expect((f"I,P,{pin},3", ""), (f"I,d,{pin},1", ""))
            self.assertEqual([self.chip.word(address) >> pin & 1 for address in (enabled, level)], [1, 1], pin)
            self.expect((f"I,d,{pin},0", ""))
            self.assertEqual(self.chip.word(level) >> pin & 1, 0, pin)
            self.line.ask(f"I,P,{pin},2")
            self.assertEqual([self.chip.word(address) >> pin & 1 for address in (enabled, pull_up)], [0, 1], pin)

    def test_extensions(self):
        self.line.ask("#,V,a")
        first = self.line.ask("I,P,3,3\n#,V,b")
        self.assertEqual(first, self.line.ask("I,P,3,3\n#,V,b"))
        self.line.socket.sendall(b"#,C,1\n#,E,ok*62\n#,E,oj*62\n#,E,ok*62\n")
        self.assertEqual([self.line.lines.readline() for _ in range(3)], [b"@#,E,ok*22\n", b"~#,C,10{BAD_CHECKSUM}*0C\n", b"@#,E,ok*22\n"])

    def test_a_request_without_a_line_end_is_executed_after_a_second(self):
        self.line.socket.sendall(b"#,B,57600\n")
        self.assertEqual(self.line.lines.readline(), b"@#,B,57600\n")
        time.sleep(0.1)  # what comes before the switch is dropped
        self.line.socket.sendall(b"I,m")
        began = time.monotonic()
        self.assertEqual(self.line.lines.readline(), b"@I,m,0,{}\n")
        self.assertGreater(time.monotonic() - began, 0.7)

    def test_a_flood_is_answered_line_by_line(self):
        self.line.socket.sendall(b"#,?\n" * 500)
        for _ in range(500):
            self.assertEqual(self.line.lines.readline(), b"@#,?,0,4,FE310,32,AsipPlainSerial\n")


class OnTheBus(unittest.TestCase):
    def test_it_is_listed_and_commanded(self):
        chip = Chip()
        self.addCleanup(chip.close)
        bus = Bus(())
        self.addCleanup(bus.close)
        bus.start("agent", "asip-agent", "--tcp", f"127.0.0.1:{chip.port}", "--name", "riscv", "--lease", "6", "--patience", "60")
        eventually(lambda: bus.state("riscv") == "online", "the board", 60)

        def asipctl(*words):
            return subprocess.run([str(BIN / "asipctl"), "--broker", f"127.0.0.1:{bus.broker_port}", *words], check=True,
                                  capture_output=True, text=True, timeout=60).stdout
        self.assertRegex(asipctl("list"), r"riscv +online +FE310 +AsipPlainSerial +io")
        asipctl("pin", "riscv", "5", "output")
        asipctl("pin", "riscv", "5", "high")


if __name__ == "__main__":
    unittest.main()
