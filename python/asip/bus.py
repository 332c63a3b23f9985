# SPDX-License-Identifier: Apache-2.0
"""A connection to a bus."""
from __future__ import annotations

import contextlib
import fnmatch
import re
import threading
import time
import weakref

from . import _wait, errors
from ._callbacks import takes
from ._engine import Engine
from ._model import Model, ModelError
from ._topics import valid_board
from .board import Board
from .service import Watch
from .settings import Settings, announced, find

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable, TypeVar, overload
    B = TypeVar("B", bound=Board)

_REGISTRY_SECONDS = 1.0
_SEARCH_SECONDS = 1.0
_KEPT_PATIENCE = 0.15  # as asipctl has it
_ASK_AGAIN_SECONDS = 60.0
_MAX_MODELS = 4096


class Bus:
    """A bus, connected: use it with `with`, or call `close()`. All methods may be called from any thread.

    `timeout` is the limit in seconds of each call that is given none.
    """

    def __init__(self, settings: Settings, *, timeout: float = 5.0, by: str | None = None, link: Any = None):
        self.timeout = timeout
        self._engine = Engine(settings, by, link) if link else Engine(settings, by)
        self._boards: dict[str, Board] = {}
        self._models: dict[str, Model] = {}  # by reference: those that a registry told
        self._not_told: dict[str, float] = {}  # until when no registry is asked again
        self._ended = threading.Event()
        self._end = weakref.finalize(self, self._engine.later, self._engine.close)
        self._end.atexit = False

    @property
    def settings(self) -> Settings:
        """Where the bus is, and where that was read."""
        return self._engine.settings

    @property
    def connected(self) -> bool:
        return bool(self._engine.session.ready)

    @property
    def on_error(self) -> Callable[[BaseException], None] | None:
        """Called with each exception that a function given to `on_...` raises; it is logged in any case."""
        return self._engine.dispatcher.on_error

    @on_error.setter
    def on_error(self, function: Callable[[BaseException], None] | None) -> None:
        self._engine.dispatcher.on_error = function

    # Boards -------------------------------------------------------------------------------------------------------------

    if TYPE_CHECKING:
        @overload
        def board(self, name: str, kind: type[B], *, timeout: float | None = ...) -> B: ...
        @overload
        def board(self, name: str, *, timeout: float | None = ...) -> Board: ...

    def board(self, name: str, kind: type[Any] = Board, *, timeout: float | None = None) -> Any:
        """The board of this name, when it is online. NotThere where it is not within `timeout`, with the reason or the nearest
        name. `kind`: a subclass of Board, as `python3 -m asip.stubs` writes one."""
        if not valid_board(name):
            raise errors.Invalid(f"{name!r} cannot be the name of a board: 1 to 64 of A-Z a-z 0-9 . _ -", board=name)
        seconds = self._seconds(timeout)
        end = time.monotonic() + seconds
        self._engine.wait_connected(seconds)
        board = self._of(name, kind)
        board._follow()
        changed = self._engine.changed
        with changed:
            _wait.until(changed, lambda: board.online and board.description or self._engine.closed, max(0.0, end - time.monotonic()))
        self._engine.check_open()
        if not board.online or not board.description:
            if board.status == "unknown":
                with contextlib.suppress(errors.Disconnected):
                    self._know_all(_REGISTRY_SECONDS)
                raise errors.NotThere(self._engine.peek(lambda session: session.catalogue.unknown(name)), board=name, reason="board-not-there")
            away = f'{board.status}; bus.boards("{name}")[0] is that board with its history'
            why = away if not board.online else "online, but its agent published no description"
            raise errors.NotThere(f"{name} is {why}", board=name, reason="board-not-there")
        self._learn([board], end)
        return board

    def _learn(self, boards: Iterable[Board], end: float) -> None:
        """Asks a registry for the models that these boards refer to and the package does not have."""
        now = time.monotonic()
        wanted = {one for board in boards for one in board._unknown_models() if self._not_told.get(one, now) <= now}
        if not wanted:
            return
        if len(self._models) + len(self._not_told) > _MAX_MODELS:
            self._models, self._not_told = {}, {}
        self._not_told.update(dict.fromkeys(wanted, now + _ASK_AGAIN_SECONDS))
        kinds = sorted({one.partition("@")[0] for one in wanted})
        for first in range(0, len(kinds), 32):
            query: dict[str, Any] = {"find": "models", "kind": kinds[first:first + 32]}
            while True:
                try:
                    answer = self.query(query, timeout=max(0.05, min(_REGISTRY_SECONDS, end - time.monotonic())))
                except errors.Error:  # none answers, or it is of a version that tells no models: such services have no commands here
                    return
                for item in _items(answer):
                    self._told_model(item)
                if not answer.get("cursor"):
                    break
                query["cursor"] = answer["cursor"]
        for board in boards:
            board._described = ("", -2)  # its services are made again, of what is known now

    def _told_model(self, item: Any) -> None:
        try:
            model = Model(item)
        except ModelError:
            return
        reference = f"{model.name}@{model.version}"
        self._models[reference] = model
        self._not_told.pop(reference, None)

    def _seconds(self, timeout: float | None) -> float:
        return _wait.seconds(self.timeout if timeout is None else timeout)

    def _of(self, name: str, kind: type[Any] = Board) -> Any:
        if not isinstance(self._boards.get(name), kind):
            self._boards[name] = kind(self, name)
        return self._boards[name]

    def boards(self, pattern: str = "*", *, labels: str | None = None, timeout: float | None = None) -> list[Board]:
        """The boards that there are, by name; `pattern` with `*` and `?`, `labels` a selector such as `room=lab,!old`. A registry is
        asked; where there is none, what the broker keeps. A board's state is that of this moment, until `bus.board()` follows it."""
        seconds = self._seconds(timeout)
        self._engine.wait_connected(seconds)
        names = self._ask_registry(pattern, labels, seconds)
        if names is None:
            if labels is not None:
                raise errors.NotThere("labels are chosen by a registry, and none answered", reason="no-registry")
            names = [name for name in self._know_all(seconds) if fnmatch.fnmatchcase(name, pattern.replace("[", "[[]"))]
        boards = [self._of(name) for name in sorted(names)]
        self._learn(boards, time.monotonic() + seconds)
        return boards

    def _ask_registry(self, pattern: str, labels: str | None, seconds: float) -> list[str] | None:
        query: dict[str, Any] = {"find": "boards", "full": True, "limit": 500}
        query.update({"board": pattern} if pattern != "*" else {}, **({"labels": labels} if labels is not None else {}))
        names: list[str] = []
        while True:
            try:
                answer = self.query(query, timeout=min(seconds, _REGISTRY_SECONDS) if not names else seconds)
            except errors.NotThere:
                return None
            for item in _items(answer):
                if valid_board(item.get("board")):
                    self._engine.peek(lambda session: session.catalogue.on_listed(item, time.monotonic()))
                    names.append(item["board"])
            if not answer.get("cursor"):
                return names
            query["cursor"] = answer["cursor"]

    def _know_all(self, seconds: float) -> list[str]:
        """The boards that the broker keeps, all of them; Disconnected where they did not come within `seconds`."""
        engine = self._engine
        engine.do(lambda session, now: session.look_at("+"))
        try:
            self._wait_told(seconds, "boards")
            names: list[str] = engine.peek(lambda session: session.catalogue.followed())
            return names
        finally:
            engine.do(lambda session, now: session.look_away("+"))

    def _wait_told(self, seconds: float, what: str) -> None:
        """Until what the broker keeps for the last subscriptions has come."""
        engine, end = self._engine, time.monotonic() + seconds
        while True:
            try:
                _wait.result(engine.ask(lambda session, now: session.mark(now, max(0.0, end - now))).future)
                break
            except errors.Unproven:  # on a connection that broke
                continue
            except errors.NotThere:
                raise errors.Disconnected(f"the broker did not tell within {seconds:g} s which {what} there are", reason="no-answer") from None
        told = time.monotonic()
        with engine.changed:  # some brokers send what they keep in their own time
            while time.monotonic() < end and _wait.until(engine.changed, lambda: engine.session.kept_at > told, _KEPT_PATIENCE):
                told = engine.session.kept_at

    def watch(self, function: Callable[..., Any]) -> Watch:
        """Calls `function(board, state)` after each change of a board's state, in the thread `asip-callbacks`. It begins with the
        boards that there are. `board` is a Board."""
        count, engine = takes(function, 2), self._engine
        seen: dict[str, str] = {}
        this = weakref.ref(self)

        def changed(name: str) -> None:
            bus = this()
            if bus is None:
                return
            entry = engine.session.catalogue.boards.get(name)
            state = entry.state if entry else "forgotten"
            if seen.get(name) != state and state != "unknown":
                seen[name] = state
                engine.dispatcher.put(function, (bus._of(name), state)[:count])
        engine.check_open()
        engine.peek(lambda session: session.watch_boards(changed))
        engine.do(lambda session, now: session.look_at("+"))

        def cancel() -> None:
            engine.peek(lambda session: session.unwatch_boards(changed))
            if not engine.closed and not engine.forked:
                engine.do(lambda session, now: session.look_away("+"))
        return Watch(cancel)

    # Links --------------------------------------------------------------------------------------------------------------

    def link(self, /, source: str, target: str, when: str = "follows", *, name: str | None = None, timeout: float | None = None, **more: Any) -> str:
        """Lets `source` switch `target`, both BOARD/PROPERTY, without this program: `bus.link("desk/io/2", "lamp/io/13", "toggles")`.
        The target's agent keeps it. `more` has the members of docs/links.md (`level`, `value`, `else_`, `for_` ...). Returns its name."""
        board, _, target_id = target.partition("/")
        name = name or re.sub(r"[^A-Za-z0-9._-]+", "-", f"{source}-{target_id}")
        members = {key.rstrip("_"): value for key, value in more.items()}
        self._link(board, {"set": {"name": name, "from": source, "to": target_id, "when": when, **members}}, timeout)
        return name

    def unlink(self, board: str, name: str, *, timeout: float | None = None) -> None:
        """Removes a link of a board."""
        self._link(board, {"remove": name}, timeout)

    def _link(self, board: str, members: dict[str, Any], timeout: float | None) -> None:
        if not valid_board(board):
            raise errors.Invalid(f"no board can be called {board!r}", reason="invalid")
        seconds = self._seconds(timeout)
        _wait.result(self._engine.ask(lambda session, now: session.link(now, board, members, seconds)).future)

    # All boards at once -------------------------------------------------------------------------------------------------

    def stop(self, boards: Iterable[str] | None = None, *, timeout: float | None = None) -> None:
        """Makes boards safe, all of them where none are named. It asks every board before it raises: the error names each that
        did not confirm."""
        seconds = self._seconds(timeout)
        boards = [boards] if isinstance(boards, str) else boards
        names = list(boards) if boards is not None else [one.name for one in self.boards() if one.state in ("online", "sleeping")]
        calls = [self._engine.stop(name, seconds) for name in names]
        failed = []
        for name, call in zip(names, calls):
            try:
                _wait.result(call.future)
            except errors.Error as fault:
                failed.append(f"{name} ({fault})")
        if failed:
            raise errors.Unproven(f"not stopped for certain: {'; '.join(failed)}", command="stop")

    def query(self, query: dict[str, Any], *, timeout: float | None = None) -> dict[str, Any]:
        """Asks a registry (docs/service-bus.md, "The registry") and returns its answer. NotThere where none answers."""
        seconds = self._seconds(timeout)
        if not isinstance(query, dict):
            raise errors.Invalid(f'a query is a dict, {{"find": "boards"}}, not {query!r}', reason="invalid")
        answer: dict[str, Any] = _wait.result(self._engine.ask(lambda session, now: session.query(now, dict(query), seconds)).future)
        return answer

    def run(self, seconds: float | None = None) -> None:
        """Waits, while callbacks go on, until Ctrl-C, a SIGTERM, `close()` in another thread, or for `seconds`."""
        import signal
        if seconds is not None:
            _wait.seconds(seconds, "seconds", most=1e9)
        end = None if seconds is None else time.monotonic() + seconds
        before = None
        if threading.current_thread() is threading.main_thread():
            before = signal.signal(signal.SIGTERM, lambda *_: self._ended.set())
        try:
            while not self._ended.is_set() and not self._engine.closed:
                left = 0.2 if end is None else min(0.2, end - time.monotonic())
                if left <= 0:
                    return
                self._ended.wait(left)
        except KeyboardInterrupt:
            pass
        finally:
            if before is not None:
                signal.signal(signal.SIGTERM, before)

    def close(self) -> None:
        """Ends the connection within a second or two. What waits ends by Closed, what was sent by Unproven."""
        self._end.detach()
        self._ended.set()
        self._engine.close()

    def __enter__(self) -> "Bus":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        where = ", ".join(f"{one.host}:{one.port}" for one in self.settings.brokers)
        return f"<asip bus {where}: {'connected' if self.connected else self._engine.session.trouble or 'not connected'}>"

    def _repr_html_(self) -> str:
        import html
        rows = "".join(f"<tr><td>{html.escape(one.name)}</td><td>{html.escape(one.status)}</td><td>{html.escape(' '.join(one.services))}</td></tr>"
                       for one in self.boards())
        return f"<table><tr><th>board</th><th>state</th><th>services</th></tr>{rows}</table>"


