#include "tests/graph/plugins/toy.h"

const fluidcarve::PluginHeader fluidcarve_plugin{
    .payloads = 98, .version = "0.9.7", .family = "acme"};

void fluidcarve_register(fluidcarve::Registry&) { std::terminate(); }
