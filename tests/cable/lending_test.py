# SPDX-License-Identifier: Apache-2.0
"""Boards that browsers lend, without a browser: a real gateway, agent, broker and firmware, and a WebSocket that does what the page
does."""

import contextlib
import json
import pathlib
import sys
import time
import unittest
import urllib.error
import urllib.request

import websocket

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "box"))
from box_test import OLD_NANO, needs_tools  # noqa: E402
from bus import IMAGES, ROOT, Bus, eventually, program_path, settings_file  # noqa: E402
from lent_board import LentBoard, board_file  # noqa: E402

SERVICES = IMAGES / "asip_uno_services.elf"
EYE = {"kind": "ultrasonic", "name": "eye", "trigger": 7, "echo": 7, "distance": 42}


class LendingBus(Bus):
    """A bus with an agent of lent boards, and simulated boards at nobody's computer yet."""

    def __init__(self, simulated=(), tokens=()):
        self.simulated = simulated
        self.tokens = tokens
        super().__init__(boards=())

    def start_all(self):
        self.cables = self.work / "cables"
        self.firmware = self.work / "firmware"
        super().start_all()
        self.start_cables()
        if self.simulated:
            files = [board_file(self.work, **board) for board in self.simulated]
            self.start("sim", "asip-sim", "--socket", str(self.work / "sim.sock"), *files)
            eventually(lambda: all((self.work / f"{board['name']}.port").exists() for board in self.simulated), "the ports")

    def start_cables(self):
        self.start("agent-cables", "asip-agent", "--cables", str(self.cables), "--lease", "6",
                   "--config", settings_file(f"firmware-dir = {self.firmware}\n"))
        eventually((self.cables / "gateway").exists, "the agent's socket")

    def start_gateway(self):
        options = ["--http", f"127.0.0.1:{self.http_port}", "--cables", str(self.cables)]
        if self.tokens:
            self.secrets = {name: self.make_token(role, name, *more) for role, name, *more in self.tokens}
            options += ["--tokens", str(self.work / "tokens")]
        self.start("gateway", "asip-gateway", *options)
        eventually(lambda: self.get("/healthz"), "the gateway")

    def make_token(self, role, name, *more):
        import subprocess
        return subprocess.run([str(program_path("asip-gateway")), "token", role, name, "--tokens", str(self.work / "tokens"), *more],
                              check=True, capture_output=True, text=True).stdout.split()[0]

    def lend(self, board, **more):
        return LentBoard(self.url, str(self.work / f"{board}.port"), **more)

    def board(self, name):
        return next((each for each in self.get("/api/boards?full=true")["items"] if each["board"] == name), None)

    def online(self, name, seconds=30):
        eventually(lambda: (self.board(name) or {}).get("state") == "online", f"{name} online", seconds)


class CableTest(unittest.TestCase):
    simulated = ({"name": "one", "image": SERVICES, "parts": [EYE]},)
    tokens = ()

    def setUp(self):
        self.bus = LendingBus(self.simulated, self.tokens)
        self.addCleanup(self.bus.close)
        self.addCleanup(lambda: self._outcome.success or print(self.bus.logs()))

    def lend(self, board, **more):
        lent = self.bus.lend(board, **more)
        self.addCleanup(lent.close)
        return lent


