"""The process that runs a script for nodes in Python. The program starts it (nodes/python/worker.h).

Requests and answers are lines of JSON on a socket; arrays lie in two pieces of shared memory, one that the program writes and one
that the worker writes.
"""

from __future__ import annotations

import ast
import faulthandler
import fcntl
import importlib.machinery
import importlib.util
import inspect
import json
import mmap
import os
import resource
import socket
import sys
import traceback
from types import ModuleType
from typing import Any, Dict, List, Mapping, Optional, Set

SOCKET, GIVEN, ANSWERED, LIFE = 3, 4, 5, 6
MOST_WARNED = 1000  # characters
F_SETSIG, SIGKILL = 10, 9
PACKAGE = os.path.dirname(os.path.abspath(__file__))


class At:
    """Where a call is: `frame`, its number; `time`, its place in the sequence, from 0; `frames`, the numbers of all; `work`, the work folder."""

    def __init__(self, worker: "Worker", frame: int, time: int, frames: List[int], work: str) -> None:
        self._worker = worker
        self.frame = frame
        self.time = time
        self.frames = frames
        self.work = work

    def warn(self, text: str) -> None:
        """Shows a warning at the end of the run, and in its report."""
        self._worker.tell({"warn": str(text)[:MOST_WARNED]})

    def progress(self, fraction: float) -> None:
        """Tells how much of the work is done, 0 to 1; of functions that work on all frames."""
        self._worker.tell({"progress": float(fraction)})


