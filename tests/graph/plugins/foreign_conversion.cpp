#include "graph/types/plugin.h"
#include "tests/support/toy_nodes.h"

const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};

void fluidcarve_register(fluidcarve::Registry& out) {
    out.add(fluidcarve::conversion<toy::Number, toy::Text>(
        [](const fluidcarve::Ref<toy::Number>&) { return std::make_shared<toy::Text>(); }));
}
