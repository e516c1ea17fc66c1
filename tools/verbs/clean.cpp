#include "tools/verbs/verbs.h"

#include "carve/base/failure.h"
#include "carve/base/numbers.h"
#include "carve/base/words.h"
#include "runtime/flow/options.h"
#include "runtime/keep/work_folder.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/arguments.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace fluidcarve {

namespace {

/// An age such as 7d, 12h, 30m or 2w; nothing if a text is none.
std::optional<std::chrono::seconds> age_of(std::string_view text) {
    static const std::map<char, std::chrono::seconds> units{{'m', std::chrono::minutes(1)},
                                                            {'h', std::chrono::hours(1)},
                                                            {'d', std::chrono::hours(24)},
                                                            {'w', std::chrono::hours(24 * 7)}};
    const auto unit = text.empty() ? units.end() : units.find(text.back());
    if (unit == units.end()) return std::nullopt;
    text.remove_suffix(1);
    const auto number = number_of<int>(text);
    if (!number || *number < 0 || *number > 100000) return std::nullopt;
    return *number * unit->second;
}

/// Arguments of the verb `clean`.
struct CleanArguments {
    std::string folder = RunOptions().work_folder;
    std::string older, shot;  ///< empty: not stated
    bool dry_run = false;
};

/// Removes files of fluidcarve from a work folder, and the folder if it is then empty.
int clean(const CleanArguments& arguments) {
    const auto& [path, older, shot, dry_run] = arguments;
    const WorkFolder folder(path);
    WorkFolder::Cleaning cleaning{older.empty() ? std::nullopt : age_of(older), dry_run,
                                  shot.empty() ? std::nullopt : std::optional(shot)};
    if (!older.empty() && !cleaning.older)
        return end_with(fmt::format("--older: '{}' is no age such as 7d, 12h, 30m or 2w", older));
    if (const auto fault = folder.read_fault(); !fault.empty())
        return end_with("failed: " + fault, exit_code::input);
    if (const auto fault = folder.fault(); !fault.empty())
        return end_with(fmt::format("cannot clean: {}", fault));
    try {
        const auto cleaned = folder.clean(cleaning);
        const auto stay = [](std::size_t count, const char* why) {
            return count == 0 ? std::string()
                              : fmt::format("; {} {} {}", count,
                                            count == 1 ? "file stays" : "files stay", why);
        };
        const auto rest = stay(cleaned.kept, "that were used since") +
                          stay(cleaned.apart, "of other shots, or of several") +
                          stay(cleaned.left, "that fluidcarve did not write");
        const auto what =
            fmt::format("{}, {}", counted(cleaned.removed, "file"), size_text(cleaned.bytes));
        print(fmt::format("{}: {}{}\n", path,
                          cleaned.removed == 0 ? "nothing to clean"
                          : dry_run            ? "would remove " + what
                                               : "removed " + what,
                          rest));
    } catch (const Failure& failure) {
        return end_with(failure.what(), exit_code::node_failed);
    }
    return exit_code::done;
}

}  // namespace

Verb::Work clean_verb(CLI::App& verb, Program&) {
    const auto arguments = std::make_shared<CleanArguments>();
    declare_work_folder(verb, arguments->folder);
    verb.add_option("--shot", arguments->shot,
                    "Remove only what runs of this pipeline made: the name of its file, as in "
                    "sh010 for sh010.yaml. Results of up to 64 KB, which lie many to a file, stay")
        ->type_name("NAME");
    verb.add_option("--older", arguments->older,
                    "Remove only what was not used for so long: 7d, 12h, 30m, 2w")
        ->type_name("AGE");
    verb.add_flag("--dry-run", arguments->dry_run, "Only say what would be removed");
    return [=] { return clean(*arguments); };
}

}  // namespace fluidcarve
