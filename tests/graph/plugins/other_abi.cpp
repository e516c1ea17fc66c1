#include "tests/graph/plugins/toy.h"

const fluidcarve::PluginHeader fluidcarve_plugin{.abi = 99, .family = "acme"};

void fluidcarve_register(fluidcarve::Registry&) { std::terminate(); }
