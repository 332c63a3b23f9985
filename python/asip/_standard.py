# SPDX-License-Identifier: Apache-2.0
"""The standard services, for type checkers: made of the service models by generate_standard.py."""
from __future__ import annotations

from typing import Any, Sequence

from .service import Service


class Acceleration(Service):
    """Accelerometer (acceleration@1)."""

    def measure(self, *, timeout: float | None = None) -> Any:
        """Measure once.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Bump(Service):
    """Bump sensors (bump@1)."""

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Distance(Service):
    """Ultrasonic distance sensors (distance@1)."""

    def measure(self, *, timeout: float | None = None) -> Any:
        """Measure once.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Encoders(Service):
    """Wheel encoders (encoders@1)."""

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Gyroscope(Service):
    """Gyroscope (gyroscope@1)."""

    def measure(self, *, timeout: float | None = None) -> Any:
        """Measure once.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Heading(Service):
    """Compass (heading@1)."""

    def measure(self, *, timeout: float | None = None) -> Any:
        """Measure once.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Humidity(Service):
    """Humidity sensor (humidity@1)."""

    def measure(self, *, timeout: float | None = None) -> Any:
        """Measure once.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Io(Service):
    """Pins: digital and analog input and output (io@1)."""

    def mode(self, pin: int, mode: int | str, *, timeout: float | None = None) -> None:
        """Set the mode of a pin.

        pin: integer, 0 to 255
        mode: integer, 0 to 5 or "unallocated", "input", "input-pullup", "output", "analog", "pwm"

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def write(self, pin: int, level: int | str, *, timeout: float | None = None) -> None:
        """Set the level of an output pin.

        pin: integer, 0 to 255
        level: integer, 0 to 1 or "low", "high", "off", "on"

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def pwm(self, pin: int, duty: int, *, timeout: float | None = None) -> None:
        """Set the duty of a PWM pin.

        pin: integer, 0 to 255
        duty: integer, 0 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report analog pins periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def levels(self, *, timeout: float | None = None) -> Any:
        """Ask for the levels of all input pins (boards with the extension D).

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def ports(self, *, timeout: float | None = None) -> Any:
        """Ask for port and bit of each pin.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def channels(self, *, timeout: float | None = None) -> Any:
        """Ask for the analog channels.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def modes(self, *, timeout: float | None = None) -> Any:
        """Ask for the mode of each pin.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def capabilities(self, *, timeout: float | None = None) -> Any:
        """Ask what each pin can do.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Lcd(Service):
    """Display of 5 lines of 21 characters (lcd@1)."""

    def write(self, line: int, text: str, *, timeout: float | None = None) -> None:
        """Write a line.

        line: integer, 0 to 4
        text: text

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def clear(self, *, timeout: float | None = None) -> None:
        """Clear the display.

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def bars(self, bars: Sequence[Any], *, timeout: float | None = None) -> None:
        """Draw bars.

        bars: list of line:percent

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Motors(Service):
    """Direct-current motors (motors@1)."""

    def power(self, motor: int, power: int, *, timeout: float | None = None) -> None:
        """Set the power of one motor.

        motor: integer, 0 to 255
        power: integer, -255 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def drive(self, power0: int, power1: int, *, timeout: float | None = None) -> None:
        """Set the power of the first two motors at once.

        power0: integer, -255 to 255
        power1: integer, -255 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def stop(self, motor: int, *, timeout: float | None = None) -> None:
        """Stop one motor.

        motor: integer, 0 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def stop_all(self, *, timeout: float | None = None) -> None:
        """Stop every motor.

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Neopixels(Service):
    """Strips of WS2812 pixels, each pixel by its own request (neopixels@1)."""

    def color(self, strip: int, pixel: int, red: int, green: int, blue: int, *, timeout: float | None = None) -> None:
        """Set the color of one pixel, shown by show.

        strip: integer, 0 to 255
        pixel: integer, 0 to 65535
        red: integer, 0 to 255
        green: integer, 0 to 255
        blue: integer, 0 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def brightness(self, strip: int, brightness: int, *, timeout: float | None = None) -> None:
        """Set the brightness of a strip.

        strip: integer, 0 to 255
        brightness: integer, 0 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def show(self, strip: int, *, timeout: float | None = None) -> None:
        """Show what was set.

        strip: integer, 0 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Pixels(Service):
    """Strip of WS2812 pixels (pixels@1)."""

    def set(self, pixels: Sequence[Any], *, timeout: float | None = None) -> None:
        """Set single pixels.

        pixels: list of pixel:color

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def fill(self, first: int, colors: Sequence[Any], *, timeout: float | None = None) -> None:
        """Set pixels that follow each other.

        first: integer, 0 to 65535
        colors: list of color

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def brightness(self, brightness: int, *, timeout: float | None = None) -> None:
        """Set the brightness of the strip.

        brightness: integer, 0 to 255

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def count(self, *, timeout: float | None = None) -> Any:
        """Ask how many pixels there are.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Pressure(Service):
    """Pressure sensor (pressure@1)."""

    def measure(self, *, timeout: float | None = None) -> Any:
        """Measure once.

        Returns the board's answer.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Reflectance(Service):
    """Infrared reflectance sensors (reflectance@1)."""

    def report(self, period: int, *, timeout: float | None = None) -> None:
        """Report periodically; 0 stops.

        period: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Servo(Service):
    """Servo motors (servo@1)."""

    def write(self, servo: int, angle: int, *, timeout: float | None = None) -> None:
        """Turn a servo to an angle.

        servo: integer, 0 to 255
        angle: integer, 0 to 180 degrees

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """

    def remap(self, pins: Sequence[Any], *, timeout: float | None = None) -> None:
        """Use these pins instead.

        pins: list of pin

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """


class Tone(Service):
    """Tone on a loudspeaker or buzzer (tone@1)."""

    def play(self, frequency: int, duration: int, *, timeout: float | None = None) -> None:
        """Play a tone; later requests do not wait for its end.

        frequency: integer, 0 to 65535 Hz
        duration: integer, 0 to 65535 ms

        Returns when the board has executed it.
        Raises one of asip.errors: Invalid, BoardError, Refused, NotThere, Unproven, Disconnected.
        """
