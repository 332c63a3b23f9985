# SPDX-License-Identifier: Apache-2.0
"""How values were: a week with two power cuts, in the file of a real registry, on the page of a board and on a dashboard."""

import itertools
import json
import math
import signal
import time
import unittest
import urllib.request
from unittest import mock

from selenium.webdriver.support.ui import Select

import axe_test
from rig import DESK, Bus, Keys, eventually
from kept_values import DAY, MINUTE, write_kept

HOUR = 60 * MINUTE
VIEWS = itertools.repeat(axe_test.VIEWS)


class BusWithPast(Bus):
    """Its registry ran for a week; the power was cut twice, for five hours and for a day."""

    def start_all(self):
        now = self.now = int(time.time() * 1000)
        stretches = [(now - 7 * DAY, now - 5 * DAY), (now - 5 * DAY + 5 * HOUR, now - 3 * DAY), (now - 2 * DAY, now - 2 * MINUTE)]
        write_kept(self.work / "history.values.db", "desk", "distance/0", stretches, lambda at: 40 + 20 * math.sin(at / DAY * 2 * math.pi))
        super().start_all()


class Plots(axe_test.Axe):
    boards = (DESK,)

    def show(self, span):
        self.browser.button(span, "asip-plot").click()

    def plot(self):
        """Whether each part of the picture has a line, from what is drawn, with the note below it."""
        return self.browser.run("""
            const plot = [...document.querySelectorAll('asip-plot')].find((each) => each.offsetParent);
            const { canvas, kept, span } = plot;
            const to = plot.end ?? Date.now();
            const points = kept.shown(to - span, to)[0]?.points ?? [];
            const context = canvas.getContext('2d');
            const ratio = devicePixelRatio;
            const left = 48 * ratio;
            const color = plot.colors[0].match(/\\w\\w/g).map((each) => parseInt(each, 16));
            const drawn = Array.from({ length: 84 }, (_, i) => {
              const width = (canvas.width - left) / 84;
              const { data } = context.getImageData(Math.round(left + i * width + width / 4), 0, Math.max(1, Math.round(width / 2)), canvas.height - 20 * ratio);
              for (let at = 0; at < data.length; at += 4) if (data[at + 3] > 200 && color.every((each, k) => Math.abs(each - data[at + k]) < 40)) return '#';
              return '.';
            }).join('');
            return { drawn, note: plot.note.textContent, label: canvas.getAttribute('aria-label'), points: points.length, pressed: plot.querySelector('.plot-tools [aria-pressed=true]')?.textContent };""")

    def drawn(self, test, what):
        return eventually(lambda: (seen := self.plot()) and test(seen) and seen, what, 30)


