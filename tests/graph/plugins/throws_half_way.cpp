#include "tests/graph/plugins/toy.h"

#include <stdexcept>

const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};

void fluidcarve_register(fluidcarve::Registry& out) {
    toy::add_hair(out, "acme.hair");
    toy::add_grow(out, "acme.grow");
    throw std::runtime_error("the licence server is away");
}
