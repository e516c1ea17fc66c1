"""The add-on of Blender, in a Blender without a window: `blender -b --factory-startup --python test_blender.py`.

It is enabled as an artist's would be, from Blender's folder of add-ons.
"""

import csv
import glob
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import addon_utils
import bpy
from mathutils import Matrix, Vector

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
PLUME = os.path.join(ROOT, "tests/data/plume/plume.0051.vdb")
PROGRAM = os.environ["FLUIDCARVE"]


def addon():
    return sys.modules["fluidcarve"]


def program(*words, code=0):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout


def obj_vertices(path):
    with open(path, encoding="utf-8") as file:
        return [tuple(float(each) for each in line.split()[1:]) for line in file if line.startswith("v ")]


class BlenderTest(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        addon_utils.enable("fluidcarve", default_set=True)
        self.folder = tempfile.mkdtemp(prefix="fluidcarve-blender-")
        self.addCleanup(shutil.rmtree, self.folder)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(self.folder, "scene.blend"))
        bpy.context.scene.frame_set(51)

    def volume(self, matrix=Matrix()):
        data = bpy.data.volumes.new("plume")
        data.filepath = PLUME
        data.is_sequence = True
        data.frame_start, data.frame_duration, data.frame_offset = 51, 6, 50
        out = bpy.data.objects.new("plume", data)
        bpy.context.scene.collection.objects.link(out)
        out.matrix_world = matrix
        bpy.context.view_layer.objects.active = out
        bpy.context.view_layer.update()
        self.assertEqual(bpy.ops.fluidcarve.look(), {"FINISHED"})
        return out

    def curve(self, points=((0.98, 0.98, -0.3), (1.05, 0.98, 1.5), (0.98, 0.98, 4.3)), matrix=Matrix()):
        data = bpy.data.curves.new("path", "CURVE")
        data.dimensions = "3D"
        spline = data.splines.new("BEZIER")
        spline.bezier_points.add(len(points) - 1)
        for point, place in zip(spline.bezier_points, points):
            point.co = place
            point.handle_left_type = point.handle_right_type = "AUTO"
        out = bpy.data.objects.new("path", data)
        bpy.context.scene.collection.objects.link(out)
        out.matrix_world = matrix
        bpy.context.view_layer.update()
        return out

    def bent(self, matrix=Matrix()):
        volume = self.volume(matrix)
        settings = volume.fluidcarve
        settings.rig = self.curve(matrix=matrix)
        settings.up = matrix.to_3x3() @ Vector((0, 1, 0))
        settings.reach_u = settings.reach_v = [1.3 * each * matrix.to_scale()[0] for each in (-1, 1)]
        settings.amount, settings.unit = -20, "PERCENT"
        return volume

    def carved_files(self, name="scene_plume"):
        return sorted(glob.glob(os.path.join(self.folder, name, "carved.*.vdb")))

    def pipeline(self):
        with open(os.path.join(self.folder, "scene_plume.yaml"), encoding="utf-8") as file:
            return file.read()


class Registration(BlenderTest):
    def test_add_on_is_enabled_disabled_and_enabled_again(self):
        self.assertTrue(hasattr(bpy.types.Object, "fluidcarve"))
        addon_utils.disable("fluidcarve")
        self.assertFalse(hasattr(bpy.types.Object, "fluidcarve"))
        self.assertFalse(any("fluidcarve" in handler.__module__ for handler in bpy.app.handlers.depsgraph_update_post))
        addon_utils.enable("fluidcarve")
        self.assertTrue(hasattr(bpy.types.Object, "fluidcarve"))


