#pragma once

#include "formats/file/path_pattern.h"
#include "graph/types/context.h"
#include "graph/types/growth.h"
#include "graph/types/node_check.h"
#include "graph/types/node_hooks.h"
#include "graph/types/node_traits.h"
#include "graph/types/outlook.h"
#include "graph/types/param.h"
#include "graph/types/payload.h"
#include "graph/types/survey.h"

#include <any>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <typeindex>
#include <vector>

namespace fluidcarve {

/// Types of input members in a node's `Ports`. A plain Ref<T> is one required connection; the
/// others are:
template <class T>
struct Optional : Ref<T> {  ///< one connection or none; null if unconnected
    using Ref<T>::operator=;
};
template <class T>
using List = std::vector<Ref<T>>;  ///< one connection or more: `terms: [a, b]`
template <class T>
struct OptionalList : List<T> {  ///< empty if unconnected
    using List<T>::operator=;
};
template <class T>
using Named =
    std::vector<std::pair<std::string, Ref<T>>>;  ///< connections with names: `inputs: {d: a}`
template <class T>
struct OptionalNamed : Named<T> {  ///< empty if unconnected
    using Named<T>::operator=;
};
/// Outputs named by a parameter (Declare::outputs_from): name to payload.
using NamedOutputs = std::map<std::string, Payload>;

/// A fact about outputs that follows from parameters alone. Nodes that take the outputs must know
/// it before their frames are counted.
struct Promise {
    std::any fact;
    std::string fault;  ///< why an input that does not know this promise can't take the output
};

/// An input of a node type.
struct InputSpec {
    enum class Arity { one, list, named };
    std::string name;
    std::string doc;
    Arity arity = Arity::one;
    std::type_index type = typeid(void);
    /// Stores the connected payloads, all of type `type`, in a node's Ports.
    /// @param names  of the connections, if the input is named
    std::function<void(void* ports, const std::vector<Payload>&,
                       const std::vector<std::string>& names)>
        set;
    bool optional = false;  ///< may be unconnected
    /// Whether a gathering node combines this input over all frames: differences from frame to
    /// frame do not make its outputs differ.
    bool summed = false;
    /// Returns the parameters with the promise of a connected output added; empty: the input
    /// refuses outputs with promises.
    std::function<std::shared_ptr<const void>(const void* params, const std::any& promised)> learn =
        {};
};

/// An output of a node type.
struct OutputSpec {
    std::string name;
    std::string doc;
    std::type_index type = typeid(void);
    std::function<Payload(const void* ports)> get;
};

/// A parameter of a node type.
struct ParamSpec {
    std::string name;
    std::string doc;
    Shape shape;
    Unit unit = Unit::none;
    Range range;
    bool required = false;
    std::string fallback;  ///< the default as YAML; empty if the parameter is required
    std::function<bool(void* params, const Value&, ValueReader&)> parse;
    /// The value as YAML that `parse` reads back.
    std::function<std::string(const void* params)> text;
    /// The path of a path parameter; empty for all others.
    std::function<const PathPattern&(const void* params)> path;
    /// The files of a parameter of type WrittenPaths, by name; empty for all others.
    std::function<const WrittenPaths&(const void* params)> written;

