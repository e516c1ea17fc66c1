#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <algorithm>
#include <filesystem>
#include <regex>
#include <vector>

namespace fs = std::filesystem;

namespace {

const std::string small_vdb = TEST_DATA "/vdb/cortex_points.vdb";
const std::string large_vdb = TEST_DATA "/plume/plume.0051.vdb";

/// A folder with a pipeline that copies `in.####.vdb` to `out/o.####.vdb`, frames 1-6.
class Bench {
public:
    Bench() { write(); }

    /// @param more  further nodes
    void write(const std::string& sim = "path: in.####.vdb", const std::string& more = {}) const {
        scratch.write("p.yaml", "fluidcarve: 1\nframes: 1-6\nnodes:\n  sim: {type: vdb.read, " +
                                    sim + "}\n  out: {type: vdb.write, source: sim, path: \"" +
                                    (scratch / "out/o.####.vdb") + "\"}\n" + more);
    }
    void put(const std::vector<int>& frames, const std::string& file = small_vdb) const {
        for (const int frame : frames)
            fs::copy_file(file, scratch / "in.000" + std::to_string(frame) + ".vdb",
                          fs::copy_options::overwrite_existing);
    }

    /// One frame after the other, so that it is known which were made. Without the folder's name
    /// and the time in what is told.
    Called run(const std::string& arguments = {}, const std::string& shell = {}) const {
        return plain(call_shell(
            shell + FLUIDCARVE_PROGRAM " run --progress none --threads 1 --in-flight 1 " +
            (scratch / "p.yaml") + " " + arguments));
    }
    Called plain(Called called) const {
        for (std::size_t at; (at = called.err.find(scratch.path() + "/")) != std::string::npos;)
            called.err.erase(at, scratch.path().size() + 1);
        called.err =
            std::regex_replace(called.err, std::regex(" in [0-9.]+ s( ->|\n)"), " in N s$1");
        return called;
    }

    std::vector<std::string> files(const std::string& folder = "out") const {
        std::vector<std::string> out;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(scratch / folder, none))
            out.push_back(entry.path().filename().string());
        std::ranges::sort(out);
        return out;
    }

    Scratch scratch;
};

using Files = std::vector<std::string>;

void require(const Called& called, int code, const std::string& err) {
    CHECK(called.err == err);
    CHECK(called.out == "");
    CHECK(called.code == code);
}

/// A limit on the size of files, in units of 512 bytes, stands in for a full disk.
std::string disk_of(int blocks) {
    return "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; ";
}

}  // namespace

