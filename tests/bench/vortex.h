#pragma once

#include <string>

/// Lines about rings: pipelines/vortex.yaml on a folder of `vortex.####.vdb`, of which
/// tests/data/vortex is an excerpt.
void bench_vortex(const std::string& folder);
