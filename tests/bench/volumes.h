#pragma once

#include <string>

/// The paper's table 2: seconds and energy of a seam by solver, in real and synthetic volumes.
/// Prints it, and writes `OUT.csv` and `OUT.md`.
/// @param folder  of sequences `plume/plume.####.vdb`, `vortex/...`, `bonfire/...`, which go
///   through the shipped pipelines;
///                those that are not there are left out
/// @param large   a synthetic volume of the size of the paper's smoke vortex too; takes 5 GB
void compare_on_volumes(const std::string& folder, const std::string& out, bool large);