TEST_CASE("a pipeline with slips is refused with all of them, and nothing is made") {
    const Bench bench;
    bench.put({1});
    bench.scratch.write("p.yaml", R"(fluidcarve: 1
nodes:
  sim: {type: vdb.read, path: in.<fram>.vdb, grids: {density: float, velocity: vector}}
  spin: {type: energy.vorticity, velocity: sim.density}
  detail: {type: energy.gradient, field: sim.densty}
  sum: {type: energy.comine, terms: [spin, detail]}
  out: {type: vdb.write, source: sim, path: out.####.vdb, compresion: zip}
)");
    require(bench.run("--set sim.pth=a --set smi.path=a --set cuont=3"), 2,
            "--set:1:1: there is no node 'smi'; did you mean 'sim'?\nsmi.path=a\n^\n"
            "--set:1:1: there is no param 'cuont'\ncuont=3\n^\n"
            "--set:1:5: vdb.read has no parameter 'pth'; did you mean 'path'?\nsim.pth=a\n    ^\n"
            "p.yaml:3:31: vdb.read parameter 'path' has '<fram>', which is no frame token; did you "
            "mean '<frame>'?\n"
            "  sim: {type: vdb.read, path: in.<fram>.vdb, grids: {density: float, velocity: "
            "vector}}\n                              ^\n"
            "p.yaml:6:15: there is no node type 'energy.comine'; did you mean 'energy.combine'?\n"
            "  sum: {type: energy.comine, terms: [spin, detail]}\n              ^\n"
            "p.yaml:7:59: vdb.write has no parameter 'compresion'; did you mean 'compression'?\n"
            "  out: {type: vdb.write, source: sim, path: out.####.vdb, compresion: zip}\n          "
            "                                                ^\n");
    CHECK(bench.files(".") == Files{"in.0001.vdb", "p.yaml"});
}

TEST_CASE("a wrong port is refused with both ends") {
    const Bench bench;
    const std::string here = "\np.yaml:4:3: ";
    const std::string sim =
        "  sim: {type: vdb.read, path: in.####.vdb, grids: {density: float, velocity: vector}}\n  "
        "^\n";
    bench.write("path: in.####.vdb, grids: {density: float, velocity: vector}",
                "  spin: {type: energy.vorticity, velocity: sim.density}\n  detail: {type: "
                "energy.gradient, field: sim.densty}\n  bare: {type: energy.gradient}\n");
    require(
        bench.run(), 2,
        "p.yaml:6:44: energy.vorticity input 'velocity' takes vector, but sim.density is float\n"
        "  spin: {type: energy.vorticity, velocity: sim.density}\n                                 "
        "          ^" +
            here + "'sim' (vdb.read) is defined here\n" + sim +
            "p.yaml:7:42: 'sim' (vdb.read) has no output 'densty'; did you mean 'density'?\n"
            "  detail: {type: energy.gradient, field: sim.densty}\n                                "
            "         ^" +
            here + "it is defined here\n" + sim +
            "p.yaml:8:3: energy.gradient needs its input 'field' (float)\n  bare: {type: "
            "energy.gradient}\n  ^\n");
}

TEST_CASE("a file that is no pipeline is refused") {
    const Bench bench;
    const auto refused = [&](const std::string& text, const std::string& message) {
        bench.scratch.write("p.yaml", text);
        require(bench.run(), 2, "p.yaml: " + message + "\n");
    };
    refused("", "the file is empty: a pipeline starts with 'fluidcarve: 1' and has 'nodes:'");
    refused(Scratch::read(small_vdb), "binary data: a pipeline is a text in UTF-8");
    refused(std::string(1 << 21, '#'), "the file holds more than 1 MiB: not a pipeline");
    fs::remove(bench.scratch / "p.yaml");
    require(bench.run("--set a=1"), 2, "cannot read p.yaml: it does not exist\n");
    fs::create_directory(bench.scratch / "p.yaml");
    require(bench.run(), 2, "cannot read p.yaml: it is a folder\n");
    fs::remove(bench.scratch / "p.yaml");
    REQUIRE(mkfifo((bench.scratch / "p.yaml").c_str(), 0600) == 0);
    require(
        bench.run(), 2,
        "cannot read p.yaml: it is a pipe or a device; a pipeline is read from a regular file\n");
}

TEST_CASE("an -f that names no frame of the sequence is refused") {
    const Bench bench;
    bench.put({1});
    require(bench.run("-f ''"), 2, "-f: no frame is named; write 1001, 1001-1084 or 1001-1084x2\n");
    require(bench.run("-f 5-"), 2,
            "-f: '5-' is no frame or range; write 1001, 1001-1084 or 1001-1084x2\n");
    require(bench.run("-f 1-3x0"), 2, "-f: '1-3x0' has a step of 0; the least is 1\n");
    require(bench.run("-f 1-99999999999"), 2,
            "-f: '1-99999999999' has a number beyond 2147483647, the most that a frame can be\n");
    require(bench.run("-f 1-2000000"), 2, "-f: '1-2000000' names more than 1000000 frames\n");
    require(bench.run("-f 5-9x2,0"), 2, "-f: 0,7,9 is not in the sequence 1-6\n");
    CHECK(bench.files().empty());
}

TEST_CASE("a missing frame is an error before anything runs, is left out, or is held") {
    const Bench bench;
    bench.put({1, 3, 4, 6});
    const std::string both =
        "failed: sim (vdb.read), frame 2: in.0002.vdb does not exist\nfailed: sim (vdb.read), "
        "frame 5: in.0005.vdb does not exist\n";
    require(bench.run(), 3, both);
    CHECK(bench.files().empty());
    require(bench.run("-f 1,3"), 0, "done: 2 frames in N s -> out/o.####.vdb\n");
    CHECK(bench.files() == Files{"o.0001.vdb", "o.0003.vdb"});

    require(bench.run("--set sim.missing=skip"), 0, "done: 4 frames in N s -> out/o.####.vdb\n");
    CHECK(bench.files() == Files{"o.0001.vdb", "o.0003.vdb", "o.0004.vdb", "o.0006.vdb"});
    fs::remove_all(bench.scratch / "out");
    require(bench.run("--set sim.missing=skip -f 2,5"), 0,
            "warning: sim (vdb.read): left out because their files are missing, though -f names "
            "them: 2,5\ndone: 0 frames in N s\n");
    CHECK(bench.files().empty());

    require(bench.run("--keep-going"), 4, both);
    CHECK(bench.files() == Files{"o.0001.vdb", "o.0003.vdb", "o.0004.vdb", "o.0006.vdb"});
    require(bench.run("--set sim.missing=hold"), 0, "done: 6 frames in N s -> out/o.####.vdb\n");
    CHECK(bench.files().size() == 6);
}

TEST_CASE("a run that has nothing to do says so, and where the files are") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5, 6});
    const auto with = "--work " + (bench.scratch / "kept");
    require(bench.run(with), 0, "done: 6 frames in N s -> out/o.####.vdb\n");
    require(bench.run(with), 0,
            "done: nothing had to be done, all is there already: 6 frames -> out/o.####.vdb\n");
    require(bench.run(with + " -f 2"), 0,
            "done: nothing had to be done, all is there already: 1 frame -> out/o.####.vdb\n");
    fs::remove(bench.scratch / "out/o.0002.vdb");
    require(bench.run(with + " -f 2"), 0, "done: 1 frame in N s -> out/o.####.vdb\n");
}

