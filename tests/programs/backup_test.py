# SPDX-License-Identifier: Apache-2.0
"""asipctl backup and restore. The day of an operator, from an empty system: a secured bus, a backup, another machine, the board with its label,
its link, its dashboard and a week of values (docs/run-as-services.md). And what an attacker may try, by a file or on the machine."""
import itertools
import math
import os
import pathlib
import pty
import pwd
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1] / "support")]
from bus import BIN, DESK, LAMP, die_with_parent, eventually  # noqa: E402
from kept_values import DAY, MINUTE, write_kept  # noqa: E402
from secured_bus import SecuredBus  # noqa: E402

PASSPHRASE = b"correct horse\n"
PARTS = ("etc", "state/asip", "conf.d")


def asipctl(*words, text=PASSPHRASE):
    return subprocess.run([str(BIN / "asipctl"), *map(str, words)], input=text, capture_output=True, timeout=120, check=False, preexec_fn=die_with_parent,
                          env={name: value for name, value in os.environ.items() if not name.startswith("ASIP_")})


def files_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()}


class Machine:
    """Its folders, and asipctl that takes them for those of the packages."""

    def __init__(self, work):
        self.work = work
        self.file = work / "bus.backup"
        self.make()

    def make(self):
        for part in PARTS:
            (self.work / part).mkdir(parents=True, mode=0o755)

    def options(self):
        return ("--etc", self.work / "etc", "--state", self.work / "state/asip", "--mosquitto", self.work / "conf.d")

    def backup(self, *more, text=PASSPHRASE):
        return asipctl("backup", self.file, "--passphrase-file", "-", *self.options(), *more, text=text)

    def restore(self, *more, text=PASSPHRASE):
        return asipctl("restore", self.file, "--passphrase-file", "-", "--yes", *self.options(), *more, text=text)

    def exchange(self):
        """For another one, on which nothing was done yet."""
        old = pathlib.Path(tempfile.mkdtemp(dir=self.work, prefix="old-"))
        for part in PARTS:
            (self.work / part).rename(old / part.replace("/", "-"))
        self.make()
        return old

    def write(self, name, text, mode=0o600):
        path = self.work / name
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        path.write_text(text)
        path.chmod(mode)
        return path

    def files(self):
        return {f"{part}/{name}": text for part in PARTS for name, text in files_of(self.work / part).items()}


class OperatorsBus(SecuredBus):
    """Its broker, registry and agents keep what they keep where a backup looks for it."""

    sources = (("lamp", "desk"),)

    def secure(self, *words):
        return subprocess.run([str(BIN / "asipctl"), "secure", "--dir", str(self.work / "etc/bus"), *words], check=True, capture_output=True,
                              text=True, timeout=60).stdout

    def credentials(self, name):
        return self.work / "etc/bus/credentials" / f"{name}.credentials"

    def start_all(self):
        self.work.chmod(0o755)  # the broker's user comes to its files
        self.machine = Machine(self.work)
        now = int(time.time() * 1000)
        write_kept(self.work / "state/asip/history.values.db", "desk", "distance/0", [(now - 7 * DAY, now - 2 * MINUTE)], lambda at: 40 + 20 * math.sin(at / DAY))
        self.secure("init", "--yes", "--host", "127.0.0.1", "--port", str(self.broker_port), "--mosquitto", str(self.work / "conf.d"))
        for role_and_names in self.users:
            self.secure("add", *role_and_names)
        for board_and_sources in self.sources:
            self.secure("link", *board_and_sources)
        super().start_all()

    def start_broker(self):
        config = self.machine.write("conf.d/asip-secured.conf", (self.work / "conf.d/asip-secured.conf").read_text().replace("user root\n", ""), 0o644)
        program = shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin")
        (self.work / "retained").mkdir(exist_ok=True)
        run = self.machine.write("run.conf", f"{config.read_text()}persistence_location {self.work}/retained/\n" + ("user root\n" if os.geteuid() == 0 else ""))
        self.start("broker", program, "-c", str(run))
        eventually(lambda: "running" in (self.work / "broker.log").read_text(), "the broker", 60)

    def start(self, name, program, *arguments):
        if name == "registry":
            arguments = ("--id", "first", "--history", str(self.work / "state/asip/history.db"))
        super().start(name, program, *arguments)

    def asks(self, *words):
        return asipctl(*words, "--credentials", self.credentials("admin"))


