import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import fluidcarve
from fluidcarve import stubs, yaml_text

ROOT = pathlib.Path(__file__).resolve().parents[2]
PLUME = str(ROOT / "tests/data/plume/plume.####.vdb")


def plume(out="out/plume.####.vdb"):
    """A pipeline that narrows the plume."""
    p = fluidcarve.Pipeline(frames="51-52", doc="Narrows a plume.")
    count = p.param("count", "count", -2, max=0, doc="Seams; negative removes.")
    sim = p.vdb.read(PLUME, grids={"density": "float"})
    box = p.lattice.box(fit=sim.density)
    seams = p.seam.greedy(energy=p.energy.gradient(sim.density), lattice=box, count=count)
    carved = p.remap.grids(sim, box, seams)
    out = p.vdb.write(source=carved, path=out)
    return p


class Writing(unittest.TestCase):
    def test_a_pipeline_is_written_as_a_person_would(self):
        p = fluidcarve.Pipeline(frames="51-56", doc="Narrows a plume.\n\nBy twelve.")
        count = p.param("count", "count", -12, min=-500, max=500, doc="Seams: negative removes.")
        sim = p.vdb.read("smoke.####.vdb", grids={"density": "float"})
        fast = p.energy.ax(inputs={"d": sim.density}, code="@energy = 1;\n@energy += @d;\n")
        box = p.lattice.box(fit=sim.density)
        seams = p.seam.pyramid(energy=p.energy.combine([fast, p.energy.gradient(sim.density)], weights=[1, 0.5]), lattice=box, count=count)
        self.assertEqual(p.text(), """\
# Narrows a plume.
#
# By twelve.
fluidcarve: 1

params:
  count: {type: count, default: -12, min: -500, max: 500, doc: "Seams: negative removes."}

frames: 51-56

nodes:
  sim:      {type: vdb.read, path: smoke.####.vdb, grids: {density: float}}
  fast:
    type: energy.ax
    inputs: {d: sim.density}
    code: |
      @energy = 1;
      @energy += @d;
  box:      {type: lattice.box, fit: sim.density}
  gradient: {type: energy.gradient, field: sim.density}
  combine:  {type: energy.combine, terms: [fast, gradient], weights: [1, 0.5]}
  seams:    {type: seam.pyramid, energy: combine, lattice: box, count: "${count}"}
""")

    def test_texts_that_yaml_takes_for_something_else_are_quoted(self):
        self.assertEqual(yaml_text.flow(["a b", "a: b", "#a", "a #b", "${x}", "", "null", "~", "- a", "-20%", "a,b", "1e-3", True, 2.0, None, "é"]),
                         '[a b, "a: b", "#a", "a #b", "${x}", "", "null", "~", "- a", -20%, "a,b", 1e-3, true, 2, null, "é"]')

    def test_a_node_has_the_name_of_its_variable_or_the_one_that_is_given(self):
        def made(p):
            return p.vdb.read(PLUME)

        p = fluidcarve.Pipeline()
        first = made(p)
        second = made(p)
        third = p.vdb.read(PLUME, name="again")
        with self.assertRaisesRegex(ValueError, "there is a node 'again' already"):
            p.vdb.read(PLUME, name="again")
        self.assertEqual([str(node) for node in (first, second, third)], ["read", "read_2", "again"])

    def test_wrong_names_are_refused_where_they_are_written(self):
        p = fluidcarve.Pipeline()
        with self.assertRaisesRegex(AttributeError, "there is no node type 'seam.pyramide'; did you mean 'seam.pyramid'?"):
            p.seam.pyramide(energy="a", lattice="b", count=1)
        with self.assertRaisesRegex(TypeError, "vdb.read has no 'grid'; did you mean 'grids'?"):
            p.vdb.read(PLUME, grid={})
        with self.assertRaisesRegex(TypeError, "seam.pyramid needs 'lattice', 'count'"):
            p.seam.pyramid("energy")
        with self.assertRaisesRegex(TypeError, "vdb.read takes 1 values by position, path"):
            p.vdb.read(PLUME, {"density": "float"})

    def test_a_saved_pipeline_is_good_and_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "deep", "shot.yaml")
            plume().save(path)
            self.assertEqual(fluidcarve.check(path), [])
            self.assertEqual(os.listdir(os.path.dirname(path)), ["shot.yaml"])


