#pragma once

/// Lines about the exact cut (METHOD 8 "The cut") beside Boost's boykov_kolmogorov_max_flow on the
/// same graph.
/// @throws std::runtime_error if the two flows differ
void bench_cut();
