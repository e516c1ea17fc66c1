// How good seams are, solver by solver, as the paper shows it, and what whole pipelines take at the
// paper's sizes.
//
//   build/quality images FOLDER [OUT]
//       figure 14 on all PNG files of the folder: OUT.csv and OUT.png (out/images)
//   build/quality volumes [--large] [FOLDER] [OUT]
//       table 2 on plume/, vortex/ and bonfire/ of the folder (tests/data) and on
//                                                    synthetic volumes: OUT.csv, OUT.md
//                                                    (out/volumes); --large: the size of the
//                                                    paper's
//                                                    smoke vortex too, 322 x 105 x 331 vertices and
//                                                    84 frames (takes 5 GB)
//   build/quality table [FOLDER] [OUT]
//       table 2 with whole pipelines, on sequences of its sizes that are made of those in the
//                                                    folder (tests/data) and deleted again: OUT.md
//                                                    (out/table)
//   build/quality make FILES X Y Z FRAMES OUT        makes such a sequence
//
// build/quality VERB --help tells all options.

#include "tests/bench/images.h"
#include "tests/bench/large/make.h"
#include "tests/bench/large/table.h"
#include "tests/bench/volumes.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace {

void make_folder_of(const std::string& path) {
    if (const auto folder = std::filesystem::path(path).parent_path(); !folder.empty())
        std::filesystem::create_directories(folder);
}

/// @param text  `5%`, or `0.05`
/// @throws std::runtime_error that says so
double share_of(const std::string& text) {
    double value = 0;
    const auto* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    const bool percent = rest + 1 == end && *rest == '%';
    if (percent) value /= 100;
    if (error != std::errc() || (rest != end && !percent) || value <= 0 || value > 1)
        throw std::runtime_error(
            fmt::format("--active is '{}', but must be a share such as 5% or 0.05", text));
    return value;
}

}  // namespace

int main(int argc, char** argv) {
    openvdb::initialize();
    CLI::App app("How good seams are, and what they take.");
    app.require_subcommand(1);
    std::string folder = SOURCE_ROOT "/tests/data", out;
    const auto out_or = [&](const std::string& otherwise) {
        if (out.empty()) out = otherwise;
        make_folder_of(out);
        return out;
    };

    auto* const images =
        app.add_subcommand("images", "The paper's figure 14 on all PNG files of a folder");
    images->add_option("folder", folder, "Folder of PNG files")->required();
    images->add_option("out", out, "Written: OUT.csv and OUT.png (out/images)");
    images->callback([&] { compare_on_images(folder, out_or("out/images"), 100); });

    bool large = false;
    auto* const volumes =
        app.add_subcommand("volumes", "The paper's table 2 by solver: seams alone");
    volumes->add_flag("--large", large, "The size of the paper's smoke vortex, too: takes 5 GB");
    volumes->add_option("folder", folder, "Folder of sequences (tests/data)");
    volumes->add_option("out", out, "Written: OUT.csv and OUT.md (out/volumes)");
    volumes->callback([&] { compare_on_volumes(folder, out_or("out/volumes"), large); });

    TableRequest table;
    auto* const pipelines = app.add_subcommand(
        "table", "The paper's table 2 with whole pipelines: read, energies, solve, carve, write");
    pipelines
        ->add_option(
            "--only", table.only,
            "Only this row: vortex, river, bonfire, torch, trail or plume; may be repeated")
        ->allow_extra_args(false);
    pipelines->add_option("--frames", table.frames,
                          "At most so many frames of each row; then three lengths, and the slope");
    pipelines->add_option("--memory", table.memory, "As of run")->capture_default_str();
    pipelines
        ->add_option("--scratch", table.scratch,
                     "Folder for sequences and results, deleted row by row")
        ->capture_default_str();
    pipelines->add_option("folder", folder, "Folder of sequences (tests/data)");
    pipelines->add_option("out", out, "Written: OUT.md (out/table)");
    pipelines->callback([&] {
        table.folder = folder;
        table.out = out_or("out/table");
        measure_table(table);
    });

    MakeRequest request;
    std::string active = "100%";
    auto* const make = app.add_subcommand(
        "make", "Makes a large sequence of a small one: detail is added and moves with the flow");
    make->add_option(
            "files", request.files,
            "The small one, FOLDER/NAME.####.vdb: density or particles, flame, and the velocity")
        ->required();
    make->add_option("x", request.size.x(), "Voxels that the box around its content becomes")
        ->required();
    make->add_option("y", request.size.y())->required();
    make->add_option("z", request.size.z())->required();
    make->add_option("frames", request.frames, "Frames that its time becomes")->required();
    make->add_option("out", request.out, "The large one, FOLDER/NAME.####.vdb, from frame 1 on")
        ->required();
    make->add_option("--active", active,
                     "Largest share of the voxels that is active; thinner smoke is left out")
        ->capture_default_str();
    make->add_option("--first", request.first_only, "Makes only so many of the frames");
    make->add_flag("--velocity", request.velocity, "Writes the velocity, too");
    make->callback([&] {
        request.active = share_of(active);
        make_folder_of(request.out);
        const auto made =
            make_sequence(request, [](int frame) { fmt::print(stderr, "\rframe {}", frame); });
        fmt::print(stderr, "\n");
        fmt::print(
            "{} frames, {:.2f} GB, at most {:.1f} M active voxels of {:.6g} world units a frame; "
            "places are stretched by {:.6g}, {:.6g}, {:.6g}\n",
            made.frames, static_cast<double>(made.bytes) / 1e9,
            static_cast<double>(made.active) / 1e6, made.voxel, made.stretch.x(), made.stretch.y(),
            made.stretch.z());
    });

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& failure) {
        fmt::print(stderr, "{}\n", failure.what());
        return 1;
    }
    return 0;
}
