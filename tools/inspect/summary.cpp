#include "tools/inspect/summary.h"

#include "carve/base/frame_set.h"
#include "graph/text/json_text.h"
#include "tools/inspect/oddities.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// The same thing in several frames, or its value.
using Seen = std::vector<std::pair<int, const Json*>>;

FrameSet frames_seen(const Seen& seen) {
    std::vector<int> out;
    for (const auto& [frame, value] : seen) out.push_back(frame);
    return FrameSet(std::move(out));
}

Json union_of_boxes(const Seen& seen) {
    Json out = *seen.front().second;
    for (const auto& [frame, box] : seen)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if ((*box)[0][axis] < out[0][axis]) out[0][axis] = (*box)[0][axis];
            if ((*box)[1][axis] > out[1][axis]) out[1][axis] = (*box)[1][axis];
        }
    return out;
}

Json span_of(const Seen& seen) {
    const bool spans = seen.front().second->is_array();
    Json low = spans ? seen.front().second->at(0) : *seen.front().second,
         high = spans ? seen.front().second->at(1) : *seen.front().second;
    for (const auto& [frame, value] : seen) {
        low = std::min(low, spans ? value->at(0) : *value);
        high = std::max(high, spans ? value->at(1) : *value);
    }
    return {low, high};
}

/// Merges what is known of a sequence's files, and notes what changes.
class Summary {
public:
    /// The fields of one thing in all frames.
    /// @param name  of the thing, for messages; empty: the file
    Json merged(const Seen& seen, const std::string& name) {
        auto out = Json::object();
        for (const auto& [frame, thing] : seen)
            for (const auto& [key, value] : thing->items())
                if (!out.contains(key)) out[key] = merged_field(values_of(seen, key), key, name);
        return out;
    }

    void tell(const std::string& line, const std::string& name) { changes_.add(line, name); }

    Json changes() const { return changes_.lines(); }

private:
    static Seen values_of(const Seen& seen, const std::string& key) {
        Seen out;
        for (const auto& [frame, thing] : seen)
            if (const auto found = thing->find(key); found != thing->end())
                out.emplace_back(frame, &*found);
        return out;
    }

    Json merged_field(const Seen& values, const std::string& key, const std::string& name) {
        const auto& first = *values.front().second;
        if (key == "metadata") return shared(values);
        if (std::ranges::all_of(values, [&](const auto& each) { return *each.second == first; }))
            return first;
        if (key == "box") tell("the box of active voxels changes from frame to frame", name);
        if (key == "box" || key == "world_box") return union_of_boxes(values);
        if (key == "range" || first.is_number()) return span_of(values);
        if (first.is_object()) return merged(values, name);
        if (!first.is_array()) tell(by_value(values, key), name);
        return first;
    }

    /// The entries that are the same everywhere.
    static Json shared(const Seen& maps) {
        auto out = *maps.front().second;
        for (const auto& [frame, map] : maps)
            for (auto entry = out.begin(); entry != out.end();)
                if (const auto other = map->find(entry.key());
                    other == map->end() || *other != *entry)
                    entry = out.erase(entry);
                else ++entry;
        return out;
    }

    /// "type is float in frames 1-3, double in frame 4".
    static std::string by_value(const Seen& values, const std::string& key) {
        std::vector<std::pair<std::string, Seen>> groups;
        for (const auto& each : values) {
            const auto text = each.second->is_string() ? each.second->get<std::string>()
                                                       : json_text(*each.second);
            auto group = std::ranges::find_if(
                groups, [&](const auto& other) { return other.first == text; });
            if (group == groups.end()) group = groups.insert(groups.end(), {text, {}});
            group->second.push_back(each);
        }
        std::string out = key + " is ";
        for (const auto& [text, frames] : groups)
            out += fmt::format("{}{} in {}", &frames == &groups.front().second ? "" : ", ", text,
                               frames_seen(frames).in_words());
        return out;
    }

    Oddities changes_;
};

/// Oddities of all files, each with its frames unless all have it.
Json oddities_of(const std::vector<LookedAt>& files) {
    std::vector<std::pair<std::string, std::vector<int>>> all;
    for (const auto& [frame, facts] : files)
        for (const auto& oddity : facts.at("oddities")) {
            const auto text = oddity.get<std::string>();
            auto found =
                std::ranges::find_if(all, [&](const auto& each) { return each.first == text; });
            if (found == all.end()) found = all.insert(all.end(), {text, {}});
            found->second.push_back(frame);
        }
    auto out = Json::array();
    for (const auto& [text, frames] : all)
        out.push_back(frames.size() == files.size()
                          ? text
                          : fmt::format("{} ({})", text, FrameSet(frames).in_words()));
    return out;
}

}  // namespace

Json summary_of(const std::vector<LookedAt>& files, const FileInspector& inspector) {
    Summary summary;
    std::vector<Json> heads;
    std::vector<std::string> names;
    std::map<std::string, Seen> parts;
    for (const auto& [frame, facts] : files) {
        heads.push_back(facts);
        for (const auto* const key : {"file", "frame", "oddities", inspector.parts.c_str()})
            heads.back().erase(key);
        for (const auto& part : facts.at(inspector.parts)) {
            const auto name = part.at("name").get<std::string>();
            if (!parts.contains(name)) names.push_back(name);
            parts[name].emplace_back(frame, &part);
        }
    }
    Seen seen;
    for (std::size_t n = 0; n < files.size(); ++n) seen.emplace_back(files[n].frame, &heads[n]);
    auto out = summary.merged(seen, {});
    out[inspector.parts] = Json::array();
    for (const auto& name : names) {
        auto part = summary.merged(parts[name], name);
        if (const auto frames = frames_seen(parts[name]); frames.frames().size() < files.size()) {
            part["frames"] = frames.text();
            summary.tell("only in " + frames.in_words(), name);
        }
        out[inspector.parts].push_back(std::move(part));
    }
    out["changes"] = summary.changes();
    out["oddities"] = oddities_of(files);
    return out;
}

}  // namespace fluidcarve
