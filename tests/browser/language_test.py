# SPDX-License-Identifier: Apache-2.0
"""The page in its five languages: the browser's by default, a chosen one remembered; on every screen nothing is found by axe-core, and no
text is cut at 390 px."""

import itertools
import os
import unittest
from unittest import mock

import axe_test
from rig import PageTest, eventually
from selenium.webdriver.support.ui import Select

LANGUAGES = ("de", "en", "es", "fr", "it")
ON_PHONES = itertools.cycle((view,) for view in axe_test.VIEWS if view[0] == "phone")
SHOWN = itertools.repeat(axe_test.VIEWS) if os.environ.get("ASIP_EVERY_VIEW") else ON_PHONES


class Choice(PageTest):
    def speaks(self, *languages):
        """What the browser prefers from now on."""
        agent = self.browser.run("return navigator.userAgent")
        self.browser.driver.execute_cdp_cmd("Emulation.setUserAgentOverride", {"userAgent": agent, "acceptLanguage": ",".join(languages)})

    def setUp(self):
        super().setUp()
        self.browser.driver.get(self.bus.url)
        self.browser.run("localStorage.clear()")
        self.addCleanup(self.speaks, "en-US", "en")

    def begin(self, route=""):
        self.browser.driver.get("about:blank")
        self.browser.driver.get(f"{self.bus.url}/#/{route}")
        self.browser.shown("asip-link .sign.good", seconds=30)

    def language(self):
        return self.browser.run("return document.documentElement.lang")

    def test_BrowsersLanguage_IsThatOfThePage(self):
        for wanted, lang, boards in ((("de-AT", "en"), "de", "Boards"), (("pt-BR", "es-MX"), "es", "Placas"), (("fr",), "fr", "Cartes"), (("it-CH",), "it", "Schede"), (("ja",), "en", "Boards")):
            self.speaks(*wanted)
            self.begin()
            self.assertEqual((self.language(), self.browser.text("nav a")), (lang, boards))

    def test_ChosenLanguage_IsRemembered(self):
        self.begin()
        Select(self.browser.shown("#language")).select_by_visible_text("Italiano")
        eventually(lambda: self.browser.text("nav a") == "Schede", "the page in Italian")
        self.begin("settings")
        eventually(lambda: self.browser.text("h1") == "Impostazioni e stato", "Italian again")
        self.assertEqual((self.language(), Select(self.browser.shown("#language")).first_selected_option.text), ("it", "Italiano"))
        Select(self.browser.shown("#language")).select_by_visible_text("English")
        eventually(lambda: self.browser.text("h1") == "Settings and health", "the page in English")

    def test_RobotIsMovedAndStopped_InGerman(self):
        self.speaks("de")
        self.begin("board/desk")
        eventually(lambda: "Werte" in self.browser.text("asip-board") and "Bedienung" in self.browser.text("asip-board"), "the board")
        self.all_pins()
        self.browser.button("desk anhalten").click()
        eventually(lambda: "ANGEHALTEN, bis es fortgesetzt wird" in self.browser.text(".title-row"), "why it stands")
        self.browser.button("desk fortsetzen").click()
        eventually(lambda: "ANGEHALTEN" not in self.browser.text(".title-row"), "it goes on")
        self.assertRegex(self.browser.text(".title-row"), r"seit \d\d:\d\d:\d\d")
        self.bus.asipctl("send", "desk/servo", "write", "0", "90")
        eventually(lambda: "90°" in self.browser.text("asip-board"), "the angle")

    def test_RefusedCommand_IsToldInFrench(self):
        self.speaks("fr")
        self.begin("board/desk")
        self.all_pins()
        self.browser.run("document.querySelectorAll('main details').forEach((each) => { each.open = true; })")
        form = self.browser.shown("form[aria-label='servo: Use these pins instead']")
        eventually(lambda: form.find_element("css selector", ".list-row input").is_displayed() and not self.browser.run("return arguments[0].closest('[inert]')", form), "a form that can be used")
        form.find_element("css selector", ".list-row input").send_keys("400")
        form.find_element("css selector", ".actions button").click()
        eventually(lambda: "est supérieur à 255" in form.text, "why it is not sent")


class Screens(axe_test.Axe):
    @mock.patch("axe_test.NEXT", SHOWN)
    def test_EveryScreen_InEveryLanguage(self):
        self.browser.driver.get(self.bus.url)
        axe_test.Screens.put_dashboard(self)
        for language in LANGUAGES:
            with self.subTest(language):
                self.browser.run("localStorage.setItem('asip-language', arguments[0])", language)
                self.start()
                self.browser.shown(".filler .row a")
                self.assertEqual(self.browser.run("return document.documentElement.lang"), language)
                self.check(f"{language}-boards")
                for route, there in (("add", ".add-board .link-list button"), ("board/desk", ".setters input[type=range]"), ("dashboards", ".dashboard-list a"), ("dashboard/greenhouse", ".kind-gauge"),
                                     ("history", "asip-history"), ("settings", "asip-exports .card"), ("nowhere", "main h1")):
                    self.go(route, there)
                    self.browser.run("document.querySelectorAll('main details').forEach((each) => { each.open = true; })")
                    self.check(f"{language}-{route.split('/')[0]}")
        self.browser.run("localStorage.clear()")


if __name__ == "__main__":
    unittest.main()
