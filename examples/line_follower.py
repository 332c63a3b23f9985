# SPDX-License-Identifier: Apache-2.0
"""Drives a two-wheeled robot along a dark line: plain MQTT, no library of ours.

    python3 line_follower.py [BOARD [BROKER [PORT]]] [--power 50] [--kp 0.015] [--ki 0] [--kd 0] [--period 50] [--cutoff 50]
"""
import argparse
import json
import signal
import uuid

import paho.mqtt.client as mqtt

parser = argparse.ArgumentParser(description="Drives a robot along a line. Ctrl-C stops it.")
parser.add_argument("board", nargs="?", default="mirto")
parser.add_argument("broker", nargs="?", default="127.0.0.1")
parser.add_argument("port", nargs="?", type=int, default=1883)
parser.add_argument("--power", type=float, default=50, help="on a straight line, percent")
parser.add_argument("--kp", type=float, default=0.015, help="gain of the error")
parser.add_argument("--ki", type=float, default=0, help="gain of its sum")
parser.add_argument("--kd", type=float, default=0, help="gain of its change")
parser.add_argument("--period", type=int, default=50, help="milliseconds between two measurements")
parser.add_argument("--cutoff", type=int, default=50, help="sensor values below it are floor")
options = parser.parse_args()

callbacks = {"callback_api_version": mqtt.CallbackAPIVersion.VERSION2} if hasattr(mqtt, "CallbackAPIVersion") else {}  # paho-mqtt 2
client = mqtt.Client(client_id=f"line-follower-{uuid.uuid4()}", protocol=mqtt.MQTTv5, **callbacks)
error = total = 0.0


def command(service, **request):
    return client.publish(f"asip/{options.board}/{service}/in", json.dumps(request))


def motor(percent):
    return round(2.55 * max(-100, min(100, percent)))


def drive(sensors):
    """Powers for the left and the right motor; the right one is mounted the other way round."""
    global error, total
    before = error
    left, middle, right = (value if value >= options.cutoff else 0 for value in sensors)
    if left + middle + right > 0:
        error = (2000 * middle + 4000 * right) / (left + middle + right) - 2000
    total += error
    turn = options.kp * error + options.ki * total + options.kd * (error - before)
    return [motor(options.power + turn), -motor(options.power - turn)]


def on_connect(client, userdata, flags, reason, properties):
    client.subscribe([(f"asip/servicebus/{options.board}/$state", 1), (f"asip/{options.board}/reflectance/out", 0)])


def on_message(client, userdata, message):
    if message.topic.endswith("/$state"):
        print(options.board, "is", message.payload.decode(), flush=True)
        if message.payload == b"online":
            command("reflectance", report=options.period)
        return
    sensors = json.loads(message.payload).get("reflectance", [])
    if len(sensors) == 3:
        command("motors", drive=drive(sensors))


def stop(*_):
    raise KeyboardInterrupt


signal.signal(signal.SIGTERM, stop)
client.on_connect = on_connect
client.on_message = on_message
client.connect(options.broker, options.port)
try:
    client.loop_forever()
except KeyboardInterrupt:
    client.on_message = None  # the last word is ours
    client.loop_start()
    command("reflectance", report=0)
    command("motors", **{"stop-all": []}).wait_for_publish(2)
    client.loop_stop()
    client.disconnect()