class Boxes(BlenderTest):
    def test_files_are_looked_at(self):
        volume = self.volume()
        self.assertIn('"density"', volume.fluidcarve.facts)
        self.assertAlmostEqual(volume.fluidcarve.reach_u[1], 1, delta=0.3)

    def test_carved_volume_stands_in_place_of_the_source_and_flips_with_it(self):
        volume = self.volume()
        volume.fluidcarve.amount, volume.fluidcarve.unit = -8, "VOXELS"
        material = bpy.data.materials.new("smoke")
        volume.data.materials.append(material)
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"})
        carved = volume.fluidcarve.carved
        self.assertEqual(carved.type, "VOLUME")
        self.assertEqual(list(carved.data.materials), [material])
        self.assertTrue(volume.hide_render and not carved.hide_render)
        volume.fluidcarve.shown = "before"
        self.assertTrue(carved.hide_render and not volume.hide_render)
        for frame in (51, 56):
            bpy.context.scene.frame_set(frame)
            grids = carved.data.grids
            grids.load()
            self.assertEqual(grids.frame, frame)
            self.assertIn("density", [each.name for each in grids])
        self.assertEqual(len(self.carved_files()), 6)

    def test_pipeline_runs_without_blender_and_gives_the_same_grids_as_carve(self):
        volume = self.volume()
        volume.fluidcarve.amount, volume.fluidcarve.unit = -8, "VOXELS"
        bpy.ops.fluidcarve.carve()
        mine = os.path.join(self.folder, "mine.####.vdb")
        program("run", os.path.join(self.folder, "scene_plume.yaml"), "--set", f"out.path={mine}", "--no-cache", "-q")
        ours = os.path.join(self.folder, "scene_plume", "carved.####.vdb")
        program("diff", mine, ours)
        program("carve", PLUME.replace("0051", "####"), "-8", "-o", mine, "--no-cache", "-q")
        program("diff", mine, ours)

    def test_one_file_is_carved_alone(self):
        volume = self.volume()
        volume.data.is_sequence = False
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, volume.fluidcarve.status)
        self.assertFalse(volume.fluidcarve.carved.data.is_sequence)
        self.assertTrue(os.path.isfile(os.path.join(self.folder, "scene_plume", "carved.vdb")))

    def test_lengths_are_the_scenes(self):
        volume = self.volume(Matrix.Diagonal((10, 3, 0.5, 1)))
        volume.fluidcarve.amount, volume.fluidcarve.unit = -10 * 5 * 0.0454545, "LENGTH"
        bpy.ops.fluidcarve.check()
        with open(os.path.join(self.folder, "scene_plume", "draft.yaml"), encoding="utf-8") as file:
            self.assertIn("default: -5", file.read())

    def test_preview_carves_three_frames_at_half_size(self):
        volume = self.volume()
        self.assertEqual(bpy.ops.fluidcarve.carve(preview=True), {"FINISHED"})
        files = sorted(glob.glob(os.path.join(self.folder, "scene_plume/preview/carved.*.vdb")))
        self.assertEqual([os.path.basename(each) for each in files], ["carved.0051.vdb", "carved.0052.vdb", "carved.0053.vdb"])
        grids = volume.fluidcarve.carved.data.grids
        grids.load()
        density = next(each for each in grids if each.name == "density")
        self.assertAlmostEqual(density.matrix_object[0][0], 2 * 0.0454545, places=4)
        self.assertEqual(self.carved_files(), [])

    def test_preview_along_a_curve_has_its_lattice_at_half_size(self):
        volume = self.bent()
        self.assertEqual(bpy.ops.fluidcarve.carve(preview=True), {"FINISHED"}, volume.fluidcarve.status)
        with open(os.path.join(self.folder, "scene_plume/preview.yaml"), encoding="utf-8") as file:
            self.assertIn("spacing: 0.0909", file.read())


