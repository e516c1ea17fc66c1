#pragma once

#include "carve/base/limits.h"
#include "carve/lattice/mapping.h"
#include "carve/seam/seams.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// Solver nodes at work on small grids.
namespace fluidcarve::test {

inline FloatGrid::Ptr energy_grid(const openvdb::CoordBBox& box,
                                  const std::function<float(const openvdb::Coord&)>& value) {
    const auto out = FloatGrid::create();
    auto values = out->getAccessor();
    for (auto at = box.begin(); at; ++at) values.setValueOn(*at, value(*at));
    return out;
}

inline MaskGrid::Ptr mask_grid(const std::vector<openvdb::Coord>& voxels) {
    const auto out = MaskGrid::create();
    for (const auto& voxel : voxels) out->tree().setValueOn(voxel);
    return out;
}

struct Listener : Context::Host {
    nlohmann::ordered_json entry;
    std::vector<std::string> warnings;
    /// With what was reported of each.
    std::vector<std::pair<Ref<Seams>, nlohmann::ordered_json>> checkpoints;
    void warn(const std::string& message) override { warnings.push_back(message); }
    void report(const std::string&, const nlohmann::ordered_json& json) override { entry = json; }
    void checkpoint(const Payload& result) override {
        checkpoints.emplace_back(result.as<Seams>(), entry);
    }
};

struct Solved {
    Ref<Seams> seams;
    Listener listener;
};

/// By input: masks, or the field, or the content.
using Grids = std::map<std::string, std::vector<openvdb::GridBase::ConstPtr>>;

/// Another way to run a solver.
struct Otherwise {
    Ref<Seams> before;  ///< found by another run, with what was reported of them
    nlohmann::ordered_json reported;
    Limits limits;
    /// What becomes of each digest before it is taken.
    std::function<Payload(const Payload&)> digest;
};

/// Runs a solver over frames 5, 6 ...; one energy for all frames or one for each, lattices and
/// other grids likewise.
inline Solved solve(NodeType type, const std::string& yaml,
                    const std::vector<FloatGrid::Ptr>& energy, const std::vector<Lattice>& lattices,
                    const Grids& grids, std::size_t frame_count,
                    const std::vector<Ref<Seams>>& after = {}, const Otherwise& otherwise = {}) {
    std::vector<int> frames;
    for (std::size_t t = 0; t < frame_count; ++t) frames.push_back(5 + static_cast<int>(t));
    Solved out;
    NodeBench bench(std::move(type), yaml,
                    {{"field", grids.count("field")}, {"after", after.size()}});
    REQUIRE(bench.faults() == "");
    NodeBench::Inputs still;
    for (const auto& seams : after) still["after"].push_back(Payload(seams));
    const auto of = [](const auto& list, std::size_t t) {
        return list[std::min(t, list.size() - 1)];
    };
    auto adds = std::max(energy.size(), lattices.size());
    for (const auto& [name, of_input] : grids) adds = std::max(adds, of_input.size());
    for (std::size_t t = 0; t < adds; ++t) {
        auto inputs = still;
        inputs["energy"] = {Payload(of(energy, t))};
        inputs["lattice"] = {Payload(std::make_shared<Lattice>(of(lattices, t)))};
        for (const auto& [name, of_input] : grids) {
            const auto grid = of(of_input, t);
            if (name == "field" || name == "content")
                inputs[name] = {Payload(openvdb::gridConstPtrCast<FloatGrid>(grid))};
            else inputs[name] = {Payload(std::make_shared<AnyGrid>(AnyGrid{grid}))};
        }
        auto context = Context(out.listener, frames).limits(otherwise.limits);
        if (adds > 1) context.at(t);
        const auto digest = bench.digest(inputs, context);
        bench.add_digest(otherwise.digest ? otherwise.digest(digest) : digest, context);
    }
    if (otherwise.before) bench.resume(Payload(otherwise.before), otherwise.reported);
    const auto context = Context(out.listener, frames).limits(otherwise.limits);
    out.seams = bench.gathered(still, context).at("seams").as<Seams>();
    return out;
}

inline Lattice box(const std::array<int, 3>& shape) {
    return make_box(openvdb::Vec3d(0), shape, 1.0, {0, 1, 2});
}

}  // namespace fluidcarve::test
