#include "tools/verbs/verbs.h"

#include "carve/base/failure.h"
#include "carve/base/frame_set.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "runtime/tell/exit_codes.h"
#include "tools/compare/comparers.h"
#include "tools/compare/comparison.h"
#include "tools/compare/file_comparer.h"
#include "tools/verbs/print.h"

#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

/// What `diff` is asked for.
struct DiffRequest {
    std::string a, b;                   ///< files, paths with frame tokens, or folders
    std::optional<std::string> frames;  ///< `-f`: compare only these; nothing: all that are there
    Tolerance tolerance;
    double fail_percent = 0;  ///< share of a part's values in a frame that may differ by more than
                              ///< the tolerance, percent
    std::string picture;      ///< PNG of the greatest difference; empty: none
    int threads = 1;
    std::uint64_t memory = 0;  ///< bytes that a grid may take
    bool json = false;
};

/// Arguments of the verb `diff`.
struct DiffArguments {
    std::string frames;
    DiffRequest request;
    const CLI::Option* frames_option = nullptr;

    void declare(CLI::App& verb);

    DiffRequest read();
};

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A fault of the command line.
class WrongUse : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

bool is_folder(const std::string& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

/// Two sequences, or files, that are compared.
struct DiffPair {
    SequenceComparison comparison;
    const FileComparer* comparer = nullptr;

    FilePair files(int frame) const {
        return {comparison.a.path.at(frame), comparison.b.path.at(frame)};
    }
};

/// A frame of a pair: what is found, or why nothing is.
struct DiffFrame {
    std::size_t pair = 0;
    int frame = 0;
    std::vector<PartDifference> found;
    std::string fault;
};

/// The verb at work.
class Diff {
public:
    Diff(const DiffRequest& request)
        : request_(request), thresholds_{request.tolerance, request.fail_percent} {}

    int run() {
        check();
        if (is_folder(request_.a)) match_folders();
        else match(named(request_.a), named(request_.b));
        compare();
        auto verdict = alone_.empty() ? Verdict::same : Verdict::different;
        for (const auto& pair : pairs_) verdict = std::max(verdict, pair.comparison.verdict());
        tell(verdict);
        if (!request_.picture.empty()) draw();
        if (!faults_.empty()) return exit_code::input;
        return verdict == Verdict::different ? exit_code::differs : exit_code::done;
    }

private:
    void check() {
        const auto& [absolute, relative, warn] = request_.tolerance;
        if (std::isfinite(warn) && warn > absolute)
            throw WrongUse(
                fmt::format("--warn {:g} is above --fail {:g}: what it would warn of fails; give "
                            "--fail a greater number",
                            warn, absolute));
        if (!request_.picture.empty() && ending_of(request_.picture) != ".png")
            throw WrongUse(fmt::format(
                "--picture writes PNG: name a file that ends in .png, not {}", request_.picture));
        if (is_folder(request_.a) != is_folder(request_.b))
            throw WrongUse(fmt::format(
                "{} is a folder, but {} is not; name two folders, two sequences or two files",
                is_folder(request_.a) ? request_.a : request_.b,
                is_folder(request_.a) ? request_.b : request_.a));
        if (!request_.frames) return;
        std::string fault;
        wanted_ = FrameSet::parse(*request_.frames, fault);
        if (!wanted_) throw WrongUse("-f: " + fault);
    }

    static FileSequence named(const std::string& argument) {
        const auto out = [&] {
            try {
                return named_sequence(argument);
            } catch (const Failure& failure) {
                if (failure.kind == Failure::Kind::input) throw;
                throw WrongUse(failure.what());
            }
        }();
        if (out.frames.frames().empty())
            throw Failure(fmt::format("{}: there is no file of any frame", argument),
                          Failure::Kind::input);
        return out;
    }

    const FileComparer* comparer_of(const std::string& path) const {
        const auto ending = ending_of(path);
        for (const auto& comparer : comparers())
            if (std::ranges::find(comparer.endings, ending) != comparer.endings.end())
                return &comparer;
        return nullptr;
    }

    void match(const FileSequence& a, const FileSequence& b) {
        const auto* const comparer = comparer_of(a.path.text());
        std::vector<std::string> endings;
        for (const auto& each : comparers())
            endings.insert(endings.end(), each.endings.begin(), each.endings.end());
        for (const auto* const path : {&a.path.text(), &b.path.text()})
            if (!comparer_of(*path))
                throw WrongUse(
                    fmt::format("diff compares files that end in {}, and folders of them, not {}",
                                fmt::join(endings, ", "), *path));
        if (comparer_of(b.path.text()) != comparer)
            throw WrongUse(fmt::format("{} and {} are files of different kinds", a.path.text(),
                                       b.path.text()));
        if (a.per_frame() != b.per_frame())
            throw WrongUse(fmt::format(
                "{} is a sequence, but {} is one file; name two sequences or two files",
                (a.per_frame() ? a : b).path.text(), (a.per_frame() ? b : a).path.text()));
        if (wanted_ && !a.per_frame())
            throw WrongUse(fmt::format("-f is for sequences; {} has no frame token such as ####",
                                       a.path.text()));
        DiffPair pair{{a, b, {}, {}, {}, {}}, comparer};
        const auto &in_a = a.frames.frames(), &in_b = b.frames.frames();
        std::vector<int> both, only_a, only_b;
        std::set_intersection(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                              std::back_inserter(both));
        std::set_difference(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                            std::back_inserter(only_a));
        std::set_difference(in_b.begin(), in_b.end(), in_a.begin(), in_a.end(),
                            std::back_inserter(only_b));
        if (!wanted_) {
            pair.comparison.only_a = FrameSet(std::move(only_a));
            pair.comparison.only_b = FrameSet(std::move(only_b));
        }
        // A frame that is asked for and not there can't be read, and is reported as such.
        pair.comparison.frames = wanted_ ? *wanted_ : FrameSet(std::move(both));
        for (const int frame : pair.comparison.frames.frames())
            frames_.push_back({pairs_.size(), frame, {}, {}});
        pairs_.push_back(std::move(pair));
    }

    void match_folders() {
        std::size_t others = 0;
        const auto wanted = [&](const std::string& path) { return comparer_of(path) != nullptr; };
        const auto in_a = sequences_in(request_.a, wanted, others),
                   in_b = sequences_in(request_.b, wanted, others);
        const auto name = [](const FileSequence& sequence) {
            return fs::path(sequence.path.text()).filename().string();
        };
        const auto find = [&](const std::vector<FileSequence>& among, const FileSequence& wanted) {
            return std::ranges::find_if(
                among, [&](const auto& each) { return name(each) == name(wanted); });
        };
        for (const auto& [folder, all] :
             {std::pair(request_.a, &in_a), std::pair(request_.b, &in_b)})
            if (all->empty())
                throw Failure(fmt::format("{} holds no file that diff compares", folder),
                              Failure::Kind::input);
        for (const auto& sequence : in_a)
            if (const auto other = find(in_b, sequence); other != in_b.end())
                match(sequence, *other);
            else alone_.emplace_back("A", sequence.text());
        for (const auto& sequence : in_b)
            if (find(in_a, sequence) == in_a.end()) alone_.emplace_back("B", sequence.text());
    }

    DiffFrame& compare(DiffFrame& at) const {
        const auto& pair = pairs_[at.pair];
        try {
            at.found =
                pair.comparer->compare(pair.files(at.frame), request_.tolerance, request_.memory);
        } catch (const std::bad_alloc&) {
            at.fault =
                fmt::format("{}: there is not enough memory to compare it", pair.files(at.frame).a);
        } catch (const std::exception& error) {
            at.fault = error.what();
        }
        return at;
    }

    void compare() {
        const auto threads = static_cast<std::size_t>(request_.threads);
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        std::size_t next = 0;
        const auto feed = tbb::make_filter<void, DiffFrame*>(
            tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) -> DiffFrame* {
                if (next == frames_.size()) return control.stop(), nullptr;
                return &frames_[next++];
            });
        // Isolated: a thread that waits for a part of its frame must not begin another frame.
        const auto work = tbb::make_filter<DiffFrame*, DiffFrame*>(
            tbb::filter_mode::parallel, [&](DiffFrame* at) {
                return tbb::this_task_arena::isolate([&] { return &compare(*at); });
            });
        const auto gather = tbb::make_filter<DiffFrame*, void>(
            tbb::filter_mode::serial_in_order, [&](DiffFrame* at) {
                if (at->fault.empty())
                    pairs_[at->pair].comparison.add(at->frame, at->found, thresholds_);
                else faults_.push_back(at->fault);
                at->found = {};
            });
        tbb::parallel_pipeline(threads, feed & work & gather);
    }

    void tell(Verdict verdict) const {
        Json all{{"a", request_.a}, {"b", request_.b}, {"result", name_of(verdict)}};
        all["sequences"] = Json::array();
        all["alone"] = Json::array();
        all["failures"] = faults_;
        std::string text;
        for (const auto& pair : pairs_) {
            text += to_text(pair.comparison, thresholds_);
            all["sequences"].push_back(to_json(pair.comparison));
        }
        for (const auto& [side, sequence] : alone_) {
            text += fmt::format("only in {}: {}\n", side, sequence);
            all["alone"].push_back({{"in", side}, {"path", sequence}});
        }
        if (request_.json) print_json(all);
        else print(text);
        std::fflush(stdout);
        for (const auto& fault : faults_) complain(fmt::format("failed: {}\n", one_line(fault)));
    }

    void draw() const {
        const DiffPair* from = nullptr;
        const PartComparison* worst = nullptr;
        for (const auto& pair : pairs_)
            for (const auto& part : pair.comparison.parts)
                if (pair.comparer->draw && part.sums.worst &&
                    (!worst || part.sums.peak > worst->sums.peak))
                    from = &pair, worst = &part;
        if (!worst)
            return complain(fmt::format("{} is not written: no values of grids or images differ\n",
                                        request_.picture));
        const bool per_frame = from->comparison.per_frame();
        // One file is that of frame 1, which it has by any number.
        const auto files = from->files(per_frame ? worst->worst_frame : 1);
        for (const auto* const path : {&files.a, &files.b}) {
            std::error_code ignored;
            if (fs::equivalent(*path, request_.picture, ignored))
                throw WrongUse(fmt::format("--picture would overwrite {}", *path));
        }
        const auto title = fmt::format("{}: peak {:.4g}, {}", worst->sums.name, worst->sums.peak,
                                       place_of(*worst, per_frame));
        from->comparer->draw(files, worst->sums, title, request_.picture);
    }

    const DiffRequest& request_;
    Thresholds thresholds_;
    std::optional<FrameSet> wanted_;
    std::vector<DiffPair> pairs_;
    std::vector<DiffFrame> frames_;
    /// "A" or "B", and what the other folder lacks.
    std::vector<std::pair<std::string, std::string>> alone_;
    std::vector<std::string> faults_;
};

