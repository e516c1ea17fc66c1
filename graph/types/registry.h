#pragma once

#include "graph/types/node_type.h"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The family of a node type by its name: "mask" of "mask.box".
std::string family_of(std::string_view type);

/// The node types, payload types, conversions and selections that a pipeline may use. A plain value
/// that the program, or a test, fills.
class Registry {
public:
    /// @throws std::logic_error if the name is taken, a doc string is empty, or a port's payload
    ///   type is not registered
    void add(NodeType type);
    void add(PayloadType type);
    void add(Conversion conversion);
    void add(Selection selection);

    const NodeType* node(std::string_view name) const;
    std::vector<std::string> node_names() const;  ///< sorted
    std::vector<std::string> families() const;    ///< of node types: "mask"; sorted
    const PayloadType& payload(std::type_index type) const;
    const std::map<std::string, NodeType, std::less<>>& nodes() const { return nodes_; }
    const std::vector<PayloadType>& payloads() const { return payloads_; }

    /// Whether an input of type `to` takes a payload of type `from`, with or without a conversion.
    bool accepts(std::type_index to, std::type_index from) const;
    Payload convert(const Payload& payload, std::type_index to) const;
    /// The selection of parts of type `to` from payloads of type `from`; null if there is none.
    const Selection* selection(std::type_index from, std::type_index to) const;
    /// Names of all payload types that an input of the type takes: "volume, float or vector".
    std::string accepted_names(std::type_index to) const;
    /// The same for an input of a node type, including payloads that select its kinds
    /// (Declare::kind).
    std::string accepted_names(const NodeType& type, const InputSpec& input) const;

private:
    std::vector<std::string> names_into(std::type_index to) const;
    const Conversion* conversion(std::type_index from, std::type_index to) const;
    std::map<std::string, NodeType, std::less<>> nodes_;
    std::vector<PayloadType> payloads_;
    std::vector<Conversion> conversions_;
    std::vector<Selection> selections_;
};

}  // namespace fluidcarve
