#include "tests/fuzz/campaign.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <thread>

namespace fuzz {
namespace {

namespace fs = std::filesystem;

std::string end_of(const Ended& ended) {
    return ended.hung ? "hung" : ended.signal ? "signal" : std::to_string(ended.code);
}

}  // namespace

Score run(const Campaign& campaign, const std::string& program, std::size_t count,
          std::uint64_t seed) {
    Score out{campaign.name,
              std::max<std::size_t>(
                  1, static_cast<std::size_t>(static_cast<double>(count) * campaign.share)),
              0,
              {},
              0};
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    const auto work = [&] {
        for (std::size_t n; (n = next++) < out.mutants;) {
            const Scratch scratch;
            constexpr std::uint64_t apart = 1000003;
            Random random(seed * apart + n);
            auto words = campaign.make(n, random, scratch);
            words.insert(words.begin(), program);
            auto ended = call(words, scratch.path());
            // On a busy machine a call may only have waited for its turn.
            constexpr double longer = 12 * patience;
            if (ended.hung) ended = call(words, scratch.path(), longer);
            auto fault = fault_of(ended);
            if (fault.empty() && campaign.judge) fault = campaign.judge(ended, scratch);
            const std::lock_guard lock(mutex);
            ++out.ends[end_of(ended)];
            out.slowest = std::max(out.slowest, ended.seconds);
            if (fault.empty()) continue;
            ++out.failed;
            const auto kept = fmt::format("fuzz-{}-{}-{}", campaign.name, seed, n);
            fs::copy(scratch.path(), kept,
                     fs::copy_options::recursive | fs::copy_options::overwrite_existing);
            fmt::print("{} mutant {} {}: cd {} && {}\n", campaign.name, n, fault, kept,
                       fmt::join(words, " "));
            std::fflush(stdout);
        }
    };
    std::vector<std::thread> threads;
    for (unsigned n = 0; n < std::max(1U, std::thread::hardware_concurrency()); ++n)
        threads.emplace_back(work);
    for (auto& thread : threads) thread.join();
    return out;
}

std::string table(const std::vector<Score>& scores) {
    auto out = fmt::format("{:<14} {:>8} {:>13} {:>10}  {}\n", "campaign", "mutants",
                           "not survived", "slowest", "ends, by exit code");
    for (const auto& score : scores) {
        std::vector<std::string> ends;
        for (const auto& [end, times] : score.ends)
            ends.push_back(fmt::format("{}: {}", end, times));
        out += fmt::format("{:<14} {:>8} {:>13} {:>8.2f} s  {}\n", score.name, score.mutants,
                           score.failed, score.slowest, fmt::join(ends, ", "));
    }
    return out;
}

}  // namespace fuzz
