"""Writes YAML as a person would."""

from __future__ import annotations

import json
import re
from typing import Any, List, Mapping, Tuple

WIDTH = 120
_PLAIN = re.compile(r"[A-Za-z0-9_./+-](?:[A-Za-z0-9_./+%()$@ -]|(?<! )#)*")
_OTHER_MEANING = re.compile(r"|~|null|.* |[-?] .*|-", re.IGNORECASE)


def flow(value: Any) -> str:
    """A value in one line."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{flow(str(key))}: {flow(each)}" for key, each in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(flow(each) for each in value) + "]"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    text = str(value)
    plain = _PLAIN.fullmatch(text) and not _OTHER_MEANING.fullmatch(text)
    return text if plain else json.dumps(text, ensure_ascii=False)


def fields(entries: Mapping[str, Any], indent: int) -> List[str]:
    """Fields of a map, a line or more each."""
    return [line for name, value in entries.items() for line in _field(name, value, indent)]


def table(entries: Mapping[str, Mapping[str, Any]], indent: int) -> List[str]:
    """Maps by name: a line each, with their braces in one column; over several lines where they are too long or hold a text of several."""
    short = {name: flow(value) for name, value in entries.items() if _fits(name, value, indent)}
    column = max((len(name) for name in short), default=0) + 2
    out: List[str] = []
    for name, value in entries.items():
        if name in short:
            out.append(f"{' ' * indent}{name + ':':<{column}}{short[name]}")
        else:
            out += [f"{' ' * indent}{name}:", *fields(value, indent + 2)]
    return out


def _fits(name: str, value: Mapping[str, Any], indent: int) -> bool:
    several = any(isinstance(each, str) and "\n" in each for each in value.values())
    return not value or (not several and indent + len(name) + 2 + len(flow(value)) <= WIDTH)


def _field(name: str, value: Any, indent: int) -> Tuple[str, ...]:
    start = " " * indent + f"{name}: "
    lines = value.split("\n") if isinstance(value, str) else []
    if len(lines) > 1 and not lines[0].startswith(" ") and lines[-1] == "" and lines[-2:-1] != [""]:
        return (start + "|", *(" " * (indent + 2) + line if line else "" for line in lines[:-1]))
    return (start + flow(value),)
