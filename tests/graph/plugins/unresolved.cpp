#include "tests/graph/plugins/toy.h"

void nowhere_defined(fluidcarve::Registry& out);

const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};

void fluidcarve_register(fluidcarve::Registry& out) { nowhere_defined(out); }
