#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>

// The house's rules. A unit is a header with its source. A room is a folder; a file right below graph/, nodes/, runtime/ or tools/ is a room of
// its own. Includes go one way: nodes -> graph, runtime -> graph, and tools to all three.

namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;
using Arrows = std::map<std::string, Names>;

std::string text_of(const fs::path& path) {
    std::ifstream in(path);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

/// Files below these folders of the repository that end so, by their paths from its root.
std::vector<std::string> files_of(const std::vector<std::string>& folders, const std::vector<std::string>& endings) {
    const fs::path root = SOURCE_ROOT;
    std::vector<std::string> out;
    for (const auto& folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator(root / folder))
            if (entry.is_regular_file() && std::ranges::find(endings, entry.path().extension().string()) != endings.end())
                out.push_back(fs::relative(entry.path(), root).string());
    std::ranges::sort(out);
    return out;
}

std::vector<std::string> sources() { return files_of({"graph", "nodes", "runtime", "tools"}, {".h", ".cpp"}); }

std::string unit_of(const std::string& file) { return fs::path(file).replace_extension().string(); }

std::string room_of(const std::string& file) {
    const auto folder = fs::path(file).parent_path();
    return folder.has_parent_path() ? folder.string() : unit_of(file);
}

/// All matches of a pattern's first group.
std::vector<std::string> found(const std::string& text, const std::string& pattern) {
    const std::regex expression(pattern);
    std::vector<std::string> out;
    for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at) out.push_back((*at)[1]);
    return out;
}

/// What includes what, by name. @param name  of a file
Arrows arrows(const std::function<std::string(const std::string&)>& name) {
    Arrows out;
    for (const auto& file : sources())
        for (const auto& included : found(text_of(fs::path(SOURCE_ROOT) / file), "#include \"([^\"]+)\"")) {
            INFO(file << " includes " << included);
            CHECK(fs::exists(fs::path(SOURCE_ROOT) / included));
            if (name(file) != name(included)) out[name(file)].insert(name(included));
        }
    return out;
}

/// A circle of arrows as "a -> b -> a", or nothing.
std::string circle(const Arrows& all) {
    std::vector<std::string> way;
    Names done;
    std::string out;
    const std::function<void(const std::string&)> visit = [&](const std::string& at) {
        if (!out.empty() || done.contains(at)) return;
        if (const auto before = std::ranges::find(way, at); before != way.end()) {
            for (auto step = before; step != way.end(); ++step) out += *step + " -> ";
            out += at;
            return;
        }
        way.push_back(at);
        if (const auto next = all.find(at); next != all.end())
            for (const auto& to : next->second) visit(to);
        way.pop_back();
        done.insert(at);
    };
    for (const auto& [from, to] : all) visit(from);
    return out;
}

}  // namespace

TEST_CASE("includes never lead in a circle, neither from file to file nor from room to room") {
    CHECK(circle(arrows(unit_of)) == "");
    CHECK(circle(arrows(room_of)) == "");
    CHECK(circle({{"a", {"b"}}, {"b", {"c"}}, {"c", {"b"}}}) == "b -> c -> b");
}

