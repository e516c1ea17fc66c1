"""Writes nodes.pyi, by which editors and type checkers know all node types: `python -m fluidcarve.stubs > python/fluidcarve/nodes.pyi`."""

from __future__ import annotations

import json
import keyword
import textwrap
from typing import Any, Dict, List

from .program import call, node_types

_HEAD = '''\
# Written by `python -m fluidcarve.stubs` from the program's own node types.
from typing import Any, Literal, Mapping, Sequence

from .pipeline import Node, Output, Param, Source

'''
_ARITY = {"one": "Source", "list": "Source | Sequence[Source]", "named": "Mapping[str, Source]"}


def stubs() -> str:
    """The text of nodes.pyi."""
    types = node_types()
    schema = json.loads(call(["schema"])[1])["definitions"]
    families: Dict[str, List[str]] = {}
    out = _HEAD
    for name in types:
        family, _, word = name.partition(".")
        families.setdefault(family, []).append(word)
    for family, words in families.items():
        for word in words:
            out += _node_class(types[f"{family}.{word}"])
        out += f"\nclass {_capital(family)}Family:\n"
        out += "".join(_method(types[f"{family}.{word}"], schema[f"{family}.{word}"]["properties"]) for word in words)
    out += "\nclass Families:\n"
    for family in families:
        out += f"    @property\n    def {family}(self) -> {_capital(family)}Family: ...\n"
    return out


def _capital(name: str) -> str:
    return "".join(part.capitalize() for part in name.replace(".", "_").split("_"))


def _node_class(spec: Dict[str, Any]) -> str:
    body = "".join(f"    {each['name']}: Output\n" for each in spec["outputs"] if not keyword.iskeyword(each["name"]))
    return f"\nclass {_capital(spec['name'])}(Node):\n{body or '    ...' + chr(10)}"


def _method(spec: Dict[str, Any], properties: Dict[str, Any]) -> str:
    needed: List[str] = []
    free = ["name: str = ..."]
    for each in spec["inputs"]:
        arity = each["arity"]
        kind = _ARITY[arity.replace("optional ", "") if arity != "optional" else "one"]
        (free if arity.startswith("optional") else needed).append(f"{each['name']}: {kind}{' = ...' if arity.startswith('optional') else ''}")
    for each in spec["params"]:
        kind = _value(properties[each["name"]])
        (needed if each.get("required") else free).append(f"{each['name']}: {kind}{'' if each.get('required') else ' = ...'}")
    free += ["doc: str = ...", "cache: bool = ..."]
    arguments = "".join(f"        {each},\n" for each in [*needed, "*", *free])
    doc = textwrap.indent("\n".join(textwrap.wrap(spec["doc"], 110)), " " * 8).replace("\\", "\\\\")
    word = spec["name"].partition(".")[2]
    return f'    def {word}(\n        self,\n{arguments}    ) -> {_capital(spec["name"])}:\n        """\n{doc}\n        """\n'


def _value(schema: Dict[str, Any]) -> str:
    """The Python type of a parameter's values. A param may stand for any of them."""
    kinds = sorted(_kinds(schema))
    literals = [kind for kind in kinds if kind.startswith('"')]
    if literals and "str" not in kinds:
        kinds = [kind for kind in kinds if kind not in literals] + [f"Literal[{', '.join(literals)}]"]
    return " | ".join([kind for kind in kinds if not kind.startswith('"')] + ["Param"])


def _kinds(schema: Dict[str, Any]) -> List[str]:
    if "$ref" in schema:
        return []  # a text with ${name}, or a number as a text
    for key in ("anyOf", "allOf", "oneOf"):
        if key in schema:
            return sorted({kind for each in schema[key] for kind in _kinds(each)})
    if "const" in schema or "enum" in schema:
        values = schema.get("enum", [schema.get("const")])
        if set(values) == {"true", "false"}:
            return []
        return [json.dumps(each) for each in values]
    kinds = schema.get("type", [])
    named = {"boolean": "bool", "integer": "int", "number": "float", "string": "str", "object": "Mapping[str, Any]"}
    out = []
    for kind in [kinds] if isinstance(kinds, str) else kinds:
        if kind == "array":
            out.append(f"Sequence[{_value(schema.get('items', {})) if schema.get('items') else 'Any'}]")
        elif kind in named:
            out.append(named[kind])
    return out


if __name__ == "__main__":
    print(stubs(), end="")
