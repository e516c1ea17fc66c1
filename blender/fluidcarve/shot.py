"""Writes the pipeline of a volume's settings, and the files that it reads: the curve, regions, the energy's script.

The program drafts a pipeline by content, `carve --print-pipeline`. What a box and options cannot say is in a second one, which extends it.
"""

from __future__ import annotations

import ast
import csv
import json
import os
import re
import shlex
from dataclasses import dataclass
from typing import Any, Dict, List, Sequence

import bpy

from . import scene
from .api import call, fluidcarve, interpreter
from .settings import axis as axis_of

_MARK = "Written by the add-on of Blender for"


@dataclass
class Shot:
    """A volume's pipeline and its outputs."""

    pipeline: str  # the file that `fluidcarve run` takes
    folder: str  # all other files
    source: scene.Source
    facts: Dict[str, Any]  # what `inspect` tells of one of its files
    out: str  # the carved files
    seams: str = ""  # lines along the seams, files; empty: none
    energy: str = ""  # the energy's files; empty: none
    points: str = ""  # the carved particles, to look at; empty: none
    allow_plugins: bool = False  # whether it runs a script
    frames: Sequence[int] = ()  # numbers of the frames that it carves


def names_of(volume: bpy.types.Object) -> List[str]:
    """The pipeline of a volume and the folder of its other files: beside the .blend file, else in Blender's folder of the session."""
    blend = bpy.data.filepath
    name = bpy.path.clean_name(volume.name)
    if blend:
        folder, stem = os.path.dirname(blend), os.path.splitext(os.path.basename(blend))[0]
        start = os.path.join(folder, f"{stem}_{name}")
    else:
        start = os.path.join(bpy.app.tempdir, name)
    return [start + ".yaml", start]


def write(volume: bpy.types.Object, preview: bool = False) -> Shot:
    """Writes a volume's pipeline.

    preview  three frames around the scene's, at half size
    """
    settings = volume.fluidcarve
    source = scene.source_of(volume)
    pipeline, folder = names_of(volume)
    _require_ours(pipeline)
    os.makedirs(folder, exist_ok=True)
    if preview:
        pipeline, folder = os.path.join(folder, "preview.yaml"), os.path.join(folder, "preview")
        os.makedirs(folder, exist_ok=True)
    facts = scene.facts_of(source)
    ending = {"volume": ".vdb", "mesh": ".obj", "points": ".ply"}.get(facts["kind"], os.path.splitext(source.path)[1])
    shot = Shot(pipeline, folder, source, facts, _files(folder, "carved", ending, source))
    made = _in_time(volume, shot) if axis_of(settings) == "t" else _in_space(volume, shot, preview)
    made.doc = f"{_MARK} '{volume.name}' of {os.path.basename(bpy.data.filepath) or 'an unsaved file'}; carving again writes it anew.\n"
    made.doc += f"It runs without Blender, too: fluidcarve run {shlex.quote(os.path.basename(pipeline))}"
    made.doc += " --allow-plugins" if shot.allow_plugins else ""
    shot.frames = _near(source, preview)
    made.frames = _frame_set(shot.frames)
    made.save(pipeline)
    return shot


def _files(folder: str, name: str, ending: str, source: scene.Source) -> str:
    """The path of files that are written: one per frame of a sequence, or one."""
    return os.path.join(folder, f"{name}{'.####' if '#' in source.path else ''}{ending}")


def _require_ours(pipeline: str) -> None:
    if os.path.exists(pipeline):
        with open(pipeline, encoding="utf-8") as file:
            if _MARK not in file.readline():
                raise scene.fault(f"{pipeline} was not written by the add-on; move it away, or rename the volume")


def _near(source: scene.Source, preview: bool) -> List[int]:
    """Numbers of the frames to carve."""
    if not preview:
        return list(source.numbers)
    at = source.numbers.index(source.number(bpy.context.scene.frame_current))
    first = max(0, min(at - 1, len(source.numbers) - 3))
    return list(source.numbers[first:first + 3])


