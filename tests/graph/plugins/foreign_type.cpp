#include "tests/graph/plugins/toy.h"

const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};

void fluidcarve_register(fluidcarve::Registry& out) {
    toy::add_hair(out, "acme.hair");
    toy::add_grow(out, "toy.grow");
}
