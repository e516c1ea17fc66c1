#pragma once

#include "carve/energy/volume.h"
#include "carve/field/curl.h"
#include "carve/field/gradient.h"
#include "formats/file/module.h"
#include "formats/vdb/vdb_file.h"
#include "graph/text/yaml_reader.h"
#include "nodes/expression/energy_ax.h"
#include "nodes/expression/evaluate.h"
#include "nodes/expression/field_ax.h"
#include "nodes/expression/program_text.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"

#include <tbb/global_control.h>
#include <catch2/catch.hpp>

#include <algorithm>

using namespace fluidcarve;
using openvdb::Coord;
using test::failure_of;

inline const ExpressionModule& module() { return load_module<ExpressionModule>("expressions"); }

using Inputs = std::vector<std::pair<std::string, Ref<AnyGrid>>>;
using Constants = std::map<std::string, ProgramConstant>;

inline std::shared_ptr<const CompiledExpression> compiled(const std::string& code,
                                                          const Inputs& inputs,
                                                          const Constants& constants = {}) {
    std::vector<std::string> names;
    for (const auto& [name, grid] : inputs) names.push_back(name);
    std::vector<ExpressionFault> faults;
    auto out = module().compile({code, names, constants, "energy"}, faults);
    for (const auto& fault : faults)
        UNSCOPED_INFO(fault.line << ":" << fault.column << " " << fault.message);
    REQUIRE(out);
    return out;
}

inline FloatGrid::Ptr energy(const std::string& code, const Inputs& inputs,
                             const Constants& constants = {}, float least = 0,
                             std::uint64_t budget = ~std::uint64_t{0}) {
    return evaluated(
        module(), *compiled(code, inputs, constants), inputs, "energy", least, budget,
        [](int line, int column) { return fmt::format("p.yaml:{}:{}", line, column); });
}

template <class Grid>
Ref<AnyGrid> any(const std::shared_ptr<Grid>& grid) {
    return std::make_shared<AnyGrid>(AnyGrid{grid});
}

inline FloatGrid::Ptr numbers(float background,
                              const std::vector<std::pair<Coord, float>>& values) {
    auto out = FloatGrid::create(background);
    out->setName("density");
    for (const auto& [at, value] : values) out->tree().setValue(at, value);
    return out;
}