def _items(answer: dict[str, Any]) -> list[dict[str, Any]]:
    items = answer.get("items")
    return [item for item in items if isinstance(item, dict)] if isinstance(items, list) else []


def connect(broker: str | None = None, *, credentials: str | None = None, user: str | None = None, password: str | None = None,
            ca: str | None = None, root: str | None = None, timeout: float = 5.0, by: str | None = None) -> Bus:
    """Connects to a bus, and waits at most `timeout` seconds for it: Disconnected says why there is none.

    broker: `HOST`, `HOST:PORT`, `mqtts://HOST`, or several with commas. Without it: ASIP_BROKER and the like, a bus chosen by
        `~/.config/asip/asipctl.conf`, else 127.0.0.1, else the one broker that is announced on the local network (asip.settings).
    credentials: a file made by `asipctl secure`, with all of it.
    by: the name that boards' histories show for what this program does; the login name where none is given.
    """
    _wait.seconds(timeout)
    settings = find(broker, credentials=credentials, user=user, password=password, ca=ca, root=root)
    if settings.is_default:
        settings = announced(settings, min(_SEARCH_SECONDS, timeout))
    bus = Bus(settings, timeout=timeout, by=by or _login_name())
    try:
        bus._engine.wait_connected(timeout)
    except BaseException:
        bus.close()
        raise
    return bus


def _login_name() -> str | None:
    import getpass
    try:
        return getpass.getuser()[:64]
    except Exception:  # noqa: BLE001: an account without a name
        return None
