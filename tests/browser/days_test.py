# SPDX-License-Identifier: Apache-2.0
"""A day of a home user, and one of the operator of 5,000 boards: as they work, from what they see first to what they are told at night,
in English and in German. A lesson in two languages is in class_test.py. A teacher's day is in teacher_test.py, a robot builder's in robot_test.py."""

import http.server
import json
import threading
import unittest
import urllib.request

import paho.mqtt.client as mqtt
from selenium.webdriver.support.ui import Select

from rig import Browser, PageTest, eventually, free_port, paho_client


class HomeUser(PageTest):
    """Names things, puts them on a dashboard for the phone, and finds the house as it is after another user used it."""

    def test_Day_NamesADashboardThePhoneAndABoardThatComesBack(self):
        browser, pin_13 = self.browser, self.t("pin-label-within", label=13)
        self.open_board("lamp")
        browser.run("document.querySelector('asip-names details').open = true")
        form = browser.shown(f"form[aria-label='{self.t('names-labels')}']")
        self.name_field(form, self.t("name-board")).send_keys("Hall")
        form.find_element("css selector", "button.main").click()
        eventually(lambda: self.t("kept") in form.text, "the name is kept")
        browser.shown(".pin[title^='Pin 13:']").click()
        output = self.t("mode.output")
        browser.button(output.capitalize()).click()
        eventually(lambda: output in browser.shown(".pin[title^='Pin 13:']").get_attribute("title"), "pin 13 as output")
        pin = browser.shown(f"form[aria-label='{self.t('name-pin', label=13)}']")
        pin.find_element("tag name", "input").send_keys("Ceiling light")
        pin.find_element("tag name", "button").click()
        eventually(lambda: "Ceiling light" in browser.text("asip-pins"), "the pin's name")
        browser.shown(f"button[title='{self.t('add-what', what=pin_13)}']").click()
        add = browser.shown(f"form[aria-label='{self.t('add-what', what=pin_13)}']")
        what = Select(add.find_elements("tag name", "select")[0])
        eventually(lambda: any(self.t("kind.switch") in each.text for each in what.options), "a switch is offered")
        what.select_by_index(0)
        title = add.find_element("css selector", "input[type=text]")
        title.clear()
        title.send_keys("At home")
        add.find_element("css selector", "button.main").click()
        eventually(lambda: self.t("added") in add.text, "the switch is on the dashboard")
        self.open("dashboard/at-home")
        browser.run("document.querySelector('asip-share details').open = true")
        browser.shown("asip-share input[type=checkbox]").click()
        browser.button(self.t("make-share")).click()
        link = browser.shown(f"input[aria-label='{self.t('the-link')}']").get_property("value")

        phone = Browser()
        self.addCleanup(phone.close)
        phone.size(390, 844, mobile=True)
        phone.driver.get(link)
        phone.shown(".toggle").click()
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "the light is on")
        browser.shown(".toggle[aria-checked='true']")
        client = paho_client()  # the wall switch: another program
        client.connect("127.0.0.1", self.bus.broker_port)
        client.loop_start()
        client.publish("asip/lamp/io/in", '{"write":[13,0]}', qos=1).wait_for_publish()
        client.disconnect()
        client.loop_stop()
        phone.shown(".toggle[aria-checked='false']")
        self.bus.end("agent-lamp")
        eventually(lambda: "Board lamp is" in phone.text("main"), "the phone says that it is not there")
        self.assertTrue(phone.shown(".toggle").get_property("disabled"))
        self.bus.start_agent("lamp")
        eventually(lambda: not phone.shown(".toggle").get_property("disabled"), "it can be used again", 60)
        phone.driver.refresh()
        phone.shown(".toggle").click()
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "the light is on")
        self.open("history")
        eventually(lambda: "@at-home" in browser.text(), "the history says that the link did it", 40)

    def name_field(self, form, name):
        for label in form.find_elements("tag name", "label"):
            if label.text == name:
                return form.find_element("id", label.get_attribute("for"))
        raise AssertionError(f"no field {name} in {form.text}")


class HomeUserInGerman(HomeUser):
    language = "de"


