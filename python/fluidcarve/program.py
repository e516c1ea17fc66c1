"""Finds the program and calls it."""

from __future__ import annotations

import functools
import json
import os
import shutil
import subprocess
from typing import Any, Dict, List, Optional, Sequence, Tuple

from .errors import Error, Problem


def program() -> str:
    """The path of the program: $FLUIDCARVE, else the one of the installation or build that holds this package, else the one on PATH.

    Raises Error if there is none.
    """
    named = os.environ.get("FLUIDCARVE")
    if named:
        return named
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    # PREFIX/share/fluidcarve/python, a checkout's python/ beside its build/, or an archive's python/ beside its bin/.
    for place in ("../../../bin", "../bin", "../build"):
        path = os.path.normpath(os.path.join(here, place, "fluidcarve"))
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return path
    found = shutil.which("fluidcarve")
    if found:
        return found
    raise Error([Problem("there is no program fluidcarve beside this package nor on PATH; name it in the environment variable FLUIDCARVE")], 2)


def words_of(options: Dict[str, Any]) -> List[str]:
    """Options of a verb as the words of its command line: `{"keep_going": True, "threads": 2}` is `--keep-going --threads 2`."""
    out: List[str] = []
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            out.append(flag)
            continue
        for each in value if isinstance(value, (list, tuple)) else [value]:
            out.append(f"{flag}={each}")
    return out


def spawn(words: Sequence[str], stdout: Any, stderr: Any) -> "subprocess.Popen[bytes]":
    """Starts the program, with nothing to read."""
    try:
        return subprocess.Popen([program(), *words], stdin=subprocess.DEVNULL, stdout=stdout, stderr=stderr)
    except OSError as error:
        raise Error([Problem(f"cannot start {program()}: {error.strerror}; name the program in the environment variable FLUIDCARVE")], 2) from error


def call(words: Sequence[str], good: Sequence[int] = (0,)) -> Tuple[int, str]:
    """Calls the program and waits. Returns its exit code and what it printed.

    Raises Error if the exit code is not among `good`.
    """
    process = spawn(words, subprocess.PIPE, subprocess.PIPE)
    out, err = (text.decode(errors="replace") for text in process.communicate())
    if process.returncode not in good:
        raise Error(problems_in(out) or [Problem(err.strip().removeprefix("failed: ") or f"the program ended with code {process.returncode}")], process.returncode)
    return process.returncode, out


def call_json(words: Sequence[str], good: Sequence[int] = (0,)) -> Any:
    """The same for a verb that prints JSON."""
    return json.loads(call([*words, "--json"], good)[1])


def problems_in(text: str) -> List[Problem]:
    """The problems that `check --json` prints, or the error that another verb prints; none if the text is something else."""
    try:
        entries = json.loads(text)
    except ValueError:
        return []
    if isinstance(entries, dict) and entries.get("error"):
        return [Problem(entries["error"])]
    if not isinstance(entries, list):
        return []
    return [Problem(entry["message"], entry.get("file", ""), entry.get("line", 0), entry.get("column", 0)) for entry in entries]


@functools.lru_cache(maxsize=None)
def node_types(plugins: Tuple[str, ...] = (), path: Optional[str] = None) -> Dict[str, Any]:
    """What the program says of its node types and those of plugins, by name (`fluidcarve nodes --json`)."""
    words = [f"--plugin={file}" for file in plugins]
    return {each["name"]: each for each in call_json(["nodes", *words])["nodes"]}
