#include "tests/support/slurm_cluster.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Whether there is a Slurm; says so if there is none.
bool ready() {
    const bool installed = SlurmCluster::installed();
    if (!installed) std::cout << "skipped: Slurm is not installed; ./dev setup --farm\n";
    return installed;
}

/// A pipeline that is run at once, and by Slurm. Outputs and work folders lie in a folder with
/// spaces in its name.
class Job {
public:
    Job(const SlurmCluster& cluster, std::string pipeline)
        : cluster_(cluster), pipeline_(std::move(pipeline)) {
        // Around the program: fails once for each chunk while there is a file `flaky`, delivers
        // nothing the first time while there is `stuck`, and is slow while there is `slow`.
        scratch_.write("wrap", "#!/usr/bin/env bash\n" + fmt::format("cd {}\n", scratch_.path()) +
                                   R"(last=${@: -1}
if [ -e flaky ] && mkdir "failed$last" 2>/dev/null; then exit 1; fi
if [ -e stuck ] && [[ $* == *"--only out "* ]] && mkdir "stuck$last" 2>/dev/null; then exec sleep 100; fi
if [ -e slow ]; then sleep 2; fi
cd - >/dev/null
exec "$@"
)");
        // Around sbatch: takes one array, and refuses all later ones, while there is a file
        // `refused`.
        fs::create_directories(scratch_ / "bin");
        scratch_.write(
            "bin/sbatch",
            fmt::format("#!/usr/bin/env bash\nif [ -e {0}/refused ] && ! mkdir {0}/first "
                        "2>/dev/null; then exit 1; fi\nexec /usr/bin/sbatch \"$@\"\n",
                        scratch_.path()));
        for (const auto* const program : {"wrap", "bin/sbatch"})
            fs::permissions(scratch_ / program, fs::perms::owner_all);
    }

    Called call(const std::string& verb, const std::string& into,
                const std::string& more = {}) const {
        return cluster_.call(fmt::format(
            "export FLUIDCARVE_EXECUTABLE={0} PATH={6}:$PATH; {0} {1} {2} --work '{3}/{4} work' "
            "--set 'out={3}/{4}/o.####.vdb' --set 'seams={3}/{4}/s.vdb' "
            "--set 'sheet={3}/{4}/s.png' {5}",
            FLUIDCARVE_PROGRAM, verb, pipeline_, folder(), into, more, scratch_ / "bin"));
    }
    /// Hands the job to Slurm.
    Called submit(const std::string& more = {}) const {
        return call(
            "farm slurm", "many",
            fmt::format("--submit --output '{}/job' --prefix {} {}", folder(), wrapper(), more));
    }
    Json status() const {
        return Json::parse(call_shell(fmt::format("{} status --json --work '{}/many work'",
                                                  FLUIDCARVE_PROGRAM, folder()))
                               .out)
            .at(0);
    }
    void set(const std::string& fault, bool on) const {
        on ? static_cast<void>(scratch_.write(fault, ""))
           : static_cast<void>(fs::remove(scratch_ / fault));
    }

    /// Files that differ, but for the unique number that OpenVDB puts into the first 57 bytes of a
    /// file, or are only in one folder.
    std::string differences() const {
        return call_shell(fmt::format("cd '{}'; ls one >names; ls many | diff names -; for each in "
                                      "one/*; do cmp -i 57 $each many/${{each#*/}} 2>&1; done",
                                      folder()))
            .out;
    }
    /// Frames that all tasks of the farm computed of a node.
    int computed(const std::string& node) const {
        int out = 0;
        for (const auto& each : fs::directory_iterator(folder() + "/reports")) {
            const auto report = Json::parse(Scratch::read(each.path()));
            if (const auto& nodes = report.at("nodes"); nodes.contains(node))
                out +=
                    nodes.at(node).at("frames").get<int>() - nodes.at(node).at("cached").get<int>();
        }
        return out;
    }
    std::string log(const std::string& step) const {
        return call_shell(fmt::format("cat '{}'/job/logs/{}.*.log", folder(), step)).out;
    }
    /// Copies the input of vortex.yaml. @return its path
    std::string copied_input() const {
        fs::create_directories(scratch_ / "in");
        for (int frame = 41; frame <= 46; ++frame)
            fs::copy_file(fmt::format(TEST_DATA "/vortex/vortex.{:04}.vdb", frame),
                          scratch_ / fmt::format("in/v.{:04}.vdb", frame));
        return scratch_ / "in/v.####.vdb";
    }
    /// Cuts off the end of a frame of the copied input.
    void damage(int frame) const {
        const auto path = scratch_ / fmt::format("in/v.{:04}.vdb", frame);
        fs::resize_file(path, fs::file_size(path) - 5000);
    }
    std::string folder() const { return scratch_ / "it is here"; }
    std::string wrapper() const { return scratch_ / "wrap"; }

private:
    const SlurmCluster& cluster_;
    std::string pipeline_;
    Scratch scratch_;
};

}  // namespace

TEST_CASE("Slurm makes what one run makes, and computes each energy once") {
    if (!ready()) return;
    const SlurmCluster cluster;
    const Job plume(cluster, "pipelines/plume.yaml"), vortex(cluster, "pipelines/vortex.yaml");
    for (const auto* const job : {&plume, &vortex}) {
        const auto submitted =
            job->submit("--chunk 2 --set count=-2 --report '" + job->folder() + "/reports/r.json'");
        INFO(submitted.err);
        REQUIRE(submitted.code == 0);
        CHECK_THAT(submitted.out, Catch::StartsWith("submitted: "));
    }
    for (const auto* const job : {&plume, &vortex})
        REQUIRE(job->call("run", "one", "--set count=-2 -q").code == 0);
    cluster.wait_until_empty();
    for (const auto* const job : {&plume, &vortex}) {
        CHECK(job->status().at("state") == "done");
        CHECK(job->differences().empty());
        for (const auto* const node : {"edges", "energy"}) CHECK(job->computed(node) == 6);
    }
}

