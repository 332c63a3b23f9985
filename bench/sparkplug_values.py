# SPDX-License-Identifier: Apache-2.0
"""What a host of Sparkplug B reads: births say the aliases of metrics, data has the aliases alone."""

import struct

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5
PAYLOAD_METRICS = 2
NAME, ALIAS, IS_NULL, INT, LONG, DOUBLE, BOOLEAN, STRING = 1, 2, 7, 10, 11, 13, 14, 15


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value, at


def fields(data):
    """Number and value of each field of a protobuf message: a whole number, or bytes."""
    at = 0
    while at < len(data):
        tag, at = varint(data, at)
        wire_type = tag & 7
        if wire_type == VARINT:
            value, at = varint(data, at)
        elif wire_type in (FIXED64, FIXED32, BYTES):
            size, at = varint(data, at) if wire_type == BYTES else ({FIXED64: 8, FIXED32: 4}[wire_type], at)
            if at + size > len(data):
                raise ValueError("a protobuf message is cut off")
            value, at = data[at:at + size], at + size
        else:
            raise ValueError(f"protobuf has no wire type {wire_type}")
        yield tag >> 3, value


def value_of(metric):
    if metric.get(IS_NULL):
        return None
    if DOUBLE in metric:
        return struct.unpack("<d", metric[DOUBLE])[0]
    if BOOLEAN in metric:
        return bool(metric[BOOLEAN])
    if STRING in metric:
        return metric[STRING].decode()
    return metric.get(LONG, metric.get(INT))


def metrics(payload):
    """The name of each metric, which data does not have, its alias and its value."""
    for number, data in fields(payload):
        if number == PAYLOAD_METRICS:
            metric = dict(fields(data))
            yield metric.get(NAME, b"").decode(), metric.get(ALIAS), value_of(metric)


def values(messages, name):
    """(value, when) of a metric, as often as data of one device says it, from (topic, payload, when) of all its messages."""
    alias = None
    for topic, payload, at in messages:
        kind = topic.split("/")[2]
        for each_name, each_alias, value in metrics(payload):
            if kind == "DBIRTH" and each_name == name:
                alias = each_alias
            elif kind == "DDATA" and alias is not None and each_alias == alias:
                yield value, at
