#include "runtime/keep/keys.h"

#include "runtime/keep/grown_result.h"

#include <algorithm>

namespace fluidcarve {
namespace {

/// Raise it whenever the computation of keys changes.
constexpr std::uint64_t key_version = 1;
/// In the keys of writers whose files do not state what made them.
constexpr auto no_provenance = "no provenance";

bool among(const std::vector<std::string>* fields, const std::string& name) {
    return !fields || std::ranges::find(*fields, name) != fields->end();
}

/// Adds type, version and parameters to a hash. @param fields  the parameters to add; null: all
void describe(Hasher& hash, const Dependencies::OfNode& of,
              const std::vector<std::string>* fields) {
    hash.number(key_version).text(of.type).number(static_cast<std::uint64_t>(of.version));
    if (of.plugin) hash.hash(*of.plugin);
    for (const auto& param : of.params)
        if (param.rest && among(fields, param.name)) hash.text(param.name).text(*param.rest);
}

}  // namespace

Keys::Keys(const Pipeline& pipeline, const Dependencies& dependencies,
           std::function<bool(std::size_t node, std::size_t t)> takes)
    : pipeline_(pipeline),
      dependencies_(dependencies),
      takes_(std::move(takes)),
      entries_(pipeline.nodes.size()),
      digests_(pipeline.nodes.size()),
      gathered_(pipeline.nodes.size()) {
    const auto frames = dependencies.frames().size();
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        entries_[n].resize(pipeline.nodes[n].rate == Rate::frame ? frames : 1);
        digests_[n].resize(frames);
    }
}

void Keys::add_inputs(Hasher& hash, const Dependencies::OfNode& of, std::size_t t,
                      const std::vector<std::string>* fields, std::optional<bool> per_frame) {
    for (const auto& input : of.inputs) {
        if (!among(fields, input.name)) continue;
        if (per_frame && *per_frame != (pipeline_.nodes[input.source].rate == Rate::frame))
            continue;
        hash.text(input.name)
            .text(input.link_name)
            .text(input.output)
            .hash(result(input.source, t));
    }
}

Hash Keys::digest(std::size_t n, std::size_t t) {
    const std::lock_guard lock(mutex_);
    auto& known = digests_[n][t];
    if (known) return *known;
    const auto& type = *pipeline_.nodes[n].type;
    const auto of = dependencies_.of(n);
    const bool digests = type.digest != typeid(void);
    Hasher hash;
    if (digests) describe(hash.text("digest"), of, &type.digest_fields);
    hash.number(static_cast<std::uint64_t>(dependencies_.frames()[t]));
    add_inputs(hash, of, t, digests ? &type.digest_fields : nullptr,
               digests ? std::nullopt : std::optional(true));
    known = hash.digest();
    return *known;
}

Hash Keys::gathered(std::size_t n) {
    const std::lock_guard lock(mutex_);
    auto& known = gathered_[n];
    if (known) return *known;
    const auto of = dependencies_.of(n);
    Hasher hash;
    describe(hash.text("gathered"), of, nullptr);
    for (const auto frame : dependencies_.frames_of(n))
        hash.number(static_cast<std::uint64_t>(frame));
    for (std::size_t t = 0; t < dependencies_.frames().size(); ++t)
        if (takes_(n, t)) hash.hash(digest(n, t));
    add_inputs(hash, of, 0, nullptr, false);
    hash.hash(dependencies_.contents(n, 0));
    known = hash.digest();
    return *known;
}

Hash Keys::entry(std::size_t n, std::size_t t) {
    const std::lock_guard lock(mutex_);
    const auto& node = pipeline_.nodes[n];
    if (node.rate != Rate::frame) t = 0;
    auto& known = entries_[n][t];
    if (known) return *known;
    if (node.rate != Rate::frame && pipeline_.nodes[n].streams_in()) {
        known = gathered(n);
        if (!pipeline_.provenance && pipeline_.writes(n))
            known = Hasher().hash(*known).text(no_provenance).digest();
        return *known;
    }
    const auto of = dependencies_.of(n);
    Hasher hash;
    describe(hash.text("result"), of, nullptr);
    // Files that state what made them differ from those that do not. The statement itself is not
    // in the key: it follows from values that are in it.
    if (!pipeline_.provenance && pipeline_.writes(n)) hash.text(no_provenance);
    // A body that runs once sees the first frame of the sequence.
    hash.number(static_cast<std::uint64_t>(dependencies_.frames().at(t)));
    if (pipeline_.nodes[n].streams_in()) hash.hash(gathered(n));
    else if (node.gathers)
        for (const auto frame : dependencies_.frames_of(n))
            hash.number(static_cast<std::uint64_t>(frame));
    add_inputs(hash, of, t, nullptr, node.retimes() ? std::optional(false) : std::nullopt);
    hash.hash(dependencies_.contents(n, t));
    known = hash.digest();
    return *known;
}

Hash Keys::result(std::size_t n, std::size_t t) {
    const auto& node = pipeline_.nodes[n];
    const auto key = entry(n, t);
    if (!node.type->growth) return key;
    Hasher hash;
    hash.hash(key).text(node.type->param(node.type->growth->param)->text(node.params.get()));
    // Results from fewer items than wanted must not serve runs that want all.
    if (takes_fewer(node)) hash.text("best effort");
    return hash.digest();
}

}  // namespace fluidcarve