void DiffArguments::declare(CLI::App& verb) {
    request.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const auto number = [&](const char* name, double& value, const char* doc) {
        verb.add_option(name, value, doc)->check(CLI::NonNegativeNumber);
    };
    for (const auto& [name, path] : {std::pair("a", &request.a), std::pair("b", &request.b)})
        verb.add_option(name, *path, "A file, a sequence such as smoke.####.vdb, or a folder")
            ->required()
            ->type_name(name[0] == 'a' ? "A" : "B");
    frames_option = verb.add_option("-f,--frames", frames,
                                    "Compare only these frames (default: all that are there)")
                        ->type_name("FRAMES");
    number("--fail", request.tolerance.absolute,
           "The difference of two values that still passes (default: 0)");
    number("--relative", request.tolerance.relative,
           "The same, as a share of the greater value; the greater of both counts "
           "(default: 0)");
    number("--fail-percent", request.fail_percent,
           "The percentage of a grid's voxels in a frame that may differ by more (default: 0)");
    number("--warn", request.tolerance.warn,
           "Count the values that differ by more than this, at most --fail, and warn of them");
    verb.add_option("--picture", request.picture,
                    "Draw slices of A, B and their difference through the voxel that differs most")
        ->type_name("FILE.png");
    verb.add_option("--threads", request.threads,
                    "Threads, and frames compared at once (default: all cores)")
        ->check(CLI::Range(1, 4096))
        ->envname("FLUIDCARVE_THREADS");
    verb.add_flag("--json", request.json, "Print as JSON");
}

DiffRequest DiffArguments::read() {
    if (frames_option->count() > 0) request.frames = frames;
    request.memory = half_of_memory();
    return request;
}

/// The verb `diff`: compares two sequences frame by frame, several frames at once, each part of
/// their files by its name. Prints what differs to stdout, and errors to stderr. The output does
/// not depend on the number of threads.
/// @return an exit code: exit_code::done, exit_code::differs, or that of an error
int diff_files(const DiffRequest& request) {
    try {
        return Diff(request).run();
    } catch (const WrongUse& fault) {
        return end_with(fault.what());
    } catch (const Failure& failure) {
        return end_with(fmt::format("failed: {}", one_line(failure.what())),
                        exit_code::of(failure));
    }
}

}  // namespace

Verb::Work diff_verb(CLI::App& verb, Program&) {
    const auto arguments = std::make_shared<DiffArguments>();
    arguments->declare(verb);
    return [=] { return diff_files(arguments->read()); };
}

}  // namespace fluidcarve
