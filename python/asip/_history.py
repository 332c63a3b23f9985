# SPDX-License-Identifier: Apache-2.0
"""How a property was: `for point in desk["distance/0"].history(days=7): print(point.at, point.mean)`."""
from __future__ import annotations

import datetime
import importlib
import math

from . import _wait, errors

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NamedTuple

    from ._calls import Call
    from ._followed import Home

    class _Point(NamedTuple):
        at: datetime.datetime
        mean: float | None
        min: float | None
        max: float | None
else:
    from collections import namedtuple

    _Point = namedtuple("_Point", "at mean min max")


_TIME = "%Y-%m-%dT%H:%M:%S.%fZ"


class Point(_Point):
    """From `at` until the next point. A mean of None begins a gap: nothing is known, or the board was not there."""

    __slots__ = ()


class History(list[Point]):
    """The points, the oldest first; `level`: what they were made of (`changes`, `minutes`, `hours`), empty where nothing is kept; `registry`: who
    kept them."""

    level = ""
    registry = ""

    def frame(self) -> Any:
        """As a pandas DataFrame with the columns mean, min and max, by time."""
        pandas = importlib.import_module("pandas")
        index = pandas.DatetimeIndex([one.at for one in self], name="at")
        return pandas.DataFrame({name: [getattr(one, name) for one in self] for name in ("mean", "min", "max")}, index=index, dtype=float)


def query(board: str, property: str, days: float, hours: float, points: int) -> dict[str, Any]:
    """What a registry is asked: the last so many days and hours, of the time of this machine."""
    for name, number in (("days", days), ("hours", hours)):
        if isinstance(number, bool) or not isinstance(number, (int, float)) or not 0 <= number < 1e5:
            raise errors.Invalid(f"{name}={number!r}: is no number from 0", reason="invalid")
    if isinstance(points, bool) or not isinstance(points, int) or not 1 <= points <= 1000:
        raise errors.Invalid(f"points={points!r}: is no whole number from 1 to 1000", reason="invalid")
    span = datetime.timedelta(days=days, hours=hours) or datetime.timedelta(days=1)
    to = datetime.datetime.now(datetime.timezone.utc)
    return {"find": "values", "board": board, "property": property, "from": _text(to - span), "to": _text(to), "points": points}


def longest(bus: Home, query: dict[str, Any], seconds: float) -> History:
    """Each registry keeps for itself: all are asked, and the one counts that knew the value for the longest."""
    engine = bus._engine
    if engine.peek(lambda session: session.registries is None):
        engine.do(lambda session, now: session.look_at_registries())
        bus._wait_told(seconds, "registries")
    names = engine.peek(lambda session: sorted(session.registries or ()))
    if len(names) < 2:
        return read(bus.query(query, timeout=seconds))

    def asked(name: str) -> Call:
        return engine.ask(lambda session, now: session.query(now, dict(query), seconds, name))
    calls = [asked(name) for name in names]
    kept, fault = [], None
    for call in calls:
        try:
            kept.append(read(_wait.result(call.future)))
        except errors.Error as error:
            fault = error
    if fault is not None and not kept:
        raise fault
    to = datetime.datetime.strptime(query["to"], _TIME).replace(tzinfo=datetime.timezone.utc)
    return max(kept, key=lambda history: _known(history, to))


def _known(history: History, to: datetime.datetime) -> datetime.timedelta:
    """For how long the value was known until `to`."""
    ends = [*(one.at for one in history[1:]), to]
    return sum((max(end - one.at, datetime.timedelta()) for one, end in zip(history, ends) if one.mean is not None), datetime.timedelta())


def read(answer: dict[str, Any]) -> History:
    """From the answer of a registry; what is no point is passed over."""
    history = History()
    history.level, history.registry = str(answer.get("level") or ""), str(answer.get("registry") or "")
    items = answer.get("items")
    for item in items if isinstance(items, list) else []:
        point = _point(item)
        if point is not None:
            history.append(point)
    return history


def _text(time: datetime.datetime) -> str:
    return f"{time:%Y-%m-%dT%H:%M:%S}.{time.microsecond // 1000:03}Z"


def _point(item: Any) -> Point | None:
    if not isinstance(item, list) or len(item) not in (2, 4) or not isinstance(item[0], str):
        return None
    try:
        at = datetime.datetime.strptime(item[0], _TIME).replace(tzinfo=datetime.timezone.utc)
    except ValueError:
        return None
    if len(item) == 2 and item[1] is None:
        return Point(at, None, None, None)
    numbers = [float(one) for one in item[1:] if isinstance(one, (int, float)) and not isinstance(one, bool) and math.isfinite(one)]
    if len(numbers) != len(item) - 1:
        return None
    return Point(at, numbers[0], numbers[-2] if len(numbers) == 3 else numbers[0], numbers[-1])
