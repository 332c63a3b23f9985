# SPDX-License-Identifier: Apache-2.0
"""Boards that browsers lend, without a browser: a real gateway, agent, broker and firmware, and a WebSocket that does what the page
does."""

import contextlib
import json
import pathlib
import socket
import sys
import threading
import time
import unittest
import urllib.error
import urllib.request

import websocket

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "box"))
from box_test import OLD_NANO, ask_anew, needs_tools, next_version  # noqa: E402
from bus import IMAGES, ROOT, Bus, eventually, program_path, settings_file  # noqa: E402
from lent_board import LentBoard, board_file  # noqa: E402
from secured_bus import SecuredBus  # noqa: E402

SERVICES = IMAGES / "asip_uno_services.elf"
EYE = {"kind": "ultrasonic", "name": "eye", "trigger": 7, "echo": 7, "distance": 42}


class LendingBus(Bus):
    """A bus with an agent of lent boards, and simulated boards at nobody's computer yet."""

    host = "127.0.0.1"
    gateway_options = ()
    agent_options = ()

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
        self.start("agent-cables", "asip-agent", "--cables", str(self.cables), "--lease", "6", *self.agent_options,
                   "--config", settings_file(f"firmware-dir = {self.firmware}\n"))
        eventually((self.cables / "gateway").exists, "the agent's socket")

    def start_gateway(self):
        options = ["--http", f"{self.host}:{self.http_port}", "--cables", str(self.cables), *self.gateway_options]
        if self.tokens:
            self.secrets = {name: self.make_token(role, name, *more) for role, name, *more in self.tokens}
            options += ["--tokens", str(self.work / "tokens")]
        self.start("gateway", "asip-gateway", *options)
        eventually(lambda: self.get("/readyz"), "the gateway")

    def make_token(self, role, name, *more):
        import subprocess
        return subprocess.run([str(program_path("asip-gateway")), "token", role, name, "--tokens", str(self.work / "tokens"), *more],
                              check=True, capture_output=True, text=True).stdout.split()[0]

    def lend(self, board, url=None, **more):
        return LentBoard(url or self.url, str(self.work / f"{board}.port"), **more)

    def ask(self, method, path, body=None, token=None, cookie=None):
        """(status, what is answered, the cookie that is set)."""
        headers = {"Content-Type": "application/json", **({"Authorization": f"Bearer {self.secrets[token]}"} if token else {}), **({"Cookie": cookie} if cookie else {})}
        request = urllib.request.Request(self.url + path, None if body is None else json.dumps(body).encode(), headers, method=method)
        try:
            answer = urllib.request.urlopen(request, timeout=30)
        except urllib.error.HTTPError as refused:
            answer = refused
        with answer:
            text = answer.read()
            return answer.status, json.loads(text) if text else None, answer.headers.get("Set-Cookie", "").split(";")[0]

    def board(self, name):
        return next((each for each in self.get("/api/boards?full=true")["items"] if each["board"] == name), None)

    def online(self, name, seconds=60):
        eventually(lambda: (self.board(name) or {}).get("state") == "online", f"{name} online", seconds)


