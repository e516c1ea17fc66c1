import importlib.util
import os
import re
import shutil
import subprocess
import sys
import unittest

import fluidcarve

from .scripts import ScriptTest
from .test_pipeline import PLUME, ROOT

COOKBOOK = ROOT / "python/cookbook"


class Cookbook(ScriptTest):
    def test_its_energies_run_as_they_are(self):
        for name, inputs, params in (("glow", {"d": "sim.density", "vel": "sim.velocity"}, {"width": 2, "fast": 0.5}), ("network", {"d": "sim.density"}, {}),
                                     ("flow", {"d": "sim.density"}, {"axis": 1, "r": 4})):
            if name == "glow" and importlib.util.find_spec("scipy") is None:
                continue
            p = fluidcarve.Pipeline(frames="51-52")
            sim = p.vdb.read(PLUME, grids={"density": "float", "velocity": "vector"})
            energy = p.energy.python(inputs, str(COOKBOOK / f"{name}.py"), params=params)
            self.assertEqual(fluidcarve.run(p, {}, to="energy", **self.options).failures, [])

    def test_its_shots_run_and_one_that_fails_is_told(self):
        for shot in ("sh010", "sh020"):
            os.mkdir(os.path.join(self.folder, shot))
            shutil.copy(PLUME.replace("####", "0051"), os.path.join(self.folder, shot, "smoke.0051.vdb"))
        done = subprocess.run([sys.executable, str(COOKBOOK / "shots.py"), "sh010", "sh020", "sh030"], cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(ROOT / "python")})
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(sorted(os.listdir(os.path.join(self.folder, "sh020/carved"))), ["sheet.png", "smoke.0051.vdb"])
        self.assertIn("sh030: ", done.stderr)

    def test_the_page_shows_a_pipeline_that_runs(self):
        page = (ROOT / "python/README.md").read_text()
        block = re.search(r"```python\n(import fluidcarve\n.*?)```", page, re.DOTALL).group(1)
        subprocess.run([sys.executable, "-c", block], cwd=self.folder, check=True, env={**os.environ, "PYTHONPATH": str(ROOT / "python")})
        self.assertEqual(fluidcarve.check(os.path.join(self.folder, "shot.yaml")), [])
        self.assertIn("count: {type: count, default: -12, doc: ", self.read(os.path.join(self.folder, "shot.yaml")))
        change = re.search(r"```python\n(p = fluidcarve\.load\(.*?)```", page, re.DOTALL).group(1)
        subprocess.run([sys.executable, "-c", "import fluidcarve\n" + change], cwd=self.folder, check=True, env={**os.environ, "PYTHONPATH": str(ROOT / "python")})
        self.assertEqual([each.message for each in fluidcarve.check(os.path.join(self.folder, "sh010.yaml"))], [])


class Package(ScriptTest):
    def test_package_and_cookbook_pass_mypy(self):
        mypy = shutil.which("mypy")
        if mypy is None:
            self.skipTest("there is no mypy")
        # From 2 on it knows no Python before 3.10.
        oldest = "3.9" if re.search(r"^mypy [01]\.", subprocess.run([mypy, "--version"], capture_output=True, text=True).stdout) else "3.10"
        done = subprocess.run([mypy, "--strict", "--python-version", oldest, "--cache-dir", os.path.join(self.folder, "mypy"), "fluidcarve",
                               "cookbook"], cwd=ROOT / "python", capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        wrong = self.write("wrong.py", "import fluidcarve\np = fluidcarve.Pipeline()\np.vdb.read(pth='a')\np.seam.pyramid('e', 'b', -1, axis='x')\np.lattic.box()\n")
        done = subprocess.run([mypy, "--strict", "--cache-dir", os.path.join(self.folder, "mypy"), wrong], cwd=ROOT / "python", capture_output=True, text=True,
                              env={**os.environ, "MYPYPATH": str(ROOT / "python")})
        self.assertEqual(len(re.findall("wrong.py:[345]: error", done.stdout)), 3, done.stdout)

    def test_the_wheel_holds_the_package_and_is_the_same_each_time(self):
        wheels = []
        for name in ("one", "two"):
            done = subprocess.run([sys.executable, str(ROOT / "python/wheel.py"), os.path.join(self.folder, name)], capture_output=True, text=True, check=True)
            wheels.append(done.stdout.strip())
        with open(wheels[0], "rb") as one, open(wheels[1], "rb") as two:
            self.assertEqual(one.read(), two.read())
        done = subprocess.run([sys.executable, "-c", "import fluidcarve, fluidcarve.worker; print(fluidcarve.__file__)"], cwd=self.folder, capture_output=True,
                              text=True, env={**os.environ, "PYTHONPATH": wheels[0]})
        self.assertTrue(done.stdout.startswith(wheels[0]), done.stderr)


if __name__ == "__main__":
    unittest.main()
