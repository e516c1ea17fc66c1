#pragma once

#include "carve/lattice/build.h"
#include "nodes/lattice.h"
#include "tests/support/node_bench.h"

#include <cmath>
#include <string>
#include <vector>

namespace fluidcarve::test {

inline Rig through(std::vector<openvdb::Vec3d> points, bool closed = false,
                   const openvdb::Vec3d& up = {0, 0, 1}) {
    Rig out;
    out.points = std::move(points);
    out.closed = closed;
    out.up = up;
    return out;
}

inline LatticeSpec spec(double spacing, std::array<double, 2> u = {-0.5, 0.5},
                        std::array<double, 2> v = {-0.5, 0.5}) {
    LatticeSpec out;
    out.spacing = spacing;
    out.u = u;
    out.v = v;
    return out;
}

struct Heard : Context::Host {
    std::vector<std::string> warnings;
    nlohmann::ordered_json reported;
    void warn(const std::string& message) override { warnings.push_back(message); }
    void report(const std::string& section, const nlohmann::ordered_json& entry) override {
        reported[section] = entry;
    }
};

/// All lattices of lattice.build, or of another node, and what it said.
struct Run {
    std::vector<Ref<Lattice>> lattices;
    Heard heard;

    Run(const std::string& yaml, const std::vector<Rig>& rigs, const std::vector<int>& frames = {},
        const NodeType& type = lattice_build()) {
        NodeBench bench(type, yaml, {{"rig", 1}});
        REQUIRE(bench.faults().empty());
        const std::vector<int> none{1};
        Context context(heard, frames.empty() ? none : frames);
        const auto at = [&](std::size_t t) {
            return frames.empty() ? context : Context(heard, frames).at(t);
        };
        const auto input = [&](std::size_t t) {
            return NodeBench::Inputs{{"rig", {Payload(std::make_shared<Rig>(rigs[t]))}}};
        };
        for (std::size_t t = 0; t < rigs.size(); ++t) bench.add(input(t), at(t));
        bench.finish(context);
        for (std::size_t t = 0; t < rigs.size(); ++t)
            lattices.push_back(bench.run(input(t), at(t)).at("lattice").as<Lattice>());
    }
};

inline std::vector<openvdb::Vec3d> helix_points(double rise = 0.3) {
    std::vector<openvdb::Vec3d> out;
    for (int n = 0; n <= 2000; ++n) {
        const double a = 6 * M_PI * n / 2000;
        out.push_back({2 * std::cos(a), 2 * std::sin(a), rise * a});
    }
    return out;
}

/// Closed and not flat, so that carrying the basis around turns it.
inline std::vector<openvdb::Vec3d> saddle_points() {
    std::vector<openvdb::Vec3d> out;
    for (int n = 0; n < 3000; ++n) {
        const double a = 2 * M_PI * n / 3000;
        out.push_back({3 * std::cos(a), 3 * std::sin(a), std::sin(2 * a) + 0.5 * std::cos(3 * a)});
    }
    return out;
}

/// A lattice around a rig.
inline Lattice around(const Rig& rig, double radius, double spacing) {
    auto of = spec(spacing, {0, radius});
    of.around = true;
    return build_lattice(rig, of).lattice;
}

}  // namespace fluidcarve::test
