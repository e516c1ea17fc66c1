#include "tools/verbs/verbs.h"

#include "carve/base/words.h"
#include "graph/types/load_plugin.h"
#include "graph/views/describe.h"
#include "graph/views/schema.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/verb.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace fluidcarve {

namespace {

/// Loads plugins. Prints a message and returns false if one can't be loaded.
bool load_or_complain(const std::vector<std::string>& plugins, Registry& registry) {
    PluginFiles files;
    try {
        for (const auto& file : plugins) load_plugin(file, registry, files);
    } catch (const Failure& failure) {
        return complain(std::string(failure.what()) + "\n"), false;
    }
    return true;
}

/// The message about a name that is neither a node type nor a family, with those near to it.
std::string no_node_type(const std::string& name, const Registry& registry) {
    const auto names = registry.node_names();
    if (name.find('.') != std::string::npos)
        return fmt::format("there is no node type '{}'{}\n", name, did_you_mean(name, names));
    std::vector<std::string> quoted;
    for (const auto& each : names)
        if (each.ends_with("." + name)) quoted.push_back("'" + each + "'");
    return fmt::format("there is no node type or family '{}'{}\n", name,
                       quoted.empty() ? did_you_mean(name, registry.families())
                                      : fmt::format("; did you mean {}?", either(quoted)));
}

/// Arguments of the verb `nodes`.
struct NodesArguments {
    std::string type;  ///< or a family; empty: all
    bool json = false, markdown = false;
};

int nodes(const NodesArguments& arguments, const Registry& registry) {
    const auto& [type, json, markdown] = arguments;
    const auto families = registry.families();
    if (std::ranges::find(families, type) != families.end()) {
        if (json) print_json(family_to_json(registry, type));
        else print(markdown ? family_to_markdown(registry, type) : listing(registry, type));
    } else if (!type.empty()) {
        const auto* const found = registry.node(type);
        if (!found) return complain(no_node_type(type, registry)), exit_code::usage;
        if (json) print_json(to_json(registry, *found));
        else print(markdown ? to_markdown(registry, *found) : describe(registry, *found));
    } else {
        if (json) print_json(to_json(registry));
        else print(markdown ? to_markdown(registry) : listing(registry));
    }
    return exit_code::done;
}

/// Declares which plugins are to be loaded.
std::shared_ptr<std::vector<std::string>> declare_plugins(CLI::App& verb) {
    const auto out = std::make_shared<std::vector<std::string>>();
    verb.add_option("--plugin", *out,
                    "Include the types of this plugin; its code is loaded; may be repeated")
        ->type_name("FILE")
        ->expected(1)
        ->take_all();
    return out;
}

}  // namespace

Verb::Work nodes_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<NodesArguments>();
    verb.add_option("type", arguments->type, "The node type to describe, or the family to list")
        ->type_name("TYPE");
    auto* const json = verb.add_flag("--json", arguments->json, "Print as JSON");
    verb.add_flag("--markdown", arguments->markdown, "Print as Markdown")->excludes(json);
    const auto plugins = declare_plugins(verb);
    return [=, &program] {
        if (!load_or_complain(*plugins, program.registry)) return exit_code::usage;
        return nodes(*arguments, program.registry);
    };
}

Verb::Work schema_verb(CLI::App& verb, Program& program) {
    const auto plugins = declare_plugins(verb);
    return [=, &program] {
        if (!load_or_complain(*plugins, program.registry)) return exit_code::usage;
        return print(schema(program.registry)), exit_code::done;
    };
}

}  // namespace fluidcarve
