# SPDX-License-Identifier: Apache-2.0
"""What a secured bus keeps to itself: passwords and tokens stand in no log, however much is logged, and in no file that others can read;
the broker may use half of the machine's memory."""

import json
import os
import re
import shutil
import subprocess
import unittest
import urllib.error
import urllib.request

from bus import BIN, DESK, ROOT, eventually
from secured_bus import SecuredBus


class TalkativeBus(SecuredBus):
    users = (("board", "desk"), ("registry",), ("gateway",), ("operator", "ann"), ("viewer", "bob"))

    def start(self, name, program, *arguments):
        more = ("--log-level", "trace") if program in ("asip-agent", "asip-registry", "asip-gateway") else ()
        super().start(name, program, *arguments, *more)

    def start_gateway(self):
        made = {}
        for role, name, more in (("operator", "ann", ()), ("kiosk", "hall", ("--boards", "desk"))):
            command = [str(BIN / "asip-gateway"), "token", role, name, "--tokens", str(self.work / "tokens"), *more]
            made[role] = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()[0]
        self.token, self.kiosk = made["operator"], made["kiosk"]
        self.start("gateway", "asip-gateway", "--http", f"127.0.0.1:{self.http_port}", "--tokens", str(self.work / "tokens"))
        eventually(lambda: self.get("/readyz"), "the gateway")

    def asked(self, path, **more):
        try:
            with urllib.request.urlopen(urllib.request.Request(self.url + path, **more), timeout=20) as answer:
                return answer.status
        except urllib.error.HTTPError as error:
            return error.code

    def get(self, path):
        with urllib.request.urlopen(urllib.request.Request(self.url + path, headers={"Authorization": f"Bearer {self.token}"}), timeout=20) as answer:
            return json.load(answer)


