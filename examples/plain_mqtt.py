"""Switches the LED of board uno1 with its own button, and prints distances: plain MQTT, no library of ours."""
import json
import os
import sys
import uuid

import paho.mqtt.client as mqtt
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties

BOARD = sys.argv[1] if len(sys.argv) > 1 else "uno1"
BROKER = sys.argv[2] if len(sys.argv) > 2 else "127.0.0.1"
PORT = int(sys.argv[3]) if len(sys.argv) > 3 else 1883
USER, PASSWORD, CA = (os.environ.get(name) for name in ("ASIP_USER", "ASIP_PASSWORD", "ASIP_CA"))

NAME = f"lamp-{uuid.uuid4()}"
REPLIES = f"asip/reply/{USER}/{BOARD}/{NAME}" if USER else f"asip/reply/{NAME}"
callbacks = {"callback_api_version": mqtt.CallbackAPIVersion.VERSION2} if hasattr(mqtt, "CallbackAPIVersion") else {}  # paho-mqtt 2
client = mqtt.Client(client_id=NAME, protocol=mqtt.MQTTv5, **callbacks)
if USER:
    client.username_pw_set(USER, PASSWORD)
if CA:
    client.tls_set(CA)
waiting = {}  # correlation -> what was asked


def command(service, **request):
    """command("servo", write=[0, 90]): the answer arrives in on_message."""
    correlation = uuid.uuid4().hex.encode()
    waiting[correlation] = (service, request)
    properties = Properties(PacketTypes.PUBLISH)
    properties.ResponseTopic = REPLIES
    properties.CorrelationData = correlation
    client.publish(f"asip/{BOARD}/{service}/in", json.dumps(request), qos=1, properties=properties)


def on_connect(client, userdata, flags, reason, properties):
    if reason != 0:
        sys.exit(f"the broker refused this client: {reason}")
    client.subscribe([(REPLIES, 1), (f"asip/servicebus/{BOARD}/$state", 1), (f"asip/{BOARD}/+/out", 0)])


def on_state(state):
    print(BOARD, "is", state)
    if state == "online":
        command("io", mode=[13, "output"])
        command("io", mode=[2, "input-pullup"])
        command("distance", report=100)


def on_message(client, userdata, message):
    if message.topic == REPLIES:
        answer = json.loads(message.payload)
        asked = waiting.pop(message.properties.CorrelationData, "?")
        if answer["status"] != "ok":
            print("failed:", asked, answer)
    elif message.topic.endswith("/$state"):
        on_state(message.payload.decode())
    elif message.topic.endswith("/io/out"):
        levels = json.loads(message.payload).get("digital", {})
        if "2" in levels:
            command("io", write=[13, 1 - levels["2"]])
    elif message.topic.endswith("/distance/out"):
        print("distance", json.loads(message.payload)["distance"], "cm")


client.on_connect = on_connect
client.on_message = on_message
client.connect(BROKER, PORT)
client.loop_forever()