TEST_CASE("a chunk that fails once and a machine that dies lose nothing", "[nightly]") {
    if (!ready()) return;
    const SlurmCluster cluster;
    const Job job(cluster, "pipelines/vortex.yaml");
    job.set("flaky", true);
    job.set("slow", true);
    REQUIRE(job.submit("--chunk 3 --set count=-2 --to out").code == 0);
    const auto lost = cluster.node_of("out");
    job.set("flaky", false);
    cluster.kill_node(lost);
    job.set("slow", false);
    REQUIRE(job.call("run", "one", "--set count=-2 --to out -q").code == 0);
    cluster.wait_until_empty();
    // Slurm notes a task of a lost node as failed with it, or, if it was queued again at once, as
    // pending.
    CHECK_THAT(cluster.ended(),
               Catch::Contains("JobState=NODE_FAIL") || Catch::Contains("JobState=PENDING"));
    CHECK_THAT(job.log("*"), Catch::Contains("start 1 ended with code 1; the next one follows"));
    CHECK(job.status().at("state") == "done");
    CHECK(job.differences().empty());
}

TEST_CASE("a task that comes near its time limit starts again", "[nightly]") {
    if (!ready()) return;
    const SlurmCluster cluster;
    const Job job(cluster, "pipelines/vortex.yaml");
    job.set("stuck", true);
    const std::string options = "--set count=-2 --to out ";
    REQUIRE(job.call("farm slurm", "many",
                     options + fmt::format("--chunk 3 --output '{}/job' --prefix {}", job.folder(),
                                           job.wrapper()))
                .code == 0);
    // Slurm signals a minute before the limit: at once.
    REQUIRE(cluster.call("'" + job.folder() + "/job/submit' --time=1").code == 0);
    REQUIRE(job.call("run", "one", options + "-q").code == 0);
    cluster.wait_until_empty();
    CHECK_THAT(job.log("out"),
               Catch::Contains("start 1 ended with code 143; the next one follows") &&
                   !Catch::Contains("is cancelled"));
    CHECK(job.status().at("state") == "done");
    CHECK(job.differences().empty());
}

TEST_CASE("a job that is cancelled goes on when it is submitted again", "[nightly]") {
    if (!ready()) return;
    const SlurmCluster cluster;
    const Job job(cluster, "pipelines/vortex.yaml");
    const auto reports = " --report '" + job.folder() + "/reports/r.json'";
    REQUIRE(job.submit("--chunk 2 --set count=-2 --to out" + reports).code == 0);
    job.set("slow", true);
    cluster.node_of("out");
    const auto twice = job.submit("--chunk 2 --set count=-2 --to out" + reports);
    CHECK(twice.code == 2);
    CHECK_THAT(twice.err, Catch::Contains("submit: this job is queued already; `scancel "));
    cluster.call("scancel $(cat '" + job.folder() + "/job/jobs')");
    cluster.wait_until_empty();
    CHECK(job.status().at("state") != "done");
    CHECK(cluster.ended().find("JobState=FAILED") == std::string::npos);
    job.set("slow", false);
    // The reports of the tasks that run again say that nothing but frames was left to do.
    const int energies = job.computed("energy");
    CHECK(energies == 6);
    REQUIRE(job.submit("--chunk 2 --set count=-2 --to out" + reports).code == 0);
    cluster.wait_until_empty();
    CHECK(job.status().at("state") == "done");
    CHECK(job.computed("energy") == 0);
}

TEST_CASE("a step that fails for good ends what waits for it, and status says why", "[nightly]") {
    if (!ready()) return;
    const SlurmCluster cluster;
    const Job job(cluster, "pipelines/vortex.yaml");
    job.set("slow", true);
    REQUIRE(job.submit("--chunk 3 --set count=-2 --to out --set sim=" + job.copied_input()).code ==
            0);
    job.damage(44);
    job.set("slow", false);
    cluster.wait_until_empty();
    CHECK_THAT(cluster.ended(),
               Catch::Contains("JobState=FAILED") && Catch::Contains("JobState=CANCELLED"));
    CHECK(!fs::exists(job.folder() + "/many"));
    CHECK_THAT(job.log("*"), Catch::Contains("start 2 ended with code ") &&
                                 Catch::Contains("what waits for it is cancelled"));
    const auto status = job.status();
    CHECK(status.at("state") == "failed");
    CHECK_THAT(status.at("failures").dump(), Catch::Contains("v.0044.vdb"));
    CHECK_THAT(status.at("again").get<std::string>(),
               Catch::Contains(" farm slurm pipelines/vortex.yaml "));
}

TEST_CASE("a job that Slurm does not take as a whole is not submitted at all") {
    if (!ready()) return;
    const SlurmCluster cluster;
    const Job job(cluster, "pipelines/vortex.yaml");
    job.set("slow", true);
    job.set("refused", true);
    const auto refused = job.submit("--chunk 3");
    CHECK(refused.code == 1);
    CHECK_THAT(refused.err, Catch::EndsWith("submit: failed; nothing is submitted\n"));
    CHECK(!fs::exists(job.folder() + "/job/jobs"));
    cluster.wait_until_empty();
    CHECK_THAT(cluster.ended(), Catch::Contains("JobState=CANCELLED"));
    CHECK(cluster.ended().find("JobState=COMPLETED") == std::string::npos);
}
