# SPDX-License-Identifier: Apache-2.0
"""The only module that imports paho-mqtt: one connection to one broker, with paho-mqtt 1.6 and 2.x.

Each connection is a `mqtt.Client` of its own, and paho never reconnects: it would deliver a command of a broken connection
seconds later. Callbacks run in paho's thread; they must not block.
"""
from __future__ import annotations

import contextlib
import socket
import ssl
import sys
import threading

try:
    import paho.mqtt.client as mqtt
    from paho.mqtt.packettypes import PacketTypes
    from paho.mqtt.properties import Properties
except ModuleNotFoundError as fault:
    raise ModuleNotFoundError(f"asip needs paho-mqtt, which {sys.executable} has not: pip install paho-mqtt; Debian's package "
                              "python3-paho-mqtt is that of /usr/bin/python3", name=fault.name) from fault

from . import _wait
from .settings import Broker, Settings, password_hint

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

KEEPALIVE_SECONDS = 10
# MQTT 5 limits what a broker may have under way to us: without it one of QoS 1 messages beyond that waits unseen.
_MAX_PACKET_BYTES = 2 << 20
_BAD_CREDENTIALS = (4, 5, 134, 135)  # of a CONNACK: "bad user or password" and "not authorised", of 3.1.1 and of 5
_DELIVERED_TO_OTHERS = 131  # of a PUBACK: RabbitMQ says so of a topic to which a dead node of the cluster had a subscription
_QUICKACK = getattr(socket, "TCP_QUICKACK", None)


class _Client(mqtt.Client):  # type: ignore[misc]  # paho-mqtt 1.6 has no types
    """paho's thread runs loop_forever(): when that ends, by whatever a packet raised there, the connection has ended."""

    ended: Callable[[str], None] | None = None

    def loop_forever(self, *args: Any, **named: Any) -> Any:
        why = "its thread ended"
        _wait.forbid()
        try:
            return super().loop_forever(*args, **named)
        except Exception as fault:  # noqa: BLE001: what a broker sends may raise anything in paho
            why = f"a packet that cannot be read: {fault!r}"
            return None
        finally:
            ended = self.ended
            if ended is not None:
                ended(why)


