// Lets each call of the system fail in small runs of the program, one call in each run, and looks
// at what is left: faults [--quick] [--job NAME] [--kind KIND] [--at N]
// A run must not be ended by a signal, nor hang. It ends with 0 only if all of its files are there
// and right. Each of its outputs is whole or not there. Files of others stay. Without the fault,
// the same command then finishes with the same files.

#include "tests/faults/jobs.h"
#include "tests/fuzz/call.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

namespace {

namespace fs = std::filesystem;
using faults::Job;
using Files = std::map<std::string, std::string>;  ///< names and bytes

const std::vector<std::string> all_kinds{"open",   "read",  "write", "fsync",
                                         "rename", "close", "mmap",  "allocation"};

/// Of allocations, of which there are ten thousands, only so many fail, evenly spread.
constexpr unsigned long most_allocations = 300;
/// Calls of a kind that fail in each job in a quick round.
constexpr unsigned long most_quick = 1;

struct Choice {
    bool quick = false;
    std::string job, kind;
    unsigned long at = 0;
};

/// The files in `out/` of a folder. The first bytes of a volume are different in each: its UUID.
Files files_in(const std::string& folder) {
    constexpr std::size_t uuid = 21, uuid_bytes = 36;
    Files out;
    for (const auto& each : fs::directory_iterator(folder + "/out")) {
        auto bytes = Scratch::read(each.path().string());
        if (each.path().extension() == ".vdb" && bytes.size() > uuid + uuid_bytes)
            bytes.replace(uuid, uuid_bytes, uuid_bytes, '-');
        out[each.path().filename().string()] = std::move(bytes);
    }
    return out;
}

bool is_aside(const std::string& name) {
    return name.starts_with('.') && name.find(".part") != std::string::npos;
}

/// A call of a job's command by a shell, with variables of the shim in front.
fuzz::Ended call(const std::string& command, const std::string& folder,
                 const std::string& variables) {
    auto text = command;
    if (const auto at = text.find("{}"); at != std::string::npos)
        text.replace(at, 2,
                     variables.empty() ? FLUIDCARVE_PROGRAM
                                       : fmt::format("env LD_PRELOAD={} {} {}", FAULT_SHIM,
                                                     variables, FLUIDCARVE_PROGRAM));
    // The shell only starts the program: its code is the program's, and above 128 for a signal.
    auto out = fuzz::call({"/bin/sh", "-c",
                           "unset FLUIDCARVE_NO_CACHE FLUIDCARVE_MEMORY FLUIDCARVE_THREADS; export "
                           "FLUIDCARVE_WORK=work; exec " +
                               text},
                          folder, 60);
    if (out.code > 128 && out.code != 130) out.signal = out.code - 128;
    return out;
}

/// A furnished folder in which the earlier commands of a job have run.
struct Place {
    explicit Place(const Job& job) {
        faults::furnish(scratch.path());
        for (const auto& each : job.before) call(each, scratch.path(), "");
        former = files_in(scratch.path());
    }
    Scratch scratch;
    Files former;
};

/// What a job makes when nothing fails.
struct Reference {
    explicit Reference(const Job& job) {
        for (int round = 0; round < 2; ++round) {
            const Place place(job);
            const auto ended =
                call(job.command, place.scratch.path(), round == 0 ? "" : "FAULT_COUNT=counts");
            if (ended.code != 0)
                fault =
                    fmt::format("without a fault it ends with {}: {}", ended.code, ended.errors);
            const auto made = files_in(place.scratch.path());
            for (const auto& [name, bytes] : made) {
                if (round == 1 && files.contains(name) && files[name] != bytes)
                    changing.insert(name);
                files[name] = bytes;
            }
            std::ifstream in(place.scratch / "counts");
            for (std::string kind; in >> kind;) in >> calls[kind];
        }
        if (calls.empty() && fault.empty()) fault = "the shim counts nothing";
    }
    Files files;
    std::set<std::string> changing;  ///< files with times in them, which differ from run to run
    std::map<std::string, unsigned long> calls;  ///< by kind
    std::string fault;

