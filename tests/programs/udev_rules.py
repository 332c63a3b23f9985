#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The udev rule: which ports get an agent, and how each is called.

    udev_rules.py FILE             reads the rules as udev does, of what `udevadm info` says of real boards and clones
    udev_rules.py FILE UDEVADM     asks this udevadm (252 or newer) instead; as root
"""
import fnmatch
import os
import re
import subprocess
import sys
import tempfile
import unittest

# Properties that usb_id, path_id and 60-serial.rules give to a port.
PI = "platform-fd500000.pcie-pci-0000:01:00.0-usb-0:1.{}:1.0"
PC = "pci-0000:00:14.0-usb-0:{}:1.0"


def port(vendor, model, serial, path, text, converter=True, interface="00"):
    properties = {"ID_BUS": "usb", "ID_VENDOR_ID": vendor, "ID_MODEL_ID": model, "ID_SERIAL": text + (f"_{serial}" if serial else ""),
                  "ID_PATH": path, "ID_USB_INTERFACE_NUM": interface}
    if serial:
        properties["ID_SERIAL_SHORT"] = serial
    if converter:
        properties[".ID_PORT"] = "0"
    return properties


UNO = port("2341", "0043", "7583030313135161E0A1", PC.format(3), "Arduino__www.arduino.cc__0043", converter=False)
OLD_MEGA = port("2a03", "0042", "95433343934351F01132", PI.format(2), "Arduino_Srl_Arduino_Mega_95433343934351F01132", converter=False)
CH340 = port("1a86", "7523", "", PC.format(3), "1a86_USB_Serial")
OTHER_CH340 = port("1a86", "7523", "", PC.format(4), "1a86_USB_Serial")
CH9102 = port("1a86", "55d4", "5637012345", PI.format(1), "1a86_USB_Single_Serial", converter=False)
CP2102 = port("10c4", "ea60", "0001", PI.format(3), "Silicon_Labs_CP2102_USB_to_UART_Bridge_Controller")
FTDI = port("0403", "6001", "A50285BI", PC.format("2.1"), "FTDI_FT232R_USB_UART")
TRINKET = port("239a", "801e", "7AEC5C4E50504C4B2E3120FF", PC.format(1), "Adafruit_Trinket_M0", converter=False)
PICO = port("2e8a", "000a", "E6609103C3463A2A", PC.format(1), "Raspberry_Pi_Pico", converter=False)
MODEM = port("12d1", "1506", "", PC.format(1), "HUAWEI_HUAWEI_Mobile")


def evaluate(rules, properties, action="add"):
    """What udev makes of a tty's properties by these rules: the properties afterwards, and SYSTEMD_WANTS as a list."""
    env, wants, skip = dict(properties), [], None
    for line in rules:
        parts = re.findall(r'([A-Z_]+(?:\{[^}]*\})?)(==|!=|\+=|=)"([^"]*)"', line)
        assert ",".join(re.split(r',\s*', line.strip())) == ",".join(f'{k}{o}"{v}"' for k, o, v in parts), f"not a rule: {line}"
        if skip:
            if ("LABEL", "=", skip) in parts:
                skip = None
            continue
        for key, op, value in parts:
            name = key[4:-1] if key.startswith("ENV{") else ""
            known = {"ACTION": action, "SUBSYSTEM": "tty"}.get(key, env.get(name, ""))
            if op in ("==", "!="):
                if any(fnmatch.fnmatchcase(known, each) for each in value.split("|")) != (op == "=="):
                    break
                continue
            text = re.sub(r"\$env\{([^}]*)\}", lambda match: env.get(match[1], ""), value)
            if key == "GOTO":
                skip = value
            elif name == "SYSTEMD_WANTS":
                wants.append(text)
            elif name:
                env[name] = text
    assert not skip, f"no label {skip}"
    return env, wants


