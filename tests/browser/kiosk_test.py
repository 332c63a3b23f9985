# SPDX-License-Identifier: Apache-2.0
"""The page for users who may not do everything: a kiosk's link, in a frame of another site, too; a browser without a token; a viewer;
an operator. Nothing is shown to them that they may not do."""

import functools
import http.server
import json
import subprocess
import threading
import unittest
import urllib.error
import urllib.request

from rig import DESK, PageTest, can_connect, eventually, free_port, program_path


class Frames(http.server.BaseHTTPRequestHandler):
    """A page of another site, which shows the kiosk in a frame."""

    def __init__(self, link, *arguments):
        self.link = link
        super().__init__(*arguments)

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(f'<!doctype html><title>Wiki</title><link rel="icon" href="data:,">'
                         f'<iframe src="{self.link}" width="1200" height="800"></iframe>'.encode())

    def log_message(self, *_):
        pass


class Kiosk(PageTest):
    boards = (DESK,)
    expected_errors = ("frame-ancestors", "Refused to frame", "status of 401", "response code: 401", "status of 404", "response code: 404",
                       "status of 403", "status of 409")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.frames, cls.gateway = free_port(), free_port()
        tokens = cls.bus.work / "tokens"
        # localhost is another site than 127.0.0.1, whatever the port.
        cls.tokens = tokens
        cls.url = f"http://127.0.0.1:{cls.gateway}/"
        cls.link = f"{cls.url}kiosk/{cls.make('kiosk', 'hall', '--boards', 'desk', '--frames', f'http://localhost:{cls.frames}')}/#/board/desk"
        cls.bus.start("kiosk", "asip-gateway", "--http", f"127.0.0.1:{cls.gateway}", "--tokens", str(tokens))
        eventually(lambda: can_connect(cls.gateway), "the gateway with tokens")
        server = http.server.ThreadingHTTPServer(("127.0.0.1", cls.frames), functools.partial(Frames, cls.link))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        cls.addClassCleanup(server.server_close)
        cls.addClassCleanup(server.shutdown)

    @classmethod
    def make(cls, role, name, *more):
        made = subprocess.run([str(program_path("asip-gateway")), "token", role, name, "--tokens", str(cls.tokens), *more],
                              check=True, capture_output=True, text=True, timeout=10)
        return made.stdout.strip()

    def take_out(self, name):
        lines = [line for line in self.tokens.read_text().splitlines(keepends=True) if line.split()[1] != name]
        self.tokens.write_text("".join(lines))

    def visible(self, selector):
        return [each.get_attribute("outerHTML")[:120] for each in self.browser.find(selector) if each.is_displayed()]

    def open_page(self, address):
        self.browser.driver.get("about:blank")
        self.browser.driver.get(address)

    def sign_in(self, token):
        field = self.browser.shown("#token", seconds=40)
        field.clear()
        field.send_keys(token)
        self.browser.button("Sign in").click()

    def show_board(self, address):
        self.open_page(address)
        self.browser.shown("asip-board asip-service", seconds=40)
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)
        eventually(lambda: "distance" in self.browser.text("main"), "its services")
        eventually(lambda: self.browser.find(".pin:not(.taken)"), "its pins")
        self.all_pins()

    def shows_nothing_that_acts(self):
        """Neither a stop nor a form nor what sets a pin, also not for a moment while the page begins."""
        eventually(lambda: self.browser.find(".pin:not(.taken)"), "its pins")
        self.all_pins()
        self.browser.shown(".pin:not(.taken)").click()
        self.browser.shown(".pin-panel")
        self.browser.run("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
        self.assertEqual(self.visible("button.stop, asip-command, .toggle, .setters input, asip-service form, .pin-panel button, .pin-panel input"), [])
        self.assertNotRegex(self.browser.text("body"), r"\bStop\b")

    def open_framed(self, host):
        self.browser.driver.get(f"http://{host}:{self.frames}/")
        self.browser.driver.switch_to.frame(self.browser.find("iframe")[0])
        self.addCleanup(self.browser.driver.switch_to.default_content)

    def test_FrameOfAnAllowedOrigin_ShowsTheBoardLive(self):
        self.open_framed("localhost")
        self.browser.shown("asip-board", seconds=40)
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)
        eventually(lambda: "distance" in self.browser.text("main"), "its services")
        self.assertEqual(self.browser.driver.get_cookies(), [])
        self.bus.sim("set", "desk/distance", "77")
        self.bus.get("/api/status")
        subprocess.run(["curl", "-s", "-o", "/dev/null", "-H", "Content-Type: application/json", "-d", "{}",
                        f"{self.bus.url}/api/boards/desk/services/distance/commands/measure"], check=True, timeout=10)
        eventually(lambda: "77" in self.browser.text("main"), "the value that was measured meanwhile", 30)
        self.browser.screenshot("kiosk-in-a-frame")

    def test_FrameOfAnotherOrigin_ShowsNothing(self):
        self.open_framed("127.0.0.1")
        self.assertEqual(self.browser.find("asip-board, asip-link"), [])

    def test_LinkByItself_ShowsTheBoardAndNothingThatActs(self):
        self.show_board(self.link)
        self.shows_nothing_that_acts()
        self.browser.screenshot("kiosk-link")

    def test_BeforeTheGatewayHasSaidWhatIsAllowed_NothingThatActsIsShown(self):
        driver = self.browser.driver
        driver.execute_cdp_cmd("Network.enable", {})
        driver.execute_cdp_cmd("Network.setBlockedURLs", {"urls": ["*/api/status"]})
        self.addCleanup(driver.execute_cdp_cmd, "Network.setBlockedURLs", {"urls": []})
        self.open_page(f"{self.bus.url}/#/board/desk")  # where this machine is an admin
        self.browser.shown("asip-board asip-service", seconds=40)
        self.shows_nothing_that_acts()
        driver.execute_cdp_cmd("Network.setBlockedURLs", {"urls": []})
        self.browser.shown("asip-board .setters input", seconds=40)
        self.browser.button("Stop all")
        self.browser.shown(".pin-panel button")
        driver.get_log("browser")  # what was blocked is logged as an error

    def test_LinkThatWasTakenBack_SaysSo(self):
        token = self.make("kiosk", "brief", "--boards", "desk")
        eventually(lambda: urlopen_status(f"{self.url}kiosk/{token}/api/status") == 200, "the token is read")
        self.show_board(f"{self.url}kiosk/{token}/#/board/desk")
        self.take_out("brief")
        eventually(lambda: "This link is not valid any more" in self.browser.text("main"), "the end", 40)
        self.assertEqual(self.visible("button.stop, nav a"), [])

    def test_BrowserWithoutToken_IsAskedForOneAndShownNothingElse(self):
        self.browser.driver.delete_all_cookies()
        self.open_page(self.url)
        self.browser.shown("#token", seconds=40)
        self.assertEqual(self.visible("button.stop, nav a"), [])
        signs = "return [...document.querySelectorAll('body *')].filter((each) => each.checkVisibility() && each.textContent.trim() === '' " \
            "&& getComputedStyle(each, '::before').content === '\"!\"').map((each) => each.outerHTML)"
        self.assertEqual(self.browser.run(signs), [], "nothing is wrong yet")
        self.assertEqual(self.visible("asip-link"), [], "there is nothing to be connected to")
        self.assertNotIn("asipctl open", self.browser.text("body"), "it needs a token, too")
        self.sign_in("nonsense")
        eventually(lambda: "does not know this token" in self.browser.text("main"), "why not")
        self.browser.screenshot("sign-in")

    def test_ViewerSignsIn_ReadsAndIsShownNothingThatActs(self):
        self.browser.driver.delete_all_cookies()
        token = self.make("viewer", "visitor")
        eventually(lambda: urlopen_status(f"{self.url}api/status", token) == 200, "the token is read")
        self.open_page(f"{self.url}#/board/desk")
        self.sign_in(token)
        self.browser.shown("asip-board asip-service", seconds=40)
        eventually(lambda: self.browser.find(".pin:not(.taken)"), "its pins")
        self.all_pins()
        self.assertNotIn(token, self.browser.driver.current_url)
        self.shows_nothing_that_acts()
        self.browser.run("location.hash = '#/settings'")
        self.browser.button("Sign out").click()
        self.browser.shown("#token", seconds=40)

    def test_OperatorOfOneBoard_IsShownFormsAndAStopThatSaysWhatItStops(self):
        self.browser.driver.delete_all_cookies()
        token = self.make("operator", "worker", "--boards", "desk")
        eventually(lambda: urlopen_status(f"{self.url}api/status", token) == 200, "the token is read")
        self.open_page(f"{self.url}#/board/desk")
        self.sign_in(token)
        self.browser.shown("asip-board .setters input", seconds=40)
        self.browser.button("Stop desk")
        self.browser.button("Stop my boards").click()
        eventually(lambda: "Stopped in" in self.browser.text("header"), "its answer")
        self.browser.button("Resume all").click()
        eventually(lambda: "Resumed" in self.browser.text("header"), "its answer")
        self.take_out("worker")
        self.browser.shown("#token", seconds=40)
        self.assertEqual(self.visible("button.stop, asip-command, .setters"), [])

    def test_OperatorOfSomeServices_IsShownFormsAndNoStop(self):
        self.browser.driver.delete_all_cookies()
        token = self.make("operator", "helper", "--boards", "desk", "--services", "servo")
        eventually(lambda: urlopen_status(f"{self.url}api/status", token) == 200, "the token is read")
        self.open_page(f"{self.url}#/board/desk")
        self.sign_in(token)
        self.browser.shown("asip-board .setters input", seconds=40)
        self.assertEqual(self.visible("button.stop, button.resume"), [])

    def test_CodeForAnotherName_AsksFirstAndIsRefusedFromAnotherSite(self):
        self.browser.driver.delete_all_cookies()
        self.addCleanup(self.browser.driver.delete_all_cookies)
        tokens = {name: self.make("viewer", name) for name in ("first", "second")}
        for token in tokens.values():
            eventually(lambda: urlopen_status(f"{self.url}api/status", token) == 200, "the token is read")
        driver = self.browser.driver

        def address(name):
            request = urllib.request.Request(f"{self.url}api/codes", data=b"{}", headers={
                "Authorization": f"Bearer {tokens[name]}", "Content-Type": "application/json"})
            return f"{self.url}?code={json.load(urllib.request.urlopen(request, timeout=10))['code']}#/board/desk"

        def signed_in():
            return self.browser.run("return fetch('/api/status').then((answer) => answer.json()).then((status) => status.you.name)")

        driver.get(address("first"))
        self.browser.shown("asip-board", seconds=40)
        self.assertEqual(signed_in(), "first")
        driver.get(f"http://localhost:{self.frames}/")
        self.browser.run(f"location.href = '{address('second')}'")
        eventually(lambda: "a page of another site led here" in self.browser.text("body"), "it is refused")
        self.assertEqual(signed_in(), "first")
        driver.get(address("second"))
        eventually(lambda: "Sign in as second?" in self.browser.text("main") and "If you did not" in self.browser.text("main"), "the question")
        self.browser.run("localStorage.setItem('asip-language', 'de')")
        self.addCleanup(lambda: self.browser.run("localStorage.removeItem('asip-language')"))
        driver.refresh()
        eventually(lambda: "Als second anmelden?" in self.browser.text("main") and "first bleiben" in self.browser.text("main"), "the question in German")
        self.browser.shown("#go").click()
        self.browser.shown("asip-board", seconds=40)
        self.assertEqual(signed_in(), "second")


def urlopen_status(address, token=None):
    request = urllib.request.Request(address, headers={"Authorization": f"Bearer {token}"} if token else {})
    try:
        return urllib.request.urlopen(request, timeout=10).status
    except urllib.error.HTTPError as refused:
        return refused.code


if __name__ == "__main__":
    unittest.main()
