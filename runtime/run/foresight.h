#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {

/// What readers say of their outputs, carried on to the nodes that will receive them: names of
/// grids, and sizes of pictures. What no declaration carries on is not known.
class Foresight {
public:
    explicit Foresight(const Pipeline& pipeline);

    /// Takes down what a reader says. @param frame  frame number; of a static reader, any
    void deliver(std::size_t node, int frame, std::string_view output, Foreseen what);
    /// What an input will receive by its only connection, as a whole; null: not known.
    const Foreseen* receives(std::size_t node, int frame, std::string_view input) const;
    /// Carries on what is known of a node's inputs to its outputs. To be called for all nodes in
    /// order.
    /// @return a message, if the node lays pictures of different sizes over each other; empty: it
    ///   does not
    std::string carry(std::size_t node, int frame);

private:
    /// A fact, and the reader that it comes from.
    struct Known {
        Foreseen what;
        std::size_t reader = 0;
    };
    using Key = std::pair<int, std::size_t>;  ///< frame number, index of the output
    Key key(const Link& link, int frame) const;
    const Known* known(const Link& link, int frame) const;

    const Pipeline& pipeline_;
    std::vector<std::map<Key, Known>> known_;  ///< `[node]`
};

}  // namespace fluidcarve
