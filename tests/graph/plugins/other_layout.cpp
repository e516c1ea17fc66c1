#include "tests/graph/plugins/toy.h"

const fluidcarve::PluginHeader fluidcarve_plugin{
    .node_type = 8, .version = "0.9.7", .family = "acme"};

void fluidcarve_register(fluidcarve::Registry&) { std::terminate(); }
