# SPDX-License-Identifier: Apache-2.0
"""The page in a frame of another site, by a kiosk's link: no cookie, no token but the one in the address."""

import functools
import http.server
import subprocess
import threading
import unittest

from rig import DESK, PageTest, eventually, free_port, program_path


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
    expected_errors = ("frame-ancestors", "Refused to frame")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.frames, cls.gateway = free_port(), free_port()
        tokens = cls.bus.work / "tokens"
        # localhost is another site than 127.0.0.1, whatever the port.
        made = subprocess.run([str(program_path("asip-gateway")), "token", "kiosk", "hall", "--tokens", str(tokens),
                               "--boards", "desk", "--frames", f"http://localhost:{cls.frames}"],
                              check=True, capture_output=True, text=True, timeout=10)
        cls.link = f"http://127.0.0.1:{cls.gateway}/kiosk/{made.stdout.strip()}/#/board/desk"
        cls.bus.start("kiosk", "asip-gateway", "--http", f"127.0.0.1:{cls.gateway}", "--tokens", str(tokens))
        server = http.server.ThreadingHTTPServer(("127.0.0.1", cls.frames), functools.partial(Frames, cls.link))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        cls.addClassCleanup(server.server_close)
        cls.addClassCleanup(server.shutdown)

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

    def test_LinkByItself_ShowsTheBoard(self):
        self.browser.driver.get(self.link)
        self.browser.shown("asip-board", seconds=40)
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)


if __name__ == "__main__":
    unittest.main()
