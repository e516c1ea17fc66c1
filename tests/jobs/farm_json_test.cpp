#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <regex>
#include <set>
#include <sstream>
#include <vector>

using Json = nlohmann::json;

namespace {

using Paths = std::set<std::string>;

/// The fields that the tables of a section of FORMATS.md name, a set for each table.
std::vector<Paths> documented(const std::string& section) {
    const auto page = Scratch::read(SOURCE_ROOT "/pipelines/FORMATS.md");
    const auto begin = page.find("\n## " + section + "\n");
    REQUIRE(begin != std::string::npos);
    std::istringstream lines(page.substr(begin + 1, page.find("\n## ", begin + 1) - begin));
    std::vector<Paths> out;
    static const std::regex name("`([^`]+)`");
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("| field")) out.emplace_back();
        if (!line.starts_with("| `")) continue;
        const auto cell = line.substr(2, line.find(" |") - 2);
        for (std::sregex_iterator each(cell.begin(), cell.end(), name), end; each != end; ++each)
            out.back().insert(each->str(1));
    }
    return out;
}

/// Adds the paths of all values, as FORMATS.md writes them.
void add_paths(const Json& json, const std::string& path, Paths& out) {
    if (json.is_object()) {
        for (const auto& [key, value] : json.items())
            add_paths(value, path.empty() ? key : path + "." + (path == "nodes" ? "NAME" : key),
                      out);
    } else if (json.is_array()) {
        for (const auto& value : json) add_paths(value, path + "[]", out);
    } else {
        out.insert(path);
    }
}

Paths paths_of(const std::vector<Json>& all) {
    Paths out;
    for (const auto& json : all) add_paths(json, {}, out);
    return out;
}

}  // namespace

TEST_CASE("what plan, farm and status print for programs is what FORMATS.md says", "[long]") {
    const Scratch scratch;
    // All smoke is protected, so that no seam passes the window: only the solver finds out.
    const auto closed =
        scratch.write("shot.yaml", fmt::format("extends: {}/pipelines/plume.yaml\nnodes: {{seams: "
                                               "{{protect: sim.density, window: [15, 20]}}}}\n",
                                               SOURCE_ROOT));
    const auto call = [&](const std::string& verb,
                          const std::string& pipeline = "pipelines/plume.yaml") {
        return call_shell(fmt::format("{} {} {} --set count=-2 --to seams --work {}",
                                      FLUIDCARVE_PROGRAM, verb, pipeline, scratch / "work"));
    };
    const auto before = Json::parse(call("plan --json").out);
    REQUIRE(call("run -q").code == 0);
    const auto after = Json::parse(call("plan --json").out);
    const auto job = Json::parse(call("farm local --dry-run --json").out);
    REQUIRE(call("farm local --chunk 3", closed).code == 1);
    REQUIRE(call("run -q", closed).code == 1);
    const auto all = Json::parse(
        call_shell(fmt::format("{} status --json --work {}", FLUIDCARVE_PROGRAM, scratch / "work"))
            .out);
    REQUIRE(all.size() == 3);
    CHECK(all.at(0).contains("job"));
    CHECK_FALSE(all.at(1).contains("job"));

    const auto tables = documented("Plan, status and farm");
    REQUIRE(tables.size() == 4);
    CHECK(paths_of({before, after}) == tables[0]);
    CHECK(paths_of({job}) == tables[1]);
    CHECK(paths_of({all.at(0)}) == tables[2]);
    CHECK(paths_of({all.at(1), all.at(2)}) == tables[3]);
}
