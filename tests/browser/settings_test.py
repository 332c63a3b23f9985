# SPDX-License-Identifier: Apache-2.0
"""Settings and health: other systems with their state, users and links, notices, programs. What the page says is to be typed is typed."""

import shlex
import subprocess
import unittest
import urllib.error
import urllib.request

from rig import BIN, DESK, PageTest, eventually, paho_client, settings_file


class Settings(PageTest):
    boards = (DESK,)
    expected_errors = ("ERR_CONNECTION_REFUSED", "ERR_SOCKET_NOT_CONNECTED", "WebSocket")  # the gateway starts anew

    def card(self, title):
        """The text of a card, by its title."""
        return self.browser.run("""const card = [...document.querySelectorAll(".card")].find((each) => each.querySelector("h2, h3").textContent.startsWith(arguments[0]));
            return card?.innerText ?? "";""", title)

    def command(self, title, words):
        """What the page says is to be typed, behind the fold of this name."""
        self.browser.run("""const card = [...document.querySelectorAll("asip-exports .card")].find((each) => each.querySelector("h3").textContent === arguments[0]);
            card.querySelector("details").open = true;""", title)
        return next(each.text for each in self.browser.find(".command-line code") if words in each.text and each.is_displayed())

    def restart_gateway(self, settings):
        self.bus.end("gateway")
        self.bus.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.bus.http_port}", "--config", settings_file(settings))
        eventually(lambda: self.bus.get("/readyz"), "the gateway")

    def home_assistant_says(self, word):
        client = paho_client()
        client.connect("127.0.0.1", self.bus.broker_port)
        client.loop_start()
        client.publish("homeassistant/status", word, qos=1, retain=False).wait_for_publish(20)
        client.disconnect()
        client.loop_stop()

    def test_HomeAssistant_IsFoundAndSwitchedOnAndOffByWhatThePageSays(self):
        self.addCleanup(self.restart_gateway, "")
        self.open("settings", anew=True)
        self.browser.run("window.same_page = true")
        eventually(lambda: "off" in self.card("Home Assistant") and "said nothing" in self.card("Home Assistant"), "off, and not heard of")
        self.home_assistant_says("online")
        eventually(lambda: "Found: it uses this broker" in self.card("Home Assistant"), "found")
        file = self.bus.work / "gateway.env"
        for option, state in (("", "on, shows your boards"), ("--off", "off")):
            typed = shlex.split(self.command("Home Assistant", "export home-assistant"))
            self.assertEqual(typed, ["sudo", "asip-gateway", "export", "home-assistant", *option.split()])
            subprocess.run([BIN / "asip-gateway", *typed[2:], "--env", file], check=True, capture_output=True)
            self.restart_gateway("".join(line.removeprefix("ASIP_").lower().replace("_", "-", 1) + "\n" for line in file.read_text().splitlines()))
            eventually(lambda: state in self.card("Home Assistant"), state, 40)  # noqa: B023
        self.home_assistant_says("offline")
        eventually(lambda: "has left" in self.card("Home Assistant"), "it left")
        self.assertTrue(self.browser.run("return window.same_page"), "without a reload")

    def test_UsersAndLinks_AreListedAndALinkIsEndedHere(self):
        tokens = self.bus.work / "tokens"
        for words in (("admin", "teacher"), ("operator", "anna", "--boards", "student-1,student-2", "--until", "30d")):
            subprocess.run([BIN / "asip-gateway", "token", *words, "--tokens", tokens], check=True, capture_output=True)
        self.addCleanup(self.restart_gateway, "")
        self.restart_gateway(f"tokens = {tokens}\nloopback = admin\n")
        request = urllib.request.Request(f"{self.bus.url}/api/dashboards/hall", b'{"title":"Hall","widgets":[]}', {"Content-Type": "application/json"}, method="PUT")
        urllib.request.urlopen(request, timeout=20)
        token = eventually(lambda: self.bus.post("/api/dashboards/hall/links", {"control": True}), "a link")["token"]
        self.open("settings", anew=True)
        access = lambda: self.browser.text("asip-access")
        eventually(lambda: "teacher" in access() and "anna" in access(), "the users")
        self.assertRegex(access(), "operator, Boards: student-1, student-2, until ")
        eventually(lambda: "may use its controls" in access(), "the link")
        shows = f"{self.bus.url}/kiosk/{token}/api/status"
        self.assertEqual(urllib.request.urlopen(shows, timeout=20).status, 200)
        self.browser.button("End", "asip-access").click()
        eventually(lambda: "There is none" in access(), "it is gone")
        with self.assertRaises(urllib.error.HTTPError):
            urllib.request.urlopen(shows, timeout=20)
        self.browser.screenshot("settings")
        self.browser.run("[...document.querySelectorAll('asip-access details')].forEach((each) => { each.open = true; })")
        remove = next(each.text for each in self.browser.find("asip-access code") if "sed" in each.text)
        words = shlex.split(remove.replace("NAME", "anna").replace("/etc/asip/tokens", str(tokens)))
        subprocess.run(words[1:], check=True)  # without sudo
        eventually(lambda: "anna" not in access(), "the token is gone", 30)
        self.assertIn("teacher", access())

    def test_Notice_IsTried(self):
        self.browser.driver.execute_cdp_cmd("Browser.grantPermissions", {"permissions": ["notifications"], "origin": self.bus.url})
        self.open("settings", anew=True)
        self.assertFalse(any(each.is_displayed() and each.text == "Try it" for each in self.browser.find("asip-notify button")), "nothing to try yet")
        self.browser.button("Notify me of lost boards", "asip-notify").click()
        self.browser.button("Try it", "asip-notify").click()
        shown = lambda: self.browser.driver.execute_async_script("""navigator.serviceWorker.ready.then((it) => it.getNotifications())
            .then((all) => arguments[0](all.map((each) => `${each.title}: ${each.body}`)))""")
        eventually(lambda: shown() == ["A board is lost: So it is told. None is lost now."], "the notice")
        self.browser.button("Notify me of lost boards", "asip-notify").click()

    def test_Programs_HaveTheirVersions_AndCountersAreFolded(self):
        self.open("settings", anew=True)
        version = self.bus.get("/api/status")["version"]
        eventually(lambda: version in self.card("Registry first"), "the registry's version")
        self.assertIn(version, self.card("Gateway"))
        self.assertIn("this machine", self.card("You"))
        self.assertIn(str(self.bus.broker_port), self.card("Broker"))
        self.assertNotIn("Messages", self.card("Registry first"))
        more = self.browser.run("""const card = [...document.querySelectorAll(".card")].find((each) => each.textContent.startsWith("Registry first"));
            card.querySelector("summary").focus(); card.querySelector("summary").click(); return card.querySelector("details")""")
        messages = lambda: int(dict(zip(*[iter(more.text.split("\n")[1:])] * 2)).get("Messages", "0").replace(",", ""))
        first = eventually(messages, "the counters")
        eventually(lambda: messages() > first, "they count on", 40)
        self.assertTrue(self.browser.run("return document.activeElement === arguments[0].firstChild", more), "what is open and focused stays")
        self.browser.run("[...document.querySelectorAll('asip-settings details')].find((each) => each.innerText.includes('Agents and their versions')).open = true")
        eventually(lambda: f"1 board\n{version}" in self.browser.text("asip-settings"), "the agent's version")
        self.assertIn("Every board that is known is there", self.browser.text())


if __name__ == "__main__":
    unittest.main()