class OperatorsDay(unittest.TestCase):
    def setUp(self):
        self.began = time.time()
        self.bus = OperatorsBus((DESK, LAMP))
        self.addCleanup(self.bus.close)

    def ok(self, done):
        self.assertEqual(done.returncode, 0, done.stderr.decode() + self.bus.logs())
        return done.stdout.decode()

    def values(self):
        since, until = (time.strftime("%Y-%m-%dT%H:00:00.000Z", time.gmtime(self.began - hours * 3600)) for hours in (150, 2))
        return self.ok(self.bus.asks("values", "desk/distance/0", "--since", since, "--until", until, "--points", "50", "-o", "csv"))

    def shown(self):
        """What a user sees of it."""
        label = re.search(r"room=lab", self.ok(self.bus.asks("show", "desk")))
        link = "door" in self.ok(self.bus.asks("link", "list"))
        return bool(label), link, self.bus.get("/api/dashboards/lab")["title"]

    def test_EverythingIsBackOnAnotherMachine(self):
        bus, machine = self.bus, self.bus.machine
        self.ok(bus.asks("label", "desk", "room=lab"))
        self.ok(bus.asks("pin", "lamp", "13", "low"))
        link = ("link", "desk/distance/0", "lamp/io/13", "--below", "20", "--name", "door")
        eventually(lambda: bus.asks(*link).returncode == 0, "the link, of boards that were heard", 60)
        request = urllib.request.Request(bus.url + "/api/dashboards/lab", method="PUT", headers={"Content-Type": "application/json"},
                                                               data=b'{"title":"Lab","widgets":[{"kind":"value","board":"desk","property":"distance/0"}]}')
        urllib.request.urlopen(request, timeout=30).close()
        self.assertEqual(self.shown(), (True, True, "Lab"))
        week = self.values()
        self.assertGreater(len(week.splitlines()), 40)
        subprocess.run([str(BIN / "asip-gateway"), "token", "viewer", "hall", "--tokens", str(bus.work / "etc/tokens")], check=True, capture_output=True)
        secret = bus.user("admin")[1]

        self.assertIn("with keys and users", self.ok(asipctl("backup", machine.file, "--passphrase-file", "-", *machine.options(), "--credentials", bus.credentials("admin"))))
        kept = machine.file.read_bytes()
        self.assertEqual(machine.file.stat().st_mode & 0o777, 0o600)
        self.assertTrue(kept.startswith(b"asip-backup 1 sealed\n"))
        self.assertNotIn(secret.encode(), kept)

        refused = machine.restore("--overwrite")
        self.assertNotEqual(refused.returncode, 0, "while the registry has its files open")
        self.assertIn(b"is in use", refused.stderr)
        for name in list(bus.programs):
            if name != "sim":
                bus.end(name)
        before = machine.files()
        old = machine.exchange()
        shutil.rmtree(bus.work / "retained")
        # On the new machine a registry already ran.
        now = int(time.time() * 1000)
        write_kept(bus.work / "state/asip/history.values.db", "desk", "distance/0", [(now + MINUTE, now + 5 * MINUTE)], lambda _: 1)
        said = self.ok(machine.restore())
        self.assertRegex(said, r"differs +\S*history.values.db: the one here is replaced")
        self.assertIn("--dashboards", said, "there is no broker yet")
        after = machine.files()
        self.assertEqual({name for name in before if "history" not in name and "broker/" not in name}, {name for name in after if "history" not in name and "broker/" not in name})
        for name, text in after.items():
            if "history" not in name:
                self.assertEqual(text, before[name], name)
        for name in ("etc/bus/ca.key", "etc/bus/broker/broker.key", "etc/tokens"):
            new, was = (bus.work / name).stat(), (old / name).stat()
            self.assertEqual((new.st_mode, new.st_uid, new.st_gid), (was.st_mode, was.st_uid, was.st_gid), name)
        (bus.work / "broker.log").write_text("")
        bus.start_broker()
        self.ok(machine.restore("--dashboards"))
        bus.start("registry", "asip-registry")
        bus.start_gateway()
        for board in ("desk", "lamp"):
            bus.start_agent(board)
        eventually(lambda: all(bus.state(board) == "online" for board in ("desk", "lamp")), "all boards online", 60)
        eventually(lambda: self.shown() == (True, True, "Lab"), "all that was made", 60)
        self.assertEqual(self.values(), week)


class Folders(unittest.TestCase):
    """As a machine has them, with no program that runs."""

    def setUp(self):
        work = pathlib.Path(tempfile.mkdtemp(prefix="asip-backup-"))
        self.addCleanup(shutil.rmtree, work)
        work.chmod(0o755)
        self.machine = Machine(work)
        self.machine.write("etc/asip.conf", "broker = 127.0.0.1:1\n", 0o644)
        self.machine.write("etc/tokens", "viewer hall 00\n", 0o640)
        self.machine.write("state/asip/labels/desk.json", '{"name": "Desk"}\n')
        self.machine.write("state/asip/links/lamp/door.json", "{}\n")
        write_kept(work / "state/asip/history.values.db", "desk", "distance/0", [(DAY, 2 * DAY)], lambda at: at % 7)

    def made(self, *more, text=PASSPHRASE):
        done = self.machine.backup("--no-dashboards", *more, text=text)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def refused(self, done, why):
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(why, done.stderr.decode())


