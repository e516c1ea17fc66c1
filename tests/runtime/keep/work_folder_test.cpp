#include "runtime/keep/work_folder.h"
#include "formats/file/output_file.h"
#include "runtime/keep/cache.h"
#include "tests/runtime/keep/keys.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>
#include <filesystem>
#include <map>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
namespace fs = std::filesystem;

namespace {

/// All files below a folder, by their content.
std::map<std::string, std::string> texts_of(const std::string& folder) {
    std::map<std::string, std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            out[entry.path().string()] = Scratch::read(entry.path().string());
    return out;
}

void put(const std::string& path, const std::string& text) {
    fs::create_directories(fs::path(path).parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

/// Keeps so many numbers in a work folder. @param packed  whether they share a file
void keep(const std::string& folder, int count, bool packed = false) {
    const auto registry = toy::registry();
    Cache cache(registry, folder, packed ? Cache::small : 0);
    for (int n = 0; n < count; ++n)
        REQUIRE(cache.store(key_of(n), {{"n", n}}, {Payload(std::make_shared<toy::Number>(n))}));
}

}  // namespace

TEST_CASE("a work folder is marked where there was nothing, and only there") {
    const Scratch scratch;
    const auto fresh = scratch / "fresh", used = scratch / "used";
    CHECK(WorkFolder(fresh).fault() == "");
    WorkFolder(fresh).make();
    CHECK(WorkFolder(fresh).marked());
    CHECK(Scratch::read(fresh + "/CACHEDIR.TAG")
              .starts_with("Signature: 8a477f597d28d172789f06886806bc55\n"));
    put(used + "/cache/sim/smoke.0001.vdb", "smoke");
    WorkFolder(used).make();
    CHECK(!WorkFolder(used).marked());
    CHECK(WorkFolder(used).fault() ==
          "'" + used +
              "' is not a work folder of fluidcarve: it has no CACHEDIR.TAG written by fluidcarve, "
              "so nothing in it may be removed; name " +
              "another with --work");
    put(used + "/CACHEDIR.TAG",
        "Signature: 8a477f597d28d172789f06886806bc55\n# of another program\n");
    CHECK(!WorkFolder(used).marked());
}

TEST_CASE(
    "a work folder whose first run was killed while it made the mark is marked by the next, and "
    "keeps nothing of the first") {
    const Scratch scratch;
    const auto work = scratch / "work";
    if (const auto first = fork(); first == 0) {
        const OutputFile mark(work + "/CACHEDIR.TAG");
        _exit(0);
    } else {
        waitpid(first, nullptr, 0);
    }
    REQUIRE(!fs::is_empty(work));
    WorkFolder(work).make();
    CHECK(WorkFolder(work).marked());
    CHECK(std::distance(fs::directory_iterator(work), {}) == 1);
}

TEST_CASE(
    "what was used lately stays if only older results are to go, and a dry run removes nothing") {
    const Scratch scratch;
    const auto work = scratch / "work";
    WorkFolder(work).make();
    keep(work, 4);
    const auto entries = WorkFolder(work).entries();
    REQUIRE(entries.size() == 4);
    for (const std::size_t n : {0u, 1u, 2u})
        fs::last_write_time(entries[n].path,
                            fs::file_time_type::clock::now() - std::chrono::hours(24 * 8));
    const auto before = texts_of(work);
    WorkFolder::Cleaning cleaning{std::chrono::hours(24 * 7), true};
    auto cleaned = WorkFolder(work).clean(cleaning);
    CHECK(cleaned.removed == 3);
    CHECK(cleaned.kept == 1);
    CHECK(texts_of(work) == before);
    cleaning.dry_run = false;
    cleaned = WorkFolder(work).clean(cleaning);
    CHECK(cleaned.removed == 3);
    CHECK(cleaned.left == 0);
    CHECK(WorkFolder(work).entries().size() == 1);
    CHECK(WorkFolder(work).marked());
    CHECK(WorkFolder(work).clean({}).removed == 1);
    CHECK(!fs::exists(work));
}

TEST_CASE(
    "of several shots in a work folder, one alone is cleaned, and what serves several stays") {
    const Scratch scratch;
    const auto work = scratch / "work";
    WorkFolder(work).make();
    const auto registry = toy::registry();
    for (int n = 0; n < 6; ++n)
        REQUIRE(Cache(registry, work, 0)
                    .store(key_of(n), {{"shot", n < 4 ? "sh010" : "sh020"}},
                           {Payload(std::make_shared<toy::Number>(n))}));
    REQUIRE(
        Cache(registry, work)
            .store(key_of(9), {{"shot", "sh010"}}, {Payload(std::make_shared<toy::Number>(9))}));
    for (const std::string shot : {"sh010", "sh020"}) {
        put(work + "/runs/" + shot + ".host.12.34.json",
            R"({"pid": 1, "host": "a", "pipeline": "shots/)" + shot + R"(.yaml", "nodes": {}})");
        put(work + "/history/" + shot + ".json", R"({"sim": {"type": "toy.count", "version": 1}})");
        put(work + "/jobs/" + shot + ".1/job.json",
            R"({"pipeline": "shots/)" + shot + R"(.yaml", "engine": "local", "steps": []})");
    }
    const auto cleaned = WorkFolder(work).clean({.shot = "sh010"});
    CHECK(cleaned.removed == 7);
    CHECK(cleaned.apart == 6);
    CHECK(cleaned.left == 0);
    CHECK(WorkFolder(work).entries().size() == 3);
    for (const auto& [path, text] : texts_of(work)) CHECK(path.find("sh010") == std::string::npos);
    CHECK(WorkFolder(work).clean({.shot = "sh030"}).removed == 0);
    CHECK(WorkFolder(work).marked());
}

TEST_CASE(
    "trimming and cleaning remove what fluidcarve wrote, and nothing of others, wherever that lies "
    "and whatever it is called") {
    std::mt19937 random(5);
    const std::string hex = "0123456789abcdef";
    for (int round = 0; round < 100; ++round) {
        const Scratch scratch;
        const auto work = scratch / "work";
        WorkFolder(work).make();
        keep(work, 12);
        Packs(work + "/files").add(key_of(0), std::string("a hash"));
        put(work + "/runs/shot.host.12.34.json",
            R"({"pid": 1, "host": "a", "pipeline": "p", "nodes": {}})");
        put(work + "/history/shot.json", R"({"sim": {"type": "toy.count", "version": 1}})");
        const auto before = texts_of(work);
        // Of others: any name in any place, names of our form with other content, and what hidden
        // files there are.
        const auto part = [&] {
            return std::vector<std::string>{"",      "/cache",    "/files",    "/history",
                                            "/runs", "/cache/ab", "/files/cd", "/scans"}[random() %
                                                                                         8];
        };
        for (int n = 0; n < 30; ++n) {
            std::string name;
            for (int c = 0; c < 30; ++c) name += hex[random() % 16];
            const std::vector<std::string> names{
                name,    name + "ab.pack", name + "cd.open", "smoke.0001.vdb", ".hidden",
                "a.txt", "notes.json",     ".smoke.part",    ".a.b.part.vdb"};
            const auto path = work + part() + "/" + names[random() % names.size()];
            if (!before.contains(path)) put(path, "of somebody else " + std::to_string(n));
        }
        auto others = texts_of(work);
        for (const auto& [path, text] : before) others.erase(path);
        const auto registry = toy::registry();
        Cache cache(registry, work);
        CHECK(cache.trim(0).files == 12);
        CHECK(cache.trim(0).files == 0);
        const auto [removed, bytes, kept, apart, left] = WorkFolder(work).clean({});
        CHECK(bytes > 0);
        CHECK(kept == 0);
        CHECK(removed == 3);
        CHECK(left == others.size());
        auto now = texts_of(work);
        now.erase(work + "/CACHEDIR.TAG");
        CHECK(now == others);
    }
}

TEST_CASE("a cache that is off trims nothing, not even in the current folder") {
    const Scratch scratch;
    const auto work = scratch / "work", before = fs::current_path().string();
    WorkFolder(work).make();
    keep(work, 3);
    const auto registry = toy::registry();
    fs::current_path(work);
    const auto trimmed = Cache(registry, "").trim(0);
    fs::current_path(before);
    CHECK(trimmed.files == 0);
    CHECK(WorkFolder(work).entries().size() == 3);
}

TEST_CASE("a work folder without others' files is gone once it is clean") {
    const Scratch scratch;
    const auto work = scratch / "work";
    WorkFolder(work).make();
    keep(work, 3);
    CHECK(WorkFolder(work).clean({}).removed == 3);
    CHECK(!fs::exists(work));
    WorkFolder(work).make();
    keep(work, 3, true);
    CHECK(WorkFolder(work).entries().size() == 1);
    CHECK(WorkFolder(work).clean({}).removed == 1);
    CHECK(!fs::exists(work));
}

TEST_CASE("hashes of input files that nobody asked for in a month go") {
    const Scratch scratch;
    const auto work = scratch / "work";
    WorkFolder(work).make();
    Packs(work + "/files").add(key_of(0), std::string("a hash"));
    CHECK(WorkFolder(work).outdated().empty());
    for (const auto& [path, text] : texts_of(work + "/files"))
        fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(24 * 31));
    CHECK(WorkFolder(work).outdated().size() == 1);
    put(work + "/files/" + std::string(32, 'a') + ".pack", "of somebody else");
    CHECK(WorkFolder(work).clean({}).removed == 1);
    CHECK(texts_of(work + "/files").size() == 1);
}

TEST_CASE("nothing is removed from an unmarked folder, nor through a link") {
    const Scratch scratch;
    const auto bare = scratch / "bare", linked = scratch / "linked";
    keep(bare, 3);
    const auto registry = toy::registry();
    const auto kept = Cache(registry, bare).trim(0);
    CHECK(kept.files == 0);
    CHECK(kept.left > 0);
    CHECK(texts_of(bare).size() == 3);
    WorkFolder(linked).make();
    fs::create_directory_symlink(bare + "/cache", linked + "/cache");
    CHECK(WorkFolder(linked).fault() ==
          "'" + linked +
              "/cache' is a link: what it leads to may belong to others; make it a folder, or name "
              "another with --work");
    CHECK(Cache(registry, linked).trim(0).files == 0);
    CHECK(texts_of(bare).size() == 3);
}
