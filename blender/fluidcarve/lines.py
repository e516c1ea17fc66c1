"""Reads what the program writes to look at: lattices and seams as lines and carved meshes in .obj files, particles in .ply files."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, Iterator, List, Tuple

import numpy
from mathutils import Vector

Vertex = Tuple[float, float, float]


@dataclass
class Geometry:
    """Vertices and what joins them, by index from 0."""

    vertices: List[Vertex] = field(default_factory=list)
    edges: List[Tuple[int, int]] = field(default_factory=list)
    faces: List[Tuple[int, ...]] = field(default_factory=list)
    textures: List[Tuple[float, float]] = field(default_factory=list)
    corners: List[int] = field(default_factory=list)  # of each corner of each face its texture coordinate; -1: none
    parts: List[Tuple[str, int]] = field(default_factory=list)  # names of objects, and the first vertex of each


def read_obj(path: str) -> Geometry:
    """An .obj file."""
    out = Geometry()
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            word, *rest = line.split() or [""]
            if word == "v":
                out.vertices.append((float(rest[0]), float(rest[1]), float(rest[2])))
            elif word == "vt":
                out.textures.append((float(rest[0]), float(rest[1])))
            elif word == "o":
                out.parts.append((" ".join(rest), len(out.vertices)))
            elif word == "l":
                ends = [int(each.split("/")[0]) - 1 for each in rest]
                out.edges += zip(ends, ends[1:])
            elif word == "f":
                corners = [each.split("/") for each in rest]
                out.faces.append(tuple(int(each[0]) - 1 for each in corners))
                out.corners += [int(each[1]) - 1 if len(each) > 1 and each[1] else -1 for each in corners]
    return out


def read_points(path: str) -> "numpy.ndarray":
    """Positions of the points in a .ply file of the program's, as (n, 3) floats. Raises ValueError if it is another kind of file."""
    types = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8"}
    with open(path, "rb") as file:
        count, fields = 0, []
        for line in iter(lambda: file.readline().split(), [b"end_header"]):
            if line[:2] == [b"element", b"vertex"]:
                count = int(line[2])
            elif line[:1] == [b"property"]:
                fields.append((line[2].decode(), types[line[1].decode()]))
            elif line[:1] == [b"format"] and line[1] != b"binary_little_endian":
                raise ValueError(f"{path} is not little endian")
        read = numpy.fromfile(file, numpy.dtype(fields), count)
    return numpy.stack([read[name].astype(numpy.float32) for name in "xyz"], axis=1)


def strides(lattice: Geometry) -> List[int]:
    """How far apart neighbours along u, v and w are in a lattice's vertices; fewer, if it is a plane."""
    return sorted({b - a for a, b in lattice.edges if b > a})


def hull(lattice: Geometry) -> List[int]:
    """The vertices of a lattice's sides: those at either end of u or of v. All, if it is a plane or goes around its rig."""
    steps = strides(lattice)
    if len(steps) != 3 or steps[0] != 1:
        return list(range(len(lattice.vertices)))
    row, plane = steps[1], steps[2]
    return [n for n in range(len(lattice.vertices)) if n % row in (0, row - 1) or n % plane // row in (0, plane // row - 1)]


def folded(lattice: Geometry) -> List[Tuple[int, int, int, int]]:
    """Faces beside the lines of a lattice that run backwards: where its planes cross.

    A line from plane to plane is folded if it runs against the mean of all between these planes.
    """
    steps = strides(lattice)
    if len(steps) < 3:
        return []
    across, plane = steps[:2], steps[2]
    edges = set(lattice.edges)
    between: Dict[int, List[Tuple[int, Vector]]] = {}
    for a, b in lattice.edges:
        if b - a == plane:
            between.setdefault(a // plane, []).append((a, Vector(lattice.vertices[b]) - Vector(lattice.vertices[a])))
    out = []
    for lines in between.values():
        mean = sum((each for _, each in lines), Vector())
        for a, each in lines:
            if each.dot(mean) <= 0:
                out += [(a, a + step, a + step + plane, a + plane) for step in across if (a, a + step) in edges]
                out += [(a - step, a, a + plane, a - step + plane) for step in across if (a - step, a) in edges]
    return sorted(set(out))


def sheets(seams: Geometry) -> Iterator[Tuple[int, int, int, int]]:
    """Faces of seams, each an object of lines with vertices of their own: between neighbours of its lines in one direction.

    The lines in the one direction come first, then those in the other.
    """
    ends = [first for _, first in seams.parts[1:]] + [len(seams.vertices)]
    joined = {a for a, b in seams.edges if b == a + 1}
    for (_, first), end in zip(seams.parts, ends):
        rows: List[List[int]] = [[first]]
        for vertex in range(first + 1, end):
            if vertex - 1 in joined:
                rows[-1].append(vertex)
            else:
                rows.append([vertex])
        alike = [row for row in rows if len(row) == len(rows[0])]
        if len(alike) == len(rows):  # as many vertices in both directions
            alike = alike[:len(alike) // 2]
        for a, b in zip(alike, alike[1:]):
            for n in range(len(a) - 1):
                yield a[n], a[n + 1], b[n + 1], b[n]
