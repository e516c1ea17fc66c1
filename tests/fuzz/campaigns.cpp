#include "tests/fuzz/campaigns.h"

#include "tests/fuzz/pipelines.h"
#include "tests/fuzz/vdb_faults.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace fuzz {
namespace {

using Words = std::vector<std::string>;

std::string ascii_or_binary(const std::string& file, Random& random) {
    const bool text = std::ranges::none_of(file, [](char c) { return c < 0 || c == '\0'; });
    return random() % (text ? 3 : 8) ? (text ? retold : damaged)(file, random)
                                     : (text ? damaged : retold)(file, random);
}

std::string aimed(const Source& source, Random& random) {
    return faulty_vdb(source.bytes, source.places, random);
}

/// Runs a source's pipeline with a mutant of it.
/// @param mutate  makes the mutant
Campaign through(std::string name, double share, std::vector<Source> from,
                 std::string (*mutate)(const Source&, Random&)) {
    return {
        std::move(name), share,
        [from = std::move(from), mutate](std::size_t n, Random& random, const Scratch& scratch) {
            const auto& source = from[n % from.size()];
            scratch.write("in" + source.ending, mutate(source, random));
            scratch.write("p.yaml", source.pipeline);
            return Words{"run", "p.yaml"};
        }};
}

std::vector<Source> vdb_files(const std::vector<Source>& sources) {
    std::vector<Source> out;
    std::ranges::copy_if(sources, std::back_inserter(out),
                         [](const auto& each) { return each.ending == ".vdb"; });
    return out;
}

std::string not_refused(const Ended& ended, const Scratch& scratch) {
    if (std::filesystem::exists(scratch / "out.vdb"))
        return "writes an output from a file that is cut off";
    return ended.code == 3 ? "" : "is not refused";
}

}  // namespace

std::vector<Campaign> campaigns(const Sources& sources) {
    const auto random_faults = [](const Source& source, Random& random) {
        return damaged(source.bytes, random);
    };
    const auto text_faults = [](const Source& source, Random& random) {
        return ascii_or_binary(source.bytes, random);
    };
    const auto seam_texts = [](const Source& source, Random& random) {
        return faulty_seams(source.bytes, source.places, random);
    };
    auto headers = sources.volumes;
    headers.insert(headers.end(), sources.points.begin(), sources.points.begin() + 1);
    return {
        {"check", 1,
         [&](std::size_t n, Random& random, const Scratch& scratch) {
             scratch.write("p.yaml",
                           mistyped(sources.pipelines[n % sources.pipelines.size()].bytes, random));
             return Words{"check", "p.yaml"};
         }},
        {"inspect", 1,
         [&, headers](std::size_t n, Random& random, const Scratch& scratch) {
             const auto& source = headers[n % headers.size()];
             scratch.write("in.vdb",
                           random() % 2 ? damaged(source.bytes, random) : aimed(source, random));
             return Words{"inspect", "in.vdb"};
         }},
        {"mesh", 1,
         [&](std::size_t n, Random& random, const Scratch& scratch) {
             const auto& source = sources.meshes[n % sources.meshes.size()];
             scratch.write("in" + source.ending, ascii_or_binary(source.bytes, random));
             scratch.write("p.yaml",
                           mesh_pipeline(source.ending, any_of(sources.meshes, random).ending));
             return Words{"run", "p.yaml"};
         }},
        {"cut", 0.1,
         [&](std::size_t n, Random& random, const Scratch& scratch) {
             const auto& whole = sources.volumes[n % sources.volumes.size()].bytes;
             scratch.write("in.vdb", whole.substr(0, below(random, whole.size())));
             scratch.write("p.yaml", copy_pipeline());
             return Words{"run", "p.yaml"};
         },
         not_refused},
        through("volume", 1, sources.volumes, random_faults),
        through("volume-aimed", 1, sources.volumes, aimed),
        through("points", 0.5, sources.points, text_faults),
        through("points-aimed", 0.5, vdb_files(sources.points), aimed),
        through("seams", 0.25, sources.seams, random_faults),
        through("seams-aimed", 0.25, sources.seams, aimed),
        through("seams-text", 0.25, sources.seams, seam_texts),
        through("image", 0.5, sources.images, random_faults),
        through("curve", 0.5, sources.curves, text_faults)};
}

}  // namespace fuzz
