import asyncio
import json
import os
import signal
import tempfile
import unittest

import fluidcarve

from .test_pipeline import PLUME, plume


class Running(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.out = os.path.join(self.folder, "plume.####.vdb")
        self.work = os.path.join(self.folder, "work")

    def test_a_pipeline_runs_and_tells_what_it_does(self):
        events = []
        report = os.path.join(self.folder, "report.json")
        result = fluidcarve.run(plume(self.out), {"count": -1}, events.append, work=self.work, threads=2, report=report)
        with open(report) as file:
            self.assertEqual(json.load(file), result.raw)
        self.assertEqual(result.frames, [51, 52])
        self.assertEqual(result.nodes["seams"].type, "seam.greedy")
        self.assertEqual(len(result.seams["seams"]["energy"]), 1)
        self.assertEqual(result.failures, [])
        self.assertTrue(os.path.exists(os.path.join(self.folder, "plume.0052.vdb")))
        self.assertEqual({event.event for event in events} & {"progress", "done"}, {"progress", "done"})
        fractions = [event.fraction for event in events]
        self.assertEqual((fractions, fractions[-1]), (sorted(fractions), 1))
        planned = fluidcarve.plan(plume(self.out), {"count": -1}, work=self.work)
        self.assertEqual([planned.nodes[name].why for name in planned.nodes], [""] * len(planned.nodes))

    def test_a_wrong_pipeline_is_refused_with_its_problems(self):
        p = plume(self.out)
        p.change("gradient", field="sim.densty")
        for call in (fluidcarve.run, fluidcarve.check, fluidcarve.plan):
            with self.assertRaises(fluidcarve.Error) as raised:
                call(p)
            problem = raised.exception.problems[0]
            self.assertEqual(raised.exception.code, 2)
            self.assertIn("has no output 'densty'; did you mean 'density'?", problem.message)
            self.assertEqual(problem.remedy, "did you mean 'density'?")
            self.assertEqual((problem.line, problem.column), (12, 44))

    def test_a_frame_that_fails_is_a_problem_with_node_and_frame(self):
        with self.assertRaises(fluidcarve.Error) as raised:
            fluidcarve.run(plume(self.out), {"frames": "51-52,900"}, work=self.work)
        self.assertEqual(raised.exception.code, 3)
        self.assertEqual([(each.node, each.frame) for each in raised.exception.problems], [("sim", 900)])

    def test_a_run_can_be_polled_and_cancelled(self):
        job = fluidcarve.start(plume(self.out), work=self.work)
        self.assertEqual(job.poll(), True)
        job.cancel()
        with self.assertRaises(fluidcarve.Cancelled):
            job.wait()
        self.assertFalse(job.poll())
        with self.assertRaises(fluidcarve.Cancelled):
            job.wait()

    def test_a_callback_that_fails_ends_the_run(self):
        def fail(event):
            raise KeyError(event.event)

        job = fluidcarve.start(plume(self.out), {}, fail, work=self.work)
        with self.assertRaises(KeyError):
            job.wait()
        self.assertIsNotNone(job._process.poll())
        self.assertFalse(os.path.exists(job._folder))

    def test_runs_work_in_a_loop_of_events(self):
        async def both():
            one = fluidcarve.run_async(plume(self.out), work=self.work)
            stopped = asyncio.ensure_future(fluidcarve.run_async(plume(self.out.replace("plume.", "other.")), work=self.work + "2"))
            await asyncio.sleep(0)
            stopped.cancel()
            with self.assertRaises(asyncio.CancelledError):
                await stopped
            return await one

        self.assertEqual(asyncio.run(both()).exit, 0)

    def test_many_shots_share_their_work_and_one_that_fails_stops_none(self):
        path = os.path.join(self.folder, "shot.yaml")
        plume(self.out).save(path)
        shots = [(path, {"count": -2}), (path, {"count": -1}), (path, {"frames": 900}), path]
        done = fluidcarve.run_all(shots, work=self.work)
        self.assertEqual([shot.error is None for shot in done], [True, True, False, True])
        self.assertEqual([done[n].result.nodes["gradient"].cached for n in (0, 1, 3)], [0, 2, 2])
        self.assertEqual(done[2].error.code, 3)

    def test_files_are_carved_inspected_compared_and_explained(self):
        fluidcarve.carve(PLUME, -1, self.out, frames="51", work=self.work)
        carved = self.out.replace("####", "0051")
        told = fluidcarve.inspect(carved, os.path.join(self.folder, "no.vdb"))
        self.assertIn("density", [grid["name"] for grid in told.files[0]["grids"]])
        self.assertIn("error", told.files[1])
        self.assertEqual(fluidcarve.diff(carved, carved).result, "same")
        self.assertEqual(fluidcarve.diff(carved, PLUME.replace("####", "0051")).result, "different")
        self.assertIn("fluidcarve", fluidcarve.explain(carved).command)
        with self.assertRaises(fluidcarve.Error):
            fluidcarve.explain(PLUME.replace("####", "0051"))

    def test_a_file_that_is_not_there_is_told_as_the_program_tells_it(self):
        for call, arguments in ((fluidcarve.explain, ("/no.vdb",)), (fluidcarve.diff, ("/no.vdb", "/no.vdb"))):
            with self.subTest(call.__name__), self.assertRaises(fluidcarve.Error) as raised:
                call(*arguments)
            self.assertTrue(raised.exception.problems[0].message.startswith("/no.vdb does not exist"), raised.exception)

    def test_a_farm_tells_its_steps(self):
        path = os.path.join(self.folder, "shot.yaml")
        plume(self.out).save(path)
        job = fluidcarve.farm("openjd", path, dry_run=True, work=self.work)
        self.assertEqual(job.steps[-1]["tasks"] >= 1, True)
        with self.assertRaisesRegex(fluidcarve.Error, "save it"):
            fluidcarve.farm("openjd", plume())

    def test_ctrl_c_ends_the_run_first(self):
        def interrupt(event):
            os.kill(os.getpid(), signal.SIGINT)

        job = fluidcarve.start(plume(self.out), {}, interrupt, work=self.work)
        with self.assertRaises(KeyboardInterrupt):
            job.wait()
        self.assertIsNotNone(job._process.poll())

    def test_a_missing_program_is_told(self):
        before = os.environ.get("FLUIDCARVE")
        self.addCleanup(lambda: os.environ.__setitem__("FLUIDCARVE", before) if before else os.environ.pop("FLUIDCARVE"))
        os.environ["FLUIDCARVE"] = "/nowhere/fluidcarve"
        with self.assertRaisesRegex(fluidcarve.Error, "name the program in the environment variable FLUIDCARVE"):
            fluidcarve.run("shot.yaml")


if __name__ == "__main__":
    unittest.main()
