# SPDX-License-Identifier: Apache-2.0
"""What raised where nobody thought of it: counted, logged once, dropped."""
from __future__ import annotations

import logging
from concurrent.futures import InvalidStateError

from ._calls import Action, Resolve, Tell

log = logging.getLogger("asip")
_MAX_KINDS = 100


class Faults:
    """The faults of one bus: each is counted, and each kind is logged once."""

    def __init__(self) -> None:
        self.count = 0
        self._kinds: set[str] = set()

    def note(self, what: str, fault: BaseException) -> None:
        self.count += 1
        inner = fault.__traceback__.tb_next if fault.__traceback__ else None
        kind = f"{type(fault).__name__} {inner.tb_lineno if inner else ''}"
        if kind not in self._kinds and len(self._kinds) < _MAX_KINDS:
            self._kinds.add(kind)
            log.error("asip: %s was dropped; others of this kind will be without a line here", what, exc_info=fault)

    def tell(self, actions: list[Action]) -> None:
        """Futures and sinks: neither blocks, and none that fails keeps another from being told."""
        for action in actions:
            try:
                if isinstance(action, Tell):
                    action.sink(*action.args)
                elif isinstance(action, Resolve):
                    action.future.set_exception(action.error) if action.error is not None else action.future.set_result(action.result)
            except InvalidStateError:
                pass  # cancelled meanwhile
            except BaseException as fault:  # noqa: BLE001: what a user hangs on a future may raise anything
                self.note("what was told", fault)
