#include "tests/bench/cache.h"

#include "nodes/catalogue.h"
#include "runtime/keep/file_hashes.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/measure.h"
#include "tests/support/scratch.h"

#include <filesystem>
#include <vector>

using namespace fluidcarve;

namespace {

void bench_runs(const std::string& name) {
    const Scratch scratch;
    const auto registry = builtin_registry();
    const auto pipeline = pipeline_of(
        document_in(SOURCE_ROOT "/pipelines/" + name + ".yaml",
                    {"out=" + (scratch / "out.####.vdb"), "seams=" + (scratch / "seams.vdb"),
                     "sheet=" + (scratch / "sheet.png")}),
        registry);
    auto request = quiet_request();
    request.options.work_folder = scratch / "work";
    const auto run = [&](bool cache, bool fresh) {
        request.options.cache = cache;
        if (fresh) std::filesystem::remove_all(request.options.work_folder);
        run_to_end(pipeline, registry, request);
    };
    // By turns, so that whatever else the machine does meets both.
    std::vector<double> with, without;
    for (int n = 0; n < 7; ++n) {
        without.push_back(seconds(1, [&] { run(false, false); }));
        with.push_back(seconds(1, [&] {
            std::filesystem::remove_all(scratch / "out");
            run(true, true);
        }));
    }
    const double again = seconds(3, [&] { run(true, false); });
    std::ranges::sort(with);
    std::ranges::sort(without);
    line(name + ".yaml: first run with cache / without", with[3] / without[3],
         fmt::format("{:.2f} s, {:.2f} s", with[3], without[3]), Better::lower);
    line(name + ".yaml: first run / second run", with[3] / again, fmt::format("{:.3f} s", again));
}

void bench_hashing() {
    const Scratch scratch;
    constexpr std::size_t bytes = std::size_t{1} << 28;
    const auto file = scratch.write("data", std::string(bytes, 'x'));
    FileHashes files("");
    const double hash = seconds(5, [&] { files.content_now(file); });
    const double read = seconds(5, [&] { Scratch::read(file); });
    line("read a file / read and hash it", read / hash,
         fmt::format("{:.2f} GB/s", bytes / hash * 1e-9));
}

}  // namespace

void bench_cache() {
    for (const auto* const name : {"plume", "vortex", "bonfire"}) bench_runs(name);
    bench_hashing();
}
