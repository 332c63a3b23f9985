"""Makes docs/images/page.png anew: the page of a simulated board, with its plot and a servo that was moved."""

import math
import time

from rig import DESK, ROOT, PageTest, eventually

PICTURE = ROOT / "docs" / "images" / "page.png"
SECONDS = 50  # of the plot


class Picture(PageTest):
    boards = (DESK,)

    def test_Page_IsPhotographed(self):
        self.open_board()
        report = self.form("distance", "Report periodically; 0 stops")
        self.fill(report, "Period", "50")
        self.send(report)
        self.answered(report, "ok", "Done")
        began = time.monotonic()
        while (passed := time.monotonic() - began) < SECONDS:
            self.bus.sim("set", "desk/distance", f"{70 + 45 * math.sin(passed / 4):.0f}")
            time.sleep(0.2)
        servo = self.form("servo", "Turn a servo to an angle")
        self.fill(servo, "Angle", "120")
        self.send(servo)
        self.answered(servo, "ok", "proof: fence")
        eventually(lambda: abs(float(self.bus.part("desk/servo")) - 120) < 2, "the servo at 120 degrees")
        self.browser.run("document.activeElement.blur(); scrollTo(0, 0)")
        self.browser.driver.save_screenshot(str(PICTURE))
