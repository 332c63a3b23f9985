# SPDX-License-Identifier: Apache-2.0
"""The floor of a simulated robot on the page: drawn, live, and for people who do not see it."""

import pathlib
import re
import signal
import unittest

from rig import BUILD, IMAGES, ROOT, PageTest, eventually

MIRTO = {"name": "mirto", "board": "uno", "image": str(IMAGES / "asip_uno_mirto.elf"), "link": "mirto.port",
         "world": str(ROOT / "sim" / "worlds" / "track.json"), "parts": [{"kind": "rover", "name": "rover"}]}
AXE = pathlib.Path(BUILD, "axe-core/node_modules/axe-core/axe.min.js")


class World(PageTest):
    boards = (MIRTO,)
    simulator_options = ("--publish-world", "world")

    def setUp(self):
        super().setUp()
        self.bus.sim("place", "rover", "-60", "0", "0")
        self.bus.sim("clear", "rover")
        self.open("board/world")
        self.arrow()

    def arrow(self):
        """Where the page draws the rover: x, y and heading in the world's measures."""
        def drawn():
            found = self.browser.find("asip-world .rover[data-rover=mirto]")
            return found and [float(number) for number in
                              re.findall(r"-?[\d.]+", found[0].get_attribute("transform").split(")")[0])
                              + re.findall(r"-?[\d.]+", found[0].find_elements("css selector", "path")[0].get_attribute("transform"))]
        x, y, heading = eventually(drawn, "the rover's arrow")
        return x, -y, -heading

    def drive(self, left, right):
        return self.browser.driver.execute_async_script("""
            const [args, done] = arguments;
            fetch('api/boards/mirto/services/motors/commands/drive', { method: 'POST', headers: { 'Content-Type': 'application/json' },
              body: JSON.stringify(args) }).then((answer) => answer.json()).then(done);""", [left, right])

    def test_RoverThatDrives_MovesItsArrowAndLeavesAWay(self):
        eventually(lambda: abs(self.arrow()[0] + 60) < 1, "the arrow where the rover stands")
        self.assertEqual(self.drive(100, -100)["status"], "ok")
        eventually(lambda: self.arrow()[0] > 100, "the arrow on its way")
        self.assertEqual(self.drive(0, 0)["status"], "ok")
        self.assertLess(abs(self.arrow()[1]), 5)
        eventually(lambda: len(self.browser.find("asip-world .way.grade0")) > 0, "its way on the line")
        points = self.browser.run("return document.querySelector('asip-world .track').points.numberOfItems")
        self.assertGreater(points, 20)
        self.browser.screenshot("world")

    def test_RoverThatIsPutAside_IsDrawnThereAndItsWayIsWide(self):
        self.bus.sim("place", "rover", "200", "30", "90")
        eventually(lambda: self.arrow() == (200, 30, 90), "the arrow beside the line")
        self.drive(60, -60)
        wide = eventually(lambda: self.browser.find("asip-world .way.grade3"), "a way far from the line")
        self.drive(0, 0)
        self.assertEqual(self.browser.run("return getComputedStyle(arguments[0]).strokeWidth", wide[0]), "7px")
        self.browser.button("Clear the ways").click()
        eventually(lambda: len(self.browser.find("asip-world .way")) <= 1, "no ways")

    def test_RobotsPage_IsTwoScreensOfAPhone_AndItsMotorsComeFirst(self):
        self.addCleanup(self.browser.driver.get, "about:blank")  # last: what is open speaks Italian
        self.addCleanup(self.browser.run, "localStorage.clear()")
        for language in ("en", "de", "es", "fr", "it"):
            with self.subTest(language):
                self.browser.run("localStorage.setItem('asip-language', arguments[0])", language)
                self.browser.size(390, 844, mobile=True)
                self.browser.driver.get("about:blank")
                self.browser.driver.get(f"{self.bus.url}/#/board/mirto")
                self.browser.shown("asip-board.drives .controls-box form")
                self.browser.shown("asip-link .sign.good", seconds=30)
                eventually(lambda: self.browser.find("asip-board .value") and not [each for each in self.browser.find("asip-board .value") if each.text == "–"], "its values", 60)
                height = self.browser.run("return document.documentElement.scrollHeight")
                self.browser.size(390, height, mobile=True)
                self.browser.screenshot(f"phone-robot-{language}")
                self.assertLessEqual(height, 2 * 844)
                self.assertEqual(self.browser.run("return document.querySelectorAll('asip-board details[open] asip-plot').length"), 0)

    def test_NewObstacle_IsDrawnAndSaid(self):
        self.bus.sim("block", "rover", "700", "-490", "60")
        eventually(lambda: len(self.browser.find("asip-world .obstacles circle")) == 1, "the obstacle")
        label = self.browser.shown("asip-world svg")
        eventually(lambda: "1 obstacle" in label.get_attribute("aria-label"), "the obstacle in words")
        self.assertIn("mirto: on the line, at -60, 0 mm", label.get_attribute("aria-label"))
        self.assertIn("mirto: on the line", self.browser.text("asip-world .rovers"))

    def test_PoseIsAServiceToo_WithItsValues(self):
        eventually(lambda: "heading" in self.browser.text("asip-service"), "the values of the pose")
        self.assertEqual(len(self.browser.find("asip-service")), 1, "the floor is the picture alone")

    def test_AccessibleAndNoWiderThanAPhone_LightAndDark(self):
        self.browser.run(AXE.read_text())
        eventually(lambda: self.browser.find("asip-world .way-sign"), "what the colors mean")
        for scheme in ("light", "dark"):
            self.browser.color_scheme(scheme)
            eventually(lambda: self.browser.run("return document.getAnimations().length === 0"), "the colors in place")
            found = self.browser.driver.execute_async_script(
                "const [done] = arguments; axe.run({ resultTypes: ['violations'] }).then((result) => done(result.violations))")
            self.assertEqual([f"{each['id']}: {each['nodes'][0]['html'][:120]}" for each in found], [], scheme)
            self.browser.screenshot(f"world-{scheme}")
        self.browser.color_scheme("light")
        self.browser.size(360, 740, mobile=True)
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 360)
        picture = self.browser.shown("asip-world svg").rect
        self.assertGreater(picture["width"], 280)
        self.assertGreater(picture["height"], 100)
        self.browser.screenshot("phone-world")

    def test_ZLast_WorldThatIsKilled_IsLost_AndGoesOnWhenItIsBack_AndOfflineAtItsEnd(self):
        self.bus.end("sim", signal.SIGKILL)
        eventually(lambda: "lost" in self.browser.text(".title-row"), "lost")
        self.assertEqual(len(self.browser.find("asip-board.gone asip-world")), 1)
        (self.bus.work / "mirto.port").unlink()  # its number may be another program's by now
        self.bus.start("sim", "asip-sim", "--socket", str(self.bus.work / "sim.sock"), *self.simulator_options, str(self.bus.work / "mirto.json"))
        eventually(lambda: "online" in self.browser.text(".title-row"), "online again")
        self.bus.sim("place", "rover", "300", "20", "0")
        eventually(lambda: self.arrow() == (300, 20, 0), "the arrow of the new one")
        self.bus.end("sim")
        eventually(lambda: "offline" in self.browser.text(".title-row"), "offline")
        self.assertEqual(len(self.browser.find("asip-board.gone asip-world")), 1)


if __name__ == "__main__":
    unittest.main()
