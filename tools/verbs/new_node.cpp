#include "tools/verbs/verbs.h"

#include "graph/types/registry.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/arguments.h"
#include "tools/verbs/new_node_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {
namespace {

/// Arguments of the verb `new-node`.
struct NewNode {
    std::string name;     ///< name of the node type: `acme.sparkle`
    bool solver = false;  ///< true: a solver; false: an energy
    /// True: an energy by a script of Python, for energy.python; false: a plugin.
    bool python = false;
    std::string folder;  ///< empty: `FAMILY_NAME` in the current folder
};

/// Whether a name has the form FAMILY.NAME: both parts begin with a letter, and hold small letters,
/// digits and single underscores.
bool well_formed(const std::string& name) {
    const auto dot = name.find('.');
    if (dot == std::string::npos) return false;
    const auto is_word = [](std::string_view word) {
        const auto small = [](char c) { return c >= 'a' && c <= 'z'; };
        const auto fits = [&](char c) { return small(c) || (c >= '0' && c <= '9') || c == '_'; };
        return !word.empty() && small(word.front()) && word.back() != '_' &&
               std::ranges::all_of(word, fits) && word.find("__") == std::string_view::npos;
    };
    return is_word(std::string_view(name).substr(0, dot)) &&
           is_word(std::string_view(name).substr(dot + 1));
}

namespace fs = std::filesystem;

/// What is wrong with the name of a new node type; empty: nothing.
std::string fault_of(const std::string& name, const Registry& registry) {
    if (!well_formed(name))
        return fmt::format(
            "'{}' can't name a new node type: a name is FAMILY.NAME, such as acme.sparkle, in "
            "lower-case letters, digits and single _",
            name);
    const auto dot = name.find('.');
    const auto family = name.substr(0, dot);
    for (const auto& known : registry.node_names())
        if (known.starts_with(family + "."))
            return fmt::format(
                "'{}' can't name a new node type: the family '{}' is a built-in one, of '{}'; use "
                "one of your own, such as acme.{}",
                name, family, known, name.substr(dot + 1));
    if (name.substr(dot + 1) == "plugin")
        return fmt::format(
            "'{}' can't name a new node type: its source would be plugin.cpp, which every plugin "
            "has for another purpose; choose another name",
            name);
    return {};
}

/// A name as a C++ type name: "two_words" to "TwoWords".
std::string as_type(const std::string& name) {
    std::string out;
    bool start = true;
    for (const char letter : name) {
        if (letter != '_')
            out += start ? static_cast<char>(std::toupper(static_cast<unsigned char>(letter)))
                         : letter;
        start = letter == '_';
    }
    return out;
}

std::string filled(std::string_view text,
                   const std::vector<std::pair<std::string, std::string>>& names) {
    std::string out(text);
    for (const auto& [name, value] : names)
        for (std::size_t at = 0; (at = out.find(name, at)) != std::string::npos; at += value.size())
            out.replace(at, name.size(), value);
    return out;
}

/// Makes a folder, unless an empty one exists.
/// @return an exit code; what is wrong is printed
int make_folder(const fs::path& folder) {
    std::error_code error;
    if (fs::exists(folder, error) &&
        !(fs::is_directory(folder, error) && fs::is_empty(folder, error)))
        return end_with(
            fmt::format(
                "{} already exists and is not overwritten; choose another --folder, or remove it",
                folder.string()),
            exit_code::usage);
    fs::create_directories(folder, error);
    return error ? end_with(fmt::format("cannot make the folder {}: {}", folder.string(),
                                        error.message()),
                            exit_code::node_failed)
                 : exit_code::done;
}

std::string kind_of(const NewNode& wanted) { return wanted.solver ? "solver" : "energy"; }

/// The files of a new node type, and the template of each.
std::vector<std::pair<std::string, std::string>> files_of(const NewNode& wanted,
                                                          const std::string& name) {
    if (wanted.python)
        return {{name + ".py", "python.py"},
                {name + "_test.py", "python_test.py"},
                {"example.yaml", "python.yaml"},
                {"README.md", "python.md"}};
    const auto kind = kind_of(wanted);
    return {{name + ".h", kind + ".h"},
            {name + ".cpp", kind + ".cpp"},
            {name + "_test.cpp", kind + "_test.cpp"},
            {"plugin.cpp", "plugin.cpp"},
            {"CMakeLists.txt", "CMakeLists.txt"},
            {"example.yaml", kind + ".yaml"},
            {"README.md", "README.md"}};
}

/// Writes a plugin with one node type, ready to build: source, test, build files, and a pipeline
/// that uses it; or a script, its test and its pipeline. Never overwrites files.
/// @return an exit code
int write_new_node(const NewNode& wanted, const Registry& registry) {
    if (const auto fault = fault_of(wanted.name, registry); !fault.empty()) return end_with(fault);
    const auto dot = wanted.name.find('.');
    const auto family = wanted.name.substr(0, dot), name = wanted.name.substr(dot + 1),
               library = family + "_" + name;
    const fs::path folder = wanted.folder.empty() ? library : wanted.folder;
    if (const int code = make_folder(folder); code != exit_code::done) return code;
    const std::vector<std::pair<std::string, std::string>> names{{"{{family}}", family},
                                                                 {"{{name}}", name},
                                                                 {"{{Name}}", as_type(name)},
                                                                 {"{{type}}", wanted.name},
                                                                 {"{{folder}}", library}};
    for (const auto& [file, text] : files_of(wanted, name)) {
        std::ofstream out(folder / file, std::ios::binary);
        out << filled(new_node_texts().at(text), names);
        out.close();
        if (!out)
            return end_with(fmt::format("cannot write {}", (folder / file).string()),
                            exit_code::node_failed);
    }
    const auto told =
        wanted.python
            ? fmt::format(
                  "{}: an energy in Python with its test and a pipeline; its README.md "
                  "says how to run it\n",
                  folder.string())
            : fmt::format(
                  "{}: a complete plugin with the {} {}, ready to build; its README.md says how\n",
                  folder.string(), kind_of(wanted), wanted.name);
    print(told);
    return exit_code::done;
}

}  // namespace

Verb::Work new_node_verb(CLI::App& verb, Program& program) {
    const auto wanted = std::make_shared<NewNode>();
    verb.add_option("name", wanted->name,
                    "Name of the node type: FAMILY.NAME, such as acme.sparkle; choose a family of "
                    "your own")
        ->required()
        ->type_name("NAME");
    auto* const solver =
        verb.add_flag("--solver", wanted->solver, "Write a solver instead of an energy");
    verb.add_flag("--python", wanted->python,
                  "Write an energy as a script of Python, with its test and a pipeline, instead of "
                  "a plugin")
        ->excludes(solver);
    verb.add_option("--folder", wanted->folder, "The folder to write (default: ./FAMILY_NAME)")
        ->type_name("DIR");
    return [=, &program] { return write_new_node(*wanted, program.registry); };
}

}  // namespace fluidcarve
