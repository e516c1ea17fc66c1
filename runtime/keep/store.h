#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/cache.h"
#include "runtime/keep/keys.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// What a body told the run beside its results; told again where they are taken from a former run.
struct Said {
    std::vector<std::string> warnings;
    std::map<std::string, nlohmann::ordered_json> report;  ///< by section
    bool empty() const { return warnings.empty() && report.empty(); }
};

/// The results of a pipeline's nodes in the work folder: what former runs left, and what this one leaves. Safe from several
/// threads.
class Store {
public:
    Store(const Pipeline& pipeline, const std::vector<int>& frames, Keys& keys, Cache& cache, FileHashes& files);

    /// Under which a result is kept.
    Key key(std::size_t node, std::size_t place) { return keys_.kept(node, place); }

    /// Whether nothing has to be computed for a result: it is kept, as large as is wished for; or, of a writer, its files are
    /// there and hold what it would write.
    bool knows(std::size_t node, std::size_t place);
    bool knows_digest(std::size_t node, std::size_t place);
    /// The same, after reading them to the last byte: what is damaged is not known any more.
    bool knows_whole(std::size_t node, std::size_t place) { return knows(node, place) && cache_.whole(keys_.kept(node, place)); }
    bool knows_whole_digest(std::size_t node, std::size_t place) { return knows_digest(node, place) && cache_.whole(keys_.taken(node, place)); }
    /// What was said when the result was computed.
    Said said(std::size_t node, std::size_t place);
    Said said_of_digest(std::size_t node, std::size_t place) const;

    /// Whether a file that a node reads is not the one that keys were made of.
    bool inputs_changed(std::size_t node, std::size_t place);

    /// Kept outputs; nothing if they are gone or damaged.
    std::optional<std::vector<Payload>> result(std::size_t node, std::size_t place);
    std::optional<Payload> digest(std::size_t node, std::size_t place);
    /// Of a growing result: what there is though it is not enough, and what was reported of it.
    std::optional<std::pair<Payload, nlohmann::ordered_json>> part(std::size_t node);

    /// Keeps what a body made, if it is to be kept, and what it said.
    void keep(std::size_t node, std::size_t place, const std::vector<Payload>& outputs, const Said& said);
    void keep_digest(std::size_t node, std::size_t place, const Payload& digest, const Said& said);
    /// Keeps a part of a growing result, unless there is more of it already.
    void keep_grown(const Key& key, std::size_t node, const Payload& result, const Said& said, bool part);

    /// The files that a writer writes for the frame at a place.
    std::vector<std::string> outputs(std::size_t node, std::size_t place) const;

private:
    struct Whole {
        std::vector<Payload> outputs;
        Said said;
    };
    /// A kept result, cut to what is wished for.
    std::optional<Whole> whole(std::size_t node, std::size_t place);
    void keep_files(std::size_t node, std::size_t place, const Said& said);

    const Pipeline& pipeline_;
    const std::vector<int>& frames_;
    Keys& keys_;
    Cache& cache_;
    FileHashes& files_;
};

}  // namespace fluidcarve
