"""What the scene says: a volume's files and frames, and curves and regions in the volume's own space, which is the world of its files."""

from __future__ import annotations

import glob
import os
import re
from dataclasses import dataclass
from typing import Any, Dict, Iterator, List, Optional, Tuple

import bpy
from mathutils import Matrix, Vector

from .api import fluidcarve


def fault(message: str) -> Exception:
    """An error as the program's own: what is wrong; what to do."""
    return fluidcarve.Error([fluidcarve.Problem(message)], 2)


@dataclass(frozen=True)
class Source:
    """Files of a shot: a path with its frame token, and which of them each frame of the scene shows."""

    path: str
    numbers: Tuple[int, ...]  # those that are there
    start: int  # the scene's frame that shows the first of them

    def scene_frame(self, number: int) -> int:
        return number - self.numbers[0] + self.start

    def number(self, scene_frame: int) -> int:
        """The file that a frame of the scene shows; the nearest that is there."""
        wanted = scene_frame - self.start + self.numbers[0]
        return min(self.numbers, key=lambda each: abs(each - wanted))


def source_of(volume: bpy.types.Object) -> Source:
    """The files of a volume object, or those that its settings name.

    Blender takes the last digits of a name for the frame's number, and so does this.
    """
    data, named = volume.data, volume.fluidcarve.files
    path = os.path.normpath(bpy.path.abspath(named or data.filepath))
    if not named and data.packed_file:
        raise fault(f"the file of '{volume.name}' is packed into the .blend file; unpack it, since the program reads files")
    if not os.path.isfile(path):
        raise fault(f"{path} is not there; name a file of '{volume.name}' that is")
    found = re.fullmatch(r"(.*?)(\d+)(\D*)", os.path.basename(path))
    if not found or (not named and not data.is_sequence):
        return Source(path, (1,), 1)
    head, digits, tail = found.groups()
    alike = re.compile(re.escape(head) + r"(\d+)" + re.escape(tail))
    folder = os.path.dirname(path)
    names = (alike.fullmatch(os.path.basename(each)) for each in glob.glob(os.path.join(glob.escape(folder), "*")))
    numbers = tuple(sorted({int(each.group(1)) for each in names if each and (len(each.group(1)) == len(digits) or digits[0] != "0")}))
    pattern = os.path.join(folder, head + "#" * len(digits) + tail)
    if named:
        return Source(pattern, numbers, numbers[0])
    # Scene frame `frame_start` shows file `frame_offset + 1`, for `frame_duration` frames.
    first = data.frame_offset + 1
    shown = tuple(each for each in numbers if first <= each < first + data.frame_duration)
    if not shown:
        raise fault(f"no file of '{volume.name}' lies in its frames, {first} to {first + data.frame_duration - 1}; mend its start and offset")
    return Source(pattern, shown, data.frame_start + shown[0] - first)


def to_files(volume: bpy.types.Object) -> Matrix:
    """From the scene to the world of the volume's files: any affine map."""
    return volume.matrix_world.inverted()


def scale_of(volume: bpy.types.Object) -> float:
    """Lengths of the scene in units of the files: the mean over directions."""
    return abs(to_files(volume).to_3x3().determinant()) ** (1 / 3)


def curve_points(curve: bpy.types.Object, matrix: Matrix) -> List[Tuple[float, float, float]]:
    """Points of a curve's first spline as Blender draws it, in order, at the current frame. Closed: the last is the first.

    matrix  from the scene to where they are wanted
    """
    evaluated = curve.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    if mesh is None:
        raise _no_path(curve)
    try:
        if mesh.polygons:
            raise fault(f"'{curve.name}' is a tube or a filled shape; take its bevel, extrusion and fill away")
        place = matrix @ curve.matrix_world
        vertices = [tuple(place @ vertex.co) for vertex in mesh.vertices]
        after: Dict[int, List[int]] = {}
        for edge in mesh.edges:
            a, b = edge.vertices
            after.setdefault(a, []).append(b)
            after.setdefault(b, []).append(a)
    finally:
        evaluated.to_mesh_clear()
    if len(vertices) < 2 or len(mesh_order := _ordered(after)) < 2:
        raise _no_path(curve)
    return [vertices[each] for each in mesh_order]


