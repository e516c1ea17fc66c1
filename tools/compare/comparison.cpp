#include "tools/compare/comparison.h"

#include "carve/base/frame_set.h"
#include "carve/base/one_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace fluidcarve {
namespace {

std::string value_text(const std::vector<double>& value) {
    return value.size() == 1 ? fmt::format("{:g}", value[0])
                             : fmt::format("[{:g}]", fmt::join(value, ", "));
}

/// What a value differs by if it is counted: " by more than 0.1".
std::string threshold_text(const Tolerance& tolerance) {
    if (tolerance.none()) return {};
    const auto relative = fmt::format("{:g} of the greater value", tolerance.relative);
    if (tolerance.relative == 0) return fmt::format(" by more than {:g}", tolerance.absolute);
    return tolerance.absolute == 0
               ? " by more than " + relative
               : fmt::format(" by more than {:g} and {}", tolerance.absolute, relative);
}

std::string part_text(const PartComparison& part, const SequenceComparison& of,
                      const Thresholds& thresholds) {
    const auto& sums = part.sums;
    const auto in_frames = [&](const std::vector<int>& frames) {
        return of.per_frame() ? " in " + FrameSet(frames).in_words() : std::string();
    };
    constexpr std::array verdicts{"the same", "the same within the thresholds",
                                  "the same within the thresholds, with warnings", "different"};
    auto out = fmt::format(
        "  {}: {}{}\n", one_line(sums.name), verdicts.at(static_cast<std::size_t>(part.verdict)),
        part.verdict == Verdict::different ? in_frames(part.differing) : std::string());
    for (const auto& [fault, frames] : part.faults)
        out += fmt::format("    {}{}\n", one_line(fault), in_frames(frames));
    if (!sums.worst) return out;
    out += fmt::format("    {} of {} {} differ{}", sums.over, sums.compared, sums.values,
                       threshold_text(thresholds.tolerance));
    if (sums.warned > 0)
        out += fmt::format(", {} by more than {:g}", sums.warned, thresholds.tolerance.warn);
    if (sums.only_a > 0) out += fmt::format(", {} are active in A only", sums.only_a);
    if (sums.only_b > 0) out += fmt::format(", {} are active in B only", sums.only_b);
    if (sums.not_finite > 0) out += fmt::format(", {} by no finite number", sums.not_finite);
    out += fmt::format("\n    mean {:.4g}, RMS {:.4g}, peak {:.4g}: {}: {} in A, {} in B\n",
                       sums.mean(), sums.rms(), sums.peak, place_of(part, of.per_frame()),
                       value_text(sums.worst->a), value_text(sums.worst->b));
    return out;
}

nlohmann::ordered_json part_json(const PartComparison& part, bool per_frame) {
    using Json = nlohmann::ordered_json;
    const auto& sums = part.sums;
    Json out{{"name", sums.name}, {"result", name_of(part.verdict)}};
    if (per_frame) out["different_frames"] = FrameSet(part.differing).text();
    out["faults"] = Json::array();
    for (const auto& [fault, frames] : part.faults) {
        Json entry{{"fault", fault}};
        if (per_frame) entry["frames"] = FrameSet(frames).text();
        out["faults"].push_back(std::move(entry));
    }
    out["values"] = sums.values;
    out["compared"] = sums.compared;
    out["over"] = sums.over;
    out["warned"] = sums.warned;
    out["only_a"] = sums.only_a;
    out["only_b"] = sums.only_b;
    out["not_finite"] = sums.not_finite;
    out["mean"] = sums.mean();
    out["rms"] = sums.rms();
    out["peak"] = sums.peak;
    if (!sums.worst) return out;
    auto& worst = out["worst"] = Json::object();
    if (per_frame) worst["frame"] = part.worst_frame;
    worst["index"] = sums.worst->index;
    if (sums.worst->world) worst["world"] = *sums.worst->world;
    worst["a"] = sums.worst->a;
    worst["b"] = sums.worst->b;
    return out;
}

}  // namespace

std::string name_of(Verdict verdict) {
    constexpr std::array names{"same", "within", "warning", "different"};
    return names.at(static_cast<std::size_t>(verdict));
}

Verdict Thresholds::judge(const PartDifference& part) const {
    if (part.same()) return Verdict::same;
    if (!part.faults.empty() ||
        static_cast<double>(part.over) > fail_percent / 100 * static_cast<double>(part.compared))
        return Verdict::different;
    return part.warned > 0 ? Verdict::warning : Verdict::within;
}

void SequenceComparison::add(int frame, const std::vector<PartDifference>& found,
                             const Thresholds& thresholds) {
    for (const auto& part : found) {
        auto known = std::ranges::find_if(
            parts, [&](const auto& each) { return each.sums.name == part.name; });
        if (known == parts.end()) {
            known = parts.insert(parts.end(), PartComparison());
            known->sums.name = part.name;
            known->sums.values = part.values;
        }
        if (known->sums.add(part)) known->worst_frame = frame;
        const auto verdict = thresholds.judge(part);
        known->verdict = std::max(known->verdict, verdict);
        if (verdict == Verdict::different) known->differing.push_back(frame);
        for (const auto& fault : part.faults) {
            auto same = std::ranges::find_if(known->faults,
                                             [&](const auto& each) { return each.first == fault; });
            if (same == known->faults.end())
                same = known->faults.insert(known->faults.end(), {fault, {}});
            same->second.push_back(frame);
        }
    }
}

Verdict SequenceComparison::verdict() const {
    auto out =
        only_a.frames().empty() && only_b.frames().empty() ? Verdict::same : Verdict::different;
    for (const auto& part : parts) out = std::max(out, part.verdict);
    return out;
}

std::string to_text(const SequenceComparison& comparison, const Thresholds& thresholds) {
    auto out = fmt::format("{} and {}", comparison.a.path.text(), comparison.b.path.text());
    if (comparison.per_frame() && !comparison.frames.frames().empty())
        out += ", " + comparison.frames.in_words();
    out += "\n";
    for (const auto& [side, only] :
         {std::pair("A", &comparison.only_a), std::pair("B", &comparison.only_b)})
        if (!only->frames().empty())
            out += fmt::format("  only in {}: {}\n", side, only->in_words());
    for (const auto& part : comparison.parts) out += part_text(part, comparison, thresholds);
    return out;
}

nlohmann::ordered_json to_json(const SequenceComparison& comparison) {
    nlohmann::ordered_json out{{"a", comparison.a.path.text()},
                               {"b", comparison.b.path.text()},
                               {"result", name_of(comparison.verdict())}};
    if (comparison.per_frame()) {
        out["frames"] = comparison.frames.text();
        out["only_a"] = comparison.only_a.text();
        out["only_b"] = comparison.only_b.text();
    }
    out["parts"] = nlohmann::ordered_json::array();
    for (const auto& part : comparison.parts)
        out["parts"].push_back(part_json(part, comparison.per_frame()));
    return out;
}

std::string place_of(const PartComparison& part, bool per_frame) {
    // "voxels" are counted, one "voxel" is named.
    const auto& values = part.sums.values;
    const auto one = values == "vertices" ? "vertex" : values.substr(0, values.size() - 1);
    const auto& worst = *part.sums.worst;
    auto out = per_frame ? fmt::format("frame {}, ", part.worst_frame) : std::string();
    out += worst.index.size() == 1 ? fmt::format("{} {}", one, worst.index[0])
                                   : fmt::format("{} [{}]", one, fmt::join(worst.index, ", "));
    if (worst.world) out += fmt::format(", world [{:.6g}]", fmt::join(*worst.world, ", "));
    return out;
}

}  // namespace fluidcarve
