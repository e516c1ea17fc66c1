import os
import sys
import time
import unittest

import fluidcarve

from .scripts import EXPRESSIONS, ScriptTest
from .test_pipeline import PLUME


class Nodes(ScriptTest):
    def pipeline(self, script, frames="51-53", type="energy.python", inputs=None, **fields):
        """A pipeline with a node `glow` of one script, whose result is written as a grid."""
        p = fluidcarve.Pipeline(frames=frames)
        sim = p.vdb.read(PLUME, grids={"density": "float", "velocity": "vector"})
        given = {"d": "sim.density"} if inputs is None else inputs
        glow = p._add(type, script=self.write("glow.py", script), inputs=given, name="glow", **fields)
        box = p.lattice.box(fit=sim.density)
        if type == "mask.python":
            p.seam.greedy(p.energy.gradient(sim.density), box, -1, protect=glow, name="seams")
        elif type == "energy.python":
            p.seam.greedy(glow, box, -1, name="seams")
        else:
            p.seam.greedy(p.energy.gradient(glow), box, -1, name="seams")
        p.seams.write("seams", os.path.join(self.folder, "seams.vdb"), name="out")
        return p

    def run_one(self, script, **more):
        return fluidcarve.run(self.pipeline(script, **more), {}, **self.options)

    def failure(self, script, **more):
        """What the first failure of a run says, without the folder."""
        with self.assertRaises(fluidcarve.Error) as raised:
            self.run_one(script, **more)
        return str(raised.exception).replace(self.folder + os.sep, "")

    # What functions get and return

    def test_an_energy_is_what_the_function_returns_in_any_of_its_shapes(self):
        results = []
        for body in ("abs(d.leaves) * gain", "abs(d.values) * gain", "abs(d.dense()) * gain", "d.like(abs(d.values) * gain)"):
            script = f"def energy(d, gain, at):\n    assert at.frames == [51, 52, 53] and at.frames[at.time] == at.frame, at.frames\n    return {body}\n"
            results.append(self.run_one(script, params={"gain": 2.5}).seams["seams"]["energy"])
        self.assertEqual(results[1:], results[:-1])

    @unittest.skipUnless(EXPRESSIONS, "this build has no expressions")
    def test_an_energy_is_that_of_the_same_expression(self):
        mine = self.run_one("def energy(d, gain, at): return abs(d.leaves) * gain", params={"gain": 2.5})
        built_in = self.pipeline("def energy(d, at): return abs(d.leaves)")
        ax = built_in.energy.ax(inputs={"d": "sim.density"}, code="@energy = 2.5f * abs(@d);", name="ax")
        built_in.change("seams", energy=ax)
        self.assertEqual(fluidcarve.run(built_in, {}, **self.options).seams["seams"]["energy"], mine.seams["seams"]["energy"])

    def test_grids_of_a_call_share_their_voxels(self):
        p = self.pipeline("""
            import numpy as np

            def energy(d, vel, m, at):
                assert d.values.shape == vel.values.shape[:1] == m.values.shape == d.coords.shape[:1]
                assert vel.values.shape[1:] == (3,) and vel.dense().shape == (*d.dense().shape, 3) and m.dense().dtype == bool
                low, high = d.box
                at_voxels = tuple((d.coords - low).T)
                assert (d.dense()[at_voxels] == d.values).all() and (vel.dense()[at_voxels] == vel.values).all()
                assert (m.values == (d.values > 0.5)).all() and m.values.any()
                assert d.masks[d.active].all() and d.active.any()
                assert np.allclose(d.transform[:3, :3], np.eye(3) * d.transform[0, 0]) and d.transform[0, 0] > 0
                wide = d.dense((np.subtract(low, 9), np.add(high, 3)))
                assert (wide[9:-3, 9:-3, 9:-3] == d.dense()).all() and np.count_nonzero(wide) == np.count_nonzero(d.dense())
                return np.linalg.norm(vel.values, axis=1)
            """, inputs={"d": "sim.density", "vel": "sim.velocity", "m": "high"})
        p.mask.threshold("sim.density", above=0.5000001, name="high")
        fluidcarve.run(p, {}, **self.options)

    def test_fields_and_masks_are_computed_too(self):
        self.run_one("def field(d, at): return -2 * d.dense()", type="field.python")
        told = self.run_one("def mask(d, at): return d.dense() > 0.7", type="mask.python").seams["seams"]
        values = self.run_one("def mask(d, at): return d.values > 0.7", type="mask.python").seams["seams"]
        self.assertEqual(told["energy"], values["energy"])
        self.assertEqual(told["protected"], [0])

    def test_blocks_with_a_halo_give_what_the_whole_frame_gives(self):
        script = """
            import numpy as np

            def energy(d):
                assert max(d.dense().shape) <= limit
                return np.sqrt(sum(each * each for each in np.gradient(d.dense())))

            def mask(d):
                return np.gradient(d.dense())[0] > 0.05
            """
        whole = self.run_one(script.replace("limit", "90"))
        blocks = self.run_one(script.replace("limit", "66"), halo=1)
        self.assertEqual(blocks.seams["seams"]["energy"], whole.seams["seams"]["energy"])
        masks = [self.run_one(script, type="mask.python", frames="54", **more).seams["seams"]["energy"] for more in ({}, {"halo": 2})]
        self.assertEqual(*masks)

    def test_a_script_may_see_all_frames_before(self):
        script = """
            def add(d, at):
                seen.append((at.frame, float(d.values.max())))

            def finish(gain):
                assert [frame for frame, _ in seen] == [51, 52, 53]
                return {"highest": gain * max(value for _, value in seen), "note": "all"}

            def energy(d, gain, highest, note):
                assert gain == 2 and note == "all"
                return abs(d.leaves) / highest

            seen = []
            """
        told = self.run_one(script, params={"gain": 2})
        plain = self.run_one("def energy(d, highest): return abs(d.leaves) / highest", params={"highest": 2 * 0.99609375})
        self.assertEqual(told.nodes["glow"].frames, 3)
        self.assertAlmostEqual(told.seams["seams"]["energy"][0] / plain.seams["seams"]["energy"][0], 1, 1)
        self.assertIn("finish returned a list; it must be a dict", self.failure(script.replace('return {"highest"', 'return [1] or {"highest"'), params={"gain": 2}))
        self.assertIn("has `finish`, but no `add`", self.failure("def finish(): return {}\ndef energy(d): return 1"))

    def test_results_are_the_same_with_any_number_of_workers(self):
        written = []
        for threads in (1, 2, 4):
            self.options.update(threads=threads, work=os.path.join(self.folder, f"work{threads}"))
            p = self.pipeline("import numpy as np\ndef energy(d): return abs(np.sin(d.dense() * 9))", frames="51-56")
            fluidcarve.run(p, {}, **self.options)
            written.append(os.path.join(self.folder, f"seams{threads}.vdb"))
            os.rename(os.path.join(self.folder, "seams.vdb"), written[-1])
        self.assertEqual([fluidcarve.diff(written[0], each).result for each in written[1:]], ["same", "same"])

    # What is computed again

    def test_a_second_run_computes_nothing_and_a_changed_helper_recomputes(self):
        script = "import helper\ndef energy(d, at):\n    from tools import more\n    return abs(d.leaves) * helper.gain() * more.GAIN\n"
        self.write("helper.py", "def gain(): return 2\n")
        os.mkdir(os.path.join(self.folder, "tools"))
        self.write("tools/__init__.py", "")
        self.write("tools/more.py", "GAIN = 1\n")
        p = self.pipeline(script)
        first = fluidcarve.run(p, {}, **self.options)
        self.assertEqual(fluidcarve.plan(p, {}, **self.options).nodes["glow"].why, "")
        for name, text in (("helper.py", "def gain(): return 3\n"), ("tools/more.py", "GAIN = 2\n")):
            self.write(name, text)
            self.assertNotEqual(fluidcarve.plan(p, {}, **self.options).nodes["glow"].why, "")
            second = fluidcarve.run(p, {}, **self.options)
            self.assertEqual(second.nodes["glow"].cached, 0)
            self.assertNotEqual(second.seams["seams"]["energy"], first.seams["seams"]["energy"])
            first = second

    def test_its_version_counts(self):
        script = "import os\nVERSION = open(os.path.join(os.path.dirname(__file__), 'weights')).read()\ndef energy(d): return abs(d.leaves)\n"
        self.write("weights", "1")
        p = self.pipeline(script)
        fluidcarve.run(p, {}, **self.options)
        self.write("weights", "2")
        self.assertIn("VERSION changed from 1 to 2", fluidcarve.plan(p, {}, **self.options).nodes["glow"].why)

    # What may run, and what is checked

    def test_scripts_run_only_where_they_are_allowed(self):
        del self.options["allow_plugins"]
        self.assertIn("energy.python runs code that the pipeline names, with your rights, and nobody allowed that; if you trust it, give --allow-plugins",
                      self.failure("raise SystemExit(open('ran', 'w'))"))
        self.assertFalse(os.path.exists("ran"))

    def test_check_compares_the_function_with_the_pipeline(self):
        for script, fault in (
            ("def energy(d, gain, at): pass", "energy needs 'gain'; state it under `inputs` or `params`"),
            ("def add(d, other): pass\ndef energy(d): pass", "glow.py: add needs 'other'; state it under `inputs` or `params`"),
            ("def energy(density, at): pass", "'inputs': glow.py:1: energy takes no 'd'; it takes density, at"),
            ("def glow(d): pass", "glow.py has no function 'energy'; write one, `def energy(d, at)`; it has glow"),
            ("def energy(d):\n  return (", "glow.py:2: SyntaxError: '(' was never closed" if sys.version_info >= (3, 10) else "glow.py:2: SyntaxError"),
            ("import nonsense_module", "glow.py:1: ModuleNotFoundError: No module named 'nonsense_module'"),
        ):
            with self.assertRaises(fluidcarve.Error) as raised:
                fluidcarve.check(self.pipeline(script), {}, allow_plugins=True)
            self.assertIn(fault, str(raised.exception).replace(self.folder + os.sep, ""))
            self.assertGreater(raised.exception.problems[0].line, 0)
        self.assertEqual(fluidcarve.check(self.pipeline("def energy(d, gain=1, **more): pass", params={"gain": 2, "other": "a"}), {}, allow_plugins=True), [])

    def test_an_interpreter_that_is_none_is_told(self):
        for python, fault in (("/nowhere/python", "cannot start the Python '/nowhere/python': No such file or directory; name one by `python`"),
                              ("/bin/false", "'/bin/false' can't run scripts; name another Python by `python`")):
            with self.assertRaises(fluidcarve.Error) as raised:
                fluidcarve.check(self.pipeline("def energy(d): pass", python=python), {}, allow_plugins=True)
            self.assertIn(fault, str(raised.exception))

    # What goes wrong

    def test_what_a_function_does_wrong_is_told_with_its_place(self):
        for script, faults in (
            ("def energy(d):\n  return inner(d)\ndef inner(d):\n  return 1 / 0", ("glow.py:4: ZeroDivisionError: division by zero", "glow.py:2, in energy: return inner(d)")),
            ("def energy(d):\n  return d.dense()[1:]", ("glow.py:1: ValueError: energy returned an array of type float32 and shape", "it must have the shape of dense()")),
            ("def energy(d):\n  pass", ("TypeError: energy returned nothing; it must be numbers, as an array or a Grid",)),
            ("def energy(d):\n  return d.dense().astype(complex)", ("energy returned an array of type complex128 and shape",)),
            ("import numpy as np\ndef energy(d):\n  with np.errstate(all='ignore'): return np.where(d.dense() > 0.5, np.nan, 1)", ("glow.py: energy returned nan at voxel [",)),
            ("def energy(d):\n  return -1 - abs(d.dense())", ("at voxel [", "it must be at least 0: use numpy.maximum(..., 0)")),
            ("import os\ndef energy(d):\n  os._exit(3)", ("glow.py: the script ended its process with code 3, as os._exit does",)),
            ("import ctypes\ndef energy(d):\n  ctypes.string_at(0)", ("glow.py:3: the script's process crashed (Segmentation fault)",)),
            ("def energy(d):\n  raise SystemExit(5)", ("glow.py:2: SystemExit: 5",)),
            ("def energy(d):\n  return bytearray(1 << 44)", ("glow.py:2: MemoryError",)),
            ("def energy(d):\n  d.leaves[...] = 0", ("glow.py:2: ValueError: assignment destination is read-only",)),
        ):
            with self.subTest(script):
                told = self.failure(script, frames="51")
                for fault in faults:
                    self.assertIn(fault, told)
                self.assertTrue(told.startswith("glow, frame 51: "), told)

    def test_a_script_that_never_ends_is_stopped_with_its_place(self):
        told = self.failure("def energy(d):\n  while True: pass\n", frames="51", timeout=0.4)
        self.assertIn("glow.py:2: the script did not end within 0.40 s; raise `timeout` if it needs longer", told)

    def test_a_script_that_eats_memory_is_refused_more(self):
        self.options["memory"] = "1G"
        told = self.failure("def energy(d):\n  hoard = []\n  while True: hoard.append(bytearray(1 << 26))\n", frames="51")
        self.assertIn("glow.py:3: MemoryError", told)

    def test_what_a_script_does_while_it_is_imported_is_told_as_its_own(self):
        for script, fault in (
            ("import os\nos._exit(3)\n", "glow.py: the script ended its process with code 3, as os._exit does"),
            ("import ctypes\nctypes.string_at(0)\n", "glow.py:2: the script's process crashed"),
            ("hoard = []\nwhile True: hoard.append(bytearray(1 << 30))\n", "glow.py:2: MemoryError"),
        ):
            with self.subTest(script), self.assertRaises(fluidcarve.Error) as raised:
                fluidcarve.check(self.pipeline(script), {}, allow_plugins=True)
            self.assertIn(fault, str(raised.exception))

    def test_a_remedy_is_never_a_line_of_a_script(self):
        with self.assertRaises(fluidcarve.Error) as raised:
            fluidcarve.check(self.pipeline("a = 1; b = 1 / 0\n"), {}, allow_plugins=True)
        self.assertIn("a = 1; b = 1 / 0", str(raised.exception))
        self.assertEqual([each.remedy for each in raised.exception.problems], [""])

    def test_one_frame_that_fails_stops_no_other(self):
        p = fluidcarve.Pipeline(frames="51-53")
        sim = p.vdb.read(PLUME, grids={"density": "float"})
        script = self.write("glow.py", "import os\ndef energy(d, at):\n  if at.frame == 52: os._exit(1)\n  return abs(d.leaves)\n")
        glow = p.energy.python(inputs={"d": sim.density}, script=script)
        result = fluidcarve.run(p, {}, keep_going=True, to="glow", **self.options)
        self.assertEqual((result.exit, [(each.node, each.frame) for each in result.failures]), (4, [("glow", 52)]))
        self.assertEqual(fluidcarve.plan(p, {}, to="glow", **self.options).nodes["glow"].cached, 2)

    def test_what_a_script_sends_by_itself_is_never_taken_for_an_answer(self):
        self.options["threads"] = 1
        p = fluidcarve.Pipeline(frames="51-54")
        sim = p.vdb.read(PLUME, grids={"density": "float"})
        good = p.field.python(inputs={"d": sim.density}, script=self.write("good.py", "def field(d): return d.leaves * 2\n"), name="good")
        p.vdb.write(good, os.path.join(self.folder, "good.####.vdb"), name="expected")
        for sent in ("noise", "{}", '{"warn": 5}', '{"number": 1}', ""):
            script = f"import os\ndef field(d, at):\n  if at.frame == 52: os.write(3, {(sent + chr(10)).encode()!r})\n  return d.leaves * 2\n"
            if not sent:
                script = "def field(d, at):\n  if at.frame == 52: at.progress(float('nan'))\n  at.warn('a \\udc80 b')\n  return d.leaves * 2\n"
            with self.subTest(sent):
                bad = p.field.python(inputs={"d": sim.density}, script=self.write("bad.py", script), name="bad")
                p.vdb.write(bad, os.path.join(self.folder, "bad.####.vdb"), name="got")
                result = fluidcarve.run(p, {}, keep_going=True, **self.options)
                self.assertEqual([(each.node, each.frame) for each in result.failures], [("bad", 52)])
                self.assertIn("bad.py:2: ValueError" if not sent else "wrote into the socket", result.failures[0].message)
                for frame in (51, 53, 54):
                    self.assertEqual(fluidcarve.diff(*(os.path.join(self.folder, f"{name}.00{frame}.vdb") for name in ("good", "bad"))).result, "same")
                del p["got"], p["bad"]

    def test_frames_go_on_with_the_processes_that_there_are(self):
        self.options["threads"] = 4
        script = "import os\nos.close(os.open(os.path.join(os.path.dirname(__file__), 'one'), os.O_CREAT | os.O_EXCL))\ndef energy(d): return abs(d.leaves)\n"
        p = fluidcarve.Pipeline(frames="51-56")
        sim = p.vdb.read(PLUME, grids={"density": "float"})
        glow = p.energy.python(inputs={"d": sim.density}, script=self.write("glow.py", script))
        self.assertEqual(fluidcarve.run(p, {}, to="glow", **self.options).nodes["glow"].frames, 6)

    def test_prints_and_warnings_are_shown_and_never_too_long(self):
        script = "def energy(d, at):\n  at.warn('mind the gap')\n  print('x' * 1000000)\n  return abs(d.leaves)\n"
        warnings = [each.message for each in self.run_one(script, frames="51").warnings]
        self.assertIn("mind the gap", warnings)
        told = next(each for each in warnings if each.startswith("the script printed: xxx"))
        self.assertLess(len(told), 1100)
        self.assertIn("and 999 kB more", told)

    def test_no_process_survives_the_program(self):
        p = self.pipeline("import os, time\ndef energy(d):\n  open(os.path.join(os.path.dirname(__file__), 'pid'), 'w').write(str(os.getpid()))\n  while True: pass\n",
                          frames="51")
        job = fluidcarve.start(p, {}, **self.options)
        pid_file = os.path.join(self.folder, "pid")
        while not self.read(pid_file):
            self.assertTrue(job.poll())
        pid = int(self.read(pid_file))
        job._process.kill()
        job._process.wait()
        while _runs(pid):
            time.sleep(0.001)
        with self.assertRaises(fluidcarve.Error):
            job.wait()


def _runs(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


if __name__ == "__main__":
    unittest.main()