class Link:
    """One connection, from its first packet to its end.

    `on_up(v5)`, `on_down(why, how)` (`how`: as asip._brokers has it), `on_message(topic, payload, retained, expiry)`, `on_denied(key)`: in paho's thread. `on_down`
    comes at most once, also where the connection was never up. paho-mqtt 1.6 tells of no denied message.
    """

    def __init__(self, broker: Broker, settings: Settings, client_id: str, v5: bool, on_up: Callable[[bool], None],
                 on_down: Callable[[str, str], None], on_message: Callable[[str, bytes, bool, "int | None"], None],
                 on_denied: Callable[[str], None]):
        self._v5 = v5
        self._on_denied = on_denied
        self._mids = threading.Lock()
        self._asked: dict[int, str] = {}  # by the number of its packet: what is told as denied
        self._denied: set[int] = set()    # before publish() said which number a packet has
        self._on_up, self._on_down, self._on_message = on_up, on_down, on_message
        self._down = False
        self._answered = False  # by a CONNACK
        self._socket: Any = None
        extra: dict[str, Any] = {}
        if hasattr(mqtt, "CallbackAPIVersion"):
            extra["callback_api_version"] = mqtt.CallbackAPIVersion.VERSION2
        self._client: Any = _Client(client_id=client_id, protocol=mqtt.MQTTv5 if v5 else mqtt.MQTTv311, reconnect_on_failure=False, **extra)
        client = self._client
        client.ended = self._thread_ended
        client.on_connect = self._connected
        client.on_disconnect = self._disconnected
        client.on_message = self._received
        client.on_publish = self._published
        client.on_socket_open = self._opened
        client.max_queued_messages_set(0)
        client.max_inflight_messages_set(1000)
        if settings.user is not None:
            client.username_pw_set(settings.user, settings.password_bytes)
        if broker.tls:
            context = ssl.create_default_context(cafile=settings.ca, cadata=settings.ca_text)
            if settings.certificate:
                context.load_cert_chain(settings.certificate, settings.key)
            client.tls_set_context(context)
        self._broker = broker
        self._hint = password_hint(settings.password_bytes)

    def start(self) -> None:
        """Connects; OSError or ValueError where there is no way to the broker."""
        options: dict[str, Any] = {}
        if self._v5:
            properties: Any = Properties(PacketTypes.CONNECT)
            properties.MaximumPacketSize = _MAX_PACKET_BYTES
            options = {"clean_start": True, "properties": properties}
        self._client.connect(self._broker.host, self._broker.port, KEEPALIVE_SECONDS, **options)
        self._client.loop_start()

    def publish(self, topic: str, payload: bytes, qos: int, expiry: int | None, key: str | None = None) -> None:
        """`key`: what `on_denied` is told where the broker denies this message."""
        properties: Any = None
        if self._v5 and expiry is not None:
            properties = Properties(PacketTypes.PUBLISH)
            properties.MessageExpiryInterval = expiry
        client = self._client
        if client is None:
            return
        mid = client.publish(topic, payload, qos, False, properties).mid
        if key is not None and qos > 0 and self._v5:
            with self._mids:
                denied = mid in self._denied
                self._denied.discard(mid)
                if not denied:
                    self._asked[mid] = key
            if denied:
                self._on_denied(key)

    def _published(self, _client: Any, _data: Any, mid: int, *rest: Any) -> None:
        self._acknowledge_at_once()
        reason = rest[0] if rest else 0
        code = getattr(reason, "value", reason)
        denied = code >= 128 and code != _DELIVERED_TO_OTHERS
        with self._mids:
            key = self._asked.pop(mid, None)
            if denied and key is None:
                self._denied.add(mid)
        if denied and key is not None:
            self._on_denied(key)

    def subscribe(self, topic: str, qos: int) -> None:
        client = self._client
        if client is not None:
            client.subscribe(topic, qos)

    def unsubscribe(self, topic: str) -> None:
        client = self._client
        if client is not None:
            client.unsubscribe(topic)

    def close(self) -> None:
        """Says goodbye to the broker, and ends paho's thread within a second. Not from paho's thread."""
        self._down = True
        self._socket = None
        client, self._client = self._client, None
        if client is None:
            return
        with contextlib.suppress(Exception):
            client.disconnect()
        with contextlib.suppress(Exception):
            client.loop_stop()
        # paho closes its inner sockets when nothing refers to the client any more.
        client.ended = None
        for name in ("on_connect", "on_disconnect", "on_message", "on_publish", "on_socket_open"):
            setattr(client, name, None)
        del self._on_up, self._on_down, self._on_message, self._on_denied

    def _opened(self, _client: Any, _data: Any, sock: Any) -> None:
        self._socket = sock if _QUICKACK is not None else None
        with contextlib.suppress(OSError, AttributeError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _acknowledge_at_once(self) -> None:
        """Without it Linux acknowledges up to 40 ms late, and a broker without TCP_NODELAY waits for that."""
        if self._socket is not None:
            with contextlib.suppress(OSError, AttributeError, ValueError):
                self._socket.setsockopt(socket.IPPROTO_TCP, _QUICKACK, 1)

    def _connected(self, _client: Any, _data: Any, _flags: Any, reason: Any, *_: Any) -> None:
        self._answered = True
        if reason == 0:
            self._on_up(self._v5)
            return
        number = getattr(reason, "value", reason)
        text = mqtt.connack_string(reason) if isinstance(reason, int) else str(reason)  # a number is one of 3.1.1
        if number in _BAD_CREDENTIALS:
            text += self._hint
        version = self._v5 and number in (1, 132) or "protocol version" in text.lower()
        self._ended(f"the broker refuses us: {text}", "version" if version else "other")

    def _disconnected(self, _client: Any, _data: Any, *rest: Any) -> None:
        # (reason, properties) with 1.6, (flags, reason, properties) with 2.x
        reason = rest[1] if len(rest) >= 3 else rest[0] if rest else ""
        self._ended(f"the connection to {self._broker.host}:{self._broker.port} ended ({reason})", "other" if self._answered else "closed")

    def _thread_ended(self, why: str) -> None:
        # paho-mqtt may understand nothing of a refusal in the words of 3.1.1.
        self._ended(f"the connection to {self._broker.host}:{self._broker.port} ended ({why})", "other" if self._answered or not self._v5 else "version")

    def _ended(self, why: str, how: str) -> None:
        if not self._down:
            self._down = True
            self._on_down(why, how)

    def _received(self, _client: Any, _data: Any, message: Any) -> None:
        self._acknowledge_at_once()
        expiry = getattr(getattr(message, "properties", None), "MessageExpiryInterval", None)
        try:
            topic = message.topic
        except UnicodeDecodeError:
            return
        self._on_message(topic, bytes(message.payload), bool(message.retain), expiry)