class Memory:
    """Shared memory of any size."""

    def __init__(self, file: int) -> None:
        self._file = file
        self._map: Optional[mmap.mmap] = None

    def of(self, bytes: int) -> mmap.mmap:
        """The memory, of at least so many bytes."""
        bytes = max(bytes, 1)  # nothing can't be mapped
        if self._map is None or len(self._map) < bytes:
            if os.fstat(self._file).st_size < bytes:
                os.ftruncate(self._file, (bytes // mmap.PAGESIZE + 1) * mmap.PAGESIZE)
            self._map = mmap.mmap(self._file, os.fstat(self._file).st_size)
        return self._map


class _Source(importlib.machinery.SourceFileLoader):
    """Loads modules of the script's folder from their text, never from what was compiled before, which may be of another text."""

    def path_stats(self, path: Any) -> Mapping[str, Any]:
        raise OSError


class Worker:
    def __init__(self) -> None:
        self.channel = socket.socket(fileno=SOCKET)
        self.given = Memory(GIVEN)
        self.answered = Memory(ANSWERED)
        self.frames: List[int] = []
        self.found: Dict[str, Any] = {}
        self.path = ""
        self.script: Optional[ModuleType] = None

    def tell(self, message: Mapping[str, Any]) -> None:
        # Characters that no file of UTF-8 can hold become question marks.
        self.channel.sendall(json.dumps(message, ensure_ascii=False, allow_nan=False).encode("utf-8", "replace") + b"\n")

    def answer(self, request: Mapping[str, Any]) -> Mapping[str, Any]:
        if "memory" in request:
            hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
            resource.setrlimit(resource.RLIMIT_DATA, (request["memory"] if hard == resource.RLIM_INFINITY else min(request["memory"], hard), hard))
        if "open" in request:
            return self.open(request["open"])
        if "look" in request:
            return self.look(request["look"], request["inputs"], request["params"], request["offered"])
        return self.call(request)

    def open(self, path: str) -> Mapping[str, Any]:
        """Imports the script."""
        from . import grids  # noqa: F401  tells of a missing numpy now

        self.path = path
        folder = os.path.dirname(path)
        finder = importlib.machinery.FileFinder.path_hook((importlib.machinery.ExtensionFileLoader, importlib.machinery.EXTENSION_SUFFIXES),
                                                          (_Source, importlib.machinery.SOURCE_SUFFIXES))

        def hook(entry: str) -> Any:
            if entry != folder and not entry.startswith(folder + os.sep):
                raise ImportError
            return finder(entry)

        sys.path_hooks.insert(0, hook)
        sys.path_importer_cache.clear()
        sys.path.insert(0, folder)
        name = os.path.splitext(os.path.basename(path))[0]
        spec = importlib.util.spec_from_file_location(name, path, loader=_Source(name, path))
        assert spec is not None and spec.loader is not None
        self.script = importlib.util.module_from_spec(spec)
        # A name of its own, unless it would hide a module that others need.
        sys.modules.setdefault(name, self.script)
        self.tell({"progress": 0})  # from here on the script runs
        spec.loader.exec_module(self.script)
        return {}

    def look(self, function: str, inputs: List[str], params: List[str], offered: List[str]) -> Mapping[str, Any]:
        """What the script depends on, what is wrong with a function's arguments, and which of the offered ones it takes."""
        version = getattr(self.script, "VERSION", "")
        return {"files": local_imports(self.path), "version": str(version), "faults": self.faults(function, inputs, params, offered),
                "gathers": callable(getattr(self.script, "add", None)), "takes": [each for each in offered if self.takes(function, each)]}

    def takes(self, name: str, argument: str) -> bool:
        function = getattr(self.script, name, None)
        taken = dict(inspect.signature(function).parameters) if callable(function) else {}
        return argument in taken or any(each.kind is each.VAR_KEYWORD for each in taken.values())

    def faults(self, name: str, inputs: List[str], params: List[str], offered: List[str]) -> List[Mapping[str, str]]:
        function = getattr(self.script, name, None)
        if not callable(function):
            have = [each for each, value in vars(self.script).items() if inspect.isfunction(value) and not each.startswith("_")]
            return [{"field": "script", "message": f"parameter 'script': {self.path} has no function '{name}'; write one, `def {name}("
                     f"{', '.join([*inputs, *params, 'at'])})`" + (f"; it has {', '.join(have)}" if have else "")}]
        place = f"{self.path}:{inspect.unwrap(function).__code__.co_firstlineno}" if hasattr(inspect.unwrap(function), "__code__") else self.path
        out: List[Mapping[str, str]] = []
        if hasattr(self.script, "finish") and not hasattr(self.script, "add"):
            out.append({"field": "script", "message": f"parameter 'script': {self.path} has `finish`, but no `add`, which sees each frame before; write both"})
        known = inspect.signature(function).parameters
        also = [inspect.signature(getattr(self.script, each)).parameters for each in ("add", "finish") if hasattr(self.script, each)]
        taken = {each: kind for names in (known, *also) for each, kind in names.items()}
        rest = any(each.kind is each.VAR_KEYWORD for each in taken.values())
        for field, given in (("inputs", inputs), ("params", params)):
            for each in given:
                if each == "at" or (each not in taken and not rest):
                    out.append({"field": field, "message": f"'{field}': {place}: {name} takes no '{each}'; it takes {', '.join(known) or 'nothing'}"})
        both = [each for each in [*inputs, *offered] if each in params]
        out += [{"field": "params", "message": f"'params': '{each}' is an input already; give it another name"} for each in both]
        if hasattr(self.script, "add"):
            for argument in inspect.signature(getattr(self.script, "add")).parameters.values():
                if argument.default is argument.empty and argument.kind not in (argument.VAR_KEYWORD, argument.VAR_POSITIONAL) \
                        and argument.name not in [*inputs, *params, "at"]:
                    out.append({"field": "inputs", "message": f"{self.path}: add needs '{argument.name}'; state it under `inputs` or `params`"})
        for argument in known.values():
            # What `finish` returns is known only when it has run.
            needed = not hasattr(self.script, "finish") and argument.default is argument.empty and argument.kind not in (argument.VAR_KEYWORD, argument.VAR_POSITIONAL)
            if needed and argument.name not in [*inputs, *params, *offered, "at"]:
                out.append({"field": "inputs", "message": f"{place}: {name} needs '{argument.name}'; state it under `inputs` or `params`"})
        return out

    def call(self, request: Mapping[str, Any]) -> Mapping[str, Any]:
        from . import grids, points

        at = request["at"]
        self.frames = at.get("frames", self.frames)
        arguments: Dict[str, Any] = dict(request.get("params", {}))
        space = None
        if "grids" in request:
            space, given = grids.read(request["grids"], self.given.of(request["grids"]["bytes"]))
            arguments.update(given)
        for name, each in request.get("points", {}).items():
            arguments[name] = points.read(each, self.given.of(request["bytes"]))
        for name, each in request.get("arrays", {}).items():
            arguments[name] = grids.array_in(self.given.of(request["bytes"]), each["at"], each["type"], *each["shape"])
        if "found" in request:
            self.found = grids.found_in(request["found"]) if request["found"] else {}
        arguments["at"] = At(self, at["frame"], at["time"], self.frames, at["work"])
        result = self.called(request["call"], {**arguments, **self.found})
        give = {"numbers": self.give_numbers, "states": self.give_states, "positions": self.give_positions, "entries": self.give_entries,
                "points": self.give_points, "nothing": self.give_nothing, "found": self.give_found}[request["wants"]]
        return give(space if space is not None else {**arguments, **request}, result, request["call"])

    def called(self, name: str, arguments: Dict[str, Any]) -> Any:
        """What a function returns, called with those of the arguments that it takes."""
        if name == "finish" and not hasattr(self.script, name):
            return {}
        function = getattr(self.script, name)
        names = inspect.signature(function).parameters
        if not any(each.kind is each.VAR_KEYWORD for each in names.values()):
            arguments = {each: value for each, value in arguments.items() if each in names}
        return function(**arguments)

    def give_nothing(self, _: Any, result: Any, name: str) -> Mapping[str, Any]:
        return {}

    def give_found(self, _: Any, result: Any, name: str) -> Mapping[str, Any]:
        from .grids import found_as

        data = found_as(result, name)
        self.answered.of(len(data))[:len(data)] = data
        return {"bytes": len(data)}

    def give_numbers(self, space: Any, result: Any, name: str) -> Mapping[str, Any]:
        import numpy as np

        from .grids import leaves_of

        leaves = leaves_of(space, result, name)
        out = np.frombuffer(self.answered.of(4 * leaves.size), np.float32, leaves.size)
        with np.errstate(over="ignore"):
            np.copyto(out.reshape(leaves.shape), leaves, casting="unsafe")
        return {}

    def give_states(self, space: Any, result: Any, name: str) -> Mapping[str, Any]:
        import numpy as np

        from .grids import states_of

        states, origins = states_of(space, result, name)
        memory = self.answered.of(states.nbytes + origins.nbytes)
        np.frombuffer(memory, np.uint8, states.size)[:] = states.ravel()
        np.frombuffer(memory, np.int32, origins.size, states.nbytes)[:] = origins.ravel()
        return {"leaves": len(origins)}

    def give_positions(self, _: Any, result: Any, name: str) -> Mapping[str, Any]:
        import numpy as np

        positions = np.asarray(result)
        if positions.dtype.kind not in "iuf" or positions.ndim != 2 or positions.shape[1] != 3:
            raise TypeError(f"{name} returned {positions.dtype} of shape {positions.shape}; it must be positions, numbers of shape (n, 3)")
        wrong = np.flatnonzero(~np.isfinite(positions).all(axis=1))
        if wrong.size:
            raise ValueError(f"{name} returned position {wrong[0]} as {positions[wrong[0]].tolist()}; positions must be finite")
        np.frombuffer(self.answered.of(8 * positions.size), np.float64, positions.size)[:] = positions.ravel()
        return {"count": len(positions)}

    def give_entries(self, arguments: Any, result: Any, name: str) -> Mapping[str, Any]:
        import numpy as np

        entries, wanted = np.asarray(result), arguments["energy"].shape[:3]
        if entries.dtype.kind not in "iu" or entries.shape != wanted:
            raise TypeError(f"{name} returned {entries.dtype} of shape {entries.shape}; it must be entries, whole numbers of shape {wanted}")
        # Beyond what 32 bits hold they would become others, which may be in order.
        np.frombuffer(self.answered.of(4 * entries.size), np.int32, entries.size)[:] = entries.ravel().astype(np.int64).clip(-1, 2**31 - 1)
        return {}

    def give_points(self, request: Any, result: Any, name: str) -> Mapping[str, Any]:
        import numpy as np

        from .points import columns_of

        like = request["points"][request["like"]]
        columns = columns_of(result, like, name)
        memory = self.answered.of(sum(each.nbytes + 8 for each in columns.values()))
        told, at = [], 0
        for column, values in columns.items():
            np.frombuffer(memory, values.dtype, values.size, at)[:] = values
            told.append({"name": column, "type": str(values.dtype), "at": at})
            at += (values.nbytes + 7) // 8 * 8
        return {"count": len(columns["x"]), "columns": told}

    def told(self, error: BaseException, name: str) -> str:
        """An exception as text: the place in the script, what it is, and the calls that led there."""
        text = "".join(traceback.format_exception_only(type(error), error)).strip()
        if isinstance(error, MemoryError):
            text += "; --memory is what each process may take"
        if isinstance(error, SyntaxError) and error.filename:
            return f"{error.filename}:{error.lineno}: {text.splitlines()[-1]}"
        stack = [each for each in traceback.extract_tb(error.__traceback__) if not each.filename.startswith((PACKAGE, "<frozen importlib"))]
        folder = os.path.dirname(self.path)
        mine = [each for each in stack if each.filename.startswith(folder)]
        if not stack:
            function = getattr(self.script, name, None)
            line = f":{function.__code__.co_firstlineno}" if inspect.isfunction(function) else ""
            return f"{self.path}{line}: {text}" if self.path and self.script is not None else text
        place = (mine or stack)[-1]
        calls = "".join(f"\n  {each.filename}:{each.lineno}, in {each.name}: {each.line}" for each in stack)
        return f"{place.filename}:{place.lineno}: {text}{calls}"

    def run(self) -> None:
        for line in self.channel.makefile("rb"):
            request = json.loads(line)
            # Past its time the process ends itself, and tells where it was.
            faulthandler.dump_traceback_later(request["seconds"], exit=True, file=2)
            try:
                answer = self.answer(request)
            except BaseException as error:
                answer = {"failed": self.told(error, request.get("call", ""))}
            faulthandler.cancel_dump_traceback_later()
            for stream in (sys.stdout, sys.stderr):
                stream.flush()
            self.tell({**answer, "number": request["number"]})


def local_imports(script: str) -> List[str]:
    """The files that a script imports from its own folder, and these again, sorted; also those that it imports later, in its functions."""
    folder = os.path.dirname(script)
    found: Set[str] = set()
    open_files = [script]
    while open_files:
        path = open_files.pop()
        if not path.endswith(".py"):
            continue
        with open(path, "rb") as file:
            tree = ast.parse(file.read(), path)
        for name in (each for node in ast.walk(tree) for each in _imported(node, path, folder)):
            for file_path in _files_of(name, folder):
                if file_path not in found and file_path != script:
                    found.add(file_path)
                    open_files.append(file_path)
    return sorted(found)


def _imported(node: ast.AST, path: str, folder: str) -> List[str]:
    """The modules that a statement imports, as paths from the folder."""
    if isinstance(node, ast.Import):
        return [each.name.replace(".", os.sep) for each in node.names]
    if not isinstance(node, ast.ImportFrom):
        return []
    start = ""
    if node.level:
        start = os.path.dirname(path)
        for _ in range(node.level - 1):
            start = os.path.dirname(start)
        start = os.path.relpath(start, folder)
    module = os.path.normpath(os.path.join(start, (node.module or "").replace(".", os.sep)))
    return [module, *(os.path.join(module, each.name) for each in node.names)]


def _files_of(module: str, folder: str) -> List[str]:
    """The files of a module, and of the packages that it is in."""
    out = []
    parts = module.split(os.sep)
    for count in range(1, len(parts) + 1):
        base = os.path.normpath(os.path.join(folder, *parts[:count]))
        endings = [".py", *importlib.machinery.EXTENSION_SUFFIXES]
        out += [path for path in (os.path.join(base, "__init__.py"), *(base + ending for ending in endings)) if os.path.isfile(path)]
    return out


def main() -> None:
    # The program's end ends this process and those that it started, whatever they do: its end of a pipe closes, and the system sends a signal to
    # the group.
    fcntl.fcntl(LIFE, fcntl.F_SETOWN, -os.getpgrp())
    fcntl.fcntl(LIFE, F_SETSIG, SIGKILL)
    fcntl.fcntl(LIFE, fcntl.F_SETFL, fcntl.fcntl(LIFE, fcntl.F_GETFL) | os.O_ASYNC)
    for file in (SOCKET, GIVEN, ANSWERED, LIFE):
        os.set_inheritable(file, False)
    faulthandler.enable(file=2)
    Worker().run()
    # What the script left, such as threads, must not keep the process.
    os._exit(0)
