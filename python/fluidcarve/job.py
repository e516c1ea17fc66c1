"""A run of the program, in a process of its own."""

from __future__ import annotations

import json
import os
import select
import shutil
import signal
import tempfile
from typing import Any, Callable, List, Optional, Sequence

from .errors import Cancelled, Error, Problem
from .program import spawn
from .results import Event, Result, result_of, taken_from

Progress = Callable[[Event], object]
_KEPT_GOING, _INTERRUPTED = 4, 130


class Job:
    """A run or a carve that was started.

    A program with a loop of its own calls `poll` now and then; all others call `wait`. `cancel` may come from anywhere, also from
    the callback. No thread is started.
    """

    def __init__(self, words: Sequence[str], progress: Optional[Progress] = None, check: Optional[Callable[[], List[Problem]]] = None,
                 folder: Optional[str] = None, report: Optional[str] = None) -> None:
        """check   finds the problems of the pipeline, if the program refuses it
        folder  is removed at the end
        report  where the report is to stay
        """
        self._folder = folder or tempfile.mkdtemp(prefix="fluidcarve-")
        self._progress = progress
        self._check = check
        self._report = report or os.path.join(self._folder, "report.json")
        self._said: List[str] = []
        self._rest = b""
        self._fraction = 0.0
        self._outcome: Any = None
        self._cancelled = False
        try:
            with open(os.path.join(self._folder, "stdout"), "wb") as printed:
                self._process = spawn([*words, "--progress", "json", "--report", self._report], printed, -1)
        except BaseException:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise
        assert self._process.stderr is not None
        self._told = self._process.stderr
        os.set_blocking(self._told.fileno(), False)

    def fileno(self) -> int:
        """What becomes readable when `poll` has something to do: for `select` and loops of events."""
        return self._told.fileno()

    def cancel(self) -> None:
        """Asks the run to stop. What is finished stays in the work folder."""
        if not self._told.closed and self._process.poll() is None:
            self._cancelled = True
            self._process.send_signal(signal.SIGTERM)

    def poll(self) -> bool:
        """Hands on what the program has told since the last call. Returns whether it still runs. Never waits."""
        while not self._told.closed:
            try:
                chunk = os.read(self._told.fileno(), 65536)
            except BlockingIOError:
                return True
            if not chunk:
                self._end()
                break
            lines = (self._rest + chunk).split(b"\n")
            self._rest = lines.pop()
            for line in lines:
                self._hear(line.decode(errors="replace"))
        return False

    def wait(self) -> Result:
        """Waits for the end. Raises Error if the run failed, Cancelled if it was cancelled."""
        try:
            while self.poll():
                select.select([self], [], [])
        except BaseException:
            # The callback failed, or Ctrl-C: nobody wants the result.
            self._progress = None
            self.cancel()
            while self.poll():
                select.select([self], [], [])
            raise
        if isinstance(self._outcome, Error):
            raise self._outcome
        assert isinstance(self._outcome, Result)
        return self._outcome

    def _hear(self, line: str) -> None:
        try:
            answer = json.loads(line)
            event = taken_from(Event, {"fraction": 1 if answer["event"] == "done" else self._fraction, **answer})
        except (ValueError, TypeError, AttributeError, KeyError):
            event = Event("warning", line, self._fraction)
        self._fraction = event.fraction
        if event.event in ("failure", "warning"):
            self._said.append(event.text)
        if self._progress is not None:
            self._progress(event)

    def _end(self) -> None:
        if self._rest:
            line, self._rest = self._rest.decode(errors="replace"), b""
            self._hear(line)
        code = self._process.wait()
        self._told.close()
        try:
            self._outcome = self._made(code)
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _made(self, code: int) -> Any:
        """The result, or the error."""
        if code == _INTERRUPTED or (self._cancelled and code != 0):
            return Cancelled([Problem("the run was cancelled; run it again to continue")], _INTERRUPTED)
        result = None
        if code != 2 and os.path.exists(self._report):
            with open(self._report, encoding="utf-8") as file:
                result = result_of(json.load(file))
        if result is not None and code in (0, _KEPT_GOING):
            return result
        problems = result.failures if result is not None else []
        if not problems and self._check is not None and code == 2:
            problems = self._check()
        return Error(problems or [Problem("\n".join(self._said) or f"the program ended with code {code}")], code)
