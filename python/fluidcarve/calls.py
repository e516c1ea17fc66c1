"""The verbs of the program as functions. Options are those of the command line, as keywords: `keep_going=True`, `threads=4`."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Iterable, Iterator, List, Mapping, Optional, Tuple, Union

from . import yaml_text
from .errors import Cancelled, Error, Problem
from .job import Job, Progress
from .pipeline import Pipeline
from .program import call, call_json, problems_in, words_of
from .results import Difference, Explanation, Farm, Inspection, Plan, Result, plan_of, taken_from

if TYPE_CHECKING:
    import asyncio

PipelineLike = Union[str, "os.PathLike[str]", Pipeline]
Sets = Mapping[str, Any]
# What a check takes of the options of a run.
_OPTIONS_OF_CHECK = ("allow_plugins", "confine")


def start(pipeline: PipelineLike, sets: Sets = {}, progress: Optional[Progress] = None, **options: Any) -> Job:
    """Starts a run, and returns it.

    pipeline  a file, or a Pipeline
    sets      values of params and of fields, as of --set: {"count": -20, "seams.axis": "v", "frames": "1001-1010"}
    progress  is called with each Event, while `wait` or `poll` runs
    """
    folder = tempfile.mkdtemp(prefix="fluidcarve-")
    path, report = _path_of(pipeline, folder), options.pop("report", None)
    # The folder goes only with the job, so that the check finds the pipeline there.
    return Job(["run", path, *_words_of_sets(sets), *words_of(options)], progress, lambda: _problems(path, sets, options), folder, report)


def run(pipeline: PipelineLike, sets: Sets = {}, progress: Optional[Progress] = None, **options: Any) -> Result:
    """Runs a pipeline and waits for its end; as `start`. Raises Error, whose problems say what failed; Cancelled if it was interrupted."""
    return start(pipeline, sets, progress, **options).wait()


async def run_async(pipeline: PipelineLike, sets: Sets = {}, progress: Optional[Progress] = None, **options: Any) -> Result:
    """As `run`, for asyncio. Cancelling the task cancels the run."""
    return await finished(start(pipeline, sets, progress, **options))


async def finished(job: Job) -> Result:
    """Waits for a job, for asyncio."""
    import asyncio  # three times as slow to load as all else here

    loop = asyncio.get_running_loop()
    try:
        while job.poll():
            ready: "asyncio.Future[None]" = loop.create_future()
            loop.add_reader(job.fileno(), _set, ready)
            try:
                await ready
            finally:
                loop.remove_reader(job.fileno())
    except BaseException:
        job.cancel()
        with contextlib.suppress(Error):
            job.wait()
        raise
    return job.wait()


def _set(future: "asyncio.Future[None]") -> None:
    if not future.done():
        future.set_result(None)


@dataclass
class Shot:
    """A run of many: its pipeline, its values, and what came of it, either `result` or `error`."""

    pipeline: PipelineLike
    sets: Sets = field(default_factory=dict)
    result: Optional[Result] = None
    error: Optional[Error] = None


def run_all(shots: Iterable[Union[Shot, PipelineLike, Tuple[PipelineLike, Sets]]], progress: Optional[Progress] = None, **options: Any) -> List[Shot]:
    """Runs shots one after the other, each with all cores and with one work folder, so that what shots share is computed once.

    A shot is a Shot, a pipeline, or a pipeline and its sets. One that fails stops no other: its `error` says why. Cancelled ends them all.
    """
    out = [_shot(each) for each in shots]
    for shot in out:
        try:
            shot.result = run(shot.pipeline, shot.sets, progress, **options)
        except Cancelled:
            raise
        except Error as error:
            shot.error = error
    return out


def check(pipeline: PipelineLike, sets: Sets = {}, **options: Any) -> List[Problem]:
    """All that can be known without running. Returns the warnings; raises Error with all problems if there are any."""
    with _file(pipeline) as path:
        return problems_in(call(["check", path, "--json", *_words_of_sets(sets), *words_of(options)])[1])


def plan(pipeline: PipelineLike, sets: Sets = {}, **options: Any) -> Plan:
    """What a run will do, and what is in the work folder."""
    with _file(pipeline) as path:
        try:
            return plan_of(call_json(["plan", path, *_words_of_sets(sets), *words_of(options)]))
        except Error as error:
            raise Error((_problems(path, sets, options) if error.code == 2 else []) or error.problems, error.code) from None


def inspect(*files: Union[str, "os.PathLike[str]"]) -> Inspection:
    """What is in files, sequences and folders. A file that can't be read has an entry with its `error`."""
    return taken_from(Inspection, call_json(["inspect", *(os.fspath(file) for file in files)], good=(0, 3)))


def carve(files: str, count: Union[int, float, str], out: str, progress: Optional[Progress] = None, **options: Any) -> Result:
    """Carves files in the box around them, without a pipeline: `carve("smoke.####.vdb", -12, "out/smoke.####.vdb")`."""
    report = options.pop("report", None)
    return Job(["carve", files, str(count), f"--out={out}", *words_of(options)], progress, report=report).wait()


def diff(a: str, b: str, **options: Any) -> Difference:
    """Compares two sequences, files or folders."""
    return taken_from(Difference, call_json(["diff", a, b, *words_of(options)], good=(0, 1)))


def explain(file: str) -> Explanation:
    """What made a file. Raises Error, code 3, if it states nothing."""
    return taken_from(Explanation, call_json(["explain", file])["provenance"])


def farm(engine: str, pipeline: PipelineLike, sets: Sets = {}, **options: Any) -> Union[Farm, str]:
    """Makes a job of a farm: `engine` is local, slurm or openjd. Returns what was printed; with `dry_run=True` the job's steps."""
    if isinstance(pipeline, Pipeline):
        raise Error([Problem("a farm's machines read the pipeline's file: save it, and give its path")], 2)
    words = ["farm", engine, os.fspath(pipeline), *_words_of_sets(sets), *words_of(options)]
    return taken_from(Farm, call_json(words)) if options.get("dry_run") else call(words)[1]


def _shot(each: Union[Shot, PipelineLike, Tuple[PipelineLike, Sets]]) -> Shot:
    if isinstance(each, Shot):
        return each
    return Shot(*each) if isinstance(each, tuple) else Shot(each)


def _words_of_sets(sets: Sets) -> List[str]:
    return [word for name, value in sets.items() for word in ("--set", f"{name}={value if isinstance(value, str) else yaml_text.flow(value)}")]


def _problems(path: str, sets: Sets, options: Dict[str, Any]) -> List[Problem]:
    """What is wrong with a pipeline that a run refuses."""
    try:
        check(path, sets, **{name: options[name] for name in _OPTIONS_OF_CHECK if name in options})
    except Error as error:
        return error.problems
    return []


def _path_of(pipeline: PipelineLike, folder: str) -> str:
    """The file of a pipeline; of a Pipeline one in a folder."""
    if not isinstance(pipeline, Pipeline):
        return os.fspath(pipeline)
    path = os.path.join(folder, "pipeline.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(pipeline.text())
    return path


@contextlib.contextmanager
def _file(pipeline: PipelineLike) -> Iterator[str]:
    folder = tempfile.mkdtemp(prefix="fluidcarve-")
    try:
        yield _path_of(pipeline, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