TEST_CASE("where every frame is missing there is nothing to skip or hold") {
    const Bench bench;
    for (const std::string missing : {"error", "skip", "hold"}) {
        require(bench.run("--set sim.missing=" + missing), 3,
                "failed: sim (vdb.read), frame 1: in.0001.vdb does not exist, nor does in.0001.vdb "
                "in the current folder, nor does any other frame\n");
        require(bench.run("-f 3-4 --set sim.missing=" + missing), 3,
                "failed: sim (vdb.read), frame 3: in.0003.vdb does not exist, nor does in.0003.vdb "
                "in the current folder, nor does any other frame\n");
    }
    bench.put({1, 2, 3});
    bench.write("path: in.####.vdb, missing: skip",
                "  other: {type: vdb.read, path: b.####.vdb, missing: skip}\n");
    for (const int frame : {4, 5, 6})
        fs::copy_file(small_vdb, bench.scratch / "b.000" + std::to_string(frame) + ".vdb");
    const auto fault =
        "failed: out (vdb.write): no frame is left: every frame lacks a file of a reader with "
        "`missing: skip`\n";
    require(bench.run(), 3, fault);
    require(bench.plain(fluidcarve_program("plan " + (bench.scratch / "p.yaml"))), 3, fault);
    CHECK(bench.files().empty());
}

TEST_CASE("files that can't be read are told before anything runs, each with its fault") {
    const Bench bench;
    bench.put({1});
    const auto whole = Scratch::read(small_vdb);
    bench.scratch.write("in.0002.vdb", "");
    bench.scratch.write("in.0003.vdb", "a letter to the editor");
    fs::create_directory(bench.scratch / "in.0004.vdb");
    bench.scratch.write("in.0005.vdb", whole.substr(0, 20000));
    bench.scratch.write("in.0006.vdb", whole.substr(0, 100));
    const std::string all =
        "failed: sim (vdb.read), frame 2: in.0002.vdb is cut off: it ends within its header, at "
        "byte 0; copy or write it again\n"
        "failed: sim (vdb.read), frame 3: in.0003.vdb is not a VDB file\n"
        "failed: sim (vdb.read), frame 4: in.0004.vdb is not a file\n"
        "failed: sim (vdb.read), frame 5: in.0005.vdb is cut off: grid 'points' ends at byte "
        "38933, the file at 20000; copy or write it again\n"
        "failed: sim (vdb.read), frame 6: in.0006.vdb is cut off: it ends within its header, at "
        "byte 100; copy or write it again\n";
    require(bench.run(), 3, all);
    CHECK(bench.files().empty());
    require(bench.run("--keep-going"), 4, all);
    CHECK(bench.files() == Files{"o.0001.vdb"});
}

