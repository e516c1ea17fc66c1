#include "graph/code_trust.h"

namespace fluidcarve {
namespace {

bool allowed = false;

}  // namespace

bool code_allowed() { return allowed; }
void allow_code() { allowed = true; }

}  // namespace fluidcarve
