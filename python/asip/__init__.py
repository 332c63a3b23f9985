# SPDX-License-Identifier: Apache-2.0
"""Boards on an ASIP service bus, in ten lines.

    import asip

    with asip.connect() as bus:
        desk = bus.board("desk")
        print(desk.distance.read())        # [42, None]
        desk.servo.write(0, 90)            # returns when the board has executed it, or raises
        desk.pin(13).on()

Importing the package opens no connection. `asip.aio` has the same names for asyncio, `asip.testing` a bus in memory.
"""
# Type checkers know the name TYPE_CHECKING, which each module sets itself: importing `typing` would be a fifth of what this package adds to paho.
from ._version import __version__
from .board import Board
from .bus import Bus, connect
from .errors import BoardError, Closed, Disconnected, Error, Invalid, NotThere, Refused, Unproven
from .pin import Pin
from .property import Property
from .service import Service
from .stream import Reading

__all__ = ["Board", "BoardError", "Bus", "Closed", "Disconnected", "Error", "Invalid", "NotThere", "Pin", "Property", "Reading", "Refused",
           "Service", "Unproven", "__version__", "connect"]
