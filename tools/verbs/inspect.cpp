#include "tools/verbs/verbs.h"

#include "carve/base/frame_set.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "runtime/tell/exit_codes.h"
#include "tools/inspect/inspectors.h"
#include "tools/inspect/summary.h"
#include "tools/reading/read_in_child.h"
#include "tools/reading/sequences.h"
#include "tools/verbs/print.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// The verb at work: prints what it looks at, and keeps it for JSON.
class Inspection {
public:
    Inspection(bool json, std::uint64_t memory) : json_(json), memory_(memory) {}

    void look_at(const FileSequence& sequence) {
        const auto& inspector = *inspector_of(sequence.path.text());
        std::vector<LookedAt> seen;
        std::vector<std::string> paths;
        for (const int frame : sequence.frames.frames()) paths.push_back(sequence.path.at(frame));
        constexpr std::size_t at_once = 32;
        for (std::size_t begin = 0; begin < paths.size(); begin += at_once) {
            const auto some =
                std::span(paths).subspan(begin, std::min(at_once, paths.size() - begin));
            auto outcomes = read_in_child(some, inspector.look, memory_);
            for (std::size_t n = 0; n < some.size(); ++n) {
                const int frame = sequence.frames.frames()[begin + n];
                auto& [facts, fault] = outcomes[n];
                if (!facts) {
                    fail(fault, {{"file", some[n]}, {"error", fault}});
                    continue;
                }
                if (sequence.per_frame()) (*facts)["frame"] = frame;
                all_["files"].push_back(*facts);
                seen.push_back({frame, std::move(*facts)});
            }
        }
        if (seen.empty()) return;
        if (!sequence.per_frame()) {
            if (!json_) print(inspector.text(seen.front().facts));
            alone_[&inspector].push_back(std::move(seen.front().facts));
            return;
        }
        summarise(sequence, seen, inspector);
    }

    /// Compares the files that are alone, and prints what is left. @return an exit code
    int finish() {
        for (const auto& inspector : inspectors()) note(inspector, alone_[&inspector]);
        if (json_) print_json(all_);
        return code_;
    }

    /// @param entry  of the file, for JSON; null: none
    void fail(const std::string& fault, Json entry = {}) {
        std::fflush(stdout);
        if (!json_) complain(fmt::format("failed: {}\n", one_line(fault)));
        if (!entry.is_null()) all_["files"].push_back(std::move(entry));
        else all_["notes"].push_back(fault);
        code_ = exit_code::input;
    }

    void tell_of(const std::string& folder, std::size_t others) {
        all_["folders"].push_back({{"folder", folder}, {"other_files", others}});
        if (!json_ && others > 0)
            print(fmt::format("{}: {} not looked at\n", folder,
                              others == 1 ? "1 file of another kind is"
                                          : fmt::format("{} files of other kinds are", others)));
    }

private:
    void summarise(const FileSequence& sequence, const std::vector<LookedAt>& seen,
                   const FileInspector& inspector) {
        std::vector<int> frames;
        for (const auto& each : seen) frames.push_back(each.frame);
        const FileSequence there{sequence.path, FrameSet(std::move(frames))};
        Json entry{
            {"path", there.path.text()}, {"frames", there.frames.text()}, {"count", seen.size()}};
        auto summary = summary_of(seen, inspector);
        if (!json_) {
            auto titled = summary;
            titled["file"] = fmt::format("{}, {}", there.text(), counted(seen.size(), "file"));
            print(inspector.text(titled));
            for (const auto& change : summary["changes"])
                print(fmt::format("  changes: {}\n", change.get<std::string>()));
        }
        entry.update(summary);
        all_["sequences"].push_back(std::move(entry));
        std::vector<Json> facts;
        for (const auto& each : seen) facts.push_back(each.facts);
        note(inspector, facts);
    }

    void note(const FileInspector& inspector, const std::vector<Json>& files) {
        for (const auto& note : inspector.compare(files)) {
            if (!json_) print(fmt::format("note: {}\n", note));
            all_["notes"].push_back(note);
        }
    }

    bool json_;
    std::uint64_t memory_;
    int code_ = exit_code::done;
    std::map<const FileInspector*, std::vector<Json>> alone_;
    Json all_{{"files", Json::array()},
              {"notes", Json::array()},
              {"sequences", Json::array()},
              {"folders", Json::array()}};
};

bool can_inspect(const std::string& path) { return inspector_of(path) != nullptr; }

/// ".vdb, .png" of all files that can be inspected.
std::string all_endings() {
    std::vector<std::string> out;
    for (const auto& inspector : inspectors())
        out.insert(out.end(), inspector.endings.begin(), inspector.endings.end());
    return fmt::format("{}", fmt::join(out, ", "));
}

/// Takes the paths of the command line in their order: files side by side may make
/// sequences.
class PathsInOrder {
public:
    explicit PathsInOrder(Inspection& inspection) : inspection_(inspection) {}

    /// @throws Failure
    void take(const std::string& path) {
        std::error_code ignored;
        const bool folder = std::filesystem::is_directory(path, ignored);
        const auto sequence = folder ? FileSequence{} : named_sequence(path);
        if (!folder && !sequence.per_frame()) return files_.push_back(path);
        look_at_files();
        if (folder) look_into(path);
        else if (sequence.frames.frames().empty())
            inspection_.fail(fmt::format("{}: there is no file of any frame", path));
        else inspection_.look_at(sequence);
    }
    /// Looks at the files taken last.
    void look_at_files() {
        for (const auto& sequence : sequences_of(files_)) inspection_.look_at(sequence);
        files_.clear();
    }

private:
    void look_into(const std::string& folder) {
        std::size_t others = 0;
        const auto sequences = sequences_in(folder, can_inspect, others);
        if (sequences.empty())
            return inspection_.fail(
                fmt::format("{} holds no file that ends in {}", folder, all_endings()));
        for (const auto& sequence : sequences) inspection_.look_at(sequence);
        inspection_.tell_of(folder, others);
    }

    Inspection& inspection_;
    std::vector<std::string> files_;
};

/// The verb `inspect`: reads files in child processes, prints their content to stdout, a sequence
/// as one, and errors to stderr.
/// @param paths   files, paths with frame tokens, and folders, of which the files right in them are
///   looked at
/// @param memory  limit of the memory for reading files, bytes
/// @return an exit code
int inspect_files(const std::vector<std::string>& paths, bool json, std::uint64_t memory) {
    std::error_code ignored;
    for (const auto& path : paths)
        if (!std::filesystem::is_directory(path, ignored) && !can_inspect(path)) {
            complain(
                fmt::format("inspect reads files that end in {}, and folders of them, not {}\n",
                            all_endings(), path));
            return exit_code::usage;
        }
    Inspection inspection(json, memory);
    PathsInOrder in_order(inspection);
    for (const auto& path : paths) {
        try {
            in_order.take(path);
        } catch (const Failure& failure) {
            if (failure.kind != Failure::Kind::input) return end_with(failure.what());
            inspection.fail(failure.what());
        }
    }
    in_order.look_at_files();
    return inspection.finish();
}

}  // namespace

Verb::Work inspect_verb(CLI::App& verb, Program&) {
    const auto files = std::make_shared<std::vector<std::string>>();
    const auto json = std::make_shared<bool>(false);
    verb.add_option("files", *files, "Data files, sequences such as smoke.####.vdb, and folders")
        ->required()
        ->type_name("FILE");
    verb.add_flag("--json", *json, "Print as JSON");
    return [=] { return inspect_files(*files, *json, half_of_memory()); };
}

}  // namespace fluidcarve
