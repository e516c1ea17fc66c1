#include "graph/types/load_plugin.h"
#include "graph/pipeline.h"
#include "graph/types/plugin.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <string>

using namespace fluidcarve;
namespace fs = std::filesystem;

namespace {

/// Built from tests/graph/plugins.
std::string plugin(const std::string& name) { return PLUGINS "/" + name + ".so"; }

struct Loaded {
    Registry registry = toy::registry();
    PluginFiles files;
    std::string problems;
};

std::string without(std::string text, const std::string& part) {
    for (std::size_t at; (at = text.find(part)) != std::string::npos;) text.erase(at, part.size());
    return text;
}

/// Loads what a pipeline names.
Loaded load(const Scratch& scratch, const std::string& yaml, const PluginTrust& trust) {
    Loaded out;
    Problems problems;
    const auto document = read_document(
        scratch.write("p.yaml", "fluidcarve: 1\n" + yaml + "nodes:\n  a: {type: x}\n"), {},
        problems);
    load_plugins(document.plugins, trust, out.registry, out.files, problems);
    out.problems = without(to_text(problems), scratch.path() + "/");
    return out;
}

/// What is said of a plugin that can't be used; after it, nothing of it may be left.
std::string fault_of(const std::string& name) {
    Loaded out;
    const auto before = out.registry.node_names();
    std::string fault = "none";
    try {
        load_plugin(plugin(name), out.registry, out.files);
    } catch (const Failure& failure) {
        fault = without(failure.what(), PLUGINS "/");
    }
    CHECK(out.registry.node_names() == before);
    CHECK(out.registry.payloads().size() == toy::registry().payloads().size());
    CHECK(out.files.empty());
    return fault;
}

}  // namespace

TEST_CASE("the types of a plugin are types as all others, and say where they come from") {
    Loaded out;
    load_plugin(plugin("whole"), out.registry, out.files);
    const auto* const type = out.registry.node("acme.grow");
    REQUIRE(type);
    CHECK(out.registry.payload(type->outputs.at(0).type).name == "acme.hair");
    CHECK(out.files == PluginFiles{{"acme.grow", plugin("whole")}});
    load_plugin(plugin("whole"), out.registry, out.files);
    CHECK(out.registry.node_names().size() == toy::registry().node_names().size() + 1);
}

TEST_CASE(
    "a plugin that was built for another fluidcarve is refused before any code of it is called") {
    CHECK(fault_of("other_abi") ==
          "the plugin other_abi.so has ABI number 99, but fluidcarve " FLUIDCARVE_VERSION
          " takes " +
              std::to_string(plugin_abi) + "; build it again with the headers of this one");
    CHECK(fault_of("other_payloads") ==
          "the plugin other_payloads.so was built with fluidcarve 0.9.7, whose payload types are "
          "of version 98, but here, in "
          "fluidcarve " FLUIDCARVE_VERSION ", they are of " +
              std::to_string(payload_abi) + "; build it again with the headers of this one");
    CHECK(fault_of("other_layout") ==
          "the plugin other_layout.so was built with fluidcarve 0.9.7 where a node type takes 8 "
          "bytes, but here it takes " +
              std::to_string(sizeof(NodeType)) +
              "; build it again with the headers of this one, and with the same options for the "
              "standard library");
}

TEST_CASE("a library without a plugin's symbols, or with one that nobody has, is told") {
    CHECK(fault_of("no_header") ==
          "no_header.so is no plugin of fluidcarve: it has no symbol 'fluidcarve_plugin'; "
          "`fluidcarve new-node` writes a complete one");
    CHECK(fault_of("no_entry") ==
          "no_entry.so is no plugin of fluidcarve: it has no symbol 'fluidcarve_register'; "
          "`fluidcarve new-node` writes a complete one");
    CHECK(fault_of("unresolved") ==
          "the plugin unresolved.so can't be opened: unresolved.so: undefined symbol: "
          "_Z15nowhere_definedRN10fluidcarve8RegistryE; "
          "build it again with the headers of fluidcarve " FLUIDCARVE_VERSION);
}

TEST_CASE("what a plugin throws is told, and nothing of it stays") {
    CHECK(fault_of("throws_half_way") ==
          "the plugin throws_half_way.so failed to register its types: the licence server is away; "
          "none of them can be used");
    CHECK(fault_of("throws_number") ==
          "the plugin throws_number.so failed to register its types: it threw something that is "
          "not a std::exception; none of them can be used");
}

TEST_CASE("a plugin's types are of a family of its own") {
    CHECK(fault_of("built_in_family")
              .starts_with("the plugin built_in_family.so gives its types the family 'toy', but "
                           "that is a built-in one, of 'toy."));
    CHECK(fault_of("foreign_type") ==
          "the plugin foreign_type.so adds the node type 'toy.grow', which is not of its own "
          "family 'acme'; call it 'acme.grow'");
    CHECK(fault_of("foreign_payload") ==
          "the plugin foreign_payload.so adds the payload type 'hair', which is not of its own "
          "family 'acme'; call it 'acme.hair'");
    CHECK(fault_of("foreign_conversion") ==
          "the plugin foreign_conversion.so converts 'number' to 'text' for all nodes; it may only "
          "convert from and to types of its own family 'acme'");
    CHECK(fault_of("foreign_selection") ==
          "the plugin foreign_selection.so picks 'text' from 'number' for all nodes; it may only "
          "pick from and to types of its own family 'acme'");
}

