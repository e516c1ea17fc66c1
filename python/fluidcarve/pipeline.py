"""Writes pipelines."""

from __future__ import annotations

import difflib
import dis
import os
import sys
from types import FrameType
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

from . import yaml_text
from .nodes import Families
from .program import call_json, node_types, words_of


class Output:
    """An output of a node, or a grid of its volume: what inputs of other nodes take."""

    def __init__(self, node: Node, name: str) -> None:
        self.node = node
        self.name = name

    def __str__(self) -> str:
        return f"{self.node}.{self.name}"


class Param:
    """A param of a pipeline, as a value of fields; inside a text, `f"out/{count}.vdb"`, it is inserted as text."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __str__(self) -> str:
        return f"${{{self.name}}}"


class Node:
    """A node of a pipeline. As a value of an input it stands for its first output; its attributes are its other outputs.

    `node["GRID"]` is an output whose name is no Python name, such as `vel.x`.
    """

    def __init__(self, pipeline: Pipeline, name: str, type: str, fields: Mapping[str, Any]) -> None:
        self._pipeline = pipeline
        self._name = name
        self._type = type
        self._fields: Dict[str, Any] = dict(fields)

    def __getattr__(self, name: str) -> Output:
        if name.startswith("_"):
            raise AttributeError(name)
        return Output(self, name)

    def __getitem__(self, name: str) -> Output:
        return Output(self, name)

    def __str__(self) -> str:
        return self._name

    def __repr__(self) -> str:
        return f"<node {self._name}: {self._type}>"


Source = Union[Node, Output, str]


class Pipeline(Families):
    """A pipeline: nodes, the params that a shot may change, and frames.

    `p.FAMILY.NAME(...)` adds a node of the type FAMILY.NAME. Inputs take nodes and their outputs, parameters take values or
    params. What the type requires may be given by position, inputs first. A node is named after the variable that it is assigned to, else after its type; `name=` names it otherwise.

    frames   a frame set such as "1001-1084", a number, or "auto"
    extends  the path of a pipeline that this one changes; `load` sets it
    doc      comment lines at the top
    env      environment variables that ${NAME} may name
    plugins  files with node types of their own
    """

    def __init__(self, frames: Union[str, int, Param, None] = None, *, extends: Optional[str] = None, doc: str = "", env: Sequence[str] = (),
                 plugins: Sequence[str] = (), provenance: Optional[bool] = None) -> None:
        self.frames = frames
        self.extends = extends
        self.doc = doc
        self.env = list(env)
        self.plugins = list(plugins)
        self.provenance = provenance
        self._params: Dict[str, Dict[str, Any]] = {}
        self._nodes: Dict[str, Optional[Node]] = {}
        self._below: Dict[str, Node] = {}  # of the pipeline that this one extends
        self._params_below: List[str] = []

    def param(self, name: str, type: str, default: Any = None, *, min: Optional[float] = None, max: Optional[float] = None,
              doc: str = "") -> Param:
        """Declares what a shot may change. `type` is bool, int, float, vector, string, path or count."""
        stated = {"type": type, "default": default, "min": min, "max": max, "doc": doc or None}
        self._params[name] = {key: value for key, value in stated.items() if value is not None}
        return Param(name)

    def set(self, **params: Any) -> None:
        """Gives params other defaults: `p.set(count=-20)`."""
        known = list(dict.fromkeys([*self._params_below, *self._params]))
        for name in params:
            if name not in known:
                raise TypeError(f"there is no param '{name}'{_near(name, known)}")
        for name, value in params.items():
            self._params.setdefault(name, {})["default"] = value

    def change(self, node: Union[Node, str], **fields: Any) -> Node:
        """Gives fields of a node other values; None takes a field away."""
        found = self[str(node)]
        self._require_fields(found._type, fields)
        mine = self._nodes.setdefault(found._name, Node(self, found._name, found._type, {}))
        assert mine is not None
        mine._fields.update(fields)
        return mine

    def type_of(self, node: Union[Node, str]) -> str:
        """The type of a node."""
        return self[str(node)]._type

    def fields(self, node: Union[Node, str]) -> Dict[str, Any]:
        """What is stated of a node: by the pipeline that this one extends, as the text that `check -v` prints, and by this one."""
        name = self[str(node)]._name
        below, here = self._below.get(name), self._nodes.get(name)
        return {**(below._fields if below else {}), **(here._fields if here else {})}

    def nodes(self) -> List[Node]:
        """All nodes, in order."""
        merged: Dict[str, Optional[Node]] = {**self._below, **self._nodes}
        return [node for node in merged.values() if node is not None]

    def __getitem__(self, name: str) -> Node:
        for node in self.nodes():
            if node._name == name:
                return node
        raise KeyError(f"there is no node '{name}'{_near(name, [node._name for node in self.nodes()])}")

    def __delitem__(self, name: str) -> None:
        """Takes a node away."""
        self._nodes.pop(self[name]._name, None)
        if name in self._below:
            self._nodes[name] = None

    def text(self, folder: Optional[str] = None) -> str:
        """The pipeline file. `folder` is where it will lie; relative paths of `extends` start there."""
        lines = ["# " + line if line else "#" for line in self.doc.splitlines()]
        if self.extends is None:
            lines.append("fluidcarve: 1")
        else:
            path = self.extends if folder is None else os.path.relpath(self.extends, folder)
            lines += ["fluidcarve: 1", f"extends: {yaml_text.flow(path)}"]
        for name, listed in (("plugins", self.plugins), ("env", self.env)):
            if listed:
                lines.append(f"{name}: {yaml_text.flow(listed)}")
        if self.provenance is not None:
            lines.append(f"provenance: {yaml_text.flow(self.provenance)}")
        if self._params:
            lines += ["", "params:", *yaml_text.table({name: _written(each) for name, each in self._params.items()}, 2)]
        if self.frames is not None:
            lines += ["", f"frames: {yaml_text.flow(_written(self.frames))}"]
        if self._nodes:
            lines += ["", "nodes:"]
            entries = {name: self._entry(node) for name, node in self._nodes.items()}
            lines += yaml_text.table({name: entry for name, entry in entries.items() if entry is not None}, 2)
            lines += [f"  {name}:" for name, entry in entries.items() if entry is None]
        elif self.extends is None:
            lines += ["", "nodes: {}"]
        return "\n".join(lines) + "\n"

    def save(self, path: str) -> None:
        """Writes the pipeline file. It appears whole or not at all."""
        path = os.fspath(path)
        folder = os.path.dirname(os.path.abspath(path))
        os.makedirs(folder, exist_ok=True)
        unfinished = f"{path}.{os.getpid()}.part"
        try:
            with open(unfinished, "w", encoding="utf-8") as file:
                file.write(self.text(folder))
            os.replace(unfinished, path)
        except BaseException:
            if os.path.exists(unfinished):
                os.remove(unfinished)
            raise

    def _add(self, type: str, *required: Any, name: Optional[str] = None, **fields: Any) -> Node:
        types = node_types(tuple(self.plugins), os.environ.get("FLUIDCARVE"))
        if type not in types:
            raise AttributeError(f"there is no node type '{type}'{_near(type, list(types))}")
        spec = types[type]
        needed = [each["name"] for each in spec["inputs"] if not each["arity"].startswith("optional")]
        needed += [each["name"] for each in spec["params"] if each.get("required")]
        if len(required) > len(needed):
            raise TypeError(f"{type} takes {len(needed)} values by position, {', '.join(needed)}; name the others")
        fields = {**dict(zip(needed, required)), **fields}
        self._require_fields(type, fields)
        missing = [each for each in needed if each not in fields]
        if missing:
            raise TypeError(f"{type} needs {', '.join(repr(each) for each in missing)}")
        if name is not None and name in {node._name for node in self.nodes()}:
            raise ValueError(f"there is a node '{name}' already; give this one another name")
        wanted = name or _assigned_to(sys._getframe(2)) or type.rpartition(".")[2]
        node = Node(self, self._free(wanted), type, fields)
        self._nodes[node._name] = node
        return node

    def _free(self, name: str) -> str:
        taken = {node._name for node in self.nodes()}
        out, number = name, 2
        while out in taken:
            out, number = f"{name}_{number}", number + 1
        return out

    def _require_fields(self, type: str, fields: Mapping[str, Any]) -> None:
        spec = node_types(tuple(self.plugins), os.environ.get("FLUIDCARVE"))[type]
        known = [each["name"] for each in spec["inputs"] + spec["params"]] + ["doc", "cache"]
        for name in fields:
            if name not in known:
                raise TypeError(f"{type} has no '{name}'{_near(name, known)}")

    def _entry(self, node: Optional[Node]) -> Optional[Dict[str, Any]]:
        """What the file says of a node; None: that it is taken away."""
        if node is None:
            return None
        below = self._below.get(node._name)
        head = {} if below is not None and below._type == node._type else {"type": node._type}
        return {**head, **{name: _written(value) for name, value in node._fields.items()}}


def load(path: str, **options: Any) -> Pipeline:
    """A pipeline that changes the one of a file: its nodes are there, and what is changed, added or taken away is saved as a
    few lines that extend the file.

    Options are those of `fluidcarve check`, as keywords, such as `allow_plugins=True`. Raises Error with all problems of the file.
    """
    path = os.fspath(path)
    values = call_json(["check", path, "--verbose", *words_of(options)])
    out = Pipeline(extends=os.path.abspath(path))
    out._params_below = list(values["params"])
    for name, entry in values["nodes"].items():
        stated = {key: each["value"] for key, each in entry.items() if key != "type" and each["from"] != "default"}
        out._below[name] = Node(out, name, entry["type"]["value"], stated)
    return out


def _written(value: Any) -> Any:
    """A value as the file states it."""
    if isinstance(value, (Node, Output, Param, os.PathLike)):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): _written(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_written(each) for each in value]
    return value


def _near(name: str, known: List[str]) -> str:
    near = difflib.get_close_matches(name, known, 1)
    return f"; did you mean '{near[0]}'?" if near else f"; there are {', '.join(known)}" if 0 < len(known) < 40 else ""


def _assigned_to(frame: FrameType) -> str:
    """The variable that takes the result of the call that a frame is in; empty if none does."""
    after = next((each for each in dis.get_instructions(frame.f_code) if each.offset > frame.f_lasti), None)
    if after is None or not after.opname.startswith("STORE_"):
        return ""
    name = after.argval[0] if isinstance(after.argval, tuple) else after.argval
    return name if isinstance(name, str) and name.isidentifier() else ""
