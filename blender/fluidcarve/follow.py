"""Follows what the artist does: draws the lattice anew while its curve changes, and shows each frame's own meshes."""

from __future__ import annotations

import os
import tempfile
from typing import Optional, Set

import bpy
from bpy.app.handlers import persistent

_WAIT = 0.15  # seconds without a change before the lattice is drawn
_changed: Set[str] = set()  # names of volumes


def on_setting(settings: bpy.types.PropertyGroup, _context: object) -> None:
    """A setting of the lattice was changed."""
    _ask(settings.id_data)


def on_shown(settings: bpy.types.PropertyGroup, _context: object) -> None:
    """Before or after was chosen."""
    from . import show

    show.flip(settings.id_data)


def _ask(volume: bpy.types.Object) -> None:
    if volume.type != "VOLUME" or not volume.fluidcarve.live:
        return
    _changed.add(volume.name)
    if bpy.app.background:  # timers do not run
        return
    if bpy.app.timers.is_registered(_draw_changed):
        bpy.app.timers.unregister(_draw_changed)
    bpy.app.timers.register(_draw_changed, first_interval=_WAIT)


def _draw_changed() -> None:
    while _changed:
        volume = bpy.data.objects.get(_changed.pop())
        if volume is not None and volume.fluidcarve.rig is not None:
            draw(volume)


def draw(volume: bpy.types.Object) -> Optional[bpy.types.Object]:
    """Draws the lattice of the frame, as the program builds it. What is wrong is the volume's status."""
    from . import scene, shot, show
    from .api import fluidcarve

    settings = volume.fluidcarve
    try:
        facts = shot.known_facts(volume)
        with tempfile.TemporaryDirectory(prefix="fluidcarve-") as folder:
            rig, drawn = os.path.join(folder, "rig.csv"), os.path.join(folder, "lattice.obj")
            shot.write_points(rig, scene.curve_points(settings.rig, scene.to_files(volume)))
            p = fluidcarve.Pipeline(frames=1)
            shot.add_lattice(p, volume, rig, shot.spacing_of(volume, facts))
            p.lattice.write(lattice="bent", path=drawn)
            result = fluidcarve.run(p, no_cache=True, threads=1)
            out = show.lattice(volume, drawn)
        settings.status = "\n".join(each.message for each in result.warnings)
        return out
    except fluidcarve.Error as error:
        settings.status = "\n".join(each.message for each in error.problems)
        return None


@persistent
def _on_change(_scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> None:
    touched = {update.id.original for update in graph.updates if isinstance(update.id, (bpy.types.Object, bpy.types.Curve))}
    if not touched:
        return
    for volume in _volumes():
        rig = volume.fluidcarve.rig
        if rig is not None and (rig in touched or rig.data in touched):
            _ask(volume)


@persistent
def _on_frame(_scene: bpy.types.Scene, _graph: object = None) -> None:
    from . import scene, show

    for volume in _volumes():
        if volume.fluidcarve.sequence:
            show.mesh_of_frame(volume)
        if scene.is_animated(volume.fluidcarve.rig):
            _ask(volume)


@persistent
def _on_load(_path: object) -> None:
    from . import run

    run.forget()


def _volumes() -> list:
    return [each for each in bpy.data.objects if each.type == "VOLUME" and (each.fluidcarve.rig is not None or each.fluidcarve.sequence)]


_HANDLERS = (("depsgraph_update_post", _on_change), ("frame_change_post", _on_frame), ("load_post", _on_load))


def register() -> None:
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    if bpy.app.timers.is_registered(_draw_changed):
        bpy.app.timers.unregister(_draw_changed)