class Attacks(Folders):
    def test_DamagedFile_RestoresNothing(self):
        self.made()
        whole = self.machine.file.read_bytes()
        self.machine.exchange()
        damaged = [whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:] for at in (0, 12, 16, 25, 40, len(whole) // 2, len(whole) - 20, len(whole) - 1)]
        for text in [*damaged, whole[:-1], whole[:30], whole + b"x", b"", whole.replace(b"sealed", b"public")]:
            self.machine.file.write_bytes(text)
            self.assertNotEqual(self.machine.restore().returncode, 0)
            self.assertEqual(self.machine.files(), {})
        self.machine.file.write_bytes(whole.replace(b"p 1 ", b"p 2 "))
        self.refused(self.machine.restore(), "another version")
        self.machine.file.write_bytes(whole)
        self.assertEqual(self.machine.restore().returncode, 0)
        self.assertEqual(len(self.machine.files()), 5)

    def test_PassphraseCounts_WithEachOfItsBytes(self):
        self.made(text=b"a secret\0of mine\n")
        self.machine.exchange()
        for other in (b"a secret\0of yours\n", b"a secret\n", b"a secret\0of mine \n"):
            self.refused(self.machine.restore(text=other), "another passphrase")
        self.refused(self.machine.restore(text=b"\n"), "8 to 1024 bytes")
        self.assertEqual(self.machine.files(), {})
        self.assertEqual(self.machine.restore(text=b"a secret\0of mine\nand more").returncode, 0)

    def test_WithoutAPassphrase_SaysThatNothingProvesIt_AndHasNoSecrets(self):
        done = asipctl("backup", self.machine.file, "--no-secrets", "--no-dashboards", *self.machine.options())
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(b"nothing proves", done.stdout)
        self.machine.exchange()
        self.refused(self.machine.restore(), "nothing proves")
        words = ("restore", self.machine.file, *self.machine.options())
        asked = asipctl(*words)
        self.refused(asked, "no terminal")
        self.assertIn(b"labels/desk.json", asked.stdout)
        self.assertEqual(self.machine.files(), {})
        self.assertEqual(asipctl(*words, "--yes").returncode, 0)
        self.assertNotIn("etc/tokens", self.machine.files())
        self.assertIn("etc/asip.conf", self.machine.files())

    def test_MachineWithUsers_IsLeftAsItIs_UnlessItIsSaid(self):
        self.made()
        self.machine.write("etc/asip.conf", "broker = 127.0.0.1:2\n", 0o644)
        before = self.machine.files()
        refused = self.machine.restore()
        self.refused(refused, "has users")
        self.assertRegex(refused.stdout.decode(), r"differs +\S*/etc/asip.conf")
        self.assertEqual(self.machine.files(), before)
        self.assertEqual(self.machine.restore("--overwrite", "--dry-run").returncode, 0)
        self.assertEqual(self.machine.files(), before)
        self.assertEqual(self.machine.restore("--overwrite").returncode, 0)
        self.assertIn(b":1\n", self.machine.files()["etc/asip.conf"])

    def test_WhatIsNewerOrOfOthers_Stays(self):
        self.made()
        self.machine.write("state/asip/labels/desk.json", '{"name": "Newer"}\n')
        self.machine.write("state/asip/links/lamp/door.json", "{ }\n")
        os.utime(self.machine.work / "state/asip/links/lamp/door.json", (1000, 1000))
        for name in ("state/asip/labels/other.json", "state/asip/links/lamp/more.json", "etc/own.conf", "conf.d/own.conf", "state/asip/history.db-wal"):
            self.machine.write(name, "mine")
        said = self.machine.restore("--overwrite").stdout.decode()
        self.assertRegex(said, r"newer +\S*labels/desk.json: stays")
        files = self.machine.files()
        self.assertIn(b"Newer", files["state/asip/labels/desk.json"])
        self.assertEqual(files["state/asip/links/lamp/door.json"], b"{}\n")
        self.assertEqual(sum(text == b"mine" for text in files.values()), 5)

    def test_HistoryThatGoesOnHere_StaysUnlessItIsSaid(self):
        self.made()
        file = self.machine.work / "state/asip/history.values.db"
        file.unlink()
        later = int(time.time() * 1000) + DAY
        write_kept(file, "desk", "distance/0", [(later - 3 * DAY, later)], lambda _: 1)
        before = file.read_bytes()
        done = self.machine.restore("--overwrite", "--dry-run")
        self.assertRegex(done.stdout.decode(), r"differs +\S*history.values.db: the one here is replaced")
        (self.machine.work / "etc/tokens").unlink()
        done = self.machine.restore()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout.decode(), r"newer +\S*history.values.db: stays")
        self.assertEqual(file.read_bytes(), before)
        self.assertEqual(self.machine.restore("--overwrite").returncode, 0)
        self.assertNotEqual(file.read_bytes(), before)

    def test_PlantedPipes_HoldNothingUp(self):
        self.made()
        state = self.machine.work / "state/asip"
        for place in ("labels/desk.json.new", "labels/desk.json", "history.values.db", "history.values.db-journal", "history.values.db-wal"):
            with self.subTest(place=place):
                self.machine.exchange()
                (state / "labels").mkdir(mode=0o700)
                os.mkfifo(state / place, 0o600)
                done = self.machine.restore()
                self.assertEqual(done.returncode != 0, not place.endswith(".new"), done.stderr)
                if place != "labels/desk.json.new":
                    self.assertIn(b"no plain file", done.stderr)
        self.machine.exchange()
        write_kept(state / "history.values.db", "desk", "distance/0", [(DAY, 2 * DAY)], lambda at: at % 7)
        os.mkfifo(state / "history.values.db-journal", 0o600)
        self.refused(self.machine.backup("--no-dashboards"), "no plain file")

    def test_PlantedLinks_LeadNowhere(self):
        self.made()
        owner = pwd.getpwnam("nobody").pw_uid if os.geteuid() == 0 else os.geteuid()
        outside = self.machine.write("outside/file", "untouched")
        state = self.machine.work / "state/asip"
        for place, target in (("labels", outside.parent), ("labels/desk.json", outside), ("links/lamp", outside.parent), ("history.values.db", outside),
                              ("labels/desk.json.new", outside), ("history.values.db-journal", outside), ("history.values.db-wal", outside)):
            with self.subTest(place=place):
                self.machine.exchange()
                link = state / place
                link.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
                link.symlink_to(target)
                for path in (state, *state.rglob("*")):
                    os.lchown(path, owner, -1)
                self.machine.restore()
                self.assertEqual(files_of(outside.parent), {"file": b"untouched"})
                self.assertEqual(outside.stat().st_uid, os.geteuid())
                self.assertTrue(link.is_symlink() or place.endswith((".new", "-journal", "-wal")))

    def test_PlantedLinks_AreNotRead(self):
        self.machine.write("outside", "a secret of root")
        for name in ("labels/a.json", "labels/b.json"):
            (self.machine.work / "state/asip" / name).symlink_to(self.machine.work / "outside")
        os.link(self.machine.work / "outside", self.machine.work / "state/asip/labels/c.json")
        said = self.made().stderr.decode()
        self.assertEqual(said.count("is no plain file"), 2)
        self.assertEqual(said.count("has a second name"), 1)
        self.machine.exchange()
        self.assertEqual(self.machine.restore().returncode, 0)
        self.assertEqual(len(self.machine.files()), 5)

    def test_FileThatCannotBeMade_LeavesTheOldOne(self):
        self.made()
        before = self.machine.file.read_bytes()
        self.refused(self.machine.backup("--no-dashboards", text=b"short\n"), "8 to 1024 bytes")
        shutil.rmtree(self.machine.work / "state/asip")
        self.machine.write("state/asip/history.db", "no database")
        self.refused(self.machine.backup("--no-dashboards"), "not a database")
        self.assertEqual(self.machine.file.read_bytes(), before)
        self.assertEqual(list(self.machine.work.glob("bus.backup.*")), [])

    def test_LargeFile_IsLeftOutWithALine(self):
        self.machine.write("etc/large", "x" * (1 << 20) + "x", 0o644)
        self.machine.write("etc/less", "x" * (1 << 20), 0o644)
        self.assertRegex(self.made().stderr.decode(), r"left out: \S*/etc/large is above 1 MiB")
        before = self.machine.files()
        self.machine.exchange()
        self.assertEqual(self.machine.restore().returncode, 0)
        self.assertEqual(before.keys() - self.machine.files().keys(), {"etc/large"})

    def test_FilesThatComeAndGo_FailNothing(self):
        stop = threading.Event()

        def change():
            for number in itertools.count():
                if stop.is_set():
                    return
                shutil.rmtree(self.machine.work / f"etc/of-{number % 9}", ignore_errors=True)
                for each in range(20):
                    self.machine.write(f"etc/of-{number % 9}/{each}", "x", 0o644)

        changes = threading.Thread(target=change)
        changes.start()
        try:
            for _ in range(15):
                self.made()
        finally:
            stop.set()
            changes.join()

    def test_OpenFileInAClosedFolder_IsASecret(self):
        self.machine.write("etc/private/open", "mine", 0o644)
        done = asipctl("backup", self.machine.file, "--no-secrets", "--no-dashboards", *self.machine.options())
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(b"left out: 2 files with keys and users", done.stderr)
        self.assertNotIn(b"private/open", self.machine.file.read_bytes())


