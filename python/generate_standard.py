#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes asip/_standard.py: a class for each standard service model, so that editors and type checkers know their commands.

    python3 generate_standard.py            writes it
    python3 generate_standard.py --check    status 1 where it is not what would be written

asip.service.class_of() makes the same classes at run time; a test compares the two.
"""
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from asip import _model  # noqa: E402
from asip.service import _OWN, identifier_of_class  # noqa: E402

HERE = pathlib.Path(__file__).parent
FILE = HERE / "asip" / "_standard.py"
KINDS = {"integer": "int", "number": "float", "text": "str", "color": "int | str", "list": "Sequence[Any]"}


def annotation(field: _model.Field) -> str:
    kind = KINDS.get(field.type, "Any")
    return kind + " | str" if field.names and field.type == "integer" else kind


def class_text(model: _model.Model, name: str) -> str:
    lines = [f"class {name}(Service):", f'    """{model.title} ({model.name}@{model.version})."""']
    for attribute, command in model.attributes.items():
        if attribute in _OWN:
            continue
        args = "".join(f", {_model.identifier(field.name)}: {annotation(field)}" for field in command.args)
        answers = "Any" if command.answer else "None"
        doc = "\n".join("        " + line if line else "" for line in command.doc.splitlines()).strip()
        signature = f"    def {attribute}(self{args}, *, timeout: float | None = None) -> {answers}:"
        lines += ["", signature, f'        """{doc}', '        """']
    return "\n".join(lines) + "\n"


def module_text(documents: "list[dict]", imports: str, title: str) -> str:
    models = [_model.Model(document) for document in documents]
    classes = "\n\n".join(class_text(model, identifier_of_class(model.name)) for model in models)
    return (f'# SPDX-License-Identifier: Apache-2.0\n"""{title}"""\nfrom __future__ import annotations\n\n'
            f"from typing import Any, Sequence\n\n{imports}\n\n\n{classes}")


def main() -> int:
    documents = [json.loads(file.read_text()) for file in sorted((HERE / "asip" / "models").glob("*.json")) if file.stem != "schema"]
    text = module_text(documents, "from .service import Service",
                       "The standard services, for type checkers: made of the service models by generate_standard.py.")
    if "--check" in sys.argv[1:]:
        return 0 if FILE.read_text() == text else 1
    FILE.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
