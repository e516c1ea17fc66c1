import json
import os
import unittest

import fluidcarve

from .scripts import ScriptTest, numpy
from .test_pipeline import PLUME, ROOT

COOKBOOK = ROOT / "python/cookbook"


class Families(ScriptTest):
    def solved(self, script, **fields):
        """The report on seams of a function, which takes the density itself for its energy."""
        p = fluidcarve.Pipeline(frames="51-53")
        sim = p.vdb.read(PLUME, grids={"density": "float"})
        box = p.lattice.box(fit=sim.density)
        energy = p.energy.python(inputs={"d": sim.density}, script=self.write("energy.py", "def energy(d): return abs(d.leaves)"))
        seams = p.seam.python(energy=energy, lattice=box, count=-2, script=script, **fields)
        out = p.seams.write(seams=seams, path=os.path.join(self.folder, "seams.vdb"))
        return fluidcarve.run(p, {}, **self.options).seams["seams"]

    # Solvers

    def test_a_solver_finds_seams_that_are_checked_and_priced_as_any(self):
        script = self.write("straight.py", (COOKBOOK / "straight.py").read_text())
        told = self.solved(script)
        self.assertEqual(told["shape"][0] - 2, told["shape"][0] - len(told["energy"]))
        self.assertTrue(all(energy >= bound for energy, bound in zip(told["energy"], told["lower_bound"])))
        flat = self.write("flat.py", "import numpy as np\ndef seam(energy, place, at): return np.full(energy.shape[:3], place)\n")
        at_rim = self.solved(flat, params={"place": 0})
        self.assertLess(at_rim["energy"][0], self.solved(flat, params={"place": 20})["energy"][0])

    def test_a_solver_sees_the_field_as_it_is_after_each_seam(self):
        script = self.write("seen.py", """
            import json
            import numpy as np

            def seam(energy, field, at):
                with open(PATH, "a") as told:
                    told.write(json.dumps([energy.shape, field.shape, field[0].tolist()]) + "\\n")
                return np.full(energy.shape[:3], 12)
            """.replace("PATH", repr(os.path.join(self.folder, "told"))))
        for thickness in (1, 4):
            p = fluidcarve.Pipeline(frames="51")
            sim = p.vdb.read(PLUME, grids={"density": "float"})
            box = p.lattice.box(fit=sim.density)
            seams = p.seam.python(p.energy.gradient(sim.density), box, -2 * thickness, script, field=sim.density, thickness=thickness, empty=1)
            p.seams.write(seams, os.path.join(self.folder, "seams.vdb"))
            fluidcarve.run(p, {}, **self.options)
            (energy, field, before), (_, _, after) = [json.loads(line) for line in self.read(os.path.join(self.folder, "told")).splitlines()]
            os.remove(os.path.join(self.folder, "told"))
            with self.subTest(thickness=thickness):
                self.assertEqual(field[:3] + [field[3] - thickness + 1], energy)
                before, after = numpy.array(before), numpy.array(after)
                self.assertGreater(before.max(), 0.5)
                self.assertTrue((numpy.delete(before, range(12, 12 + thickness), -1) == after).all())

    def test_a_solver_that_needs_a_field_is_told_where_there_is_none(self):
        script = self.write("seen.py", "def seam(energy, field): pass\n")
        with self.assertRaisesRegex(fluidcarve.Error, "seen.py:1: seam needs 'field'"):
            self.solved(script)

    def test_what_is_no_seam_is_refused_with_its_place(self):
        for body, fault in (
            ("np.full(energy.shape[:3], -1)", "entry -1 at [0, 0, 0] is not from 0 to "),
            ("np.arange(np.prod(energy.shape[:3])).reshape(energy.shape[:3]) % 3", "differ by more than 1"),
            ("np.full(energy.shape[:3], 2**32 + 1)", "at [0, 0, 0] is not from 0 to "),
            ("np.full(energy.shape[:3], 2.5)", "seam returned float64 of shape"),
            ("np.full(energy.shape[:2], 2)", "it must be entries, whole numbers of shape"),
        ):
            with self.subTest(body), self.assertRaises(fluidcarve.Error) as raised:
                self.solved(self.write("bad.py", f"import numpy as np\ndef seam(energy):\n    return {body}\n"))
            self.assertIn(fault, str(raised.exception))

    def test_a_solver_meets_what_is_protected(self):
        p = fluidcarve.Pipeline(frames="51")
        sim = p.vdb.read(PLUME, grids={"density": "float"})
        box = p.lattice.box(fit=sim.density)
        script = self.write("solver.py", """
            import numpy as np

            def seam(energy):
                assert np.isinf(energy).any() and np.isfinite(energy).any()
                return np.full(energy.shape[:3], energy.shape[3] // 2)
            """)
        p.seam.python(p.energy.gradient(sim.density), box, -1, script, protect=p.mask.threshold(sim.density, above=0.5), name="seams")
        p.seams.write("seams", os.path.join(self.folder, "seams.vdb"))
        with self.assertRaisesRegex(fluidcarve.Error, "is protected: its energy is inf"):
            fluidcarve.run(p, {}, **self.options)

    # Rigs

    def test_a_rig_runs_through_the_points_of_a_function(self):
        script = self.write("rig.py", """
            import numpy as np

            def rig(d, at):
                low, high = (np.asarray(each, float) for each in d.box)
                ends = np.stack([np.append((low + high) / 2, 1)] * 2)
                ends[0, 2], ends[1, 2] = low[2], high[2] + at.time
                return (ends @ d.transform.T)[:, :3]
            """)
        p = fluidcarve.Pipeline(frames="51-52")
        sim = p.vdb.read(PLUME, grids={"density": "float"})
        path = p.rig.python(script, inputs={"d": sim.density}, up=[1, 0, 0])
        p.lattice.build(path, spacing=0.1, extent_u=[-0.5, 0.5], extent_v=[-0.5, 0.5], name="lattice")
        p.lattice.write("lattice", os.path.join(self.folder, "lattice.####.obj"), name="out")
        result = fluidcarve.run(p, {}, **self.options)
        self.assertEqual(result.nodes["path"].frames, 2)
        self.write("rig.py", "def rig(d, at): return [[0, 0, 0], [0, 0, 0]]\n")
        with self.assertRaisesRegex(fluidcarve.Error, "rig returned no path: "):
            fluidcarve.run(p, {}, **self.options)

    def test_a_rig_through_no_place_is_refused_with_its_place(self):
        p = fluidcarve.Pipeline()
        path = p.rig.python(self.write("rig.py", "def rig(at): return [[0, 0, 0], [0, float('nan'), 1]]\n"))
        p.lattice.build(path, spacing=0.1, extent_u=[-0.5, 0.5], extent_v=[-0.5, 0.5], name="lattice")
        p.lattice.write("lattice", os.path.join(self.folder, "lattice.obj"), name="out")
        with self.assertRaisesRegex(fluidcarve.Error, "ValueError: rig returned position 1 as .0.0, nan, 1.0.; positions must be finite"):
            fluidcarve.run(p, {}, **self.options)

    def test_a_rig_without_inputs_is_one_for_all_frames_unless_it_is_animated(self):
        script = self.write("rig.py", "def rig(length, at): return [[0, 0, 0], [0, 0, length + at.time]]\n")
        for animate, frames in ((False, 1), (True, 2)):
            p = fluidcarve.Pipeline(frames="51-52")
            path = p.rig.python(script, params={"length": 2}, animate=animate)
            result = fluidcarve.run(p, {}, to="path", **self.options)
            self.assertEqual(result.nodes["path"].frames, frames)

    # Particles

    def test_particles_are_moved_added_and_taken_away(self):
        drops = self.write("drops.0001.ply", """\
            ply
            format ascii 1.0
            element vertex 3
            property float x
            property float y
            property float z
            property float v_x
            property float v_y
            property float v_z
            property int id
            end_header
            0 0 0 1 2 3 7
            1 0 0 4 5 6 8
            2 0 0 7 8 9 9
            """.replace("            ", ""))
        script = self.write("points.py", """
            import numpy as np

            def points(p, step, at):
                assert sorted(p) == ["P", "id", "v"] and p["v"].shape == (3, 3) and p["P"].dtype == np.float64
                kept = {name: values[p["id"] != 8] for name, values in p.items()}
                kept["P"] = kept["P"] + step * kept["v"]
                kept["age"] = np.arange(2) > 0
                return kept
            """)
        p = fluidcarve.Pipeline(frames="1")
        drops = p.points.read(drops.replace("0001", "####"), translate=[10, 0, 0])
        moved = p.points.python(inputs={"p": drops}, script=script, params={"step": 0.5})
        out = p.points.write(moved, os.path.join(self.folder, "out.####.ply"))
        fluidcarve.run(p, {}, **self.options)
        lines = self.read(os.path.join(self.folder, "out.0001.ply")).splitlines()
        self.assertEqual([line for line in lines if line.startswith("property")],
                         ["property float x", "property float y", "property float z", "property float v_x", "property float v_y", "property float v_z",
                          "property int id", "property uchar age"])
        self.assertEqual(lines[lines.index("end_header") + 1:], ["0.5 1 1.5 1 2 3 7 0", "5.5 4 4.5 7 8 9 9 1"])

    def test_what_can_be_no_points_is_refused(self):
        path = self.write("drops.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n")
        for body, fault in (("None", "it must be a dict of arrays with the positions 'P'"), ("{'P': p['P'] / 0}", "a position that is not finite, of point 0"),
                            ("{**p, 'a': [1, 2]}", "'a' of shape (2,); for 1 points it must be (1,) or (1, 3)"),
                            ("{**p, 'a': ['x']}", "'a' of type <U1; it must be numbers")):
            p = fluidcarve.Pipeline()
            drops = p.points.read(path)
            moved = p.points.python(inputs={"p": drops}, script=self.write("points.py", f"def points(p):\n    return {body}\n"))
            with self.subTest(body), self.assertRaises(fluidcarve.Error) as raised:
                fluidcarve.run(p, {}, to="moved", **self.options)
            self.assertIn(fault, str(raised.exception))


if __name__ == "__main__":
    unittest.main()