class OneCable(CableTest):
    def test_LentBoard_IsOnTheBus_StepsUpAndAnswers(self):
        lent = self.lend("one")
        eventually(lambda: lent.name, "its name", 30)
        self.assertEqual(lent.name, "lent-loopback")
        self.bus.online(lent.name)
        eventually(lambda: lent.baud == 1_000_000, "the line is stepped up", 10)
        self.assertIn("42", self.bus.asipctl("get", f"{lent.name}/distance/0").stdout)
        self.assertEqual(self.bus.asipctl("send", f"{lent.name}/servo", "write", "0", "90").returncode, 0)
        self.assertEqual(lent.restarts, 0)

    def test_TabThatCloses_IsAPulledCable_AndTheBoardComesBack(self):
        lent = self.lend("one")
        self.bus.online("lent-loopback")
        lent.close()
        lost = eventually(lambda: (lambda board: board["state"] == "lost" and board)(self.bus.board("lent-loopback")), "lost")
        self.assertEqual(lost["reason"], "unplugged")
        self.assertIn("the browser that lent it closed", json.dumps(lost["description"]["warnings"]))
        again = self.lend("one")
        self.bus.online("lent-loopback")
        self.assertNotIn("warnings", self.bus.board("lent-loopback")["description"])
        self.assertEqual(self.bus.asipctl("send", "lent-loopback/servo", "write", "0", "90").returncode, 0)
        self.assertIsNone(again.why)

    def test_BoardPulledThere_IsLostWithThatReason(self):
        self.lend("one")
        self.bus.online("lent-loopback")
        self.bus.sim("unplug", "one")
        lost = eventually(lambda: (lambda board: board["state"] == "lost" and board)(self.bus.board("lent-loopback")), "lost")
        self.assertEqual(lost["reason"], "unplugged", lost)
        self.assertIn("was unplugged from the computer that lent it", json.dumps(lost["description"]["warnings"]))

    def test_AgentStartedAgain_PageIsTold_AndTheNextCableServes(self):
        lent = self.lend("one")
        self.bus.online("lent-loopback")
        self.bus.end("agent-cables")
        eventually(lambda: lent.closed, "the end of the cable")
        self.assertEqual((lent.why, lent.closed), ("the agent of lent boards was stopped", 1000))
        self.bus.start_cables()
        lent.close()
        self.lend("one")
        self.bus.online("lent-loopback")

    def test_MoreThanAMegabitASecond_EndsTheCable(self):
        lent = self.lend("one")
        self.bus.online("lent-loopback")
        for _ in range(200):  # a machine with other work to do may carry the first of them within the rate
            if not lent.closed:
                lent.send(b"D" + b"x" * 60000)
        eventually(lambda: lent.closed, "the end")
        self.assertEqual((lent.why, lent.closed), ("its browser sent more than 1 Mbit/s", 1008))
        eventually(lambda: self.bus.board("lent-loopback")["state"] == "lost", "lost")

    def test_WrongMessages_EndTheCableAlone(self):
        for wrong in (b"", b"X", b"R9600"):
            lent = self.lend("one")
            self.bus.online("lent-loopback")
            lent.send(wrong)
            eventually(lambda: lent.closed, f"the end, {wrong}")
            self.assertEqual(lent.closed, 1008)
            lent.close()
        lent = self.lend("one")
        lent.socket.send("D text")
        eventually(lambda: lent.closed, "the end, text")
        self.assertEqual(lent.closed, 1003)
        lent.close()
        with self.assertRaises(websocket.WebSocketBadStatusException) as refused:
            self.lend("one", vendor="xyz")
        self.assertEqual(refused.exception.status_code, 400)
        self.lend("one")
        self.bus.online("lent-loopback")


class RestartedByOpening(CableTest):
    simulated = ({"name": "uno", "image": SERVICES, "reset_on_open": True, "parts": [EYE]},)

    def test_BoardThatOpeningRestarts_KeepsItsRate(self):
        lent = self.lend("uno")
        self.bus.online("lent-loopback")
        self.assertIn("42", self.bus.asipctl("get", "lent-loopback/distance/0").stdout)
        self.assertEqual((lent.port.opened, lent.restarts), ([57600], 0))


