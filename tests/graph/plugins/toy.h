#pragma once

#include "graph/types/plugin.h"

#include <memory>

/// What the plugins here add.
namespace toy {

struct Hair {
    int strands = 7;
};

struct Grow {
    struct Params {};
    struct Ports {
        fluidcarve::Ref<Hair> hair;
    };
    static void run(const Params&, Ports& io, fluidcarve::Context&) {
        io.hair = std::make_shared<Hair>();
    }
};

inline void add_hair(fluidcarve::Registry& out, const char* name) {
    out.add(
        fluidcarve::payload_type<Hair>(name, "Strands.", [](const Hair&) { return sizeof(Hair); }));
}

inline void add_grow(fluidcarve::Registry& out, const char* name) {
    out.add(
        fluidcarve::Declare<Grow>(name, "Grows hair.").output("hair", &Grow::Ports::hair, "Hair."));
}

}  // namespace toy
