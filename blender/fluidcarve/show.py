"""Puts what the program wrote into the scene: the carved volume, lattice, seams, energy, meshes."""

from __future__ import annotations

import os
import re
from typing import List, Optional, Sequence, Tuple

import bpy

from . import lines, scene

_COLLECTION = "fluidcarve"
_COLOURS = {"folded": (1, 0.05, 0.03, 1), "seams": (1, 0.55, 0.05, 0.6)}


def _collection() -> bpy.types.Collection:
    found = bpy.data.collections.get(_COLLECTION)
    if found is None:
        found = bpy.data.collections.new(_COLLECTION)
    if found.name not in bpy.context.scene.collection.children:
        bpy.context.scene.collection.children.link(found)
    return found


def _object(volume: bpy.types.Object, use: str, data: bpy.types.ID) -> bpy.types.Object:
    """The object of a use, `lattice` or `carved`, of a volume, with new data in the volume's place."""
    settings = volume.fluidcarve
    found = getattr(settings, use)
    if found is None or found.name not in bpy.data.objects or found.type != _type_of(data):
        found = bpy.data.objects.new(f"{volume.name} {use}", data)
        _collection().objects.link(found)
        setattr(settings, use, found)
    else:
        old, found.data = found.data, data
        if old is not None and old.users == 0:
            bpy.data.batch_remove([old])
    found.parent = None
    found.matrix_world = volume.matrix_world
    return found


def _type_of(data: bpy.types.ID) -> str:
    return "VOLUME" if isinstance(data, bpy.types.Volume) else "MESH"


def _material(name: str) -> bpy.types.Material:
    name = f"fluidcarve {name}"
    found = bpy.data.materials.get(name)
    if found is None:
        found = bpy.data.materials.new(name)
        colour = _COLOURS[name.rpartition(" ")[2]]
        found.diffuse_color = colour
        found.use_nodes = True
        nodes = found.node_tree.nodes
        nodes.clear()
        glow, out = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        glow.inputs["Color"].default_value = colour
        found.node_tree.links.new(glow.outputs[0], out.inputs["Surface"])
    return found


def lattice(volume: bpy.types.Object, path: str) -> bpy.types.Object:
    """Draws a lattice: its mesh is all that the program writes, of which a modifier shows the sides. Folded cells are red."""
    read = lines.read_obj(path)
    red = lines.folded(read)
    mesh = bpy.data.meshes.new("lattice")
    mesh.from_pydata(read.vertices, read.edges, [])
    out = _object(volume, "lattice", mesh)
    out.display_type = "WIRE"
    out.hide_render = True
    out.show_in_front = True
    out.vertex_groups.clear()
    out.vertex_groups.new(name="sides").add(lines.hull(read), 1, "REPLACE")
    sides = out.modifiers.get("sides") or out.modifiers.new("sides", "MASK")
    sides.vertex_group = "sides"
    _folded_cells(out, read, red)
    return out


def _folded_cells(owner: bpy.types.Object, read: lines.Geometry, red: List[Tuple[int, int, int, int]]) -> None:
    """The folded cells as red faces, in front of all."""
    name = f"{owner.name} folded"
    old = bpy.data.objects.get(name)
    if old is not None:
        bpy.data.batch_remove([old.data, old] if old.data.users == 1 else [old])
    if not red:
        return
    at = {vertex: n for n, vertex in enumerate(sorted({vertex for face in red for vertex in face}))}
    mesh = bpy.data.meshes.new("folded")
    mesh.from_pydata([read.vertices[each] for each in at], [], [[at[each] for each in face] for face in red])
    mesh.materials.append(_material("folded"))
    cells = bpy.data.objects.new(name, mesh)
    _collection().objects.link(cells)
    cells.parent = owner
    cells.hide_render = True
    cells.show_in_front = True


def seams(volume: bpy.types.Object, path: str, number: int) -> Optional[bpy.types.Object]:
    """Draws a frame's seams as surfaces, hidden at first."""
    if not path or not os.path.exists(scene.of_frame(path, number)):
        return None
    read = lines.read_obj(scene.of_frame(path, number))
    mesh = bpy.data.meshes.new("seams")
    mesh.from_pydata(read.vertices, [], list(lines.sheets(read)))
    mesh.materials.append(_material("seams"))
    out = _object(volume, "seams", mesh)
    out.hide_render = True
    out.hide_viewport = True
    return out


