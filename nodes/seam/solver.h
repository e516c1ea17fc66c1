#pragma once

#include "nodes/seam/declare_solver.h"
#include "nodes/seam/search/find_seams.h"
#include "nodes/seam/search/protection.h"
#include "nodes/seam/search/strip.h"

/// Everything that a solver includes: its node (SeamNode) and its declaration, the loop that calls it (FindSeam), ways past protected
/// vertices, and sums over seams.
