# SPDX-License-Identifier: Apache-2.0
"""Writes a module by which editors and type checkers know the commands of services, made of the service models.

    python3 -m asip.stubs [MODEL.json...] > lab.py     the standard services, and those of the files

    from lab import Board
    desk = bus.board("desk", Board)     # desk.servo.write(...) is completed and checked

Nothing of it runs: the package makes the same classes of a board's description (`asip.service.class_of`).
"""
from __future__ import annotations

import json
import pathlib
import sys

from . import _model
from .board import Board
from .service import _OWN, identifier_of_class

_KINDS = {"list": "Sequence[Any]", "object": "Any"}
_HEAD = '''"""The services of boards, for editors and type checkers. `python3 -m asip.stubs` wrote it."""
from __future__ import annotations

from typing import Any, Sequence

import asip
'''


def _class_text(model: _model.Model) -> str:
    lines = [f"class {identifier_of_class(model.name)}(asip.Service):", f"    {json.dumps(f'{model.title} ({model.name}@{model.version}).')}"]
    for attribute, command in model.attributes.items():
        if attribute not in _OWN:
            args = "".join(f", {_model.identifier(field.name)}: {_KINDS.get(field.annotation, field.annotation)}" for field in command.args)
            lines += ["", f"    def {attribute}(self{args}, *, timeout: float | None = None) -> {'Any' if command.answer else 'None'}:",
                      f"        {json.dumps(command.doc)}"]
    return "\n".join(lines) + "\n"


def module_text(models: "list[_model.Model]") -> str:
    named = {model.name: model for model in models}  # a file's goes before the standard one
    services = {_model.identifier(name): identifier_of_class(name) for name in sorted(named)}
    attributes = [f"    {name}: {kind}" for name, kind in services.items() if not hasattr(Board, name)]
    board = ["class Board(asip.Board):", *attributes, "    __getattr__: None  # type: ignore[assignment,misc]  # what is not above is a fault"]
    return "\n\n".join([_HEAD, *(_class_text(named[name]) for name in sorted(named)), "\n".join(board) + "\n"])


def main(files: "list[str]") -> int:
    paths = [*sorted((pathlib.Path(__file__).parent / "models").glob("*.json")), *map(pathlib.Path, files)]
    sys.stdout.write(module_text([_model.Model(json.loads(path.read_text(encoding="utf-8"))) for path in paths if path.stem != "schema"]))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
