"""The buttons: look at files, draw, check, preview, carve, cancel."""

import json
import os

import bpy

from . import follow, scene, shot, show
from .api import fluidcarve, set_program

_jobs = {}  # names of volumes, and the jobs that carve them


def job_of(volume):
    """The job that carves a volume; None: none does."""
    return _jobs.get(volume.name)


def forget() -> None:
    """Ends all jobs: another file was opened. What they finished is in the work folder."""
    for job in _jobs.values():
        job.cancel()
    _jobs.clear()
    for volume in bpy.data.objects:
        if volume.fluidcarve.status.endswith("%"):
            volume.fluidcarve.status = "was carving when the file was saved; Carve goes on"


def prepare(context) -> None:
    """Finds the program, as the preferences have it."""
    addon = context.preferences.addons.get(__package__)
    set_program(bpy.path.abspath(addon.preferences.program) if addon and addon.preferences.program else "")


def volume_of(context):
    """The volume that the buttons are for: the active object, or the one that a carved one came of."""
    active = context.object
    if active is None:
        return None
    if active.type == "VOLUME" and not any(active in (other.fluidcarve.carved, other.fluidcarve.slice) for other in bpy.data.objects):
        return active
    for other in bpy.data.objects:
        if other.type == "VOLUME" and active in (other.fluidcarve.carved, other.fluidcarve.lattice, other.fluidcarve.seams, other.fluidcarve.slice):
            return other
    return None


class _Button:
    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context):
        return volume_of(context) is not None and job_of(volume_of(context)) is None

    def fail(self, error, volume) -> None:
        """Tells all problems, and opens the pipeline at the first place."""
        volume.fluidcarve.status = "\n".join(str(each) for each in error.problems)
        for problem in error.problems:
            self.report({"ERROR"}, str(problem))
        place = next((each for each in error.problems if each.line and os.path.isfile(each.file)), None)
        if place is not None:
            _open_text(place)


def _open_text(place) -> None:
    path = os.path.abspath(place.file)
    old = next((each for each in bpy.data.texts if each.filepath and os.path.abspath(bpy.path.abspath(each.filepath)) == path), None)
    if old is not None:
        bpy.data.texts.remove(old)
    text = bpy.data.texts.load(path)
    text.cursor_set(place.line - 1, character=max(place.column - 1, 0))
    for area in bpy.context.screen.areas if bpy.context.screen else ():
        if area.type == "TEXT_EDITOR":
            area.spaces.active.text = text
            break


class FLUIDCARVE_OT_look(_Button, bpy.types.Operator):
    """Look at the volume's files: grids, frames, voxel size; and let the lattice reach around their content"""

    bl_idname = "fluidcarve.look"
    bl_label = "Inspect"

    def execute(self, context):
        volume = volume_of(context)
        prepare(context)
        try:
            source = scene.source_of(volume)
            facts = scene.facts_of(source)
            volume.fluidcarve.facts = json.dumps({**facts, "frames": [source.numbers[0], source.numbers[-1], len(source.numbers)]})
            if facts["kind"] != "image":
                shot.fit(volume, source)
        except fluidcarve.Error as error:
            self.fail(error, volume)
            return {"CANCELLED"}
        volume.fluidcarve.status = ""
        return {"FINISHED"}


class FLUIDCARVE_OT_lattice(_Button, bpy.types.Operator):
    """Draw the lattice along the curve; cells that fold are red"""

    bl_idname = "fluidcarve.lattice"
    bl_label = "Draw lattice"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and volume_of(context).fluidcarve.rig is not None

    def execute(self, context):
        volume = volume_of(context)
        prepare(context)
        if follow.draw(volume) is None:
            self.report({"ERROR"}, volume.fluidcarve.status)
            return {"CANCELLED"}
        return {"FINISHED"}


class FLUIDCARVE_OT_check(_Button, bpy.types.Operator):
    """Write the pipeline, and check all that can be known without running it"""

    bl_idname = "fluidcarve.check"
    bl_label = "Check"

    def execute(self, context):
        volume = volume_of(context)
        prepare(context)
        try:
            made = shot.write(volume)
            warnings = fluidcarve.check(made.pipeline, allow_plugins=made.allow_plugins)
            seconds = fluidcarve.plan(made.pipeline, allow_plugins=made.allow_plugins).seconds
        except fluidcarve.Error as error:
            self.fail(error, volume)
            return {"CANCELLED"}
        for each in warnings:
            self.report({"WARNING"}, str(each))
        volume.fluidcarve.status = "\n".join(str(each) for each in warnings) or "the pipeline is right" + (f"; about {seconds:.0f} s" if seconds else "")
        return {"FINISHED"}


