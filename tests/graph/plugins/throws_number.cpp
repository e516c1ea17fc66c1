#include "tests/graph/plugins/toy.h"

const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};

void fluidcarve_register(fluidcarve::Registry&) { throw 7; }
