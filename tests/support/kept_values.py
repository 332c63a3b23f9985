# SPDX-License-Identifier: Apache-2.0
"""A file of values as a registry writes it: what it would have kept in the days before a test begins."""

import math
import sqlite3
import struct

MINUTE = 60_000
DAY = 24 * 60 * MINUTE
# Each level has parts of one length, and rows of another.
LEVELS = {"changes": (6 * 60 * MINUTE, 0), "minutes": (3 * DAY, MINUTE), "hours": (90 * DAY, 60 * MINUTE)}
TABLES = """PRAGMA user_version=1;
    CREATE TABLE properties(id INTEGER PRIMARY KEY, board TEXT NOT NULL, property TEXT NOT NULL, written INTEGER NOT NULL, UNIQUE(board, property));
    CREATE TABLE stretches(start INTEGER PRIMARY KEY, until INTEGER NOT NULL, shift INTEGER NOT NULL);
    CREATE TABLE changes(part INTEGER, property INTEGER, at INTEGER, block BLOB NOT NULL, PRIMARY KEY(part, property, at)) WITHOUT ROWID;"""
BUCKETS = """CREATE TABLE {}(part INTEGER, property INTEGER, at INTEGER, min REAL, mean REAL, max REAL, last REAL, known INTEGER,
    PRIMARY KEY(part, property, at)) WITHOUT ROWID;"""


def packed(changes, begin):
    """As registry/values/value_blocks.cpp: milliseconds since the change before, seven bits a byte, and the value in four bytes."""
    block = b""
    for at, value in changes:
        head = (at - begin) << 1 | 1
        begin = at
        while head >= 0x80:
            block += bytes([head & 0x7F | 0x80])
            head >>= 7
        block += bytes([head]) + struct.pack("<f", value)
    return block


def write_kept(file, board, property_id, stretches, value_at):
    """`stretches`: [(BEGIN, END)] in milliseconds since 1970, in which a registry ran; value_at(TIME) is the value of that minute."""
    with sqlite3.connect(file) as database:
        database.executescript(TABLES + "".join(BUCKETS.format(level) for level in ("minutes", "hours")))
        database.execute("INSERT INTO properties VALUES(1,?,?,0)", (board, property_id))
        for begin, end in stretches:
            begin -= begin % MINUTE
            end -= end % MINUTE
            database.execute("INSERT INTO stretches VALUES(?,?,0)", (begin, end))
            values = [(at, value_at(at)) for at in range(begin, end, MINUTE)]
            for level, (part, length) in LEVELS.items():
                rows = {}
                for at, value in values:
                    rows.setdefault((at // part, at // length if length else 0), []).append((at, value))
                for (number, _), inside in rows.items():
                    at = inside[0][0]
                    if length == 0:
                        database.execute("INSERT INTO changes VALUES(?,1,?,?)", (number, at - number * part, packed(inside, at)))
                        continue
                    numbers = [value for _, value in inside]
                    database.execute(f"INSERT INTO {level} VALUES(?,1,?,?,?,?,?,?)", (number, at - number * part, min(numbers) - 1,
                                     math.fsum(numbers) / len(numbers), max(numbers) + 1, numbers[-1], min(length, len(numbers) * MINUTE)))
    database.close()
