// Feeds the program files with random faults: it may refuse them, but not crash or hang.
//
//   build/fuzz [COUNT] [SEED]      2000 mutants of each kind; the same seed makes the same mutants
//
// A mutant that the program does not survive is kept in the current folder, with the call that shows it.

#include "tests/support/scratch.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

namespace fs = std::filesystem;

namespace {

constexpr double patience = 10;  // seconds
constexpr int hung = -1;
constexpr int signalled = 1000;  // and the signal

using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t end) { return end == 0 ? 0 : random() % end; }

/// Exit code, `hung`, or `signalled` and more.
int call(const std::vector<std::string>& arguments) {
    const auto child = fork();
    if (child == 0) {
        const int nowhere = open("/dev/null", O_RDWR);
        for (const int file : {0, 1, 2}) dup2(nowhere, file);
        std::vector<char*> words;
        for (const auto& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
        words.push_back(nullptr);
        execv(words[0], words.data());
        _exit(127);
    }
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience);
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (std::chrono::steady_clock::now() > end) {
            kill(child, SIGKILL);
            waitpid(child, &status, 0);
            return hung;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return WIFSIGNALED(status) ? signalled + WTERMSIG(status) : WEXITSTATUS(status);
}

/// Faults of a disk or a network: bits, bytes, numbers, pieces.
std::string damaged(std::string text, Random& random) {
    const auto count = 1 + below(random, 6);
    for (std::size_t n = 0; n < count && text.size() > 8; ++n) {
        // Half of all faults near the front, where the structure is.
        const auto at = below(random, random() % 2 ? text.size() - 8 : std::min<std::size_t>(text.size() - 8, 2000));
        const auto kind = below(random, 10);
        if (kind < 3) {
            text[at] = static_cast<char>(text[at] ^ (1 << below(random, 8)));
        } else if (kind < 5) {
            text[at] = static_cast<char>(random());
        } else if (kind < 8) {
            constexpr std::array<std::uint32_t, 6> numbers{0, 0xFFFFFFFF, 0x7FFFFFFF, 0x80000000, 0x10000, 0xFFFF};
            const auto number = numbers[below(random, numbers.size())];
            text.replace(at, 4, reinterpret_cast<const char*>(&number), 4);
        } else if (kind == 8) {
            const auto from = below(random, text.size()), length = std::min(below(random, 200), text.size() - std::max(at, from));
            text.replace(at, length, text.substr(from, length));
        } else if (random() % 2) {
            text.erase(at, below(random, 200));
        } else {
            text.insert(at, text.substr(below(random, text.size()), below(random, 200)));
        }
    }
    return text;
}

/// Slips of the hand in a pipeline, and malice.
std::string mistyped(std::string text, Random& random) {
    constexpr std::array pieces{"&a",          "*a",         "<<: *a",
                                "{",           "}",          "[",
                                "]",           "\t",         "\"",
                                "'",           ": ",         "\n",
                                "- ",          "!!x",        "%Y 1",
                                "---",         "...",        "\0",
                                "|\n",         "${count}",   "${}",
                                "#",           "9e999",      "-1000000000",
                                "nan",         "1-99999999", "~",
                                "? ",          "\xff\xfe",   "extends: plume.yaml\n",
                                "seams.seams", "sim",        "[[[[[[[[[[[[[[[["};
    const auto count = 1 + below(random, 5);
    for (std::size_t n = 0; n < count && text.size() > 8; ++n) {
        const auto at = below(random, text.size());
        const auto line = text.rfind('\n', at) + 1, next = text.find('\n', at);
        switch (random() % 6) {
            case 0: text.insert(at, pieces[below(random, pieces.size())]); break;
            case 1: text.erase(at, 1 + below(random, 12)); break;
            case 2: text.erase(line, next == std::string::npos ? next : next - line + 1); break;
            case 3: text.insert(line, text.substr(line, next == std::string::npos ? next : next - line + 1)); break;
            case 4: std::swap(text[at], text[below(random, text.size())]); break;
            default: text.replace(at, 1, pieces[below(random, pieces.size())]); break;
        }
    }
    return text;
}

struct Campaign {
    std::string name;
    std::size_t count;
    /// Makes mutant `n` in a folder and says the call, and what is wrong with its exit code; empty: nothing.
    std::function<std::vector<std::string>(std::size_t n, Random&, const Scratch&)> make;
    std::function<std::string(int code, const Scratch&)> judge;
};

std::string survived(int code) {
    if (code == hung) return "hangs";
    if (code >= signalled) return fmt::format("crashes with signal {}", code - signalled);
    return code == 0 || code == 2 || code == 3 ? "" : fmt::format("ends with exit code {}", code);
}

/// @return how many mutants failed
std::size_t run(const Campaign& campaign, std::uint64_t seed) {
    std::atomic<std::size_t> next{0}, failed{0};
    std::mutex mutex;
    std::map<int, std::size_t> codes;
    const auto work = [&] {
        for (std::size_t n; (n = next++) < campaign.count;) {
            const Scratch scratch;
            Random random(seed * 1000003 + n);
            const auto arguments = campaign.make(n, random, scratch);
            const int code = call(arguments);
            const auto fault = campaign.judge(code, scratch);
            const std::lock_guard lock(mutex);
            ++codes[code];
            if (fault.empty()) continue;
            ++failed;
            const auto kept = fmt::format("fuzz-{}-{}", campaign.name, n);
            fs::copy(scratch.path(), kept, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
            fmt::print("{} mutant {} {}: {} (kept in {})\n", campaign.name, n, fault, fmt::join(arguments, " "), kept);
        }
    };
    std::vector<std::thread> threads;
    for (unsigned n = 0; n < std::max(1U, std::thread::hardware_concurrency()); ++n) threads.emplace_back(work);
    for (auto& thread : threads) thread.join();
    fmt::print("{:<12} {} mutants, {} not survived; exit codes", campaign.name, campaign.count, failed.load());
    for (const auto& [code, times] : codes) fmt::print(" {}: {}", code, times);
    fmt::print("\n");
    return failed;
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t count = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 2000;
    const std::uint64_t seed = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
    const std::string program = FLUIDCARVE_PROGRAM;
    std::vector<std::string> volumes, pipelines;
    for (const auto* name : {"cortex_points", "gaffer_arnold_sphere", "oiio_sphereCd"})
        volumes.push_back(Scratch::read(fmt::format("{}/vdb/{}.vdb", TEST_DATA, name)));
    for (const auto& entry : fs::directory_iterator(SOURCE_ROOT "/pipelines"))
        if (entry.path().extension() == ".yaml") pipelines.push_back(Scratch::read(entry.path()));
    std::sort(pipelines.begin(), pipelines.end());

    // A mesh in each format, written by the program itself.
    const Scratch made;
    std::vector<std::pair<std::string, std::string>> meshes;
    const auto convert = [&](const Scratch& scratch, const std::string& from, const std::string& to) {
        return std::vector{
            program, std::string("run"),
            scratch.write("p.yaml", fmt::format("fluidcarve: 1\nnodes:\n  in: {{type: mesh.read, path: {}}}\n  out: {{type: mesh.write, source: in, "
                                                "path: {}}}\n",
                                                from, to))};
    };
    for (const std::string ending : {".obj", ".ply", ".off", ".stl"}) {
        call(convert(made, TEST_DATA "/bonfire/firepit.obj", made / ("m" + ending)));
        meshes.emplace_back("m" + ending, Scratch::read(made / ("m" + ending)));
    }

    const auto no_fault = [](int code, const Scratch&) { return survived(code); };
    std::size_t failed = 0;
    failed += run({"check", count,
                   [&](std::size_t n, Random& random, const Scratch& scratch) {
                       return std::vector{program, std::string("check"), scratch.write("p.yaml", mistyped(pipelines[n % pipelines.size()], random))};
                   },
                   no_fault},
                  seed);
    failed += run({"inspect", count,
                   [&](std::size_t n, Random& random, const Scratch& scratch) {
                       return std::vector{program, std::string("inspect"), scratch.write("v.vdb", damaged(volumes[n % volumes.size()], random))};
                   },
                   no_fault},
                  seed);
    failed += run({"mesh", count,
                   [&](std::size_t n, Random& random, const Scratch& scratch) {
                       const auto& [name, whole] = meshes[n % meshes.size()];
                       return convert(scratch, scratch.write(name, damaged(whole, random)), scratch / ("out" + meshes[below(random, meshes.size())].first));
                   },
                   no_fault},
                  seed);
    failed += run({"run", count / 10,
                   [&](std::size_t n, Random& random, const Scratch& scratch) {
                       const auto& whole = volumes[n % volumes.size()];
                       scratch.write("v.vdb", whole.substr(0, below(random, whole.size())));
                       const auto pipeline = scratch.write("p.yaml",
                                                           "fluidcarve: 1\nnodes:\n  in: {type: vdb.read, path: v.vdb}\n  out: {type: vdb.write, source: in, "
                                                           "path: " +
                                                               (scratch / "out.vdb") + "}\n");
                       return std::vector{program, std::string("run"), pipeline};
                   },
                   [](int code, const Scratch& scratch) {
                       if (fs::exists(scratch / "out.vdb")) return std::string("writes an output from a file that is cut off");
                       return code == 3 ? std::string() : fmt::format("is not refused: {}", code);
                   }},
                  seed);
    return failed == 0 ? 0 : 1;
}
