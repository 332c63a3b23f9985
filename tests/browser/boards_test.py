# SPDX-License-Identifier: Apache-2.0
"""The table of boards: appears, changes, is searched."""

import json
import unittest
import urllib.request

from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from rig import PageTest, commands_heard, eventually


class Boards(PageTest):
    def row_has(self, board, text, seconds=20):
        eventually(lambda: text in self.browser.table().get(board, ""), f"{board} {text}", seconds)

    def test_PageOpened_ShowsBothBoardsWithTheirServices(self):
        self.open()
        self.row_has("desk", "online")
        self.row_has("lamp", "online")
        self.assertIn("Pins, Distance, Servo", self.browser.table()["desk"])
        self.assertIn("2 boards", self.browser.text(".found"))
        self.assertEqual(self.browser.text("asip-link"), "live")
        self.browser.screenshot("boards")

    def test_AgentKilledAndBack_BoardGoesAndAppearsWithoutReload(self):
        self.open()
        self.row_has("lamp", "online")
        self.browser.run("window.same_page = true")
        self.bus.end("agent-lamp")
        self.row_has("lamp", "offline")
        self.bus.start_agent("lamp")
        self.row_has("lamp", "online")
        self.assertTrue(self.browser.run("return window.same_page"))

    def test_View_StandsInTheAddressAndIsFoundByIt(self):
        self.open()
        self.row_has("lamp", "online")
        self.browser.shown("input[type=search]").send_keys("lamp")
        eventually(lambda: list(self.browser.table()) == ["lamp"], "only lamp")
        self.assertIn("text=lamp", self.browser.driver.current_url)
        self.open("?text=desk", anew=True)
        eventually(lambda: list(self.browser.table()) == ["desk"], "only desk")
        self.open("?sort=name", anew=True)

    def test_Forget_AsksFirst(self):
        self.bus.end("agent-lamp")
        self.open("board/lamp")
        self.browser.button("Forget this board").click()
        self.assertIn("Forget lamp", self.browser.text(".tools"))
        self.browser.button("Keep it").click()
        self.browser.button("Forget this board")
        self.bus.start_agent("lamp")
        eventually(lambda: self.bus.state("lamp") == "online", "lamp online again", 30)

    def test_SearchAndFilters_ShowOnlyWhatFits(self):
        self.open()
        self.row_has("lamp", "online")
        search = self.browser.shown("input[type=search]")
        search.send_keys("distance")
        eventually(lambda: list(self.browser.table()) == ["desk"], "only desk")
        self.assertIn("1 of 2 boards", self.browser.text(".found"))
        search.clear()
        search.send_keys("nothing like it")
        eventually(lambda: "No board fits" in self.browser.text(), "the sentence")
        search.send_keys(Keys.CONTROL, "a")
        search.send_keys(Keys.DELETE)
        eventually(lambda: len(self.browser.table()) == 2, "both boards")
        self.browser.run("const kind = document.querySelector('.toolbar select'); kind.value = 'servo'; kind.dispatchEvent(new Event('change'))")
        eventually(lambda: list(self.browser.table()) == ["desk"], "only the board with a servo")

    def choose(self, label, value):
        self.browser.run("const each = document.querySelector(`select[aria-label='${arguments[0]}']`); each.value = arguments[1]; each.dispatchEvent(new Event('change'))", label, value)

    def test_Value_OfEachBoardIsInTheListAndMoves(self):
        self.open()
        cell = lambda: self.browser.run("return document.querySelector('.filler .row:not([hidden]) .c-value').textContent.replace('\u00a0', ' ')")
        eventually(lambda: cell() in ("41 cm", "42 cm", "43 cm"), "the distance of desk")
        self.bus.sim("set", "desk/distance", "66")
        eventually(lambda: cell() in ("65 cm", "66 cm", "67 cm"), "the next one")
        self.choose("Value that is shown", "-")
        eventually(lambda: cell() == "", "no value")
        self.assertIn("value=-", self.browser.driver.current_url)
        self.open("?value=distance", anew=True)
        eventually(lambda: cell() in ("65 cm", "66 cm", "67 cm"), "the value that the address names")
        self.bus.sim("set", "desk/distance", "42")

    def labelled(self, board, change):
        urllib.request.urlopen(urllib.request.Request(f"{self.bus.url}/api/boards/{board}/labels", json.dumps({"labels": change}).encode(),
                                                      {"Content-Type": "application/json"}), timeout=10).read()

    def test_List_IsGroupedByALabel_AndTheAddressSaysSo(self):
        self.labelled("desk", {"room": "lab"})
        self.open()
        eventually(lambda: "room" in self.browser.text("select[aria-label='Group by a label']"), "the label to group by")
        self.choose("Group by a label", "room")
        groups = lambda: self.browser.run("return [...document.querySelectorAll('.filler .row:not([hidden])')].sort((a, b) => a.ariaRowIndex - b.ariaRowIndex)"
                                          ".map((row) => row.querySelector(row.classList.contains('group') ? 'small' : 'a').textContent)")
        eventually(lambda: groups() == ["room: lab (1)", "desk", "without room (1)", "lamp"], "two groups")
        self.assertIn("2 boards", self.browser.text(".found"))
        self.assertIn("group=room", self.browser.driver.current_url)
        self.open("?group=room", anew=True)
        eventually(lambda: groups() == ["room: lab (1)", "desk", "without room (1)", "lamp"], "the same by its address")
        self.browser.screenshot("boards-grouped")
        self.open("?sort=name", anew=True)
        self.labelled("desk", {"room": None})

    def pick(self, name):
        self.browser.shown(f"input[aria-label='{name}']").click()

    def test_Selection_IsStoppedResumedLabelledAndSentTo(self):
        self.open("?sort=name", anew=True)
        self.row_has("lamp", "online")
        self.pick("Select all that are shown")
        eventually(lambda: "2 boards selected" in self.browser.text("asip-selection"), "both are selected")
        self.browser.button("Label …").click()
        field = self.browser.shown("form[aria-label='Label the selected boards'] input")
        field.send_keys("class=7b", Keys.ENTER)
        eventually(lambda: "Done on 2 boards" in self.browser.text("asip-selection"), "both are labelled")
        self.row_has("desk", "class=7b")
        self.row_has("lamp", "class=7b")
        self.browser.screenshot("selection")
        self.browser.button("Stop", "asip-selection").click()
        eventually(lambda: "Done on 2 boards" in self.browser.text("asip-selection output"), "both are stopped")
        self.row_has("desk", "stopped")
        self.row_has("lamp", "stopped")
        self.browser.button("Resume", "asip-selection").click()
        self.row_has("lamp", "online")
        self.row_has("desk", "online")
        self.browser.button("Send …").click()
        self.browser.run("const each = [...document.querySelectorAll('asip-selection select')]; each[1].value = 'mode'; each[1].dispatchEvent(new Event('change'))")
        form = self.form("io", "Set the mode of a pin")
        self.fill(form, "Pin", "13")
        self.browser.run("const each = arguments[0].querySelector('select'); each.value = '3'", form)
        form.find_element(By.CSS_SELECTOR, "button.main").click()
        eventually(lambda: "Done on 2 boards" in form.text, "sent to both")
        for board in ("desk", "lamp"):
            eventually(lambda: self.bus.get(f"/api/boards/{board}")["description"]["pins"]["modes"][13] == "3", f"pin 13 of {board} is an output")
        self.browser.button("Label …").click()
        self.browser.shown("form[aria-label='Label the selected boards'] input").send_keys("class-", Keys.ENTER)
        eventually(lambda: "class" not in self.browser.table()["lamp"] and "class" not in self.browser.table()["desk"], "the label is gone")
        self.browser.button("Clear", "asip-selection").click()
        eventually(lambda: not self.browser.find("asip-selection")[0].is_displayed(), "nothing is selected")

    def test_LostBoard_IsNotifiedAfterTheButtonWasPressed_AndNotBefore(self):
        self.browser.driver.execute_cdp_cmd("Browser.grantPermissions", {"permissions": ["notifications"], "origin": self.bus.url})
        self.open("?sort=name", anew=True)
        self.browser.run("""window.told = []; window.asked = 0;
            const ask = Notification.requestPermission.bind(Notification);
            Notification.requestPermission = () => { ++asked; return ask(); };
            const show = ServiceWorkerRegistration.prototype.showNotification;
            ServiceWorkerRegistration.prototype.showNotification = async function(title, options) {
              await show.call(this, title, options);
              const shown = await this.getNotifications();
              told.push([shown[0].title, shown[0].body, performance.now()]);
            };""")
        told = lambda: self.browser.run("return told")
        button = self.browser.button("Notify me of lost boards")
        self.row_has("lamp", "online")
        self.bus.sim("unplug", "lamp")
        self.row_has("lamp", "lost", 30)
        workers = lambda: self.browser.driver.execute_async_script("navigator.serviceWorker.getRegistrations().then((all) => arguments[0](all.length))")
        self.assertEqual((told(), self.browser.run("return asked"), workers()), ([], 0, 0), "nobody asked for it")
        self.bus.sim("replug", "lamp")
        self.row_has("lamp", "online", 30)
        button.click()
        eventually(lambda: button.get_attribute("aria-pressed") == "true", "it is turned on")
        for _ in range(2):
            before = len(told())
            self.bus.sim("unplug", "lamp")
            eventually(lambda: len(told()) == before + 1, "the notification", 30)
            self.assertEqual(told()[-1][:2], ["lamp is lost", "cable unplugged"])
            self.bus.sim("replug", "lamp")
            self.row_has("lamp", "online", 30)
            eventually(lambda: self.browser.run("return performance.now()") - told()[-1][2] > 5100, "the next loss is another one")
        button.click()
        eventually(lambda: button.get_attribute("aria-pressed") == "false", "it is turned off")
        self.assertEqual(len(told()), 2)

    def test_Nothing_IsSentWhenPagesAreOpened(self):
        with commands_heard(self.bus) as heard:
            for route in ("", "board/desk", "board/lamp", "history", "settings"):
                self.open(route)
                self.browser.shown("main > *")
            self.open_board("desk", anew=True)
        self.assertEqual(heard, [])


if __name__ == "__main__":
    unittest.main()
