# SPDX-License-Identifier: Apache-2.0
"""The real Home Assistant as a child process, on a free port of 127.0.0.1, asked by its own interfaces.
ASIP_HOME_ASSISTANT is the root folder that `install` made, such as build/dev/home-assistant/debian-13."""

import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import urllib.error
import urllib.parse
import urllib.request

import websocket

from bus import die_with_parent, eventually, free_port

HERE = pathlib.Path(__file__).resolve().parent
ROOT = pathlib.Path(os.environ["ASIP_HOME_ASSISTANT"])

CONFIGURATION = """
homeassistant:
  name: Test
  time_zone: UTC
  unit_system: metric
  latitude: 52
  longitude: 4
  elevation: 0
http:
  server_host: 127.0.0.1
  server_port: {port}
frontend:
logger:
  default: warning
"""


class HomeAssistant:
    def __init__(self, broker_port, user=None, password=None, authority=None, for_people=False):
        """authority: the broker's certificate authority, as PEM; with it Home Assistant uses TLS. for_people: its pages are
        looked at, so the questions of its first start are answered, and it keeps what they draw."""
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="config-", dir=ROOT / "tmp"))
        self.port = free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.token = None
        self.process = None
        (self.folder / "configuration.yaml").write_text(CONFIGURATION.format(port=self.port) +
                                                          ("recorder:\nhistory:\n" if for_people else ""))
        try:
            self.start()
            self.enter(for_people)
            self.add_broker(broker_port, user, password, authority)
        except BaseException:
            self.close()
            raise

    def start(self):
        with open(self.folder / "output.log", "ab") as log:
            self.process = subprocess.Popen(
                [str(HERE / "inside"), str(ROOT), "/opt/home-assistant/bin/python", "-m", "homeassistant", "--config",
                 "/" + str(self.folder.relative_to(ROOT)), "--skip-pip", "--log-no-color"],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, preexec_fn=die_with_parent)
        eventually(lambda: self.request("/api/onboarding", token=False) is not None, "Home Assistant's port", 180)
        if self.token:
            self.runs()
        assert "Activating recovery mode" not in self.log()

    def stop(self):
        if self.process is None:
            return
        # The program inside, not the one that holds its folders.
        pid = self.process.pid
        for child in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
            os.kill(int(child), signal.SIGTERM)
        try:
            self.process.wait(60)
        except subprocess.TimeoutExpired:
            self.process.send_signal(signal.SIGKILL)
            self.process.wait()
        self.process = None

    def restart(self):
        self.stop()
        self.start()

    def enter(self, for_people):
        """A user, and a token."""
        client = self.url + "/"
        code = self.request("/api/onboarding/users", {"client_id": client, "name": "a", "username": "a", "password": "secret-a",
                                                      "language": "en"}, token=False)["auth_code"]
        form = urllib.parse.urlencode({"grant_type": "authorization_code", "code": code, "client_id": client}).encode()
        with urllib.request.urlopen(self.url + "/auth/token", form, timeout=30) as answer:
            self.token = json.load(answer)["access_token"]
        if for_people:
            for step, body in (("core_config", {}), ("analytics", {}), ("integration", {"client_id": client, "redirect_uri": client})):
                self.request("/api/onboarding/" + step, body)
        self.token = self.ask(type="auth/long_lived_access_token", client_name="test", lifespan=1)
        self.runs()

    def runs(self):
        eventually(lambda: self.request("/api/config")["state"] == "RUNNING", "Home Assistant's start", 120)
        # Since 2026.8 settings of HTTP that stand in a file are undone five minutes later, by a restart, unless a person confirms them.
        with contextlib.suppress(AssertionError):
            self.ask(type="http/config/promote")

    def add_broker(self, port, user, password, authority):
        """As a person does: form by form, each with what it asks for."""
        known = {"broker": "127.0.0.1", "port": port, "set_client_cert": False, "set_ca_cert": "off", "transport": "tcp"}
        if authority:
            known |= {"username": user, "password": password, "advanced_options": True, "set_ca_cert": "custom"}

        def answers(fields):
            given = {}
            for field in fields:
                name = field["name"]
                if field.get("type") == "expandable":
                    given[name] = answers(field["schema"])
                elif name == "certificate" and authority:
                    given[name] = self.upload("ca.crt", authority)
                elif name in known:
                    given[name] = known[name]
            return given

        step = self.request("/api/config/config_entries/flow", {"handler": "mqtt", "show_advanced_options": bool(authority)})
        for _ in range(5):
            if step["type"] != "form":
                break
            assert not step.get("errors"), step
            step = self.request(f"/api/config/config_entries/flow/{step['flow_id']}", answers(step["data_schema"]))
        assert step["type"] == "create_entry", step

    def upload(self, name, text):
        """The id of a file that a form then names."""
        edge = "edge-of-the-file"
        body = (f'--{edge}\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n'
                f"Content-Type: application/x-x509-ca-cert\r\n\r\n{text}\r\n--{edge}--\r\n").encode()
        request = urllib.request.Request(self.url + "/api/file_upload", body, {
            "Authorization": f"Bearer {self.token}", "Content-Type": f"multipart/form-data; boundary={edge}"})
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)["file_id"]

    def request(self, path, body=None, token=True):
        headers = {"Content-Type": "application/json"}
        if token:
            headers["Authorization"] = f"Bearer {self.token}"
        data = None if body is None else json.dumps(body).encode()
        with urllib.request.urlopen(urllib.request.Request(self.url + path, data, headers), timeout=30) as answer:
            text = answer.read()
            return json.loads(text) if text else {}

    def ask(self, **command):
        """One command of its WebSocket interface."""
        connection = websocket.create_connection(f"ws://127.0.0.1:{self.port}/api/websocket", timeout=30)
        try:
            assert json.loads(connection.recv())["type"] == "auth_required"
            connection.send(json.dumps({"type": "auth", "access_token": self.token}))
            assert json.loads(connection.recv())["type"] == "auth_ok"
            connection.send(json.dumps({"id": 1, **command}))
            answer = json.loads(connection.recv())
            assert answer["success"], answer
            return answer["result"]
        finally:
            connection.close()

    def state(self, entity):
        """None: there is no such entity."""
        try:
            return self.request(f"/api/states/{entity}")
        except urllib.error.HTTPError as fault:
            if fault.code != 404:
                raise
            return None

    def value(self, entity):
        state = self.state(entity)
        return state and state["state"]

    def call(self, service, entity, **data):
        return self.request("/api/services/" + service.replace(".", "/"), {"entity_id": entity, **data})

    def entities(self):
        """Of MQTT, by id, as its registry has them."""
        return {each["entity_id"]: each for each in self.ask(type="config/entity_registry/list") if each["platform"] == "mqtt"}

    def devices(self):
        return {each["name"] for each in self.ask(type="config/device_registry/list") if each["manufacturer"] == "ASIP"}

    def log(self):
        return (self.folder / "output.log").read_text(errors="replace")

    def complaints(self):
        """Lines of its MQTT integration that are warnings or errors."""
        return [line for line in self.log().splitlines()
                if "homeassistant.components.mqtt" in line and (" WARNING " in line or " ERROR " in line)
                # It says so of its own clean-up, once for each component of a device that is removed.
                and "No device components to cleanup" not in line]

    def close(self):
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)
