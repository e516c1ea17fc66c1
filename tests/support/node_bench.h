#pragma once

#include "graph/text/yaml_reader.h"
#include "graph/types/node_type.h"
#include "tests/support/failure_of.h"

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace fluidcarve::test {

/// One node at work without a pipeline: parameters from YAML, ports set by the test.
class NodeBench {
public:
    /// Carves classically where the parameters do not say otherwise: `soft` and `spread` are 0.
    /// @param yaml  the parameters, as in a pipeline: `gain: 2`
    /// @param connected  how many connections each input has
    explicit NodeBench(NodeType type, const std::string& yaml = "{}",
                       const std::map<std::string, std::size_t>& connected = {})
        : type_(std::move(type)) {
        const auto params = type_.make_params();
        Problems problems;
        const auto set = [&](const ParamSpec& spec, const std::string& name, const Value& value) {
            ValueReader reader(problems, name, spec.range);
            spec.parse(params.get(), value, reader);
        };
        for (const auto* const name : {"soft", "spread"})
            if (const auto* const spec = type_.param(name))
                set(*spec, name,
                    read_yaml(std::make_shared<Source>(Source{"test", "n: 0", ""}), problems)
                        .fields.front()
                        .value);
        const auto value = read_yaml(std::make_shared<Source>(Source{"test", yaml, ""}), problems);
        for (const auto& field : value.fields) {
            const auto* const spec = type_.param(field.name);
            if (!spec) throw std::logic_error("no parameter " + field.name);
            set(*spec, field.name, field.value);
        }
        for (const auto& problem : problems) faults_ += problem.message + "\n";
        if (faults_.empty() && type_.check) {
            Check check(value, connected, faults_);
            type_.check(params.get(), check);
        }
        params_ = params;
        if (!faults_.empty()) return;
        behaviour_ = type_.bind(params_);
        if (type_.named_outputs)
            for (const auto& output : type_.named_outputs(params_.get()))
                type_.outputs.push_back(output);
    }

    /// What a user would be told of the parameters, a line each.
    const std::string& faults() const { return faults_; }
    bool gathers() const {
        return type_.gathers && (!type_.traits || type_.traits(params_.get()).gathers);
    }
    const NodeType& type() const { return type_; }
    const void* params() const { return params_.get(); }

    using Inputs = std::map<std::string, std::vector<Payload>>;
    /// What a node that digests makes of a frame.
    Payload digest(const Inputs& inputs, Context context = {}) const {
        return behaviour_.digest(ports(inputs).get(), context);
    }
    void add_digest(const Payload& digest, Context context = {}) {
        behaviour_.add_digest(digest, context);
    }
    /// By way of the digest if there is one.
    void add(const Inputs& inputs, Context context = {}) {
        if (behaviour_.digest) add_digest(digest(inputs, context), context);
        else behaviour_.add(ports(inputs).get(), context);
    }
    void resume(const Payload& result, const nlohmann::ordered_json& entry) {
        behaviour_.resume(result, entry);
    }
    void finish(Context context = {}) { behaviour_.finish(ports({}).get(), context); }
    /// `finish` of a node whose outputs come once. @return as run
    std::map<std::string, Payload> gathered(const Inputs& inputs, Context context = {}) {
        const auto made = ports(inputs);
        behaviour_.finish(made.get(), context);
        return outputs(made.get());
    }
    /// @return the outputs by name; null payloads left out
    std::map<std::string, Payload> run(const Inputs& inputs, Context context = {}) {
        const auto made = ports(inputs);
        behaviour_.run(made.get(), context);
        return outputs(made.get());
    }

    struct Surveyed : Survey {
        std::vector<int> all;
        std::set<int> left_out;
        std::map<int, int> stood_in;  ///< frame -> the frame whose file serves it
        std::map<int, std::string> absent;
        std::map<std::string, Region> regions;  ///< by output
        std::vector<std::string> warnings;
        std::vector<Pick> picked;
        const std::vector<int>& frames() const override { return all; }
        void stands_in(int frame, int file) override { stood_in[frame] = file; }
        void leave_out(int frame) override { left_out.insert(frame); }
        void expect(int, std::uint64_t) override {}
        void missing(int frame, const std::string& message) override { absent[frame] = message; }
        bool needs(int) const override { return true; }
        bool wants(std::string_view) const override { return true; }
        void lies(std::string_view output, const Region& region) override {
            regions.emplace(output, region);
        }
        const std::vector<Pick>& picks() const override { return picked; }
        void warn(const std::string& message) override { warnings.push_back(message); }
        void delivers(int frame, std::string_view output, SurveyedFacts what) override {
            delivered[{frame, std::string(output)}] = std::move(what);
        }
        const SurveyedFacts* receives(int, std::string_view input) const override {
            const auto found = received.find(std::string(input));
            return found == received.end() ? nullptr : &found->second;
        }
        std::map<std::pair<int, std::string>, SurveyedFacts> delivered;
        std::map<std::string, SurveyedFacts> received;  ///< by input, in all frames
    };
    /// @param received  what readers say of the inputs
    /// @param picks     parts that other nodes take of its first output
    Surveyed survey(std::vector<int> frames, std::map<std::string, SurveyedFacts> received = {},
                    std::vector<Pick> picks = {}) const {
        Surveyed out;
        out.all = std::move(frames);
        out.received = std::move(received);
        out.picked = std::move(picks);
        type_.survey(params_.get(), out);
        return out;
    }

    using Regions = std::map<std::string, Region, std::less<>>;                     ///< by input
    using Received = std::map<std::string, std::vector<OutputFacts>, std::less<>>;  ///< by input
    struct Ahead : Outlook {
        const Regions& inputs;
        const Received& known;
        bool runs_once;
        std::optional<Region> outputs;
        OutputFacts facts;
        std::vector<std::string> warnings, faults;
        Ahead(const Regions& inputs, const Received& known, bool once)
            : inputs(inputs), known(known), runs_once(once) {}
        const Region* region(std::string_view input) const override {
            const auto found = inputs.find(input);
            return found == inputs.end() ? nullptr : &found->second;
        }
        const std::vector<OutputFacts>& receives(std::string_view input) const override {
            static const std::vector<OutputFacts> none;
            const auto found = known.find(input);
            return found == known.end() ? none : found->second;
        }
        bool once() const override { return runs_once; }
        std::size_t frames() const override { return 1; }
        void lies(const Region& region) override { outputs = region; }
        void delivers(const OutputFacts& stated) override { facts = stated; }
        void warn(const std::string& message) override { warnings.push_back(message); }
        void fault(const std::string& message) override { faults.push_back(message); }
    };
    /// What a node foresees if its inputs lie there. @param inputs  those that are known
    Ahead foresee(const Regions& inputs = {}, const Received& received = {},
                  bool once = false) const {
        Ahead out(inputs, received, once);
        type_.foresee(params_.get(), out);
        return out;
    }

private:
    struct Check : NodeCheck {
        const Value& value;
        const std::map<std::string, std::size_t>& connected;
        std::string& faults;
        Check(const Value& value, const std::map<std::string, std::size_t>& connected,
              std::string& faults)
            : value(value), connected(connected), faults(faults) {}
        bool stated(std::string_view field) const override {
            return value.find(field) || connected.contains(std::string(field));
        }
        std::size_t connections(std::string_view input) const override {
            const auto found = connected.find(std::string(input));
            return found == connected.end() ? 0 : found->second;
        }
        std::vector<std::string> names(std::string_view) const override { return {}; }
        void fault(std::string_view field, const std::string& message) override {
            faults += std::string(field) + ": " + message + "\n";
        }
        void fault(const Mark& at, const std::string& message) override {
            faults += std::to_string(at.line) + ": " + message + "\n";
        }
        void warn(std::string_view, const std::string&) override {}
    };

    std::map<std::string, Payload> outputs(const void* made) const {
        std::map<std::string, Payload> out;
        for (const auto& output : type_.outputs)
            if (const auto payload = output.get(made)) out[output.name] = payload;
        return out;
    }

    std::shared_ptr<void> ports(const Inputs& inputs) const {
        auto out = behaviour_.make_ports();
        for (const auto& [name, payloads] : inputs) type_.input(name)->set(out.get(), payloads, {});
        return out;
    }

    NodeType type_;
    std::shared_ptr<const void> params_;
    Behaviour behaviour_;
    std::string faults_;
};

}  // namespace fluidcarve::test