class Week(Plots):
    @classmethod
    def make_bus(cls):
        return BusWithPast(cls.boards)

    @mock.patch("axe_test.NEXT", VIEWS)
    def test_WeekWithTwoPowerCuts_HasAGapForEach(self):
        self.start()
        self.go("board/desk", "asip-plot canvas")
        self.show("1 week")
        seen = self.drawn(lambda plot: plot["points"] > 100 and "#" in plot["drawn"], "a week")
        # Each part is two hours: the power was away for five hours after two days, and for a day after four.
        self.assertEqual(seen["pressed"], "1 week")
        self.assertEqual(seen["drawn"][1:24], "#" * 23)
        self.assertEqual(seen["drawn"][24:26], "..")
        self.assertEqual(seen["drawn"][27:48], "#" * 21)
        self.assertEqual(seen["drawn"][48:60], "." * 12)
        self.assertEqual(seen["drawn"][61:83], "#" * 22)
        self.assertIn("Registry first has kept this since", seen["note"])
        self.drawn(lambda plot: "19\u00a0cm to 61\u00a0cm" in plot["label"], "for those who cannot see it: from the lowest to the highest")
        for scheme in ("light", "dark"):
            self.browser.color_scheme(scheme)
            self.browser.screenshot(f"kept-week-{scheme}")
        self.check("kept-week")

    def test_HourDayAndMonth_AreShownAndMovedByKeys(self):
        self.start()
        self.go("board/desk", "asip-plot canvas")
        for span in ("1 h", "1 day", "1 month"):
            self.show(span)
            self.drawn(lambda plot: plot["pressed"] == span and plot["points"] > 20 and "first" in plot["note"], span)  # noqa: B023
        self.assertEqual(self.plot()["drawn"][:60], "." * 60, "nothing is known of the weeks before")
        self.show("1 day")
        canvas = self.browser.shown("asip-plot canvas")
        for _ in range(11):
            canvas.send_keys(Keys.ARROW_LEFT)
        self.drawn(lambda plot: plot["drawn"] == "." * 84 or "nothing yet" in plot["label"], "the day without power")
        self.assertEqual(self.browser.find(".plot-tools button")[0].text, "Follow")
        self.browser.button("Follow", "asip-plot").click()
        self.drawn(lambda plot: plot["drawn"][:80] == "#" * 80, "the last day again")
        self.show("1 min")
        eventually(lambda: self.plot()["note"] == "", "the last minute is this page's own")

    def test_BoardThatIsGone_ShowsItsWeek(self):
        self.bus.end("agent-desk", signal.SIGKILL)
        self.addCleanup(lambda: eventually(lambda: self.bus.state("desk") == "online", "the board is back", 60))
        self.addCleanup(self.bus.start_agent, "desk")
        eventually(lambda: self.bus.state("desk") == "lost", "its agent is gone", 30)
        self.start()
        self.go("board/desk", "asip-board .unusable:not(:empty)")
        self.browser.shown("asip-plot canvas")
        self.show("1 week")
        self.drawn(lambda plot: plot["drawn"][61:80] == "#" * 19, "the week before")

    def test_Csv_HasWhatIsInThePicture(self):
        self.start()
        self.go("board/desk", "asip-plot canvas")
        self.show("1 week")
        self.drawn(lambda plot: plot["points"] > 100, "a week")
        self.browser.run("""
            URL.createObjectURL = (blob) => { blob.text().then((text) => { window.saved = text; }); return 'blob:none'; };
            HTMLAnchorElement.prototype.click = function () { window.file = this.download; };""")
        self.browser.button("CSV", "asip-plot").click()
        rows = eventually(lambda: self.browser.run("return window.saved"), "the file").splitlines()
        self.assertEqual(rows[0], "name,at,mean,min,max")
        self.assertGreater(len(rows), 100)
        self.assertEqual(sum(row.endswith(",,,") for row in rows), 2, "two gaps")
        self.assertTrue(self.browser.run("return window.file").endswith(".csv"))

    @mock.patch("axe_test.NEXT", VIEWS)
    def test_Dashboard_HasAPlotOfAWeekAndOnAPhoneInItalian(self):
        self.ask("PUT", "week", {"title": "Week", "widgets": [{"kind": "plot", "size": "wide", "board": "desk", "property": "distance/0", "span": "week"}]})
        self.addCleanup(lambda: self.browser.run("localStorage.removeItem('asip-language')"))
        self.start()
        self.browser.run("localStorage.setItem('asip-language', 'it')")
        self.start()
        self.go("dashboard/week", "asip-plot canvas")
        self.drawn(lambda plot: plot["pressed"] == "1 settimana" and plot["points"] > 100 and "Il registro first conserva" in plot["note"], "una settimana")
        self.check("kept-dashboard")

    def ask(self, method, path, body):
        request = urllib.request.Request(f"{self.bus.url}/api/dashboards/{path}", json.dumps(body).encode(), {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=20) as answer:
            return json.load(answer)

    def test_TimeOfAPlot_IsKeptWithItsDashboardAndALinkSeesNoMore(self):
        self.ask("PUT", "hall", {"title": "Hall", "widgets": [{"kind": "plot", "size": "wide", "board": "desk", "property": "distance/0"}]})
        self.start()
        self.go("dashboard/hall", "asip-plot canvas")
        self.drawn(lambda plot: plot["pressed"] == "1 min", "as before")
        self.browser.button("Edit").click()
        Select(self.browser.shown(".widget-list select[aria-label^='Time that']")).select_by_visible_text("1 day")
        self.drawn(lambda plot: plot["pressed"] == "1 day" and plot["points"] > 20, "the day that was chosen")
        self.start()
        self.go("dashboard/hall", "asip-plot canvas")
        self.drawn(lambda plot: plot["pressed"] == "1 day" and plot["drawn"][:80] == "#" * 80, "a day at once")
        self.browser.screenshot("kept-day")
        token = self.ask("POST", "hall/links", {"until": None})["token"]
        self.browser.driver.get(f"{self.bus.url}/kiosk/{token}/")
        self.browser.shown("asip-plot canvas")
        self.drawn(lambda plot: plot["pressed"] == "1 day" and plot["points"] > 20, "the same by a link")
        self.assertEqual([each.get_attribute("textContent") for each in self.browser.find(".plot-tools button[aria-pressed]")], ["10 s", "1 min", "10 min", "1 h", "1 day"])


class NothingYet(Plots):
    def test_LineThatIsHidden_IsSaidToBeSoWhenTheLegendIsDrawnAnew(self):
        self.start()
        self.go("board/desk", "asip-plot canvas")
        pressed = self.browser.run("""
            const plot = document.querySelector('asip-plot');
            const lines = ['a', 'b'].map((key) => ({ key, name: key }));
            const pressed = () => [...plot.legend.children].map((each) => each.getAttribute('aria-pressed')).join();
            plot.show_legend(lines);
            plot.legend.firstChild.click();
            const before = pressed();
            plot.show_legend([]); // hours that are not there yet
            plot.show_legend(lines);
            const after = pressed();
            plot.legend.firstChild.click();
            return [before, after, pressed()];""")
        self.assertEqual(pressed, ["false,true", "false,true", "true,true"])

    @mock.patch("axe_test.NEXT", VIEWS)
    def test_NothingIsKept_SaysWhatToDoAndItHelps(self):
        self.start()
        self.go("board/desk", "asip-plot canvas")
        self.show("1 h")
        self.drawn(lambda plot: "Give it a name, or put it on a dashboard" in plot["note"], "what to do")
        self.check("kept-nothing")
        self.bus.asipctl("label", "desk/distance", "name=Shelf")
        self.browser.shown("asip-service.named")
        self.show("1 h")
        eventually(lambda: "Registry first has kept this since" in self.plot()["note"], "it is kept", 60)


if __name__ == "__main__":
    unittest.main()
