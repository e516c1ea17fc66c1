#pragma once

#include "graph/types/node_type.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// How the program looks into a kind of file (`fluidcarve inspect`), whatever is in it.
struct FileInspector {
    std::string ending;  ///< of the files' names: ".vdb"
    /// What is in a file; called in a process of its own, since the file may be damaged. @throws Failure
    std::function<nlohmann::ordered_json(const std::string& path)> look;
    /// What several such files, looked at in order, have to do with each other; a line each.
    std::function<std::vector<std::string>(const std::vector<nlohmann::ordered_json>&)> compare;
    /// What `look` found, for people.
    std::function<std::string(const nlohmann::ordered_json&)> text;
};

/// What a node of any type may state beside its own inputs and parameters: its type, whether its results are kept, words for people.
inline constexpr std::array<std::string_view, 3> common_fields{"type", "cache", "doc"};
bool is_common_field(std::string_view name);

/// The node types and payload types that a pipeline may use. A plain value: the program fills one, so may a test.
class Registry {
public:
    /// @throws std::logic_error if the name is taken, a text is empty, or a port's payload type is not registered
    void add(NodeType type);
    void add(PayloadType type);
    void add(Conversion conversion);
    void add(FileInspector inspector) { inspectors_.push_back(std::move(inspector)); }

    const NodeType* node(std::string_view name) const;
    std::vector<std::string> node_names() const;  ///< sorted
    const PayloadType& payload(std::type_index type) const;
    const std::map<std::string, NodeType, std::less<>>& nodes() const { return nodes_; }
    const std::vector<PayloadType>& payloads() const { return payloads_; }
    const std::vector<FileInspector>& inspectors() const { return inspectors_; }

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
    std::vector<FileInspector> inspectors_;
};

}  // namespace fluidcarve
