#include "runtime/keep/history.h"

#include "carve/base/frame_set.h"
#include "carve/base/words.h"
#include "formats/file/confinement.h"
#include "formats/file/output_file.h"
#include "graph/text/json_text.h"
#include "runtime/keep/work_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

namespace fluidcarve {
namespace {

using nlohmann::json;

constexpr std::size_t most_named = 3;

/// Names in a row: "a, b and 2 others".
/// @param names  at least the first `most_named`
/// @param total  how many there are
std::string listed(const std::vector<std::string>& names, std::size_t total) {
    if (total <= most_named) return fmt::format("{}", fmt::join(names, ", "));
    return fmt::format("{} and {}", fmt::join(names.begin(), names.begin() + most_named, ", "),
                       counted(total - most_named, "other"));
}

/// Per node: which changed nodes are upstream of it. A row of bits for each, so that ten thousand
/// nodes in a chain take some MB.
class ChangedUpstream {
public:
    explicit ChangedUpstream(const Pipeline& pipeline)
        : pipeline_(pipeline), rows_(pipeline.nodes.size()) {}

    /// To be called for the nodes in order. @param changed  whether the node itself changed
    void add(std::size_t n, bool changed) {
        for (const auto& link : pipeline_.nodes[n].links()) {
            const auto& upstream = rows_[link.node];
            rows_[n].resize(std::max(rows_[n].size(), upstream.size()));
            for (std::size_t word = 0; word < upstream.size(); ++word)
                rows_[n][word] |= upstream[word];
            // Changed nodes are in order, as all nodes are.
            if (const auto at = std::ranges::lower_bound(changed_, link.node);
                at != changed_.end() && *at == link.node)
                set(rows_[n], static_cast<std::size_t>(at - changed_.begin()));
        }
        if (changed) changed_.push_back(n);
    }

    bool none(std::size_t n) const { return rows_[n].empty(); }
    std::string text(std::size_t n) const {
        std::vector<std::string> first;
        std::size_t total = 0;
        for (std::size_t word = 0; word < rows_[n].size(); ++word) {
            total += static_cast<std::size_t>(std::popcount(rows_[n][word]));
            for (auto bits = rows_[n][word]; bits != 0 && first.size() < most_named;
                 bits &= bits - 1)
                first.push_back(
                    pipeline_
                        .nodes[changed_[word * bits_per_word +
                                        static_cast<std::size_t>(std::countr_zero(bits))]]
                        .name);
        }
        return listed(first, total);
    }

private:
    using Row = std::vector<std::uint64_t>;
    static constexpr std::size_t bits_per_word = 64;

    static void set(Row& row, std::size_t bit) {
        row.resize(std::max(row.size(), bit / bits_per_word + 1));
        row[bit / bits_per_word] |= std::uint64_t{1} << bit % bits_per_word;
    }