    /// Whether a file is as it should be; a report, also of a run that failed, is to be whole.
    bool right(const std::string& name, const std::string& bytes) const {
        const auto found = files.find(name);
        if (found == files.end()) return false;
        return changing.contains(name) ? !bytes.empty() && bytes.back() == found->second.back()
                                       : bytes == found->second;
    }
};

/// What is wrong with the files of a run that ended. @param done  whether all must be there
std::string fault_of_files(const Place& place, const Reference& reference, bool done) {
    const auto now = files_in(place.scratch.path());
    for (const auto& [name, bytes] : now) {
        if (is_aside(name) && done) return fmt::format("{} is left over", name);
        if (is_aside(name)) continue;
        const auto former = place.former.find(name);
        const bool same = former != place.former.end() && former->second == bytes;
        if (!reference.right(name, bytes) && (done || !same))
            return fmt::format("{} is wrong", name);
    }
    for (const auto& [name, bytes] : reference.files)
        if (done && !now.contains(name)) return fmt::format("{} is missing", name);
    for (const auto& [name, bytes] : place.former)
        if (!now.contains(name)) return fmt::format("{} was there, and is gone", name);
    return {};
}

/// What is wrong after a call failed; empty: nothing.
std::string fault_of(const Job& job, const Reference& reference, const std::string& kind,
                     unsigned long at) {
    const Place place(job);
    Files foreign;
    for (const auto& name : faults::foreign_files())
        foreign[name] = Scratch::read(place.scratch / name);
    const auto foreign_fault = [&] {
        for (const auto& [name, bytes] : foreign)
            if (Scratch::read(place.scratch / name) != bytes)
                return fmt::format("{} of others is gone or changed", name);
        return std::string();
    };
    const auto ended =
        call(job.command, place.scratch.path(), fmt::format("FAULT_KIND={} FAULT_AT={}", kind, at));
    if (ended.hung) return "it hangs";
    if (ended.signal)
        return fmt::format("it is ended by signal {}: {}", ended.signal, ended.errors);
    if (auto fault = fault_of_files(place, reference, ended.code == 0); !fault.empty())
        return fmt::format("it ends with {}, but {}", ended.code, fault);
    if (auto fault = foreign_fault(); !fault.empty()) return fault;
    if (ended.errors.find("fault of fluidcarve itself") != std::string::npos)
        return "it calls the fault its own: " + ended.errors;
    if (ended.code != 0 && ended.errors.empty())
        return fmt::format("it ends with {} and says nothing", ended.code);
    if (ended.code == 0 && !job.then.empty())
        if (const auto after = call(job.then, place.scratch.path(), ""); after.code != 0)
            return fmt::format(
                "it ends with 0, but the next command does not find what it was to keep, and ends "
                "with {}: {}",
                after.code, after.errors);

    const auto again = call(job.command, place.scratch.path(), "");
    if (again.code != 0)
        return fmt::format("the fault is over, but the command ends with {}: {}", again.code,
                           again.errors);
    if (auto fault = fault_of_files(place, reference, true); !fault.empty())
        return "the fault is over, but " + fault;
    return foreign_fault();
}

/// The calls of a kind that are to fail, of `count`.
std::vector<unsigned long> chosen(const Choice& choice, const std::string& kind,
                                  unsigned long count, unsigned long shift) {
    if (choice.at > 0) return {choice.at};
    const auto most = choice.quick ? most_quick : kind == "allocation" ? most_allocations : count;
    std::vector<unsigned long> out;
    for (unsigned long n = 0; n < std::min(most, count); ++n)
        out.push_back(1 + (n * count / std::min(most, count) + (choice.quick ? shift : 0)) % count);
    return out;
}

Choice read(int argc, char** argv) {
    Choice out;
    for (int n = 1; n < argc; ++n) {
        const std::string word = argv[n];
        const auto value = [&] { return std::string(n + 1 < argc ? argv[++n] : ""); };
        if (word == "--quick") out.quick = true;
        else if (word == "--job") out.job = value();
        else if (word == "--kind") out.kind = value();
        else if (word == "--at") out.at = std::strtoul(value().c_str(), nullptr, 10);
        else
            fmt::print(stderr, "faults [--quick] [--job NAME] [--kind KIND] [--at N]\n"),
                std::exit(2);
    }
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    const auto choice = read(argc, argv);
    std::map<std::string, unsigned long> failed;
    unsigned long findings = 0, shift = 0;
    for (const auto& job : faults::jobs()) {
        if (!choice.job.empty() && choice.job != job.name) continue;
        const Reference reference(job);
        if (!reference.fault.empty()) {
            fmt::print("{}: {}\n", job.name, reference.fault);
            ++findings;
            continue;
        }
        for (const auto& kind : all_kinds) {
            const auto count = reference.calls.at(kind);
            // OpenVDB and TBB do not survive each allocation that fails: a quick round leaves them
            // out.
            if ((!choice.kind.empty() && choice.kind != kind) || count == 0 ||
                (choice.quick && kind == "allocation"))
                continue;
            shift += 7919;
            for (const auto at : chosen(choice, kind, count, shift)) {
                ++failed[kind];
                const auto fault = fault_of(job, reference, kind, at);
                if (fault.empty()) continue;
                ++findings;
                fmt::print("faults --job '{}' --kind {} --at {}: {}\n", job.name, kind, at, fault);
                std::fflush(stdout);
            }
        }
        fmt::print(
            "{}: {} open, {} read, {} write, {} fsync, {} rename, {} close, {} mmap, {} "
            "allocation\n",
            job.name, reference.calls.at("open"), reference.calls.at("read"),
            reference.calls.at("write"), reference.calls.at("fsync"), reference.calls.at("rename"),
            reference.calls.at("close"), reference.calls.at("mmap"),
            reference.calls.at("allocation"));
        std::fflush(stdout);
    }
    fmt::print("failed calls:");
    for (const auto& [kind, count] : failed) fmt::print(" {} {}", kind, count);
    fmt::print("\nfindings: {}\n", findings);
    return findings == 0 ? 0 : 1;
}
