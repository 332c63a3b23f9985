# SPDX-License-Identifier: Apache-2.0
"""The board's button on pin 2 switches its LED on pin 13, and what its distance sensors report is printed.

    python3 lamp.py [BOARD]         on the bus of ASIP_BROKER, of asipctl, or of this machine
"""
import sys

import asip

with asip.connect() as bus:
    board = bus.board(sys.argv[1] if len(sys.argv) > 1 else "uno1")
    print(board.name, "is", board.state)
    board.pin(2).on_change(lambda level: board.pin(13).write(not level), initial=True)
    board.distance.report(100)
    board.distance.on_value(lambda value: print("distance", value, board.distance.unit, flush=True))
    bus.run()
