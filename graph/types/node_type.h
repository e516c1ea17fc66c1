#pragma once

#include "graph/types/context.h"
#include "graph/types/param.h"
#include "graph/types/payload.h"

#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <typeindex>
#include <vector>

namespace fluidcarve {

/// Port members of a node's `Ports`, besides a plain Ref<T> (one connection, required):
template <class T>
struct Optional : Ref<T> {  ///< may stay unconnected, then null
    using Ref<T>::operator=;
};
template <class T>
using List = std::vector<Ref<T>>;  ///< `terms: [a, b]`
template <class T>
struct OptionalList : List<T> {  ///< may stay unconnected, then empty
    using List<T>::operator=;
};
template <class T>
using Named = std::vector<std::pair<std::string, Ref<T>>>;  ///< `inputs: {d: a}`
/// Outputs that a parameter names (`outputs_from`).
using NamedOutputs = std::map<std::string, Payload>;

struct InputSpec {
    enum class Arity { one, list, named };
    std::string name;
    std::string doc;
    Arity arity = Arity::one;
    std::type_index type = typeid(void);
    /// Hands the connected payloads, of `type`, to a node's Ports. `names`: those of a named input.
    std::function<void(void* ports, const std::vector<Payload>&, const std::vector<std::string>& names)> set;
    bool optional = false;  ///< may stay unconnected
};

struct OutputSpec {
    std::string name;
    std::string doc;
    std::type_index type = typeid(void);
    std::function<Payload(const void* ports)> get;
};

struct ParamSpec {
    std::string name;
    std::string doc;
    Shape shape;
    Unit unit = Unit::none;
    Range range;
    bool required = false;
    std::string fallback;  ///< the default, as YAML; empty where required
    std::function<bool(void* params, const Value&, ValueReader&)> parse;
    std::function<std::string(const void* params)> text;  ///< the value, as YAML that parses to the same
    /// Set for path parameters: the pattern in parsed params.
    std::function<const PathPattern&(const void* params)> path;
};

/// What a node's own `check` may ask and say: faults that the declaration alone can't express.
class NodeCheck {
public:
    virtual ~NodeCheck() = default;
    virtual bool stated(std::string_view field) const = 0;  ///< the user wrote this port or parameter
    virtual std::size_t connections(std::string_view input) const = 0;
    virtual void fault(std::string_view field, const std::string& message) = 0;  ///< at the field's place, or the node's
};

/// What a reader says of its files before a run starts.
class Survey {
public:
    virtual ~Survey() = default;
    virtual const std::vector<int>& frames() const = 0;
    virtual bool needs(int frame) const = 0;                          ///< whether the run will read the frame
    virtual bool wants(std::string_view output) const = 0;            ///< whether the run will read the output
    virtual void stands_in(int frame, int file) = 0;                  ///< the file of frame `file` serves `frame`
    virtual void expect(int frame, std::uint64_t bytes) = 0;          ///< memory that the frame will take, by what its file says
    virtual void leave_out(int frame) = 0;                            ///< for every node; its neighbours become adjacent in time
    virtual void missing(int frame, const std::string& message) = 0;  ///< or there, but unreadable
    virtual void warn(const std::string& message) = 0;
};

/// How much a growing result holds.
struct Extent {
    std::size_t count = 0;
    std::size_t of = 0;  ///< what a percentage is of
};

/// A node whose result holds the answers to smaller wishes, and can be continued to larger ones: a solver, whose first seams
/// are the same however many are asked for. Then it has but one output.
struct Growth {
    std::string param;                                    ///< how much is wished for: no part of what the result depends on,
    std::function<std::string(const void* params)> rest;  ///< but for this, as text
    std::function<Extent(const Payload& result)> extent;  ///< of what is there
    std::function<std::size_t(const void* params, std::size_t of)> wanted;
    /// The first `count`, and a report entry of all turned into one of these.
    std::function<Payload(const Payload& result, std::size_t count, nlohmann::ordered_json& entry)> first;
    /// Those of the node's warnings that depend on how much there is, by its report entry; empty: there are none.
    std::function<std::vector<std::string>(const nlohmann::ordered_json& entry)> warnings = nullptr;
};

/// A node at work: parameters bound, state of its own if it gathers. Made anew for every run.
struct Behaviour {
    std::function<std::shared_ptr<void>()> make_ports;
    std::function<void(void* ports, Context&)> run;              ///< per frame, concurrently; empty if the node only gathers
    std::function<void(const void* ports, Context&)> add;        ///< in frame order, one at a time; empty if it gathers nothing, or digests
    std::function<Payload(const void* ports, Context&)> digest;  ///< per frame, concurrently: what `take` needs of it
    std::function<void(const Payload& digest, Context&)> take;   ///< in frame order, one at a time, in place of `add`
    /// Before `finish`, of a growing result: what was found before, less than is wished for, and what was reported of it.
    std::function<void(const Payload& result, const nlohmann::ordered_json& entry)> resume;
    std::function<void(void* ports, Context&)> finish;  ///< once, after the last add; before any run
    std::function<bool(const Context&)> wants;          ///< whether `add` needs the context's frame
};

/// All that is known of a node type. Made by Declare.
struct NodeType {
    std::string name;
    std::string doc;
    std::vector<InputSpec> inputs;
    std::vector<OutputSpec> outputs;
    std::vector<ParamSpec> params;
    std::string outputs_param;               ///< the parameter that names further outputs, or empty
    bool per_frame_outputs = true;           ///< false: outputs come from `finish`, once
    int version = 1;                         ///< of its results: those of another version are not used again
    bool kept = false;                       ///< results are worth a file in the work folder, unless the pipeline says otherwise
    std::type_index digest = typeid(void);   ///< what `Behaviour::digest` makes; void: nothing
    std::vector<std::string> digest_fields;  ///< inputs and parameters that it depends on
    std::optional<Growth> growth;

