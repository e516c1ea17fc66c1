#pragma once

#include "graph/node_type.h"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The node types and payload types that a pipeline may use. A plain value: the program fills one, so may a test.
class Registry {
public:
    /// @throws std::logic_error if the name is taken, a text is empty, or a port's payload type is not registered
    void add(NodeType type);
    void add(PayloadType type);
    void add(Conversion conversion);

    const NodeType* node(std::string_view name) const;
    std::vector<std::string> node_names() const;  ///< sorted
    const PayloadType& payload(std::type_index type) const;
    const std::map<std::string, NodeType, std::less<>>& nodes() const { return nodes_; }
    const std::vector<PayloadType>& payloads() const { return payloads_; }

    /// Whether an input of type `to` takes a payload of type `from`, as it is or converted.
    bool accepts(std::type_index to, std::type_index from) const;
    Payload convert(const Payload& payload, std::type_index to) const;
    /// "volume, float or vector": all that an input of the type takes.
    std::string accepted_names(std::type_index to) const;

private:
    const Conversion* conversion(std::type_index from, std::type_index to) const;
    std::map<std::string, NodeType, std::less<>> nodes_;
    std::vector<PayloadType> payloads_;
    std::vector<Conversion> conversions_;
};

}  // namespace fluidcarve
