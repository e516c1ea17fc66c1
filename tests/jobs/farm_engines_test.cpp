#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <linux/magic.h>
#include <sys/vfs.h>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// A shot of few small frames, in a project with spaces, quotes and braces in its name.
class Project {
public:
    explicit Project(const std::string& frames = "51-56", int first = 51, int last = 56,
                     int step = 1) {
        fs::create_directories(folder() + "/in put");
        for (int frame = first; frame <= last; frame += step)
            fs::create_symlink(fmt::format(TEST_DATA "/plume/plume.{:04}.vdb",
                                           frame >= 51 && frame <= 56 ? frame : 51),
                               folder() + fmt::format("/in put/p.{:04}.vdb", frame));
        scratch_.write(name + "/shot {{a}}.yaml", "fluidcarve: 1\nframes: " + frames + R"(
nodes:
  sim:    {type: vdb.read, path: "in put/p.####.vdb", grids: {density: float}}
  energy: {type: energy.gradient, field: sim.density}
  box:    {type: lattice.box, fit: sim.density}
  seams:  {type: seam.pyramid, energy: energy, field: sim.density, lattice: box, axis: u, count: -1}
  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}
  out:    {type: vdb.write, source: carved, path: "out/o.####.vdb"}
  kept:   {type: seams.write, seams: seams, path: "out/it's {{k}}.vdb"}
)");
    }
    Called call(const std::string& verb, const std::string& more = {},
                const std::string& work = "work") const {
        return call_shell(fmt::format("cd \"{}\" && {} {} 'shot {{{{a}}}}.yaml' --work {} {}",
                                      folder(), FLUIDCARVE_PROGRAM, verb, work, more));
    }
    /// A bundle, handed to the scheduler of the tests. @param verb  `tasks` or `run`
    Called schedule(const std::string& bundle, const std::string& verb) const {
        return call_shell(
            fmt::format("/usr/bin/python3 tests/support/openjd.py "
                        "tests/data/jobs/openjd_template.schema.json \"{}/{}\" {}",
                        folder(), bundle, verb));
    }
    /// Files of `one` and `out` that differ, but for the unique number that OpenVDB puts into the
    /// first 57 bytes of a file, or are only in one.
    std::string differences() const {
        return call_shell(
                   fmt::format("cd \"{}\" && ls one >names && ls out | diff names -; for each in "
                               "one/*; do cmp -i 57 \"$each\" \"out/${{each#*/}}\" 2>&1; done",
                               folder()))
            .out;
    }
    std::string folder() const { return scratch_ / name; }
    const Scratch& scratch() const { return scratch_; }

private:
    inline static const std::string name = "it's {{here}}";
    Scratch scratch_;
};

/// The frames of a step's tasks, as the program reads them; each is counted.
/// @param tasks  lines: a step and the frames of one of its tasks
std::map<int, int> frames_of(const std::string& tasks, const std::string& step) {
    const Scratch scratch;
    const auto listed =
        call_shell("/usr/bin/python3 - " + scratch.write("tasks", tasks) + " " + step + R"( <<'END'
import re, sys
for line in open(sys.argv[1]):
    step, _, frames = line.strip().partition(" ")
    for part in frames.replace(":", "x").split(",") if step == sys.argv[2] else []:
        first, last, by = re.fullmatch(r"(-?\d+)(?:-(-?\d+)(?:x(\d+))?)?", part).groups()
        for frame in range(int(first), int(last or first) + 1, int(by or 1)): print(frame)
END
)");
    std::map<int, int> out;
    std::istringstream numbers(listed.out);
    for (int frame = 0; numbers >> frame;) ++out[frame];
    return out;
}

}  // namespace