class CableTest(unittest.TestCase):
    simulated = ({"name": "one", "image": SERVICES, "parts": [EYE]},)
    tokens = ()
    make_bus = LendingBus

    def setUp(self):
        self.bus = self.make_bus(self.simulated, self.tokens)
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

    def load(self):
        lent = self.lend("nano", vendor="1a86", product="7523")
        eventually(lambda: (lambda board: board and board["state"] == "lost" and board["reason"] == "silent")(self.bus.board("lent-loopback")),
                   "the board without ASIP", 60)
        flashed = self.bus.asipctl("flash", "lent-loopback", "--board", "nano-old")
        self.assertEqual(flashed.returncode, 0, flashed.stderr)
        self.bus.online("lent-loopback", 60)
        return lent

    def test_BoardFromTheBox_IsLoadedOverTheCable(self):
        lent = self.load()
        self.assertIn("42", self.bus.asipctl("get", "lent-loopback/distance/0").stdout)
        self.assertGreaterEqual(lent.restarts, 1)
        self.assertEqual(lent.baud, 57600)

    def test_TabThatClosesDuringAnUpdate_IsAFailure_AndTheBoardIsLoadedWhenItIsBack(self):
        lent = self.load()
        next_version(self.bus.firmware)
        ask_anew(self.bus, "lent-loopback")
        eventually(lambda: self.bus.board("lent-loopback").get("available") == "0.3", "out of date", 60)
        self.bus.online("lent-loopback", 60)
        ended = []
        update = threading.Thread(target=lambda: ended.append(self.bus.asipctl("flash", "--update")))
        update.start()
        eventually(lambda: self.bus.board("lent-loopback")["description"].get("updating", {}).get("step") == "writing", "it is being written", 90)
        lent.close()
        update.join(120)
        self.assertEqual(ended[0].returncode, 1, ended[0].stderr)
        self.assertRegex(ended[0].stdout, r"^lent-loopback +failed ")
        self.assertIn("0 updated, 1 failed, 0 left", ended[0].stderr)
        eventually(lambda: self.bus.board("lent-loopback")["state"] == "lost", "lost", 60)
        self.load()
        self.assertEqual(self.bus.board("lent-loopback")["version"], "0.3")


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
        # That of a pupil's place is none which a board may bring along.
        self.assertEqual(self.bus.asipctl("send", cables[7].name, "--raw", "#,I,student-3").returncode, 0)
        cables[7].close()
        pretender = self.lend("board7")
        eventually(lambda: pretender.name == "lent-0-student-3", "a name that is no pupil's", 60)


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

    def test_LineOfABoard_IsForWhomMayCommandIt(self):
        lent = self.start("lab")
        eventually(lambda: lent.name, "its name", 60)

        def asked(name, what):
            stream = websocket.create_connection(f"{self.bus.url.replace('http', 'ws')}/api/stream", suppress_origin=True, timeout=60,
                                                 header=[f"Authorization: Bearer {self.bus.secrets[name]}"])
            self.addCleanup(stream.close)
            stream.send(json.dumps({"subscribe": what, "ref": 1}))
            return stream, json.loads(stream.recv())

        for name, what in (("guest", "lent-lab/$line"), ("lab", "lent-*/$line")):
            self.assertIn("you may command", asked(name, what)[1].get("error", ""), name)
        all_services, _ = asked("lab", "lent-lab/*")
        stream, answer = asked("lab", "lent-lab/$line")
        self.assertTrue(answer.get("ok"), answer)
        seen = lambda: json.loads(stream.recv()).get("value", {}).get("line", [])
        while not any(direction == "<" and "@D,e," in text for direction, _, text in seen()):
            pass
        services = {json.loads(all_services.recv()).get("service") for _ in range(20)}
        self.assertNotIn("$line", services)

    def test_TokenTakenAway_EndsTheCableWithinASecond(self):
        lent = self.start("lender")
        eventually(lambda: lent.name, "its name", 30)
        tokens = self.bus.work / "tokens"
        tokens.write_text("".join(line for line in tokens.read_text().splitlines(True) if " lender " not in line))
        began = time.monotonic()
        eventually(lambda: lent.closed, "the end", 5)
        self.assertLess(time.monotonic() - began, 3)
        self.assertEqual((lent.why, lent.closed), ("the right to lend it has ended", 1008))


