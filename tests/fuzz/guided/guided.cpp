// Gives the parsers of this project bytes that libFuzzer chooses by what they make a parser do:
//   guided --list
//   guided --parser=NAME [OPTION OF LIBFUZZER]... [FOLDER]...
// A parser refuses what is damaged by a Failure or a problem. All else that it throws, and all that
// sanitizers find, ends the program.

#include "carve/base/frame_set.h"
#include "formats/file/input_file.h"
#include "formats/geometry_file/curve_file.h"
#include "formats/image/image_provenance.h"
#include "formats/mesh_file/mesh_file.h"
#include "formats/points_file/ply.h"
#include "formats/seam_file/seam_file.h"
#include "formats/vdb/vdb_file.h"
#include "graph/document.h"
#include "runtime/jobs/job_status.h"
#include "runtime/keep/history.h"
#include "runtime/keep/manifest.h"
#include "runtime/keep/packs.h"

#include <fmt/format.h>

#include <unistd.h>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace {

using namespace fluidcarve;

/// A folder in memory, removed at the end.
struct Folder {
    std::string path = fmt::format("/dev/shm/fluidcarve-guided-{}", getpid());
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
        std::error_code none;
        std::filesystem::remove_all(path, none);
    }
};

const std::string& folder() {
    static const Folder all;
    return all.path;
}

using Parser = std::function<void(const std::string& bytes)>;

/// A parser of files. @param name  of the file, below folder()
Parser of_file(const std::string& name, const std::function<void(const std::string& path)>& read) {
    const auto path = folder() + "/" + name;
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    return [path, read](const std::string& bytes) {
        std::ofstream(path, std::ios::binary)
            .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        read(path);
    };
}

void read_records(const std::string&) {
    job_status_text(folder() + "/work", true);
    job_status_text(folder() + "/work", false);
}

void read_pack(const std::string& path) {
    Packs packs(std::filesystem::path(path).parent_path().string());
    packs.read(Hash{1, 1});
}

constexpr std::uint64_t budget = std::uint64_t{64} << 20;  ///< bytes of a volume

const std::map<std::string, std::function<Parser()>>& parsers() {
    static const auto mesh = [](const std::string& path) { read_mesh(path); };
    static const auto curve = [](const std::string& path) { read_curve(path); };
    static const std::map<std::string, std::function<Parser()>> all{
        {"yaml",
         [] {
             return [](const std::string& bytes) {
                 Problems problems;
                 const auto source = std::make_shared<Source>();
                 source->name = "p.yaml";
                 source->text = bytes;
                 read_document(source, {}, problems);
             };
         }},
        {"frames",
         [] {
             return [](const std::string& bytes) {
                 std::string fault;
                 FrameSet::parse(bytes, fault);
             };
         }},
        {"obj", [] { return of_file("a.obj", mesh); }},
        {"ply", [] { return of_file("a.ply", mesh); }},
        {"off", [] { return of_file("a.off", mesh); }},
        {"stl", [] { return of_file("a.stl", mesh); }},
        {"points",
         [] { return of_file("p.ply", [](const std::string& path) { read_ply(path); }); }},
        {"curve_obj", [] { return of_file("c.obj", curve); }},
        {"curve_ply", [] { return of_file("c.ply", curve); }},
        {"curve_csv", [] { return of_file("c.csv", curve); }},
        {"vdb",
         [] {
             return of_file("a.vdb",
                            [](const std::string& path) { VdbFile(path, budget).header(); });
         }},
        {"seams",
         [] { return of_file("s.vdb", [](const std::string& path) { read_seams(path); }); }},
        {"image",
         [] {
             return of_file("a.png", [](const std::string& path) {
                 provenance_of_image(InputFile(path, {.what = "an image"}));
             });
         }},
        {"manifest", [] { return of_file("m", [](const std::string& path) { Manifest{path}; }); }},
        {"history",
         [] {
             return of_file("work/history/p.json", [](const std::string&) {
                 History(folder() + "/work", "p.yaml").of("sim");
             });
         }},
        {"run", [] { return of_file("work/runs/p.json", read_records); }},
        {"job", [] { return of_file("work/jobs/p/job.json", read_records); }},
        {"pack",
         [] { return of_file("work/cache/0123456789abcdef0123456789abcdef.pack", read_pack); }},
    };
    return all;
}

Parser chosen;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** words) {
    constexpr std::string_view option = "--parser=";
    const std::string_view word = *count > 1 ? (*words)[1] : "";
    if (word == "--list") {
        for (const auto& [name, parser] : parsers()) std::puts(name.c_str());
        std::exit(0);
    }
    const auto found = word.starts_with(option)
                           ? parsers().find(std::string(word.substr(option.size())))
                           : parsers().end();
    if (found == parsers().end()) {
        std::fputs("guided --list, or guided --parser=NAME\n", stderr);
        std::exit(2);
    }
    chosen = found->second();
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    try {
        chosen(std::string(reinterpret_cast<const char*>(bytes), size));
    } catch (const Failure&) {
        // What is refused is refused as it should be.
    }
    return 0;
}
