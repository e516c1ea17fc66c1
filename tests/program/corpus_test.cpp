#include "tests/fuzz/pipelines.h"
#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <vector>

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> corpus() {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(SOURCE_ROOT "/tests/fuzz/corpus"))
        if (entry.path().extension() != ".md") out.push_back(entry.path());
    std::ranges::sort(out);
    return out;
}

/// The pipeline for a file, by the first word of its name.
std::string pipeline_for(const fs::path& file) {
    const auto ending = file.extension().string(), name = file.filename().string();
    const auto kind = name.substr(0, name.find('-'));
    if (kind == "pipeline") return Scratch::read(file);
    const std::map<std::string, std::string> all{
        {"volume", fuzz::volume_pipeline("out", "float")},
        {"points", fuzz::points_pipeline(TEST_DATA, ending)},
        {"seams", fuzz::seams_pipeline(TEST_DATA "/vdb/gaffer_arnold_sphere.vdb", "density")},
        {"mesh", fuzz::mesh_pipeline(ending, ending)},
        {"image", fuzz::image_pipeline(ending, ending)}};
    return all.at(kind);
}

}  // namespace

TEST_CASE(
    "files with harmful faults are refused in time, with little memory, and nothing is written") {
    const auto files = corpus();
    CHECK(files.size() >= 20);
    CHECK(files.size() <= 40);
    for (const auto& file : files) {
        INFO(file);
        CHECK(fs::file_size(file) < 20000);
        const Scratch scratch;
        fs::copy_file(file, scratch / ("in" + file.extension().string()));
        scratch.write("p.yaml", pipeline_for(file));
        const auto begin = std::chrono::steady_clock::now();
        const auto called = call_shell("cd " + scratch.path() +
                                       " && timeout 30 " FLUIDCARVE_PROGRAM
                                       " run --quiet --no-cache --threads 2 --memory 64M p.yaml");
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        INFO(called.err);
        CHECK((called.code == 2 || called.code == 3));
        CHECK(called.err != "");
        CHECK(seconds.count() < 10);
        for (const auto& entry : fs::directory_iterator(scratch.path()))
            CHECK(!entry.path().filename().string().starts_with("out"));
    }
}
