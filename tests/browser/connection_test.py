# SPDX-License-Identifier: Apache-2.0
"""The connection lost and back, and several tabs on one connection."""

import contextlib
import signal
import socket
import threading
import unittest

from selenium.webdriver.common.by import By

from rig import PageTest, can_connect, commands_heard, eventually, free_port, paho_client


class Cuttable:
    """A way to a port that can be cut and mended."""

    def __init__(self, to):
        self.to = to
        self.open = True
        self.ends = []
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]

    def __enter__(self):
        threading.Thread(target=self.accept, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.cut()
        for end in (self.listener, *self.ends):
            end.close()

    def accept(self):
        with contextlib.suppress(OSError):
            while True:
                near, _ = self.listener.accept()
                if not self.open:
                    near.close()
                    continue
                far = socket.create_connection(("127.0.0.1", self.to))
                self.ends += [near, far]
                for one, other in ((near, far), (far, near)):
                    threading.Thread(target=self.carry, args=(one, other), daemon=True).start()

    @staticmethod
    def carry(one, other):
        with contextlib.suppress(OSError):
            while data := one.recv(65536):
                other.sendall(data)
        with contextlib.suppress(OSError):
            other.shutdown(socket.SHUT_RDWR)

    def cut(self):
        self.open = False
        for end in self.ends:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def mend(self):
        self.open = True


class Connection(PageTest):
    expected_errors = ("ERR_CONNECTION_REFUSED", "WebSocket connection", "Failed to load resource", "ERR_CONNECTION_RESET")

    def online(self, *boards):
        def shown():
            rows = self.browser.table()
            return all("online" in rows.get(board, "") for board in boards)
        eventually(shown, f"{boards} online")

    def test_GatewayGoneAndBack_IsSeenAndTheTableIsTrueAgain(self):
        self.open()
        self.online("desk", "lamp")
        self.browser.run("window.same_page = true")
        self.bus.end("gateway", signal.SIGKILL)
        eventually(lambda: "lost since" in self.browser.text("asip-banner"), "the sign that the connection is lost")
        self.assertEqual(self.browser.text("asip-link"), "not connected")
        self.browser.screenshot("connection-lost")
        self.bus.end("agent-lamp")
        self.bus.start_gateway()
        eventually(lambda: self.browser.text("asip-banner") == "", "the sign gone", 30)
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)
        eventually(lambda: "offline" in self.browser.text(".filler") or "lost" in self.browser.text(".filler"), "what changed meanwhile", 30)
        self.assertTrue(self.browser.run("return window.same_page"))
        self.bus.start_agent("lamp")
        self.online("desk", "lamp")

    def test_CommandWithoutConnection_IsRefusedAtOnceAndNotSentLater(self):
        self.open_board()
        form = self.form("servo", "Turn a servo to an angle")
        self.fill(form, "Angle", "20")
        before = self.bus.part("desk/servo")
        self.bus.end("gateway", signal.SIGKILL)
        eventually(lambda: "lost since" in self.browser.text("asip-banner"), "the sign")
        eventually(lambda: "Commands are off" in self.browser.text(".unusable"), "the forms are off")
        self.browser.run("arguments[0].requestSubmit()", form) # the user was quicker
        eventually(lambda: "no connection" in form.text, "the refusal")
        self.bus.start_gateway()
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)
        eventually(lambda: self.bus.state("desk") == "online", "desk online")
        self.assertAlmostEqual(float(self.bus.part("desk/servo")), float(before), delta=2)  # of pulses, as measured

    def test_ConnectionCutWhileACommandIsUnderWay_ItsOutcomeIsShown(self):
        with Cuttable(self.bus.http_port) as path, commands_heard(self.bus) as heard:
            self.browser.driver.get(f"http://127.0.0.1:{path.port}/#/board/desk")
            form = self.form("servo", "Turn a servo to an angle")
            eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)
            self.fill(form, "Angle", "70")
            self.bus.programs["agent-desk"].send_signal(signal.SIGSTOP)
            self.send(form)
            eventually(lambda: heard, "the command on its way to the board")
            path.cut()
            eventually(lambda: self.browser.text("asip-link") == "not connected", "the loss of the connection")
            self.bus.programs["agent-desk"].send_signal(signal.SIGCONT)
            path.mend()
            self.answered(form, "ok", "Done")
            self.assertEqual(len(heard), 1, "it is not sent again")

    def test_BrokerGone_IsSaid(self):
        self.open()
        self.online("desk")
        self.bus.end("broker")
        eventually(lambda: "no connection to the broker" in self.browser.text("asip-banner"), "the sign", 30)
        self.assertEqual(self.browser.text("asip-link"), "no broker")
        self.bus.start_broker()
        eventually(lambda: self.browser.text("asip-link") == "live", "live", 30)
        self.online("desk", "lamp")

    def off(self):
        return self.browser.run("""const forms = [...document.querySelectorAll('asip-board asip-command')];
            return forms.length > 0 && forms.every((each) => each.closest('[inert]'))""")

    def test_FormsBehindALostBroker_AreOffUntilItIsBack(self):
        self.open_board()
        self.form("servo", "Turn a servo to an angle")
        eventually(lambda: not self.off(), "the forms can be used")
        self.bus.end("broker")
        eventually(self.off, "the forms are off", 30)
        self.assertIn("the bus cannot be reached", self.browser.text(".unusable"))
        self.bus.start_broker()
        eventually(lambda: not self.off() and self.browser.text(".unusable") == "", "the forms can be used again", 60)

    def test_FormsOfABoardWhosePortIsLent_AreOffUntilItIsBack(self):
        self.open_board("lamp")
        eventually(lambda: not self.off(), "the forms can be used")
        client = paho_client()
        client.connect("127.0.0.1", self.bus.broker_port)
        client.loop_start()
        self.addCleanup(client.loop_stop)
        self.addCleanup(client.disconnect)
        client.publish("asip/lamp/in", '{"port":"release","seconds":60,"by":"ann"}', qos=1).wait_for_publish(20)
        eventually(self.off, "the forms are off", 30)
        self.assertIn("in other hands", self.browser.text(".unusable"))
        client.publish("asip/lamp/in", '{"port":"take"}', qos=1).wait_for_publish(20)
        eventually(lambda: not self.off(), "the forms can be used again", 60)

    def test_BrokerThatNeverWasThere_HasNoTimeSinceWhichItIsGone(self):
        port = free_port()
        self.bus.start("lonely", "asip-gateway", "--http", f"127.0.0.1:{port}", "--broker", f"127.0.0.1:{free_port()}")
        self.addCleanup(self.bus.end, "lonely")
        eventually(lambda: can_connect(port), "the gateway without a broker")
        self.browser.driver.get(f"http://127.0.0.1:{port}/")
        text = eventually(lambda: "no connection to the broker" in self.browser.text("asip-banner") and self.browser.text("asip-banner"), "the sign", 30)
        self.assertNotIn("since", text)
        self.browser.driver.get(f"http://127.0.0.1:{port}/#/settings")
        eventually(lambda: "Broker" in self.browser.text("asip-settings"), "the cards")
        self.assertNotIn("00:00:00", self.browser.text("body"))

    def test_SevenTabs_NoneStalls(self):
        driver = self.browser.driver
        self.open()
        self.online("desk", "lamp")
        first = driver.current_window_handle
        for _ in range(6):
            driver.switch_to.new_window("tab")
            self.browser.desktop()
            self.open_board()
        self.assertEqual(self.bus.get("/api/status")["streams"]["clients"], 1)
        form = self.form("servo", "Turn a servo to an angle")
        self.fill(form, "Angle", "70")
        form.find_element(By.CSS_SELECTOR, "button.main").click()
        eventually(lambda: "Done" in form.text, "the answer in the seventh tab")
        # A browser has six connections for all pages of an address: were they taken by streams, this would hang.
        driver.get("about:blank")
        self.open("settings", anew=True)
        self.browser.shown("asip-settings")
        for handle in driver.window_handles:
            if handle != first:
                driver.switch_to.window(handle)
                driver.close()
        driver.switch_to.window(first)
        eventually(lambda: self.browser.text("asip-link") == "live", "the first tab is live")

    def test_TwoTabs_ShareOneConnectionAndBothAreLive(self):
        driver = self.browser.driver
        self.open()
        self.online("desk", "lamp")
        first = driver.current_window_handle
        driver.switch_to.new_window("tab")
        self.browser.desktop()
        self.open_board()
        self.assertEqual(self.bus.get("/api/status")["streams"]["clients"], 1)
        form = self.form("servo", "Turn a servo to an angle")
        self.fill(form, "Angle", "100")
        form.find_element(By.CSS_SELECTOR, "button.main").click()
        eventually(lambda: "Done" in form.text, "the answer in the second tab")
        self.bus.end("agent-lamp")
        driver.switch_to.window(first)
        eventually(lambda: "offline" in self.browser.text(".filler"), "the change in the first tab")
        driver.switch_to.window(driver.window_handles[-1])
        driver.close()
        driver.switch_to.window(first)
        self.bus.start_agent("lamp")
        self.online("desk", "lamp")


if __name__ == "__main__":
    unittest.main()