TEST_CASE("the tasks of every engine have each frame once, and job bundles are valid",
          "[nightly][long]") {
    struct Case {
        std::string frames;
        int first, last, step;
    };
    for (const auto& [frames, first, last, step] : {Case{"1001-1240", 1001, 1240, 1},
                                                    {"1-100x3", 1, 100, 3},
                                                    {"-5-5", -5, 5, 1},
                                                    {"52", 52, 52, 1}}) {
        const Project project(frames, first, last, step);
        std::map<int, int> wanted;
        for (int frame = first; frame <= last; frame += step) wanted[frame] = 1;
        for (const std::string extension : {"", "--no-chunk-extension"}) {
            INFO(frames << " " << extension);
            const auto made = project.call("farm openjd", "--chunk 7 --output bundle " + extension);
            INFO(made.err);
            REQUIRE(made.code == 0);
            const auto tasks = project.schedule("bundle", "tasks");
            INFO(tasks.err);
            REQUIRE(tasks.code == 0);
            CHECK(frames_of(tasks.out, "seams-energy") == wanted);
            CHECK(frames_of(tasks.out, "out") == wanted);
        }
        INFO(frames);
        REQUIRE(project.call("farm slurm", "--chunk 7 --output job").code == 0);
        REQUIRE(call_shell(fmt::format("cd \"{}\" && FLUIDCARVE_EXECUTABLE=true {} farm local "
                                       "*.yaml --work local -q --chunk 7",
                                       project.folder(), FLUIDCARVE_PROGRAM))
                    .code == 0);
        for (const std::string step : {"seams-energy", "out"}) {
            const auto tasks_in = [&](const std::string& files) {
                return call_shell(fmt::format("cd \"{}\" && cat {} | grep -o -- "
                                              "'--frames=[-0-9,x]*' | sed 's/--frames=/{} /'",
                                              project.folder(), files, step))
                    .out;
            };
            CHECK(frames_of(tasks_in("job/" + step + ".sbatch"), step) == wanted);
            CHECK(frames_of(tasks_in("local/jobs/*/logs/" + step + ".*"), step) == wanted);
        }
    }
}

TEST_CASE("a job bundle says what travels, and what its hosts must have") {
    const Project project;
    REQUIRE(project.call("farm openjd", "--chunk 2 --threads 3 --output bundle").code == 0);
    const auto job = Json::parse(Scratch::read(project.folder() + "/bundle/template.json"));
    CHECK(job.at("extensions") == Json{"TASK_CHUNKING"});
    std::map<std::string, Json> parameters, steps;
    for (const auto& each : job.at("parameterDefinitions")) parameters[each.at("name")] = each;
    for (const auto& each : job.at("steps")) steps[each.at("name")] = each;
    const auto is = [&](const std::string& name, const std::string& type, const std::string& flow,
                        const std::string& place) {
        INFO(name);
        CHECK(parameters.at(name).at("objectType") == type);
        CHECK(parameters.at(name).at("dataFlow") == flow);
        CHECK(parameters.at(name).at("default") == place);
    };
    is("project", "DIRECTORY", "NONE", "..");
    is("pipeline", "FILE", "IN", "../shot {{a}}.yaml");
    is("sim_path", "DIRECTORY", "IN", "../in put");
    is("out_path", "DIRECTORY", "OUT", "../out");
    is("kept_path", "FILE", "OUT", "../out/it's {{k}}.vdb");
    is("work", "DIRECTORY", "INOUT", "../work");
    CHECK(parameters.size() == 6);
    const auto& step = steps.at("seams-energy");
    CHECK(step.at("dependencies").at(0).at("dependsOn") == "box-fit");
    const auto amounts = step.at("hostRequirements").at("amounts");
    CHECK(amounts.at(0) == Json{{"name", "amount.worker.vcpu"}, {"min", 3}});
    CHECK(amounts.at(1).at("name") == "amount.worker.memory");
    CHECK(amounts.at(1).at("min") > 256);
    CHECK(amounts.at(2).at("name") == "amount.worker.disk.scratch");
    CHECK(step.at("script").at("actions").at("onRun").at("cancelation").at("mode") ==
          "NOTIFY_THEN_TERMINATE");
    CHECK(steps.at("seams").find("parameterSpace") == steps.at("seams").end());
}

TEST_CASE("a job bundle makes what one run makes, also where its scheduler has moved files",
          "[nightly][long]") {
    const Project project;
    REQUIRE(project.call("run", "-q --no-cache").code == 0);
    fs::rename(project.folder() + "/out", project.folder() + "/one");
    for (const std::string extension : {"", "--no-chunk-extension"}) {
        REQUIRE(project.call("farm openjd", "--chunk 4 --output bundle " + extension).code == 0);
        const auto ran = project.schedule("bundle", "run");
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        CHECK_THAT(ran.out, Catch::Contains("openjd_progress: 100.0"));
        CHECK(project.differences().empty());
        fs::remove_all(project.folder() + "/out");
        fs::remove_all(project.folder() + "/work");
    }
    REQUIRE(project.call("farm openjd", "--chunk 4 --output bundle").code == 0);
    const auto moved = project.scratch() / "moved 'there'";
    fs::create_directories(moved);
    fs::rename(project.folder() + "/in put", moved + "/in put");
    const auto ran = project.schedule(
        "bundle",
        fmt::format("run \"{0}/in put={1}/in put\" \"{0}/out={1}/out\"", project.folder(), moved));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK(!fs::exists(project.folder() + "/out"));
    CHECK(call_shell(fmt::format("{0} diff \"{1}/one/o.####.vdb\" \"{2}/out/o.####.vdb\"",
                                 FLUIDCARVE_PROGRAM, project.folder(), moved))
              .code == 0);
}

