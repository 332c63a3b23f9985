// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::gateway::api {

/// A dashboard with one widget of each kind.
inline constexpr std::string_view kDashboardExample = R"json({"title": "Greenhouse", "widgets": [
  {"kind": "value", "title": "Distance", "board": "desk", "property": "distance/0"},
  {"kind": "plot", "board": "desk", "property": "distance/0", "size": "wide", "span": "day"},
  {"kind": "switch", "title": "Lamp", "board": "lamp", "property": "io/13"},
  {"kind": "slider", "title": "Vent", "board": "desk", "property": "servo/0/angle"},
  {"kind": "lamp", "title": "Button", "board": "desk", "property": "io/2"},
  {"kind": "gauge", "labels": "room=greenhouse", "property": "io/14"},
  {"kind": "text", "title": "Rules", "text": "Water by noon."},
  {"kind": "stop", "title": "Stop"}]})json";

/// The part of the OpenAPI document that the routes refer to.
inline constexpr std::string_view kComponents = R"json({
"securitySchemes": {
  "token": {"type": "http", "scheme": "bearer", "description": "Made by asip-gateway token"},
  "cookie": {"type": "apiKey", "in": "cookie", "name": "asip", "description": "Set when a browser opens a code"}
},
"responses": {
  "BadRequest": {"description": "The request is wrong; the sentence names the fault",
    "content": {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}},
  "Unauthorized": {"description": "A token is needed, or the one that was sent is not known",
    "content": {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}},
  "Forbidden": {"description": "The token does not allow this, or a page of another origin asked",
    "content": {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}},
  "WrongType": {"description": "The body is not application/json",
    "content": {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}},
  "WrongHost": {"description": "Host is not a name of this gateway",
    "content": {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}}
},
"schemas": {
  "Anything": {},
  "Problem": {"type": "object", "required": ["title", "status", "detail"], "properties": {
    "title": {"type": "string"}, "status": {"type": "integer"}, "detail": {"type": "string"},
    "outcome": {"type": "string", "enum": ["error", "timeout", "refused"]},
    "reason": {"type": "string"}, "code": {"type": "integer"}, "error": {"type": "string"}, "id": {"type": "string"}}},
  "State": {"type": "string", "enum": ["online", "offline", "lost", "sleeping", "updating"]},
  "ServiceItem": {"type": "object", "required": ["name"], "properties": {
    "name": {"type": "string"}, "board": {"type": "string"}, "state": {"$ref": "#/components/schemas/State"},
    "kind": {"type": "string"}, "model": {"type": "string"}, "id": {"type": "string"}, "title": {"type": "string"},
    "count": {"type": "integer"}, "period": {"type": "integer"},
    "label": {"type": "string", "description": "What people call it"}}},
  "Names": {"type": "object", "description": "What people call services and pins", "properties": {
    "services": {"type": "object", "additionalProperties": {"type": "string"}},
    "pins": {"type": "object", "additionalProperties": {"type": "string"}}}},
  "Board": {"type": "object", "required": ["board", "state", "services"], "properties": {
    "board": {"type": "string"}, "state": {"$ref": "#/components/schemas/State"}, "age": {"type": "number"},
    "names_only": {"type": "boolean"}, "session": {"type": "string"}, "seq": {"type": "integer"},
    "lease": {"type": "integer"}, "first_seen": {"type": "string"}, "last_seen": {"type": "string"},
    "since": {"type": "string"}, "reason": {"type": "string"}, "state_age": {"type": "number"}, "chip": {"type": "string"}, "sketch": {"type": "string"},
    "version": {"type": "string", "description": "Of the firmware library in the sketch"}, "available": {"type": "string", "description": "The newer one that its agent would load"},
    "protocol": {"type": "string"}, "agent": {"type": "string"}, "link": {"type": "string"},
    "labels": {"type": "object", "additionalProperties": {"type": "string", "maxLength": 63}},
    "names": {"$ref": "#/components/schemas/Names"}, "conflict": {"type": "object"}, "description": {"type": "object"},
    "services": {"type": "array", "items": {"$ref": "#/components/schemas/ServiceItem"}}}},
  "Page": {"type": "object", "required": ["find", "items"], "properties": {
    "find": {"type": "string", "enum": ["boards", "services", "history", "values"]},
    "epoch": {"type": "string"}, "seq": {"type": "integer"}, "registry": {"type": "string"},
    "settling": {"type": "boolean"}, "brief": {"type": "boolean"}, "total": {"type": "integer"},
    "cursor": {"type": "string"}, "items": {"type": "array"},
    "level": {"type": "string", "enum": ["changes", "minutes", "hours"], "description": "Of values: what the points are made of; missing: nothing is kept"}}},
  "Forgotten": {"type": "object", "required": ["forgotten"], "properties": {
    "forgotten": {"type": "array", "items": {"type": "string"}}}},
  "Service": {"type": "object", "required": ["name", "board", "state"], "properties": {
    "name": {"type": "string"}, "board": {"type": "string"}, "state": {"$ref": "#/components/schemas/State"},
    "model": {"description": "The model; the reference to it where it is not known here"}}},
  "Value": {"type": "object", "required": ["board", "service", "place", "events"], "properties": {
    "board": {"type": "string"}, "service": {"type": "string"}, "place": {"type": "string"},
    "events": {"type": "object", "additionalProperties": {"type": "object", "required": ["value", "at", "age"],
      "properties": {"value": {}, "at": {"type": "string"}, "age": {"type": "number"}}}}}},
  "Values": {"type": "object", "required": ["items", "complete", "place"], "properties": {
    "complete": {"type": "boolean", "description": "Nothing behind `since` is missing"},
    "place": {"type": "string"},
    "items": {"type": "array", "items": {"type": "object", "required": ["place", "at"],
      "properties": {"place": {"type": "string"}, "at": {"type": "string"}, "value": {}, "error": {}}}}}},
  "PropertyList": {"type": "object", "required": ["version", "board", "session", "properties"], "properties": {
    "version": {"type": "integer"}, "board": {"type": "string"}, "session": {"type": "string"}, "seq": {"type": "integer"},
    "properties": {"type": "array", "items": {"type": "object", "required": ["id", "name", "service", "kind", "type", "access"],
      "properties": {"id": {"type": "string"}, "name": {"type": "string"}, "service": {"type": "string"},
        "kind": {"type": "string", "enum": ["sensor", "binary", "switch", "number", "light", "button", "text", "select"]},
        "type": {"type": "string"}, "access": {"type": "string", "enum": ["read", "write", "both"]}, "unit": {"type": "string"}}}}}},
  "PropertyValues": {"type": "object", "required": ["board", "session", "values", "present"], "properties": {
    "board": {"type": "string"}, "session": {"type": "string"},
    "present": {"type": "boolean", "description": "The board is there; otherwise these are its last values"},
    "past": {"type": "object", "description": "By id, the newest first: [time, number]", "additionalProperties": {"type": "array", "items": {"type": "array"}}},
    "values": {"type": "object", "additionalProperties": {"type": "object", "required": ["age"], "properties": {
      "value": {}, "age": {"type": "number"}, "how": {"type": "string", "enum": ["reported", "answered", "set"]},
      "unknown": {"type": "string", "enum": ["never", "restart", "doubt"], "description": "Why there is no value"}}}}}},
  "Arguments": {"description": "An array of arguments, an object by their names, or nothing"},
  "RawLines": {"type": "object", "required": ["lines"], "additionalProperties": false, "properties": {
    "lines": {"type": "array", "minItems": 1, "maxItems": 64, "items": {"type": "string", "maxLength": 62}}}},
  "LabelChange": {"type": "object", "minProperties": 1, "additionalProperties": false,
    "description": "What is to be set; null removes, what is not named stays", "properties": {
    "labels": {"type": "object", "maxProperties": 32, "additionalProperties": {"type": ["string", "null"], "maxLength": 63}},
    "meanings": {"type": "object", "maxProperties": 64, "additionalProperties": {"type": ["object", "null"]}, "description": "What properties are, by id: class, inverted, debounce, unit, line, icon, hidden"},
    "names": {"type": "object", "additionalProperties": false, "properties": {
      "services": {"type": "object", "maxProperties": 64, "additionalProperties": {"type": ["string", "null"], "maxLength": 63}},
      "pins": {"type": "object", "maxProperties": 64, "additionalProperties": {"type": ["string", "null"], "maxLength": 63}}}}}},
  "Load": {"type": "object", "additionalProperties": false, "description": "Firmware of the agent's machine, AsipServices where it is not given; which board it is, where USB does not tell", "properties": {
    "firmware": {"type": "string", "maxLength": 64}, "board": {"type": "string", "enum": ["uno", "nano", "nano-old", "mega"]},
    "force": {"type": "boolean", "description": "Also where the board runs ASIP"},
    "update": {"type": "boolean", "description": "Instead: the newer version of the sketch that the board runs; where its agent has none, nothing is done"}}},
  "BoardLinkChange": {"type": "object", "minProperties": 1, "maxProperties": 1, "additionalProperties": false, "properties": {
    "set": {"type": "object", "required": ["name", "from", "to"], "description": "See docs/links.md"},
    "remove": {"type": "string"}, "enable": {"type": "string"}, "disable": {"type": "string"}}},
  "BoardLinks": {"type": "object", "required": ["items"], "properties": {
    "set_aside": {"type": "array", "items": {"type": "string"}, "description": "Files of links that cannot be read, by their names"},
    "items": {"type": "array", "items": {"type": "object", "required": ["name", "board", "from", "when", "to", "rule", "state", "yours"],
      "properties": {"name": {"type": "string"}, "board": {"type": "string", "description": "Of the target"}, "from": {"type": "string"},
        "when": {"type": "string"}, "to": {"type": "string"}, "rule": {"type": "string"}, "state": {"type": "string", "description": "on, disabled, or why it does nothing"},
        "last": {"type": "string", "description": "What it did last, and why"}, "at": {"type": "string"}, "user": {"type": "string"},
        "yours": {"type": "boolean", "description": "The gateway set it, and you may change it"}}}}}},
  "CommandAnswer": {"type": "object", "required": ["status"], "properties": {
    "status": {"type": "string", "enum": ["ok", "error", "timeout", "refused"]}, "id": {"type": "string"},
    "proof": {"type": "string"}, "answer": {}, "code": {"type": "integer"}, "error": {"type": "string"},
    "reason": {"type": "string"}, "by": {"type": "string"}}},
  "Command": {"type": "object", "required": ["id", "target", "by", "at", "request"], "properties": {
    "id": {"type": "string"}, "target": {"type": "string"}, "by": {"type": "string"}, "at": {"type": "string"},
    "request": {}, "late": {"type": "boolean"}, "answer": {"$ref": "#/components/schemas/CommandAnswer"}}},
  "BoardNames": {"type": "object", "additionalProperties": false, "properties": {
    "boards": {"type": "array", "items": {"type": "string"}, "description": "Missing: all that you see"}}},
  "Stopped": {"type": "object", "required": ["boards"], "properties": {
    "boards": {"type": "object", "additionalProperties": {"$ref": "#/components/schemas/CommandAnswer"}}}},
  "Models": {"type": "object", "required": ["items"], "properties": {"items": {"type": "array", "items": {
    "type": "object", "required": ["name", "version", "id", "title"], "properties": {"name": {"type": "string"},
      "version": {"type": "integer"}, "id": {"type": "string"}, "title": {"type": "string"}}}}}},
  "Model": {"type": "object", "required": ["name", "version"], "properties": {
    "name": {"type": "string"}, "version": {"type": "integer"}}},
  "Thing": {"type": "object", "required": ["@context", "id", "title", "security", "securityDefinitions"],
    "description": "A W3C Thing Description 1.1"},
  "Things": {"type": "array", "items": {"$ref": "#/components/schemas/Thing"}},
  "Properties": {"type": "object"},
  "PropertyValue": {"description": "A number, a text, true or false; of a light an object: on, brightness, color"},
  "PropertyByIdValue": {"type": "object", "minProperties": 1, "maxProperties": 1, "description": "Its id and its value", "additionalProperties": {"$ref": "#/components/schemas/PropertyValue"}},
  "EventStream": {"type": "string"},
  "Widget": {"type": "object", "required": ["kind"], "additionalProperties": false, "properties": {
    "id": {"type": "string", "pattern": "^[A-Za-z0-9_-]{1,16}$", "description": "Given by the gateway where it is missing"},
    "kind": {"type": "string", "enum": ["value", "plot", "switch", "slider", "lamp", "stop", "gauge", "text"]},
    "title": {"type": "string", "maxLength": 100}, "size": {"type": "string", "enum": ["small", "wide", "large"]},
    "board": {"type": "string", "description": "Of all but stop and text, with property"},
    "labels": {"type": "string", "description": "In place of board: one tile for each board that has them now, such as `class=4b`; its id is ID.BOARD"},
    "text": {"type": "string", "maxLength": 1000, "description": "Of a text"},
    "span": {"type": "string", "enum": ["hour", "day", "week", "month"], "description": "Of a plot: the time that it shows at first, and the longest that the user of a link sees; missing: the last minute"},
    "property": {"type": "string", "description": "Its id in the list of the board, such as `servo/0/angle`"}}},
  "Dashboard": {"type": "object", "required": ["widgets"], "additionalProperties": false, "properties": {
    "title": {"type": "string", "maxLength": 100},
    "widgets": {"type": "array", "maxItems": 48, "items": {"$ref": "#/components/schemas/Widget"}},
    "name": {"type": "string", "readOnly": true}, "by": {"type": "string", "readOnly": true}, "changed": {"type": "string", "readOnly": true},
    "links": {"type": "array", "readOnly": true, "description": "For users who may change it", "items": {"$ref": "#/components/schemas/Link"}}}},
  "Dashboards": {"type": "object", "required": ["items"], "properties": {"items": {"type": "array", "items": {"type": "object",
    "required": ["name", "title", "widgets"], "properties": {"name": {"type": "string"}, "title": {"type": "string"},
      "widgets": {"type": "integer"}, "by": {"type": "string"}, "changed": {"type": "string"},
      "links": {"type": "array", "items": {"$ref": "#/components/schemas/Link"}}}}}}},
  "WidgetValue": {"type": "object", "description": "Of a stop: an empty object", "properties": {"value": {"$ref": "#/components/schemas/PropertyValue"}}},
  "LinkRequest": {"type": "object", "additionalProperties": false, "properties": {
    "name": {"type": "string"}, "until": {"type": ["string", "null"], "description": "How long it is valid: 12h, 365d; null: until it is ended; missing: 30d. It ends with the token of its maker in any case"},
    "control": {"type": "boolean", "description": "Its switches, sliders and stops may be used"}}},
  "Link": {"type": "object", "required": ["name", "control"], "properties": {
    "name": {"type": "string"}, "control": {"type": "boolean"}, "until": {"type": "string"}, "by": {"type": "string"},
    "token": {"type": "string"}, "path": {"type": "string"}}},
  "LessonRequest": {"type": "object", "additionalProperties": false, "description": "boards, labels or lend", "properties": {
    "boards": {"type": "array", "minItems": 1, "maxItems": 64, "items": {"type": "string"}, "description": "Names, or patterns: those that are there now"},
    "labels": {"type": "string", "description": "Those that have them now: `class=4b`. A label that is set later gives nobody a right"},
    "lend": {"type": "boolean", "description": "Each pupil lends the board in its computer"},
    "minutes": {"type": "integer", "minimum": 1, "maximum": 480, "description": "Missing: 60"}}},
  "Lesson": {"type": "object", "required": ["id", "code", "path", "by", "until", "lend", "boards", "free"], "properties": {
    "id": {"type": "string"}, "code": {"type": "string"}, "path": {"type": "string", "description": "Of the page, behind its address: the code is in the part that no browser sends"},
    "by": {"type": "string"}, "until": {"type": "string"}, "lend": {"type": "boolean"}, "free": {"type": "integer"},
    "boards": {"type": "array", "items": {"type": "object", "required": ["board", "kept"], "properties": {
      "board": {"type": "string"}, "kept": {"type": "boolean", "description": "By the teacher"},
      "pupil": {"type": "string"}, "since": {"type": "string"}}}}}},
  "Lessons": {"type": "object", "required": ["items"], "properties": {"items": {"type": "array", "items": {"$ref": "#/components/schemas/Lesson"}}}},
  "TakeOver": {"type": "object", "required": ["board"], "additionalProperties": false, "properties": {
    "board": {"type": "string"}, "keep": {"type": "boolean", "description": "It stays with the teacher; missing: it becomes free"}}},
  "JoinRequest": {"type": "object", "required": ["code"], "additionalProperties": false, "properties": {"code": {"type": "string"}}},
  "Seat": {"type": "object", "required": ["pupil", "board", "lend", "until"], "properties": {
    "pupil": {"type": "string"}, "board": {"type": "string"}, "lend": {"type": "boolean", "description": "The pupil lends this board, which may not be there yet"}, "until": {"type": "string"}}},
  "Status": {"type": "object", "required": ["version", "you", "broker", "mirror"],
    "description": "For a token that is limited to boards or services: of these alone, without broker address and all that is of no board; users are for an admin",
    "properties": {"version": {"type": "string"}, "you": {"type": "object"}, "broker": {"type": "object"},
      "mirror": {"type": "object"}, "registries": {"type": "array"}, "streams": {"type": "object"},
      "exports": {"type": "array", "items": {"type": "object", "required": ["system", "title", "on", "shows"], "properties": {
        "system": {"type": "string"}, "title": {"type": "string"}, "on": {"type": "boolean", "description": "The gateway has its option"},
        "shows": {"type": "boolean", "description": "It shows boards there now"},
        "other": {"type": "string", "description": "The machine of another gateway that does"},
        "found": {"type": "boolean", "description": "What the system last said of itself; missing: nothing yet"}}}},
      "simulator": {"type": "boolean", "description": "The gateway's machine has asip-sim"},
      "users": {"type": "array", "description": "Of the tokens file", "items": {"type": "object", "required": ["name", "role"], "properties": {
        "name": {"type": "string"}, "role": {"type": "string"}, "until": {"type": "string"}, "dashboard": {"type": "string"},
        "boards": {"type": "array", "items": {"type": "string"}}, "services": {"type": "array", "items": {"type": "string"}}}}}}},
  "Code": {"type": "object", "required": ["code", "expires_in"], "properties": {
    "code": {"type": "string"}, "expires_in": {"type": "integer"}}},
  "Health": {"type": "object", "required": ["status"], "properties": {"status": {"type": "string"}}}
}})json";

}  // namespace asip::gateway::api
