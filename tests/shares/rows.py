# SPDX-License-Identifier: Apache-2.0
"""What is flooded: each topic that a user may write, and each resource of the gateway. A row stands for the role that is trusted least of
those that may: programs are not told who sent a message. Registries, gateways and administrators are trusted."""

import json

SHAPES = ("small", "large", "many", "costly")
NAMES = 500  # different names in a flood of many
USERS = {"board": "crook", "viewer": "eve", "operator": "olga", "home-assistant": "home-assistant"}


def description(number):
    services = [{"name": f"s{i}", "id": "D", "model": "distance@1", "title": "x" * 600, "count": 4} for i in range(64)]
    return json.dumps({"board": "crook", "session": f"{number:08x}", "seq": number, "lease": 60, "services": services})


def properties(number):
    each = {"name": "x" * 300, "service": "io", "kind": "number", "type": "integer", "access": "read", "read": "/digital/2"}
    return json.dumps({"version": 1, "board": "crook", "session": "1", "seq": number, "properties": [{"id": f"io/{i}", **each} for i in range(256)]})


def values(number):
    each = {f"io/{i}": {"value": number + i, "how": "reported", "age": 0.1} for i in range(256)}
    return json.dumps({"version": 1, "board": "crook", "session": "1", "seq": number, "clock": f"1-{number}", "values": each})


def nested(number):
    return '{"id":"%d","write":' % number + "[" * 4000


def demand(number):
    return json.dumps({"services": {"*": 100}, "lease": 300, "list": True, "id": str(number), "reply_to": f"asip/reply/eve/desk/c{number}"})


def query(number):
    return json.dumps({"find": "boards", "full": True, "limit": 250, "sort": "-last_seen", "count": True, "board": "*o*d*",
                       "id": str(number), "reply_to": "asip/reply/eve/registry/c1"})


def forget(number):
    return json.dumps({"forget": "*", "dry_run": True, "id": str(number), "reply_to": "asip/reply/olga/registry/c1"})


def link(number):
    return json.dumps({"set": {"name": f"l{number % 200}", "from": "crook/io/2", "when": "follows", "to": "io/13"}, "id": str(number),
                       "reply_to": "asip/reply/olga/desk/c1"})


def links(number):
    each = {"name": "x" * 30, "from": "crook/io/2", "when": "follows", "to": "io/13", "user": "olga"}
    return json.dumps({"version": 1, "board": "crook", "seq": number, "links": [each] * 100})


def log_line(number):
    return json.dumps({"what": "command", "by": f"crook{number}", "service": "io", "request": "x" * 2000, "status": "ok",
                       "time": "2026-11-21T19:00:00Z", "level": "warning", "text": "x" * 2000})


# Topic as in the table of SECURITY.md: who floods it; the message, by its number, that costs its readers most; whether it is retained.
TOPICS = {
    "servicebus/BOARD": ("board", lambda n: f"service-{n}", False),
    "servicebus/BOARD/$state": ("board", lambda n: ("online", "lost", "sleeping", "offline")[n % 4], True),
    "servicebus/BOARD/$description": ("board", description, True),
    "servicebus/BOARD/$stats": ("board", values, False),
    "servicebus/BOARD/$log": ("board", log_line, False),
    "servicebus/BOARD/$commands": ("board", log_line, False),
    "servicebus/BOARD/$properties": ("board", properties, True),
    "servicebus/BOARD/$demand/USER/CLIENT": ("viewer", demand, True),
    "servicebus/$probe": ("viewer", lambda n: "", False),
    "BOARD/in": ("operator", lambda n: "I,d,13,1\n" * 64, False),
    "BOARD/SERVICE/in": ("operator", nested, False),
    "BOARD/$stop": ("operator", lambda n: json.dumps({"id": str(n), "why": "x" * 15000, "reply_to": "asip/reply/olga/desk/c1"}), False),
    "BOARD/$link/USER/CLIENT": ("operator", link, False),
    "BOARD/$links": ("board", links, True),
    "BOARD/$values": ("board", values, True),
    "BOARD/out": ("board", lambda n: f"@D,e,1,{{{n}}}", False),
    "BOARD/SERVICE/out": ("board", lambda n: json.dumps({"distance": list(range(n, n + 400))}), False),
    "BOARD/SERVICE/error": ("board", log_line, False),
    "BOARD/SERVICE/set": ("board", lambda n: json.dumps({"digital": {"13": n}}), True),
    "registry/ID/query": ("viewer", query, False),
    "registry/query": ("viewer", query, False),
    "registry/ID/forget": ("operator", forget, False),
    "registry/forget": ("operator", forget, False),
    "reply/USER/BOARD/CLIENT": ("board", log_line, False),
    "reply/USER/BOARD/CLIENT/PART": ("board", log_line, False),
    "reply/USER/$self/CLIENT": ("viewer", log_line, False),
    "reply/USER/$self/CLIENT/PART": ("viewer", log_line, False),
    "export/ha/EXPORTED/NAME/set": ("home-assistant", lambda n: str(n % 180), False),
    "homeassistant/status": ("home-assistant", lambda n: ("offline", "online")[n % 2], True),
    "homie/5/EXPORTED/ID/NAME/set": ("operator", lambda n: str(n % 180), False),
    "spBv1.0/ID/NCMD/NAME": ("operator", lambda n: b"\x12\x1b\n\x14Node Control/Rebirth \x0bp\x01", False),
    "spBv1.0/ID/DCMD/NAME/EXPORTED": ("operator", lambda n: b"\x12\x0f\n\x08servo/0 \x03X" + bytes([n % 100]), False),
    "spBv1.0/STATE/NAME": ("operator", lambda n: json.dumps({"online": bool(n % 2), "timestamp": 4000000000000 + n}), True),
}
NAMED = {"export/": {"NAME": "servo-0-angle"}, "homie/": {"ID": "servo", "NAME": "servo-0-angle"}}
OUTSIDE = ("homeassistant/", "homie/", "spBv1.0/")