class Terminal:
    """asipctl, with a person before it."""

    def __init__(self, *words):
        self.shown = b""
        self.process, self.end = pty.fork()
        if self.process == 0:
            os.execv(BIN / "asipctl", ["asipctl", *map(str, words)])

    def read(self):
        try:
            part = os.read(self.end, 4096)
        except OSError:  # it has ended
            part = b""
        self.shown += part
        return part

    def answers(self, question, text):
        while question not in self.shown:
            assert self.read(), self.shown
        os.write(self.end, text)

    def status(self):
        while self.read():
            pass
        os.close(self.end)
        return os.waitstatus_to_exitcode(os.waitpid(self.process, 0)[1])


class ByHand(Folders):
    def test_TypedPassphrase_IsNotShownAndOpensTheBackup(self):
        typed = (b"Passphrase: ", PASSPHRASE), (b"The same again: ", PASSPHRASE)
        backup = Terminal("backup", self.machine.file, "--no-dashboards", *self.machine.options())
        for question, text in typed:
            backup.answers(question, text)
        self.assertEqual(backup.status(), 0, backup.shown)
        before = self.machine.files()
        self.machine.exchange()
        for answer, files in ((b"n\n", {}), (b"y\n", before)):
            restore = Terminal("restore", self.machine.file, *self.machine.options())
            restore.answers(*typed[0])
            restore.answers(b"Continue? [y/N]", answer)
            self.assertEqual(restore.status(), 0, restore.shown)
            self.assertNotIn(PASSPHRASE.strip(), backup.shown + restore.shown)
            self.assertEqual(self.machine.files().keys(), set(files))

    def test_TwoPassphrases_OrCtrlC_MakeNothing(self):
        for first, second in ((b"correct horse\n", b"correct house\n"), (b"correct\x03", None)):
            backup = Terminal("backup", self.machine.file, "--no-dashboards", *self.machine.options())
            backup.answers(b"Passphrase: ", first)
            if second:
                backup.answers(b"The same again: ", second)
            self.assertNotEqual(backup.status(), 0, backup.shown)
            self.assertFalse(self.machine.file.exists())

    def test_ServicesAndAgents_AreStoppedWhileItWrites(self):
        """In folders of a machine of its own. A test has no systemd: one that only says what it was asked shows that the right units are asked."""
        root = ("unshare", "--map-root-user", "--mount")
        if subprocess.run([*root, "true"], check=False).returncode != 0:
            self.skipTest("this system lets nobody make a namespace")
        self.made()
        work = self.machine.work
        label = "/var/lib/asip/labels/desk.json"
        systemctl = self.machine.write("bin/systemctl", f"""#!/bin/sh
            case $1 in list-units) printf '%s\\n' 'asip-registry.service loaded active running' 'asip-agent@usb-1.service loaded activating auto-restart';;
            *) echo "$*" $(ls {label} 2>/dev/null) >> {work}/asked;; esac\n""", 0o755)
        (work / "machine/etc").mkdir(parents=True)
        done = subprocess.run([*root, "sh", "-ec", f"""
            mount -t tmpfs run /run; mkdir -p /run/systemd/system
            mount -t tmpfs lib /var/lib; mkdir -m 750 /var/lib/asip
            mount --rbind /etc {work}/machine/etc; mount -t tmpfs etc /etc
            ln -s {work}/machine/etc/* /etc/; rm -f /etc/asip /etc/mosquitto; mkdir -p /etc/asip /etc/mosquitto/conf.d
            HOME={work} PATH={systemctl.parent}:$PATH {BIN}/asipctl restore {self.machine.file} --passphrase-file - --yes
            test -e {label}"""], input=PASSPHRASE, capture_output=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        units = "asip-registry.service asip-agent@usb-1.service"
        self.assertEqual((work / "asked").read_text().splitlines(), [f"stop {units}", f"start {units} {label}"])


if __name__ == "__main__":
    unittest.main()