    const Pipeline& pipeline_;
    std::vector<std::size_t> changed_;  ///< nodes
    /// Per node: bit n is set if `changed_[n]` is upstream; no bits: none is.
    std::vector<Row> rows_;
};

/// Per node: the nodes that read it, each once, in order.
std::vector<std::vector<std::size_t>> readers_of(const Pipeline& pipeline) {
    std::vector<std::vector<std::size_t>> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n)
        for (const auto& link : pipeline.nodes[n].links())
            if (auto& readers = out[link.node]; readers.empty() || readers.back() != n)
                readers.push_back(n);
    return out;
}

/// The key of a node's files that are the same for all frames.
constexpr auto all_frames = "0";

/// Describes the differences between two states of a node.
/// @param unless  a parameter that is left out; empty: none
/// @param shared  names of the files that the node reads for all frames; none: it reads files per
///   frame
std::vector<std::string> differences(const json& was, const json& now, const std::string& unless,
                                     const std::vector<std::string>& shared) {
    std::vector<std::string> out;
    if (was["type"] != now["type"])
        return {fmt::format("type changed from {} to {}", was["type"].get<std::string>(),
                            now["type"].get<std::string>())};
    if (was["version"] != now["version"])
        out.push_back(fmt::format("node version changed from {} to {}", was["version"].dump(),
                                  now["version"].dump()));
    if (was.value("plugin", "") != now.value("plugin", ""))
        out.emplace_back("its plugin was built again");
    for (const auto* const part : {"params", "inputs"}) {
        const bool input = std::string_view(part) == "inputs";
        const auto text = [](const json& of, const std::string& name) {
            return of.contains(name) ? of[name].get<std::string>() : std::string("nothing");
        };
        std::set<std::string> names;
        for (const auto* const each : {&was, &now})
            for (const auto& [name, value] : (*each)[part].items()) names.insert(name);
        for (const auto& name : names)
            if (const auto before = text(was[part], name), after = text(now[part], name);
                before != after && (input || name != unless))
                out.push_back(fmt::format("{}{} changed from {} to {}", input ? "input " : "", name,
                                          before, after));
    }
    std::vector<int> changed, fresh;
    for (const auto& [frame, content] : now["files"].items()) {
        const auto found = was["files"].find(frame);
        if (found == was["files"].end()) fresh.push_back(std::stoi(frame));
        else if (*found != content) changed.push_back(std::stoi(frame));
    }
    std::ranges::sort(changed);
    std::ranges::sort(fresh);
    const auto tell = [&](const std::vector<int>& frames, const char* what) {
        if (frames.empty()) return;
        if (!shared.empty())
            out.push_back(fmt::format("input {} {}", listed(shared, shared.size()), what));
        else
            out.push_back(fmt::format("input frame{} {} {}", frames.size() == 1 ? "" : "s",
                                      FrameSet(frames).text(), what));
    };
    tell(changed, "changed");
    tell(fresh, fresh.size() == 1 ? "is new" : "are new");
    return out;
}

/// Names of the files that a node reads for all frames; none: it reads files per frame, or none.
std::vector<std::string> shared_files(const Node& node, std::size_t n,
                                      const Dependencies& dependencies) {
    std::vector<std::string> out;
    if (node.rate == Rate::frame || dependencies.frames().empty()) return out;
    for (const auto& path : dependencies.files(n, 0))
        out.push_back(std::filesystem::path(path).filename().string());
    return out;
}

/// The parameter with the count of a growing result, if the node does not run because of it: no
/// result is kept that could be too small. Else empty.
std::string idle_count(const Node& node, const std::optional<GrownResult>& grown, const json& was,
                       const json& now) {
    return node.type->growth && !grown && was.value("rest", "") == now.value("rest", "")
               ? node.type->growth->param
               : std::string();
}

/// "goes on from 7 of 12 seams"; empty: the node begins anew.
std::string goes_on(const Node& node, const std::optional<GrownResult>& grown) {
    if (!grown || grown->enough_for(node)) return {};
    const auto& growth = *node.type->growth;
    if (grown->items.count == 0) return "goes on where it was stopped";
    return fmt::format(
        "goes on from {} of {}", grown->items.count,
        counted(growth.wanted(node.params.get(), grown->items.all_items), growth.item));
}

const std::array<std::pair<Work, const char*>, work_kinds> names_of_work{
    std::pair{Work::frame, "frame"},
    {Work::consume, "consume"},
    {Work::load, "load"},
    {Work::once, "once"}};

json to_json(const WorkTime& cost) {
    return {{"seconds", cost.seconds},      {"abreast", cost.at.abreast},
            {"cores", cost.at.cores},       {"input_bytes", cost.at.input_bytes},
            {"gathered", cost.at.gathered}, {"items", cost.at.items},
            {"of", cost.at.all_items}};
}

WorkTime cost_in(const json& from) {
    const auto count = [&](const char* name) {
        return static_cast<std::size_t>(std::max(0.0, from.value(name, 0.0)));
    };
    return {from.value("seconds", 0.0),
            {from.value("abreast", 1.0), from.value("cores", 1.0), count("input_bytes"),
             count("gathered"), count("items"), count("of")}};
}

/// Whether a value read from a file has the form that `made_of` returns.
bool well_formed(const json& node) {
    if (!has(node, "type", &json::is_string) || !has(node, "version", &json::is_number))
        return false;
    for (const auto* const part : {"params", "inputs", "files"}) {
        if (!has(node, part, &json::is_object)) return false;
        for (const auto& [name, value] : node[part].items())
            if (!value.is_string() || (std::string_view(part) == "files" &&
                                       name.find_first_not_of("-0123456789") != std::string::npos))
                return false;
    }
    if (node.contains("rest") && !node["rest"].is_string()) return false;
    if (!node.contains("costs")) return true;
    if (!node["costs"].is_object()) return false;
    return std::ranges::all_of(node["costs"], [](const json& cost) {
        return cost.is_object() &&
               std::ranges::all_of(cost, [](const json& value) { return value.is_number(); });
    });
}

}  // namespace