LABELS = json.dumps({"labels": {f"k{i}": "x" * 60 for i in range(32)}})
BOARD = json.dumps({"title": "x", "widgets": [{"kind": "plot", "board": "desk", "property": "distance/0"}] * 48})
SUBSCRIBE = '{"subscribe":"%s","ref":%d,"max_hz":1000}'

# Resource: who floods it; what is asked for behind the path, or sent, where that costs most.
RESOURCES = {
    "GET /api/boards": ("viewer", "?full=true&limit=250&sort=-last_seen&board=*o*d*&count=true&chip=*AT*", ""),
    "GET /api/boards/{board}": ("viewer", "", ""),
    "DELETE /api/boards/{board}": ("admin", "", ""),
    "GET /api/boards/{board}/properties": ("viewer", "", ""),
    "GET /api/boards/{board}/values": ("viewer", "?past=600", ""),
    "PUT /api/boards/{board}/values": ("operator", "?deadline_ms=60000", '{"io/13":true}'),
    "GET /api/boards/{board}/values/stream": ("viewer", "?max_hz=1000", ""),
    "GET /api/boards/{board}/values/kept": ("viewer", "?property=distance/0&points=1000", ""),
    "GET /api/boards/{board}/history": ("viewer", "?limit=1000", ""),
    "GET /api/history": ("viewer", "?limit=1000", ""),
    "GET /api/services": ("viewer", "?limit=1000&sort=-last_seen&unit=cm&count=true&board=*o*d*", ""),
    "GET /api/boards/{board}/services/{service}": ("viewer", "", ""),
    "GET /api/boards/{board}/services/{service}/value": ("viewer", "?wait=60", ""),
    "GET /api/boards/{board}/services/{service}/values": ("viewer", "?since=2026-11-01T00:00:00.000Z", ""),
    "POST /api/boards/{board}/services/{service}/commands/{command}": ("operator", "?deadline_ms=60000&hold_ms=60000", "[13,1]"),
    "POST /api/boards/{board}/raw": ("operator+raw", "", json.dumps({"lines": ["I,d,13,1"] * 64})),
    "POST /api/boards/{board}/labels": ("operator", "", LABELS),
    "POST /api/boards/{board}/load": ("operator", "?deadline_ms=60000", '{"board":"uno"}'),
    "GET /api/boards/{board}/links": ("viewer", "", ""),
    "POST /api/boards/{board}/links": ("operator", "?deadline_ms=60000", json.dumps({"set": {"name": "l1", "from": "lamp/io/2", "to": "io/13"}})),
    "GET /api/commands/{id}": ("operator", "", ""),
    "POST /api/commands/{id}/renew": ("operator", "?hold_ms=60000", "{}"),
    "POST /api/boards/{board}/stop": ("operator", "?once=true&why=" + "x" * 1000, "{}"),
    "POST /api/stop": ("operator", "?once=true", "{}"),
    "POST /api/boards/{board}/resume": ("operator", "", "{}"),
    "POST /api/resume": ("operator", "", "{}"),
    "GET /api/dashboards": ("viewer", "", ""),
    "GET /api/dashboards/{dashboard}": ("kiosk", "", ""),
    "PUT /api/dashboards/{dashboard}": ("operator", "", BOARD),
    "POST /api/dashboards/{dashboard}/widgets/{widget}": ("kiosk", "", '{"value":90}'),
    "GET /api/dashboards/{dashboard}/widgets/{widget}/kept": ("kiosk", "?points=1000", ""),
    "POST /api/dashboards/{dashboard}/links": ("operator", "", '{"control":true}'),
    "DELETE /api/dashboards/{dashboard}/links/{link}": ("operator", "", ""),
    "DELETE /api/dashboards/{dashboard}": ("operator", "", ""),
    "GET /api/lessons": ("operator", "", ""),
    "POST /api/lessons": ("operator", "", '{"boards":["*"]}'),
    "GET /api/lessons/{lesson}": ("operator", "", ""),
    "POST /api/lessons/{lesson}/take": ("operator", "", '{"board":"desk"}'),
    "DELETE /api/lessons/{lesson}": ("operator", "", ""),
    "POST /api/join": ("nobody", "", '{"code":"CDF347"}'),
    "GET /metrics": ("viewer", "?values=*/*", ""),
    "GET /.well-known/wot": ("viewer", "", ""),
    "GET /things": ("viewer", "?limit=250&offset=1700", ""),
    "GET /things/{id}": ("viewer", "", ""),
    "GET /things/{id}/properties": ("viewer", "", ""),
    "GET /things/{id}/properties/{property}": ("viewer", "", ""),
    "PUT /things/{id}/properties/{property}": ("operator", "?deadline_ms=60000", "90"),
    "GET /things/{id}/properties/{property}/stream": ("viewer", "", ""),
    "POST /things/{id}/actions/{action}": ("operator", "?deadline_ms=60000", "{}"),
    "GET /events": ("viewer", "", ""),
    "GET /events/{type}": ("viewer", "", ""),
    "GET /api/models": ("viewer", "", ""),
    "GET /api/models/{name}": ("viewer", "", ""),
    "GET /api/events": ("viewer", "?board=*o*d*", ""),
    "GET /api/boards/{board}/services/{service}/stream": ("viewer", "?max_hz=1000", ""),
    "GET /api/stream": ("viewer", "", ""),
    "GET /api/cable": ("operator", "?vendor=2341&product=0043", ""),
    "GET /api/status": ("kiosk", "", ""),
    "POST /api/codes": ("viewer", "", "{}"),
    "DELETE /api/session": ("nobody", "", ""),
    "GET /api/openapi.json": ("nobody", "", ""),
    "GET /healthz": ("nobody", "", ""),
    "GET /readyz": ("nobody", "", ""),
}
# Beside that table: the page, what is not there, and what the broker does for everybody.
PAGES = {"GET /": ("kiosk", "", ""), "GET /{nothing}": ("viewer", "", ""), "OPTIONS /api/boards": ("nobody", "", "")}
BROKER = {"connect": "nobody", "subscribe": "viewer"}


