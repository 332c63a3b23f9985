# SPDX-License-Identifier: Apache-2.0
"""The page in its five languages: the browser's by default, a chosen one remembered; on every screen nothing is found by axe-core, no
text is cut at 390 px, and no English word is left over."""

import itertools
import json
import os
import re
import unittest
from unittest import mock

import axe_test
from rig import ROOT, PageTest, eventually
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

    def page_language(self):
        return self.browser.run("return document.documentElement.lang")

    def test_BrowsersLanguage_IsThatOfThePage(self):
        for wanted, lang, boards in ((("de-AT", "en"), "de", "Boards"), (("pt-BR", "es-MX"), "es", "Placas"), (("fr",), "fr", "Cartes"), (("it-CH",), "it", "Schede"), (("ja",), "en", "Boards")):
            self.speaks(*wanted)
            self.begin()
            self.assertEqual((self.page_language(), self.browser.text("nav a")), (lang, boards))

    def test_ChosenLanguage_IsRemembered(self):
        self.begin()
        Select(self.browser.shown("#language")).select_by_visible_text("Italiano")
        eventually(lambda: self.browser.text("nav a") == "Schede", "the page in Italian")
        self.begin("settings")
        eventually(lambda: self.browser.text("h1") == "Impostazioni e stato", "Italian again")
        self.assertEqual((self.page_language(), Select(self.browser.shown("#language")).first_selected_option.text), ("it", "Italiano"))
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
        form = self.browser.shown("form[aria-label='servo: Utiliser plutôt ces broches']")
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


def words(text):
    return {word.lower() for word in re.findall(r"[^\W\d_]{3,}", text)}


def table(language):
    texts = json.loads((ROOT / "gateway/page/languages" / f"{language}.json").read_text()).values()
    return words(" ".join(" ".join(text.values()) if isinstance(text, dict) else text for text in texts))


def of_models():
    """What models say to people: titles, arguments and their choices."""
    def told(value, inside=""):
        if isinstance(value, dict):
            yield from (each for key, part in value.items() for each in ((key,) if inside in ("commands", "names") else ()) + tuple(told(part, key)) if key not in ("examples", "match", "events"))
        elif isinstance(value, list):
            yield from (each for part in value for each in told(part, inside))
        elif inside in ("title", "name", "element"):
            yield value
    return words(" ".join(each for file in (ROOT / "services").glob("*.json") if file.name != "schema.json" for each in told(json.loads(file.read_text()))))


class German(axe_test.Axe):
    """What is shown, and told to those who hear the page, on each screen."""

    names = words(json.dumps(axe_test.WHOLE)) | {"desk", "lamp", "greenhouse", "board", "boards", "first", "form", "home", "pin", "serial", "token", "sim", "mosquitto"}

    def check(self, name):
        shown = self.browser.run("""const seen = [...document.querySelectorAll("body *")].filter((each) => !each.closest("code, pre, script, style, #language, .command-line") && each.checkVisibility());
            return seen.flatMap((each) => [...["aria-label", "placeholder", "title", "aria-valuetext"].map((name) => each.getAttribute(name) ?? ""),
              ...[...each.childNodes].filter((part) => part.nodeType === Node.TEXT_NODE).map((part) => part.data)]).filter((text) => text.trim() !== "");""")
        self.assertGreater(len(shown), 5, name)
        english = (table("en") | of_models()) - table("de") - self.names
        left = {text for text in shown if words(text) & english}
        with self.subTest(name):
            self.assertEqual(left, set())

    def unfold(self):
        self.browser.run("document.querySelectorAll('main details').forEach((each) => { each.open = true; })")

    def test_NoEnglishWord_IsLeftOnAnyScreen(self):
        axe_test.Screens.put_dashboard(self)
        self.bus.asipctl("send", "desk/servo", "write", "7", "90")
        self.bus.asipctl("label", "lamp", "form=4b")
        self.browser.driver.get(self.bus.url)
        self.browser.run("localStorage.setItem('asip-language', 'de')")
        self.start()
        self.browser.shown(".filler .row a")
        self.browser.run("document.querySelectorAll('.c-pick input')[1].click()")
        for each in (2, 3):  # what is sent, then labels
            self.browser.shown("asip-selection .toolbar button")
            self.browser.run("document.querySelectorAll('asip-selection .toolbar > button')[arguments[0]].click()", each)
            self.browser.shown("asip-selection form")
            self.check("boards")
        for route, there in (("add", ".add-board .link-list button"), ("add/desk", ".add-board form"), ("board/lamp", "asip-board .all-pins"), ("dashboards", ".dashboard-list a"),
                             ("dashboard/nowhere", "main h1"), ("history", "asip-history tbody tr"), ("settings", "asip-exports .card"), ("class", "form.open-lesson"),
                             ("join", "input.class-code"), ("nowhere", "main h1")):
            with self.subTest(route):
                self.go(route, there)
                self.unfold()
                self.check(route)
        self.go("board/desk", ".setters input[type=range]")
        self.all_pins()
        self.browser.shown(".pin:not(.taken)").click()
        self.browser.run("document.querySelectorAll('asip-add-widget > button').forEach((each) => each.click())")
        self.unfold()
        eventually(lambda: self.browser.find("asip-history tbody tr"), "its history")
        self.every_command()
        self.check("board")
        self.go("dashboard/greenhouse", ".kind-gauge")
        self.check("dashboard")
        self.browser.button("Bearbeiten").click()
        self.browser.shown(".widget-list li")
        self.unfold()
        self.check("dashboard-editor")

    def test_WhatIsRefused_IsToldInGerman(self):
        self.browser.driver.get(self.bus.url)
        self.browser.run("localStorage.setItem('asip-language', 'de')")
        self.start()
        self.go("join/ABCDEF", "input.class-code")
        self.browser.button("Beitreten").click()
        eventually(lambda: "Keine Stunde hat diesen Code" in self.browser.text(), "why")
        self.go("board/desk", "asip-board .all-pins")
        self.all_pins()
        self.unfold()
        form = self.browser.shown("form[aria-label='servo: Einen Servo auf einen Winkel drehen']")
        self.fill(form, "Winkel", "400")
        self.send(form)
        self.answered(form, "refused", "Winkel liegt über 180.")


if __name__ == "__main__":
    unittest.main()
