# SPDX-License-Identifier: Apache-2.0
# A button on one board lights the LED of another: the two-board switch of the ASIP paper.
import asip

with asip.connect() as bus:
    button, led = bus.board("desk").pin(2), bus.board("lamp").pin(13)
    button.on_change(lambda level: led.write(not level), initial=True)
    bus.run()