class Lattices(BlenderTest):
    def lattice_of(self, volume):
        self.assertEqual(bpy.ops.fluidcarve.lattice(), {"FINISHED"}, volume.fluidcarve.status)
        return [tuple(each.co) for each in volume.fluidcarve.lattice.data.vertices]

    def test_lattice_drawn_is_the_one_that_the_program_writes(self):
        volume = self.bent()
        drawn = self.lattice_of(volume)
        bpy.ops.fluidcarve.check()
        written = os.path.join(self.folder, "lattice.obj")
        shot = os.path.join(self.folder, "lattice.yaml")
        with open(shot, "w", encoding="utf-8") as file:
            file.write(f"fluidcarve: 1\nextends: scene_plume.yaml\nnodes:\n  drawn: {{type: lattice.write, lattice: bent, path: {written}}}\n")
        program("run", shot, "--to", "drawn", "--no-cache", "-q")
        wanted = obj_vertices(written)
        self.assertEqual(len(drawn), len(wanted))
        for a, b in zip(drawn, wanted):
            self.assertLess(math.dist(a, b), 1e-5)

    def test_bent_carve_equals_the_command_lines(self):
        volume = self.bent()
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, volume.fluidcarve.status)
        mine = os.path.join(self.folder, "mine.####.vdb")
        program("run", os.path.join(self.folder, "scene_plume.yaml"), "--set", f"out.path={mine}", "--no-cache", "-q")
        program("diff", mine, os.path.join(self.folder, "scene_plume", "carved.####.vdb"))
        self.assertIn("bent", self.pipeline())
        self.assertGreater(len(volume.fluidcarve.seams.data.polygons), 10)
        self.assertTrue(volume.fluidcarve.slice.data.display.use_slice)

    def test_turned_and_scaled_volume_carves_alike(self):
        straight = self.bent()
        first = self.lattice_of(straight)
        turned = self.bent(Matrix.Translation((3, -2, 1)) @ Matrix.Rotation(0.7, 4, "Z") @ Matrix.Scale(2.5, 4))
        second = self.lattice_of(turned)
        self.assertEqual(len(first), len(second))
        self.assertLess(max(math.dist(a, b) for a, b in zip(first, second)), 1e-4)
        self.assertEqual(turned.fluidcarve.lattice.matrix_world, turned.matrix_world)

    def test_place_may_be_mirrored_and_of_three_scales(self):
        straight = self.bent()
        first = self.lattice_of(straight)
        placed = self.bent()
        matrix = Matrix.Translation((2, 0, -1)) @ Matrix.Rotation(0.4, 4, "X") @ Matrix.Diagonal((1, -1.5, 0.5, 1))
        placed.matrix_world = placed.fluidcarve.rig.matrix_world = matrix
        bpy.context.view_layer.update()
        scale = abs(matrix.to_3x3().determinant()) ** (1 / 3)
        placed.fluidcarve.reach_u = placed.fluidcarve.reach_v = (-1.3 * scale, 1.3 * scale)
        placed.fluidcarve.up = matrix.to_3x3() @ Vector((0, 1, 0))
        second = self.lattice_of(placed)
        self.assertEqual(len(first), len(second))
        self.assertLess(max(math.dist(a, b) for a, b in zip(first, second)), 1e-3)

    def test_lattice_reaches_around_the_content(self):
        volume = self.bent()
        bpy.ops.fluidcarve.look()
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, volume.fluidcarve.status)
        self.assertNotIn("make the lattice larger", volume.fluidcarve.status)

    def test_folded_cells_are_red(self):
        volume = self.bent()
        volume.fluidcarve.rig = self.curve(((0.2, 0.98, 0.5), (1.0, 0.98, 2), (1.8, 0.98, 0.5)))
        volume.fluidcarve.reach_u = volume.fluidcarve.reach_v = (-1.9, 1.9)
        self.lattice_of(volume)
        self.assertIn("folded", volume.fluidcarve.status)
        cells = bpy.data.objects["plume lattice folded"].data
        self.assertGreater(len(cells.polygons), 5)
        self.assertEqual(tuple(cells.materials[0].diffuse_color)[0], 1)
        volume.fluidcarve.rig = self.curve()
        volume.fluidcarve.reach_u = volume.fluidcarve.reach_v = (-1, 1)
        self.lattice_of(volume)
        self.assertIsNone(bpy.data.objects.get("plume lattice folded"))

    def test_moving_curve_gives_a_rig_for_each_frame(self):
        volume = self.bent()
        curve = volume.fluidcarve.rig
        for frame, x in ((51, 0.0), (56, 0.2)):
            curve.location.x = x
            curve.keyframe_insert("location", frame=frame)
        self.assertEqual(bpy.ops.fluidcarve.check(), {"FINISHED"}, volume.fluidcarve.status)
        starts = []
        for frame in range(51, 57):
            with open(os.path.join(self.folder, "scene_plume", f"rig.{frame:04d}.csv"), encoding="utf-8") as file:
                starts.append(float(next(csv.DictReader(file))["x"]))
        self.assertAlmostEqual(starts[0], 0.98, places=4)
        self.assertAlmostEqual(starts[-1], 1.18, places=4)
        self.assertEqual(sorted(starts), starts)
        self.assertEqual(bpy.context.scene.frame_current, 51)


