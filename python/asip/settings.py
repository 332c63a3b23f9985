# SPDX-License-Identifier: Apache-2.0
"""Where the bus is: what was given, else the environment, else the user's file of asipctl, else 127.0.0.1; where
no program listens there, the broker that is announced on the local network.

Anybody on a network may announce a broker: one that was found so gets no credentials, its name is logged, and of several none is
taken. ASIP_NO_MDNS=true searches nothing.

The environment's variables are those of asipctl: ASIP_BROKER, ASIP_USER, ASIP_PASSWORD or ASIP_PASSWORD_FILE, ASIP_CA,
ASIP_TOPIC_ROOT, or all of it in the file of ASIP_CREDENTIALS (made by `asipctl secure`).
"""
from __future__ import annotations

import logging
import os
import urllib.parse

from . import errors

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Mapping

log = logging.getLogger("asip")
DEFAULT = "the default"
_SCHEMES = {"": None, "mqtt": False, "tcp": False, "mqtts": True, "ssl": True}


class Broker:
    """`tls` None: TLS is used where a certificate authority is given."""

    def __init__(self, host: str, port: int, tls: bool | None = None):
        self.host, self.port, self.tls = host, port, tls

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Broker) and self.__dict__ == other.__dict__

    def __repr__(self) -> str:
        return f"Broker({self.host!r}, {self.port}, {self.tls})"

    @staticmethod
    def parse(text: str) -> Broker:
        """`HOST`, `HOST:PORT`, `mqtt://HOST:PORT` or `mqtts://HOST`. Raises ValueError, without any password in its text."""
        scheme, _, rest = text.strip().rpartition("://")
        shown = f"{scheme}://...@{rest.rsplit('@', 1)[1]}" if "@" in rest else text
        if scheme not in _SCHEMES:
            raise errors.Invalid(f'broker "{shown}": only mqtt:// and mqtts:// are supported')
        if "@" in rest:
            raise errors.Invalid(f'broker "{shown}": give user and password as user= and password= (ASIP_USER, ASIP_PASSWORD_FILE)')
        if rest.count(":") > 1 and not rest.startswith("["):
            raise errors.Invalid(f'broker "{shown}": an IPv6 address stands in brackets, [{rest}]')
        try:
            parts = urllib.parse.urlsplit("//" + rest.rstrip("/"))
            port = parts.port
        except ValueError as fault:
            raise errors.Invalid(f'broker "{shown}": {fault}') from None
        if not parts.hostname or parts.path or parts.netloc.endswith(":") or port == 0:
            raise errors.Invalid(f'broker "{shown}" is not HOST, HOST:PORT or mqtt://HOST:PORT')
        tls = _SCHEMES[scheme]
        return Broker(parts.hostname, port or (8883 if tls else 1883), tls)


class Settings:
    """How the bus is reached. `source` says where that was read, for error texts."""

    def __init__(self, brokers: tuple[Broker, ...] = (Broker("127.0.0.1", 1883),), user: str | None = None, password: str | None = None,
                 ca: str | None = None, ca_text: str | None = None, certificate: str | None = None, key: str | None = None,
                 root: str = "asip", source: str = DEFAULT):
        self.brokers, self.user, self.password, self.ca, self.ca_text = brokers, user, password, ca, ca_text
        self.certificate, self.key, self.root, self.source = certificate, key, root, source

    def replace(self, **changes: Any) -> Settings:
        return Settings(**{**self.__dict__, **changes})

    def __repr__(self) -> str:
        """Without the password: what is shown in a notebook is copied into reports."""
        where = ", ".join(f"{one.host}:{one.port}" for one in self.brokers)
        return f"<settings of {self.source}: {where}, user {self.user or 'none'}, {'TLS' if self.ca or self.ca_text else 'no TLS'}, topics {self.root}/...>"

    @property
    def password_bytes(self) -> bytes | None:
        """As the broker gets it: also where a file, or the environment, has it in another encoding than UTF-8."""
        return None if self.password is None else self.password.encode("utf-8", "surrogateescape")

    @property
    def is_default(self) -> bool:
        """Nothing says where the bus is, and there are no credentials: they are for the broker that they were made for."""
        return self.source == DEFAULT and self.user is None and self.password is None and self.certificate is None and self.ca is None

    def with_tls_decided(self) -> Settings:
        secure = self.ca is not None or self.ca_text is not None
        return self.replace(brokers=tuple(Broker(one.host, one.port, secure if one.tls is None else one.tls) for one in self.brokers))


def password_hint(password: bytes | None) -> str:
    """What may be wrong with a password that a broker refuses. tests/vectors/passwords.json binds it to the C++ client."""
    if not password:
        return ""
    if b"\n" in password or b"\r" in password:
        return " (the password has a line end)"
    for byte, verb in ((password[-1:], "ends"), (password[:1], "begins")):
        if byte in b" \t":
            return f" (the password {verb} with a blank)"
    try:
        password.decode()
    except UnicodeDecodeError:
        return " (the password is no UTF-8: was it written as Latin-1?)"
    return ""