    std::function<std::shared_ptr<void>()> make_params;
    std::function<bool(const void* params)> gathers;
    std::function<bool(const void* params)> animates;  ///< delivers something else in each frame, though no input or file does; empty: never
    std::function<void(const void* params, NodeCheck&)> check;
    std::function<void(const void* params, Survey&)> survey;  ///< empty: opens no files
    std::function<std::vector<OutputSpec>(const void* params)> named_outputs;
    std::function<Behaviour(std::shared_ptr<const void> params)> bind;

    const InputSpec* input(std::string_view name) const;
    const ParamSpec* param(std::string_view name) const;
    std::vector<std::string> field_names() const;  ///< inputs and parameters
};

namespace detail {
template <class M>
struct PortTraits;
template <class T>
struct PortTraits<Ref<T>> {
    using type = T;
    static constexpr auto arity = InputSpec::Arity::one;
    static void set(Ref<T>& port, const std::vector<Payload>& in, const std::vector<std::string>&) { port = in.empty() ? nullptr : in[0].as<T>(); }
};
template <class T>
struct PortTraits<Optional<T>> : PortTraits<Ref<T>> {};
template <class T>
struct PortTraits<List<T>> {
    using type = T;
    static constexpr auto arity = InputSpec::Arity::list;
    static void set(List<T>& port, const std::vector<Payload>& in, const std::vector<std::string>&) {
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
    static void set(Named<T>& port, const std::vector<Payload>& in, const std::vector<std::string>& names) {
        port.clear();
        for (std::size_t n = 0; n < in.size(); ++n) port.emplace_back(names[n], in[n].as<T>());
    }
};
template <class M>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<Optional<T>> = true;
template <class T>
inline constexpr bool is_optional<OptionalList<T>> = true;
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

/// The one declaration of a node type. `Node` is a plain struct with
///
///     struct Params { ... };   optional; one, const, for all frames; the fields' initialisers are the defaults
///     struct Ports { ... };    inputs and outputs, one per frame
///     static void run(const Params&, Ports&, Context&);              a node that works frame by frame
///
/// or, if it gathers, the members (state lives in the struct; `add` comes once per frame in the order of frames)
///
///     void add(const Params&, const Ports&, Context&);
///     void finish(const Params&, Ports&, Context&);                  sets the outputs, unless there is a run
///     void run(const Params&, Ports&, Context&) const;               optional; per frame, after finish; sets the outputs
///     static bool gathers(const Params&);                            optional; false: add and finish are left out
///     static bool wants(const Params&, const Context&);              optional; false: add does not need this frame
///
/// What `add` needs of a frame may be small beside the frame, or dear to find. Then it is a value of its own, which is found
/// for many frames at once and kept, so that no later run needs the frame:
///
///     static std::shared_ptr<Digest> digest(const Params&, const Ports&, Context&);       with Declare::digests
///     void add(const Params&, const Ref<Digest>&, Context&);                              in place of the other add
///
/// and, each optional,
///
///     static bool animates(const Params&);                           runs per frame, though no input or file of its own does
///     static void check(const Params&, NodeCheck&);                  what one field alone does not show
///     static void survey(const Params&, Survey&);                    which of its files are there
template <class Node>
class Declare {
public:
    using Params = typename detail::ParamsOf<Node>::type;
    using Ports = typename Node::Ports;

