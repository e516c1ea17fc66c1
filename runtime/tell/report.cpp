#include "runtime/tell/report.h"

#include "carve/base/numbers.h"
#include "carve/base/one_line.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <algorithm>
#include <tuple>

namespace fluidcarve {

std::string to_text(const NodeFailure& failure) {
    return fmt::format("{} ({}){}: {}", failure.node, failure.type,
                       failure.frame ? fmt::format(", frame {}", *failure.frame) : std::string(),
                       one_line(failure.message));
}

namespace {

/// Sorts the fields of an entry with a field per frame by frame number. Returns any other entry
/// unchanged.
nlohmann::ordered_json in_order(const nlohmann::ordered_json& entry) {
    std::map<int, nlohmann::ordered_json> frames;
    if (entry.is_object())
        for (const auto& [name, value] : entry.items()) {
            const auto frame = number_of<int>(name);
            if (!frame) return entry;
            frames[*frame] = value;
        }
    if (frames.empty()) return entry;
    auto out = nlohmann::ordered_json::object();
    for (const auto& [frame, value] : frames) out[std::to_string(frame)] = value;
    return out;
}

}  // namespace

Report::Report(const Pipeline& pipeline) : pipeline_(pipeline), stats_(pipeline.nodes.size()) {}

void Report::expect(std::vector<NodeDemand> demands) {
    const std::lock_guard lock(mutex_);
    if (demands_.empty()) demands_ = std::move(demands);
}

void Report::ran(std::size_t node, std::size_t t, double seconds, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    auto& stats = stats_[node];
    stats.computed.insert(t);
    stats.frame_s += seconds;
    stats.most_bytes = std::max(stats.most_bytes, bytes);
}

void Report::consumed(std::size_t node, std::size_t t, double seconds, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    auto& stats = stats_[node];
    stats.consumed.insert(t);
    stats.consume_s += seconds;
    stats.most_bytes = std::max(stats.most_bytes, bytes);
}

void Report::gathered(std::size_t node, std::size_t t) {
    const std::lock_guard lock(mutex_);
    stats_[node].gathered.insert(t);
}

void Report::grew(std::size_t node, std::size_t items, std::size_t of) {
    const std::lock_guard lock(mutex_);
    stats_[node].items = items;
    stats_[node].of_items = of;
}

void Report::ended(std::size_t node, double seconds, std::uint64_t bytes, bool good) {
    const std::lock_guard lock(mutex_);
    auto& stats = stats_[node];
    stats.finished = good;
    stats.once_s += seconds;
    stats.most_bytes = std::max(stats.most_bytes, bytes);
}

void Report::holds(std::size_t node, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    stats_[node].most_bytes = std::max(stats_[node].most_bytes, bytes);
}

std::size_t Report::computed(std::size_t n) const {
    const auto& stats = stats_[n];
    if (!stats.computed.empty()) return stats.computed.size();
    if (stats.finished && pipeline_.nodes[n].rate != Rate::frame) return demands_[n].needed;
    return demands_[n].only_digests ? stats.consumed.size() : 0;
}

std::uint64_t Report::most_bytes(std::size_t n) const {
    const std::lock_guard lock(mutex_);
    return stats_[n].most_bytes;
}

std::optional<GatheringProgress> Report::gathering(std::size_t n) const {
    const std::lock_guard lock(mutex_);
    if (n >= demands_.size() || !pipeline_.nodes[n].streams_in() || demands_[n].only_digests ||
        stats_[n].finished)
        return std::nullopt;
    const auto needed = demands_[n].gathered();
    if (needed == 0) return std::nullopt;
    return GatheringProgress{stats_[n].gathered.size(), needed, stats_[n].items,
                             stats_[n].of_items};
}

std::vector<std::size_t> Report::done() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::size_t> out;
    for (std::size_t n = 0; n < demands_.size(); ++n)
        out.push_back(demands_[n].needed - demands_[n].computed +
                      std::min(computed(n), demands_[n].computed));
    return out;
}

void Report::failed(NodeFailure failure) {
    const std::lock_guard lock(mutex_);
    // A run that begins again may meet the same failure again.
    const auto same = [&](const NodeFailure& known) {
        return known.node == failure.node && known.frame == failure.frame &&
               known.message == failure.message;
    };
    if (std::ranges::none_of(failures_, same)) failures_.push_back(std::move(failure));
}