class Secrets(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = TalkativeBus(boards=(DESK,))
        cls.addClassCleanup(cls.bus.close)

    def test_NoLogHasAPasswordOrAToken(self):
        bus = self.bus
        secrets = {name: bus.user(name)[1] for name in ("desk", "registry", "gateway", "ann", "bob", "admin")}
        secrets |= {"a token": bus.token, "the token of a kiosk": bus.kiosk}
        said = ""
        for user, words in (("ann", ("send", "desk/io", "write", "13", "1")), ("bob", ("send", "desk/io", "write", "13", "1")), ("bob", ("doctor",))):
            done = bus.asipctl(*words, "--credentials", str(bus.credentials(user)))
            said += done.stdout + done.stderr
        self.assertEqual(bus.asked(f"/kiosk/{bus.kiosk}/api/boards"), 200)
        self.assertEqual(bus.asked(f"/kiosk/{bus.kiosk}/api/stop", data=b"{}", headers={"Content-Type": "application/json"}), 403)
        self.assertEqual(bus.asked(f"/kiosk/{bus.kiosk}x/api/boards"), 404)
        secrets["a link of a dashboard"] = link = self.made_link()
        self.assertEqual(bus.asked(f"/kiosk/{link}/api/dashboards/lab"), 200)
        self.assertEqual(bus.asked(f"/kiosk/{link}x/api/dashboards/lab"), 404)
        self.assertEqual(bus.asked("/api/boards", headers={"Authorization": f"Bearer {bus.token}"}), 200)
        self.assertEqual(bus.asked("/api/boards", headers={"Authorization": f"Bearer {bus.token}x"}), 401)
        wrong = {"ASIP_USER": "ann", "ASIP_PASSWORD": "wrong-but-not-shown", "ASIP_CA": str(bus.work / "bus" / "ca.crt"),
                 "ASIP_BROKER": f"mqtts://127.0.0.1:{bus.broker_port}"}
        done = subprocess.run([str(BIN / "asipctl"), "list"], env={**os.environ, **wrong}, capture_output=True, text=True, timeout=60)
        self.assertNotEqual(done.returncode, 0)
        secrets["one of the environment"] = wrong["ASIP_PASSWORD"]
        said += done.stdout + done.stderr
        # They write what they know of the connection to the broker when it is lost and made again, and when the password is wrong.
        bus.end("broker")
        self.assertIn(" trace ", self.log("agent-desk"))
        bus.secure("renew", "desk")
        bus.start("broker", shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin"), "-c", str(bus.work / "bus" / "mosquitto.conf"))
        eventually(lambda: re.search("password|not authori", self.log("agent-desk"), re.I), "the agent whose password is an old one")
        secrets["the new one of desk"] = bus.user("desk")[1]
        everything = said + "".join(self.log(path.stem) for path in bus.work.glob("*.log"))
        for name, secret in secrets.items():
            self.assertGreater(len(secret), 15)
            self.assertNotIn(secret, everything, name)

    def made_link(self):
        bus = self.bus
        own = {"Authorization": f"Bearer {bus.token}", "Content-Type": "application/json"}
        board = {"title": "lab", "widgets": [{"id": "w1", "kind": "slider", "board": "desk", "property": "servo/0/angle"}]}
        self.assertIn(bus.asked("/api/dashboards/lab", data=json.dumps(board).encode(), headers=own, method="PUT"), (200, 201))
        eventually(lambda: "lab" in json.dumps(bus.get("/api/dashboards")), "a dashboard", 60)
        asked = urllib.request.Request(f"{bus.url}/api/dashboards/lab/links", b"{}", own)
        with urllib.request.urlopen(asked, timeout=20) as answer:
            token = json.load(answer)["token"]
        eventually(lambda: bus.asked(f"/kiosk/{token}/api/dashboards/lab") == 200, "the link", 60)
        return token

    def log(self, name):
        return (self.bus.work / f"{name}.log").read_text(errors="replace")

    def test_OtherUsersReadNoCredentials(self):
        files = [*(self.bus.work / "bus" / "credentials").iterdir(), self.bus.work / "tokens"]
        self.assertGreater(len(files), 5)
        for file in files:
            self.assertEqual(file.stat().st_mode & 0o077, 0, file)
            if os.geteuid() == 0:
                os.chmod(self.bus.work, 0o755)
                read = subprocess.run(["setpriv", "--reuid", "65534", "--clear-groups", "cat", str(file)], capture_output=True, text=True)
                self.assertNotEqual(read.returncode, 0, file)

    def test_TheBrokerMayUseHalfOfTheMemory(self):
        configuration = (self.bus.work / "bus" / "mosquitto.conf").read_text()
        self.assertIn(f"\nmax_queued_bytes {256 << 20}\n", configuration)
        limit = int(re.search(r"^memory_limit (\d+)$", configuration, re.M)[1])
        half = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2
        self.assertLessEqual(limit, max(half, 64 << 20))
        self.assertGreater(limit, half - (64 << 20))


class Units(unittest.TestCase):
    def test_ServicesRunAsOneUser_AndHaveTheMemoryThatIsPromised(self):
        promised = " ".join((ROOT / "SECURITY.md").read_text().split())
        found = re.search(r"an agent of one board (\d+) MB, an agent of all boards (\d+) MB, a registry and a gateway (\d+) GB", promised)
        one, all_boards, others = found[1] + "M", found[2] + "M", found[3] + "G"
        limits = {"asip-agent@": one, "asip-boards": all_boards, "asip-cables": all_boards, "asip-gateway": others, "asip-registry": others}
        units = {path.stem: path.read_text() for path in (ROOT / "packaging" / "systemd").glob("*.service")}
        self.assertEqual(set(units), set(limits))
        for name, text in units.items():
            self.assertEqual(re.findall(r"^User=(.*)$", text, re.M), ["asip"], name)
            self.assertEqual(re.findall(r"^MemoryMax=(.*)$", text, re.M), [limits[name]], name)


if __name__ == "__main__":
    unittest.main()
