#include "nodes/solving/solve_task.h"

#include "carve/solver/task/no_more.h"
#include "carve/solver/task/part_finder.h"
#include "carve/solver/task/task_bounds.h"
#include "nodes/solving/report.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <utility>

namespace fluidcarve {

namespace {

using Clock = std::chrono::steady_clock;

/// A running search: its progress, and the time of the last Context::checkpoint.
class TaskSearch {
public:
    TaskSearch(EnergyVolume& energy, const SearchSetup& setup, const Context& context)
        : task_(setup.task),
          setup_(setup),
          context_(context),
          parts_(energy, setup.task, setup.space, setup.find, context.limits()) {}

    ReportedSeams run() {
        const auto [pairs, found] =
            find_parts(task_, [&](const SeamPart& part, int count, const FoundSeams& found_pairs) {
                return find(part, count, found_pairs);
            });
        auto out = whole(found, pairs);
        if (static_cast<int>(found.seams.size()) == task_.count) return out;
        out = out.first(found.seams.size());
        const auto& part = found.no_more ? task_.seams : *task_.pairs;
        set_shortfall(out.report, static_cast<std::size_t>(task_.asked),
                      where_no_more(found.no_more ? *found.no_more : *pairs.no_more, task_, part,
                                    setup_.space));
        return out;
    }

private:
    /// A part's share of the work of this search, 0 to 1: its share of the missing seams.
    double share_of(const SeamPart& part) const {
        if (!task_.pairs) return 1;
        const auto left = [&](bool pair) {
            const auto& before = setup_.before.seams;
            return std::max(0, task_.count - static_cast<int>(!before ? 0
                                                              : pair  ? before->pairs.size()
                                                                      : before->seams.size()));
        };
        const int all = left(true) + left(false);
        return all > 0 ? static_cast<double>(left(part.pair)) / all : 0;
    }

    /// @param pairs  found before
    FoundSeams find(const SeamPart& part, int count, const FoundSeams& pairs) {
        const double share = share_of(part);
        const auto tick = [&](double fraction) {
            context_.check_cancelled();
            context_.progress(done_ + share * fraction);
        };
        SearchOptions options;
        if (const auto& before = setup_.before.seams)
            options.before = part.pair ? before->pairs : before->seams;
        options.start_from = setup_.start_from;
        options.found = [&](const FoundSeams& now) {
            // After the last seam, the whole set is delivered anyway.
            if (part.pair || now.seams.size() < static_cast<std::size_t>(count))
                checkpoint(now, part, pairs);
        };
        options.best_effort = setup_.best_effort;
        options.thick = setup_.thick;
        TaskBounds bounds(setup_.bound_passes, static_cast<int>(options.before.size()),
                          [&] { context_.check_cancelled(); },
                          {parts_.memory(), context_.limits().folder});
        options.bounds = &bounds;
        auto out = parts_(part, count, tick, std::move(options));
        done_ += share;
        return out;
    }

    /// Delivers the seams found so far as a complete set.
    void checkpoint(const FoundSeams& now, const SeamPart& part, const FoundSeams& pairs) {
        if (Clock::now() - last_checkpoint_ < setup_.checkpoint_after) return;
        const auto so_far = part.pair ? only_pairs(now) : whole(now, pairs);
        context_.report("seams", so_far.report);
        context_.checkpoint(Payload(so_far.seams));
        last_checkpoint_ = Clock::now();
    }

    /// The set while its second seams are searched. These come first, so there may be more of them
    /// than of first seams, which are those of an earlier search.
    ReportedSeams only_pairs(const FoundSeams& pairs) const {
        const auto& before = setup_.before;
        auto set = std::make_shared<Seams>(setup_.empty);
        if (before.seams) set->seams = before.seams->seams;
        set->pairs = pairs.seams;
        auto report = before.seams ? before.report : empty_report(*set);
        describe_seams(pairs, "pair_", setup_.marks, report);
        report["wall_s"] = wall_seconds(before.report, pairs, {});
        return {std::move(set), std::move(report)};
    }

    /// The set with all its pairs.
    ReportedSeams whole(const FoundSeams& found, const FoundSeams& pairs) const {
        auto set = std::make_shared<Seams>(setup_.empty);
        set->seams = found.seams;
        set->pairs = pairs.seams;
        set->find_shifts();
        auto report = empty_report(*set);
        if (task_.finest > 1) report["finest"] = task_.finest;
        if (set->thick()) report["thickness"] = set->thickness;
        describe_seams(found, "", setup_.marks, report);
        if (task_.pairs) describe_seams(pairs, "pair_", setup_.marks, report);
        report["wall_s"] = wall_seconds(setup_.before.report, pairs, found);
        return {std::move(set), std::move(report)};
    }

    const SeamTask& task_;
    const SearchSetup& setup_;
    const Context& context_;
    const PartFinder parts_;
    double done_ = 0;  ///< share of the work, 0 to 1
    Clock::time_point last_checkpoint_ = Clock::now();
};

}  // namespace

ReportedSeams solve_task(EnergyVolume& energy, const SearchSetup& setup, const Context& context) {
    return TaskSearch(energy, setup, context).run();
}

}  // namespace fluidcarve