std::string Report::warn(std::size_t node, const std::string& message) {
    const std::lock_guard lock(mutex_);
    return warnings_.emplace(node, message).second ? line_of(node, message) : std::string();
}

void Report::entry(std::size_t node, const std::string& section, nlohmann::ordered_json entry) {
    const std::lock_guard lock(mutex_);
    auto& known = entries_[section][pipeline_.nodes[node].name];
    if (known.is_object()) known.update(entry);
    else known = std::move(entry);
}

void Report::add_line(std::size_t node, const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(fmt::format("{}: {}", pipeline_.nodes[node].name, one_line(line)));
}

nlohmann::ordered_json Report::entry_of(std::size_t node, const std::string& section) const {
    const std::lock_guard lock(mutex_);
    const auto entries = entries_.find(section);
    if (entries == entries_.end()) return {};
    const auto found = entries->second.find(pipeline_.nodes[node].name);
    return found == entries->second.end() ? nlohmann::ordered_json() : found->second;
}

std::vector<NodeFailure> Report::failures() const {
    const std::lock_guard lock(mutex_);
    auto out = failures_;
    const auto place = [&](const std::string& name) { return pipeline_.find(name); };
    std::ranges::stable_sort(out, [&](const NodeFailure& a, const NodeFailure& b) {
        return std::tuple(a.frame.has_value() ? 0 : 1, a.frame.value_or(0), place(a.node)) <
               std::tuple(b.frame.has_value() ? 0 : 1, b.frame.value_or(0), place(b.node));
    });
    return out;
}

std::vector<std::string> Report::warnings() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> out;
    for (const auto& [node, message] : warnings_) out.push_back(line_of(node, message));
    return out;
}

std::string Report::line_of(std::size_t node, const std::string& message) const {
    return fmt::format("{} ({}): {}", pipeline_.nodes[node].name, pipeline_.nodes[node].type->name,
                       message);
}

nlohmann::ordered_json Report::to_json(const std::vector<int>& delivered, int exit_code) const {
    using json = nlohmann::ordered_json;
    const auto sorted = failures();
    const std::lock_guard lock(mutex_);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    json out{{"fluidcarve", FLUIDCARVE_VERSION},
             {"pipeline", pipeline_.name},
             {"frames", delivered},
             {"exit", exit_code},
             {"wall_s",
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count()},
             {"peak_rss_bytes", static_cast<std::uint64_t>(usage.ru_maxrss) * 1024},
             {"nodes", json::object()},
             {"seams", json::object()}};
    for (std::size_t n = 0; n < demands_.size(); ++n) {
        const auto& stats = stats_[n];
        const auto& demand = demands_[n];
        const auto cached =
            demand.needed - std::max(demand.computed, std::min(computed(n), demand.needed));
        if (demand.needed == 0 ||
            (cached == 0 && computed(n) == 0 && stats.consumed.empty() && stats.once_s == 0))
            continue;
        auto& node = out["nodes"][pipeline_.nodes[n].name];
        node = {{"type", pipeline_.nodes[n].type->name},
                {"frames", cached + computed(n)},
                {"cached", cached},
                {"wall_s", stats.seconds()},
                {"bytes", stats.most_bytes}};
        if (stats.consumed.size() + demand.consumed_digests > 0)
            node["taken"] = {{"frames", stats.consumed.size() + demand.consumed_digests},
                             {"cached", demand.consumed_digests}};
    }
    for (const auto& [section, nodes] : entries_)
        for (const auto& [node, entry] : nodes) out[section][node] = in_order(entry);
    out["failures"] = json::array();
    for (const auto& failure : sorted) {
        json entry{{"node", failure.node}, {"message", failure.message}};
        if (failure.frame) entry["frame"] = *failure.frame;
        out["failures"].push_back(std::move(entry));
    }
    out["warnings"] = json::array();
    for (const auto& [node, message] : warnings_)
        out["warnings"].push_back({{"node", pipeline_.nodes[node].name}, {"message", message}});
    return out;
}

}  // namespace fluidcarve
