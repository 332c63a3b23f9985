# SPDX-License-Identifier: Apache-2.0
"""A lesson: a teacher at the gateway's machine, ten phones of its network that have a code, and ten boards. No token is typed."""

import json
import socket
import time
import unittest
import urllib.request

import websocket

from rig import IMAGES, Browser, Bus, PageTest, eventually

PUPILS = 10


def address_of_this_machine():
    """At which others reach it; 127.0.0.1 where it has no network: then phones have the rights of the machine until they join."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
        except OSError:
            return "127.0.0.1"
        return probe.getsockname()[0]


class School(Bus):
    def start_gateway(self):
        self.start("gateway", "asip-gateway", "--http", f"0.0.0.0:{self.http_port}", "--anonymous", "class")
        eventually(lambda: self.get("/readyz"), "the gateway")


def board(number):
    name = f"student-{number}"
    return {"name": name, "board": "uno", "image": str(IMAGES / "asip_uno.elf"), "link": f"{name}.port", "parts": [{"kind": "led", "name": f"light-{number}", "pin": 13}]}


class Phones:
    """So many phones in one Chromium: each has cookies and a worker of its own."""

    def __init__(self, count, url, language="en"):
        self.browser = Browser(f"--accept-lang={language}")
        self.windows = []
        address = self.browser.driver.capabilities["goog:chromeOptions"]["debuggerAddress"]
        with urllib.request.urlopen(f"http://{address}/json/version", timeout=10) as answer:
            self.tools = websocket.create_connection(json.load(answer)["webSocketDebuggerUrl"], suppress_origin=True, timeout=30)
        driver = self.browser.driver
        for _ in range(count):
            context = self.ask("Target.createBrowserContext")["browserContextId"]
            known = set(driver.window_handles)
            self.ask("Target.createTarget", url=url, browserContextId=context)
            self.windows.append(eventually(lambda known=known: next(iter(set(driver.window_handles) - known), None), "the phone's window"))

    def ask(self, method, **parameters):
        """Asks the whole browser: chromedriver asks a page only."""
        self.tools.send(json.dumps({"id": 1, "method": method, "params": parameters}))
        while (answer := json.loads(self.tools.recv())).get("id") != 1:
            pass
        return answer["result"]

    def __getitem__(self, number):
        self.browser.driver.switch_to.window(self.windows[number])
        self.browser.size(390, 844, mobile=True)
        return self.browser

    def close(self):
        self.tools.close()
        self.browser.close()


class Lesson(PageTest):
    pupils = PUPILS
    boards = tuple(board(number) for number in range(1, PUPILS + 1))
    expected_errors = ("status of 401", "status of 404", "status of 409", "response code: 401", "ERR_CONNECTION_REFUSED", "WebSocket")

    @classmethod
    def make_bus(cls):
        bus = School(cls.boards)
        cls.outside = f"http://{address_of_this_machine()}:{bus.http_port}"
        return bus

    def setUp(self):
        super().setUp()
        self.addCleanup(self.end_lessons)

    def end_lessons(self):
        for each in self.bus.get("/api/lessons")["items"]:
            self.ask("DELETE", f"/api/lessons/{each['id']}")

    def ask(self, method, path, body=None, cookie=None):
        headers = {"Content-Type": "application/json", **({"Cookie": cookie} if cookie else {})}
        request = urllib.request.Request(self.bus.url + path, None if body is None else json.dumps(body).encode(), headers, method=method)
        with urllib.request.urlopen(request, timeout=20) as answer:
            text = answer.read()
            return json.loads(text) if text else None

    def open_lesson(self):
        self.browser.shown(".toolbar a[href='#/class']").click()
        eventually(lambda: f"({self.pupils})" in self.browser.text("form.open-lesson select"), "all boards", 30)
        self.browser.button(self.t("lesson-open")).click()
        return self.browser.shown("p.class-code").text

    def join(self, phone, code):
        # What the browser may do is known: the screen does not change any more.
        eventually(lambda: phone.run("return document.querySelector('nav').hidden") or phone.text("asip-link") == self.t("live-within"), "the way in", 60)
        field = phone.shown("input.class-code")
        field.clear()
        field.send_keys(code)
        # Pupils press at the same time. A click of the driver waits for the page that follows, one phone after the other.
        phone.run("setTimeout(() => arguments[0].click())", phone.button(self.t("lesson-join")))

    def is_pupil(self, phone, number):
        return phone.text("asip-pupil").startswith(self.texts["lesson-pupil"].split("{board}")[0].format(pupil=f"student-{number}"))

    def seat(self, name):
        return next(each for each in self.browser.find("ul.seats li") if each.find_element("css selector", "a").text == name)

    def test_TenPhones_CommandTenBoards_AndTheTeacherSeesAll(self):
        self.open()
        phones = Phones(self.pupils, f"{self.outside}/join", self.language)
        self.addCleanup(phones.close)
        began = time.monotonic()
        code = self.open_lesson()
        for number in range(self.pupils):
            self.join(phones[number], code.lower())
        for number in range(self.pupils):
            eventually(lambda: self.is_pupil(phones.browser, number + 1) if phones[number] else False, f"pupil {number + 1} is in", 40)
            phones[number].shown("asip-board .title-row")
            eventually(lambda: phones.browser.text("asip-link") == self.t("live-within"), "live", 30)
            phones.browser.button(self.t("lesson-identify"), "asip-pupil").click()
        for number in range(self.pupils):
            phones[number]
            eventually(lambda: self.t("lesson-blinked") in phones.browser.text("asip-pupil"), f"the board of pupil {number + 1}", 60)
        print(f"{self.pupils} pupils command after {time.monotonic() - began:.1f} s")
        all_in = self.texts["lesson-until"].split("{time}")[1].format(pupils=self.pupils, count=self.pupils)
        eventually(lambda: all_in in self.browser.text(".lesson"), "all in the teacher's list")
        self.browser.screenshot("class-teacher")
        self.one_pupil(phones)
        self.teacher(phones, code)

    def one_pupil(self, phones):
        """What the page of a pupil shows and may do."""
        phone = phones[2]
        phone.screenshot("class-pupil")
        self.assertLessEqual(phone.run("return document.documentElement.scrollWidth"), 390)
        asked = """const [path, body, done] = arguments;
            fetch(path, { method: body ? "POST" : "GET", headers: body ? { "Content-Type": "application/json" } : {}, body: body ?? undefined })
                .then(async (answer) => done([answer.status, await answer.text()]));"""
        status, text = phone.driver.execute_async_script(asked, "/api/boards", None)
        self.assertEqual([each["board"] for each in json.loads(text)["items"]], ["student-3"], status)
        self.assertEqual(phone.driver.execute_async_script(asked, "/api/boards/student-4/services/io/commands/write", "[13,1]")[0], 404)
        self.assertEqual(phone.driver.execute_async_script(asked, "/api/lessons", None)[0], 403)

    def teacher(self, phones, code):
        self.browser.button(self.t("lesson-stop")).click()
        eventually(lambda: "STOPPED" in self.seat("student-3").text or "latched" in self.seat("student-3").get_attribute("innerHTML"), "stopped", 30)
        phones[2].button(self.t("lesson-identify"), "asip-pupil").click()
        refused = "stopped" if self.language == "en" else self.t("answer.refused.stopped")
        eventually(lambda: refused in phones.browser.text("asip-pupil"), "the pupil is told")
        self.assertEqual([each.text for each in phones.browser.find("button.resume") if each.is_displayed()], [], "only the teacher resumes")
        self.browser.button(self.t("lesson-resume")).click()
        eventually(lambda: "latched" not in self.seat("student-3").get_attribute("innerHTML"), "resumed", 30)
        self.seat("student-3").find_element("css selector", f"button[aria-label='{self.t('lesson-take')} student-3']").click()
        eventually(lambda: self.seat("student-3").text.startswith(self.t("lesson-is-yours")), "taken over")
        phones[2]
        eventually(lambda: self.t("lesson-was") in phones.browser.text(), "the pupil is told", 40)
        self.assertIn(self.texts.get("status.join.409", "no board is free; ask the teacher for one"), self.sentence_of_join(phones[2], code))
        self.browser.shown(f"button[aria-label='{self.t('lesson-free')} student-3']").click()
        eventually(lambda: self.seat("student-3").text.startswith(self.t("lesson-is-free")), "free")
        self.join(phones[2], code)
        eventually(lambda: self.is_pupil(phones.browser, 3), "again", 40)
        self.browser.button(self.t("lesson-end")).click()
        for number in range(self.pupils):
            phones[number]
            eventually(lambda: self.t("lesson-was") in phones.browser.text(), f"pupil {number + 1} is told", 40)
        phones.browser.button(self.t("lesson-over")).click()

    def sentence_of_join(self, phone, code):
        self.join(phone, code)
        return eventually(lambda: phone.text(f"form[aria-label='{self.t('lesson-join-class')}'] output"), "an answer")

    def test_AddressOfTheQrCode_FillsInTheCode(self):
        self.open()
        code = self.open_lesson()
        address = self.browser.shown("svg.qr").get_attribute("aria-label")
        self.assertEqual(address, f"{self.bus.url}/#/join/{code}")
        self.assertIn("Phones do not reach this machine by this address", self.browser.text(".lesson"))
        phones = Phones(1, address.replace(self.bus.url, self.outside))
        self.addCleanup(phones.close)
        eventually(lambda: phones[0].shown("input.class-code").get_property("value") == code, "the code of the address")
        self.assertEqual(self.bus.get("/api/lessons")["items"][0]["free"], PUPILS, "nobody joins without a press")
        phones[0].button("Join").click()
        eventually(lambda: self.is_pupil(phones.browser, 1), "joined", 40)

    def test_GatewayStartedAnew_TellsPupilsThatTheLessonIsOver(self):
        self.open()
        code = self.open_lesson()
        phones = Phones(1, f"{self.outside}/")
        self.addCleanup(phones.close)
        self.join(phones[0], code)
        eventually(lambda: self.is_pupil(phones.browser, 1), "joined", 40)
        self.bus.end("gateway")
        self.bus.start_gateway()
        eventually(lambda: "the gateway was started anew" in phones.browser.text(), "the sentence", 60)


class LessonInItalian(Lesson):
    """A teacher and four pupils who read Italian."""

    language = "it"
    pupils = 4
    boards = Lesson.boards[:4]
    test_AddressOfTheQrCode_FillsInTheCode = test_GatewayStartedAnew_TellsPupilsThatTheLessonIsOver = None  # in English


if __name__ == "__main__":
    unittest.main()
