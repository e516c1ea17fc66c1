#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>

// The house's rules. A unit is a header with its source. A room is a folder; a file right below a
// floor is a room of its own. The floors, and which others each may include, stand in README.md.

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
std::vector<std::string> files_of(const std::vector<std::string>& folders,
                                  const std::vector<std::string>& endings) {
    const fs::path root = SOURCE_ROOT;
    std::vector<std::string> out;
    for (const auto& folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator(root / folder))
            if (entry.is_regular_file() &&
                std::ranges::find(endings, entry.path().extension().string()) != endings.end())
                out.push_back(fs::relative(entry.path(), root).string());
    std::ranges::sort(out);
    return out;
}

const std::vector<std::string> floors{"carve", "formats", "graph", "nodes", "runtime", "tools"};

std::vector<std::string> sources() { return files_of(floors, {".h", ".cpp"}); }

std::string floor_of(const std::string& file) { return file.substr(0, file.find('/')); }

std::string unit_of(const std::string& file) { return fs::path(file).replace_extension().string(); }

std::string room_of(const std::string& file) {
    const auto folder = fs::path(file).parent_path();
    return folder.has_parent_path() ? folder.string() : unit_of(file);
}

/// All matches of a pattern's first group.
std::vector<std::string> found(const std::string& text, const std::string& pattern) {
    const std::regex expression(pattern);
    std::vector<std::string> out;
    for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at)
        out.push_back((*at)[1]);
    return out;
}

/// The anchors of a page's titles, as forges make them.
Names anchors_of(const std::string& page) {
    Names out;
    for (const auto& title : found(page, "(?:^|\n)#+ ([^\n]+)")) {
        std::string anchor;
        for (const char c : title)
            if (c == ' ') anchor += '-';
            else if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
                anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        out.insert(anchor);
    }
    return out;
}

