"""The panel in the 3D view's sidebar, and the add-on's preferences."""

import json
import textwrap

import bpy

from . import run
from .settings import axis


class FLUIDCARVE_preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(name="Program", subtype="FILE_PATH", description="The program fluidcarve. Empty: the one beside the add-on, or on PATH")

    def draw(self, _context):
        self.layout.prop(self, "program")


class _Panel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "fluidcarve"

    @classmethod
    def poll(cls, context):
        return run.volume_of(context) is not None


class FLUIDCARVE_PT_carve(_Panel, bpy.types.Panel):
    bl_idname = "FLUIDCARVE_PT_carve"
    bl_label = "fluidcarve"

    @classmethod
    def poll(cls, _context):
        return True

    def draw(self, context):
        layout, volume = self.layout, run.volume_of(context)
        if volume is None:
            layout.label(text="Select a volume", icon="OUTLINER_OB_VOLUME")
            return
        settings = volume.fluidcarve
        layout.use_property_split = True
        layout.use_property_decorate = False
        row = layout.row()
        row.label(text=volume.name, icon="OUTLINER_OB_VOLUME")
        row.operator("fluidcarve.look", text="", icon="VIEWZOOM")
        _say(layout, context, _told(settings.facts))
        layout.prop(settings, "files")
        _size(layout, settings)
        _buttons(layout, context, volume)


class FLUIDCARVE_PT_lattice(_Panel, bpy.types.Panel):
    bl_parent_id = "FLUIDCARVE_PT_carve"
    bl_label = "Lattice"

    def draw(self, context):
        layout, settings = self.layout, run.volume_of(context).fluidcarve
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings, "rig")
        if settings.rig is None:
            layout.label(text="A box around the content")
            return
        for name in ("up", "reach_u", "reach_v", "spacing"):
            layout.prop(settings, name)
        row = layout.row()
        row.prop(settings, "live", toggle=True)
        row.operator("fluidcarve.lattice", text="", icon="FILE_REFRESH")


class FLUIDCARVE_PT_masks(_Panel, bpy.types.Panel):
    bl_parent_id = "FLUIDCARVE_PT_carve"
    bl_label = "What must stay, what must go"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, settings = self.layout, run.volume_of(context).fluidcarve
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("protect", "attract", "window_low", "window_high"):
            layout.prop(settings, name)


class FLUIDCARVE_PT_look(_Panel, bpy.types.Panel):
    bl_parent_id = "FLUIDCARVE_PT_carve"
    bl_label = "Look"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, settings = self.layout, run.volume_of(context).fluidcarve
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("energy", "thick", "empty", "anchor", "conserve"):
            layout.prop(settings, name)


def _told(facts):
    """What the panel says of a volume's files."""
    if not facts:
        return []
    known = json.loads(facts)
    out = []
    if "frames" in known:
        first, last, count = known["frames"]
        out.append(f"frames {first} to {last}" + (f", {last - first + 1 - count} missing" if count != last - first + 1 else ""))
    grids = [grid["name"] for grid in known.get("grids", []) if grid.get("active_voxels")]
    if grids:
        sizes = [grid["transform"]["voxel_size"][0] for grid in known["grids"] if grid.get("active_voxels")]
        out.append(f"{', '.join(grids)}; voxels of {sizes[0]:.4g}")
    elif "kind" in known:
        out.append(known["kind"])
    return out


def _size(layout, settings) -> None:
    layout.prop(settings, "rig_axis" if settings.rig else "box_axis", expand=False)
    if axis(settings) != "t":
        row = layout.row(align=True)
        row.prop(settings, "amount")
        row.prop(settings, "unit", text="")
        return
    layout.prop(settings, "time")
    layout.prop(settings, {"CARVE": "frames", "RETIME": "speed", "LOOP": "loop"}[settings.time])


def _say(layout, context, lines) -> None:
    """Lines of text, wrapped as the panel is wide."""
    column = layout.column(align=True)
    letters = max(20, int(context.region.width / context.preferences.system.ui_scale / 7))
    for line in lines:
        for part in textwrap.wrap(line, letters):
            column.label(text=part)


def _buttons(layout, context, volume) -> None:
    settings = volume.fluidcarve
    if run.job_of(volume) is not None:
        layout.operator("fluidcarve.cancel", icon="CANCEL")
    else:
        row = layout.row(align=True)
        row.operator("fluidcarve.check")
        row.operator("fluidcarve.carve", text="Preview").preview = True
        row.operator("fluidcarve.carve", icon="PLAY").preview = False
    _say(layout, context, settings.status.splitlines()[:6])
    if settings.carved is not None:
        layout.row().prop(settings, "shown", expand=True)
        column = layout.column(align=True)
        for name, text in (("lattice", "Lattice"), ("seams", "Seams"), ("slice", "Energy")):
            thing = getattr(settings, name)
            if thing is not None:
                column.prop(thing, "hide_viewport", text=text, invert_checkbox=True)


_CLASSES = (FLUIDCARVE_preferences, FLUIDCARVE_PT_carve, FLUIDCARVE_PT_lattice, FLUIDCARVE_PT_masks, FLUIDCARVE_PT_look)


def register() -> None:
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