class Pupils(CableTest):
    simulated = tuple({"name": name, "image": SERVICES, "parts": [EYE]} for name in ("one", "two"))
    tokens = (("admin", "miss"), ("operator", "lab", "--boards", "uno*"))

    def open_lesson(self):
        status, lesson, _ = self.bus.ask("POST", "/api/lessons", {"lend": True, "minutes": 45}, token="miss")
        self.assertEqual((status, lesson["boards"], lesson["lend"]), (201, [], True))
        return lesson

    def join(self, lesson, number):
        status, seat, cookie = self.bus.ask("POST", "/api/join", {"code": lesson["code"]})
        self.assertEqual((status, seat["pupil"], seat["board"], seat["lend"]), (200, f"student-{number}", f"lent-student-{number}", True))
        return cookie

    def state(self, name, **by):
        _, board, _ = self.bus.ask("GET", f"/api/boards/{name}", **by)
        return board.get("state")

    def test_BoardOfAPupil_IsThePupilsAndTheTeachers_UntilTheLessonEnds(self):
        lesson = self.open_lesson()
        pupils = [self.join(lesson, number) for number in (1, 2)]
        cables = [self.lend(board, cookie=cookie) for board, cookie in zip(("one", "two"), pupils)]
        for number, cookie in enumerate(pupils, 1):
            own, other = f"lent-student-{number}", f"lent-student-{3 - number}"
            eventually(lambda: self.state(own, cookie=cookie) == "online", f"{own}, seen by its pupil", 60)
            self.assertEqual(self.bus.ask("POST", f"/api/boards/{own}/services/servo/commands/write", [0, 90], cookie=cookie)[0], 200)
            self.assertEqual(self.bus.ask("GET", f"/api/boards/{other}", cookie=cookie)[0], 404)
            self.assertEqual(self.bus.ask("POST", f"/api/boards/{own}/labels", {"labels": {"class": "4b"}}, cookie=cookie)[0], 403)
            self.assertEqual(self.state(own, token="miss"), "online")
            self.assertEqual(self.bus.ask("GET", f"/api/boards/{own}", token="lab")[0], 404)
        self.assertEqual(self.bus.ask("DELETE", f"/api/lessons/{lesson['id']}", token="miss")[0], 204)
        for number, cable in enumerate(cables, 1):
            eventually(lambda: cable.closed, "the end of the cable", 60)
            self.assertEqual((cable.why, cable.closed), ("the right to lend it has ended", 1008))
            eventually(lambda: self.state(f"lent-student-{number}", token="miss") == "lost", "lost", 60)
        for cookie in pupils:
            self.assertEqual(self.bus.ask("GET", "/api/boards/lent-student-1", cookie=cookie)[0], 401)
            with self.assertRaises(websocket.WebSocketBadStatusException) as refused:
                self.lend("one", cookie=cookie)
            self.assertEqual(refused.exception.status_code, 401)

    def test_SecondCableOfAPupil_EndsTheFirstForGood(self):
        cookie = self.join(self.open_lesson(), 1)
        first = self.lend("one", cookie=cookie)
        eventually(lambda: first.name, "its name", 60)
        second = self.lend("two", cookie=cookie)
        eventually(lambda: first.closed, "the end of the first", 60)
        self.assertEqual((first.why, first.closed), ("another board was connected in its place", 4001))
        eventually(lambda: second.name == "lent-student-1", "the second", 60)

    def test_NextLesson_HasTheSameNames_WhateverTheBoardIsCalled(self):
        lesson = self.open_lesson()
        first = self.lend("one", cookie=self.join(lesson, 1))
        eventually(lambda: self.state("lent-student-1", token="miss") == "online", "online", 60)
        status, _, _ = self.bus.ask("POST", "/api/boards/lent-student-1/raw", {"lines": ["#,I,rover"]}, token="miss")
        self.assertEqual(status, 200)
        self.bus.ask("DELETE", f"/api/lessons/{lesson['id']}", token="miss")
        eventually(lambda: first.closed, "the end", 60)
        first.close()
        for board in ("one", "two"):  # the second one while the first is there
            cookie = self.join(self.open_lesson(), 1) if board == "one" else cookie
            cable = self.lend(board, cookie=cookie)
            eventually(lambda: cable.name, "its name", 60)
            self.assertEqual(cable.name, "lent-student-1")
            eventually(lambda: self.state("lent-student-1", cookie=cookie) == "online", "online", 60)
        self.assertEqual([each["board"] for each in self.bus.ask("GET", "/api/boards", token="miss")[1]["items"]], ["lent-student-1"])
        eventually(lambda: "warnings" not in self.bus.ask("GET", "/api/boards/lent-student-1", token="miss")[1]["description"], "nothing is wrong", 60)


class SecuredLendingBus(LendingBus, SecuredBus):
    users = (("registry",), ("gateway",), ("board", "lent-student-1"))

    def start_cables(self):
        # As the service has it: each board finds broker and password in the file of its name.
        self.start("cables", "/usr/bin/env", "-u", "ASIP_BROKER", str(program_path("asip-agent")), "--cables", str(self.cables), "--lease", "6",
                   "--config", settings_file(f"credentials-dir = {self.work / 'bus' / 'credentials'}\n"))
        eventually((self.cables / "gateway").exists, "the agent's socket")


class Secured(CableTest):
    """A bus that lets in only whom it knows: each lent board has a name that is known before, and credentials."""

    tokens = (("admin", "miss"),)
    make_bus = SecuredLendingBus

    def test_BoardOfAPupil_SpeaksForItselfAlone(self):
        _, lesson, _ = self.bus.ask("POST", "/api/lessons", {"lend": True, "minutes": 45}, token="miss")
        cookie = self.bus.ask("POST", "/api/join", {"code": lesson["code"]})[2]
        self.lend("one", cookie=cookie)
        eventually(lambda: self.bus.ask("GET", "/api/boards/lent-student-1", cookie=cookie)[1].get("state") == "online", "online", 60)
        self.assertEqual(self.bus.ask("POST", "/api/boards/lent-student-1/services/servo/commands/write", [0, 90], cookie=cookie)[0], 200)


