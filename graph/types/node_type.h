#pragma once

#include "formats/file/path_pattern.h"
#include "graph/types/context.h"
#include "graph/types/growth.h"
#include "graph/types/node_check.h"
#include "graph/types/node_hooks.h"
#include "graph/types/node_spec.h"
#include "graph/types/node_traits.h"
#include "graph/types/outlook.h"
#include "graph/types/param.h"
#include "graph/types/payload.h"
#include "graph/types/survey.h"

#include <algorithm>
#include <concepts>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Declares a node type. `Node` is a plain struct with
///
///     struct Params { ... };
///         optional; one const object for all frames; the fields' initialisers are the defaults
///     struct Ports { ... };    inputs and outputs; one object per frame
///     static void run(const Params&, Ports&, Context&);
///         a node that works frame by frame
///
/// A node that gathers frames keeps its state in the struct, and has these members instead of the
/// static `run`:
///
///     void add(const Params&, const Ports&, Context&);
///         called once per frame, in frame order
///     void finish(const Params&, Ports&, Context&);
///         sets the outputs, unless there is a run
///     void run(const Params&, Ports&, Context&) const;
///         optional; called per frame after finish; sets the outputs
///
/// If `add` needs only data that is much smaller than the frame, or expensive to compute, that data
/// can be a digest. Digests are computed for many frames concurrently and cached, so that later
/// runs do not need the frames:
///
///     static std::shared_ptr<Digest> digest(const Params&, const Ports&, Context&);
///         with Declare::digests
///     void add(const Params&, const Ref<Digest>&, Context&);
///         replaces the other add
///
/// Any node may also have
///
///     static NodeTraits traits(const Params&);
///         states whether it gathers, which frames it takes, and what its results depend on
///     static void check(const Params&, NodeCheck&);
///         finds faults that involve several fields
///     static void survey(const Params&, Survey&);
///         looks at its files, and for grids that it needs, before the run
///     static void foresee(const Params&, Outlook&);
///         looks before the run at where its inputs lie
///     static void conclude(const Params&, const nlohmann::ordered_json& frames, Context&);
///         with Declare::concludes
///
/// `conclude` is called once after a run if all of the node's frames are done, in this run or an
/// earlier one. `frames` holds the reports of one section by frame number; of a node that runs
/// once, its only report. It warns, reports and tells lines.
///
/// A node with a growing result (Declare::grows, Growth) may have
///
///     void resume(const Payload& result, const nlohmann::ordered_json& entry);
///
/// It is called once, after the last `add` and before `finish`, if the cache holds a smaller result
/// than wanted, with that result and its report entry. `finish` then continues the result.
template <class Node>
class Declare {
public:
    using Params = typename detail::ParamsOf<Node>::type;
    using Ports = typename Node::Ports;

// Takes a static hook of the node over into its type, if there is one of this name.
#define FLUIDCARVE_TAKE_HOOK(hook, signature)                  \
    if constexpr (detail::has_##hook<Node>) {                  \
        static_assert(                                         \
            requires { type_.hook = on_params(&Node::hook); }, \
            "`" #hook "` must be `" signature "`");            \
        type_.hook = on_params(&Node::hook);                   \
    }

    Declare(std::string name, std::string doc) {
        type_.name = std::move(name);
        type_.doc = std::move(doc);
        type_.make_params = [] { return std::make_shared<Params>(); };
        type_.gathers = has_add;
        type_.per_frame_outputs = has_run;
        FLUIDCARVE_TAKE_HOOK(traits, "static NodeTraits traits(const Params&)");
        FLUIDCARVE_TAKE_HOOK(check, "static void check(const Params&, NodeCheck&)");
        FLUIDCARVE_TAKE_HOOK(survey, "static void survey(const Params&, Survey&)");
        FLUIDCARVE_TAKE_HOOK(foresee, "static void foresee(const Params&, Outlook&)");
        FLUIDCARVE_TAKE_HOOK(
            conclude,
            "static void conclude(const Params&, const nlohmann::ordered_json& frames, Context&)");
        type_.bind = &bind;
    }

#undef FLUIDCARVE_TAKE_HOOK

    template <class M, class P>
    requires std::derived_from<Ports, P> Declare& input(std::string name, M P::*member,
                                                        std::string doc) {
        using Traits = detail::PortTraits<M>;
        type_.inputs.push_back({std::move(name), std::move(doc), Traits::arity,
                                typeid(typename Traits::type),
                                [member](void* ports, const std::vector<Payload>& in,
                                         const std::vector<std::string>& names) {
                                    Traits::set(static_cast<Ports*>(ports)->*member, in, names);
                                },
                                detail::is_optional<M>});
        return *this;
    }

    template <class T, class P>
    requires std::derived_from<Ports, P> Declare& output(std::string name,
                                                         std::shared_ptr<T> P::*member,
                                                         std::string doc) {
        type_.outputs.push_back({std::move(name), std::move(doc), typeid(std::remove_const_t<T>),
                                 [member](const void* ports) {
                                     return Payload(static_cast<const Ports*>(ports)->*member);
                                 }});
        return *this;
    }

    /// Declares further outputs, named and typed by a parameter, delivered in a NamedOutputs port.
    /// @param list  maps parsed params to the name and payload type of each output
    Declare& outputs_from(
        std::string param, NamedOutputs Ports::*member,
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

    /// Raise the version whenever the same inputs give another result: cached results of another
    /// version are not used. Version numbers of the parts of a declaration add up.
    Declare& version(int number) {
        type_.version += number;
        return *this;
    }
    /// Caches results in the work folder by default. For nodes whose results are faster to read
    /// than to compute.
    Declare& kept() {
        type_.kept = true;
        return *this;
    }
    /// Declares that the node has a digest.
    /// @param fields  inputs and parameters that Node::digest depends on
    Declare& digests(std::vector<std::string> fields) {
        static_assert(has_digest);
        type_.digest = typeid(typename Digested<Node>::type);
        type_.digest_fields = std::move(fields);
        return *this;
    }
    /// Declares inputs that a gathering node combines over all frames, so that they do not make its
    /// outputs differ from frame to frame (InputSpec::summed).
    Declare& sums(std::initializer_list<std::string_view> inputs) {
        for (auto& input : type_.inputs)
            input.summed = input.summed || std::ranges::find(inputs, input.name) != inputs.end();
        return *this;
    }
    /// Declares what outputs promise from the parameters alone.
    /// @param promised  the promise of a Params; nothing: there is none
    /// @param fault     why inputs without learns() can't take them
    template <class Promised>
    Declare& promises(Promised promised, std::string fault) {
        type_.promise = [promised,
                         fault = std::move(fault)](const void* params) -> std::optional<Promise> {
            auto fact = promised(*static_cast<const Params*>(params));
            if (!fact) return std::nullopt;
            return Promise{*std::move(fact), fault};
        };
        return *this;
    }
    /// Declares that an input takes outputs that promise something.
    /// @param member  of Params, receives the promise; not a parameter of a pipeline
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& learns(std::string_view input,
                                                          std::optional<T> P::*member) {
        std::ranges::find(type_.inputs, input, &InputSpec::name)->learn =
            [member](const void* params, const std::any& promised) {
                const auto out = std::make_shared<Params>(*static_cast<const Params*>(params));
                // Promises of an unknown type are ignored.
                if (const auto* const known = std::any_cast<T>(&promised)) (*out).*member = *known;
                return std::shared_ptr<const void>(out);
            };
        return *this;
    }
    /// Declares that the node has a `conclude`.
    /// @param section  of the report, where `run` has an entry for each frame
    Declare& concludes(std::string section) {
        static_assert(detail::has_conclude<Node>);
        type_.concludes_from = std::move(section);
        return *this;
    }
    Declare& grows(Growth growth) {
        type_.growth = std::move(growth);
        return *this;
    }
    /// Declares that all inputs and outputs cover the same place. Runs with pictures of different
    /// sizes are then refused.
    Declare& in_place() {
        type_.in_place = true;
        return *this;
    }
    /// Declares the type that replaces this one if an input is connected to an output of another
    /// payload, so that a pipeline needs one name for both.
    template <class Payload>
    Declare& kind(std::string input, std::string type) {
        type_.kinds.push_back({std::move(input), typeid(Payload), std::move(type)});
        return *this;
    }
    /// Declares that its parameters name code that runs with the user's rights.
    Declare& runs_code() {
        type_.runs_code = true;
        return *this;
    }
    /// Declares that the first output is a volume with grids of the same names as an input's.
    Declare& names_from(std::string input) {
        type_.names_from = std::move(input);
        return *this;
    }

    /// A parameter with a default: the value of its field in a fresh Params.
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& param(std::string name, T P::*member, Unit unit,
                                                         Range range, std::string doc) {
        auto spec = make_param(std::move(name), member, unit, range, std::move(doc));
        const Params fresh{};
        spec.fallback = ParamTraits<T>::text(fresh.*member);
        type_.params.push_back(std::move(spec));
        return *this;
    }
    /// The same for a parameter that is not a number.
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& param(std::string name, T P::*member,
                                                         std::string doc) {
        return param(std::move(name), member, Unit::none, any_number(), std::move(doc));
    }
    /// A parameter that every pipeline must state.
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& required(std::string name, T P::*member,
                                                            Unit unit, Range range,
                                                            std::string doc) {
        auto spec = make_param(std::move(name), member, unit, range, std::move(doc));
        spec.required = true;
        type_.params.push_back(std::move(spec));
        return *this;
    }
    template <class T, class P>
    requires std::derived_from<Params, P> Declare& required(std::string name, T P::*member,
                                                            std::string doc) {
        return required(std::move(name), member, Unit::none, any_number(), std::move(doc));
    }

    operator NodeType() const { return type_; }

private:
    static constexpr bool has_run =
        requires(const Node node, const Params params, Ports& ports, Context& context) {
        node.run(params, ports, context);
    };
    static constexpr bool has_digest =
        requires(const Params params, const Ports& ports, Context& context) {
        Node::digest(params, ports, context);
    };
    template <class N>
    struct Digested {
        using type = std::remove_cvref_t<decltype(*N::digest(std::declval<const Params&>(),
                                                             std::declval<const Ports&>(),
                                                             std::declval<Context&>()))>;
    };
    static constexpr bool has_add = has_digest || requires(Node node, const Params params,
                                                           const Ports& ports, Context& context) {
        node.add(params, ports, context);
    };
    /// A static hook of a node, for a NodeType: its parameters have no type.
    template <class R, class P, class... A>
    requires std::derived_from<Params, P>
    static std::function<R(const void*, A...)> on_params(R (*hook)(const P&, A...)) {
        return [hook](const void* params, A... rest) -> R {
            return hook(*static_cast<const Params*>(params), std::forward<A>(rest)...);
        };
    }

    static_assert(has_run || has_add, "a node needs run, or add and finish");
    // Without these checks, a hook with a wrong signature would be ignored.
    static_assert(has_run || !detail::has_run<Node>,
                  "`run` must be `static void run(const Params&, Ports&, Context&)`, or const if "
                  "the node gathers");
    static_assert(has_digest || !detail::has_digest<Node>,
                  "`digest` must be `static std::shared_ptr<T> digest(const Params&, const Ports&, "
                  "Context&)`");
    static_assert(has_add || !detail::has_add<Node>,
                  "`add` must be `void add(const Params&, const Ports&, Context&)`");
    static_assert(
        !detail::has_resume<Node> ||
            requires(Node node, const Payload& result, const nlohmann::ordered_json& entry) {
                node.resume(result, entry);
            },
        "`resume` must be `void resume(const Payload& result, const nlohmann::ordered_json& "
        "entry)`");

    template <class T, class P>
    static ParamSpec make_param(std::string name, T P::*member, Unit unit, Range range,
                                std::string doc) {
        ParamSpec spec;
        spec.name = std::move(name);
        spec.doc = std::move(doc);
        spec.shape = ParamTraits<T>::shape();
        spec.unit = unit;
        spec.range = range;
        spec.text = [member](const void* params) {
            return ParamTraits<T>::text(static_cast<const Params*>(params)->*member);
        };
        spec.parse = [member](void* params, const Value& value, ValueReader& reader) {
            auto got = ParamTraits<T>::parse(value, reader);
            if (got) static_cast<Params*>(params)->*member = std::move(*got);
            return got.has_value();
        };
        if constexpr (std::derived_from<T, PathPattern>)
            spec.path = [member](const void* params) -> const PathPattern& {
                return static_cast<const Params*>(params)->*member;
            };
        if constexpr (std::same_as<T, WrittenPaths>)
            spec.written = [member](const void* params) -> const WrittenPaths& {
                return static_cast<const Params*>(params)->*member;
            };
        return spec;
    }

    static Behaviour bind(std::shared_ptr<const void> erased) {
        auto params = std::static_pointer_cast<const Params>(std::move(erased));
        auto node = std::make_shared<Node>();
        Behaviour out;
        out.make_ports = [] { return std::make_shared<Ports>(); };
        if constexpr (has_run)
            out.run = [params, node](void* ports, Context& context) {
                std::as_const(*node).run(*params, *static_cast<Ports*>(ports), context);
            };
        if constexpr (has_add) {
            bool gathers = true;
            if constexpr (detail::has_traits<Node>) gathers = Node::traits(*params).gathers;
            if (gathers) {
                if constexpr (has_digest) {
                    using Digest = typename Digested<Node>::type;
                    out.digest = [params](const void* ports, Context& context) {
                        return Payload(
                            Node::digest(*params, *static_cast<const Ports*>(ports), context));
                    };
                    out.add_digest = [params, node](const Payload& digest, Context& context) {
                        node->add(*params, digest.as<Digest>(), context);
                    };
                } else {
                    out.add = [params, node](const void* ports, Context& context) {
                        node->add(*params, *static_cast<const Ports*>(ports), context);
                    };
                }
                if constexpr (detail::has_resume<Node>)
                    out.resume = [node](const Payload& result,
                                        const nlohmann::ordered_json& entry) {
                        node->resume(result, entry);
                    };
                out.finish = [params, node](void* ports, Context& context) {
                    node->finish(*params, *static_cast<Ports*>(ports), context);
                };
            }
        }
        return out;
    }

    NodeType type_;
};

}  // namespace fluidcarve