class Masks(BlenderTest):
    def test_regions_and_windows_reach_the_solver(self):
        volume = self.volume()
        settings = volume.fluidcarve
        settings.amount = -10
        keep = bpy.data.objects.new("keep", None)
        keep.empty_display_type, keep.empty_display_size, keep.location = "SPHERE", 0.2, (0.98, 0.98, 1)
        low, high = bpy.data.objects.new("low", None), bpy.data.objects.new("high", None)
        low.location, high.location = (0.5, 0, 0), (1.6, 0, 0)
        for each in (keep, low, high):
            bpy.context.scene.collection.objects.link(each)
        settings.protect, settings.window_low, settings.window_high = keep, low, high
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, settings.status)
        self.assertRegex(self.pipeline(), r"window: \[[0-9.]+%, [0-9.]+%\]")

    def test_energy_is_a_function_of_a_text(self):
        volume = self.volume()
        text = bpy.data.texts.new("glow")
        text.from_string("def energy(density, at):\n    return density.dense() ** 2\n")
        volume.fluidcarve.energy = text
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, volume.fluidcarve.status)
        text.from_string("def energy(heat, at):\n    return heat.dense()\n")
        with self.assertRaisesRegex(RuntimeError, "there is no grid 'heat'"):
            bpy.ops.fluidcarve.carve()


class OtherFiles(BlenderTest):
    def carve(self, file, amount=-10):
        volume = self.volume()
        volume.fluidcarve.files = os.path.join(ROOT, "tests/data", file)
        volume.fluidcarve.amount = amount
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, volume.fluidcarve.status)
        return volume

    def test_meshes_come_back_as_an_object_with_their_coordinates_of_textures(self):
        volume = self.carve("river/riverbank.obj")
        mesh = volume.fluidcarve.carved.data
        self.assertEqual(len(mesh.vertices), len(obj_vertices(os.path.join(ROOT, "tests/data/river/riverbank.obj"))))
        self.assertEqual(len(mesh.uv_layers), 1)
        bpy.context.scene.frame_set(52)
        self.assertEqual(len(volume.fluidcarve.carved.data.polygons), len(mesh.polygons))

    def test_particles_are_carved_with_the_grids_beside_them(self):
        mesh = self.carve("river/meander.0037.vdb", -5).fluidcarve.carved.data
        self.assertGreater(len(mesh.vertices), 1000)
        self.assertLess(max(each.co.x for each in mesh.vertices), 10)
        self.assertIn("points", program("inspect", self.carved_files()[0]))

    def test_images_are_files(self):
        self.carve("images/chelsea.png")
        self.assertTrue(os.path.isfile(os.path.join(self.folder, "scene_plume", "carved.png")))


class Time(BlenderTest):
    def test_volume_becomes_shorter_in_time(self):
        volume = self.volume()
        volume.fluidcarve.box_axis, volume.fluidcarve.frames = "t", -2
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, volume.fluidcarve.status)
        self.assertEqual(volume.fluidcarve.carved.data.frame_duration, 4)

    def test_loop_and_speed(self):
        volume = self.volume()
        settings = volume.fluidcarve
        settings.box_axis, settings.time, settings.loop = "t", "LOOP", (4, 4)
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, settings.status)
        self.assertEqual(settings.carved.data.frame_duration, 4)
        settings.time, settings.speed = "RETIME", 2
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"}, settings.status)
        self.assertEqual(settings.carved.data.frame_duration, 3)


