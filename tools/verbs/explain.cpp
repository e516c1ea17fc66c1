#include "tools/verbs/verbs.h"

#include "carve/base/one_line.h"
#include "runtime/tell/exit_codes.h"
#include "tools/provenance/read_provenance.h"
#include "tools/reading/read_in_child.h"
#include "tools/verbs/print.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <span>
#include <string>

namespace fluidcarve {
namespace {

/// An entry's name without what all of them begin with.
std::string short_name(const std::string& name) { return name.substr(name.find('_') + 1); }

/// The verb `explain`: reads in a child process what a file states of how it was made, and prints
/// it to stdout, errors to stderr.
/// @param memory  limit of the memory for reading the file, bytes
/// @return an exit code: `input` if the file can't be read, or states nothing
int explain_file(const std::string& path, bool json, std::uint64_t memory) {
    using Json = nlohmann::ordered_json;
    const auto read = [&](const std::string& file) {
        auto out = Json::object();
        for (const auto& [name, text] : read_provenance(file)) out[short_name(name)] = text;
        return out;
    };
    const auto [found, fault] = read_in_child(std::span(&path, 1), read, memory).front();
    if (json) {
        Json out{{"file", path}, {"provenance", found && !found->empty() ? *found : Json()}};
        if (!found) out["error"] = fault;
        print_json(out);
    } else if (!found) {
        complain(fmt::format("failed: {}\n", one_line(fault)));
    } else if (found->empty()) {
        complain(
            fmt::format("{} does not state what made it: no run of fluidcarve wrote it, or "
                        "one with 'provenance: false'\n",
                        one_line(path)));
    } else {
        // A file may state anything: none of it reaches a terminal but as a line of text.
        std::string out = one_line(path) + "\n";
        for (const auto& [name, text] : found->items())
            out += fmt::format("  {:<9} {}\n", name + ":", one_line(text.get<std::string>()));
        print(out);
    }
    return found && !found->empty() ? exit_code::done : exit_code::input;
}

}  // namespace

Verb::Work explain_verb(CLI::App& verb, Program&) {
    const auto file = std::make_shared<std::string>();
    const auto json = std::make_shared<bool>(false);
    verb.add_option("file", *file, "A file that a run wrote (.vdb, .png, .exr, .jpg, .ply, .obj)")
        ->required()
        ->type_name("FILE");
    verb.add_flag("--json", *json, "Print as JSON");
    return [=] { return explain_file(*file, *json, half_of_memory()); };
}

}  // namespace fluidcarve