def _frame_set(numbers: List[int]) -> str:
    """Numbers as a frame set: 1-5,8."""
    runs: List[List[int]] = []
    for each in numbers:
        if runs and each == runs[-1][-1] + 1:
            runs[-1].append(each)
        else:
            runs.append([each])
    return ",".join(str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}" for run in runs)


def _in_time(volume: bpy.types.Object, shot: Shot) -> Any:
    settings = volume.fluidcarve
    if shot.facts["kind"] != "volume":
        raise scene.fault(f"only volumes change in time, and {os.path.basename(shot.source.path)} is a {shot.facts['kind']}; choose another axis")
    p = fluidcarve.Pipeline()
    grids = {grid["name"]: grid["type"] for grid in shot.facts["grids"]}
    velocity = next((name for name in ("velocity", "vel", "v") if grids.get(name) == "vec3s"), None)
    shown = _shown(grids) if settings.time == "CARVE" else None
    named = {**({velocity: "vector"} if velocity else {}), **({shown: "float"} if shown else {})}
    sim = p.vdb.read(path=shot.source.path, **({"grids": named} if named else {}))
    moving = {"velocity": sim[velocity]} if velocity else {}
    if settings.time == "CARVE":
        carved = _own_pace(p, sim, str(shown), settings.frames)
    elif settings.time == "RETIME":
        carved = p.time.retime(source=sim, speed=round(settings.speed, 6), **moving)
    else:
        low, high = sorted(settings.loop)
        carved = p.time.loop(source=sim, frames=low if low == high else [low, high], **moving)
    p.vdb.write(source=carved, path=shot.out, name="out")
    return p


def _shown(grids: Dict[str, str]) -> str:
    """The grid that is looked at: the density, else the first of numbers."""
    floats = [name for name, kind in grids.items() if kind == "float"]
    if not floats:
        raise scene.fault("there is no grid of numbers, which tells at what moment frames may leave; choose Speed or Loop")
    return "density" if "density" in floats else floats[0]


def _own_pace(p: fluidcarve.Pipeline, sim: Any, shown: str, frames: int) -> Any:
    """Takes frames out, or shows them twice, at each place where that is seen least."""
    box = p.lattice.box(fit=sim[shown])
    edges = p.energy.gradient(field=sim[shown])
    seams = p.seam.pyramid(energy=edges, field=sim[shown], lattice=box, axis="t", count=frames)
    return p.remap.grids(source=sim, lattice=box, seams=seams)


def _in_space(volume: bpy.types.Object, shot: Shot, preview: bool) -> Any:
    draft = os.path.join(shot.folder, "draft.yaml")
    with open(draft, "w", encoding="utf-8") as file:
        file.write(_draft(volume, shot))
    p = fluidcarve.load(draft)
    settings = volume.fluidcarve
    is_volume = shot.facts["kind"] == "volume"
    if preview and is_volume:
        _halve(p, 2 * voxel_of(shot.facts))
    if settings.rig:
        _bend(p, volume, shot, 2 if preview and is_volume else 1)
    has_seams = not p.type_of("seams").startswith("warp")
    if settings.energy:
        os.environ.setdefault("FLUIDCARVE_PYTHON", interpreter())
        p.energy.python(script=_script(settings.energy, shot), inputs=_inputs(settings.energy, p, shot), name="artist")
        p.change("seams", energy="artist")
    if settings.attract:
        _write_region(settings.attract, volume, shot, "attract")
        p.mesh.read(path=_in(shot, "attract", settings.attract), name="wanted")
        p.mask.mesh(mesh="wanted", like="energy", name="attracted")
        p.change("seams", attract="attracted")
    if settings.thick and has_seams:
        p.change("seams", thickness=settings.thick)
    if settings.window_low or settings.window_high:
        p.change("seams", window=_window(volume, shot))
    if is_volume:
        shot.energy = _files(shot.folder, "energy", ".vdb", shot.source)
        p.vdb.write(source=p.fields("seams")["energy"], path=shot.energy, name="shown")
    if "moved" in [str(node) for node in p.nodes()]:
        shot.points = _files(shot.folder, "points", ".ply", shot.source)
        p.points.write(source="moved", path=shot.points, encoding="little_endian", name="seen")
    if has_seams and shot.facts["kind"] != "image":
        shot.seams = _files(shot.folder, "seams", ".obj", shot.source)
        p.seams.curves(lattice="bent" if settings.rig else "box", seams="seams", path=shot.seams, name="lines")
    return p


