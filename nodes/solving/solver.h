#pragma once

#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/protection.h"
#include "carve/solver/search/strip.h"
#include "nodes/solving/declare_solver.h"

/// Everything that a solver includes: its node (SeamNode) and its declaration, the loop that calls
/// it (FindSeam), ways past protected vertices, and sums over seams.
