# SPDX-License-Identifier: Apache-2.0
"""The nodes of node-red/ in a real Node-RED, with a real bus and simulated boards."""

import json
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

from bus import BUILD, ROOT, Bus, eventually, free_port

sys.path.insert(0, str(ROOT / "tests" / "browser"))
from rig import Browser  # noqa: E402

NODE_RED = BUILD / "node-red" / "node_modules" / "node-red" / "red.js"
SETTINGS = """module.exports = {{ uiPort: {port}, uiHost: "127.0.0.1", httpAdminRoot: "/admin", flowFile: "flow.json", credentialSecret: false,
    telemetry: {{ enabled: false }}, logging: {{ console: {{ level: "info" }} }} }};"""


def flow(broker_port):
    def node(id, type, wires=(), **more):
        return {"id": id, "type": type, "z": "tab", "x": 1, "y": 1, "wires": [[one] if isinstance(one, str) else list(one) for one in wires], **more}

    def debug(name):
        return node(name, "debug", active=True, console=True, complete="true", tosidebar=False, name=name)
    return [
        {"id": "tab", "type": "tab", "label": "asip"},
        {"id": "bus", "type": "asip-bus", "broker": f"127.0.0.1:{broker_port}", "root": "asip"},
        node("button", "asip-pin-in", ["lamp"], bus="bus", board="desk", pin="2", mode="input-pullup", invert=True, initial=True),
        node("lamp", "asip-pin-out", ["", "", ""], bus="bus", board="lamp", pin="13", mode="output", restore=True),
        node("value", "asip-value", ["saw-value"], bus="bus", board="desk", service="distance", hz=10, initial=True),
        debug("saw-value"),
        node("silent", "asip-value", ["saw-first"], bus="bus", board="desk", service="distance", element="0", hz=1, initial=True),
        node("good", "inject", ["turn"], payload="[0,90]", payloadType="json", props=[{"p": "payload"}], repeat="", once=False),
        node("bad", "inject", ["turn"], payload="[9,90]", payloadType="json", props=[{"p": "payload"}], repeat="", once=False),
        node("turn", "asip-command", ["saw-executed", "saw-failed", "saw-unknown"], bus="bus", board="desk", service="servo", command="write", timeout=5),
        node("report", "inject", ["reporting"], payload="100", payloadType="num", props=[{"p": "payload"}], repeat="", once=False),
        node("reporting", "asip-command", ["", "", ""], bus="bus", board="desk", service="distance", command="report", timeout=5),
        node("seen", "asip-property-in", ["saw-property"], bus="bus", board="desk", property="servo/1/angle", initial=True),
        node("set", "inject", ["angle"], payload="30", payloadType="num", props=[{"p": "payload"}], repeat="", once=False),
        node("angle", "asip-property-out", ["", "", ""], bus="bus", board="desk", property="servo/1/angle", timeout=5),
        node("watch", "asip-boards", ["saw-board"], bus="bus", pattern="la*"),
        node("catch", "catch", ["saw-caught"], scope=None, uncaught=False),
        *(debug(name) for name in ("saw-executed", "saw-failed", "saw-unknown", "saw-board", "saw-caught", "saw-first", "saw-property")),
    ]


def install(folder, *options):
    """What docs/node-red.md says, in an empty folder of Node-RED, with the folder of this clone."""
    line = re.search(r"```\n(npm install /path/to/the/clone/node-red)\n```", (ROOT / "docs" / "node-red.md").read_text())[1]
    folder.mkdir(exist_ok=True)
    subprocess.run([*line.replace("/path/to/the/clone", str(ROOT)).split(), *options], cwd=folder, check=True, timeout=300)


class Installed(unittest.TestCase):
    """Linked, as npm does without more ado, is what Nodes begins with."""

    def test_copied_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            home = pathlib.Path(folder)
            install(home, "--install-links")
            self.assertFalse((home / "node_modules" / "@asip-bus" / "node-red-asip").is_symlink())
            done = subprocess.run(["node", "-e", "const path = '@asip-bus/node-red-asip/lib/'; const { Models } = require(path + 'models'); const { Bus } = require(path + 'bus');"
                                   "new Bus({}); console.log(new Models().of({ model: 'servo@1' }).name)"], cwd=home, capture_output=True, text=True, timeout=60)
            self.assertEqual((done.stdout, done.stderr), ("servo\n", ""))