TEST_CASE("the environment that a pipeline takes values from travels with its tasks", "[long]") {
    const Project project;
    project.scratch().write("it's {{here}}/set.yaml",
                            "extends: 'shot {{a}}.yaml'\nenv: [CARVED, UNSET]\nnodes: {out: {path: "
                            "\"out/${CARVED}.####.vdb\"}}\n");
    const auto call = [&](const std::string& carved, const std::string& engine,
                          const std::string& more) {
        return call_shell(
            fmt::format("cd \"{}\" && CARVED={} {} farm {} set.yaml --work work --chunk 6 {}",
                        project.folder(), carved, FLUIDCARVE_PROGRAM, engine, more));
    };
    const auto dry = [&](const std::string& carved) {
        return Json::parse(call(carved, "local", "--dry-run --json").out);
    };
    const auto command = dry("'a b'").at("steps").at(0).at("command");
    CHECK(command.at(0) == "env");
    CHECK(command.at(1) == "CARVED=a b");
    CHECK(dry("c").at("name") != dry("d").at("name"));
    // The scheduler has another environment.
    const auto made = call("'a b'", "openjd", "--output bundle");
    INFO(made.err);
    REQUIRE(made.code == 0);
    const auto ran = project.schedule("bundle", "run");
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK(fs::exists(project.folder() + "/out/a b.0051.vdb"));
}

TEST_CASE("Slurm's scripts are shell code, and their arrays index chunks") {
    const Project project("-5-5", -5, 5);
    REQUIRE(project.call("farm slurm", "--chunk 4 --threads 3 --output job").code == 0);
    CHECK(call_shell(fmt::format("cd \"{}/job\" && bash -n submit && for each in *.sbatch; do bash "
                                 "-n $each || exit 1; done",
                                 project.folder()))
              .code == 0);
    const auto script = Scratch::read(project.folder() + "/job/seams-energy.sbatch");
    CHECK_THAT(script,
               Catch::Contains("\n    --frames=-5--2\n    --frames=-1-2\n    --frames=3-5\n)") &&
                   Catch::Contains("\n#SBATCH --cpus-per-task=3\n") &&
                   Catch::Contains("\n#SBATCH --requeue\n") &&
                   Catch::Contains("\n#SBATCH --kill-on-invalid-dep=yes\n") &&
                   Catch::Contains("\n#SBATCH --mem="));
    CHECK_THAT(Scratch::read(project.folder() + "/job/submit"),
               Catch::Contains("\nstep box-fit 3\n") &&
                   Catch::Contains("\nstep seams-energy 3 box-fit\n") &&
                   Catch::Contains("\nstep seams 1 seams-energy\n") &&
                   Catch::Contains("\nstep out 3 seams\n"));
}

TEST_CASE("arrays of more tasks than Slurm takes are split") {
    const Project project("1-1100", 1, 1100);
    REQUIRE(project.call("farm slurm", "--chunk 1 --output job --to seams.energy").code == 0);
    // An sbatch that says what it is given.
    fs::create_directories(project.scratch() / "bin");
    project.scratch().write("bin/sbatch",
                            "#!/bin/sh\nfor word; do printf '%s ' \"${word##*/}\"; done | tee -a " +
                                (project.scratch() / "given") + " >/dev/null; echo >>" +
                                (project.scratch() / "given") + "; wc -l <" +
                                (project.scratch() / "given") + "\n");
    for (const auto* const name : {"scancel", "squeue"})
        project.scratch().write(std::string("bin/") + name, "#!/bin/sh\n");
    const auto submitted =
        call_shell(fmt::format("chmod +x {0}/*; PATH={0}:$PATH \"{1}/job/submit\" --partition=fx",
                               project.scratch() / "bin", project.folder()));
    INFO(submitted.err);
    REQUIRE(submitted.code == 0);
    const auto given = Scratch::read(project.scratch() / "given");
    CHECK_THAT(given, Catch::Contains("--array=0-999 --job-name=") &&
                          Catch::Contains(" --partition=fx box-fit.sbatch 1000 ") &&
                          Catch::Contains("--array=0-99 ") &&
                          Catch::Contains(" --dependency=afterok:1:2 ") &&
                          Catch::Contains(" --partition=fx seams-energy.sbatch 1000 "));
    CHECK(std::ranges::count(given, '\n') == 4);
    CHECK_THAT(submitted.out, Catch::StartsWith("submitted: 1 2 3 4\n"));
}

