#include "graph/file_claims.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>

using namespace fluidcarve;
namespace fs = std::filesystem;

namespace {

using Earlier = std::vector<std::optional<std::size_t>>;

/// The same, by the paths of all frames.
Earlier by_frames(const std::vector<FileClaim>& claims, const std::vector<int>& frames) {
    Earlier out(claims.size());
    std::map<std::string, std::size_t> first;
    for (std::size_t n = 0; n < claims.size(); ++n)
        for (const auto frame : frames) {
            const auto [found, fresh] = first.emplace(claims[n].path.at(frame), n);
            if (!fresh && found->second != n && claims[n].writes && !out[n]) out[n] = found->second;
        }
    return out;
}

std::vector<int> frames_to(int last) {
    std::vector<int> out(static_cast<std::size_t>(last));
    std::iota(out.begin(), out.end(), 1);
    return out;
}

}  // namespace

TEST_CASE("claims meet where the paths of their frames do, whatever their patterns") {
    std::mt19937 random(3);
    const std::vector<std::string> parts{"#", "##", "1", "01", "-", ".", "a", "<frame>", "/b", "2"};
    for (int trial = 0; trial < 3000; ++trial) {
        std::vector<int> frames;
        for (int frame = -3; frame < 25; ++frame)
            if (random() % 2 == 0) frames.push_back(frame);
        if (frames.empty()) continue;
        std::vector<FileClaim> claims;
        for (std::size_t n = 0; n < 2 + random() % 3; ++n) {
            std::string text = "/nowhere/n";
            for (std::size_t part = 0; part < 1 + random() % 4; ++part)
                text += parts[random() % parts.size()];
            claims.push_back({PathPattern(text), n > 0});
        }
        INFO(claims[0].path.text() << " " << claims[1].path.text());
        CHECK(overwritten(claims, frames) == by_frames(claims, frames));
    }
}

TEST_CASE(
    "what a link leads to is read, too, over several links, and a circle of links leads nowhere") {
    const Scratch scratch;
    fs::create_directories(scratch / "real");
    fs::create_symlink("real/in.3", scratch / "near.3");
    fs::create_symlink(scratch / "near.3", scratch / "far.3");
    fs::create_symlink("round.3", scratch / "round.3");
    const auto over = [&](const std::string& read, const std::string& written) {
        return overwritten(
                   {{PathPattern(scratch / read), false}, {PathPattern(scratch / written), true}},
                   {1, 2, 3})[1]
            .has_value();
    };
    CHECK(over("far.#", "real/in.#"));
    CHECK(over("far.3", "real/in.#"));
    CHECK(over("far.#", "real/in.3"));
    CHECK_FALSE(over("far.#", "real/out.#"));
    CHECK_FALSE(over("round.#", "real/in.#"));
    fs::create_directory_symlink("real", scratch / "linked");
    CHECK(over("far.#", "linked/in.#"));
}

TEST_CASE("a path that is no pattern is taken as it is written") {
    CHECK(overwritten(
              {{PathPattern::literal("/nowhere/a.#"), false}, {PathPattern("/nowhere/a.#"), true}},
              {1, 2})[1] == std::nullopt);
    CHECK(overwritten(
              {{PathPattern::literal("/nowhere/a.2"), false}, {PathPattern("/nowhere/a.#"), true}},
              {1, 2})[1] == 0);
}

TEST_CASE("a million frames take no time where folders or names tell files apart") {
    const auto frames = frames_to(1'000'000);
    const auto begin = std::chrono::steady_clock::now();
    CHECK(overwritten({{PathPattern("/nowhere/in.####"), false},
                       {PathPattern("/nowhere/in.carved.####"), true},
                       {PathPattern("/elsewhere/in.####"), true}},
                      frames) == Earlier(3));
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(200));
}