def _draft(volume: bpy.types.Object, shot: Shot) -> str:
    """The program's own pipeline for the files."""
    settings = volume.fluidcarve
    words = ["carve", shot.source.path, _count(volume, shot), f"--out={shot.out}", "--print-pipeline"]
    words.append(f"--seams={os.path.join(shot.folder, 'seams.vdb')}")
    words.append(f"--sheet={os.path.join(shot.folder, 'sheet.png')}")
    words.append(f"--axis={'x' if settings.rig else settings.box_axis}")
    if settings.anchor != "auto":
        words.append(f"--anchor={settings.anchor}")
    elif settings.rig:  # the curve stays, or its start
        words.append(f"--anchor={'low' if settings.rig_axis == 'w' else 'middle'}")
    if settings.empty:
        words.append(f"--empty={settings.empty:.6g}")
    if settings.conserve:
        words.append("--conserve=mass")
    if settings.protect:
        _write_region(settings.protect, volume, shot, "protect")
        words.append(f"--protect={_in(shot, 'protect', settings.protect)}")
    return call(words)[1]


def _count(volume: bpy.types.Object, shot: Shot) -> str:
    """The change of size as the program takes it."""
    settings = volume.fluidcarve
    amount = settings.amount
    if settings.unit == "PERCENT":
        return f"{amount:.6g}%"
    if settings.unit == "LENGTH":
        scale = scene.scale_of(volume) if settings.rig else 1 / volume.matrix_world.to_3x3().col["xyz".index(settings.box_axis)].length
        amount = amount * scale / spacing_of(volume, shot.facts)
    count = round(amount)
    if count == 0:
        raise scene.fault("the change is less than a voxel; ask for more")
    return str(count)


def voxel_of(facts: Dict[str, Any]) -> float:
    """The size of a voxel in units of the files; of what has none, a hundredth of its size."""
    sizes = [grid["transform"]["voxel_size"][0] for grid in facts.get("grids", []) if grid.get("active_voxels")]
    if sizes:
        return float(sizes[0])
    low, high = facts.get("world_box", [[0, 0, 0], [1, 1, 1]])
    return max(b - a for a, b in zip(low, high)) / 100