class FLUIDCARVE_OT_carve(_Button, bpy.types.Operator):
    """Carve the volume's files. Those that are finished stay, so that a cancelled carve goes on"""

    bl_idname = "fluidcarve.carve"
    bl_label = "Carve"

    preview: bpy.props.BoolProperty(name="Preview", description="Three frames around this one, at half size")

    def execute(self, context):
        """Carves and waits."""
        if not self._start(context):
            return {"CANCELLED"}
        try:
            return self._end(context)
        finally:
            _jobs.pop(self._name, None)

    def invoke(self, context, _event):
        """Carves in the background of the interface."""
        if bpy.app.background:
            return self.execute(context)
        if not self._start(context):
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._job is not _jobs.get(self._name):  # another file was opened
            self._leave(context)
            return {"CANCELLED"}
        if self._job.poll():
            volume = bpy.data.objects.get(self._name)
            context.window_manager.progress_update(self._percent)
            context.workspace.status_text_set(f"fluidcarve: {volume.fluidcarve.status if volume else ''}")
            for area in context.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()
            return {"PASS_THROUGH"}
        self._leave(context)
        _jobs.pop(self._name, None)
        return self._end(context)

    def _leave(self, context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _start(self, context) -> bool:
        volume = volume_of(context)
        prepare(context)
        self._name, self._percent = volume.name, 0
        try:
            self._shot = shot.write(volume, self.preview)
            self._job = fluidcarve.start(self._shot.pipeline, progress=self._hear, allow_plugins=self._shot.allow_plugins,
                                         work=os.path.join(self._shot.folder, ".fluidcarve"))
        except fluidcarve.Error as error:
            self.fail(error, volume)
            return False
        _jobs[self._name] = self._job
        return True

    def _hear(self, event) -> None:
        volume = bpy.data.objects.get(self._name)
        if volume is not None and event.event == "progress":
            self._percent = int(100 * event.fraction)
            left = f", {event.left_s:.0f} s left" if event.left_s else ""
            volume.fluidcarve.status = f"{event.at}{left}, {self._percent} %"

    def _end(self, context):
        volume = bpy.data.objects.get(self._name)
        if volume is None:
            self.report({"WARNING"}, f"'{self._name}' was renamed or removed while it was carved; its files are in {self._shot.folder}")
            return {"CANCELLED"}
        try:
            result = self._job.wait()
        except fluidcarve.Cancelled:
            volume.fluidcarve.status = "cancelled; Carve goes on"
            self.report({"INFO"}, "cancelled")
            return {"CANCELLED"}
        except fluidcarve.Error as error:
            self.fail(error, volume)
            return {"CANCELLED"}
        for each in result.warnings:
            self.report({"WARNING"}, str(each))
        made = self._shot
        volume.fluidcarve.sequence = ""
        # A change in time numbers its frames on from the first.
        written = result.nodes["out"].frames
        numbers = made.frames if written == len(made.frames) else range(made.frames[0], made.frames[0] + written)
        show.carved(volume, made.points or made.out, made.source, numbers)
        if made.seams:
            show.seams(volume, made.seams, made.source.number(context.scene.frame_current))
        if made.energy:
            show.energy(volume, made.energy, made.source, numbers)
        volume.fluidcarve.status = "\n".join(str(each) for each in result.warnings) or f"carved in {result.wall_s:.1f} s"
        return {"FINISHED"}


class FLUIDCARVE_OT_cancel(bpy.types.Operator):
    """Stop the carve. What is finished stays"""

    bl_idname = "fluidcarve.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, context):
        return volume_of(context) is not None and job_of(volume_of(context)) is not None

    def execute(self, context):
        job_of(volume_of(context)).cancel()
        return {"FINISHED"}


_CLASSES = (FLUIDCARVE_OT_look, FLUIDCARVE_OT_lattice, FLUIDCARVE_OT_check, FLUIDCARVE_OT_carve, FLUIDCARVE_OT_cancel)


def register() -> None:
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    for job in _jobs.values():
        job.cancel()
    _jobs.clear()
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
