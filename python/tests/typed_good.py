# SPDX-License-Identifier: Apache-2.0
# mypy --strict finds nothing here.
import asip
from lab import Board

with asip.connect() as bus:
    bus.board("desk").servo.write(0, 90)
    desk = bus.board("desk", Board)
    desk.servo.write(0, angle=90)
    desk.io.mode(13, "output")
    desk.pin(13).on(timeout=1.0)
    desk["servo/0/angle"].value = 90
    desk.set_meaning("io/2", "door", inverted=True)
    print([(one.id, one.text, one.read(timeout=1.0)) for one in desk.properties])
    for value in desk.distance.stream(hz=5):
        print(value)
