"""What an artist sets for a volume. It is saved with the object."""

import bpy

from . import follow

_RIG_AXES = (
    ("u", "Across", "Narrower or wider, across the curve"),
    ("v", "Up", "Lower or taller, along the curve's up direction"),
    ("w", "Along", "Shorter or longer, along the curve"),
    ("t", "Time", "Shorter or longer in time"),
)
_BOX_AXES = (
    ("x", "X", "Along X of the volume"),
    ("y", "Y", "Along Y of the volume"),
    ("z", "Z", "Along Z of the volume"),
    ("t", "Time", "Shorter or longer in time"),
)
_UNITS = (
    ("PERCENT", "%", "A share of the size"),
    ("LENGTH", "Length", "In the scene's units"),
    ("VOXELS", "Voxels", "Whole voxels"),
)
_TIMES = (
    ("CARVE", "Own pace", "Frames leave, or are added, where nobody sees it"),
    ("RETIME", "Speed", "Faster or slower throughout"),
    ("LOOP", "Loop", "A part of the sequence that repeats for ever"),
)
_ANCHORS = (
    ("auto", "Automatic", "The end that stands still, where the source is"),
    ("low", "Low", "The low end stays in place"),
    ("middle", "Middle", "The middle stays in place"),
    ("high", "High", "The high end stays in place"),
)
_SHOWN = (("before", "Before", "Show the source"), ("after", "After", "Show the carved volume"))


def _is_curve(_self: object, other: bpy.types.Object) -> bool:
    return other.type == "CURVE"


def _is_region(_self: object, other: bpy.types.Object) -> bool:
    return other.type in {"MESH", "EMPTY"}


def _is_empty(_self: object, other: bpy.types.Object) -> bool:
    return other.type == "EMPTY"


def _region(name: str, description: str) -> object:
    return bpy.props.PointerProperty(type=bpy.types.Object, name=name, description=description, poll=_is_region)


class FLUIDCARVE_settings(bpy.types.PropertyGroup):
    """How a volume is carved, and what came of it."""

    files: bpy.props.StringProperty(
        name="Files", subtype="FILE_PATH",
        description="One file of a sequence to carve in place of the volume: particles, meshes or images. Empty: the volume's own files")
    # Size.
    amount: bpy.props.FloatProperty(name="Change", default=-20, description="How much smaller (below 0) or larger (above 0)")
    unit: bpy.props.EnumProperty(items=_UNITS, name="Unit")
    box_axis: bpy.props.EnumProperty(items=_BOX_AXES, name="Axis")
    rig_axis: bpy.props.EnumProperty(items=_RIG_AXES, name="Axis", update=follow.on_setting)
    anchor: bpy.props.EnumProperty(items=_ANCHORS, name="Anchor", description="What stays in place")
    # Time.
    time: bpy.props.EnumProperty(items=_TIMES, name="Time")
    speed: bpy.props.FloatProperty(name="Speed", default=0.5, min=-100, max=100, description="2 is twice as fast; below 0 plays backwards")
    frames: bpy.props.IntProperty(name="Frames", default=-6, description="Frames that leave (below 0) or are added (above 0)")
    loop: bpy.props.IntVectorProperty(name="Length", size=2, default=(20, 30), min=2, description="Least and greatest length of the loop, in frames")
    # Lattice.
    rig: bpy.props.PointerProperty(type=bpy.types.Object, name="Curve", poll=_is_curve, update=follow.on_setting,
                                   description="The lattice runs along this curve. None: a box around the content")
    up: bpy.props.FloatVectorProperty(name="Up", size=3, default=(0, 0, 1), subtype="DIRECTION", update=follow.on_setting,
                                      description="Direction of the lattice's second axis at the curve's start, in the scene")
    reach_u: bpy.props.FloatVectorProperty(name="Across", size=2, default=(-1, 1), update=follow.on_setting, unit="LENGTH",
                                           description="Where the lattice begins and ends across the curve")
    reach_v: bpy.props.FloatVectorProperty(name="Up", size=2, default=(-1, 1), update=follow.on_setting, unit="LENGTH",
                                           description="Where the lattice begins and ends along Up")
    spacing: bpy.props.FloatProperty(name="Spacing", min=0, update=follow.on_setting, subtype="DISTANCE", precision=4,
                                     description="Distance of the lattice's vertices. 0: the size of a voxel")
    live: bpy.props.BoolProperty(name="Draw", default=True, update=follow.on_setting, description="Draw the lattice while the curve changes")
    # Masks.
    protect: _region("Protect", "No seam passes this mesh or empty")
    attract: _region("Attract", "Seams take this mesh or empty first")
    window_low: bpy.props.PointerProperty(type=bpy.types.Object, name="From", poll=_is_empty, description="Seams stay above this empty")
    window_high: bpy.props.PointerProperty(type=bpy.types.Object, name="To", poll=_is_empty, description="Seams stay below this empty")
    # Look.
    energy: bpy.props.PointerProperty(
        type=bpy.types.Text, name="Energy",
        description="A text with a function `energy(density, at)` in Python: what must keep its look. Its arguments name grids")
    thick: bpy.props.IntProperty(name="Thickness", default=0, min=0, max=10000, description="Voxels that a seam takes. 0: as the content asks for")
    empty: bpy.props.FloatProperty(name="Empty space", default=0, min=0, max=100,
                                   description="Price of empty space beside content: more takes more from the content. 0: automatic")
    conserve: bpy.props.BoolProperty(name="Keep mass", description="Keep the mass of densities")
    # What is known and what came of it. The add-on sets these.
    facts: bpy.props.StringProperty()
    status: bpy.props.StringProperty()
    carved: bpy.props.PointerProperty(type=bpy.types.Object)
    lattice: bpy.props.PointerProperty(type=bpy.types.Object)
    seams: bpy.props.PointerProperty(type=bpy.types.Object)
    slice: bpy.props.PointerProperty(type=bpy.types.Object)
    shown: bpy.props.EnumProperty(items=_SHOWN, name="Show", default="after", update=follow.on_shown)
    sequence: bpy.props.StringProperty(description="Files of meshes of which each frame shows its own")


def axis(settings: FLUIDCARVE_settings) -> str:
    """u, v, w along a curve; x, y, z in a box; t."""
    return settings.rig_axis if settings.rig else settings.box_axis


def register() -> None:
    bpy.utils.register_class(FLUIDCARVE_settings)
    bpy.types.Object.fluidcarve = bpy.props.PointerProperty(type=FLUIDCARVE_settings)


def unregister() -> None:
    del bpy.types.Object.fluidcarve
    bpy.utils.unregister_class(FLUIDCARVE_settings)