def across(points: List[Tuple[float, float, float]], up: Vector, at: Any) -> Tuple[float, float, float]:
    """Where a place lies beside a curve: along u and along v from the curve's nearest point, and that point's share of the length."""
    path = [Vector(each) for each in points]
    lengths = [0.0]
    for a, b in zip(path, path[1:]):
        lengths.append(lengths[-1] + (b - a).length)
    near = min(range(len(path)), key=lambda n: (path[n] - Vector(at)).length)
    w = (path[min(near + 1, len(path) - 1)] - path[max(near - 1, 0)]).normalized()
    v = (up - up.dot(w) * w).normalized()
    away = Vector(at) - path[near]
    return away.dot(v.cross(w)), away.dot(v), lengths[near] / lengths[-1]


def _no_path(curve: bpy.types.Object) -> Exception:
    return fault(f"'{curve.name}' has no path; draw a curve of two points or more")


def _ordered(after: Dict[int, List[int]]) -> List[int]:
    """A walk along edges from vertex 0."""
    out, last, at = [], -1, 0
    while at in after:
        out.append(at)
        onward = [each for each in after[at] if each != last]
        last, at = at, onward[0] if onward else -1
        if at == out[0]:
            return [*out, at]
    return out


def region_faces(region: bpy.types.Object, matrix: Matrix) -> Tuple[List[Vector], List[Tuple[int, ...]]]:
    """A mesh, or an empty as a cube or a sphere of its size, as vertices and faces at the current frame."""
    place = matrix @ region.matrix_world
    if region.type == "EMPTY":
        vertices, faces = _SPHERE if region.empty_display_type == "SPHERE" else _CUBE
        return [place @ (each * region.empty_display_size) for each in vertices], faces
    evaluated = region.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    try:
        return [place @ each.co for each in mesh.vertices], [tuple(each.vertices) for each in mesh.polygons]
    finally:
        evaluated.to_mesh_clear()


def _cube() -> Tuple[List[Vector], List[Tuple[int, ...]]]:
    corners = [Vector((x, y, z)) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    return corners, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def _sphere(rings: int = 12) -> Tuple[List[Vector], List[Tuple[int, ...]]]:
    import math

    around = 2 * rings
    corners = [Vector((0, 0, 1)), Vector((0, 0, -1))]
    for ring in range(1, rings):
        polar = math.pi * ring / rings
        corners += [Vector((math.sin(polar) * math.cos(math.pi * n / rings), math.sin(polar) * math.sin(math.pi * n / rings), math.cos(polar)))
                    for n in range(around)]
    at = lambda ring, n: 2 + (ring - 1) * around + n % around
    faces: List[Tuple[int, ...]] = [(0, at(1, n), at(1, n + 1)) for n in range(around)]
    faces += [(at(ring, n), at(ring + 1, n), at(ring + 1, n + 1), at(ring, n + 1)) for ring in range(1, rings - 1) for n in range(around)]
    faces += [(1, at(rings - 1, n + 1), at(rings - 1, n)) for n in range(around)]
    return corners, faces


_CUBE, _SPHERE = _cube(), _sphere()


def is_animated(thing: Optional[bpy.types.Object]) -> bool:
    """Whether an object, its data or what it hangs on may change from frame to frame."""
    while thing is not None:
        keys = getattr(thing.data, "shape_keys", None)
        if any(getattr(each, "animation_data", None) for each in (thing, thing.data, keys)) or thing.constraints or thing.modifiers:
            return True
        thing = thing.parent
    return False


def each_frame(source: Source, things: List[Optional[bpy.types.Object]]) -> Iterator[Optional[int]]:
    """Goes through the frames in which things move, and comes back: yields numbers of files; once None if nothing moves."""
    if not any(is_animated(each) for each in things):
        yield None
        return
    scene = bpy.context.scene
    before = scene.frame_current
    try:
        for number in source.numbers:
            scene.frame_set(source.scene_frame(number))
            yield number
    finally:
        scene.frame_set(before)


def facts_of(source: Source) -> Dict[str, Any]:
    """What the program says of the first of the files that shows something: `inspect`'s entry for it."""
    middle = source.numbers[len(source.numbers) // 2]
    told = fluidcarve.inspect(of_frame(source.path, middle)).files[0]
    if "error" in told:
        raise fault(f"{told['file']}: {told['error']}")
    return told


def of_frame(path: str, number: int) -> str:
    """The file of a frame."""
    return re.sub(r"#+", lambda token: str(number).zfill(len(token.group(0))), path)