def energy(volume: bpy.types.Object, path: str, source: scene.Source, numbers: Sequence[int]) -> bpy.types.Object:
    """Draws the energy as a slice through the volume, hidden at first."""
    data = _sequence("energy", path, numbers, source)
    data.display.use_slice = True
    data.display.slice_axis = "AUTO"
    out = _object(volume, "slice", data)
    out.hide_render = True
    out.hide_viewport = True
    return out


def carved(volume: bpy.types.Object, path: str, source: scene.Source, numbers: Sequence[int]) -> bpy.types.Object:
    """Puts the carved files of frames in the place of a volume, which is hidden."""
    if path.endswith((".obj", ".ply")):
        out = _object(volume, "carved", bpy.data.meshes.new("carved"))
        volume.fluidcarve.sequence = path
        mesh_of_frame(volume)
    elif path.endswith(".vdb"):
        data = _sequence("carved", path, numbers, source)
        for attribute in ("density", "interpolation_method", "wireframe_type", "wireframe_detail"):
            setattr(data.display, attribute, getattr(volume.data.display, attribute))
        for attribute in ("space", "step_size", "clipping"):
            setattr(data.render, attribute, getattr(volume.data.render, attribute))
        out = _object(volume, "carved", data)
    else:
        return volume  # images are files
    out.data.materials.clear()
    for material in volume.data.materials:
        out.data.materials.append(material)
    flip(volume)
    return out


def _numbers(path: str) -> List[int]:
    """Numbers of the files of a path that are there."""
    folder, name = os.path.split(path)
    if "#" not in name:
        return [1]
    head, token, tail = re.fullmatch(r"(.*?)(#+)(.*)", name).groups()
    pattern = re.compile(re.escape(head) + r"(\d{" + str(len(token)) + r",})" + re.escape(tail))
    return sorted(int(found.group(1)) for found in map(pattern.fullmatch, os.listdir(folder)) if found) if os.path.isdir(folder) else []


def _sequence(name: str, path: str, numbers: Sequence[int], source: scene.Source) -> bpy.types.Volume:
    data = bpy.data.volumes.new(name)
    data.filepath = scene.of_frame(path, numbers[0])
    data.is_sequence = "#" in path
    data.frame_duration = numbers[-1] - numbers[0] + 1
    data.frame_offset = numbers[0] - 1
    data.frame_start = source.scene_frame(numbers[0])
    return data


def flip(volume: bpy.types.Object) -> None:
    """Shows the source, or what was carved of it."""
    settings = volume.fluidcarve
    if settings.carved is None:
        return
    after = settings.shown == "after"
    for thing, shown in ((volume, not after), (settings.carved, after)):
        thing.hide_set(not shown)
        thing.hide_viewport = False
        thing.hide_render = not shown


def mesh_of_frame(volume: bpy.types.Object) -> None:
    """Gives the carved mesh of a volume, or its particles as vertices, those of the scene's frame."""
    settings = volume.fluidcarve
    numbers = _numbers(settings.sequence)
    if settings.carved is None or not numbers:
        return
    source = scene.source_of(volume)
    wanted = source.number(bpy.context.scene.frame_current)
    path = scene.of_frame(settings.sequence, min(numbers, key=lambda each: abs(each - wanted)))
    mesh = settings.carved.data
    mesh.clear_geometry()
    if path.endswith(".ply"):
        points = lines.read_points(path)
        mesh.vertices.add(len(points))
        mesh.vertices.foreach_set("co", points.ravel())
        mesh.update()
        return
    read = lines.read_obj(path)
    mesh.from_pydata(read.vertices, [], read.faces)
    if read.textures and -1 not in read.corners:
        layer = mesh.uv_layers.new(name="UVMap")
        for loop, corner in zip(layer.data, read.corners):
            loop.uv = read.textures[corner]
    mesh.update()