TEST_CASE("graph/ includes no volume, no task and no mesh library, and neither other wing") {
    CHECK(call_shell(R"(grep -rnE '#include *[<"](openvdb|tbb|oneapi|OpenMesh|nodes/|runtime/)' graph)").out == "");
    CHECK(call_shell(R"(grep -rlE 'yaml-cpp' graph | grep -v '^graph/text/yaml_reader.cpp$')").out == "");
}

TEST_CASE("nodes/ and runtime/ never include each other, and none of the floors below includes tools/") {
    CHECK(call_shell(R"(grep -rnE '#include *"runtime/' nodes)").out == "");
    CHECK(call_shell(R"(grep -rnE '#include *("nodes/|<openvdb)' runtime)").out == "");
    CHECK(call_shell(R"(grep -rnE '#include *"tools/' graph nodes runtime)").out == "");
}

TEST_CASE("the algorithms of nodes/ know nothing of the graph but failures and frames") {
    CHECK(
        call_shell(
            R"(grep -rlE '#include "graph/(types/(node_type|registry)|pipeline|document|text/yaml_reader)' nodes --include=*.h | grep -vE 'nodes/(catalogue|plugin|precompiled)\.h' | while read f; do
        grep -q 'NodeType ' "$f" || grep -q 'Registry&' "$f" || grep -q 'Declare<' "$f" || echo "$f"; done)")
            .out == "");
}

TEST_CASE("no two wings give two types one name, which a linker would take for the same") {
    CHECK(
        call_shell(
            R"(grep -hoE '^(struct|class|enum class) +[A-Za-z_]+ *(:.*)?\{' --include=*.h -r graph runtime nodes tools | awk '{print $(/^enum/ ? 3 : 2)}' | tr -d ':{' | sort | uniq -d)")
            .out == "");
}

TEST_CASE("no two rooms have one name, but for modules") {
    std::map<std::string, Names> rooms;
    for (const auto& file : sources()) rooms[fs::path(file).parent_path().filename().string()].insert(fs::path(file).parent_path().string());
    rooms.erase("module");
    for (const auto& [name, all] : rooms) {
        INFO(name);
        CHECK(all.size() == 1);
    }
}

TEST_CASE("no file is longer than 500 lines, no folder holds more than 25 units") {
    std::map<std::string, Names> units;
    for (const auto& file : files_of({"graph", "nodes", "runtime", "tools", "tests"}, {".h", ".cpp"})) {
        const auto text = text_of(fs::path(SOURCE_ROOT) / file);
        INFO(file);
        CHECK(std::ranges::count(text, '\n') <= 500);
        units[fs::path(file).parent_path().string()].insert(unit_of(file));
    }
    for (const auto& [folder, all] : units) {
        INFO(folder);
        CHECK(all.size() <= 25);
    }
}

TEST_CASE("every citation of the method leads to a section of nodes/METHOD.md, and every title to its paragraph", "[long]") {
    const auto method = text_of(SOURCE_ROOT "/nodes/METHOD.md");
    std::set<std::string> sections, titles;
    for (const auto& number : found(method, "\n## ([0-9]+)\\. ")) sections.insert(number);
    std::istringstream lines(method);
    std::string section;
    for (std::string line; std::getline(lines, line);) {
        if (const auto number = found(line, "^## ([0-9]+)\\. "); !number.empty()) section = number.front();
        for (const auto& title : found(line, "\\*\\*([^*]+?)\\.?\\*\\*")) titles.insert(section + " " + title);
    }
    std::size_t citations = 0;
    for (const auto& file : files_of({"graph", "nodes", "runtime", "tools", "tests"}, {".h", ".cpp"})) {
        if (file == "tests/program/house_test.cpp") continue;
        const auto text = text_of(fs::path(SOURCE_ROOT) / file);
        INFO(file);
        for (const auto& cited : found(text, "METHOD ([0-9]+(?: \"[^\"]+\")?)")) {
            INFO("METHOD " << cited);
            const auto quote = cited.find('"');
            CHECK(sections.contains(cited.substr(0, cited.find(' '))));
            if (quote != std::string::npos) CHECK(titles.contains(cited.substr(0, quote) + cited.substr(quote + 1, cited.size() - quote - 2)));
            ++citations;
        }
        CHECK(found(text, "(METHOD)(?! [0-9])").empty());
    }
    CHECK(citations > 20);
}

TEST_CASE("every link of a page leads to a file") {
    for (const auto& page : {"README.md", "nodes/README.md", "nodes/METHOD.md", "pipelines/README.md", "pipelines/FORMATS.md", "pipelines/NODES.md",
                             "pipelines/gallery/README.md", "python/README.md", "runtime/README.md", "SECURITY.md", "package/README.md"}) {
        const fs::path path = fs::path(SOURCE_ROOT) / page;
        REQUIRE(fs::exists(path));
        for (const auto& link : found(text_of(path), "\\]\\(([^)# ]+)(?:#[^)]*)?\\)")) {
            INFO(page << " -> " << link);
            if (!link.starts_with("http")) CHECK(fs::exists(path.parent_path() / link));
        }
    }
}

TEST_CASE("the first page is short enough to be read") {
    const auto text = text_of(SOURCE_ROOT "/README.md");
    CHECK(std::ranges::count(text, '\n') <= 120);
}