class Loading(unittest.TestCase):
    def test_a_loaded_pipeline_is_saved_as_its_changes(self):
        with tempfile.TemporaryDirectory() as folder:
            plume().save(os.path.join(folder, "show.yaml"))
            p = fluidcarve.load(os.path.join(folder, "show.yaml"))
            with self.assertRaisesRegex(TypeError, "there is no param 'cuont'; did you mean 'count'?"):
                p.set(cuont=-3)
            p.set(count=-3)
            p.frames = 51
            jet = p.mask.threshold(p["sim"].density, above=0.7)
            p.change("seams", protect=jet)
            del p["out"]
            p.save(os.path.join(folder, "shot.yaml"))
            with open(os.path.join(folder, "shot.yaml")) as file:
                self.assertEqual(file.read(), """\
fluidcarve: 1
extends: show.yaml

params:
  count: {default: -3}

frames: 51

nodes:
  jet:   {type: mask.threshold, field: sim.density, above: 0.7}
  seams: {protect: jet}
  out:
""")
            again = fluidcarve.load(os.path.join(folder, "shot.yaml"))
            self.assertEqual([str(node) for node in again.nodes()], [str(node) for node in p.nodes()])
            with self.assertRaisesRegex(KeyError, "there is no node 'seam'; did you mean 'seams'?"):
                again["seam"]
            with self.assertRaisesRegex(TypeError, "seam.greedy has no 'counts'; did you mean 'count'?"):
                again.change("seams", counts=3)

    def test_what_is_stated_of_a_node_is_told_whichever_file_states_it(self):
        with tempfile.TemporaryDirectory() as folder:
            plume().save(os.path.join(folder, "show.yaml"))
            p = fluidcarve.load(os.path.join(folder, "show.yaml"))
        p.change("seams", anchor="middle")
        self.assertEqual((p.fields("seams")["lattice"], p.fields("seams")["anchor"]), ("box", "middle"))
        self.assertEqual(p.type_of("seams"), "seam.greedy")

    def test_faults_of_a_loaded_file_are_problems(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "shot.yaml")
            with open(path, "w") as file:
                file.write("fluidcarve: 1\nnodes:\n  a: {type: vdb.rad}\n  b: {type: lattice.box, fit: a.density}\n")
            with self.assertRaises(fluidcarve.Error) as raised:
                fluidcarve.load(path)
            first = raised.exception.problems[0]
            self.assertEqual((first.file, first.line, first.column), (path, 3, 13))
            self.assertEqual(first.message, "there is no node type 'vdb.rad'; did you mean 'vdb.read'?")
            self.assertEqual(first.remedy, "did you mean 'vdb.read'?")


class Stubs(unittest.TestCase):
    def test_the_stubs_are_those_of_the_program(self):
        stored = (ROOT / "python/fluidcarve/nodes.pyi").read_text()
        self.assertEqual(stubs.stubs(), stored, "write them again: python -m fluidcarve.stubs > python/fluidcarve/nodes.pyi")

    def test_the_package_needs_nothing_but_the_standard_library(self):
        code = "import sys; sys.path.insert(0, sys.argv[1]); import fluidcarve, fluidcarve.stubs; p = fluidcarve.Pipeline(); p.vdb.read('a'); print(p.text())"
        done = subprocess.run([sys.executable, "-I", "-S", "-c", code, str(ROOT / "python")], capture_output=True, text=True,
                              env={**os.environ, "FLUIDCARVE": fluidcarve.program()})
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
