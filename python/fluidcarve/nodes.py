"""Families of node types, as attributes. Editors know them by nodes.pyi, which `python -m fluidcarve.stubs` writes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

if TYPE_CHECKING:
    from .pipeline import Node


class Family:
    """The node types of one family: `p.seam.pyramid(...)` adds a node of the type seam.pyramid."""

    def __init__(self, add: Callable[..., Node], name: str) -> None:
        self._add = add
        self._name = name

    def __getattr__(self, name: str) -> Callable[..., Node]:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *required, **fields: self._add(f"{self._name}.{name}", *required, **fields)


class Families:
    """All families of node types."""

    def __getattr__(self, name: str) -> Family:
        if name.startswith("_"):
            raise AttributeError(name)
        add: Callable[..., Node] = getattr(self, "_add")
        return Family(add, name)

    def _add(self, type: str, *required: Any, **fields: Any) -> Node:
        raise NotImplementedError