TEST_CASE("a work folder on a disk of this machine is warned of, if other machines shall see it") {
    const Project project;
    const auto file_system = call_shell("stat -f -c %T \"" + project.folder() + "\"").out;
    const bool disk =
        std::set<std::string>{"ext2/ext3\n", "xfs\n", "btrfs\n", "overlayfs\n", "f2fs\n"}.contains(
            file_system);
    const auto warned = [&](const std::string& verb) {
        const auto called = project.call(verb, "--dry-run");
        CHECK(called.code == 0);
        return called.err.find("warning: --work: ") != std::string::npos;
    };
    CHECK(warned("farm slurm") == disk);
    CHECK(warned("farm openjd") == disk);
    CHECK(!warned("farm local"));
}

TEST_CASE("engines refuse what they can't do, and make nothing", "[long]") {
    const Project project;
    const auto refused = [&](const std::string& verb, const std::string& more, int code,
                             const std::string& message, const std::string& work = "work") {
        const auto called = project.call(verb, more, work);
        INFO(verb << " " << more);
        CHECK(called.code == code);
        CHECK_THAT(called.err, Catch::Contains(message));
        for (const auto& made : {project.folder() + "/work", project.folder() + "/job", work})
            CHECK(!fs::exists(made));
    };
    refused("farm openjd", "--output job --submit", 2,
            "--submit: a bundle is handed over by its scheduler's own command, such as `deadline "
            "bundle submit");
    const auto without = call_shell(fmt::format(
        "cd \"{}\" && PATH=/nowhere {} farm slurm *.yaml --work work --output job --submit",
        project.folder(), FLUIDCARVE_PROGRAM));
    CHECK(without.code == 2);
    CHECK_THAT(without.err, Catch::StartsWith("--submit: there is no sbatch in PATH; "));
    CHECK(!fs::exists(project.folder() + "/work"));
    CHECK(!fs::exists(project.folder() + "/job"));
    refused("farm slurm", "--output job --chunk 0", 2, "--chunk 0: ");
    refused("farm openjd", "--output job --chunk 0", 2, "--chunk 0: ");
    refused("farm local", "--output job", 2,
            "--output: local does not take it; it is for slurm and openjd\n");
    refused("farm slurm", "--output job -j 2", 2,
            "--processes: slurm does not take it; it is for local\n");
    refused("farm slurm", "--output job --no-chunk-extension", 2,
            "--no-chunk-extension: slurm does not take it; it is for openjd\n");
    for (const std::string verb : {"farm slurm", "farm openjd"}) {
        refused(verb, "--output job --set sim.path=nowhere.####.vdb", 3, "nowhere.0051.vdb");
        // In a container it may be a folder on a disk.
        struct statfs shared {};
        if (statfs("/dev/shm", &shared) == 0 && shared.f_type == TMPFS_MAGIC)
            refused(verb, "--output job", 2,
                    "--work: /dev/shm/fluidcarve_work is in the memory of this machine",
                    "/dev/shm/fluidcarve_work");
        refused(verb, "--output job", 1, "failed: cannot make the work folder /proc/none",
                "/proc/none");
    }
    refused("farm openjd", "--output job --set energy.field=sim.densty", 2, "densty");
    fs::create_directories(project.folder() + "/taken");
    project.scratch().write("it's {{here}}/taken/submit", "echo mine\n");
    const auto held = project.call("farm slurm", "--output taken");
    CHECK(held.code == 1);
    CHECK_THAT(
        held.err,
        Catch::Contains(
            "taken/submit is there already, and `farm` did not write it; choose another --output"));
    CHECK(!fs::exists(project.folder() + "/taken/out.sbatch"));
    CHECK(project.call("farm slurm", "--output .").code == 0);
    CHECK(project.call("farm slurm", "--output .").code == 0);
}
