// Feeds the program files with faults, random and aimed: it may refuse them, but not crash, hang or
// ask for all memory.
//
//   build/fuzz [COUNT] [SEED] [--only NAME]
//       COUNT mutants of each kind, or a share of it; the same seed makes the same mutants
//   build/fuzz --corpus FOLDER                  writes the files of tests/fuzz/corpus anew
//
// A mutant that the program does not survive is kept in the current folder, with the call that
// shows it.

#include "tests/fuzz/campaigns.h"
#include "tests/fuzz/corpus.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <stdexcept>

using namespace fuzz;

namespace {

struct Options {
    std::size_t count = 2000;
    std::uint64_t seed = 1;
    std::string only, corpus;
};

Options options_of(const std::vector<std::string>& words) {
    Options out;
    std::size_t numbers = 0;
    for (auto word = words.begin(); word != words.end(); ++word) {
        if (const bool only = *word == "--only"; only || *word == "--corpus") {
            if (word + 1 == words.end()) throw std::runtime_error(*word + " needs a name");
            const auto option = *word++;
            (only ? out.only : out.corpus) = *word;
            continue;
        }
        std::uint64_t number = 0;
        const auto* const end = word->data() + word->size();
        if (const auto [stop, error] = std::from_chars(word->data(), end, number);
            error != std::errc{} || stop != end || numbers == 2)
            throw std::runtime_error(
                fmt::format("'{}' is not understood; usage: fuzz [COUNT] [SEED] [--only NAME] | "
                            "--corpus FOLDER",
                            *word));
        (numbers++ == 0 ? out.count : out.seed) = number;
    }
    return out;
}

/// @return whether the program survived all mutants
bool fuzz_all(const Options& options, const std::string& program, const Sources& sources) {
    std::vector<Score> scores;
    std::string names;
    for (const auto& campaign : campaigns(sources)) {
        names += " " + campaign.name;
        if (options.only.empty() || options.only == campaign.name)
            scores.push_back(run(campaign, program, options.count, options.seed));
    }
    if (scores.empty())
        throw std::runtime_error(
            fmt::format("there is no campaign '{}'; known:{}", options.only, names));
    fmt::print("{}", table(scores));
    std::size_t failed = 0;
    for (const auto& score : scores) failed += score.failed;
    return failed == 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto options = options_of({argv + 1, argv + argc});
        const std::string program = FLUIDCARVE_PROGRAM;
        const Scratch made;
        const auto sources = make_sources(program, made.path());
        if (options.corpus.empty()) return fuzz_all(options, program, sources) ? 0 : 1;
        write_corpus(options.corpus, sources);
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "failed: {}\n", error.what());
        return 2;
    }
}
