#include "runtime/keep/history.h"

#include "graph/confinement.h"
#include "graph/output_file.h"
#include "runtime/keep/work_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

namespace fluidcarve {
namespace {

using nlohmann::json;

constexpr std::size_t most_named = 3;

/// Names in a row: "a, b and 2 others". @param names  at least the first `most_named` @param total  how many there are
std::string listed(const std::vector<std::string>& names, std::size_t total) {
    if (total <= most_named) return fmt::format("{}", fmt::join(names, ", "));
    return fmt::format("{} and {} others", fmt::join(names.begin(), names.begin() + most_named, ", "), total - most_named);
}

/// Per node: which changed nodes are upstream of it. A row of bits for each, so that ten thousand nodes in a chain take some MB.
class ChangedUpstream {
public:
    explicit ChangedUpstream(const Pipeline& pipeline) : pipeline_(pipeline), rows_(pipeline.nodes.size()) {}

    /// To be called for the nodes in order. @param changed  whether the node itself changed
    void add(std::size_t n, bool changed) {
        for (const auto& links : pipeline_.nodes[n].inputs)
            for (const auto& link : links) {
                const auto& upstream = rows_[link.node];
                rows_[n].resize(std::max(rows_[n].size(), upstream.size()));
                for (std::size_t word = 0; word < upstream.size(); ++word) rows_[n][word] |= upstream[word];
                // Changed nodes are in order, as all nodes are.
                if (const auto at = std::ranges::lower_bound(changed_, link.node); at != changed_.end() && *at == link.node)
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
            for (auto bits = rows_[n][word]; bits != 0 && first.size() < most_named; bits &= bits - 1)
                first.push_back(pipeline_.nodes[changed_[word * bits_per_word + static_cast<std::size_t>(std::countr_zero(bits))]].name);
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
    std::vector<Row> rows_;             ///< per node: bit n is set if `changed_[n]` is upstream; no bits: none is
};

/// Per node: the nodes that read it, each once, in order.
std::vector<std::vector<std::size_t>> readers_of(const Pipeline& pipeline) {
    std::vector<std::vector<std::size_t>> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n)
        for (const auto& links : pipeline.nodes[n].inputs)
            for (const auto& link : links)
                if (auto& readers = out[link.node]; readers.empty() || readers.back() != n) readers.push_back(n);
    return out;
}

/// Describes the differences between two states of a node.
std::vector<std::string> differences(const json& was, const json& now) {
    std::vector<std::string> out;
    if (was["type"] != now["type"]) return {fmt::format("type changed from {} to {}", was["type"].get<std::string>(), now["type"].get<std::string>())};
    if (was["version"] != now["version"]) out.push_back(fmt::format("node version changed from {} to {}", was["version"].dump(), now["version"].dump()));
    if (was.value("plugin", "") != now.value("plugin", "")) out.emplace_back("its plugin was built again");
    for (const auto* const part : {"params", "inputs"}) {
        const bool input = std::string_view(part) == "inputs";
        const auto text = [](const json& of, const std::string& name) { return of.contains(name) ? of[name].get<std::string>() : std::string("nothing"); };
        std::set<std::string> names;
        for (const auto* const each : {&was, &now})
            for (const auto& [name, value] : (*each)[part].items()) names.insert(name);
        for (const auto& name : names)
            if (const auto before = text(was[part], name), after = text(now[part], name); before != after)
                out.push_back(fmt::format("{}{} changed from {} to {}", input ? "input " : "", name, before, after));
    }
    std::vector<int> changed, fresh;
    for (const auto& [frame, content] : now["files"].items()) {
        const auto found = was["files"].find(frame);
        if (found == was["files"].end()) fresh.push_back(std::stoi(frame));
        else if (*found != content) changed.push_back(std::stoi(frame));
    }
    std::sort(changed.begin(), changed.end());
    std::sort(fresh.begin(), fresh.end());
    const auto tell = [&](const std::vector<int>& frames, const char* what) {
        if (!frames.empty()) out.push_back(fmt::format("input frame{} {} {}", frames.size() == 1 ? "" : "s", FrameSet(frames).text(), what));
    };
    tell(changed, "changed");
    tell(fresh, fresh.size() == 1 ? "is new" : "are new");
    return out;
}

/// Whether a value read from a file has the form that `made_of` returns.
bool well_formed(const json& node) {
    if (!node.is_object() || !node.contains("type") || !node["type"].is_string() || !node.contains("version") || !node["version"].is_number()) return false;
    for (const auto* const part : {"params", "inputs", "files"}) {
        if (!node.contains(part) || !node[part].is_object()) return false;
        for (const auto& [name, value] : node[part].items())
            if (!value.is_string() || (std::string_view(part) == "files" && name.find_first_not_of("-0123456789") != std::string::npos)) return false;
    }
    if (!node.contains("cost")) return true;
    if (!node["cost"].is_object()) return false;
    for (const auto& [name, value] : node["cost"].items())
        if (!value.is_number()) return false;
    return true;
}

}  // namespace

History::History(const std::string& folder, const std::string& pipeline) {
    nodes_ = json::object();
    if (folder.empty()) return;
    path_ = fmt::format("{}/history/{}.json", folder, std::filesystem::path(pipeline).stem().string());
    if (!Confinement::of_program().refusal(path_).empty()) {
        path_.clear();
        return;
    }
    std::ifstream in(path_);
    auto read = json::parse(in, nullptr, false);
    const bool whole = read.is_object() && std::ranges::all_of(read, [](const json& node) { return node.is_object(); });
    foreign_ = in.is_open() && !whole && !WorkFolder(folder).marked();
    if (read.is_object()) nodes_ = std::move(read);
}

const json& History::of(const std::string& node) const {
    static const json nothing;
    const auto found = nodes_.find(node);
    return found == nodes_.end() || !well_formed(*found) ? nothing : *found;
}

json History::made_of(const Pipeline& pipeline, std::size_t n, const Dependencies& dependencies, const std::vector<bool>& reads) {
    const auto of = dependencies.of(n);
    json out{{"type", of.type}, {"version", of.version}, {"params", json::object()}, {"inputs", json::object()}, {"files", json::object()}};
    if (of.plugin) out["plugin"] = of.plugin->text();
    for (const auto& param : of.params) out["params"][param.name] = param.text;
    std::map<std::string, std::vector<std::string>> sources;
    for (const auto& input : of.inputs) sources[input.name].push_back(pipeline.nodes[input.source].name + "." + input.output);
    for (const auto& [name, all] : sources) out["inputs"][name] = fmt::format("{}", fmt::join(all, ", "));
    const auto& frames = dependencies.frames();
    for (std::size_t place = 0; place < frames.size(); ++place) {
        if (dependencies.files(n, place).empty()) break;
        if (!reads[place]) continue;
        out["files"][std::to_string(frames[place])] = dependencies.contents(n, place).text();
        if (pipeline.nodes[n].rate != Rate::frame) break;
    }
    return out;
}

void History::set(const std::string& node, json made_of) {
    if (const auto& was = of(node); !was.is_null()) {
        if (was.contains("cost")) made_of["cost"] = was["cost"];
        for (const auto& [frame, content] : was.at("files").items())
            if (!made_of["files"].contains(frame)) made_of["files"][frame] = content;
    }
    nodes_[node] = std::move(made_of);
}

void History::set_cost(const std::string& node, const NodeCost& cost, std::uint64_t input_bytes) {
    auto& known = nodes_[node]["cost"];
    if (cost.frame_s) known["frame_s"] = *cost.frame_s;
    if (cost.take_s) known["take_s"] = *cost.take_s;
    if (cost.once_s) known["once_s"] = *cost.once_s;
    if (cost.bytes > 0) known["bytes"] = cost.bytes;
    known["input_bytes"] = input_bytes;
}

std::optional<NodeCost> History::cost(const std::string& node, std::uint64_t input_bytes) const {
    const auto& made = of(node);
    if (made.is_null() || !made.contains("cost")) return std::nullopt;
    const auto& known = made["cost"];
    const auto then = known.value("input_bytes", std::uint64_t{0});
    const double scale = then > 0 && input_bytes > 0 ? static_cast<double>(input_bytes) / static_cast<double>(then) : 1;
    const auto seconds = [&](const char* name) { return known.contains(name) ? std::optional(scale * known[name].get<double>()) : std::nullopt; };
    return NodeCost{seconds("frame_s"), seconds("take_s"), seconds("once_s"), static_cast<std::uint64_t>(scale * known.value("bytes", 0.0))};
}

void History::save() const {
    if (path_.empty() || foreign_) return;
    try {
        OutputFile file(path_);
        std::ofstream out(file.aside(), std::ios::binary);
        out << nodes_.dump(1, ' ', false, json::error_handler_t::replace) << "\n";
        out.close();
        if (out) file.commit();
    } catch (const Failure&) {
        // Without the file a forecast only lacks reasons and estimates.
    }
}

std::vector<std::string> reasons(const Pipeline& pipeline, const std::vector<Share>& shares, const History& history, const Dependencies& dependencies,
                                 const std::function<std::vector<bool>(std::size_t node)>& reads) {
    const auto count = pipeline.nodes.size();
    std::vector<std::vector<std::string>> own(count);
    std::vector<bool> fresh(count, false);
    ChangedUpstream upstream(pipeline);
    for (std::size_t n = 0; n < count; ++n) {
        if (shares[n].frames == 0) continue;
        const auto& was = history.of(pipeline.nodes[n].name);
        fresh[n] = was.is_null();
        if (!fresh[n]) own[n] = differences(was, History::made_of(pipeline, n, dependencies, reads(n)));
        upstream.add(n, fresh[n] || !own[n].empty());
    }
    const auto readers = readers_of(pipeline);
    std::vector<std::string> out(count);
    for (std::size_t n = 0; n < count; ++n) {
        const auto& node = pipeline.nodes[n];
        if (shares[n].runs == 0 && shares[n].taken_anew == 0) continue;
        std::vector<std::string> users;
        for (const auto user : readers[n])
            if (shares[user].runs > 0 || shares[user].taken_anew > 0) users.push_back(pipeline.nodes[user].name);
        if (!history.on()) out[n] = "nothing is kept";
        else if (fresh[n]) out[n] = "never run";
        else if (!own[n].empty()) out[n] = listed(own[n], own[n].size());
        else if (!upstream.none(n)) out[n] = "changed: " + upstream.text(n);
        else if (node.kept && pipeline.writes(n)) out[n] = "its files are missing, or not as it wrote them";
        else if (!node.kept && !users.empty()) out[n] = "for " + listed(users, users.size());
        else if (!node.kept) out[n] = "its results are not kept";
        else out[n] = "was not finished, or is no longer kept";
    }
    return out;
}

}  // namespace fluidcarve
