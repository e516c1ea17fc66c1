#include "runtime/report.h"

#include "graph/one_line.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <algorithm>
#include <charconv>
#include <tuple>

namespace fluidcarve {

std::string to_text(const Fault& fault) {
    return fmt::format("{} ({}){}: {}", fault.node, fault.type, fault.frame ? fmt::format(", frame {}", *fault.frame) : std::string(), one_line(fault.message));
}

namespace {

/// An entry with a field per frame, in the order of frames; any other as it is.
nlohmann::ordered_json in_order(const nlohmann::ordered_json& entry) {
    std::map<int, nlohmann::ordered_json> frames;
    if (entry.is_object())
        for (const auto& [name, value] : entry.items()) {
            int frame = 0;
            const auto* const end = name.data() + name.size();
            const auto parsed = std::from_chars(name.data(), end, frame);
            if (parsed.ec != std::errc() || parsed.ptr != end) return entry;
            frames[frame] = value;
        }
    if (frames.empty()) return entry;
    auto out = nlohmann::ordered_json::object();
    for (const auto& [frame, value] : frames) out[std::to_string(frame)] = value;
    return out;
}

}  // namespace

Report::Report(const Pipeline& pipeline) : pipeline_(pipeline), stats_(pipeline.nodes.size()) {}

void Report::ran(std::size_t node, std::size_t frames, double seconds, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    stats_[node].frames += frames;
    stats_[node].ran = true;
    stats_[node].seconds += seconds;
    stats_[node].most_bytes = std::max(stats_[node].most_bytes, bytes);
}

void Report::failed(Fault fault) {
    const std::lock_guard lock(mutex_);
    faults_.push_back(std::move(fault));
}

void Report::warn(std::size_t node, const std::string& message) {
    const std::lock_guard lock(mutex_);
    warnings_.emplace(node, message);
}

void Report::entry(std::size_t node, const std::string& section, nlohmann::ordered_json entry) {
    const std::lock_guard lock(mutex_);
    auto& known = entries_[section][pipeline_.nodes[node].name];
    if (known.is_object()) known.update(entry);
    else known = std::move(entry);
}

std::vector<Fault> Report::faults() const {
    const std::lock_guard lock(mutex_);
    auto out = faults_;
    const auto place = [&](const std::string& name) { return pipeline_.find(name); };
    std::stable_sort(out.begin(), out.end(), [&](const Fault& a, const Fault& b) {
        return std::tuple(a.frame.has_value() ? 0 : 1, a.frame.value_or(0), place(a.node)) <
               std::tuple(b.frame.has_value() ? 0 : 1, b.frame.value_or(0), place(b.node));
    });
    return out;
}

std::vector<std::string> Report::warnings() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> out;
    for (const auto& [node, message] : warnings_)
        out.push_back(fmt::format("{} ({}): {}", pipeline_.nodes[node].name, pipeline_.nodes[node].type->name, message));
    return out;
}

nlohmann::ordered_json Report::to_json(const std::vector<int>& delivered, int exit_code) const {
    using json = nlohmann::ordered_json;
    const auto failures = faults();
    const std::lock_guard lock(mutex_);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    json out{{"fluidcarve", FLUIDCARVE_VERSION},
             {"pipeline", pipeline_.name},
             {"frames", delivered},
             {"exit", exit_code},
             {"wall_s", std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count()},
             {"peak_rss_bytes", static_cast<std::uint64_t>(usage.ru_maxrss) * 1024},
             {"nodes", json::object()},
             {"seams", json::object()}};
    for (std::size_t n = 0; n < stats_.size(); ++n) {
        const auto& stats = stats_[n];
        if (stats.ran)
            out["nodes"][pipeline_.nodes[n].name] = {
                {"type", pipeline_.nodes[n].type->name}, {"frames", stats.frames}, {"cached", 0}, {"wall_s", stats.seconds}, {"bytes", stats.most_bytes}};
    }
    for (const auto& [section, nodes] : entries_)
        for (const auto& [node, entry] : nodes) out[section][node] = in_order(entry);
    out["failures"] = json::array();
    for (const auto& fault : failures) {
        json entry{{"node", fault.node}, {"message", fault.message}};
        if (fault.frame) entry["frame"] = *fault.frame;
        out["failures"].push_back(std::move(entry));
    }
    out["warnings"] = json::array();
    for (const auto& [node, message] : warnings_) out["warnings"].push_back({{"node", pipeline_.nodes[node].name}, {"message", message}});
    return out;
}

}  // namespace fluidcarve