    Declare(std::string name, std::string doc) {
        type_.name = std::move(name);
        type_.doc = std::move(doc);
        type_.make_params = [] { return std::make_shared<Params>(); };
        type_.per_frame_outputs = has_run;
        type_.gathers = [](const void* params) {
            if constexpr (!has_add) return (void)params, false;
            else if constexpr (requires { Node::gathers(Params{}); }) return Node::gathers(*static_cast<const Params*>(params));
            else return (void)params, true;
        };
        if constexpr (requires { Node::animates(Params{}); })
            type_.animates = [](const void* params) { return Node::animates(*static_cast<const Params*>(params)); };
        if constexpr (requires(NodeCheck & check) { Node::check(Params{}, check); })
            type_.check = [](const void* params, NodeCheck& check) { Node::check(*static_cast<const Params*>(params), check); };
        if constexpr (requires(Survey & survey) { Node::survey(Params{}, survey); })
            type_.survey = [](const void* params, Survey& survey) { Node::survey(*static_cast<const Params*>(params), survey); };
        type_.bind = &bind;
    }

    template <class M, class P>
    requires std::derived_from<Ports, P> Declare& input(std::string name, M P::*member, std::string doc) {
        using Traits = detail::PortTraits<M>;
        type_.inputs.push_back({std::move(name), std::move(doc), Traits::arity, typeid(typename Traits::type),
                                [member](void* ports, const std::vector<Payload>& in, const std::vector<std::string>& names) {
                                    Traits::set(static_cast<Ports*>(ports)->*member, in, names);
                                },
                                detail::is_optional<M>});
        return *this;
    }

    template <class T, class P>
    requires std::derived_from<Ports, P> Declare& output(std::string name, std::shared_ptr<T> P::*member, std::string doc) {
        type_.outputs.push_back({std::move(name), std::move(doc), typeid(std::remove_const_t<T>),
                                 [member](const void* ports) { return Payload(static_cast<const Ports*>(ports)->*member); }});
        return *this;
    }

    /// Further outputs, named and typed by a parameter, delivered in a NamedOutputs port.
    /// @param list  parsed params -> name and payload type of each
    Declare& outputs_from(std::string param, NamedOutputs Ports::*member,
                          std::function<std::vector<std::pair<std::string, std::type_index>>(const Params&)> list) {
        type_.outputs_param = std::move(param);
        type_.named_outputs = [member, list = std::move(list)](const void* params) {
            std::vector<OutputSpec> out;
            for (const auto& [name, type] : list(*static_cast<const Params*>(params)))
                out.push_back({name, {}, type, [member, name = name](const void* ports) {
                                   const auto& made = static_cast<const Ports*>(ports)->*member;
                                   const auto found = made.find(name);
                                   return found == made.end() ? Payload() : found->second;
                               }});
            return out;
        };
        return *this;
    }

    /// Results of another version are not used again: to be raised whenever the same inputs come to give another result.
    Declare& version(int number) {
        type_.version = number;
        return *this;
    }
    /// Results are worth a file in the work folder: reading them takes less time than making them.
    Declare& kept() {
        type_.kept = true;
        return *this;
    }
    /// @param fields  inputs and parameters that Node::digest depends on
    Declare& digests(std::vector<std::string> fields) {
        static_assert(has_digest);
        type_.digest = typeid(typename Digested<Node>::type);
        type_.digest_fields = std::move(fields);
        return *this;
    }
    Declare& grows(Growth growth) {
        type_.growth = std::move(growth);
        return *this;
    }

