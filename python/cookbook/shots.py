"""One pipeline for many shots, written and run: `python3 shots.py FOLDER...`, each with a sequence smoke.####.vdb."""

import os
import sys
from typing import List

import fluidcarve


def pipeline() -> fluidcarve.Pipeline:
    """Narrows smoke by a share, and draws what came of it."""
    p = fluidcarve.Pipeline(frames="auto", doc="Narrows smoke.")
    folder = p.param("folder", "string", doc="Of the shot.")
    count = p.param("count", "count", "-20%", doc="Seams: negative removes, positive inserts.")
    sim = p.vdb.read(f"{folder}/smoke.####.vdb", grids={"density": "float"})
    energy = p.energy.combine([p.energy.gradient(sim.density), p.field.filter(sim.density, width=3)], weights=[1, 0.2])
    box = p.lattice.box(fit=sim.density)
    seams = p.seam.pyramid(energy, box, count, field=sim.density, thickness="auto")
    carved = p.remap.grids(source=sim, lattice=box, seams=seams)
    p.vdb.write(source=carved, path=f"{folder}/carved/smoke.####.vdb")
    p.preview.sheet(before=sim, after=carved, path=f"{folder}/carved/sheet.png", grid="density", show="render")
    return p


def main(folders: List[str]) -> int:
    p = pipeline()
    shots = [fluidcarve.Shot(p, {"folder": os.path.abspath(folder)}) for folder in folders]
    for shot in fluidcarve.run_all(shots, keep_going=True):
        name = shot.sets["folder"]
        if shot.result is not None:
            print(f"{name}: {len(shot.result.frames)} frames in {shot.result.wall_s:.1f} s")
        elif shot.error is not None:
            print(f"{name}: {shot.error}", file=sys.stderr)
    return sum(shot.error is not None for shot in shots)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