    /// Whether the value is the path of a file that the node reads, or writes.
    bool reads_file() const { return shape.kind == Shape::Kind::input_path; }
    bool writes_file() const { return shape.kind == Shape::Kind::output_path; }
};

/// A node with bound parameters and, if it gathers, its state. Made anew for every run.
struct Behaviour {
    std::function<std::shared_ptr<void>()> make_ports;
    /// Called per frame, concurrently; empty if the node only gathers.
    std::function<void(void* ports, Context&)> run;
    /// Called in frame order, one at a time; empty if the node digests or does not gather.
    std::function<void(const void* ports, Context&)> add;
    /// Called per frame, concurrently: extracts the digest for `add_digest`
    std::function<Payload(const void* ports, Context&)> digest;
    /// Replaces `add`: called in frame order, one at a time.
    std::function<void(const Payload& digest, Context&)> add_digest;
    /// Hands a growing result of a former run, too small for this run, and its report entry to the
    /// node; called before `finish`.
    std::function<void(const Payload& result, const nlohmann::ordered_json& entry)> resume;
    /// Called once, after the last `add` and before any `run`
    std::function<void(void* ports, Context&)> finish;
};

/// The description of a node type, made by Declare.
struct NodeType {
    std::string name;
    std::string doc;
    std::vector<InputSpec> inputs;
    std::vector<OutputSpec> outputs;
    std::vector<ParamSpec> params;
    std::string outputs_param;  ///< the parameter that names further outputs, or empty
    bool gathers = false;       ///< it has `add` and `finish`; NodeTraits::gathers: they are called
    bool per_frame_outputs = true;  ///< false: `finish` makes the outputs, once
    int version = 1;    ///< part of the cache key: cached results of another version are not used
    bool kept = false;  ///< results are cached in the work folder, unless the pipeline states
                        ///< `cache: false`
    /// Type that `Behaviour::digest` returns; void: no digests.
    std::type_index digest = typeid(void);
    std::vector<std::string> digest_fields;  ///< inputs and parameters that the digest depends on
    std::string concludes_from;  ///< the section of the report that `conclude` gets; empty: there
                                 ///< is no `conclude`
    std::optional<Growth> growth;
    bool runs_code = false;  ///< its parameters name code, such as a script: pipelines with it need
                             ///< --allow-plugins
    /// Outputs cover the same place as inputs: pictures that meet here have one size.
    bool in_place = false;
    /// A type that stands in for this one where an input is connected to a payload.
    struct Kind {
        std::string input;
        std::type_index payload;
        std::string type;
    };
    std::vector<Kind> kinds;
    /// The input with grids of the same names as the first output; empty: none.
    std::string names_from;

    std::function<std::shared_ptr<void>()> make_params;
    std::function<NodeTraits(const void* params)> traits;  ///< empty: as NodeTraits's defaults
    /// Empty: outputs promise nothing.
    std::function<std::optional<Promise>(const void* params)> promise;
    std::function<void(const void* params, NodeCheck&)> check;
    /// Empty: reads no files, and needs no grid of a name.
    std::function<void(const void* params, Survey&)> survey;
    /// Empty: outputs lie where the inputs lie.
    std::function<void(const void* params, Outlook&)> foresee;
    /// Called after a run with what the node reported of all its frames; empty: nothing to say.
    std::function<void(const void* params, const nlohmann::ordered_json& frames, Context&)>
        conclude;
    std::function<std::vector<OutputSpec>(const void* params)> named_outputs;
    std::function<Behaviour(std::shared_ptr<const void> params)> bind;

    const InputSpec* input(std::string_view name) const;
    const ParamSpec* param(std::string_view name) const;
    std::vector<std::string> field_names() const;  ///< names of inputs and parameters
};

namespace detail {
template <class M>
struct PortTraits;
template <class T>
struct PortTraits<Ref<T>> {
    using type = T;
    static constexpr auto arity = InputSpec::Arity::one;
    static void set(Ref<T>& port, const std::vector<Payload>& in, const std::vector<std::string>&) {
        port = in.empty() ? nullptr : in[0].as<T>();
    }
};
template <class T>
struct PortTraits<Optional<T>> : PortTraits<Ref<T>> {};
template <class T>
struct PortTraits<List<T>> {
    using type = T;
    static constexpr auto arity = InputSpec::Arity::list;
    static void set(List<T>& port, const std::vector<Payload>& in,
                    const std::vector<std::string>&) {
        port.clear();
        for (const auto& payload : in) port.push_back(payload.as<T>());
    }
};
template <class T>
struct PortTraits<OptionalList<T>> : PortTraits<List<T>> {};
template <class T>
struct PortTraits<Named<T>> {
    using type = T;
    static constexpr auto arity = InputSpec::Arity::named;
    static void set(Named<T>& port, const std::vector<Payload>& in,
                    const std::vector<std::string>& names) {
        port.clear();
        for (std::size_t n = 0; n < in.size(); ++n) port.emplace_back(names[n], in[n].as<T>());
    }
};
template <class T>
struct PortTraits<OptionalNamed<T>> : PortTraits<Named<T>> {};
template <class M>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<Optional<T>> = true;
template <class T>
inline constexpr bool is_optional<OptionalList<T>> = true;
template <class T>
inline constexpr bool is_optional<OptionalNamed<T>> = true;
struct NoParams {};
template <class Node>
struct ParamsOf {
    using type = NoParams;
};
template <class Node>
requires requires { typename Node::Params; }
struct ParamsOf<Node> {
    using type = typename Node::Params;
};
}  // namespace detail

}  // namespace fluidcarve