def fit(volume: bpy.types.Object, source: scene.Source) -> None:
    """Makes the lattice reach around the content of the first, the middle and the last frame, and two voxels more."""
    settings = volume.fluidcarve
    numbers = sorted({source.numbers[0], source.numbers[len(source.numbers) // 2], source.numbers[-1]})
    low, high = box_of(source, numbers)
    more = 2 * voxel_of(known_facts(volume))
    reach: List[Any] = [(-half - more, half + more) for half in [sorted(b - a for a, b in zip(low, high))[1] / 2] * 2]
    if settings.rig:
        points = scene.curve_points(settings.rig, scene.to_files(volume))
        corners = [scene.across(points, _up(volume), (x, y, z)) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
        reach = [(min(each[n] for each in corners) - more, max(each[n] for each in corners) + more) for n in range(2)]
    settings.reach_u, settings.reach_v = ([each / scene.scale_of(volume) for each in side] for side in reach)


def _up(volume: bpy.types.Object) -> Any:
    """The lattice's up direction in the world of the files."""
    return (scene.to_files(volume).to_3x3() @ volume.fluidcarve.up).normalized()


def known_facts(volume: bpy.types.Object) -> Dict[str, Any]:
    """What was told of the volume's files, or is now."""
    settings = volume.fluidcarve
    if not settings.facts:
        settings.facts = json.dumps(scene.facts_of(scene.source_of(volume)))
    out: Dict[str, Any] = json.loads(settings.facts)
    return out


def spacing_of(volume: bpy.types.Object, facts: Dict[str, Any]) -> float:
    """The distance of the lattice's vertices in units of the files."""
    settings = volume.fluidcarve
    return settings.spacing * scene.scale_of(volume) if settings.spacing and settings.rig else voxel_of(facts)


def _bend(p: Any, volume: bpy.types.Object, shot: Shot, coarser: int) -> None:
    """Puts a lattice along the curve in the place of the box."""
    settings = volume.fluidcarve
    path = _write_rig(volume, shot.source, os.path.join(shot.folder, "rig"))
    add_lattice(p, volume, path, coarser * spacing_of(volume, shot.facts))
    for node in p.nodes():
        if p.fields(node).get("lattice") == "box":
            p.change(node, lattice="bent")
        if p.type_of(node) in ("remap.grids", "remap.points", "remap.mesh"):
            p.change(node, rim="fade")
    p.change("seams", axis=settings.rig_axis)
    del p["box"]


def add_lattice(p: Any, volume: bpy.types.Object, path: str, spacing: float) -> None:
    """Adds the nodes `rig` and `bent` for the curve in files."""
    settings = volume.fluidcarve
    scale = scene.scale_of(volume)
    reach = {name: [_short(scale * each) for each in sorted(values)] for name, values in (("extent_u", settings.reach_u), ("extent_v", settings.reach_v))}
    p.rig.curve(path=path, up=[_short(each) for each in _up(volume)], name="rig")
    p.lattice.build(rig="rig", spacing=_short(spacing), name="bent", **reach)


def _short(value: float) -> float:
    return float(f"{value:.6g}")


def _write_rig(volume: bpy.types.Object, source: scene.Source, start: str) -> str:
    """Writes the curve, once or for each frame. Returns the path."""
    curve = volume.fluidcarve.rig
    for number in scene.each_frame(source, [curve, volume]):
        write_points(start + (f".{number:04d}" if number is not None else "") + ".csv", scene.curve_points(curve, scene.to_files(volume)))
    return start + (".####.csv" if scene.is_animated(curve) or scene.is_animated(volume) else ".csv")


def write_points(path: str, points: List[Any]) -> None:
    """Writes points as a .csv file with the columns x, y, z."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow("xyz")
        writer.writerows([f"{each:.7g}" for each in point] for point in points)


def _in(shot: Shot, name: str, region: bpy.types.Object) -> str:
    return os.path.join(shot.folder, name + (".####.obj" if scene.is_animated(region) else ".obj"))


def _write_region(region: bpy.types.Object, volume: bpy.types.Object, shot: Shot, name: str) -> None:
    """Writes a mesh or an empty as an .obj file, once or for each frame."""
    for number in scene.each_frame(shot.source, [region]):
        vertices, faces = scene.region_faces(region, scene.to_files(volume))
        if not faces:
            raise scene.fault(f"'{region.name}' has no faces; take a closed mesh or an empty")
        with open(os.path.join(shot.folder, name + (f".{number:04d}" if number is not None else "") + ".obj"), "w", encoding="utf-8") as file:
            file.writelines("v {:.7g} {:.7g} {:.7g}\n".format(*each) for each in vertices)
            file.writelines("f " + " ".join(str(each + 1) for each in face) + "\n" for face in faces)


def _window(volume: bpy.types.Object, shot: Shot) -> List[str]:
    """Where the two empties lie along the axis, as shares of the lattice."""
    settings = volume.fluidcarve
    shares = []
    for empty, otherwise in ((settings.window_low, 0.0), (settings.window_high, 1.0)):
        shares.append(_share(volume, shot, scene.to_files(volume) @ empty.matrix_world.translation) if empty else otherwise)
    low, high = sorted(shares)
    if high - low < 0.01:
        raise scene.fault("between From and To there is no room along the axis; move the empties apart")
    return [f"{100 * low:.4g}%", f"{100 * high:.4g}%"]


def _share(volume: bpy.types.Object, shot: Shot, at: Any) -> float:
    """The place of a point along the lattice's axis, from 0 to 1."""
    settings = volume.fluidcarve
    if not settings.rig:
        low, high = box_of(shot.source, shot.source.numbers)
        axis = "xyz".index(settings.box_axis)
        return min(max((at[axis] - low[axis]) / (high[axis] - low[axis]), 0.0), 1.0)
    u, v, along = scene.across(scene.curve_points(settings.rig, scene.to_files(volume)), _up(volume), at)
    if settings.rig_axis == "w":
        return along
    place, reach = (u, settings.reach_u) if settings.rig_axis == "u" else (v, settings.reach_v)
    low, high = (scene.scale_of(volume) * each for each in sorted(reach))
    return min(max((place - low) / (high - low), 0.0), 1.0)


def box_of(source: scene.Source, numbers: Sequence[int]) -> List[List[float]]:
    """The box around the content of frames: of the first grid that has any, as a box lattice lies, or of a mesh."""
    low, high = [float("inf")] * 3, [float("-inf")] * 3
    for told in fluidcarve.inspect(*(scene.of_frame(source.path, number) for number in numbers)).files:
        boxes = [grid["world_box"] for grid in told.get("grids", []) if "world_box" in grid and grid["name"] != "shadow"]
        for a, b in boxes[:1] or ([told["world_box"]] if "world_box" in told else []):
            low, high = [min(each) for each in zip(low, a)], [max(each) for each in zip(high, b)]
    if low[0] > high[0]:
        raise scene.fault(f"{os.path.basename(source.path)} has no content in its frames; name other files")
    return [low, high]


def _script(text: bpy.types.Text, shot: Shot) -> str:
    """Writes a text block as a script, and returns its path."""
    path = os.path.join(shot.folder, "energy.py")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.as_string())
    shot.allow_plugins = True
    return path


def _inputs(text: bpy.types.Text, p: Any, shot: Shot) -> Dict[str, str]:
    """The grids that the function's arguments name."""
    try:
        tree = ast.parse(text.as_string())
    except SyntaxError as error:
        raise scene.fault(f"text '{text.name}', line {error.lineno}: {error.msg}; mend it in the text editor") from None
    function = next((each for each in tree.body if isinstance(each, ast.FunctionDef) and each.name == "energy"), None)
    if function is None:
        raise scene.fault(f"text '{text.name}' has no function 'energy'; write `def energy(density, at):`")
    kinds = {"float": "float", "vec3s": "vector"}
    grids = {grid["name"]: kinds[grid["type"]] for grid in shot.facts.get("grids", []) if grid["type"] in kinds}
    names = [each.arg for each in function.args.args if each.arg != "at"]
    for name in names:
        if name not in grids:
            raise scene.fault(f"text '{text.name}': there is no grid '{name}' for energy(); name one of {', '.join(grids)}")
    read = dict(re.findall(r"([\w.\[\]]+): (\w+)", p.fields("sim").get("grids", "")))
    p.change("sim", grids={**read, **{name: grids[name] for name in names}})
    return {name: f"sim.{name}" for name in names}


def _halve(p: Any, voxel: float) -> None:
    """Makes all that follows the reader of grids see them at half size."""
    if "sim" not in [str(node) for node in p.nodes()]:
        return
    takers = [node for node in p.nodes() if str(node) != "sim"]
    p.grid.resample(source="sim", voxel_size=voxel, name="small")
    for node in takers:
        fields = p.fields(node)
        halved = {name: _of_small(value) for name, value in fields.items() if name not in ("path", "doc")}
        changed = {name: value for name, value in halved.items() if value != fields[name]}
        if changed:
            p.change(node, **changed)
    fields = p.fields("seams")
    count = "count" if "count" in fields else "amount"
    if not fields[count].endswith("%"):
        p.change("seams", **{count: round(float(fields[count]) / 2) or 1})


def _of_small(value: str) -> Any:
    """A field, as the text that `check` prints, with what is of `sim` taken of `small`."""
    swapped = re.sub(r"(?<![\w.])sim(?=[.,\]]|$)", "small", value)
    if swapped == value or not swapped.startswith("["):
        return swapped
    return swapped[1:-1].split(", ")
