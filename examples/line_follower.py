# SPDX-License-Identifier: Apache-2.0
"""Drives a two-wheeled robot along a dark line. When this program dies, the robot's agent stops the motors.

    python3 line_follower.py [BOARD [BROKER]] [--power 50] [--kp 0.015] [--ki 0] [--kd 0] [--period 50] [--cutoff 50]
"""
import argparse
import signal

import asip

parser = argparse.ArgumentParser(description="Drives a robot along a line. Ctrl-C stops it.")
parser.add_argument("board", nargs="?", default="mirto")
parser.add_argument("broker", nargs="?", help="HOST:PORT; else that of the environment")
parser.add_argument("--power", type=float, default=50, help="on a straight line, percent")
parser.add_argument("--kp", type=float, default=0.015, help="gain of the error")
parser.add_argument("--ki", type=float, default=0, help="gain of its sum")
parser.add_argument("--kd", type=float, default=0, help="gain of its change")
parser.add_argument("--period", type=int, default=50, help="milliseconds between two measurements")
parser.add_argument("--cutoff", type=int, default=50, help="sensor values below it are floor")
options = parser.parse_args()
error = total = 0.0


def motor(percent):
    return round(2.55 * max(-100, min(100, percent)))


def drive(sensors):
    """Powers for the left and the right motor; the right one is mounted the other way round. IR 0 is the right sensor."""
    global error, total
    before = error
    right, middle, left = (value if value >= options.cutoff else 0 for value in sensors)
    if left + middle + right > 0:
        error = (2000 * middle + 4000 * right) / (left + middle + right) - 2000
    total += error
    turn = options.kp * error + options.ki * total + options.kd * (error - before)
    return [motor(options.power + turn), -motor(options.power - turn)]


def stop(*_):
    raise KeyboardInterrupt


signal.signal(signal.SIGTERM, stop)
try:
    with asip.connect(options.broker) as bus:
        robot = bus.board(options.board)
        print(robot.name, "follows the line", flush=True)
        robot.reflectance.report(options.period)
        try:
            with robot.motors.hold(drive=[0, 0], seconds=0.5, feed=1.0) as motors:
                for sensors in robot.reflectance.stream():
                    motors.set(drive=drive(sensors))
        finally:
            robot.reflectance.report(0)
except KeyboardInterrupt:
    pass
