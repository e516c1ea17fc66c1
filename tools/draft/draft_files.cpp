#include "tools/draft/draft_files.h"

#include "carve/base/failure.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "tools/inspect/inspectors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <utility>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

std::uintmax_t size_of(const FileSequence& sequence) {
    std::error_code ignored;
    return fs::file_size(sequence.path.at(sequence.frames.frames().front()), ignored);
}

/// The sequences in a folder, of files that the first inspector that fits any of them looks at.
/// Those of most frames stand first, of these those of large files.
std::vector<FileSequence> sequences_to_draft(const std::string& folder) {
    std::size_t others = 0;
    const auto all = sequences_in(
        folder, [&](const std::string& path) { return inspector_of(path) != nullptr; }, others);
    for (const auto& inspector : inspectors()) {
        std::vector<FileSequence> found;
        for (const auto& each : all)
            if (inspector_of(each.path.text()) == &inspector) found.push_back(each);
        std::ranges::stable_sort(found, std::greater(), [](const FileSequence& each) {
            return std::pair(each.frames.frames().size(), size_of(each));
        });
        if (!found.empty()) return found;
    }
    throw Failure(fmt::format("{} holds no volumes, images, particles or meshes", folder),
                  Failure::Kind::input);
}

/// What a file of a known other format is, and what makes one to carve of it: " is a NanoVDB file:
/// ...". Empty: of no known one.
std::string foreign_format(const std::string& path) {
    constexpr auto usd =
        "a USD stage: carve the .vdb files that it refers to, or export its meshes as .obj";
    constexpr auto houdini =
        "a Houdini geometry: write volumes as .vdb, particles as .ply, meshes as .obj";
    constexpr auto film =
        "a film: write its frames as images, with `ffmpeg -i FILM frame.%04d.png`";
    static const std::map<std::string, const char*> known{
        {".nvdb", "a NanoVDB file: convert it with nanovdb_convert, or write it as OpenVDB"},
        {".abc",
         "an Alembic file: export its meshes as .obj or .ply, its particles as .ply, a file per "
         "frame"},
        {".bgeo", houdini},
        {".sc", houdini},
        {".usd", usd},
        {".usda", usd},
        {".usdc", usd},
        {".f3d", "a Field3D file: convert it with Houdini or Maya to .vdb"},
        {".uni", "a cache of Mantaflow: bake it as OpenVDB"},
        {".mp4", film},
        {".mov", film},
    };
    const auto found = known.find(ending_of(path));
    return found == known.end() ? "" : fmt::format(" is {}", found->second);
}

FileSequence sequence_of(const std::string& argument) {
    std::error_code ignored;
    auto out = named_sequence(argument);
    if (out.frames.frames().empty())
        throw Failure(fmt::format("{}: there is no file of any frame", argument),
                      Failure::Kind::input);
    if (!out.per_frame() && !fs::exists(argument, ignored))
        throw Failure(fmt::format("{}: there is no such file", argument), Failure::Kind::input);
    if (inspector_of(argument)) return out;
    if (const auto other = foreign_format(argument); !other.empty())
        throw Failure(argument + other);
    std::vector<std::string> endings;
    for (const auto& inspector : inspectors())
        for (const auto& ending : inspector.endings)
            if (std::ranges::find(inspector.not_carved, ending) == inspector.not_carved.end())
                endings.push_back(ending);
    throw Failure(fmt::format("{}: files to carve end in {}", argument,
                              fmt::join(std::set(endings.begin(), endings.end()), ", ")));
}

/// Looks at some of a sequence's files. @throws Failure
DraftFiles look_at(const FileSequence& sequence) {
    DraftFiles out{sequence, {}, {}};
    const auto& inspector = *inspector_of(out.sequence.path.text());
    constexpr std::size_t most = 5;
    const auto& frames = out.sequence.frames.frames();
    const auto count = std::min(most, frames.size());
    for (std::size_t n = 0; n < count; ++n) {
        const auto path =
            out.sequence.path.at(frames[count == 1 ? 0 : n * (frames.size() - 1) / (count - 1)]);
        try {
            out.facts.push_back(inspector.look(path));
        } catch (const std::exception& error) {
            const std::string fault = error.what();
            throw Failure(
                one_line(fault.find(path) == std::string::npos ? path + ": " + fault : fault),
                Failure::Kind::input);
        }
    }
    out.notes = inspector.compare(out.facts);
    return out;
}

}  // namespace

std::string DraftFiles::stem() const {
    const auto ends = sequence.path.name_ends();
    auto out = sequence.per_frame() ? ends->begin : fs::path(sequence.path.text()).stem().string();
    while (!out.empty() && std::string_view("._-").find(out.back()) != std::string_view::npos)
        out.pop_back();
    return out.empty() ? "carved" : out;
}

DraftRequest DraftFiles::request(const std::string& folder) const {
    DraftRequest out;
    out.input = sequence.path.text();
    if (!folder.empty() && fs::path(out.input).is_relative()) {
        std::error_code fault;
        const auto path =
            fs::proximate(fs::absolute(out.input), fs::absolute(folder), fault).string();
        if (!fault) out.input = path;
    }
    if (sequence.per_frame()) out.frames = sequence.frames.text();
    out.facts = facts;
    return out;
}

DraftFiles look_at_draft_files(const std::string& argument, Several several) {
    std::error_code ignored;
    if (!fs::is_directory(argument, ignored)) return look_at(sequence_of(argument));
    const auto found = sequences_to_draft(argument);
    if (found.size() == 1) return look_at(found.front());
    std::vector<std::string> texts;
    for (const auto& each : found) texts.push_back(each.path.text());
    if (several == Several::refused)
        throw Failure(fmt::format("{} holds {} sequences; name one of them: {}", argument,
                                  texts.size(), fmt::join(texts, ", ")));
    auto out = look_at(found.front());
    for (std::size_t n = 1; n < found.size() && !out.notes.empty(); ++n)
        if (auto other = look_at(found[n]); other.notes.empty()) out = std::move(other);
    std::erase(texts, out.sequence.path.text());
    out.notes.push_back(fmt::format("{} holds {} sequences; this is for {}, not for {}", argument,
                                    found.size(), out.sequence.path.text(),
                                    fmt::join(texts, ", ")));
    return out;
}

}  // namespace fluidcarve