    /// A parameter with a default: the value of its field in a fresh Params.
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& param(std::string name, T P::*member, Unit unit, Range range, std::string doc) {
        auto spec = make_param(std::move(name), member, unit, range, std::move(doc));
        const Params fresh{};
        spec.fallback = ParamTraits<T>::text(fresh.*member);
        type_.params.push_back(std::move(spec));
        return *this;
    }
    /// The same for what is no number.
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& param(std::string name, T P::*member, std::string doc) {
        return param(std::move(name), member, Unit::none, any_number(), std::move(doc));
    }
    /// A parameter that every pipeline must state.
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& required(std::string name, T P::*member, Unit unit, Range range, std::string doc) {
        auto spec = make_param(std::move(name), member, unit, range, std::move(doc));
        spec.required = true;
        type_.params.push_back(std::move(spec));
        return *this;
    }
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& required(std::string name, T P::*member, std::string doc) {
        return required(std::move(name), member, Unit::none, any_number(), std::move(doc));
    }

    operator NodeType() const { return type_; }

private:
    static constexpr bool has_run = requires(const Node node, const Params params, Ports& ports, Context& context) { node.run(params, ports, context); };
    static constexpr bool has_digest = requires(const Params params, const Ports& ports, Context& context) { Node::digest(params, ports, context); };
    template <class N>
    struct Digested {
        using type = std::remove_cvref_t<decltype(*N::digest(std::declval<const Params&>(), std::declval<const Ports&>(), std::declval<Context&>()))>;
    };
    static constexpr bool has_add = has_digest || requires(Node node, const Params params, const Ports& ports, Context& context) {
        node.add(params, ports, context);
    };
    static_assert(has_run || has_add, "a node needs run, or add and finish");

    template <class T, class P>
    static ParamSpec make_param(std::string name, T P::*member, Unit unit, Range range, std::string doc) {
        ParamSpec spec;
        spec.name = std::move(name);
        spec.doc = std::move(doc);
        spec.shape = ParamTraits<T>::shape();
        spec.unit = unit;
        spec.range = range;
        spec.text = [member](const void* params) { return ParamTraits<T>::text(static_cast<const Params*>(params)->*member); };
        spec.parse = [member](void* params, const Value& value, ValueReader& reader) {
            auto got = ParamTraits<T>::parse(value, reader);
            if (got) static_cast<Params*>(params)->*member = std::move(*got);
            return got.has_value();
        };
        if constexpr (std::derived_from<T, PathPattern>)
            spec.path = [member](const void* params) -> const PathPattern& { return static_cast<const Params*>(params)->*member; };
        return spec;
    }

    static Behaviour bind(std::shared_ptr<const void> erased) {
        auto params = std::static_pointer_cast<const Params>(std::move(erased));
        auto node = std::make_shared<Node>();
        Behaviour out;
        out.make_ports = [] { return std::make_shared<Ports>(); };
        if constexpr (has_run)
            out.run = [params, node](void* ports, Context& context) { std::as_const(*node).run(*params, *static_cast<Ports*>(ports), context); };
        if constexpr (has_add) {
            bool gathers = true;
            if constexpr (requires { Node::gathers(Params{}); }) gathers = Node::gathers(*params);
            if (gathers) {
                if constexpr (has_digest) {
                    using Digest = typename Digested<Node>::type;
                    out.digest = [params](const void* ports, Context& context) {
                        return Payload(Node::digest(*params, *static_cast<const Ports*>(ports), context));
                    };
                    out.take = [params, node](const Payload& digest, Context& context) { node->add(*params, digest.as<Digest>(), context); };
                } else {
                    out.add = [params, node](const void* ports, Context& context) { node->add(*params, *static_cast<const Ports*>(ports), context); };
                }
                if constexpr (requires(Node & each, const Payload& result, const nlohmann::ordered_json& entry) { each.resume(result, entry); })
                    out.resume = [node](const Payload& result, const nlohmann::ordered_json& entry) { node->resume(result, entry); };
                out.finish = [params, node](void* ports, Context& context) { node->finish(*params, *static_cast<Ports*>(ports), context); };
                if constexpr (requires(const Context& context) { Node::wants(Params{}, context); })
                    out.wants = [params](const Context& context) { return Node::wants(*params, context); };
            }
        }
        return out;
    }

    NodeType type_;
};

}  // namespace fluidcarve
