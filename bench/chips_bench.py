#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a chip on a board's I2C bus costs a program, beside what wires need at least: one register read over the bus and point to point, a frame of a
display.

    bench_chips [ROUNDS]    so many rounds of each, 5 when not given; the best one counts

The board is a simulated Uno with the real firmware, at 57,600 baud and at 500,000; its I2C bus has 100 kHz.
"""
import pathlib
import socket
import statistics
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "tests" / "support")]
READS = 200
FRAMES = 5
SLOW, FAST = 57_600, 500_000
ADDRESS, DISPLAY, IDENTITY = 0x76, 0x3C, 0xD0
FRAME = b"\x40" + bytes(at * 37 & 255 for at in range(1024))
REGISTER_BYTES = len("J,t,118,1,D0\n@J,t,60\r\n")


def i2c_seconds(data_bytes, starts=1):
    """At 100 kHz: nine bits for a byte and an address, one each for a START and the STOP."""
    return (9 * (data_bytes + starts) + starts + 1) / 100_000


def frame_line_bytes():
    """What the requests of a frame have, each with its line end and checksum."""
    from asip import _chips
    requests = _chips.commands_of([(DISPLAY, FRAME)], 7)
    return sum(len(",".join(["J,w", *map(str, args)])) + len("\n*00") for _, args in requests)


def milliseconds(what, count):
    samples = []
    for _ in range(count):
        began = time.perf_counter()
        what()
        samples.append((time.perf_counter() - began) * 1000)
    return statistics.median(samples)


def best(rounds, what, count):
    return min(milliseconds(what, count) for _ in range(rounds))


def read_of(i2c, into):
    return lambda: i2c.writeto_then_readfrom(ADDRESS, bytes([IDENTITY]), into)


def row(what, ours, beside, must, aim):
    ratio = ours / beside
    verdict = "ok" if ratio <= must else "MISSED"
    print(f"{what:<82} {ours:10.3f} {beside:10.3f} ms        ratio {ratio:5.2f}  must {must:4.1f}  aim {aim:4.1f}  {verdict}", flush=True)
    return ratio <= must


def main():
    import bus as bus_module
    import asip
    import asip.i2c
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    port = bus_module.free_port()
    board = {"name": "desk", "board": "uno", "image": str(bus_module.IMAGES / "asip_uno_i2c.elf"), "link": "desk.port", "tcp": port,
             "parts": [{"kind": "ssd1306", "name": "display"}, {"kind": "bme280", "name": "weather"}]}

    class Real(bus_module.Bus):
        def start_agent(self, name):
            path = self.work / f"{name}.port"
            bus_module.eventually(path.exists, "the port of the board")
            config = self.work / "agent.conf"
            config.write_text(f"max-baud = {FAST}\n")
            self.start(f"agent-{name}", "asip-agent", "--config", str(config), "--serial", str(path), "--name", name, "--patience", "60")
    good = []
    print(f"{'':<82} {'asip':>10} {'wires':>10}")
    real = Real((board,))
    try:
        with asip.connect(f"mqtt://127.0.0.1:{real.broker_port}", timeout=20) as bus:
            desk = bus.board("desk", timeout=20)
            bus_module.eventually(lambda: desk.description["link"].get("baud") == FAST, "the line is stepped up")
            i2c, into = desk.i2c(timeout=20), bytearray(1)
            ping = best(rounds, lambda: desk.raw("#,?"), READS)
            register = best(rounds, read_of(i2c, into), READS)
            assert into[0] == 0x60
            wire = i2c_seconds(2, 2) * 1000
            good.append(row("a register read over MQTT at 500,000 baud, p50, over a ping and the I2C wire", register, ping + wire, 1.3, 1.1))
            frame = best(rounds, lambda: i2c.writeto(DISPLAY, FRAME), FRAMES)
            wires = (i2c_seconds(len(FRAME)) + frame_line_bytes() * 10 / FAST) * 1000
            good.append(row("a frame of an SSD1306 over MQTT at 500,000 baud, over the I2C wire and the line", frame, wires, 1.5, 1.2))
        real.end("agent-desk")
        with socket.create_connection(("127.0.0.1", port), 20) as connection, connection.makefile("rwb") as stream:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            i2c = asip.i2c.over(stream)
            bus_module.eventually(lambda: ADDRESS in i2c.scan(), "the board answers")
            register = best(rounds, read_of(i2c, into), READS)
            wires = (REGISTER_BYTES * 10 / SLOW + i2c_seconds(2, 2)) * 1000
            good.append(row("a register read point to point at 57,600 baud, p50, over both wires", register, wires, 1.3, 1.1))
    finally:
        real.close()
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