def _text(path: str) -> str:
    """Bytes that are no UTF-8 stay what they are: a password may have them."""
    with open(path, encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
        text = file.read(1 << 20)
    if "\0" in text:
        raise errors.Invalid(f"{path} is no plain text: save it as UTF-8")
    return text


def _lines(path: str) -> tuple[dict[str, str], str]:
    """Lines `NAME = VALUE` before any section and in `[asipctl]`, and the text of all certificates. Quotes around a value are taken off."""
    text = _text(path)
    found: dict[str, str] = {}
    inside, section = False, "asipctl"
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.strip()
        if inside or line.startswith("-----BEGIN "):
            inside = not line.startswith("-----END ")
        elif line.startswith("["):
            section = line[1:].partition("]")[0].strip()
        elif line and line[0] not in "#;" and section == "asipctl":
            name, equals, value = line.partition("=")
            if not equals:
                raise errors.Invalid(f"{path}:{number}: expected NAME = VALUE")
            found[name.strip().replace("_", "-")] = value.strip().strip('"')
    return found, text if "-----BEGIN CERTIFICATE-----" in text else ""


def _of_credentials(path: str) -> Settings:
    values, certificates = _lines(path)
    for name in ("broker", "user", "password"):
        if not values.get(name):
            raise errors.Invalid(f"{path}: the line {name} = ... is missing")
    return Settings(_brokers(values["broker"]), values["user"], values["password"], None, certificates or None,
                    root=values.get("topic-root") or "asip", source=path)


def _brokers(text: str) -> tuple[Broker, ...]:
    if not isinstance(text, str):
        raise errors.Invalid(f"broker {text!r} is no text: HOST, HOST:PORT or mqtt://HOST:PORT")
    made = tuple(Broker.parse(one) for one in text.split(",") if one.strip())
    if not made:
        raise errors.Invalid("the list of brokers is empty")
    return made


def _first_line(path: str) -> str:
    return _text(path).split("\n", 1)[0].rstrip("\r")


def _password(path: str) -> str:
    found = _first_line(path)
    if not found:
        raise errors.Invalid(f"the password file {path} has no password in its first line")
    return found


def _of_options(values: Mapping[str, str], source: str) -> Settings:
    """`values`: names of asipctl's options without the dashes."""
    if values.get("credentials"):
        return _of_credentials(values["credentials"])
    password = values.get("password") or (_password(values["password-file"]) if values.get("password-file") else None)
    return Settings(_brokers(values.get("broker") or "127.0.0.1"), values.get("user") or None, password, values.get("ca") or None,
                    certificate=values.get("cert") or None, key=values.get("key") or None, root=values.get("topic-root") or "asip", source=source)


def _of_user(environment: Mapping[str, str]) -> Settings | None:
    """The bus of the file that `asipctl` reads: ASIP_CONFIG, else the user's own."""
    base = environment.get("XDG_CONFIG_HOME") or (os.path.join(environment["HOME"], ".config") if environment.get("HOME") else "")
    file = environment.get("ASIP_CONFIG") or (os.path.join(base, "asip", "asipctl.conf") if base else "")
    if not file or not (environment.get("ASIP_CONFIG") or os.path.exists(file)):
        return None
    values = _lines(file)[0]
    made = _of_options(values, file)
    return made.replace(brokers=_brokers(values["broker"])) if values.get("broker") else made


def find(broker: str | None = None, *, credentials: str | None = None, user: str | None = None, password: str | None = None,
         ca: str | None = None, root: str | None = None, environment: Mapping[str, str] = os.environ) -> Settings:
    """The settings of `asip.connect()`. With a `broker` nothing is taken from the environment: a password goes to no other
    broker. Raises ValueError or OSError, naming the file."""
    if credentials is not None:
        made = _of_credentials(credentials)
    elif broker is not None:
        made = Settings(_brokers(broker), source="connect()")
    else:
        given = {name: environment.get("ASIP_" + name.upper().replace("-", "_"), "")
                 for name in ("broker", "user", "password", "password-file", "ca", "cert", "key", "topic-root", "credentials")}
        chosen = None if given["broker"] or given["credentials"] else _of_user(environment)
        made = chosen or _of_options(given, "the environment" if given["broker"] else DEFAULT)
    changes: dict[str, Any] = {name: value for name, value in (("user", user), ("password", password), ("ca", ca), ("root", root)) if value is not None}
    return made.replace(**changes).with_tls_decided()


def announced(settings: Settings, seconds: float, environment: Mapping[str, str] = os.environ) -> Settings:
    """`settings`, or where no program listens at their broker the one that is announced on the local network. Disconnected where
    there are several."""
    from . import _mdns
    if environment.get("ASIP_NO_MDNS", "").lower() in ("true", "1", "on", "yes") or _mdns.listens_here(settings.brokers[0].port):
        return settings
    found = _mdns.search(seconds)
    if not found:
        return settings.replace(source="the default: no broker is configured, none is on this machine, and none is announced on this network")
    every = ", ".join(f"mqtt://{one.host}:{one.port} ({one.name})" for one in found)
    if len(found) > 1:
        raise errors.Disconnected(f"several brokers are announced on this network: {every}; choose one: asip.connect(\"{found[0].host}:{found[0].port}\"), "
                                  "or ASIP_BROKER", reason="several-brokers")
    log.warning("asip: no broker is configured: using %s, which is announced on this network", every)
    return settings.replace(brokers=(Broker(found[0].host, found[0].port, False),), source="an announcement on this network")