class Faults(BlenderTest):
    def test_wrong_curve_tells_what_is_wrong(self):
        volume = self.bent()
        data = bpy.data.curves.new("empty", "CURVE")
        volume.fluidcarve.rig = bpy.data.objects.new("nothing", data)
        with self.assertRaisesRegex(RuntimeError, "'nothing' has no path; draw a curve"):
            bpy.ops.fluidcarve.carve()
        self.assertIn("has no path", volume.fluidcarve.status)

    def test_fault_of_the_pipeline_opens_at_its_place(self):
        volume = self.volume()
        volume.fluidcarve.thick = 5000
        with self.assertRaises(RuntimeError):
            bpy.ops.fluidcarve.carve()
        self.assertIn("thickness", volume.fluidcarve.status)

    def test_missing_file_is_named(self):
        volume = self.volume()
        volume.data.filepath = "/nowhere/plume.0051.vdb"
        with self.assertRaisesRegex(RuntimeError, "/nowhere/plume.0051.vdb is not there"):
            bpy.ops.fluidcarve.carve()

    def test_pipeline_of_somebody_else_stays(self):
        self.volume()
        with open(os.path.join(self.folder, "scene_plume.yaml"), "w", encoding="utf-8") as file:
            file.write("fluidcarve: 1\n")
        with self.assertRaisesRegex(RuntimeError, "was not written by the add-on"):
            bpy.ops.fluidcarve.carve()
        self.assertEqual(self.pipeline(), "fluidcarve: 1\n")


class GoingOn(BlenderTest):
    def test_cancelled_carve_leaves_nothing_half_written_and_goes_on(self):
        volume = self.volume()
        package, run = addon().api.fluidcarve, sys.modules["fluidcarve.run"]
        run.prepare(bpy.context)
        made = sys.modules["fluidcarve.shot"].write(volume)
        job = package.start(made.pipeline, work=os.path.join(made.folder, ".fluidcarve"))
        run._jobs[volume.name] = job
        self.assertFalse(bpy.ops.fluidcarve.carve.poll())
        before = time.monotonic()
        self.assertEqual(bpy.ops.fluidcarve.cancel(), {"FINISHED"})
        with self.assertRaises(package.Cancelled):
            job.wait()
        self.assertLess(time.monotonic() - before, 1)
        run._jobs.clear()
        for file in self.carved_files():
            program("inspect", file)
        self.assertFalse(glob.glob(os.path.join(made.folder, "*.part*")))
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"})
        self.assertEqual(len(self.carved_files()), 6)

    def test_saved_and_opened_again_goes_on(self):
        volume = self.volume()
        volume.fluidcarve.amount = -25
        bpy.ops.fluidcarve.carve()
        bpy.ops.wm.save_mainfile()
        bpy.ops.wm.open_mainfile(filepath=os.path.join(self.folder, "scene.blend"))
        volume = bpy.data.objects["plume"]
        bpy.context.view_layer.objects.active = volume
        self.assertEqual(volume.fluidcarve.amount, -25)
        self.assertEqual(volume.fluidcarve.carved.name, "plume carved")
        run = sys.modules["fluidcarve.run"]
        self.assertEqual(run.volume_of(bpy.context), volume)
        self.assertEqual(bpy.ops.fluidcarve.carve(), {"FINISHED"})
        self.assertLess(len([each for each in bpy.data.objects if each.name.startswith("plume carved")]), 2)


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    done = unittest.main(module=__name__, argv=["test_blender", *words], exit=False)
    print(f"Blender {bpy.app.version_string}: {done.result.testsRun} tests")
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if done.result.wasSuccessful() else 1)
