#pragma once

/// Sequences of smoke made of tests/data/plume: a whole run beside copying the files, and what an
/// active voxel costs in a large box, nearly empty, beside a smaller and fuller one. Adds lines to
/// the figures.
/// @param large  the large box is 1000 x 600 x 600 in place of 500 x 300 x 300, and there are 24
///   frames of the smaller one
void bench_sparse(bool large);
