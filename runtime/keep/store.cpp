#include "runtime/keep/store.h"

#include "formats/file/output_file.h"
#include "runtime/keep/work_folder.h"

#include <algorithm>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// Remembered contents of a writer's files, per result.
constexpr std::size_t most_alternatives = 16;

}  // namespace

Store::Store(const Pipeline& pipeline, const Dependencies& dependencies, Keys& keys, Cache& cache,
             FileHashes& files)
    : pipeline_(pipeline), dependencies_(dependencies), keys_(keys), cache_(cache), files_(files) {}

std::vector<std::string> Store::outputs(std::size_t n, std::size_t t) const {
    const auto& node = pipeline_.nodes[n];
    std::vector<std::string> out;
    for (const auto& [param, path] : node.written())
        out.push_back(path.at(dependencies_.frames().at(node.rate == Rate::frame ? t : 0)));
    return out;
}

bool Store::knows(std::size_t n, std::size_t t) {
    const auto& node = pipeline_.nodes[n];
    if (!node.kept || !cache_.on()) return false;
    const auto header = cache_.look(key(n, t));
    if (!header) return false;
    if (!node.outputs.empty()) {
        if (!header->contains("outputs")) return false;
        const auto grown = GrownResult::in(*header);
        const bool enough = !node.type->growth || (grown && grown->enough_for(node));
        if (enough) cache_.touch(key(n, t));
        return enough;
    }
    Json now = Json::array();
    for (const auto& path : outputs(n, t)) {
        const auto content = files_.content(path);
        if (!content) return false;
        now.push_back(content->hash.text());
    }
    const auto were = header->value("files", Json::array());
    const bool current = !now.empty() && std::ranges::find(were, now) != were.end();
    if (current) cache_.touch(key(n, t));
    return current;
}

std::optional<GrownResult> Store::grown(std::size_t n) {
    const auto& node = pipeline_.nodes[n];
    if (!node.type->growth || !node.kept || !cache_.on() || node.rate == Rate::frame)
        return std::nullopt;
    const auto header = cache_.look(key(n, 0));
    return header && header->contains("outputs") ? GrownResult::in(*header) : std::nullopt;
}

bool Store::knows_digest(std::size_t n, std::size_t t) {
    const auto& node = pipeline_.nodes[n];
    const bool there =
        node.digests_kept && node.type->digest != typeid(void) && cache_.look(keys_.digest(n, t));
    if (there) cache_.touch(keys_.digest(n, t));
    return there;
}

std::optional<Store::Whole> Store::whole(std::size_t n, std::size_t t) {
    const auto& node = pipeline_.nodes[n];
    auto entry = cache_.load(key(n, t));
    if (!entry || entry->outputs.size() != node.outputs.size()) return std::nullopt;
    Whole out{std::move(entry->outputs), log_in(entry->header)};
    if (!node.type->growth) return out;
    const auto grown = GrownResult::in(entry->header);
    if (!grown || !grown->enough_for(node)) return std::nullopt;
    cut(node, *grown, out.outputs.at(0), out.log);
    return out;
}

NodeLog Store::log(std::size_t n, std::size_t t) {
    const auto& node = pipeline_.nodes[n];
    const auto header = cache_.look(key(n, t));
    if (!header) return {};
    const auto grown = node.type->growth ? GrownResult::in(*header) : std::nullopt;
    if (!grown || grown->fits(node)) return log_in(*header);
    auto found = whole(n, t);
    return found ? std::move(found->log) : NodeLog{};
}

NodeLog Store::log_of_digest(std::size_t n, std::size_t t) const {
    const auto header = cache_.look(keys_.digest(n, t));
    return header ? log_in(*header) : NodeLog{};
}

std::optional<std::vector<Payload>> Store::result(std::size_t n, std::size_t t) {
    auto found = whole(n, t);
    return found ? std::optional(std::move(found->outputs)) : std::nullopt;
}

std::optional<Payload> Store::digest(std::size_t n, std::size_t t) {
    auto entry = cache_.load(keys_.digest(n, t));
    if (!entry || entry->outputs.size() != 1 || !entry->outputs.front() ||
        entry->outputs.front().type() != pipeline_.nodes[n].type->digest)
        return std::nullopt;
    return std::move(entry->outputs.front());
}

std::optional<std::pair<Payload, Json>> Store::part(std::size_t n) {
    auto entry = cache_.load(key(n, 0));
    if (!entry || entry->outputs.size() != 1 || !entry->outputs.front()) return std::nullopt;
    return std::pair(std::move(entry->outputs.front()), grown_entry(log_in(entry->header)));
}

Json Store::header_of(const NodeLog& log) const {
    auto out = to_json(log);
    out["shot"] = shot_of(pipeline_.name);
    return out;
}

void Store::keep(std::size_t n, std::size_t t, const std::vector<Payload>& outputs,
                 const NodeLog& log) {
    const auto& node = pipeline_.nodes[n];
    if (node.kept && pipeline_.writes(n)) return keep_files(n, t, log);
    if (node.kept && !outputs.empty()) {
        if (node.type->growth) return keep_grown(n, t, outputs.at(0), log, false);
        cache_.store(key(n, t), header_of(log), outputs);
        return;
    }
    if (log.empty()) return;
    const auto there = cache_.look(key(n, t));
    if (!there || !there->contains("outputs")) cache_.store(key(n, t), header_of(log), {});
}

void Store::keep_files(std::size_t n, std::size_t t, const NodeLog& log) {
    if (!cache_.on()) return;
    Json now = Json::array();
    for (const auto& path : outputs(n, t)) {
        const auto content = files_.content_now(path);
        // Another process may have replaced the file since.
        if (!content || content->inode != OutputFile::inode_of(path)) return;
        now.push_back(content->hash.text());
    }
    auto header = header_of(log);
    header["files"] = Json::array({now});
    // The same result may have been written to several paths, with different bytes: some writers
    // put a unique id into each file.
    if (const auto there = cache_.look(key(n, t)))
        for (const auto& were : there->value("files", Json::array()))
            if (were != now && header["files"].size() < most_alternatives)
                header["files"].push_back(were);
    cache_.store(key(n, t), std::move(header), {});
}

void Store::keep_digest(std::size_t n, std::size_t t, const Payload& digest, const NodeLog& log) {
    if (pipeline_.nodes[n].digests_kept && digest)
        cache_.store(keys_.digest(n, t), header_of(log), {digest});
}

void Store::keep_grown(std::size_t n, std::size_t t, const Payload& result, const NodeLog& log,
                       bool part) {
    if (!cache_.on() || !result) return;
    const auto& growth = *pipeline_.nodes[n].type->growth;
    const bool exhausted = growth.exhausted && growth.exhausted(grown_entry(log));
    const GrownResult grown{growth.item_count(result),
                            cache_.registry().payload(result.type()).bytes(result), part,
                            exhausted};
    if (const auto there = cache_.look(key(n, t)))
        if (const auto kept = GrownResult::in(*there); kept && kept->holds(grown)) return;
    auto header = header_of(log);
    grown.describe(header);
    cache_.store(key(n, t), std::move(header), {result});
}

}  // namespace fluidcarve