TEST_CASE("a grid that is missing, or of another type, is told with what the file has") {
    const Bench bench;
    bench.put({1, 2}, large_vdb);
    const auto run = [&](const std::string& grid) {
        bench.write("path: in.####.vdb, grids: {x: " + grid + "}",
                    "  detail: {type: energy.gradient, field: sim.x}\n");
        return bench.run("-f 1");
    };
    require(run("{name: densty, type: float}"), 3,
            "failed: sim (vdb.read), frame 1: in.0001.vdb has no grid 'densty'; it has velocity, "
            "density, shadow, temperature, flame; did you mean 'density'?\n");
    require(run("{name: velocity, type: float}"), 3,
            "failed: sim (vdb.read), frame 1: in.0001.vdb: grid 'velocity' is of type vec3s, not "
            "float; state it as vector\n");
    CHECK(bench.files().empty());
}

TEST_CASE("a grid that a later node lacks is told before anything runs") {
    const Scratch scratch;
    const auto call = [&](const std::string& verb, const std::string& more) {
        return fluidcarve_program(
            verb + " pipelines/plume.yaml --set out=" + (scratch / "out/o.####.vdb") +
            " --set seams=" + (scratch / "out/seams.vdb") +
            " --set sheet=" + (scratch / "out/sheet.png") + " " + more);
    };
    const std::string unknown =
        "failed: sheet (preview.sheet), frame 51: 'before' has no grid 'smoke'; known: velocity, "
        "density, shadow, temperature, flame\n";
    require(call("run -q", "--set sheet.grid=smoke"), 3, unknown);
    require(call("plan", "--set sheet.grid=smoke"), 3, unknown);
    // A carve keeps the names of the grids.
    require(call("run -q", "--set sheet.grid=densty --set sheet.before=carved"), 3,
            "failed: sheet (preview.sheet), frame 51: 'before' has no grid 'densty'; did you mean "
            "'density'?\n");
    CHECK_FALSE(fs::exists(scratch / "out"));
}

TEST_CASE("an output over an input is refused, whatever the path, and the input stays") {
    const Bench bench;
    bench.put({1});
    fs::create_directory_symlink(bench.scratch.path(), bench.scratch / "link");
    bench.write();
    for (const std::string& path :
         {bench.scratch / "in.####.vdb", bench.scratch / "link/./in.%04d.vdb",
          fs::relative(bench.scratch / "in.$F4.vdb", SOURCE_ROOT).string()}) {
        const auto quoted = "'out.path=" + path + "'";
        auto shown = "out.path=" + path + "\n";
        if (const auto at = shown.find(bench.scratch.path() + "/"); at != std::string::npos)
            shown.erase(at, bench.scratch.path().size() + 1);
        require(bench.run("-f 1 --set " + quoted), 2,
                "--set:1:10: 'out' would overwrite a file of the same pipeline\n" + shown +
                    "         ^\np.yaml:4:31: 'sim' reads it here\n  sim: {type: vdb.read, path: "
                    "in.####.vdb}\n                              ^\n");
    }
    CHECK(Scratch::read(bench.scratch / "in.0001.vdb") == Scratch::read(small_vdb));
}

TEST_CASE("where nothing can be written is told before anything runs") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5, 6});
    require(bench.run("--set out.path=/proc/nowhere/o.####.vdb"), 1,
            "failed: out (vdb.write), frame 1: cannot write /proc/nowhere/o.0001.vdb: the folder "
            "/proc/nowhere cannot be made: No such file or directory\n");
    require(bench.run("--set out.path=/proc/o.####.vdb"), 1,
            "failed: out (vdb.write), frame 1: cannot write /proc/o.0001.vdb: no file can be made "
            "in the folder /proc: No such file or directory\n");
    require(bench.run("--set out.path=" + (bench.scratch / "p.yaml/o.####.vdb")), 1,
            "failed: out (vdb.write), frame 1: cannot write p.yaml/o.0001.vdb: the folder p.yaml "
            "cannot be made: Not a directory\n");
    require(bench.run("--report /proc/nowhere/r.json"), 1,
            "failed: report: cannot write /proc/nowhere/r.json: the folder /proc/nowhere cannot be "
            "made: No such file or directory\n");
    CHECK(bench.files().empty());
}

