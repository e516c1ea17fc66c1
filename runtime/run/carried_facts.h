#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Facts of readers about their outputs, passed on to the nodes that will receive them: names of
/// grids, and sizes of pictures. They are passed on only as declarations state.
class CarriedFacts {
public:
    explicit CarriedFacts(const Pipeline& pipeline);

    /// Records a fact of a reader. @param frame  frame number; of a static reader, any
    void deliver(std::size_t node, int frame, std::string_view output, SurveyedFacts what);
    /// Facts about the whole payload that an input will receive by its only connection; null:
    /// unknown.
    const SurveyedFacts* receives(std::size_t node, int frame, std::string_view input) const;
    /// Passes facts about a node's inputs on to its outputs. Call it for all nodes in order.
    /// @return a message if the node combines pictures of different sizes; else empty
    std::string carry(std::size_t node, int frame);

private:
    /// A fact, and the reader that it comes from.
    struct KnownFact {
        SurveyedFacts what;
        std::size_t reader = 0;
    };
    using Key = std::pair<int, std::size_t>;  ///< frame number, index of the output
    Key key(const Link& link, int frame) const;
    const KnownFact* known(const Link& link, int frame) const;

    const Pipeline& pipeline_;
    std::vector<std::map<Key, KnownFact>> known_;  ///< `[node]`
};

}  // namespace fluidcarve
