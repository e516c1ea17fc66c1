#pragma once

#include "carve/points/point_grid.h"
#include "formats/points_file/points_file.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace fluidcarve::test {

inline const std::string data = TEST_DATA;

inline const std::string river_43 = data + "/river/river.0043.vdb";

inline Points read(const std::string& path) {
    return read_points(path, "", PointOffset::detect, {});
}

inline const std::string typical_header =
    "ply\nformat {} 1.0\ncomment made by hand\nobj_info shot 7\nelement vertex 3\nproperty float "
    "x\nproperty float y\nproperty float32 z\n"
    "property uchar red\nproperty double age\nproperty short kind\nproperty uint key\nproperty "
    "int8 sign\nproperty float v_x\nproperty float v_y\n"
    "property float v_z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";

inline const std::string typical_ascii =
    fmt::format(fmt::runtime(typical_header), "ascii") +
    "0.1 -2.5 1e-20 255 0.30000000000000004 -7 4294967295 -1 1 2 3\n"
    "1.5 0 3 0 1e+300 32767 0 127 0 -0 inf\n"
    "1.25 0.33333334 3 17 -0 5 12 0 nan 5 6\n";

/// All values of one row, as bytes.
inline std::string row(const PointTable& points, std::size_t n) {
    std::string out;
    for (const auto& column : points.columns) {
        const auto size = bytes_of(column.type);
        out.append(column.values.data() + n * size, size);
    }
    return out;
}

inline std::vector<std::string> sorted_rows(const PointTable& points) {
    std::vector<std::string> out;
    for (std::size_t n = 0; n < points.size; ++n) out.push_back(row(points, n));
    std::ranges::sort(out);
    return out;
}

struct Told : Context::Host {
    std::vector<std::string> warnings;
    void warn(const std::string& message) override { warnings.push_back(message); }
};

inline std::string refusal(const std::string& path) {
    const auto whole = failure_of([&] { read(path); });
    const auto start = whole.find(path);
    return start == std::string::npos
               ? whole
               : whole.substr(0, start) + "FILE" + whole.substr(start + path.size());
}

}  // namespace fluidcarve::test