class Nodes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bus = Bus()
        cls.addClassCleanup(cls.bus.close)
        install(cls.bus.work)
        (cls.bus.work / "flow.json").write_text(json.dumps(flow(cls.bus.broker_port)))
        cls.port = free_port()
        (cls.bus.work / "settings.js").write_text(SETTINGS.format(port=cls.port))
        cls.bus.start("node-red", "/usr/bin/env", "node", str(NODE_RED), "--userDir", str(cls.bus.work), "--settings", str(cls.bus.work / "settings.js"))
        eventually(lambda: "Started flows" in cls.log(), "Node-RED's start", 120)
        eventually(lambda: "[asip-bus:bus] connected" in cls.log(), "the connection to the bus", 60)

    def setUp(self):
        self.addCleanup(lambda: self._outcome.success or print(self.bus.logs()))

    @classmethod
    def log(cls):
        return (cls.bus.work / "node-red.log").read_text(errors="replace")

    def admin(self, path, data=None):
        with urllib.request.urlopen(urllib.request.Request(f"http://127.0.0.1:{self.port}/admin{path}", data=data, method="POST" if data is not None else "GET"), timeout=30) as answer:
            return answer.read().decode()

    def shown(self, name):
        return re.findall(rf"\[debug:{name}\].*?\n(\{{.*?\n\}})", self.log(), re.DOTALL)

    def test_button_of_one_board_lights_the_lamp_of_the_other(self):
        self.bus.sim("press", "desk/button")
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "the lamp")
        self.bus.sim("release", "desk/button")
        eventually(lambda: self.bus.part("lamp/lamp") == "off", "the lamp out")

    def test_command_is_executed_or_refused_in_the_boards_words(self):
        self.admin("/inject/good", b"")
        eventually(lambda: self.shown("saw-executed"), "the message of the first output")
        self.assertIn(self.bus.part("desk/servo"), ("89", "90", "91"))
        self.admin("/inject/bad", b"")
        eventually(lambda: self.shown("saw-failed"), "the message of the second output")
        self.assertIn("code: 7", self.shown("saw-failed")[-1])
        eventually(lambda: self.shown("saw-caught"), "the message of the Catch node")
        self.assertEqual(self.shown("saw-unknown"), [])

    def test_first_the_present_value_of_a_board_that_reports_nothing(self):
        eventually(lambda: self.shown("saw-first"), "the present value")
        self.assertIn("payload: 42", self.shown("saw-first")[0])

    def test_property_that_is_set_is_told(self):
        self.admin("/inject/set", b"")
        eventually(lambda: self.shown("saw-property"), "the value of the property")
        self.assertIn("payload: 30", self.shown("saw-property")[-1])
        self.assertIn("text: '30 degrees'", self.shown("saw-property")[-1])
        listed = json.loads(self.admin("/asip/bus/properties?board=lamp"))
        self.assertIn("servo/0/angle", [one["id"] for one in json.loads(self.admin("/asip/bus/properties?board=desk"))])
        self.assertIn("io/13", [one["id"] for one in listed])

    def test_form_of_a_command_is_made_of_its_model(self):
        browser = Browser()
        self.addCleanup(browser.close)
        browser.driver.get(f"http://127.0.0.1:{self.port}/admin/")
        eventually(lambda: browser.run("return Boolean(window.RED?.nodes?.node?.('turn'))"), "the editor", 60)
        browser.run("RED.editor.edit(RED.nodes.node('turn'))")
        eventually(lambda: "write" in browser.run("return [...document.querySelectorAll('#asip-commands option')].map((one) => one.value)"), "the commands")
        self.assertFalse(browser.run("return $('#asip-form').is(':visible')"), "its arguments come with the message")
        browser.run("$('#asip-args-from').val('form').trigger('change')")
        self.assertEqual(browser.run("return $('#asip-form label').get().map((one) => one.textContent)"), ["servo", "angle"])
        self.assertEqual(browser.run("const at = document.querySelector('#asip-arg-1'); return [at.type, at.min, at.max, at.title]"),
                         ["number", "0", "180", "integer 0 to 180 degrees"])
        browser.run("$('#asip-arg-0').val('0'); $('#asip-arg-1').val('45')")
        browser.screenshot("node-red-command")
        browser.run("document.querySelector('#node-dialog-ok').click()")
        eventually(lambda: browser.run("return RED.nodes.node('turn').args") == "[0,45]", "the arguments in the node")
        eventually(lambda: not browser.run("return Boolean(document.querySelector('#node-input-bus'))"), "the end of the dialog")
        browser.run("RED.editor.edit(RED.nodes.node('turn'))")
        eventually(lambda: browser.run("return $('#asip-arg-1').val()") == "45", "the form again, with its values")

    def test_value_with_its_unit(self):
        self.admin("/inject/report", b"")
        eventually(lambda: self.shown("saw-value"), "a value")
        self.assertRegex(self.shown("saw-value")[-1], r"payload: \[ 42, 0 \]")
        self.assertIn("unit: 'cm'", self.shown("saw-value")[-1])

    def test_board_that_is_lost_and_returns(self):
        eventually(lambda: any("payload: 'joined'" in one for one in self.shown("saw-board")), "the board")
        self.bus.end("agent-lamp", signal.SIGKILL)
        eventually(lambda: any("payload: 'lost'" in one and "agent-gone" in one for one in self.shown("saw-board")), "the loss")
        self.bus.sim("press", "desk/button")
        self.bus.start_agent("lamp")
        eventually(lambda: any("payload: 'returned'" in one for one in self.shown("saw-board")), "the return", 60)
        self.bus.sim("release", "desk/button")
        self.bus.sim("press", "desk/button")
        eventually(lambda: self.bus.part("lamp/lamp") == "on", "the lamp after the return")
        self.bus.sim("release", "desk/button")

    def test_editor_offers_the_boards_and_services_of_the_bus(self):
        browser = Browser()
        self.addCleanup(browser.close)
        browser.driver.get(f"http://127.0.0.1:{self.port}/admin/")
        eventually(lambda: browser.run("return Boolean(window.RED?.nodes?.node?.('value'))"), "the editor", 60)
        self.assertEqual(browser.run("return ['value','command','pin-in','pin-out','property-in','property-out','boards'].filter((one) => !RED.nodes.getType('asip-' + one))"), [])
        for dialog in ("value", "turn", "button", "lamp", "watch"):
            browser.run("RED.editor.edit(RED.nodes.node(arguments[0]))", dialog)
            eventually(lambda: browser.run("return Boolean(document.querySelector('#node-input-bus'))"), f"the dialog of {dialog}")
            if dialog == "value":
                offered = "return [...document.querySelectorAll('#%s option')].map((one) => one.value)"
                eventually(lambda: sorted(browser.run(offered % "asip-boards")) == ["desk", "lamp"], "the boards")
                eventually(lambda: "servo" in browser.run(offered % "asip-services"), "the services")
                browser.screenshot("node-red-value")
            browser.run("document.querySelector('#node-dialog-cancel').click()")
            eventually(lambda: not browser.run("return Boolean(document.querySelector('#node-input-bus'))"), "the end of the dialog")

    def test_lists_of_the_editor(self):
        boards = json.loads(self.admin("/asip/bus/boards"))
        self.assertEqual(sorted(one["name"] for one in boards), ["desk", "lamp"])
        self.assertIn("servo", [one["name"] for one in json.loads(self.admin("/asip/bus/services?board=desk"))])
        commands = json.loads(self.admin("/asip/bus/commands?board=desk&service=servo"))
        self.assertEqual([one["args"][1]["unit"] for one in commands if one["name"] == "write"], ["degrees"])
        self.assertEqual(json.loads(self.admin("/asip/bus/commands?board=desk&service=nothing")), [])
        self.assertEqual(json.loads(self.admin("/asip/bus/services?board=nowhere")), [])
        with self.assertRaises(urllib.error.HTTPError) as raised:
            self.admin("/asip/nowhere/boards")
        self.assertEqual(raised.exception.code, 503)


if __name__ == "__main__":
    unittest.main()
