#include "tests/bench/sparse.h"

#include "tests/bench/bytes_in.h"
#include "tests/bench/copying.h"
#include "tests/bench/large/make.h"
#include "tests/support/program.h"
#include "tests/support/scratch.h"

#include <nlohmann/json.hpp>

#include <stdexcept>

using namespace fluidcarve;

namespace {

/// A sequence in a folder of its own, and what it takes to carve it.
class Sequence {
public:
    Sequence(const openvdb::Coord& size, int frames, double active) : frames_(frames) {
        MakeRequest request;
        request.files = SOURCE_ROOT "/tests/data/plume/plume.####.vdb";
        request.size = size;
        request.frames = frames;
        request.active = active;
        request.out = files();
        made_ = make_sequence(request, [](int) {});
    }

    double active() const { return static_cast<double>(made_.active); }
    double bytes() const { return static_cast<double>(made_.bytes); }
    double copy_seconds() const {
        return seconds_to_copy(PathPattern(files()), frames_, scratch_ / "copy.vdb");
    }

    struct Run {
        double seconds, memory, work_folder;  ///< the latter two in bytes
    };
    /// @param pipeline  one of those that ship
    Run run(const std::string& pipeline, int count) const {
        const auto work = scratch_ / ("work of " + pipeline);
        const auto carve = [&] {
            const auto ran = fluidcarve_program(fmt::format(
                "run {}/pipelines/{}.yaml -q --progress none --threads 2 --memory 10G --work '{}' "
                "--report {}/report.json "
                "--to out --set frames=1-{} --set count={} --set sim={} --set out={}/out.####.vdb",
                SOURCE_ROOT, pipeline, work, scratch_.path(), frames_, count, files(),
                scratch_.path()));
            if (ran.code != 0) throw std::runtime_error(ran.err);
        };
        const auto took = seconds(1, carve);
        const auto report = nlohmann::json::parse(Scratch::read(scratch_ / "report.json"));
        return {took, report["peak_rss_bytes"].get<double>(), bytes_in(work)};
    }

private:
    std::string files() const { return scratch_ / "in.####.vdb"; }

    Scratch scratch_;
    int frames_;
    Made made_;
};

}  // namespace

void bench_sparse(bool large) {
    const int frames = large ? 24 : 4;
    const Sequence full({250, 250, 250}, frames, 0.32);
    const auto ours = full.run("plume", -12);
    line(
        fmt::format("250x250x250, a third active, {} frames: plume.yaml / reading and writing them",
                    frames),
        ours.seconds / full.copy_seconds(), fmt::format("{:.1f} s", ours.seconds), Better::lower);

    constexpr int few = 4;
    const openvdb::Coord box =
        large ? openvdb::Coord(1000, 600, 600) : openvdb::Coord(500, 300, 300);
    constexpr double share = 0.05;
    const Sequence sparse(box, few, share), as_sparse({250, 250, 250}, frames, share);
    const auto in_full = full.run("plume_large", -10), in_sparse = sparse.run("plume_large", -10),
               in_small = as_sparse.run("plume_large", -10);
    const auto name = fmt::format("{}x{}x{}, 5 % active, {} frames, plume_large.yaml", box.x(),
                                  box.y(), box.z(), few);
    const double cost = in_sparse.seconds / (few * sparse.active());
    line(name + ": an active voxel / one at 250x250x250",
         cost / (in_full.seconds / (frames * full.active())), fmt::format("{:.2f} us", 1e6 * cost),
         Better::lower);
    // Blocks of a sequence that is as sparse are as full, and so only the size differs.
    line(name + ": an active voxel / one of 5 % at 250x250x250",
         cost / (in_small.seconds / (frames * as_sparse.active())), "", Better::lower);
    line(name + ": work folder / input", in_sparse.work_folder / sparse.bytes(),
         fmt::format("memory {:.1f} GB", 1e-9 * in_sparse.memory), Better::lower);
}