History::History(const std::string& folder, const std::string& pipeline) {
    nodes_ = json::object();
    if (folder.empty()) return;
    path_ = fmt::format("{}/history/{}.json", folder, shot_of(pipeline));
    if (!Confinement::of_program().refusal(path_).empty()) {
        path_.clear();
        return;
    }
    std::error_code none;
    auto read = json_of_own_file<json>(path_);
    const bool whole = read.is_object() &&
                       std::ranges::all_of(read, [](const json& node) { return node.is_object(); });
    foreign_ = std::filesystem::exists(path_, none) && !whole && !WorkFolder(folder).marked();
    if (read.is_object()) nodes_ = std::move(read);
}

const json& History::state(const std::string& node) const {
    static const json nothing;
    const auto found = nodes_.find(node);
    return found == nodes_.end() || !well_formed(*found) ? nothing : *found;
}

json History::made_of(const Pipeline& pipeline, std::size_t n, const Dependencies& dependencies,
                      const std::vector<bool>& reads) {
    const auto of = dependencies.of(n);
    json out{{"type", of.type},
             {"version", of.version},
             {"params", json::object()},
             {"inputs", json::object()},
             {"files", json::object()}};
    if (of.plugin) out["plugin"] = of.plugin->text();
    const auto& growth = pipeline.nodes[n].type->growth;
    for (const auto& param : of.params) {
        out["params"][param.name] = param.text;
        if (growth && growth->param == param.name && param.rest) out["rest"] = *param.rest;
    }
    std::map<std::string, std::vector<std::string>> sources;
    for (const auto& input : of.inputs)
        sources[input.name].push_back(pipeline.nodes[input.source].name + "." + input.output);
    for (const auto& [name, all] : sources)
        out["inputs"][name] = fmt::format("{}", fmt::join(all, ", "));
    const auto& frames = dependencies.frames();
    for (std::size_t t = 0; t < frames.size(); ++t) {
        if (dependencies.files(n, t).empty()) break;
        if (!reads[t]) continue;
        const bool per_frame = pipeline.nodes[n].rate == Rate::frame;
        out["files"][per_frame ? std::to_string(frames[t]) : all_frames] =
            dependencies.contents(n, t).text();
        if (!per_frame) break;
    }
    return out;
}

void History::set(const std::string& node, json made_of) {
    if (const auto& was = state(node); !was.is_null()) {
        if (was.contains("costs") && was["type"] == made_of["type"] &&
            was["version"] == made_of["version"])
            made_of["costs"] = was["costs"];
        for (const auto& [frame, content] : was.at("files").items())
            if (!made_of["files"].contains(frame)) made_of["files"][frame] = content;
    }
    nodes_[node] = std::move(made_of);
}

