"""Writes and runs pipelines of fluidcarve.

    import fluidcarve

    p = fluidcarve.Pipeline(frames="1001-1100")
    sim = p.vdb.read(path="smoke.####.vdb", grids={"density": "float"})
    energy = p.energy.gradient(field=sim.density)
    box = p.lattice.box(fit=sim.density)
    seams = p.seam.pyramid(energy=energy, lattice=box, count=-12)
    carved = p.remap.grids(source=sim, lattice=box, seams=seams)
    out = p.vdb.write(source=carved, path="out/smoke.####.vdb")
    p.save("shot.yaml")
    fluidcarve.run("shot.yaml", {"seams.count": -20}, progress=print)

Nothing but the standard library is needed to write and run; arrays of nodes in Python need numpy.
"""

from .calls import Shot, carve, check, diff, explain, farm, finished, inspect, plan, run, run_all, run_async, start
from .errors import Cancelled, Error, Problem
from .job import Job
from .pipeline import Node, Output, Param, Pipeline, load
from .program import program
from .results import Difference, Event, Explanation, Farm, Inspection, NodeRun, Plan, PlannedNode, Result

__all__ = [
    "Cancelled", "Difference", "Error", "Event", "Explanation", "Farm", "Inspection", "Job", "Node", "NodeRun", "Output", "Param", "Pipeline",
    "Plan", "PlannedNode", "Problem", "Result", "Shot", "carve", "check", "diff", "explain", "farm", "finished", "inspect", "load", "plan",
    "program", "run", "run_all", "run_async", "start",
]