TEST_CASE("a full disk is told, and leaves nothing half-written") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5, 6});
    require(bench.run("", disk_of(8)), 1,
            "failed: out (vdb.write), frame 1: cannot write out/o.0001.vdb: the file did not come "
            "out whole; is the disk full?\n");
    CHECK(bench.files().empty());
}

TEST_CASE("a report that a full disk cuts off fails the run, and is not there") {
    const Bench bench;
    bench.put({1});
    bench.scratch.write("p.yaml", "fluidcarve: 1\nnodes:\n  " + std::string(600, 'n') +
                                      ": {type: vdb.read, path: in.0001.vdb}\n");
    require(bench.run("--report " + (bench.scratch / "r.json"), disk_of(1)), 1,
            "done: 1 frame in N s\nfailed: report: cannot write r.json: File too large\n");
    CHECK(bench.files(".") == Files{"in.0001.vdb", "p.yaml"});
}

TEST_CASE("a report goes through a pipe, and a closed pipe for messages does not end the run") {
    const Bench bench;
    bench.put({1});
    const auto out = " --set out.path=" + (bench.scratch / "out/o.####.vdb");
    const auto piped = call_shell(FLUIDCARVE_PROGRAM " run -q " + (bench.scratch / "p.yaml") +
                                  " -f 1" + out + " --report /dev/stdout | cat");
    CHECK_THAT(piped.out, Catch::StartsWith("{\n  \"fluidcarve\""));
    fs::remove_all(bench.scratch / "out");
    call_shell(FLUIDCARVE_PROGRAM " run " + (bench.scratch / "p.yaml") + " -f 1" + out +
               " 2>&1 | true");
    CHECK(bench.files() == Files{"o.0001.vdb"});
}

TEST_CASE("a write that fails half way keeps the frames before it whole") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5, 6});
    REQUIRE(bench.run("--set out.path=" + (bench.scratch / "whole/o.####.vdb")).code == 0);
    bench.put({3}, large_vdb);
    const std::string told =
        "failed: out (vdb.write), frame 3: cannot write out/o.0003.vdb: the file did not come out "
        "whole; is the disk full?\n";
    require(bench.run("", disk_of(200)), 1, told);
    CHECK(bench.files() == Files{"o.0001.vdb", "o.0002.vdb"});
    // Whole but for the identifier of its own that each file has, behind magic, versions and the
    // offsets flag.
    const auto without_identifier = [&](const std::string& path) {
        return Scratch::read(bench.scratch / path).erase(8 + 4 + 4 + 4 + 1, 36);
    };
    for (const auto& file : bench.files())
        CHECK((without_identifier("out/" + file) == without_identifier("whole/" + file)));
    require(bench.run("--keep-going", disk_of(200)), 4, told);
    CHECK(bench.files() ==
          Files{"o.0001.vdb", "o.0002.vdb", "o.0004.vdb", "o.0005.vdb", "o.0006.vdb"});
}

TEST_CASE("a run whose words can't be written still ends by its code") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5});
    CHECK(
        call_shell(FLUIDCARVE_PROGRAM " run " + (bench.scratch / "p.yaml") + " 2>/dev/full").code ==
        3);
    const auto cut = call_shell(FLUIDCARVE_PROGRAM " schema >/dev/full");
    CHECK(cut.code == 1);
    CHECK(cut.err == "failed: the results could not be written; is the disk full?\n");
}

TEST_CASE("a report is never written over what the pipeline reads, writes or is") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5, 6});
    const auto refused = [&](const std::string& name, const std::string& why) {
        require(bench.run("--report " + (bench.scratch / name)), 2,
                "--report would overwrite " + name + ": " + why + "\n");
    };
    refused("in.0003.vdb", "'sim' reads it");
    refused("out/o.0006.vdb", "'out' writes it");
    refused("p.yaml", "it is the pipeline");
    CHECK(Scratch::read(bench.scratch / "in.0003.vdb") == Scratch::read(small_vdb));
    CHECK(bench.files() == Files{});
}

