#include "runtime/run/prerequisites.h"

#include "carve/base/words.h"
#include "runtime/run/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>

namespace fluidcarve {
namespace {

constexpr auto between_looks = std::chrono::milliseconds(500);

/// Why a node's results should exist, and what makes them; empty: they exist, or the run may make
/// them.
std::string lack_of(const Pipeline& pipeline, std::size_t n, const Plan& plan,
                    const NodeDemand& demand, const RunRequest& request) {
    const auto& node = pipeline.nodes[n];
    if (plan.targets[n] || plan.digested[n]) return {};
    const auto waited =
        request.wait ? fmt::format("after {} s of --wait, ", *request.wait) : std::string();
    if (request.target.only && demand.computed > 0 && node.kept)
        return fmt::format(
            "has no results in the work folder for {} of {}, {}and --only runs no other node; run "
            "--to {} first",
            demand.computed, counted(demand.needed, "frame"), waited, node.name);
    if (!request.wait) return {};
    const auto lack = [&](const char* what, std::size_t frames) {
        return fmt::format(
            "{} {} of {} are not in the work folder '{}', {}and --wait leaves them to other runs; "
            "run --to {} first",
            what, frames, counted(std::max(demand.needed, demand.gathered()), "frame"),
            request.options.work_folder, waited, node.name);
    };
    if (digests_apart(node) && demand.consumed_inputs > 0)
        return lack("the data of", demand.consumed_inputs);
    if (gathers_apart(node) && demand.computed > 0) return lack("the results of", demand.computed);
    return {};
}

std::vector<NodeFailure> missing_in(const Pipeline& pipeline, const Plan& plan,
                                    const std::vector<NodeDemand>& demands,
                                    const RunRequest& request) {
    std::vector<NodeFailure> out;
    for (std::size_t n = 0; n < demands.size(); ++n)
        if (const auto lack = lack_of(pipeline, n, plan, demands[n], request); !lack.empty())
            out.push_back(failure_in(pipeline.nodes[n], std::nullopt, lack, Failure::Kind::input));
    return out;
}

}  // namespace

std::string fault_of_task_folder(const RunRequest& request,
                                 const std::function<bool()>& cancelled) {
    const auto folder = job_folder(request.options.work_folder, request.task->job);
    std::error_code error;
    const auto start = std::chrono::steady_clock::now();
    while (!std::filesystem::exists(folder, error)) {
        if (cancelled() || std::chrono::steady_clock::now() - start >
                               std::chrono::duration<double>(request.wait.value_or(0)))
            break;
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    if (std::filesystem::exists(folder, error)) return {};
    return fmt::format(
        "--task {}: there is no folder {}; share the work folder with this machine, or make the "
        "job again if it was cleaned",
        request.task->text(), folder);
}

Prerequisites wait_for_prerequisites(const Pipeline& pipeline, Preparation& prepared,
                                     const RunRequest& request,
                                     const std::function<bool()>& cancelled) {
    using Clock = std::chrono::steady_clock;
    constexpr double longest = 1e9;  // seconds; more would overflow the clock
    const auto end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                           std::min(request.wait.value_or(0), longest)));
    while (true) {
        Prerequisites out{prepared.schedule(), {}, {}};
        out.demands = prepared.demands(out.schedule);
        out.missing = missing_in(pipeline, prepared.plan(), out.demands, request);
        if (const auto fault = prepared.cache().read_fault(); !fault.empty())
            for (auto& failure : out.missing)
                failure.message =
                    "nothing tells whether its results are in the work folder: " + fault;
        if (out.missing.empty() || cancelled() || Clock::now() >= end) return out;
        std::this_thread::sleep_for(between_looks);
        prepared.cache().look_again();
    }
}

}  // namespace fluidcarve