class Firmware(CableTest):
    simulated = ({"name": "nano", "board": "nano", "image": OLD_NANO, "reset_on_open": True, "parts": [EYE]},)

    def setUp(self):
        needs_tools()
        super().setUp()
        import subprocess
        subprocess.run([ROOT / "packaging/loadable_firmware", IMAGES, self.bus.firmware], check=True)

    def test_BoardFromTheBox_IsLoadedOverTheCable(self):
        lent = self.lend("nano", vendor="1a86", product="7523")
        eventually(lambda: (lambda board: board and board["state"] == "lost" and board["reason"] == "silent")(self.bus.board("lent-loopback")),
                   "the board without ASIP", 60)
        flashed = self.bus.asipctl("flash", "lent-loopback", "--board", "nano-old")
        self.assertEqual(flashed.returncode, 0, flashed.stderr)
        self.bus.online("lent-loopback", 60)
        self.assertIn("42", self.bus.asipctl("get", "lent-loopback/distance/0").stdout)
        self.assertGreaterEqual(lent.restarts, 1)
        self.assertEqual(lent.baud, 57600)


class TenCables(CableTest):
    simulated = tuple({"name": f"board{i}", "image": SERVICES, "parts": [EYE]} for i in range(10))

    def test_TenAtOnce_EachIsABoardOfItsOwn_AndStoredNamesGoWithTheBoard(self):
        cables = [self.lend(f"board{i}") for i in range(10)]
        eventually(lambda: all(each.name for each in cables), "the names", 90)
        names = [each.name for each in cables]
        self.assertEqual(sorted(names), sorted(["lent-loopback"] + [f"lent-loopback-{i}" for i in range(2, 11)]))
        for name in names:
            self.bus.online(name, 90)
        # A board with a name of its own has that wherever it is.
        rover = cables[3]
        self.assertEqual(self.bus.asipctl("send", rover.name, "--raw", "#,I,rover").returncode, 0)
        rover.close()
        cables[5].close()
        eventually(lambda: self.bus.board(names[5])["state"] == "lost", "another place that is free")
        for _ in range(2):
            back = self.lend("board3")
            eventually(lambda: back.name == "lent-rover", "its own name", 60)
            self.bus.online("lent-rover", 60)
            back.close()
            eventually(lambda: self.bus.board("lent-rover")["state"] == "lost", "lost")


class Rights(CableTest):
    tokens = (("admin", "teacher"), ("operator", "lab"), ("operator", "lender", "--boards", "lent-*"),
              ("operator", "limited", "--boards", "uno*"), ("viewer", "guest"))

    def start(self, name):
        return self.lend("one", token=self.bus.secrets[name] if name else None)

    def get(self, name, path):
        request = urllib.request.Request(self.bus.url + path, headers={"Authorization": f"Bearer {self.bus.secrets[name]}"})
        with contextlib.closing(urllib.request.urlopen(request, timeout=10)) as answer:
            return json.load(answer)

    def test_WhoMayLend_AndSees(self):
        for name, status in ((None, 401), ("guest", 403), ("limited", 403)):
            with self.assertRaises(websocket.WebSocketBadStatusException) as refused:
                self.start(name)
            self.assertEqual(refused.exception.status_code, status, name)
        for name in ("teacher", "lab", "lender"):
            lent = self.start(name)
            eventually(lambda: lent.name == f"lent-{name}", f"the name, of {name}", 30)
            eventually(lambda: self.get(name, f"/api/boards/lent-{name}")["state"] == "online", "seen by its lender")
            self.get("teacher", f"/api/boards/lent-{name}")
            with self.assertRaises(urllib.error.HTTPError) as hidden:
                self.get("limited", f"/api/boards/lent-{name}")
            self.assertEqual(hidden.exception.code, 404)
            lent.close()

    def test_TokenTakenAway_EndsTheCableWithinASecond(self):
        lent = self.start("lender")
        eventually(lambda: lent.name, "its name", 30)
        tokens = self.bus.work / "tokens"
        tokens.write_text("".join(line for line in tokens.read_text().splitlines(True) if " lender " not in line))
        began = time.monotonic()
        eventually(lambda: lent.closed, "the end", 5)
        self.assertLess(time.monotonic() - began, 3)
        self.assertEqual((lent.why, lent.closed), ("the right to lend it has ended", 1008))


if __name__ == "__main__":
    unittest.main()
