"""What the program answers, as data. `raw` is all of it, as pipelines/FORMATS.md describes it."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, Dict, List, Mapping, Type, TypeVar, cast

from .errors import Problem

T = TypeVar("T")


def taken_from(kind: Type[T], answer: Mapping[str, Any], **more: Any) -> T:
    """A dataclass from the fields of the same names, and more."""
    names = {each.name for each in fields(cast(Any, kind))}
    return kind(**{name: value for name, value in answer.items() if name in names and name not in more}, **more)


@dataclass(frozen=True)
class Event:
    """What a run tells while it runs: `event` is progress, warning, failure, result or done. `fraction` is the share of the work
    that is done by then, 0 to 1."""

    event: str
    text: str = ""
    fraction: float = 0
    passes: int = 0
    elapsed_s: float = 0
    left_s: float = 0
    at: str = ""


@dataclass(frozen=True)
class NodeRun:
    """What a node did: frames that it delivered, how many of them came from the work folder, seconds over all threads."""

    type: str
    frames: int = 0
    cached: int = 0
    wall_s: float = 0
    bytes: int = 0


@dataclass(frozen=True)
class Result:
    """A finished run. With `keep_going`, `failures` has the frames that failed, and `exit` is 4."""

    frames: List[int]
    exit: int
    wall_s: float
    peak_rss_bytes: int
    nodes: Dict[str, NodeRun]
    failures: List[Problem]
    warnings: List[Problem]
    seams: Dict[str, Any] = field(default_factory=dict)
    grids: Dict[str, Any] = field(default_factory=dict)
    raw: Dict[str, Any] = field(default_factory=dict, repr=False)


@dataclass(frozen=True)
class PlannedNode:
    """A node of a plan: frames that the run needs of it, how many of them are in the work folder, why it runs."""

    type: str
    frames: int
    cached: int
    why: str = ""


@dataclass(frozen=True)
class Plan:
    """What a run will do. Estimates of time (seconds), memory and disk (bytes) are 0 where nothing is known."""

    pipeline: str
    frames: List[int]
    nodes: Dict[str, PlannedNode]
    seconds: float
    bytes: int
    disk: int
    cores: int
    unmeasured: List[str] = field(default_factory=list)
    steps: List[Dict[str, Any]] = field(default_factory=list)
    raw: Dict[str, Any] = field(default_factory=dict, repr=False)


@dataclass(frozen=True)
class Inspection:
    """What is in files: an entry for each file, sequence and folder."""

    files: List[Dict[str, Any]]
    sequences: List[Dict[str, Any]]
    folders: List[Dict[str, Any]]
    notes: List[str]


@dataclass(frozen=True)
class Difference:
    """How two sequences differ: `result` is same, within, warning or different."""

    a: str
    b: str
    result: str
    sequences: List[Dict[str, Any]]
    alone: List[Dict[str, Any]]
    failures: List[Any]


@dataclass(frozen=True)
class Explanation:
    """What made a file."""

    version: str = ""
    pipeline: str = ""
    values: str = ""
    seams: str = ""
    command: str = ""


@dataclass(frozen=True)
class Farm:
    """A job of a farm, and its steps. `again` is the command that makes it again."""

    name: str
    pipeline: str
    folder: str
    again: str
    steps: List[Dict[str, Any]]


def result_of(raw: Mapping[str, Any]) -> Result:
    """A report as a result."""
    told = {name: [Problem(each["message"], node=each.get("node", ""), frame=each.get("frame")) for each in raw[name]] for name in ("failures", "warnings")}
    return taken_from(Result, raw, nodes={name: taken_from(NodeRun, each) for name, each in raw["nodes"].items()}, raw=dict(raw), **told)


def plan_of(raw: Mapping[str, Any]) -> Plan:
    """The answer of `plan --json` as a plan."""
    nodes = {name: taken_from(PlannedNode, each) for name, each in raw["nodes"].items()}
    return taken_from(Plan, raw, nodes=nodes, raw=dict(raw))
