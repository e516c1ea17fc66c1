#include "tests/graph/plugins/toy.h"

const fluidcarve::PluginHeader fluidcarve_plugin{.family = "toy"};

void fluidcarve_register(fluidcarve::Registry&) { std::terminate(); }
