"""Takes the pictures of the README in a Blender with a window: a curve is drawn, the lattice follows it, the plume is carved along it.

xvfb-run -s '-screen 0 1280x800x24' blender --factory-startup --enable-event-simulate --window-geometry 0 0 1280 800 --python panel.py -- PLUME.0051.vdb FOLDER
"""

import os
import re
import sys

import addon_utils
import bpy
from mathutils import Euler, Vector

first_file, folder = sys.argv[sys.argv.index("--") + 1:]
bpy.context.preferences.view.show_splash = False
first = int(re.findall(r"\d+", os.path.basename(first_file))[-1])


def build():
    for each in list(bpy.data.objects):
        bpy.data.objects.remove(each)
    addon_utils.enable("fluidcarve", default_set=True)
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "scene.blend"))
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = first, first + 5
    scene.frame_set(first + 5)
    data = bpy.data.volumes.new("plume")
    data.filepath, data.is_sequence = os.path.abspath(first_file), True
    data.display.density = 8
    data.frame_start, data.frame_duration, data.frame_offset = first, 6, first - 1
    volume = bpy.data.objects.new("plume", data)
    scene.collection.objects.link(volume)
    curve = bpy.data.curves.new("path", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(2)
    for point, place in zip(spline.bezier_points, ((0.98, 0.98, -0.3), (0.8, 0.98, 1.7), (1.1, 0.98, 4.2))):
        point.co = place
        point.handle_left_type = point.handle_right_type = "AUTO"
    path = bpy.data.objects.new("path", curve)
    scene.collection.objects.link(path)
    bpy.context.view_layer.objects.active = volume
    bpy.ops.fluidcarve.look()
    settings = volume.fluidcarve
    settings.rig, settings.up = path, (0, 1, 0)
    settings.reach_u = settings.reach_v = (-1.4, 1.4)
    settings.amount = -25
    show_panel()


def show_panel():
    """The sidebar is open, and the view looks at the plume from the front."""
    for area in bpy.context.window.screen.areas:
        if area.type == "VIEW_3D":
            space = area.spaces.active
            space.show_region_ui, space.show_region_toolbar = True, False
            space.shading.type, space.shading.color_type, space.shading.wireframe_color_type = "SOLID", "MATERIAL", "OBJECT"
            space.overlay.show_cursor = False
            space.region_3d.view_rotation = Euler((1.45, 0, 0.25)).to_quaternion()
            space.region_3d.view_location = Vector((1.1, 1, 2))
            space.region_3d.view_distance = 9
            space.region_3d.view_perspective = "ORTHO"


def open_tab(kind, value):
    """No function chooses a tab of the sidebar before Blender 4.2: a click on it does."""
    bpy.context.window.event_simulate(type=kind, value=value, x=1043, y=544)


def picture(name):
    bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=2)
    bpy.ops.screen.screenshot(filepath=os.path.join(folder, name))


def film(number, bend=None, frame=None):
    """A picture of the film: small, after the curve was bent or the frame changed."""
    if frame is not None:
        bpy.context.scene.frame_set(frame)
    name = os.path.join(folder, f"film.{number:02d}.png")
    picture(name)
    image = bpy.data.images.load(name)
    image.scale(768, 480)
    image.save()
    bpy.data.images.remove(image)
    if bend is not None:
        points = bpy.data.objects["path"].data.splines[0].bezier_points
        points[1].co.x = bend
        bpy.data.objects["path"].data.update_tag()


def show_seams(shown):
    bpy.data.objects["plume"].fluidcarve.seams.hide_viewport = not shown


steps = iter([
    (1.0, build),
    (1.0, lambda: open_tab("MOUSEMOVE", "NOTHING")),
    (0.3, lambda: open_tab("LEFTMOUSE", "PRESS")),
    (0.3, lambda: open_tab("LEFTMOUSE", "RELEASE")),
    (3.0, lambda: film(1, bend=0.95)),
    (3.0, lambda: film(2, bend=1.15)),
    (3.0, lambda: film(3, bend=0.8)),
    (3.0, lambda: picture("lattice.png")),
    (0.5, lambda: bpy.ops.fluidcarve.carve("INVOKE_DEFAULT")),
    (0.8, lambda: film(4)),
    (12.0, lambda: show_seams(True)),
    (0.5, lambda: film(5)),
    (0.5, lambda: show_seams(False)),
    (0.5, lambda: picture("panel.png")),
    *((0.5, lambda number=number: film(6 + number, frame=first + number)) for number in range(6)),
    (0.5, bpy.ops.wm.quit_blender),
])
_, action = None, None


def go_on():
    global action
    if action is not None:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            action()
    wait, action = next(steps, (None, None))
    return wait


bpy.app.timers.register(go_on, first_interval=0.5)