TEST_CASE("a pipeline never writes over one that it extends") {
    const Bench bench;
    bench.scratch.write("shot.yaml", "fluidcarve: 1\nextends: p.yaml\n");
    const auto ran = bench.plain(
        fluidcarve_program("check " + (bench.scratch / "shot.yaml") +
                           " --set frames=1 --set out.path=" + (bench.scratch / "p.yaml")));
    CHECK(ran.code == 2);
    CHECK_THAT(ran.err, Catch::Contains("p.yaml: the pipeline extends it\n"));
}

TEST_CASE(
    "a volume that is replaced while a run without the cache is on ends it, and nothing is made of "
    "the new one") {
    const Bench bench;
    constexpr int first = 11, last = 50;
    for (int frame = first; frame <= last; ++frame)
        fs::copy_file(large_vdb, bench.scratch / "in.00" + std::to_string(frame) + ".vdb");
    fs::copy_file(small_vdb, bench.scratch / "new.vdb");
    const auto replace = "until [ -e " + (bench.scratch / "out/o.0011.vdb") +
                         " ] || ! kill -0 $!; do sleep 0.01; done; mv " +
                         (bench.scratch / "new.vdb") + " " + (bench.scratch / "in.0050.vdb");
    require(bench.run("--no-cache --set frames=11-50 & " + replace + "; wait $!"), 3,
            "failed: sim (vdb.read), frame 50: in.0050.vdb was changed while the run was on; run "
            "again when its writer is done\n");
    CHECK(bench.files().size() == last - first);
}

TEST_CASE("with a manifest, a byte that rotted in a volume is told, and nothing is made of it") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5, 6});
    const auto with = " --manifest " + (bench.scratch / "shot.manifest");
    require(bench.run("-f 1-4" + with), 0,
            "manifest shot.manifest: 0 files unchanged, 4 added\ndone: 4 frames in N s "
            "-> out/o.####.vdb\n");
    require(bench.run("--no-cache" + with), 0,
            "manifest shot.manifest: 4 files unchanged, 2 added\ndone: 6 frames in N s "
            "-> out/o.####.vdb\n");
    const auto manifest = Scratch::read(bench.scratch / "shot.manifest");
    fs::remove_all(bench.scratch / "out");
    const auto whole = Scratch::read(small_vdb);
    auto rotten = whole;
    rotten[rotten.size() - 50] = static_cast<char>(rotten[rotten.size() - 50] ^ 4);
    bench.scratch.write("in.0003.vdb", rotten);
    const std::string told =
        "failed: sim (vdb.read), frame 3: in.0003.vdb is not the file that the manifest "
        "shot.manifest knows: its hash differs; "
        "restore it, or delete its line from the manifest to accept it\n";
    require(bench.run(with), 3, told);
    CHECK(bench.files().empty());
    require(bench.run("--no-cache" + with), 3, told);
    CHECK(bench.files() == Files{"o.0001.vdb", "o.0002.vdb"});
    require(bench.run("--no-cache --keep-going" + with), 4, told);
    CHECK(bench.files() ==
          Files{"o.0001.vdb", "o.0002.vdb", "o.0004.vdb", "o.0005.vdb", "o.0006.vdb"});
    bench.scratch.write("in.0003.vdb", whole);
    require(bench.run(with), 0,
            "manifest shot.manifest: 6 files unchanged, 0 added\ndone: 6 frames in N s "
            "-> out/o.####.vdb\n");
    CHECK(Scratch::read(bench.scratch / "shot.manifest") == manifest);
}

TEST_CASE("a damaged manifest, and one in the place of an input, are refused") {
    const Bench bench;
    bench.put({1, 2, 3, 4, 5, 6});
    require(bench.run("--manifest " + bench.scratch.write("shot.manifest", "smoke\n")), 3,
            "failed: manifest: shot.manifest, line 1: it is not '# fluidcarve manifest 1: XXH128, "
            "bytes, path'; "
            "restore the manifest, or delete it to begin a new one\n");
    require(bench.run("--manifest " + (bench.scratch / "in.0002.vdb")), 2,
            "--manifest would overwrite in.0002.vdb: 'sim' reads it\n");
    CHECK(bench.files().empty());
}