/// What includes what, by name. @param name  of a file
Arrows arrows(const std::function<std::string(const std::string&)>& name) {
    Arrows out;
    for (const auto& file : sources())
        for (const auto& included :
             found(text_of(fs::path(SOURCE_ROOT) / file), "#include \"([^\"]+)\"")) {
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

TEST_CASE("each floor includes what the first page says, and nothing else") {
    // A line of the page: `graph/ [carve/base]   what a pipeline is`.
    Arrows stated;
    const auto page = text_of(SOURCE_ROOT "/README.md");
    for (const auto& floor : floors)
        for (const auto& names : found(page, "\n    " + floor + "/ +\\[([^\\]]*)\\]"))
            for (const auto& name : found(names, "([a-z/]+)")) stated[floor].insert(name);
    // Of the method and of the formats, some take a part alone.
    const auto named = [](const std::string& file) -> std::string {
        for (const auto* const part : {"carve/base", "formats/file"})
            if (file.starts_with(std::string(part) + "/")) return part;
        return floor_of(file);
    };
    Arrows drawn;
    for (const auto& file : sources())
        for (const auto& included :
             found(text_of(fs::path(SOURCE_ROOT) / file), "#include \"([^\"]+)\""))
            if (floor_of(file) != floor_of(included)) drawn[floor_of(file)].insert(named(included));
    // Who takes all takes the part, too.
    for (auto& [floor, names] : drawn)
        for (const auto* const part : {"carve/base", "formats/file"})
            if (names.contains(floor_of(part))) names.erase(part);
    CHECK(stated == drawn);
}

TEST_CASE("the floors include the libraries that they are made for, and no others") {
    CHECK(
        call_shell(
            R"(grep -rnE '#include *<(nlohmann|yaml-cpp|OpenMesh|cairo|OpenImageIO|CLI|zlib)' carve)")
            .out == "");
    CHECK(call_shell(R"(grep -rnE '#include *<(openvdb|tbb|oneapi|OpenMesh)' graph)").out == "");
    CHECK(
        call_shell(R"(grep -rlE 'yaml-cpp' graph | grep -v '^graph/text/yaml_reader.cpp$')").out ==
        "");
    CHECK(call_shell(R"(grep -rnE '#include *<openvdb' runtime)").out == "");
}

TEST_CASE("no two floors give two types one name, which a linker would take for the same") {
    CHECK(
        call_shell(
            R"(grep -hoE '^(struct|class|enum class) +[A-Za-z_]+ *(:.*)?\{' --include=*.h -r carve formats graph runtime nodes tools | awk '{print $(/^enum/ ? 3 : 2)}' | tr -d ':{' | sort | uniq -d)")
            .out == "");
}

TEST_CASE("no two rooms have one name, but for modules") {
    std::map<std::string, Names> rooms;
    for (const auto& file : sources())
        rooms[fs::path(file).parent_path().filename().string()].insert(
            fs::path(file).parent_path().string());
    rooms.erase("module");
    for (const auto& [name, all] : rooms) {
        INFO(name);
        CHECK(all.size() == 1);
    }
}

TEST_CASE(
    "no file is longer than 500 lines, no line than 100 columns, no folder holds more than 25 "
    "units") {
    std::map<std::string, Names> units;
    for (const auto& file :
         files_of({"carve", "formats", "graph", "nodes", "runtime", "tools", "tests", "examples"},
                  {".h", ".cpp"})) {
        const auto text = text_of(fs::path(SOURCE_ROOT) / file);
        INFO(file);
        CHECK(std::ranges::count(text, '\n') <= 500);
        // Names of tests are as long as they must be.
        if (!file.starts_with("tests/"))
            for (const auto& line : found(text, "(?:^|\n)([^\n]{101,})")) CHECK(line == "");
        units[fs::path(file).parent_path().string()].insert(unit_of(file));
    }
    for (const auto& [folder, all] : units) {
        INFO(folder);
        CHECK(all.size() <= 25);
    }
}

TEST_CASE(
    "every citation of the method leads to a section of nodes/METHOD.md, and every title to its "
    "paragraph",
    "[long]") {
    const auto method = text_of(SOURCE_ROOT "/nodes/METHOD.md");
    std::set<std::string> sections, titles;
    for (const auto& number : found(method, "\n## ([0-9]+)\\. ")) sections.insert(number);
    std::istringstream lines(method);
    std::string section;
    for (std::string line; std::getline(lines, line);) {
        if (const auto number = found(line, "^## ([0-9]+)\\. "); !number.empty())
            section = number.front();
        for (const auto& title : found(line, "\\*\\*([^*]+?)\\.?\\*\\*"))
            titles.insert(section + " " + title);
    }
    std::size_t citations = 0;
    for (const auto& file :
         files_of({"carve", "formats", "graph", "nodes", "runtime", "tools", "tests", "examples"},
                  {".h", ".cpp"})) {
        if (file == "tests/program/house_test.cpp") continue;
        // A comment may break within a title.
        const auto text = std::regex_replace(text_of(fs::path(SOURCE_ROOT) / file),
                                             std::regex("\\n *//[/<]* *"), " ");
        INFO(file);
        for (const auto& cited : found(text, "METHOD ([0-9]+(?: \"[^\"]+\")?)")) {
            INFO("METHOD " << cited);
            const auto quote = cited.find('"');
            CHECK(sections.contains(cited.substr(0, cited.find(' '))));
            if (quote != std::string::npos)
                CHECK(titles.contains(cited.substr(0, quote) +
                                      cited.substr(quote + 1, cited.size() - quote - 2)));
            ++citations;
        }
        CHECK(found(text, "(METHOD)(?! [0-9])").empty());
    }
    CHECK(citations > 20);
}

TEST_CASE("every link of a page leads to a file, and to a title of it") {
    auto folders = floors;
    folders.insert(folders.end(), {"pipelines", "python", "blender", "package", "tests"});
    auto pages = files_of(folders, {".md"});
    for (const auto& entry : fs::directory_iterator(SOURCE_ROOT))
        if (entry.path().extension() == ".md") pages.push_back(entry.path().filename().string());
    int titles = 0;
    for (const auto& page : pages) {
        const auto path = fs::path(SOURCE_ROOT) / page;
        const auto text = text_of(path);
        for (const auto& link : found(text, "\\]\\(([^) ]+)\\)")) {
            INFO(page << " -> " << link);
            if (link.starts_with("http")) continue;
            const auto hash = link.find('#');
            const auto file = link.substr(0, hash);
            const auto target = file.empty() ? path : path.parent_path() / file;
            CHECK(fs::exists(target));
            if (hash == std::string::npos || target.extension() != ".md") continue;
            CHECK(anchors_of(text_of(target)).contains(link.substr(hash + 1)));
            ++titles;
        }
    }
    CHECK(titles > 50);
}

TEST_CASE("the first page is short enough to be read") {
    const auto text = text_of(SOURCE_ROOT "/README.md");
    CHECK(std::ranges::count(text, '\n') <= 120);
}
