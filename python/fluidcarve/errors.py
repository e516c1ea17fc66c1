"""What can go wrong, as exceptions with their problems."""

from __future__ import annotations

from dataclasses import dataclass
from typing import List, Optional, Sequence


@dataclass(frozen=True)
class Problem:
    """A fault, its place and its remedy.

    `file`, `line` and `column` say where in a pipeline, counted from 1; line 0 is the file as a whole. `node` and `frame` say
    where in a run.
    """

    message: str
    file: str = ""
    line: int = 0
    column: int = 0
    node: str = ""
    frame: Optional[int] = None

    @property
    def remedy(self) -> str:
        """What to do about it: what the message's first line says behind its last semicolon. Empty if it says nothing."""
        first = self.message.partition("\n")[0]
        return first.rpartition("; ")[2] if "; " in first else ""

    def __str__(self) -> str:
        if self.node:
            return f"{self.node}{'' if self.frame is None else f', frame {self.frame}'}: {self.message}"
        place = f"{self.file}:{self.line}:{self.column}: " if self.line else f"{self.file}: " if self.file else ""
        return place + self.message


class Error(Exception):
    """The program refused or failed.

    `problems` holds all that it found, and `code` its exit code (pipelines/FORMATS.md): 1 a node failed, 2 the pipeline or the
    call is wrong, 3 an input is missing or unreadable.
    """

    def __init__(self, problems: Sequence[Problem], code: int) -> None:
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems: List[Problem] = list(problems)
        self.code = code


class Cancelled(Error):
    """The run was cancelled. Run it again to continue."""