class Webhook(http.server.BaseHTTPRequestHandler):
    bodies = []

    def do_POST(self):
        self.bodies.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


class Operator(PageTest):
    """5,000 boards of ten hosts; one host fails."""

    boards = ()
    expected_errors = ("status of 404",)  # of the board that is forgotten while its page is open
    MANY, LOST = 5000, 500

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.hook = free_port()
        server = http.server.ThreadingHTTPServer(("127.0.0.1", cls.hook), Webhook)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        cls.addClassCleanup(server.server_close)
        cls.addClassCleanup(server.shutdown)
        cls.bus.start("notifier", "asip-registry", "--id", "second", "--notify", f"http://127.0.0.1:{cls.hook}/")
        eventually(lambda: any(each["id"] == "second" for each in cls.bus.get("/api/status").get("registries", [])), "the second registry")
        cls.client = paho_client(protocol=mqtt.MQTTv5)
        cls.client.max_queued_messages_set(0)
        cls.client.max_inflight_messages_set(1000)
        cls.client.connect("127.0.0.1", cls.bus.broker_port)
        cls.client.loop_start()
        cls.addClassCleanup(cls.client.loop_stop)
        for i in range(cls.MANY):
            document = {"board": f"b{i}", "session": "5f3a9c01", "seq": 1, "lease": 600, "labels": {"hall": str(i % 5)},
                        "agent": {"host": f"vm{i % 10}", "client": f"agent-vm{i % 10}"}, "firmware": {"protocol": "0.4", "chip": "ATmega328P"},
                        "services": [{"name": "distance", "id": "D", "model": "distance@1"}]}
            cls.client.publish(f"asip/servicebus/b{i}/$description", json.dumps(document), qos=1, retain=True)
            cls.say(i, "online")
        eventually(lambda: cls.bus.get("/api/status")["mirror"]["boards"] >= cls.MANY, "all boards", 90)

    def counted(self, name, **numbers):
        written = {key: f"{number:,}".replace(",", "." if self.language == "de" else ",") for key, number in numbers.items()}
        return self.texts[name]["other"].format(**written)

    @classmethod
    def say(cls, i, state):
        cls.client.publish(f"asip/servicebus/b{i}/$state", state, qos=1, retain=True).wait_for_publish(60)

    def test_Day_OneHostFails_IsToldOnceFoundAndForgotten(self):
        browser = self.browser
        self.open(anew=True)
        eventually(lambda: self.counted("n-boards", n=self.MANY) in browser.text(".found"), "all boards in the table", 40)
        Webhook.bodies.clear()
        lost = [i for i in range(self.MANY) if i % 10 == 3]
        for i in lost:
            self.client.publish(f"asip/servicebus/b{i}/$state", "lost", qos=1, retain=True)
        eventually(lambda: f"({self.t('lost-lost', lost=self.LOST)})" in browser.driver.title, "the badge in the title", 40)
        eventually(lambda: sum(each["lost"]["count"] for each in Webhook.bodies) == self.LOST, f"the webhook: {Webhook.bodies}", 60)
        self.assertLess(len(Webhook.bodies), 10, "not one message a board")
        self.assertTrue(all("behind host vm3" in each["text"] for each in Webhook.bodies), Webhook.bodies)
        self.open("?state=lost&group=hall", anew=True)  # a bookmark
        eventually(lambda: self.counted("shown-n", shown=self.LOST, n=self.MANY) in browser.text(".found"), "the lost boards alone", 40)
        browser.screenshot("operator-lost")
        self.open(f"board/b{lost[0]}")
        browser.button(self.t("forget-board")).click()
        browser.button(self.t("yes-forget")).click()
        eventually(lambda: self.bus.state(f"b{lost[0]}") is None, "it is forgotten")
        for i in lost[1:]:
            self.client.publish(f"asip/servicebus/b{i}/$state", "online", qos=1, retain=True)
        eventually(lambda: "(" not in browser.driver.title, "the badge is gone", 60)
        with urllib.request.urlopen(f"{self.bus.url}/metrics", timeout=30) as answer:
            self.assertIn(b"asip_", answer.read())


class OperatorInGerman(Operator):
    language = "de"


if __name__ == "__main__":
    unittest.main()
