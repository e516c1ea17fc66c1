#pragma once

/// Measures warp.solve beside seam.greedy. @param large  the paper's largest vortex, too
void bench_warp(bool large);
