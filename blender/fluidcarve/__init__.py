"""fluidcarve in Blender: carves the files of a volume object, in a lattice along a curve of the scene."""

bl_info = {
    "name": "fluidcarve",
    "description": "Resize finished simulations, and keep their look",
    "author": "The fluidcarve developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > fluidcarve",
    "category": "Physics",
}

from . import follow, panel, run, settings  # noqa: E402

_PARTS = (settings, run, panel, follow)


def register() -> None:
    for part in _PARTS:
        part.register()


def unregister() -> None:
    for part in reversed(_PARTS):
        part.unregister()