def ask_udevadm(udevadm, file, properties, action="add"):
    """The same of the real one, in a file system of its own, for a terminal that is always there."""
    terminal = "tty9"
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/69-fixture.rules", "w", encoding="ascii") as fixture:
            fixture.write(f'KERNEL=="{terminal}"' + "".join(f', ENV{{{k}}}="{v}"' for k, v in properties.items()) + "\n")
        script = (f"for at in /usr/lib/udev/rules.d /run; do mount -t tmpfs t $at; done; cp {folder}/69-fixture.rules {file} /usr/lib/udev/rules.d; "
                  f"exec {udevadm} test --action={action} /sys/class/tty/{terminal} 2>&1")
        said = subprocess.run(["unshare", "-m", "sh", "-c", script], capture_output=True, text=True, check=True).stdout
    assert not re.search(r"70-asip\.rules:\d+ .*([Ii]nvalid|[Uu]nknown)", said), said
    env = dict(re.findall(r"^([A-Z_.]+)=(.*)$", said, re.M))
    return env, env.get("SYSTEMD_WANTS", "").split()


class Rules(unittest.TestCase):
    def of(self, properties, action="add"):
        if UDEVADM:
            return ask_udevadm(UDEVADM, FILE, properties, action)
        return evaluate(RULES, properties, action)

    def units(self, properties):
        return self.of(properties)[1]

    def test_board_with_a_serial_number_is_called_by_it_on_whichever_port(self):
        self.assertEqual(self.units(UNO), ["asip-agent@usb-Arduino__www.arduino.cc__0043_7583030313135161E0A1-if00.service"])
        self.assertEqual(self.units(UNO), self.units({**UNO, "ID_PATH": PI.format(4)}))
        self.assertEqual(self.units(FTDI), ["asip-agent@usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0.service"])
        for board in (OLD_MEGA, CH9102, TRINKET, PICO):
            self.assertEqual(len(self.units(board)), 1, board)

    def test_clones_without_a_serial_number_are_called_by_their_usb_port(self):
        self.assertEqual(self.units(CH340), ["asip-agent@pci-0000:00:14.0-usb-0:3:1.0-port0.service"])
        self.assertEqual(self.units(OTHER_CH340), ["asip-agent@pci-0000:00:14.0-usb-0:4:1.0-port0.service"])

    def test_clones_that_all_have_one_serial_number_are_called_by_their_usb_port(self):
        self.assertEqual(self.units(CP2102), ["asip-agent@platform-fd500000.pcie-pci-0000:01:00.0-usb-0:1.3:1.0-port0.service"])

    def test_port_keeps_its_name_when_it_changes_and_when_it_is_plugged_in_again(self):
        for board in (UNO, CH340, CP2102):
            self.assertEqual(self.of(board, "change")[1], self.units(board))
            self.assertEqual(self.of(board, "remove")[1], [])

    def test_names_are_those_of_units(self):
        for board in (UNO, OLD_MEGA, CH340, CH9102, CP2102, FTDI, TRINKET, PICO):
            self.assertRegex(self.units(board)[0], r"^asip-agent@[A-Za-z0-9:._-]+\.service$")

    def test_modem_manager_keeps_off_boards_and_other_devices_are_left_alone(self):
        self.assertEqual(self.of(CH340)[0].get("ID_MM_DEVICE_IGNORE"), "1")
        env, units = self.of(MODEM)
        self.assertEqual((units, env.get("ID_MM_DEVICE_IGNORE")), ([], None))
        self.assertEqual(self.units({"ID_VENDOR_ID": "2341"}), [])

    def test_rule_of_the_administrator_decides(self):
        self.assertEqual(self.of({**FTDI, "ASIP_START": "0"})[1], [])
        self.assertEqual(self.of({**FTDI, "ASIP_START": "0"})[0].get("ID_MM_DEVICE_IGNORE"), "1")
        self.assertEqual(len(self.units({**MODEM, "ASIP_START": "1"})), 1)


if __name__ == "__main__":
    FILE = os.path.abspath(sys.argv[1])
    UDEVADM = sys.argv[2] if len(sys.argv) > 2 else None
    with open(FILE, encoding="utf-8") as opened:
        RULES = [line for line in opened if line.strip() and not line.startswith("#")]
    unittest.main(argv=sys.argv[:1])