class Way:
    """A network between a browser and the gateway, which may be gone: then nothing is carried, and nobody is told."""

    def __init__(self, port):
        self.port = port
        self.there = threading.Event()
        self.there.set()
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.listener.getsockname()[1]}"
        self.ends = []
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                near, _ = self.listener.accept()
                self.there.wait()
                far = socket.create_connection(("127.0.0.1", self.port))
            except OSError:
                return
            self.ends += [near, far]
            for source, target in ((near, far), (far, near)):
                threading.Thread(target=self.carry, args=(source, target), daemon=True).start()

    def carry(self, source, target):
        with contextlib.suppress(OSError):
            while data := source.recv(4096):
                self.there.wait()
                target.sendall(data)
        self.there.wait()
        for each in (source, target):
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)

    def gone(self, seconds):
        self.there.clear()
        time.sleep(seconds)
        self.there.set()

    def close(self):
        self.there.set()
        for each in (self.listener, *self.ends):
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()


class OverAWay(CableTest):
    simulated = tuple({"name": name, "image": SERVICES, "parts": [EYE]} for name in ("one", "two"))

    def setUp(self):
        super().setUp()
        self.way = Way(self.bus.http_port)
        self.addCleanup(self.way.close)

    def lent(self, **more):
        lent = self.lend("one", **more)
        self.bus.online("lent-loopback")
        return lent

    def works(self):
        self.bus.online("lent-loopback")
        sent = eventually(lambda: (lambda done: done.returncode == 0 and done)(self.bus.asipctl("send", "lent-loopback/servo", "write", "0", "90")), "a command", 60)
        self.assertEqual(sent.returncode, 0)

    def is_lost(self, reason):
        eventually(lambda: (lambda board: (board["state"], board.get("reason")) == ("lost", reason))(self.bus.board("lent-loopback")), f"lost, {reason}", 60)


class Network(OverAWay):
    def test_GoneForASecond_CableGoesOn(self):
        lent = self.lent(url=self.way.url)
        self.way.gone(1)
        self.works()
        self.assertIsNone(lent.closed)

    def test_GoneForTenSeconds_BoardIsSilent_AndBackOnTheSameCable(self):
        lent = self.lent(url=self.way.url)
        self.way.there.clear()
        began = time.monotonic()
        self.is_lost("silent")
        time.sleep(max(0, began + 10 - time.monotonic()))
        self.way.there.set()
        self.works()
        self.assertIsNone(lent.closed)
        eventually(lambda: lent.alive, "the gateway says that it is there", 60)

    def test_AnotherWayWhileTheOldOneStands_BoardKeepsItsName(self):
        """A laptop that changes its network: the gateway has not seen the end of the old connection yet."""
        old = self.lent(url=self.way.url)
        self.way.there.clear()
        old.leave()
        again = self.lend("one", cable=old.cable)
        eventually(lambda: again.name, "its name", 60)
        self.assertEqual(again.name, "lent-loopback")
        self.works()
        self.assertEqual([each["board"] for each in self.bus.get("/api/boards")["items"]], ["lent-loopback"])
        self.way.there.set()
        eventually(lambda: old.closed, "the end of the old one", 60)
        self.works()

    def test_BrowserAsleep_BoardIsSilent_AndBack(self):
        lent = self.lent()
        lent.lock.acquire()  # its threads stand still
        try:
            self.is_lost("silent")
        finally:
            lent.lock.release()
        self.works()
        self.assertIsNone(lent.closed)

    def test_ServerStartedAgain_TwoBoardsOfALenderKeepTheirNames(self):
        cables = []
        for board in ("one", "two"):
            cables.append(self.lend(board))
            eventually(lambda: cables[-1].name, "its name", 60)
        self.assertEqual([each.name for each in cables], ["lent-loopback", "lent-loopback-2"])
        self.bus.end("gateway")
        for each in cables:
            each.close()
        eventually(lambda: not any((self.bus.cables / name).is_symlink() for name in ("loopback", "loopback-2")), "both cables are gone")
        self.bus.start_gateway()
        for board, before in (("two", cables[1]), ("one", cables[0])):
            again = self.lend(board, cable=before.cable)
            eventually(lambda: again.name, "its name", 60)
            self.assertEqual(again.name, before.name)


class NetworkGoneForAMinute(OverAWay):
    def test_GatewayEndsTheCable_AndTheNextOneHasItsName(self):
        lent = self.lent(url=self.way.url)
        self.way.there.clear()
        self.is_lost("silent")
        self.is_lost("unplugged")
        self.assertEqual(self.bus.board("lent-loopback")["description"]["warnings"], ["the browser that lent it closed"])
        time.sleep(25)  # a minute in all
        self.way.there.set()
        eventually(lambda: not lent.threads[1].is_alive(), "the end of the connection", 60)
        lent.close()
        self.lend("one", cable=lent.cable)
        self.works()


if __name__ == "__main__":
    unittest.main()