def all_rows():
    """(kind, name, role, shape)"""
    rows = [("topic", name, role, shape) for name, (role, _, _) in TOPICS.items() for shape in SHAPES]
    rows += [("http", name, role, shape) for name, (role, _, _) in {**RESOURCES, **PAGES}.items() for shape in SHAPES]
    return rows + [("broker", name, role, shape) for name, role in BROKER.items() for shape in SHAPES]


# What the levels of a topic or a path, named in capitals or braces, stand for.
LEVELS = {"BOARD": "desk", "SERVICE": "io", "CLIENT": "c1", "PART": "p1", "ID": "hall", "NAME": "asip", "EXPORTED": "desk", "USER": "ann",
          "board": "desk", "service": "io", "command": "write", "dashboard": "hall", "id": "desk", "name": "servo", "widget": "w1",
          "link": "l1", "lesson": "none", "property": "servo-0-angle", "action": "distance-measure", "type": "thing_created", "nothing": "nothing"}


def filled(pattern, own, number, many):
    """`own`: levels that have one name only. Boards are desk and lamp in turn; of many the last other level has a name for each number."""
    def key(level):
        return level if level.isupper() else level[1:-1] if level.startswith("{") else ""
    levels = pattern.split("/")
    free = [i for i, level in enumerate(levels) if key(level) in LEVELS and key(level) not in own]
    text = [own.get(key(level), LEVELS.get(key(level), level)) for level in levels]
    for i in free:
        if key(levels[i]).upper() == "BOARD":
            text[i] = ("desk", "lamp")[number % 2]
    if many and free:
        text[free[-1]] = f"load-{number}"
    return "/".join(text)