TEST_CASE("types of one name in two plugins are told") {
    const Scratch scratch;
    fs::copy_file(plugin("whole"), scratch / "again.so");
    Loaded out;
    load_plugin(plugin("whole"), out.registry, out.files);
    try {
        load_plugin(scratch / "again.so", out.registry, out.files);
        FAIL("loaded");
    } catch (const Failure& failure) {
        CHECK(without(failure.what(), scratch.path() + "/") ==
              "the plugin again.so failed to register its types: payload type 'acme.hair' is "
              "registered twice; none of them can be used");
    }
    CHECK(out.registry.node("acme.grow"));
    CHECK(out.files.size() == 1);
}

TEST_CASE("without permission no plugin is loaded") {
    const Scratch scratch;
    fs::copy_file(plugin("whole"), scratch / "hair.so");
    const auto out = load(scratch, "plugins: [hair.so]\n", {});
    CHECK(out.problems ==
          "p.yaml:2:11: the plugin hair.so is not loaded: it is code that would run with your "
          "rights, and nobody allowed that; if you trust hair.so, give "
          "--allow-plugins, or name a folder that holds it, and that only you may write to, in the "
          "environment variable FLUIDCARVE_PLUGINS\n"
          "plugins: [hair.so]\n          ^\n");
    CHECK(out.files.empty());
    CHECK(!out.registry.node("acme.grow"));
}

TEST_CASE(
    "a plugin is loaded by the flag, or from below a trusted folder, to which not everybody may "
    "write") {
    const Scratch scratch;
    fs::create_directories(scratch / "studio/tools");
    fs::copy_file(plugin("whole"), scratch / "studio/tools/hair.so");
    const std::string yaml = "plugins: [studio/tools/hair.so]\n";
    const PluginTrust trust{false, {"/nowhere", scratch / "studio"}};
    CHECK(load(scratch, yaml, {true, {}}).problems == "");
    CHECK(load(scratch, yaml, trust).files.size() == 1);
    CHECK(load(scratch, yaml, {false, {scratch / "stud"}}).files.empty());
    CHECK(load(scratch, "plugins: [tools/hair.so]\n", trust).files.size() == 1);

    fs::permissions(scratch / "studio/tools", fs::perms::others_write, fs::perm_options::add);
    const auto refused = load(scratch, yaml, trust);
    CHECK(refused.files.empty());
    CHECK(refused.problems.find("it lies in the trusted folder studio, but everybody may write to "
                                "studio/tools; if you trust") != std::string::npos);

    fs::permissions(scratch / "studio/tools", fs::perms::others_write, fs::perm_options::remove);
    fs::copy_file(plugin("whole"), scratch / "elsewhere.so");
    fs::create_symlink(scratch / "elsewhere.so", scratch / "studio/tools/link.so");
    CHECK(load(scratch, "plugins: [studio/tools/link.so]\n", trust).files.empty());
}

TEST_CASE("trusted folders are the absolute ones between colons") {
    setenv("FLUIDCARVE_PLUGINS", "/studio/plugins::relative:/show", 1);
    CHECK(trusted_plugin_folders() == std::vector<std::string>{"/studio/plugins", "/show"});
    unsetenv("FLUIDCARVE_PLUGINS");
    CHECK(trusted_plugin_folders().empty());
}

TEST_CASE("a plugin that is not there is told with the places where it was looked for") {
    const Scratch scratch;
    CHECK(load(scratch, "plugins: [no.so]\n", {true, {"/trusted"}}).problems ==
          "p.yaml:2:11: there is no plugin no.so: no file no.so, " + fs::current_path().string() +
              "/no.so, /trusted/no.so; build it, or correct the path\nplugins: [no.so]\n          "
              "^\n");
}

TEST_CASE("faults of plugins have the place where the plugin is named") {
    const Scratch scratch;
    const auto out = load(
        scratch, "plugins:\n  - " + plugin("whole") + "\n  - " + plugin("throws_number") + "\n",
        {true, {}});
    CHECK(out.problems.starts_with("p.yaml:4:5: the plugin " + plugin("throws_number") +
                                   " failed to register its types: "));
    CHECK(out.files.size() == 1);
}

TEST_CASE("a pipeline has its own plugins and those of the files that it extends") {
    const Scratch scratch;
    fs::create_directories(scratch / "show");
    fs::copy_file(plugin("whole"), scratch / "show/hair.so");
    scratch.write("show/base.yaml", "fluidcarve: 1\nplugins: [hair.so]\nnodes:\n  b: {type: x}\n");
    const auto files = [&](const std::string& own) {
        Problems problems;
        const auto document = read_document(
            scratch.write("shot.yaml", "fluidcarve: 1\nextends: show/base.yaml\n" + own), {},
            problems);
        std::vector<std::string> out;
        for (const auto& path : document.plugins.items) out.push_back(path.text);
        return out;
    };
    CHECK(files("") == std::vector<std::string>{"hair.so"});
    CHECK(files("plugins: [other.so]\n") == std::vector<std::string>{"hair.so", "other.so"});
    CHECK(files("plugins:\n").empty());
    CHECK(load(scratch, "extends: show/base.yaml\n", {true, {}}).files ==
          PluginFiles{{"acme.grow", scratch / "show/hair.so"}});
}

TEST_CASE("plugins are a list of paths, in which params stand") {
    const Scratch scratch;
    CHECK(load(scratch, "plugins: hair.so\n", {}).problems ==
          "p.yaml:2:10: 'plugins' must be a list of files, not 'hair.so'\nplugins: hair.so\n       "
          "  ^\n");
    CHECK(load(scratch, "plugins: [{a: b}]\n", {}).problems ==
          "p.yaml:2:11: 'plugins' must list the paths of files, not a map\nplugins: [{a: b}]\n     "
          "     ^\n");
    CHECK(load(scratch,
               "params:\n  tools: {type: path, default: " PLUGINS
               "}\nplugins: [\"${tools}/whole.so\"]\n",
               {true, {}})
              .files.size() == 1);
}
