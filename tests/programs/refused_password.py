# SPDX-License-Identifier: Apache-2.0
"""A password with a blank at its end, with a line end, or in Latin-1 is refused by a real Mosquitto: each program, and the Python package,
says what is odd about it, and shows no part of it."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "support"), str(HERE.parents[1] / "python")]
from bus import BIN, can_connect, die_with_parent, eventually, free_port, settings_file  # noqa: E402

from scripted_board import ScriptedBoard  # noqa: E402

import asip  # noqa: E402

PASSWORD = "gr\u00fcner-tee"
ENDS, LINE_END, LATIN = "the password ends with a blank", "the password has a line end", "the password is no UTF-8: was it written as Latin-1?"
ODD = ((f"{PASSWORD} ".encode(), ENDS), (f"{PASSWORD}\n".encode(), LINE_END), (PASSWORD.encode("latin-1"), LATIN))


class RefusedPassword(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = pathlib.Path(tempfile.mkdtemp(prefix="asip-password-"))
        cls.addClassCleanup(shutil.rmtree, cls.work)
        cls.port = free_port()
        passwords, config = cls.work / "passwords", cls.work / "mosquitto.conf"
        subprocess.run(["mosquitto_passwd", "-b", "-c", passwords, "ann", PASSWORD], check=True, capture_output=True)
        config.write_text(f"listener {cls.port} 127.0.0.1\npassword_file {passwords}\n" + ("user root\n" if os.geteuid() == 0 else ""))
        broker = subprocess.Popen([shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin"), "-c", config], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=die_with_parent)
        cls.addClassCleanup(lambda: (broker.kill(), broker.wait()))
        eventually(lambda: can_connect(cls.port), "the broker")

    def environment(self, **more):
        return {**{name: value for name, value in os.environ.items() if not name.startswith("ASIP_")}, "XDG_STATE_HOME": str(self.work),
                "XDG_CONFIG_HOME": str(self.work), "ASIP_BROKER": f"127.0.0.1:{self.port}", "ASIP_USER": "ann", **more}

    def ways(self, password):
        """In the environment, and where one line can have it in a file."""
        yield {"ASIP_PASSWORD": password}
        if b"\n" not in password:
            file = self.work / "password"
            file.write_bytes(password + b"\nnot this\n")
            yield {"ASIP_PASSWORD_FILE": str(file)}

    def test_each_program_says_what_is_odd(self):
        http = settings_file(f"http = 127.0.0.1:{free_port()}\n")
        for program, *words in (("asipctl", "list"), ("asip-registry", "--id", "first"), ("asip-gateway", "--config", http),
                                ("asip-agent", "--tcp", f"127.0.0.1:{ScriptedBoard().port}", "--name", "desk"), ("asip-load", "--boards", "1")):
            for password, hint in ODD:
                for way in self.ways(password):
                    with self.subTest(program=program, hint=hint, way=list(way)):
                        ended = subprocess.run([BIN / program, *words], env=self.environment(**way), stdin=subprocess.DEVNULL, capture_output=True, timeout=30)
                        self.assertEqual(ended.returncode, 3, ended.stderr)
                        self.assertIn(f'user "ann" ({hint})', ended.stderr.decode().replace("\\", ""))
                        self.assertNotIn(b"-tee", ended.stdout + ended.stderr)

    def test_the_python_package_does(self):
        for password, hint in ODD:
            for way in (*self.ways(password), None):
                with self.subTest(hint=hint, way=way), self.assertRaises(asip.Disconnected) as raised:
                    environment = self.environment(**{name: os.fsdecode(value) for name, value in (way or {}).items()})
                    self.connect(environment, **({} if way else {"password": os.fsdecode(password)}))
                self.assertIn(f"({hint})", str(raised.exception))
                self.assertNotIn("-tee", str(raised.exception))

    def test_the_right_one_is_taken(self):
        for way in self.ways(PASSWORD.encode()):
            self.connect(self.environment(**{name: os.fsdecode(value) for name, value in way.items()})).close()

    def connect(self, environment, **more):
        before = dict(os.environ)
        os.environ.clear()
        os.environ.update(environment)
        try:
            return asip.connect(timeout=1.5, **more)
        finally:
            os.environ.clear()
            os.environ.update(before)


if __name__ == "__main__":
    unittest.main()