void History::set_cost(const std::string& node, const NodeCost& cost, std::uint64_t input_bytes) {
    auto& known = nodes_[node]["costs"];
    for (const auto& [work, name] : names_of_work)
        if (auto measured = cost[work]) {
            measured->at.input_bytes = input_bytes;
            known[name] = to_json(*measured);
        }
    if (cost.bytes > 0) known["result"] = {{"bytes", cost.bytes}, {"input_bytes", input_bytes}};
}

NodeCost History::cost(const std::string& node, const std::string& type) const {
    NodeCost out;
    const auto& made = state(node);
    if (made.is_null() || !made.contains("costs") || made["type"] != type) return out;
    const auto& known = made["costs"];
    for (const auto& [work, name] : names_of_work)
        if (known.contains(name)) out[work] = cost_in(known[name]);
    if (known.contains("result")) {
        out.bytes = known["result"].value("bytes", std::uint64_t{0});
        out.bytes_of_input = known["result"].value("input_bytes", std::uint64_t{0});
    }
    return out;
}

void History::save() const {
    if (path_.empty() || foreign_) return;
    try {
        OutputFile::write(path_, json_text(nodes_, 1) + "\n");
    } catch (const Failure&) {
        // Without the file a forecast only lacks reasons and estimates.
    }
}

namespace {

/// Why the results of a node that did not change are not there.
/// @param users  nodes that read them and run
std::string why_lost(const Pipeline& pipeline, std::size_t n,
                     const std::vector<std::string>& users) {
    const auto& node = pipeline.nodes[n];
    if (node.kept && pipeline.writes(n)) return "its files are missing, or not as it wrote them";
    if (node.kept) return "was not finished, or is no longer kept";
    return users.empty() ? "its results are not kept" : "for " + listed(users, users.size());
}

}  // namespace

std::vector<std::string> reasons(const Pipeline& pipeline, const std::vector<NodeDemand>& demands,
                                 const History& history, const Dependencies& dependencies,
                                 const std::function<NodeNow(std::size_t node)>& now) {
    const auto count = pipeline.nodes.size();
    std::vector<std::vector<std::string>> own(count);
    std::vector<std::string> continued(count);
    std::vector<bool> fresh(count, false);
    ChangedUpstream upstream(pipeline);
    for (std::size_t n = 0; n < count; ++n) {
        if (demands[n].needed == 0) continue;
        const auto& node = pipeline.nodes[n];
        const auto& was = history.state(node.name);
        const auto [reads, grown] = now(n);
        fresh[n] = was.is_null();
        continued[n] = goes_on(node, grown);
        bool changed = fresh[n];
        if (!fresh[n]) {
            const auto is = History::made_of(pipeline, n, dependencies, reads);
            const auto shared = shared_files(node, n, dependencies);
            own[n] = differences(was, is, idle_count(node, grown, was, is), shared);
            changed = !differences(was, is, "", shared).empty();
        }
        upstream.add(n, changed);
    }
    const auto readers = readers_of(pipeline);
    std::vector<std::string> out(count);
    for (std::size_t n = 0; n < count; ++n) {
        if (demands[n].computed == 0 && demands[n].consumed_inputs == 0) continue;
        std::vector<std::string> users;
        for (const auto user : readers[n])
            if (demands[user].computed > 0 || demands[user].consumed_inputs > 0)
                users.push_back(pipeline.nodes[user].name);
        std::vector<std::string> causes;
        if (!fresh[n] && !upstream.none(n)) causes.push_back("changed: " + upstream.text(n));
        if (!own[n].empty()) causes.push_back(listed(own[n], own[n].size()));
        if (!continued[n].empty()) causes.push_back(continued[n]);
        if (!history.on()) out[n] = "nothing is kept";
        else if (!causes.empty()) out[n] = fmt::format("{}", fmt::join(causes, "; "));
        else if (fresh[n]) out[n] = "never run";
        else out[n] = why_lost(pipeline, n, users);
    }
    return out;
}

}  // namespace fluidcarve
