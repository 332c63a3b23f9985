# SPDX-License-Identifier: Apache-2.0
# mypy --strict finds a fault in each line that says so.
import asip
from lab import Board

with asip.connect() as bus:
    desk = bus.board("desk", Board)
    desk.sevro.write(0, 90)  # fault
    desk.servo.write(0, "up")  # fault
    desk.servo.wirte(0, 90)  # fault
    desk.pin(13).on(1.0)  # fault
    desk.property(13)  # fault
    desk.property("io/13").wirte(True)  # fault
