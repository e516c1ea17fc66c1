// How good seams are, solver by solver, as the paper shows it.
//
//   build/quality images FOLDER [OUT]                figure 14 on all PNG files of the folder: OUT.csv and OUT.png (out/images)
//   build/quality volumes [--large] [FOLDER] [OUT]   table 2 on plume/, vortex/ and bonfire/ of the folder (tests/data) and on
//                                                    synthetic volumes: OUT.csv, OUT.md (out/volumes); --large: the size of the paper's
//                                                    smoke vortex too, 322 x 105 x 331 vertices and 84 frames (takes 5 GB)

#include "tests/bench/images.h"
#include "tests/bench/volumes.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <filesystem>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    openvdb::initialize();
    std::vector<std::string> words(argv + 1, argv + argc);
    const bool large = std::erase(words, "--large") > 0;
    const auto word = [&](std::size_t n, const std::string& otherwise) { return n < words.size() ? words[n] : otherwise; };
    const auto what = word(0, "");
    const auto out = word(2, "out/" + what);
    if (what != "volumes" && (what != "images" || words.size() < 2)) {
        fmt::print(stderr, "quality images FOLDER [OUT]\nquality volumes [--large] [FOLDER] [OUT]\n");
        return 2;
    }
    try {
        if (const auto folder = std::filesystem::path(out).parent_path(); !folder.empty()) std::filesystem::create_directories(folder);
        if (what == "images") compare_on_images(words[1], out, 100);
        else compare_on_volumes(word(1, SOURCE_ROOT "/tests/data"), out, large);
    } catch (const std::exception& failure) {
        fmt::print(stderr, "{}\n", failure.what());
        return 1;
    }
    return 0;
}
